/* gpu/gpu_render against core/shade: the same scene drawn twice. */
#include "gpu/gpu_render.h"

#include <stdlib.h>
#include <string.h>

#include "core/colour.h"
#include "core/units.h"
#include "fixtures/meshes.h"
#include "fixtures/surfaces.h"
#include "gpu/egl_ctx.h"
#include "tests/near.h"

enum { NX = 96, NY = 64 };

typedef struct stage {
    dif_gpu *gpu;
    dif_lut lut;
    dif_field field;
    dif_model model;
    dif_evaluator cpu;
    dif_shadow vcavity;
} stage;

static int set_up(void **state)
{
    stage *s = test_calloc(1, sizeof *s);
    dif_error err = {0};
    dif_surface surface = dif_surface_default(DIF_SURFACE_XENOPELTIS);
    dif_window window = {.kind = DIF_WINDOW_GAUSS, .sigma_um = 3.0};
    dif_lut_opts opts = dif_lut_opts_default();
    double lambda_um[9];
    const double share = 1.0;
    surface.nx = surface.ny = 128;
    surface.pitch_um = 0.1;
    opts.n_azimuth = 512;
    opts.n_radius = 128;
    for (int i = 0; i < 9; i++)
        lambda_um[i] = 0.4 + 0.04 * i;
    *state = s;
    if (dif_surface_make(&surface, &s->field, &err) ||
        dif_lut_create(&s->field, 1, &window, &share, 9, lambda_um, 1e-4, &opts, &s->lut, &err) ||
        dif_gpu_open(NULL, &s->gpu, &err)) {
        print_message("%s: skipping\n", err.text);
        return 0;
    }
    s->model =
        (dif_model){.kind = DIF_MODEL_LUT, .lut = &s->lut, .quantity = DIF_QUANTITY_RHO, .index = dif_index_default()};
    s->vcavity = (dif_shadow){.kind = DIF_SHADOWING_VCAVITY};
    return dif_cpu_evaluator_open(&s->model, &s->cpu, &err) != DIF_OK;
}

static int tear_down(void **state)
{
    stage *s = *state;
    dif_evaluator_close(&s->cpu);
    dif_lut_free(&s->lut);
    dif_field_free(&s->field);
    dif_gpu_close(s->gpu);
    test_free(s);
    return 0;
}

static dif_scene scene_of(const dif_mesh *mesh)
{
    dif_vec3 centre;
    double radius;
    dif_mesh_bounds(mesh, &centre, &radius);
    const double distance = radius * dif_camera_distance(1.0, 0.5, 1.5);
    return (dif_scene){.mesh = mesh,
                       .camera = dif_camera_orbit(centre, distance, 0.9, -1.2, 0.5),
                       .n_light = 2,
                       .light = {dif_vec3_from_angles_rad(0.5, 0.5), dif_vec3_from_angles_rad(0.8, -2.0)},
                       .groove_rad = 0.6,
                       .base_rgb = {0.1, 0.2, 0.3}};
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* 95th percentile and largest colour difference of what is shown, where both see the mesh whole and away from edges. */
static double compare(const dif_frame *a, const dif_frame *b, double *worst)
{
    static double de[NX * NY];
    const double exposure = dif_frame_exposure(a, DIF_FRAME_EXPOSURE_SHARE);
    int n = 0;
    for (int iy = 1; iy < NY - 1; iy++)
        for (int ix = 1; ix < NX - 1; ix++) {
            bool inside = true;
            for (int k = 0; k < 9; k++) {
                const int at = (iy + k / 3 - 1) * NX + ix + k % 3 - 1;
                inside = inside && a->coverage[at] > 0.999F && b->coverage[at] > 0.999F;
            }
            if (!inside)
                continue;
            double lab[2][3];
            for (int f = 0; f < 2; f++) {
                double rgb[3], xyz[3];
                const size_t at = 3 * (size_t)(iy * NX + ix);
                for (size_t c = 0; c < 3; c++)
                    rgb[c] = exposure * (double)(f ? b : a)->light[at + c] + (double)(f ? b : a)->base[at + c];
                dif_colour_fit_gamut(DIF_GAMUT_DESATURATE, rgb);
                dif_colour_xyz_from_rgb(rgb, xyz);
                dif_colour_lab_from_xyz(xyz, lab[f]);
            }
            de[n++] = dif_colour_difference_2000(lab[0], lab[1]);
        }
    assert_at_most(300, n);
    qsort(de, (size_t)n, sizeof *de, by_size);
    *worst = de[n - 1];
    return de[95 * n / 100];
}

static void draw_both(stage *s, const dif_scene *scene, const dif_shade_opts *opts, dif_frame *cpu, dif_frame *gpu)
{
    dif_gpu_renderer *renderer;
    dif_error err = {0};
    dif_eval_cost cost;
    assert_int_equal(dif_frame_create(NX, NY, cpu, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, gpu, NULL), DIF_OK);
    assert_int_equal(dif_shade_draw(scene, &s->cpu, opts, cpu, NULL, NULL), DIF_OK);
    dif_status status = dif_gpu_renderer_open(s->gpu, &s->lut, s->model.index, scene->mesh, scene->base, opts->shadow,
                                              NULL, &renderer, &err);
    if (status == DIF_OK)
        status = dif_gpu_renderer_draw(renderer, scene, opts, gpu, &cost, &err);
    if (status != DIF_OK)
        print_error("%s\n", err.text);
    assert_int_equal(status, DIF_OK);
    assert_true(cost.run_s > 0.0);
    dif_gpu_renderer_close(renderer);
}

static void test_draw__every_mesh_as_on_the_cpu(void **state)
{
    static const dif_mesh_kind kinds[] = {DIF_MESH_PLANE, DIF_MESH_DISC, DIF_MESH_CYLINDER, DIF_MESH_SPHERE,
                                          DIF_MESH_SNAKE};
    stage *s = *state;
    if (!s->gpu)
        skip();
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        dif_mesh mesh;
        dif_frame cpu, gpu;
        dif_shade_opts opts = dif_shade_opts_default();
        double worst = 0.0, sum[2] = {0.0, 0.0};
        opts.shadow = &s->vcavity;
        opts.n_sub = k == 0 ? 2 : 1;
        assert_int_equal(dif_mesh_make(kinds[k], 1, &mesh, NULL), DIF_OK);
        const dif_scene scene = scene_of(&mesh);
        draw_both(s, &scene, &opts, &cpu, &gpu);
        const double p95 = compare(&cpu, &gpu, &worst);
        print_message("%-8s p95 %.4f, worst %.4f\n", dif_mesh_kind_name(kinds[k]), p95, worst);
        /* float interpolation of normals: 1e-6 rad against lines of 0.02 rad; the worst pixel holds another triangle */
        assert_at_most(p95, 0.05);
        assert_at_most(worst, 3.0);
        for (int i = 0; i < NX * NY; i++) {
            sum[0] += (double)cpu.coverage[i];
            sum[1] += (double)gpu.coverage[i];
        }
        assert_near(sum[1], sum[0], 2e-3, 3.0);
        dif_frame_free(&cpu);
        dif_frame_free(&gpu);
        dif_mesh_free(&mesh);
    }
}

