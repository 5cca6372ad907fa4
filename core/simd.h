/* What the hot loops need from the compiler: function versions per instruction set, vectorised sine and cosine, and
 * 64-byte vectors. Everywhere else plain C.
 * Does not: contain intrinsics; without GCC on x86-64 glibc each macro falls back to portable code. */
#ifndef DIF_SIMD_H
#define DIF_SIMD_H

#include <math.h>

/* One version of a function per instruction set, chosen when the program loads. Sanitizers cannot start with the
 * resolvers this needs, and clang names the levels differently. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__linux__) &&                           \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DIF_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define DIF_CLONES
#endif

#define DIF_INLINE static inline __attribute__((always_inline))

/* glibc's vector library has these; its own declarations hide them unless fast-math is on, which we never use. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
__attribute__((simd("notinbranch"))) double sin(double);
__attribute__((simd("notinbranch"))) double cos(double);
#endif

/* 64-byte vectors and their unaligned, aliasing views for loads. */
typedef double dif_v8d __attribute__((vector_size(64)));
typedef double dif_v8du __attribute__((vector_size(64), aligned(8), may_alias));

#endif
