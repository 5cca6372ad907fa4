/* Result codes and the caller-owned error record.
 * Does not: print, exit, keep any global state. */
#ifndef DIF_STATUS_H
#define DIF_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define DIF_MUST_USE                __attribute__((warn_unused_result))
#define DIF_PRINTF(fmt_at, args_at) __attribute__((format(printf, fmt_at, args_at)))
#else
#define DIF_MUST_USE
#define DIF_PRINTF(fmt_at, args_at)
#endif

/* Numbers are append-only: X(name, number, text). */
#define DIF_STATUS_LIST(X)                                                                                             \
    X(DIF_OK, 0, "ok")                                                                                                 \
    X(DIF_ERR_ARG, 1, "argument out of range")                                                                         \
    X(DIF_ERR_TOL, 2, "tolerance out of range")                                                                        \
    X(DIF_ERR_NOMEM, 3, "out of memory")                                                                               \
    X(DIF_ERR_SIZE, 4, "size too large")                                                                               \
    X(DIF_ERR_IO, 5, "input/output error")                                                                             \
    X(DIF_ERR_FORMAT, 6, "malformed or unknown file")                                                                  \
    X(DIF_ERR_SCALE, 7, "missing physical scale")                                                                      \
    X(DIF_ERR_NONFINITE, 8, "non-finite value")                                                                        \
    X(DIF_ERR_FIT, 9, "fit not believed")                                                                              \
    X(DIF_ERR_FOREIGN, 10, "error in a library")                                                                       \
    X(DIF_ERR_RESOURCE, 11, "resource missing")                                                                        \
    X(DIF_ERR_UNSUPPORTED, 12, "not supported")

typedef enum dif_status {
#define DIF_STATUS_ENUM(name, number, text) name = number,
    DIF_STATUS_LIST(DIF_STATUS_ENUM)
#undef DIF_STATUS_ENUM
} dif_status;

/* Detail of the last failure of one call. The caller owns it; functions accept NULL. */
typedef struct dif_error {
    dif_status status;
    char text[240];
} dif_error;

/* The fixed text of a code; never NULL. */
const char *dif_status_text(dif_status status);

/* Fills *err (if not NULL) and returns the code, so that a failure is one statement. */
dif_status dif_fail(dif_error *err, dif_status status, const char *format, ...) DIF_PRINTF(3, 4);
#ifdef __clang_analyzer__ /* sees one file at a time, so it must be told which code comes back */
#define dif_fail(err, status, ...) ((void)(dif_fail)(err, status, __VA_ARGS__), (status))
#endif

#ifdef __cplusplus
}
#endif
#endif
