/* Comparisons and seeded random numbers for the tests.
 * |got - want| <= max(floor, rel * |want|), and NaN fails; the worst margin of a program is printed by near_report. */
#ifndef DIF_TEST_NEAR_H
#define DIF_TEST_NEAR_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static inline void assert_near_at(double got, double want, double rel, double floor_abs, const char *file, int line)
{
    const double allowed = fmax(floor_abs, rel * fabs(want));
    if (!(fabs(got - want) <= allowed)) {
        print_error("%.17g is not near %.17g: off by %.3g, allowed %.3g\n", got, want, fabs(got - want), allowed);
        _fail(file, line);
    }
}
#define assert_near(got, want, rel, floor_abs) assert_near_at(got, want, rel, floor_abs, __FILE__, __LINE__)

/* Asserts a <= b, NaN fails. */
static inline void assert_at_most_at(double a, double b, const char *file, int line)
{
    if (!(a <= b)) {
        print_error("%.17g is not at most %.17g\n", a, b);
        _fail(file, line);
    }
}
#define assert_at_most(a, b) assert_at_most_at(a, b, __FILE__, __LINE__)

/* A small seeded generator (splitmix64) so that tests are the same everywhere. */
static inline uint64_t test_random_next(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Uniform in [lo, hi). */
static inline double test_random(uint64_t *state, double lo, double hi)
{
    return lo + (hi - lo) * ((double)(test_random_next(state) >> 11) * 0x1p-53);
}

/* Folder of the shared data: $DIFFBENCH_DATA or ../shared/data; NULL (with a printed line) if it is not here. */
static inline const char *test_data_folder(void)
{
    const char *folder = getenv("DIFFBENCH_DATA");
    struct stat about;
    if (!folder)
        folder = "../shared/data";
    if (stat(folder, &about) == 0)
        return folder;
    print_message("data folder %s not found (set DIFFBENCH_DATA): skipping\n", folder);
    return NULL;
}

#endif
