/* diffbench maxima TABLE: maxima per wavelength against the grating equation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/csv_out.h"
#include "bench/maxima.h"
#include "core/io/table_io.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "TABLE",
    "Finds the maxima of a table at each wavelength, sub-sample, and holds them against the grating equation\n"
    "d (sin theta_i + sin theta_m) = m lambda: residual angles per order. Without a period only the statistic of\n"
    "lambda / |sin theta_i + sin theta_r| at each wavelength's largest value is printed (order 1 by assumption).\n",
    "  diffbench fixture blazed --pixels 512 --out blazed.gsf\n"
    "  diffbench table blazed.gsf --theta-i-deg 75 --angle-deg -55:-40:0.05 --lambda-nm 380:780:10 --out blazed.csv\n"
    "  diffbench maxima blazed.csv --period-nm 2500 --max-residual-deg 0.1 --out maxima.csv\n",
};

enum { ORDERS_MAX = 400 };

typedef struct maxima_args {
    double period_nm, max_residual_deg, floor_share;
    const char *out;
} maxima_args;

static void add_options(dif_cli *cli, maxima_args *args)
{
    const dif_opt opts[] = {
        {"Maxima", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"period-nm", DIF_OPT_REAL, &args->period_nm, "(0, inf)", "NM", "grating period that gives the orders", NULL},
        {"max-residual-deg", DIF_OPT_REAL, &args->max_residual_deg, "(0, 180)", "DEG",
         "exit 1 if a maximum is farther than this from its order", NULL},
        {"floor-share", DIF_OPT_REAL, &args->floor_share, "[0, 1)", "S",
         "ignore maxima below this share of the table's largest value (default 0.01)", NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F.csv", "all maxima as CSV (- is stdout, without the summary)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

typedef struct maxima_run {
    dif_table table;
    dif_manifest own, manifest; /* the table's; ours */
    dif_maxima maxima;
    dif_maxima_period first;
    int n_order;
    dif_maxima_order order[ORDERS_MAX];
} maxima_run;

static dif_status describe(const dif_cli *cli, const maxima_args *args, maxima_run *run, dif_error *err)
{
    dif_status status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status && !isnan(args->period_nm))
        status = dif_manifest_setf(&run->manifest, err, "period_nm", "%.12g", args->period_nm);
    return status ? status : dif_manifest_setf(&run->manifest, err, "floor_share", "%.6g", args->floor_share);
}

static dif_status find(const dif_cli *cli, const maxima_args *args, maxima_run *run, dif_error *err)
{
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.floor_share = args->floor_share;
    opts.period_um = args->period_nm * 1e-3; /* NaN stays NaN */
    dif_status status = dif_table_read(cli->operand[0], &run->table, &run->own, err);
    if (!status)
        status = dif_maxima_find(&run->table, &opts, &run->maxima, err);
    if (status)
        return status;
    run->first = dif_maxima_first_order(&run->maxima);
    if (!isnan(args->period_nm))
        run->n_order = dif_maxima_by_order(&run->maxima, ORDERS_MAX, run->order);
    if (run->n_order > ORDERS_MAX)
        return dif_fail(err, DIF_ERR_ARG, "--period-nm %.6g: %d orders, expected at most %d", args->period_nm,
                        run->n_order, ORDERS_MAX);
    return describe(cli, args, run, err);
}

static dif_status write_csv(const maxima_args *args, const maxima_run *run, dif_error *err)
{
    dif_csv_out out;
    const dif_status status = dif_csv_out_open(args->out, &out, err);
    if (status)
        return status;
    dif_csv_out_provenance(out.stream, &run->manifest);
    fprintf(out.stream, "lambda_nm,angle_deg,value,order,residual_deg,period_nm,is_global,at_edge\n");
    for (int i = 0; i < run->maxima.n; i++) {
        const dif_maximum *m = &run->maxima.item[i];
        fprintf(out.stream, "%.12g,%.12g,%.9g,%d,%.9g,%.9g,%d,%d\n", dif_nm_from_um(m->lambda_um),
                dif_deg_from_rad(m->angle_rad), m->value, m->order, dif_deg_from_rad(m->residual_rad),
                dif_nm_from_um(m->period_um), m->is_global, m->at_edge);
    }
    return dif_csv_out_close(&out, err);
}

static int count_edges(const dif_maxima *maxima)
{
    int n = 0;
    for (int i = 0; i < maxima->n; i++)
        n += maxima->item[i].is_global && maxima->item[i].at_edge;
    return n;
}

static void print_summary(const dif_cli *cli, const maxima_run *run)
{
    const dif_maxima_period *first = &run->first;
    const int n_edge = count_edges(&run->maxima);
    printf("%s: %d maxima at %d wavelengths\n", cli->operand[0], run->maxima.n, run->table.plan.n_lambda);
    if (n_edge > 0)
        printf("at %d wavelength%s the largest value lies at the edge of the angles: a wider range is needed\n", n_edge,
               n_edge == 1 ? "" : "s");
    printf("lambda/|sin theta_i + sin theta_r| at each wavelength's largest value:\n"
           "  mean %.6g nm, standard deviation %.4g nm, from %.6g to %.6g nm, %d wavelengths\n",
           dif_nm_from_um(first->mean_um), dif_nm_from_um(first->sd_um), dif_nm_from_um(first->min_um),
           dif_nm_from_um(first->max_um), first->n);
    if (run->n_order == 0)
        return;
    printf("residuals, maximum minus grating equation:\n"
           "  %5s %6s %12s %12s %12s %12s %10s\n",
           "order", "n", "mean_deg", "rms_deg", "worst_deg", "period_nm", "sd_nm");
    for (int i = 0; i < run->n_order; i++) {
        const dif_maxima_order *o = &run->order[i];
        printf("  %5d %6d %12.3g %12.3g %12.3g %12.6g %10.3g\n", o->order, o->n, dif_deg_from_rad(o->mean_rad),
               dif_deg_from_rad(o->rms_rad), dif_deg_from_rad(o->worst_rad), dif_nm_from_um(o->period_mean_um),
               dif_nm_from_um(o->period_sd_um));
    }
}