static void test_draw__masking_tables_and_base_textures(void **state)
{
    static const dif_shadowing kinds[] = {DIF_SHADOWING_SMITH, DIF_SHADOWING_NDF};
    stage *s = *state;
    float rgb[16 * 8 * 3];
    const dif_texture base = {16, 8, rgb};
    if (!s->gpu)
        skip();
    for (int i = 0; i < 16 * 8 * 3; i++)
        rgb[i] = 0.02F * (float)(i * 7 % 31);
    for (size_t k = 0; k < 2; k++) {
        dif_mesh mesh;
        dif_frame cpu, gpu;
        dif_shadow shadow;
        dif_shade_opts opts = dif_shade_opts_default();
        double worst = 0.0;
        assert_int_equal(dif_shadow_create(kinds[k], &s->field, &shadow, NULL), DIF_OK);
        opts.shadow = &shadow;
        assert_int_equal(dif_mesh_make(DIF_MESH_SPHERE, 2, &mesh, NULL), DIF_OK);
        dif_scene scene = scene_of(&mesh);
        scene.base = &base;
        draw_both(s, &scene, &opts, &cpu, &gpu);
        /* half floats: 5e-4 of a base, which is 0.1 in CIEDE2000; filtering of textures has 8 bits of place */
        assert_at_most(compare(&cpu, &gpu, &worst), 0.5);
        assert_at_most(worst, 5.0);
        dif_frame_free(&cpu);
        dif_frame_free(&gpu);
        dif_shadow_free(&shadow);
        dif_mesh_free(&mesh);
    }
}

