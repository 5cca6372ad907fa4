/* One case of a comparison as JSON. */
#include <math.h>
#include <stdlib.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "core/units.h"

static json_t *degrees(double rad)
{
    return dif_json_number(dif_deg_from_rad(rad));
}

static json_t *nm(double um)
{
    return dif_json_number(dif_nm_from_um(um));
}

/* Where number `at` lies; fractions run from the left and the top of a picture. */
static json_t *place_json(const dif_regress_plan *plan, dif_regress_question question, size_t at)
{
    static const char *const channels[] = {"X", "Y", "Z"};
    const dif_regress_place place = dif_regress_place_of(plan, question, at);
    if (question == DIF_REGRESS_TABLE) {
        const size_t n_angle = (size_t)plan->table->n_angle, n_lambda = (size_t)plan->table->n_lambda;
        return json_pack("{s:o, s:o, s:f, s:f}", "angle_deg", degrees(place.angle_rad), "lambda_nm",
                         nm(place.lambda_um), "x", ((double)(at % n_angle) + 0.5) / (double)n_angle, "y",
                         1.0 - ((double)(at / n_angle) + 0.5) / (double)n_lambda);
    }
    json_t *out = json_pack("{s:o, s:o, s:f, s:f}", "theta_r_deg", degrees(acos(fmin(place.wo.z, 1.0))), "phi_r_deg",
                            degrees(atan2(place.wo.y, place.wo.x)), "x", (place.ix + 0.5) / plan->n_pixel, "y",
                            (place.iy + 0.5) / plan->n_pixel);
    if (question == DIF_REGRESS_MAP)
        json_object_set_new(out, "lambda_nm", nm(place.lambda_um));
    else
        json_object_set_new(out, "channel", json_string(channels[place.channel]));
    return out;
}

/* `per`: numbers that one place of the statistic stands for in the arrays (colours: three). */
static json_t *stat_json(const dif_regress_plan *plan, dif_regress_question question, const dif_regress_stat *stat,
                         size_t per)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "median", dif_json_number(stat->median), "p95",
                     dif_json_number(stat->p95), "p99", dif_json_number(stat->p99), "worst",
                     dif_json_number(stat->worst), "at", place_json(plan, question, per * stat->worst_at), "device",
                     dif_json_number(stat->worst_a), "reference", dif_json_number(stat->worst_b));
}

static json_t *stats_json(const dif_regress_plan *plan, const dif_regress_case *c)
{
    json_t *out = json_pack("{s:o, s:o, s:o}", "rel", stat_json(plan, c->question, &c->values.relative, 1), "abs",
                            stat_json(plan, c->question, &c->values.absolute, 1), "max",
                            stat_json(plan, c->question, &c->values.of_max, 1));
    if (c->has_colours) /* the place of a colour is that of its pixel */
        json_object_set_new(out, "de", stat_json(plan, c->question, &c->de, 3));
    return out;
}

static json_t *checks_json(const dif_compare_limits *limits, const dif_regress_case *c)
{
    json_t *rows = json_array();
    for (int m = 0; m < DIF_REGRESS_METRICS; m++) {
        const double value = dif_regress_metric_of(c, (dif_regress_metric)m);
        const dif_regress_limit *limit = dif_regress_limit_find(limits->n, limits->limit, c, (dif_regress_metric)m);
        if (!limit || isnan(value) || isinf(limit->limit))
            continue;
        json_array_append_new(
            rows, json_pack("{s:s, s:s, s:o, s:o, s:b}", "metric", dif_regress_metric_name((dif_regress_metric)m),
                            "unit", dif_regress_metric_unit((dif_regress_metric)m), "value", dif_json_number(value),
                            "limit", dif_json_number(limit->limit), "pass", (int)(value <= limit->limit)));
    }
    return rows;
}

static json_t *peaks_json(const dif_regress_peaks *peaks)
{
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o}", "n", peaks->n, "n_lost", peaks->n_lost, "shift_deg",
                     degrees(peaks->worst_shift_rad), "lambda_nm", nm(peaks->lambda_um), "device_deg",
                     degrees(peaks->angle_a_rad), "reference_deg", degrees(peaks->angle_b_rad));
}

static json_t *fit_json(const dif_regress_fit *fit)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:s}", "device_nm", nm(fit->device_um), "device_u_nm", nm(fit->device_sd_um),
                     "reference_nm", nm(fit->reference_um), "reference_u_nm", nm(fit->reference_sd_um), "text",
                     fit->text);
}

/* Wall seconds; transfer apart from shaders. */
static json_t *timings_json(const dif_regress_case *c)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "build_device_s", c->build_device_s,
                     "build_reference_s", c->build_reference_s, "first_s", c->first_device_s, "call_s",
                     c->wall_device_s, "upload_s", c->device.upload_s, "run_s", c->device.run_s, "download_s",
                     c->device.download_s, "reference_s", c->wall_reference_s);
}

static void add_answer(const dif_regress_plan *plan, const dif_compare_limits *limits, const dif_regress_case *c,
                       json_t *out)
{
    json_object_set_new(out, "n", json_integer((json_int_t)c->values.n));
    json_object_set_new(out, "maximum", dif_json_number(c->values.maximum));
    json_object_set_new(out, "floor", dif_json_number(c->values.floor));
    json_object_set_new(out, "n_one_sided", json_integer((json_int_t)c->values.n_one_sided));
    if (c->values.n_one_sided > 0)
        json_object_set_new(out, "one_sided_at", place_json(plan, c->question, c->values.one_sided_at));
    json_object_set_new(out, "stats", stats_json(plan, c));
    json_object_set_new(out, "checks", checks_json(limits, c));
    if (c->has_colours)
        json_object_set_new(out, "exposure", dif_json_number(c->exposure));
    if (c->has_peaks)
        json_object_set_new(out, "peaks", peaks_json(&c->peaks));
    if (c->fit.tried)
        json_object_set_new(out, "fit", fit_json(&c->fit));
    json_object_set_new(out, "bound",
                        json_pack("{s:o, s:o}", "device", dif_json_number(c->bound_device), "reference",
                                  dif_json_number(c->bound_reference)));
    if (!getenv("SOURCE_DATE_EPOCH"))
        json_object_set_new(out, "timings", timings_json(c));
}

json_t *dif_compare_case_json(const dif_regress_plan *plan, const dif_compare_limits *limits,
                              const dif_regress_case *result, bool *pass)
{
    int n_failed;
    *pass = dif_regress_passes(limits->n, limits->limit, result, &n_failed);
    json_t *out = json_pack(
        "{s:s, s:s, s:s, s:b, s:b, s:s, s:i, s:I}", "method", dif_regress_method_name(result->method), "question",
        dif_regress_question_name(result->question), "path", result->path, "answered", (int)(result->status == DIF_OK),
        "pass", (int)*pass, "text", result->text, "n_failed", n_failed, "n_asked", (json_int_t)result->n_sample);
    if (out && result->status == DIF_OK)
        add_answer(plan, limits, result, out);
    return out;
}
