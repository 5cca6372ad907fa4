#include "core/fft.h"

#include "core/units.h"
#include "near.h"

/* Largest difference between the transform of `n_row` random rows and the definition. */
static double error_against_the_sum(int n_row, int n, bool single)
{
    uint64_t random = 3;
    double *in = calloc((size_t)(2 * n_row * n), sizeof *in), *out = calloc((size_t)(2 * n_row * n), sizeof *out);
    float *out_f = calloc((size_t)(2 * n_row * n), sizeof *out_f);
    double worst = 0.0;
    for (int i = 0; i < 2 * n_row * n; i++) {
        in[i] = out[i] = test_random(&random, -1.0, 1.0);
        out_f[i] = (float)in[i];
    }
    assert_int_equal(dif_fft_rows(single ? (void *)out_f : (void *)out, n_row, n, single, NULL), DIF_OK);
    for (int row = 0; row < n_row; row++)
        for (int q = 0; q < n; q++) {
            double re = 0.0, im = 0.0;
            for (int j = 0; j < n; j++) {
                const double c = cos(DIF_TWO_PI * q * j / n), s = sin(DIF_TWO_PI * q * j / n);
                const double *x = in + 2 * (row * n + j);
                re += x[0] * c - x[1] * s;
                im += x[0] * s + x[1] * c;
            }
            const int at = 2 * (row * n + q);
            worst = fmax(worst, hypot((single ? (double)out_f[at] : out[at]) - re,
                                      (single ? (double)out_f[at + 1] : out[at + 1]) - im));
        }
    free(in);
    free(out);
    free(out_f);
    return worst;
}

static void test_rows__are_the_sum_with_the_positive_exponent(void **state)
{
    (void)state;
    const int sizes[] = {1, 2, 3, 8, 30, 45, 128, 7, 13};
    for (int i = 0; i < 9; i++) {
        /* sums of up to 128 numbers of size one; the test's own sines are good to 1e-14 */
        assert_at_most(error_against_the_sum(3, sizes[i], false), 1e-12);
        assert_at_most(error_against_the_sum(3, sizes[i], true), 3e-5);
    }
}

static void test_size__is_never_smaller_and_smooth(void **state)
{
    (void)state;
    for (int n = 1; n < 5000; n += 37) {
        int rest = dif_fft_size(n);
        assert_true(rest >= n && rest <= 2 * n);
        for (int p = 2; p <= 5; p++)
            while (rest % p == 0)
                rest /= p;
        assert_int_equal(rest, 1);
    }
}

static void test_rows__empty_input_is_refused(void **state)
{
    (void)state;
    double x[2] = {0.0, 0.0};
    dif_error err;
    assert_int_equal(dif_fft_rows(x, 0, 1, false, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "DFT of 0 rows of 1");
    assert_int_equal(dif_fft_rows(NULL, 1, 1, false, &err), DIF_ERR_ARG);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows__are_the_sum_with_the_positive_exponent),
        cmocka_unit_test(test_size__is_never_smaller_and_smooth),
        cmocka_unit_test(test_rows__empty_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
