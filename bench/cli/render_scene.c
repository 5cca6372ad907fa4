/* The scene of a rendering, from the command line. */
#include <math.h>
#include <string.h>

#include "bench/cli/render.h"
#include "core/io/number.h"
#include "core/io/obj_tiny.h"
#include "core/units.h"
#include "fixtures/meshes.h"

enum { SIDE_MIN = 16, SIDE_MAX = 4096 };

/* How each built-in mesh looks best: where the camera stands, where the lights are, how the patch lies. On the snake the patch's y axis, along which the rows of snakes' scans are stacked, points
 * to the tail. */
static const struct {
    double camera[2];
    int n_light;
    double light[2][2], groove_deg;
} LOOKS[] = {
    [DIF_MESH_PLANE] = {{50.0, -90.0}, 1, {{30.0, 90.0}}, 0.0},
    [DIF_MESH_DISC] = {{45.0, -90.0}, 1, {{30.0, 60.0}}, 0.0},
    [DIF_MESH_CYLINDER] = {{60.0, -90.0}, 1, {{30.0, -60.0}}, 0.0},
    [DIF_MESH_SPHERE] = {{75.0, -90.0}, 1, {{40.0, -50.0}}, 0.0},
    [DIF_MESH_SNAKE] = {{48.0, -90.0}, 2, {{35.0, -60.0}, {40.0, 150.0}}, 90.0},
};

bool dif_render_numbers(const char *text, int n_min, int n_max, double *out, int *n)
{
    const char *at = text, *end = text + strlen(text);
    *n = 0;
    while (*n < n_max) {
        const char *stop = dif_number_parse(at, end, '.', &out[*n]);
        if (!stop || !isfinite(out[*n]))
            return false;
        ++*n;
        if (stop == end)
            return *n >= n_min;
        if (*stop != ',')
            return false;
        at = stop + 1;
    }
    return false;
}

static dif_status load_mesh(const dif_render_args *args, dif_render_scene *out, dif_mesh_kind *kind, dif_error *err)
{
    const char *name = args->mesh ? args->mesh : dif_mesh_kind_name(DIF_MESH_SNAKE);
    if (dif_mesh_kind_from_name(name, kind))
        return dif_mesh_make(*kind, args->detail, &out->mesh, err);
    *kind = DIF_MESH_SPHERE;
    return dif_obj_read(name, &out->mesh, err);
}

static dif_status parse_size(const dif_render_args *args, dif_render_scene *out, dif_error *err)
{
    static const char DEFAULT[] = "1280x720", STUDY[] = "160x160";
    const char *text = args->size    ? args->size
                       : args->study ? STUDY
                                     : DEFAULT,
               *end = text + strlen(text), *times = strchr(text, 'x');
    double nx = NAN, ny = NAN;
    const bool good = times && dif_number_parse(text, times, '.', &nx) == times &&
                      dif_number_parse(times + 1, end, '.', &ny) == end && nx == floor(nx) && ny == floor(ny) &&
                      nx >= SIDE_MIN && nx <= SIDE_MAX && ny >= SIDE_MIN && ny <= SIDE_MAX;
    if (!good)
        return dif_fail(err, DIF_ERR_ARG, "--size '%s': expected WIDTHxHEIGHT, each %d ... %d", text, SIDE_MIN,
                        SIDE_MAX);
    out->nx = (int)nx;
    out->ny = (int)ny;
    return DIF_OK;
}

static dif_status place_camera(const dif_render_args *args, dif_mesh_kind kind, dif_render_scene *out, dif_error *err)
{
    enum { ANGLES = 2, WITH_DISTANCE = 3 };
    static const double SHARE = 0.94; /* of the picture that the mesh fills */
    double at[3] = {LOOKS[kind].camera[0], LOOKS[kind].camera[1], 1.0}, radius = 0.0;
    int n = ANGLES;
    dif_mesh_bounds(&out->mesh, &out->centre, &radius);
    if (args->camera && !(dif_render_numbers(args->camera, 2, 3, at, &n) && fabs(at[0]) <= 180.0 && at[2] > 0.0))
        return dif_fail(err, DIF_ERR_ARG,
                        "--camera '%s': expected THETA,PHI or THETA,PHI,DISTANCE, |THETA| <= 180, "
                        "DISTANCE > 0",
                        args->camera);
    if (!(radius > 0.0))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the mesh has no extent", args->mesh);
    const double fov_rad = dif_rad_from_deg(args->fov_deg), aspect = (double)out->nx / out->ny;
    const double theta_rad = dif_rad_from_deg(at[0]), phi_rad = dif_rad_from_deg(at[1]);
    const double all = dif_camera_distance(1.0, fov_rad, aspect); /* shows the mesh however it turns */
    const bool is_framed = n < WITH_DISTANCE && args->n_turn == 0;
    dif_camera *camera = &out->scene.camera;
    *camera = is_framed ? dif_camera_framing(&out->mesh, theta_rad, phi_rad, fov_rad, aspect, SHARE)
                        : dif_camera_orbit(out->centre, (n < WITH_DISTANCE ? all : at[2]) * radius, theta_rad, phi_rad,
                                           fov_rad);
    const dif_vec3 away = dif_vec3_add(camera->eye, -1.0, camera->target);
    out->camera_theta_deg = at[0];
    out->camera_phi_deg = at[1];
    out->camera_distance = sqrt(dif_vec3_dot(away, away)) / radius;
    return DIF_OK;
}

