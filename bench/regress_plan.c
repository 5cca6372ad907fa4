/* What a comparison asks, and where its numbers lie. */
#include <math.h>

#include "bench/map.h"
#include "bench/regress_run.h"

static const char *const QUESTIONS[] = {"table", "map", "colour", "full"};
static const char *const METHODS[DIF_REGRESS_METHODS] = {"sheet", "nmm", "nmm-lines", "pq", "lut", "stam"};

const char *dif_regress_question_name(dif_regress_question question)
{
    return QUESTIONS[question];
}

const char *dif_regress_method_name(int method)
{
    return METHODS[method];
}

dif_regress_plan dif_regress_plan_default(void)
{
    dif_regress_plan plan = {.wi = {0.0, 0.0, 1.0},
                             .n_pixel = 97,
                             .lut = dif_lut_opts_default(),
                             .tol_lut = 1e-5,
                             .tol_device = 1e-7,
                             .tol_reference = 1e-9,
                             .floor_share = 1e-5,
                             .peak_floor_share = 0.01,
                             .full = true,
                             .fit = true,
                             .f_max_per_um = (double)INFINITY};
    for (int i = 0; i < DIF_REGRESS_METHODS; i++)
        plan.method[i] = true;
    return plan;
}

dif_regress_place dif_regress_place_of(const dif_regress_plan *plan, dif_regress_question question, size_t at)
{
    const double nan = (double)NAN;
    dif_regress_place place = {.lambda_um = nan, .angle_rad = nan};
    const size_t n = (size_t)plan->n_pixel * (size_t)plan->n_pixel;
    size_t pixel = at / 3;
    if (question == DIF_REGRESS_TABLE) {
        const size_t n_angle = (size_t)plan->table->n_angle;
        place.angle_rad = plan->table->angle_rad[at % n_angle];
        place.lambda_um = plan->table->lambda_um[at / n_angle];
        return place;
    }
    if (question == DIF_REGRESS_MAP) {
        place.lambda_um = plan->layer_um[at / n];
        pixel = at % n;
    } else {
        place.channel = (int)(at % 3);
    }
    place.ix = (int)(pixel % (size_t)plan->n_pixel);
    place.iy = (int)(pixel / (size_t)plan->n_pixel);
    (void)dif_map_direction(plan->n_pixel, place.ix, place.iy, &place.wo);
    return place;
}
