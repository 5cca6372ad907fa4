#include <math.h>
#include <stdio.h>

#include "bench/cli/info.h"
#include "core/units.h"

/* What a table's values are like. */
typedef struct value_summary {
    double min, max, mean;
    double angle_max_deg, lambda_max_nm; /* where the largest one is */
    size_t n, n_missing;
} value_summary;

static value_summary summarise(const dif_table *table)
{
    const dif_plan *plan = &table->plan;
    const size_t n_angle = (size_t)plan->n_angle, n = n_angle * (size_t)plan->n_lambda;
    value_summary s = {.min = INFINITY, .max = -INFINITY};
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double value = table->value[i];
        if (!isfinite(value)) {
            s.n_missing++;
            continue;
        }
        s.n++;
        sum += value;
        s.min = fmin(s.min, value);
        if (value > s.max) {
            s.max = value;
            s.angle_max_deg = dif_deg_from_rad(plan->angle_rad[i % n_angle]);
            s.lambda_max_nm = dif_nm_from_um(plan->lambda_um[i / n_angle]);
        }
    }
    s.mean = s.n ? sum / (double)s.n : (double)NAN;
    return s;
}

static void print_table(const dif_cli *cli, const dif_cli_input *input, const value_summary *s)
{
    const dif_plan *plan = &input->table.plan;
    printf("%s: response table, %s (unit %s)\n", cli->operand[0], dif_quantity_name(input->table.quantity),
           dif_quantity_unit(input->table.quantity));
    printf("plan       theta_%c %.6g deg fixed, plane at azimuth %.6g deg\n", plan->fixed_is_wo ? 'r' : 'i',
           dif_deg_from_rad(plan->fixed_rad), dif_deg_from_rad(plan->azimuth_rad));
    printf("angles     %d from %.6g to %.6g deg\n", plan->n_angle, dif_deg_from_rad(plan->angle_rad[0]),
           dif_deg_from_rad(plan->angle_rad[plan->n_angle - 1]));
    printf("wavelengths %d from %.6g to %.6g nm\n", plan->n_lambda, dif_nm_from_um(plan->lambda_um[0]),
           dif_nm_from_um(plan->lambda_um[plan->n_lambda - 1]));
    printf("values     %.4g to %.4g, mean %.4g; largest at %.6g deg, %.6g nm; %zu missing\n", s->min, s->max, s->mean,
           s->angle_max_deg, s->lambda_max_nm, s->n_missing);
    printf("provenance%s\n", input->manifest.n ? "" : " none");
    for (int i = 0; i < input->manifest.n; i++)
        printf("           %s: %s\n", input->manifest.item[i].key, input->manifest.item[i].value);
}

static json_t *json_table(const dif_cli_input *input, const value_summary *s)
{
    const dif_plan *plan = &input->table.plan;
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:f, s:f, s:i, s:i}", "kind", "table", "quantity", dif_quantity_name(input->table.quantity),
        "fixed_angle", plan->fixed_is_wo ? "theta_r" : "theta_i", "fixed_deg", dif_deg_from_rad(plan->fixed_rad),
        "azimuth_deg", dif_deg_from_rad(plan->azimuth_rad), "n_angle", plan->n_angle, "n_lambda", plan->n_lambda);
    json_object_set_new(object, "min", dif_json_number(s->min));
    json_object_set_new(object, "max", dif_json_number(s->max));
    json_object_set_new(object, "mean", dif_json_number(s->mean));
    json_object_set_new(object, "missing", json_integer((json_int_t)s->n_missing));
    json_object_set_new(object, "table_provenance", dif_json_manifest(&input->manifest));
    return object;
}

dif_status dif_info_table(const dif_cli *cli, const dif_cli_input *input, dif_error *err)
{
    const value_summary summary = summarise(&input->table);
    dif_manifest manifest = {0};
    if (!cli->json) {
        print_table(cli, input, &summary);
        return DIF_OK;
    }
    dif_status status = dif_cli_manifest(cli, cli->operand[0], &manifest, err);
    if (!status) {
        json_t *object = json_table(input, &summary);
        json_object_set_new(object, "provenance", dif_json_manifest(&manifest));
        if (dif_json_print(cli, object) != DIF_EXIT_DONE)
            status = dif_fail(err, DIF_ERR_NOMEM, "out of memory");
    }
    dif_manifest_free(&manifest);
    return status;
}