static dif_status place_lights(const dif_render_args *args, dif_mesh_kind kind, dif_render_scene *out, dif_error *err)
{
    dif_scene *scene = &out->scene;
    scene->n_light = args->light_deg.n > 0 ? args->light_deg.n : LOOKS[kind].n_light;
    if (scene->n_light > DIF_LIGHT_MAX)
        return dif_fail(err, DIF_ERR_ARG, "--light-deg: %d lights, expected at most %d", scene->n_light, DIF_LIGHT_MAX);
    for (int i = 0; i < scene->n_light; i++) {
        double *at = out->light_deg[i];
        int n = 0;
        if (args->light_deg.n == 0)
            memcpy(at, LOOKS[kind].light[i], sizeof LOOKS[kind].light[i]);
        if (args->light_deg.n > 0 &&
            !(dif_render_numbers(args->light_deg.text[i], 2, 2, at, &n) && fabs(at[0]) <= 180.0))
            return dif_fail(err, DIF_ERR_ARG, "--light-deg '%s': expected THETA,PHI, |THETA| <= 180",
                            args->light_deg.text[i]);
        scene->light[i] = dif_vec3_from_angles_rad(dif_rad_from_deg(at[0]), dif_rad_from_deg(at[1]));
    }
    return DIF_OK;
}

/* A picture, or a colour as six hexadecimal digits. */
static dif_status take_base(const dif_render_args *args, dif_render_scene *out, dif_error *err)
{
    static const char DIGITS[] = "0123456789abcdef";
    const char *text = args->base_colour;
    if (!text)
        return DIF_OK;
    if (strlen(text) == 6 && strspn(text, "0123456789abcdefABCDEF") == 6) {
        for (int c = 0; c < 3; c++) {
            const char high = text[2 * c], low = text[2 * c + 1];
            const long value = 16 * (strchr(DIGITS, high >= 'A' && high <= 'F' ? high + 32 : high) - DIGITS) +
                               (strchr(DIGITS, low >= 'A' && low <= 'F' ? low + 32 : low) - DIGITS);
            out->scene.base_rgb[c] = dif_colour_decode((double)value / 255.0);
        }
        return DIF_OK;
    }
    const dif_status status = dif_texture_load(text, &out->base, err);
    if (!status)
        out->scene.base = &out->base;
    if (!status && !out->mesh.uv)
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: no texture coordinates, which --base-colour '%s' needs; expected an "
                        "OBJ with vt lines, or a colour RRGGBB",
                        args->mesh, text);
    return status;
}

dif_status dif_render_scene_make(const dif_render_args *args, dif_render_scene *out, dif_error *err)
{
    dif_mesh_kind kind;
    *out = (dif_render_scene){0};
    dif_status status = parse_size(args, out, err);
    if (!status)
        status = load_mesh(args, out, &kind, err);
    if (status)
        return status;
    out->scene.mesh = &out->mesh;
    out->scene.groove_rad = dif_rad_from_deg(isnan(args->groove_deg) ? LOOKS[kind].groove_deg : args->groove_deg);
    status = place_camera(args, kind, out, err);
    if (!status)
        status = place_lights(args, kind, out, err);
    if (!status)
        status = take_base(args, out, err);
    if (!status && args->meso && !out->mesh.uv)
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: no texture coordinates, which --mesostructure needs; expected an OBJ with "
                        "vt lines",
                        args->mesh);
    return status ? status : dif_scene_check(&out->scene, err);
}

void dif_render_scene_free(dif_render_scene *scene)
{
    dif_mesh_free(&scene->mesh);
    dif_texture_free(&scene->base);
}
