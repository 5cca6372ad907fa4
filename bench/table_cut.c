#include "bench/table_cut.h"

#include <math.h>

dif_status dif_table_cut(const dif_table *table, double f_min_per_um, double f_max_per_um, double angle_max_rad,
                         dif_table *out, dif_error *err)
{
    const dif_plan *plan = &table->plan;
    const dif_status status = dif_table_create(plan, table->quantity, out, err);
    if (status != DIF_OK)
        return status;
    for (int ia = 0; ia < plan->n_angle; ia++) {
        double sin_sum, cos_sum;
        dif_plan_transfer(plan, ia, &sin_sum, &cos_sum);
        for (int il = 0; il < plan->n_lambda; il++) {
            const size_t at = (size_t)il * (size_t)plan->n_angle + (size_t)ia;
            const double f_per_um = fabs(sin_sum) / plan->lambda_um[il];
            const bool keep =
                f_per_um >= f_min_per_um && f_per_um <= f_max_per_um && fabs(plan->angle_rad[ia]) <= angle_max_rad;
            out->value[at] = keep ? table->value[at] : (double)NAN;
        }
    }
    return DIF_OK;
}
