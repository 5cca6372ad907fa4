/* The options of `render`. */
#include "bench/cli/render.h"

static void add_scene_options(dif_cli *cli, dif_render_args *args)
{
    const dif_opt opts[] = {
        {"Scene", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"mesh", DIF_OPT_TEXT, &args->mesh, NULL, "M", "plane, disc, cylinder, sphere, snake (default) or FILE.obj",
         NULL},
        {"detail", DIF_OPT_INT, &args->detail, "[1, 16]", "N", "fineness of a built-in mesh (default 2)", NULL},
        {"groove-deg", DIF_OPT_REAL, &args->groove_deg, "[-360, 360]", "DEG",
         "turns the patch on the mesh, counter-clockwise seen from outside (default 0; snake 90)", NULL},
        {"camera", DIF_OPT_TEXT, &args->camera, NULL, "THETA,PHI[,DISTANCE]",
         "degrees, and the distance in radii of the mesh (default: by mesh, and what shows it all)", NULL},
        {"fov-deg", DIF_OPT_REAL, &args->fov_deg, "[1, 150]", "DEG", "field of view, top to bottom (default 30)", NULL},
        {"light-deg", DIF_OPT_LIST, &args->light_deg, NULL, "THETA,PHI",
         "direction to a distant light; up to 8 times (default: by mesh)", NULL},
        {"base-colour", DIF_OPT_TEXT, &args->base_colour, NULL, "F.png|RRGGBB",
         "diffuse colour under the diffraction, a picture in texture coordinates or one colour (default: black)", NULL},
        {"turntable", DIF_OPT_INT, &args->n_turn, "[2, 10000]", "N", "N frames of one turn about the vertical", NULL},
        {"light-sweep", DIF_OPT_RANGE, &args->sweep_deg, "[-180, 180]", "A:B:STEP",
         "a frame for each theta of the first light", &args->has_sweep},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static void add_method_options(dif_cli *cli, dif_render_args *args)
{
    dif_cli_measure *measure = &args->measure;
    const dif_opt opts[] = {
        {"Method", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"method", DIF_OPT_CHOICE, &args->method, "lut|sheet|nmm|stam", NULL,
         "lut: the integrated table (default); sheet: every wavelength; nmm: few; stam: bumps without a profile", NULL},
        {"tol", DIF_OPT_REAL, &measure->tol, "[1e-14, 1)", "TOL", "wanted amplitude error (default 1e-4)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP", "wavelengths (default 380:780:5)",
         NULL},
        {"sigma-um", DIF_OPT_REAL, &measure->sigma_um, "(0, inf)", "UM", "of the coherence window (default 16.25)",
         NULL},
        {"average", DIF_OPT_CHOICE, &measure->average, "none|welch", NULL,
         "none: one window, whose speckle shows; welch (default): what a pixel with many windows sees", NULL},
        {"grating-nm", DIF_OPT_REAL, &measure->period_nm, "(0, inf)", "NM",
         "stam: the period along the patch's x (default: fitted to the heights)", NULL},
        {"azimuths", DIF_OPT_INT, &args->n_azimuth, "[16, 16384]", "N", "lut: columns (default 4096)", NULL},
        {"radii", DIF_OPT_INT, &args->n_radius, "[8, 4096]", "N", "lut: rows (default 320)", NULL},
        {"source-deg", DIF_OPT_REAL, &args->source_deg, "[0, 28]", "DEG",
         "lut: angular diameter of the light (default 0.53, the sun; with --contact-sheet 0)", NULL},
        {"shadowing", DIF_OPT_CHOICE, &args->shadowing, "none|vcavity|smith|ndf", NULL,
         "shadowing and masking (default vcavity)", NULL},
        {"n", DIF_OPT_REAL, &measure->index_n, "(0, inf)", "N", "refractive index (default 1.5)", NULL},
        {"kappa", DIF_OPT_REAL, &measure->index_kappa, "[0, inf)", "K", "its extinction (default 0)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static void add_filter_options(dif_cli *cli, dif_render_args *args)
{
    const dif_opt opts[] = {
        {"Filter", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"mesostructure", DIF_OPT_TEXT, &args->meso, NULL, "F",
         "heights between mesh and surface (scales, wrinkles), a tile in texture coordinates whose slopes tilt the "
         "surface",
         NULL},
        {"meso-tiles", DIF_OPT_REAL, &args->meso_tiles, "(0, inf)", "T", "tiles in a unit of u and v (default 4)",
         NULL},
        {"meso-scale", DIF_OPT_REAL, &args->meso_scale, "(-inf, inf)", "S", "factor on its slopes (default 1)", NULL},
        {"meso-pixel-um", DIF_OPT_REAL, &args->meso_pixel_um, "(0, inf)", "UM",
         "distance of its samples, if it has none", NULL},
        {"meso-height-um", DIF_OPT_REAL, &args->meso_height_um, "(0, inf)", "UM", "height range of an image", NULL},
        {"filter", DIF_OPT_CHOICE, &args->filter, "none|mip|slopes|supersample", NULL,
         "what happens to slopes within a pixel. none (default): they alias; mip: their mean; slopes: the table "
         "averaged over "
         "those that are seen; supersample: 32 x 32 random samples, the truth",
         NULL},
        {"filter-study", DIF_OPT_TEXT, &args->study, NULL, "DIR",
         "instead of --out: all filters at zooms 1, 4, 16, 64 against supersampling, filters.png and filters.csv",
         NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static void add_picture_options(dif_cli *cli, dif_render_args *args)
{
    const dif_opt opts[] = {
        {"Picture", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F", "F.png or F.exr (needed)", NULL},
        {"size", DIF_OPT_TEXT, &args->size, NULL, "WxH", "pixels (default 1280x720)", NULL},
        {"samples", DIF_OPT_INT, &args->n_sub, "[1, 64]", "N",
         "N x N samples a pixel (default 2; --filter supersample 32)", NULL},
        {"exposure", DIF_OPT_TEXT, &args->exposure, NULL, "V",
         "factor on the diffracted light, 1 shows a mirror under one light as white; auto (default): 2 % of the mesh's "
         "pixels are above white; frames of one run share the first one's",
         NULL},
        {"gamut", DIF_OPT_CHOICE, &args->gamut, "clip|desaturate", NULL,
         "colours that sRGB lacks are cut off, or mixed with the grey of their luminance (default)", NULL},
        {"ground", DIF_OPT_REAL, &args->ground, "[0, 1]", "Y", "PNG: grey behind the mesh, linear (default 0.01)",
         NULL},
        {"contact-sheet", DIF_OPT_FLAG, &args->contact_sheet, NULL, NULL,
         "lut, sheet, nmm and stam side by side; F.png", NULL},
        {"cpu", DIF_OPT_FLAG, &args->cpu, NULL, NULL, "render in double precision on the CPU, not on the GPU", NULL},
        {"require-hardware", DIF_OPT_FLAG, &args->require_hardware, NULL, NULL,
         "a software renderer instead of a GPU is an error (exit 4)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

void dif_render_add_options(dif_cli *cli, dif_render_args *args)
{
    add_scene_options(cli, args);
    add_method_options(cli, args);
    add_filter_options(cli, args);
    add_picture_options(cli, args);
    dif_cli_add_surface(cli, &args->surface);
}