static json_t *json_order(const dif_maxima_order *o)
{
    json_t *object = json_pack("{s:i, s:i}", "order", o->order, "n", o->n);
    json_object_set_new(object, "mean_deg", dif_json_number(dif_deg_from_rad(o->mean_rad)));
    json_object_set_new(object, "rms_deg", dif_json_number(dif_deg_from_rad(o->rms_rad)));
    json_object_set_new(object, "worst_deg", dif_json_number(dif_deg_from_rad(o->worst_rad)));
    json_object_set_new(object, "period_nm", dif_json_number(dif_nm_from_um(o->period_mean_um)));
    json_object_set_new(object, "period_sd_nm", dif_json_number(dif_nm_from_um(o->period_sd_um)));
    return object;
}

static json_t *json_maximum(const dif_maximum *m)
{
    json_t *object = json_pack("{s:i, s:b, s:b}", "order", m->order, "is_global", m->is_global, "at_edge", m->at_edge);
    json_object_set_new(object, "lambda_nm", dif_json_number(dif_nm_from_um(m->lambda_um)));
    json_object_set_new(object, "angle_deg", dif_json_number(dif_deg_from_rad(m->angle_rad)));
    json_object_set_new(object, "value", dif_json_number(m->value));
    json_object_set_new(object, "residual_deg", dif_json_number(dif_deg_from_rad(m->residual_rad)));
    json_object_set_new(object, "period_nm", dif_json_number(dif_nm_from_um(m->period_um)));
    return object;
}

static json_t *json_run(const maxima_run *run)
{
    const dif_maxima_period *first = &run->first;
    json_t *orders = json_array(), *maxima = json_array(), *period = json_pack("{s:i}", "n", first->n);
    json_object_set_new(period, "mean_nm", dif_json_number(dif_nm_from_um(first->mean_um)));
    json_object_set_new(period, "sd_nm", dif_json_number(dif_nm_from_um(first->sd_um)));
    json_object_set_new(period, "min_nm", dif_json_number(dif_nm_from_um(first->min_um)));
    json_object_set_new(period, "max_nm", dif_json_number(dif_nm_from_um(first->max_um)));
    for (int i = 0; i < run->n_order; i++)
        json_array_append_new(orders, json_order(&run->order[i]));
    for (int i = 0; i < run->maxima.n; i++)
        json_array_append_new(maxima, json_maximum(&run->maxima.item[i]));
    return json_pack("{s:o, s:o, s:o, s:o}", "provenance", dif_json_manifest(&run->manifest), "first_order", period,
                     "orders", orders, "maxima", maxima);
}

/* Exit 1 if some order's worst residual is over the limit. */
static int judge(const dif_cli *cli, const maxima_args *args, const maxima_run *run)
{
    for (int i = 0; !isnan(args->max_residual_deg) && i < run->n_order; i++) {
        const double worst_deg = fabs(dif_deg_from_rad(run->order[i].worst_rad));
        if (!(worst_deg <= args->max_residual_deg))
            return dif_cmd_outside(cli->verb,
                                   "%s: order %d is %.3g deg off, expected at most %.3g "
                                   "(--max-residual-deg)",
                                   cli->operand[0], run->order[i].order, worst_deg, args->max_residual_deg);
    }
    if (!isnan(args->max_residual_deg) && run->n_order == 0)
        return dif_cmd_outside(cli->verb, "%s: no maximum to judge, expected some (--floor-share)", cli->operand[0]);
    return DIF_EXIT_DONE;
}

static int execute(const dif_cli *cli, const maxima_args *args)
{
    dif_error err = {0};
    maxima_run run = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = find(cli, args, &run, &err);
    if (!status && args->out)
        status = write_csv(args, &run, &err);
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_run(&run));
    else if (!args->out || strcmp(args->out, "-") != 0)
        print_summary(cli, &run);
    if (code == DIF_EXIT_DONE)
        code = judge(cli, args, &run);
    dif_maxima_free(&run.maxima);
    dif_table_free(&run.table);
    dif_manifest_free(&run.own);
    dif_manifest_free(&run.manifest);
    return code;
}

int dif_cmd_maxima(int argc, char **argv)
{
    maxima_args args = {
        .period_nm = NAN, .max_residual_deg = NAN, .floor_share = dif_maxima_opts_default().floor_share};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    if (!isnan(args.max_residual_deg) && isnan(args.period_nm))
        return dif_cmd_usage(cli.verb, "--max-residual-deg without orders, expected --period-nm, too");
    return execute(&cli, &args);
}
