#include "bench/cli/compare_surface.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/folder.h"
#include "bench/cli/plane.h"
#include "core/grating.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

enum { WALL_SAMPLES = 1300 };

static const struct {
    dif_surface_kind kind;
    const char *title, *description;
} BUILT_IN[] = {
    {DIF_SURFACE_BLAZED, "Blazed grating", "Built-in synthetic surface: a sawtooth, 26 periods of 2500 nm."},
    {DIF_SURFACE_ELAPHE, "Snake-like surface, corn snake", "Built-in synthetic surface: irregular rows."},
    {DIF_SURFACE_XENOPELTIS, "Snake-like surface, sunbeam snake",
     "Built-in synthetic surface: fine ridges, twice as deep."},
};

int dif_compare_surface_built_in(void)
{
    return DIF_COUNT(BUILT_IN);
}

void dif_compare_surface_free(dif_compare_surface *surface)
{
    dif_field_free(&surface->field);
    dif_plan_free(&surface->plan);
    dif_manifest_free(&surface->manifest);
    dif_shadow_free(&surface->shadow);
}

static bool is_grating_kind(const char *kind)
{
    dif_profile profile;
    return kind && dif_profile_from_name(kind, &profile);
}

static dif_status load_built_in(const dif_cli *cli, int i, dif_compare_surface *out, dif_error *err)
{
    dif_surface surface = dif_surface_default(BUILT_IN[i].kind);
    const char *name = dif_surface_kind_name(surface.kind);
    if (surface.kind == DIF_SURFACE_BLAZED) { /* 50 samples a period: every wall stands between two pixels */
        surface.nx = surface.ny = WALL_SAMPLES;
        surface.pitch_um = 65.0 / WALL_SAMPLES;
    }
    snprintf(out->title, sizeof out->title, "%s", BUILT_IN[i].title);
    snprintf(out->slug, sizeof out->slug, "%s", name);
    snprintf(out->description, sizeof out->description, "%s", BUILT_IN[i].description);
    out->is_grating = out->has_period = is_grating_kind(name);
    out->opts.period_um = out->has_period ? surface.period_um : (double)NAN;
    out->opts.psi_rad = surface.psi_rad;
    dif_status status = dif_surface_make(&surface, &out->field, err);
    if (!status)
        status = dif_cli_manifest(cli, NULL, &out->manifest, err);
    if (!status)
        status = dif_manifest_set(&out->manifest, "fixture", name, err);
    const dif_field_file file = {.field = out->field, .format = "built-in fixture"};
    return status ? status : dif_cli_manifest_surface(&out->manifest, &file, err);
}

/* The fit of all harmonics takes seconds: only for methods that replicate a period. */
static bool wants_period(const dif_compare_args *args)
{
    bool method[DIF_REGRESS_METHODS];
    char unknown[32];
    (void)dif_compare_methods_parse(args->methods, method, unknown);
    return isnan(args->period_nm) && (method[2] || method[3]); /* nmm-lines, pq */
}

static dif_status load_file(const dif_cli *cli, const dif_compare_args *args, int i, dif_compare_surface *out,
                            dif_error *err)
{
    const char *path = cli->operand[i], *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    dif_field_file file;
    dif_status status = dif_cli_surface_read(cli, path, &args->surface, &file, err);
    if (status)
        return status;
    snprintf(out->title, sizeof out->title, "%s", name);
    dif_folder_slug(path, i + 1, cli->n_operand, out->slug);
    snprintf(out->description, sizeof out->description, "Surface read from a %s file, %d × %d samples. %s", file.format,
             file.field.nx, file.field.ny, file.warning);
    out->is_grating = is_grating_kind(dif_cli_fixture_name(&file));
    status = dif_cli_manifest(cli, path, &out->manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(&out->manifest, &file, err);
    if (!status && out->is_grating && wants_period(args)) {
        dif_error why;
        const dif_status found = dif_measure_find_period(&file.field, &out->opts, &why);
        out->has_period = found == DIF_OK; /* without one, what needs it is left out */
        if (found == DIF_ERR_NOMEM)
            status = dif_fail(err, found, "%s", why.text);
    }
    out->field = file.field;
    file.field = (dif_field){0};
    dif_field_file_free(&file);
    return status;
}

/* The user's word about the period comes first; stam alone makes do with the strongest structure. */
static void choose_period(const dif_compare_args *args, const dif_cli_plane *plane, dif_compare_surface *out)
{
    if (!isnan(args->period_nm)) {
        out->opts.period_um = dif_um_from_nm(args->period_nm);
        out->opts.psi_rad = plane->has_structure ? plane->structure.psi_rad : 0.0;
        out->has_period = true;
    } else if (isnan(out->opts.period_um) && plane->has_structure) {
        out->opts.period_um = plane->structure.period_um;
        out->opts.psi_rad = plane->structure.psi_rad;
    }
    if (!isnan(args->groove_deg))
        out->opts.psi_rad = dif_rad_from_deg(args->groove_deg);
}

/* Shadowing, from this surface's own slopes. */
static dif_status prepare_shadow(dif_shadowing kind, dif_compare_surface *out, dif_error *err)
{
    if (kind == DIF_SHADOWING_NONE)
        return DIF_OK;
    const dif_status status = dif_shadow_create(kind, &out->field, &out->shadow, err);
    out->opts.shadow = &out->shadow;
    return status ? status : dif_manifest_set(&out->manifest, "shadowing", dif_shadowing_name(kind), err);
}

dif_status dif_compare_surface_load(const dif_cli *cli, const dif_compare_args *args, int i, dif_compare_surface *out,
                                    dif_error *err)
{
    dif_cli_plane plane;
    *out = (dif_compare_surface){.opts = dif_measure_opts_default()};
    out->opts.window = (dif_window_kind)args->window;
    out->opts.sigma_um = args->sigma_um;
    out->opts.average = (dif_average)args->average;
    out->opts.index = (dif_index){args->index_n, args->index_kappa};
    out->opts.n_thread = cli->n_thread;
    dif_status status = cli->n_operand > 0 ? load_file(cli, args, i, out, err) : load_built_in(cli, i, out, err);
    if (!status)
        status = prepare_shadow((dif_shadowing)args->shadowing, out, err);
    if (status)
        return status;
    const dif_spectrum_peak known = {.period_um = out->opts.period_um, .psi_rad = out->opts.psi_rad};
    status = dif_cli_plane_choose(&out->field, out->has_period ? &known : NULL, out->is_grating, args->sigma_um,
                                  args->azimuth_deg, &plane, err);
    if (status)
        return status;
    choose_period(args, &plane, out);
    out->f_min_per_um = plane.f_min_per_um;
    out->f_max_per_um = plane.f_max_per_um;
    return dif_scan_plan(false, args->theta_i_deg, plane.azimuth_deg, &args->angle_deg, &args->lambda_nm, &out->plan,
                         err);
}