/* All filters, with relief and without, near and far. */
static void test_draw__filters_as_on_the_cpu(void **state)
{
    static const dif_filter filters[] = {DIF_FILTER_NONE, DIF_FILTER_MIP, DIF_FILTER_SLOPES};
    stage *s = *state;
    dif_field field;
    dif_meso meso;
    dif_mesh mesh;
    dif_lut_filter blurred;
    if (!s->gpu)
        skip();
    dif_surface rough = dif_surface_default(DIF_SURFACE_RANDOM);
    rough.nx = rough.ny = 64;
    rough.pitch_um = 1.0;
    rough.height_um = 0.3;
    rough.correlation_um = 7.0;
    assert_int_equal(dif_surface_make(&rough, &field, NULL), DIF_OK);
    assert_int_equal(dif_lut_filter_create(&s->lut, 128, &blurred, NULL), DIF_OK);
    assert_int_equal(dif_mesh_make(DIF_MESH_SPHERE, 2, &mesh, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh);
    for (int k = 0; k < 9; k++) {
        static const double tiles[] = {0.25, 3.0, 60.0};
        dif_frame cpu, gpu;
        dif_shade_opts opts = dif_shade_opts_default();
        double worst = 0.0;
        assert_int_equal(dif_meso_create(&field, 1.0, tiles[k / 3], &meso, NULL), DIF_OK);
        opts.filter = filters[k % 3];
        opts.meso = &meso;
        opts.blurred = &blurred;
        opts.shadow = &s->vcavity;
        opts.n_sub = k == 2 ? 2 : 1;
        draw_both(s, &scene, &opts, &cpu, &gpu);
        const double p95 = compare(&cpu, &gpu, &worst);
        print_message("tiles %-4g filter %d: p95 %.4f, worst %.4f\n", tiles[k / 3], k % 3, p95, worst);
        /* 8 bits of place in filtered textures; derivatives are differences of a quad; 60 tiles: 32 bits of uv */
        assert_at_most(p95, 0.5);
        dif_frame_free(&cpu);
        dif_frame_free(&gpu);
        dif_meso_free(&meso);
    }
    dif_lut_filter_free(&blurred);
    dif_mesh_free(&mesh);
    dif_field_free(&field);
}

static void test_draw__pictures_differ_where_scenes_do(void **state)
{
    stage *s = *state;
    dif_mesh mesh;
    dif_frame cpu, gpu;
    double worst = 0.0;
    if (!s->gpu)
        skip();
    const dif_shade_opts opts = dif_shade_opts_default();
    assert_int_equal(dif_mesh_make(DIF_MESH_SPHERE, 1, &mesh, NULL), DIF_OK);
    dif_scene scene = scene_of(&mesh);
    draw_both(s, &scene, &opts, &cpu, &gpu);
    scene.groove_rad += 0.05; /* a negative control: the comparison sees three degrees */
    assert_int_equal(dif_shade_draw(&scene, &s->cpu, &opts, &cpu, NULL, NULL), DIF_OK);
    assert_at_most(1.0, compare(&cpu, &gpu, &worst));
    dif_frame_free(&cpu);
    dif_frame_free(&gpu);
    dif_mesh_free(&mesh);
}

static void test_close__gives_everything_back(void **state)
{
    stage *s = *state;
    dif_mesh mesh;
    dif_frame frame;
    dif_gpu_renderer *renderer;
    if (!s->gpu)
        skip();
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    const dif_scene scene = scene_of(&mesh);
    const int live = dif_gpu_live(s->gpu);
    for (int k = 0; k < 20; k++) {
        assert_int_equal(dif_frame_create(NX + k, NY, &frame, NULL), DIF_OK);
        assert_int_equal(
            dif_gpu_renderer_open(s->gpu, &s->lut, s->model.index, &mesh, NULL, &s->vcavity, NULL, &renderer, NULL),
            DIF_OK);
        assert_non_null(strstr(dif_gpu_renderer_name(renderer), "fragment"));
        assert_int_equal(dif_gpu_renderer_draw(renderer, &scene, NULL, &frame, NULL, NULL), DIF_OK);
        dif_gpu_renderer_close(renderer);
        dif_frame_free(&frame);
        assert_int_equal(dif_gpu_live(s->gpu), live);
    }
    dif_mesh_free(&mesh);
}

static void test_draw__refuses_bad_scenes_and_sizes(void **state)
{
    stage *s = *state;
    dif_mesh mesh;
    dif_frame frame;
    dif_error err;
    dif_gpu_renderer *renderer;
    if (!s->gpu)
        skip();
    assert_int_equal(dif_mesh_make(DIF_MESH_PLANE, 1, &mesh, NULL), DIF_OK);
    assert_int_equal(dif_frame_create(NX, NY, &frame, NULL), DIF_OK);
    assert_int_equal(dif_gpu_renderer_open(s->gpu, &s->lut, s->model.index, &mesh, NULL, NULL, NULL, &renderer, NULL),
                     DIF_OK);
    dif_scene scene = scene_of(&mesh);
    scene.n_light = 0;
    assert_int_equal(dif_gpu_renderer_draw(renderer, &scene, NULL, &frame, NULL, &err), DIF_ERR_ARG);
    dif_gpu_renderer_close(renderer);
    dif_lut wide = s->lut;
    wide.n_azimuth = 1 << 20;
    assert_int_equal(dif_gpu_renderer_open(s->gpu, &wide, s->model.index, &mesh, NULL, NULL, NULL, &renderer, &err),
                     DIF_ERR_SIZE);
    assert_non_null(strstr(err.text, "1048576"));
    assert_null(renderer);
    dif_frame_free(&frame);
    dif_mesh_free(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draw__every_mesh_as_on_the_cpu),
        cmocka_unit_test(test_draw__masking_tables_and_base_textures),
        cmocka_unit_test(test_draw__filters_as_on_the_cpu),
        cmocka_unit_test(test_draw__pictures_differ_where_scenes_do),
        cmocka_unit_test(test_close__gives_everything_back),
        cmocka_unit_test(test_draw__refuses_bad_scenes_and_sizes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
