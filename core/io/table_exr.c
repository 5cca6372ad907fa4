/* Tables as EXR: x = angle, y = wavelength, one float channel named after the quantity, the axes as attributes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/table_impl.h"
#include "core/units.h"

#define ATTRIBUTE(key) DIF_EXR_PREFIX key
enum { KEY_SIZE = 64 };

char *dif_axis_print(const double *axis, int n, size_t (*print)(double, char[DIF_NUMBER_SIZE]))
{
    char *text = dif_alloc((size_t)n, DIF_NUMBER_SIZE);
    size_t at = 0;
    for (int i = 0; text && i < n; i++) {
        if (i > 0)
            text[at++] = ' ';
        at += print(axis[i], text + at);
    }
    return text;
}

static float *to_float(const dif_table *table)
{
    const size_t n = (size_t)table->plan.n_angle * (size_t)table->plan.n_lambda;
    float *pixel = dif_alloc(n, sizeof *pixel);
    for (size_t i = 0; pixel && i < n; i++)
        pixel[i] = (float)table->value[i];
    return pixel;
}

dif_status dif_table_exr_encode(const dif_table *table, const dif_manifest *manifest, unsigned char **data, size_t *n,
                                dif_error *err)
{
    const dif_plan *plan = &table->plan;
    *data = NULL;
    char *angles = dif_axis_print(plan->angle_rad, plan->n_angle, dif_table_print_deg);
    char *lambdas = dif_axis_print(plan->lambda_um, plan->n_lambda, dif_table_print_nm);
    float *pixel = to_float(table);
    dif_status status = DIF_OK;
    if (!angles || !lambdas || !pixel) {
        status = dif_fail(err, DIF_ERR_NOMEM, "EXR of %d x %d values", plan->n_angle, plan->n_lambda);
        goto cleanup;
    }
    char fixed[DIF_NUMBER_SIZE], azimuth[DIF_NUMBER_SIZE];
    dif_table_print_deg(plan->fixed_rad, fixed);
    dif_table_print_deg(plan->azimuth_rad, azimuth);
    const char *quantity = dif_quantity_name(table->quantity);
    const dif_exr_attribute attributes[] = {
        {ATTRIBUTE("layout"), "table: x = angle, y = wavelength", 0.0},
        {ATTRIBUTE("quantity"), quantity, 0.0},
        {ATTRIBUTE("quantity_unit"), dif_quantity_unit(table->quantity), 0.0},
        {ATTRIBUTE("fixed_angle"), plan->fixed_is_wo ? "theta_r" : "theta_i", 0.0},
        {ATTRIBUTE("fixed_deg"), fixed, 0.0},
        {ATTRIBUTE("azimuth_deg"), azimuth, 0.0},
        {ATTRIBUTE("angle_deg"), angles, 0.0},
        {ATTRIBUTE("lambda_nm"), lambdas, 0.0},
    };
    const dif_exr_layer layer = {quantity, pixel, 1};
    const dif_exr_image image = {.nx = plan->n_angle,
                                 .ny = plan->n_lambda,
                                 .layer = &layer,
                                 .n_layer = 1,
                                 .attribute = attributes,
                                 .n_attribute = sizeof attributes / sizeof *attributes,
                                 .manifest = manifest};
    status = dif_exr_encode(&image, data, n, err);
cleanup:
    dif_release(angles);
    dif_release(lambdas);
    dif_release(pixel);
    return status;
}

static const char *look_up(void *self, const char *key)
{
    char name[KEY_SIZE];
    snprintf(name, sizeof name, DIF_EXR_PREFIX "%s", key);
    return dif_exr_text(self, name);
}

dif_status dif_axis_read(const dif_source *source, const dif_exr *exr, const char *name, int n,
                         double (*convert)(double), double *axis, dif_error *err)
{
    const char *text = dif_exr_text(exr, name);
    if (!text)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no attribute %s: not written by diffbench", source->name, name);
    const char *end = text + strlen(text);
    int i = 0;
    for (; i < n; i++) {
        double value = 0.0;
        while (*text == ' ')
            text++;
        text = dif_number_parse(text, end, '.', &value);
        if (!text || !isfinite(value) || (*text && *text != ' '))
            break;
        axis[i] = convert(value);
    }
    while (text && *text == ' ')
        text++;
    if (i < n || *text)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s holds %s than %d numbers", source->name, name,
                        i < n ? "less" : "more", n);
    return DIF_OK;
}

static dif_status read_plan(const dif_source *source, dif_exr *exr, const dif_table_geometry *said, dif_plan *plan,
                            dif_error *err)
{
    plan->fixed_is_wo = said->fixed_is_wo;
    plan->fixed_rad = dif_rad_from_deg(said->fixed_deg);
    plan->azimuth_rad = dif_rad_from_deg(said->azimuth_deg);
    const dif_status status =
        dif_axis_read(source, exr, ATTRIBUTE("angle_deg"), plan->n_angle, dif_rad_from_deg, plan->angle_rad, err);
    if (status)
        return status;
    return dif_axis_read(source, exr, ATTRIBUTE("lambda_nm"), plan->n_lambda, dif_um_from_nm, plan->lambda_um, err);
}

/* Reads the geometry first: a picture that is no table is refused before its pixels are decoded. */
static dif_status read_table(const dif_source *source, dif_exr *exr, dif_table *table, dif_error *err)
{
    dif_table_geometry said;
    dif_plan plan = {0};
    float *pixel = NULL;
    char found[DIF_EXR_CHANNEL_SIZE];
    int nx = 0, ny = 0;
    dif_status status = dif_table_geometry_read(source, look_up, exr, &said, err);
    if (status)
        return status;
    if (!said.fixed_is_known || isnan(said.fixed_deg) || !said.quantity_is_known)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: EXR without %squantity, fixed_angle and fixed_deg: not a table",
                        source->name, DIF_EXR_PREFIX);
    dif_exr_size(exr, &nx, &ny);
    status = dif_plan_create(nx, ny, &plan, err);
    if (status)
        return dif_fail_named(err, source->name, status);
    status = read_plan(source, exr, &said, &plan, err);
    if (!status)
        status = dif_exr_read_channel(exr, dif_quantity_name(said.quantity), &pixel, found, err);
    if (!status)
        status = dif_table_create(&plan, said.quantity, table, err);
    for (size_t i = 0; !status && i < (size_t)nx * (size_t)ny; i++)
        table->value[i] = (double)pixel[i];
    dif_release(pixel);
    dif_plan_free(&plan);
    return status;
}

dif_status dif_table_exr_read(const dif_source *source, dif_table *table, dif_manifest *keys, dif_error *err)
{
    static const char *const SKIP[] = {NULL};
    dif_exr *exr = NULL;
    dif_status status = dif_exr_open(source, &exr, err);
    if (status)
        return status;
    status = read_table(source, exr, table, err);
    if (!status)
        status = dif_exr_take_manifest(exr, SKIP, keys, err);
    dif_exr_close(exr);
    return status;
}
