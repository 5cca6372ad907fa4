/* diffbench orders: the grating equation and the closed-form efficiencies of named profiles. */
#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "bench/cli/csv_out.h"
#include "bench/scan.h"
#include "core/brdf.h"
#include "core/grating.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "",
    "Lists the diffraction orders of a grating: (sin theta_i + sin theta_m) d = m lambda, conical incidence included.\n"
    "m = 0 is the mirror direction, m > 0 lies towards the light from it. Evanescent orders are marked (propagates "
    "0);\n"
    "without --order-range the first one on either side is listed. With a profile: |c_m|^2 (power), the efficiency "
    "and\n"
    "the sum of the efficiencies of all propagating orders, scalar theory, never rescaled.\n",
    "  diffbench orders --period-nm 2500 --profile blazed --height-nm 250 --theta-i-deg 75 --lambda-nm 550\n",
};

enum { ORDER_ROWS_MAX = 10000000 };

typedef struct orders_args {
    double period_nm, theta_i_deg, phi_i_deg, psi_deg, height_nm, duty, index_n, index_kappa;
    dif_range lambda_nm, order;
    int profile;
    const char *out;
    bool queries;
} orders_args;

static void add_options(dif_cli *cli, orders_args *args)
{
    const dif_opt opts[] = {
        {"Grating and light", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"period-nm", DIF_OPT_REAL, &args->period_nm, "(0, inf)", "NM", "grating period d (needed)", NULL},
        {"theta-i-deg", DIF_OPT_REAL, &args->theta_i_deg, "(-90, 90)", "DEG", "angle of incidence (needed)", NULL},
        {"phi-i-deg", DIF_OPT_REAL, &args->phi_i_deg, "[-360, 360]", "DEG", "its azimuth (default 0)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP", "wavelengths, or one (needed)",
         NULL},
        {"psi-deg", DIF_OPT_REAL, &args->psi_deg, "[-360, 360]", "DEG", "azimuth of the groove normal (default 0)",
         NULL},
        {"order-range", DIF_OPT_RANGE, &args->order, "[-100000, 100000]", "MIN:MAX:1", "orders to list", NULL},
        {"Profile (for efficiencies)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"profile", DIF_OPT_CHOICE, &args->profile, "sine|blazed|triangle|lamellar", NULL, "shape of a groove", NULL},
        {"height-nm", DIF_OPT_REAL, &args->height_nm, "[0, inf)", "NM", "peak to valley", NULL},
        {"duty", DIF_OPT_REAL, &args->duty, "(0, 1)", "D", "lamellar: share of the period that is high (default 0.5)",
         NULL},
        {"n", DIF_OPT_REAL, &args->index_n, "(0, inf)", "N", "refractive index (default: perfect conductor)", NULL},
        {"kappa", DIF_OPT_REAL, &args->index_kappa, "[0, inf)", "K", "its extinction (default 0)", NULL},
        {"Output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F.csv", "where to write (default: stdout)", NULL},
        {"queries", DIF_OPT_FLAG, &args->queries, NULL, NULL, "the propagating orders as queries for `diffbench eval`",
         NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static int check(const dif_cli *cli, const orders_args *args)
{
    if (isnan(args->period_nm))
        return dif_cmd_usage(cli->verb, "no grating, expected --period-nm");
    if (isnan(args->theta_i_deg))
        return dif_cmd_usage(cli->verb, "no angle of incidence, expected --theta-i-deg");
    if (args->lambda_nm.n == 0)
        return dif_cmd_usage(cli->verb, "no wavelength, expected --lambda-nm");
    if (args->profile >= 0 && isnan(args->height_nm))
        return dif_cmd_usage(cli->verb, "--profile without its height, expected --height-nm");
    if (!isnan(args->index_kappa) && isnan(args->index_n))
        return dif_cmd_usage(cli->verb, "--kappa without --n, expected both");
    const dif_range *order = &args->order;
    if (order->n > 1 && (order->step != 1.0 || order->min != floor(order->min)))
        return dif_cmd_usage(cli->verb, "--order-range: orders are whole numbers, expected MIN:MAX:1");
    return DIF_CLI_GO;
}

/* One order at one wavelength. */
typedef struct order_row {
    double lambda_nm;
    int order;
    bool propagates;
    double theta_deg, phi_deg; /* NaN if evanescent                                      */
    double angle_deg;          /* signed, in the plane of incidence; NaN out of that plane */
    double power, efficiency;  /* NaN without a profile                                   */
} order_row;

typedef struct orders_run {
    const orders_args *args;
    dif_grating grating;
    dif_vec3 wi;
    dif_manifest manifest;
} orders_run;

static double reflectance(const orders_args *args, dif_vec3 wi, dif_vec3 wm)
{
    if (isnan(args->index_n))
        return 1.0;
    const double kappa = isnan(args->index_kappa) ? 0.0 : args->index_kappa;
    return dif_brdf_reflectance((dif_index){.n = args->index_n, .kappa = kappa}, wi, wm);
}

/* Signed angle of wm in the plane of incidence, NaN if it lies outside of it. */
static double in_plane_deg(dif_vec3 wm, double phi_i_deg)
{
    const double c = cos(dif_rad_from_deg(phi_i_deg)), s = sin(dif_rad_from_deg(phi_i_deg));
    const double along = wm.x * c + wm.y * s, across = wm.y * c - wm.x * s;
    return fabs(across) < 1e-12 ? dif_deg_from_rad(asin(along)) : (double)NAN;
}

static order_row row_of(const orders_run *run, double lambda_nm, int m)
{
    const orders_args *args = run->args;
    const double lambda_um = dif_um_from_nm(lambda_nm), nan = (double)NAN;
    dif_vec3 wm;
    order_row row = {lambda_nm, m, false, nan, nan, nan, nan, nan};
    row.propagates = dif_grating_direction(run->wi, run->grating.period_um, run->grating.psi_rad, lambda_um, m, &wm);
    if (!row.propagates) {
        row.efficiency = args->profile >= 0 ? 0.0 : nan;
        return row;
    }
    const double sin_m = hypot(wm.x, wm.y);
    row.theta_deg = dif_deg_from_rad(atan2(sin_m, wm.z));
    row.phi_deg = sin_m > 0.0 ? dif_deg_from_rad(atan2(wm.y, wm.x)) : 0.0;
    row.angle_deg = in_plane_deg(wm, args->phi_i_deg);
    if (args->profile < 0)
        return row;
    const double kw = -DIF_TWO_PI / lambda_um * (run->wi.z + wm.z);
    row.power = dif_grating_power(&run->grating, m, kw);
    row.efficiency = dif_grating_efficiency(&run->grating, run->wi, lambda_um, reflectance(args, run->wi, wm), m);
    return row;
}

/* The orders to list at one wavelength; false if there are none. */
static bool listed(const orders_run *run, double lambda_nm, int *first, int *last)
{
    const dif_range *order = &run->args->order;
    if (order->n > 0) {
        *first = (int)order->min;
        *last = (int)order->max;
        return true;
    }
    if (!dif_grating_order_range(run->wi, run->grating.period_um, run->grating.psi_rad, dif_um_from_nm(lambda_nm),
                                 first, last))
        return false;
    *first -= 1;
    *last += 1;
    return true;
}

static double efficiency_sum(const orders_run *run, double lambda_nm)
{
    int first = 0, last = -1;
    double sum = 0.0;
    if (!dif_grating_order_range(run->wi, run->grating.period_um, run->grating.psi_rad, dif_um_from_nm(lambda_nm),
                                 &first, &last))
        return 0.0;
    for (int m = first; m <= last; m++)
        sum += row_of(run, lambda_nm, m).efficiency;
    return sum;
}

static void print_row(FILE *stream, const orders_run *run, const order_row *row, double sum)
{
    const orders_args *args = run->args;
    if (args->queries) {
        if (row->propagates)
            fprintf(stream, "%.12g,%.12g,%.12g,%.12g,%.12g\n", args->theta_i_deg, args->phi_i_deg, row->theta_deg,
                    row->phi_deg, row->lambda_nm);
        return;
    }
    fprintf(stream, "%.12g,%d,%d,%.12g,%.12g,%.12g", row->lambda_nm, row->order, row->propagates, row->theta_deg,
            row->phi_deg, row->angle_deg);
    if (args->profile >= 0)
        fprintf(stream, ",%.12g,%.12g,%.12g", row->power, row->efficiency, sum);
    fputc('\n', stream);
}

static void print_csv(FILE *stream, const orders_run *run)
{
    const orders_args *args = run->args;
    dif_csv_out_provenance(stream, &run->manifest);
    if (args->queries)
        fprintf(stream, "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n");
    else
        fprintf(stream, "lambda_nm,order,propagates,theta_r_deg,phi_r_deg,angle_deg%s\n",
                args->profile >= 0 ? ",power,efficiency,efficiency_sum" : "");
    for (int i = 0; i < args->lambda_nm.n; i++) {
        const double lambda_nm = dif_range_at(&args->lambda_nm, i);
        const double sum = args->profile >= 0 ? efficiency_sum(run, lambda_nm) : 0.0;
        int first = 0, last = -1;
        if (!listed(run, lambda_nm, &first, &last))
            continue;
        for (int m = first; m <= last; m++) {
            const order_row row = row_of(run, lambda_nm, m);
            print_row(stream, run, &row, sum);
        }
    }
}

static json_t *json_order(const order_row *row, bool has_profile)
{
    json_t *object = json_pack("{s:i, s:b}", "order", row->order, "propagates", row->propagates);
    json_object_set_new(object, "theta_r_deg", dif_json_number(row->theta_deg));
    json_object_set_new(object, "phi_r_deg", dif_json_number(row->phi_deg));
    json_object_set_new(object, "angle_deg", dif_json_number(row->angle_deg));
    if (has_profile) {
        json_object_set_new(object, "power", dif_json_number(row->power));
        json_object_set_new(object, "efficiency", dif_json_number(row->efficiency));
    }
    return object;
}

static json_t *json_wavelength(const orders_run *run, double lambda_nm)
{
    const bool has_profile = run->args->profile >= 0;
    json_t *object = json_object(), *orders = json_array();
    int first = 0, last = -1;
    json_object_set_new(object, "lambda_nm", dif_json_number(lambda_nm));
    if (has_profile)
        json_object_set_new(object, "efficiency_sum", dif_json_number(efficiency_sum(run, lambda_nm)));
    if (listed(run, lambda_nm, &first, &last))
        for (int m = first; m <= last; m++) {
            const order_row row = row_of(run, lambda_nm, m);
            json_array_append_new(orders, json_order(&row, has_profile));
        }
    json_object_set_new(object, "orders", orders);
    return object;
}

static json_t *json_run(const orders_run *run)
{
    json_t *list = json_array();
    for (int i = 0; i < run->args->lambda_nm.n; i++)
        json_array_append_new(list, json_wavelength(run, dif_range_at(&run->args->lambda_nm, i)));
    return json_pack("{s:o, s:o}", "provenance", dif_json_manifest(&run->manifest), "wavelengths", list);
}

/* Refuses what would print without end: a period of kilometres has billions of orders. */
static dif_status check_count(const orders_run *run, dif_error *err)
{
    const dif_range *lambda = &run->args->lambda_nm;
    int first = 0, last = -1;
    (void)listed(run, lambda->min, &first, &last);
    const double n = ((double)last - (double)first + 1.0) * lambda->n;
    if (n > ORDER_ROWS_MAX || 2.0 * run->args->period_nm / lambda->min > ORDER_ROWS_MAX)
        return dif_fail(err, DIF_ERR_ARG,
                        "over %d rows, expected fewer orders or wavelengths (--order-range, --lambda-nm)",
                        ORDER_ROWS_MAX);
    return DIF_OK;
}

static int execute(const dif_cli *cli, const orders_args *args)
{
    dif_error err = {0};
    dif_csv_out out = {0};
    orders_run run = {
        .args = args,
        .grating = {.profile = (dif_profile)(args->profile >= 0 ? args->profile : 0),
                    .period_um = dif_um_from_nm(args->period_nm),
                    .height_um = isnan(args->height_nm) ? 0.0 : dif_um_from_nm(args->height_nm),
                    .duty = args->duty,
                    .psi_rad = dif_rad_from_deg(args->psi_deg)},
        .wi = dif_vec3_from_angles_rad(dif_rad_from_deg(args->theta_i_deg), dif_rad_from_deg(args->phi_i_deg)),
    };
    int code = DIF_EXIT_DONE;
    dif_status status = check_count(&run, &err);
    if (!status)
        status = dif_cli_manifest(cli, NULL, &run.manifest, &err);
    if (!status && (args->out || !cli->json)) {
        status = dif_csv_out_open(args->out, &out, &err);
        if (!status) {
            print_csv(out.stream, &run);
            status = dif_csv_out_close(&out, &err);
        }
    }
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_run(&run));
    dif_manifest_free(&run.manifest);
    return code;
}

int dif_cmd_orders(int argc, char **argv)
{
    const double none = (double)NAN;
    orders_args args = {.period_nm = none,
                        .theta_i_deg = none,
                        .height_nm = none,
                        .duty = 0.5,
                        .index_n = none,
                        .index_kappa = none,
                        .profile = -1};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    int code = dif_cli_parse(&cli, 0, 0);
    if (code == DIF_CLI_GO)
        code = check(&cli, &args);
    return code == DIF_CLI_GO ? execute(&cli, &args) : code;
}
