/* Plans, tables and the source's statistic for the tests of methods, and the measured scans. */
#ifndef DIF_TEST_FIRST_ORDER_H
#define DIF_TEST_FIRST_ORDER_H

#include "bench/measure.h"
#include "bench/scan.h"
#include "core/io/field_io.h"
#include "core/units.h"
#include "near.h"

static inline dif_plan test_plan(double fixed_deg, double azimuth_deg, const char *angle_deg, const char *lambda_nm)
{
    dif_range angle, lambda;
    dif_plan plan;
    assert_int_equal(dif_range_parse(angle_deg, &angle, NULL), DIF_OK);
    assert_int_equal(dif_range_parse(lambda_nm, &lambda, NULL), DIF_OK);
    assert_int_equal(dif_scan_plan(false, fixed_deg, azimuth_deg, &angle, &lambda, &plan, NULL), DIF_OK);
    return plan;
}

static inline dif_table test_measure(const dif_field *field, const dif_plan *plan, const dif_measure_opts *opts,
                                     dif_measure_stats *stats)
{
    dif_table table;
    dif_error err = {DIF_OK, ""};
    if (dif_measure_table(field, plan, 1e-6, opts, &table, stats, &err) != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(err.status, DIF_OK);
    return table;
}

/* The source's statistic: mean and standard deviation of lambda / |sin sum| at each wavelength's largest value, nm. */
static inline void test_first_order_of(const dif_table *table, double *mean_nm, double *sd_nm)
{
    const dif_plan *plan = &table->plan;
    double sum = 0.0, sum2 = 0.0;
    for (int il = 0; il < plan->n_lambda; il++) {
        const double *value = table->value + (size_t)il * (size_t)plan->n_angle;
        int best = 0;
        double sin_sum, cos_sum;
        for (int ia = 1; ia < plan->n_angle; ia++)
            best = value[ia] > value[best] ? ia : best;
        dif_plan_transfer(plan, best, &sin_sum, &cos_sum);
        const double d_nm = dif_nm_from_um(plan->lambda_um[il] / fabs(sin_sum));
        sum += d_nm;
        sum2 += d_nm * d_nm;
    }
    *mean_nm = sum / plan->n_lambda;
    *sd_nm = sqrt(sum2 / plan->n_lambda - *mean_nm * *mean_nm);
}

static inline void test_first_order(const dif_field *field, const dif_measure_opts *opts, double azimuth_deg,
                                    const char *angle_deg, double *mean_nm, double *sd_nm)
{
    dif_plan plan = test_plan(75.0, azimuth_deg, angle_deg, "380:780:1");
    dif_table table = test_measure(field, &plan, opts, NULL);
    test_first_order_of(&table, mean_nm, sd_nm);
    dif_table_free(&table);
    dif_plan_free(&plan);
}

static inline bool test_read_scan(const char *name, double height_um, dif_field *field)
{
    dif_field_request request = dif_field_request_default();
    const char *folder = test_data_folder();
    dif_field_file file;
    char path[512];
    if (!folder)
        return false;
    snprintf(path, sizeof path, "%s/measured/%s", folder, name);
    request.size_um = 65.0;
    request.height_um = height_um;
    assert_int_equal(dif_field_read(path, &request, &file, NULL), DIF_OK);
    *field = file.field;
    return true;
}

#endif
