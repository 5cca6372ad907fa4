#include "core/scene.h"

#include <math.h>

#include "core/alloc.h"
#include "core/units.h"

void dif_texture_free(dif_texture *texture)
{
    dif_release(texture->rgb);
    *texture = (dif_texture){0};
}

static int wrap(double at, int n)
{
    const double turned = at - n * floor(at / n);
    return turned < n ? (int)turned : 0;
}

void dif_texture_read(const dif_texture *texture, const double uv[2], double rgb[3])
{
    const int nx = texture->nx, ny = texture->ny;
    const double x = (uv[0] - floor(uv[0])) * nx - 0.5, y = (1.0 - (uv[1] - floor(uv[1]))) * ny - 0.5;
    const double right = x - floor(x), down = y - floor(y);
    const int x0 = wrap(floor(x), nx), x1 = wrap(floor(x) + 1.0, nx);
    const size_t y0 = (size_t)wrap(floor(y), ny) * (size_t)nx, y1 = (size_t)wrap(floor(y) + 1.0, ny) * (size_t)nx;
    for (size_t c = 0; c < 3; c++) {
        const double top = (1.0 - right) * (double)texture->rgb[3 * (y0 + (size_t)x0) + c] +
                           right * (double)texture->rgb[3 * (y0 + (size_t)x1) + c];
        const double bottom = (1.0 - right) * (double)texture->rgb[3 * (y1 + (size_t)x0) + c] +
                              right * (double)texture->rgb[3 * (y1 + (size_t)x1) + c];
        rgb[c] = (1.0 - down) * top + down * bottom;
    }
}

static bool is_unit(dif_vec3 a)
{
    return fabs(dif_vec3_dot(a, a) - 1.0) < 1e-6;
}

dif_status dif_scene_check(const dif_scene *scene, dif_error *err)
{
    const dif_camera *camera = &scene->camera;
    const dif_vec3 view = dif_vec3_add(camera->target, -1.0, camera->eye), side = dif_vec3_cross(view, camera->up);
    if (!(scene->n_light >= 1 && scene->n_light <= DIF_LIGHT_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d lights, want 1 ... %d", scene->n_light, DIF_LIGHT_MAX);
    for (int i = 0; i < scene->n_light; i++)
        if (!is_unit(scene->light[i]))
            return dif_fail(err, DIF_ERR_ARG, "light %d is not a unit direction", i);
    if (!(camera->fov_y_rad > 1e-6 && camera->fov_y_rad < DIF_PI - 1e-6))
        return dif_fail(err, DIF_ERR_ARG, "a field of view of %g rad, want 0 < angle < pi", camera->fov_y_rad);
    if (!(dif_vec3_dot(side, side) > 1e-18 * dif_vec3_dot(view, view) && isfinite(dif_vec3_dot(view, view))))
        return dif_fail(err, DIF_ERR_ARG, "the camera looks nowhere or along its up direction");
    if (!isfinite(scene->groove_rad))
        return dif_fail(err, DIF_ERR_ARG, "groove azimuth is not finite");
    if (scene->base && !scene->mesh->uv)
        return dif_fail(err, DIF_ERR_ARG, "a base colour texture needs texture coordinates, and the mesh has none");
    return DIF_OK;
}

dif_camera dif_camera_orbit(dif_vec3 centre, double distance, double theta_rad, double phi_rad, double fov_y_rad)
{
    static const dif_vec3 z = {0.0, 0.0, 1.0};
    const dif_vec3 away = dif_vec3_from_angles_rad(theta_rad, phi_rad), straight = {-cos(phi_rad), -sin(phi_rad), 0.0};
    return (dif_camera){.eye = dif_vec3_add(centre, distance, away),
                        .target = centre,
                        .up = fabs(away.z) < 1.0 - 1e-9 ? z : straight,
                        .fov_y_rad = fov_y_rad};
}

double dif_camera_distance(double radius, double fov_y_rad, double aspect)
{
    const double half_y = 0.5 * fov_y_rad, half_x = atan(tan(half_y) * aspect);
    return radius / sin(fmin(half_x, half_y));
}

/* The rectangle of clip coordinates that a mesh takes up: low[2], high[2]. */
static void outline(const dif_mesh *mesh, const dif_projection *projection, double low[2], double high[2])
{
    low[0] = low[1] = INFINITY;
    high[0] = high[1] = -INFINITY;
    for (int i = 0; i < mesh->n_vertex; i++) {
        const dif_vec3 p = mesh->position[i];
        double clip[3];
        for (int k = 0; k < 3; k++) {
            const double *row = projection->row[k];
            clip[k] = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
        }
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], clip[k] / clip[2]);
            high[k] = fmax(high[k], clip[k] / clip[2]);
        }
    }
}

dif_camera dif_camera_framing(const dif_mesh *mesh, double theta_rad, double phi_rad, double fov_y_rad, double aspect,
                              double share)
{
    enum { ROUNDS = 12 }; /* each leaves about a quarter of the error: perspective is mild from there */
    dif_vec3 target;
    double radius;
    dif_mesh_bounds(mesh, &target, &radius);
    const double whole = radius * dif_camera_distance(1.0, fov_y_rad, aspect), tangent = tan(0.5 * fov_y_rad);
    double distance = whole;
    for (int round = 0; round < ROUNDS; round++) {
        const dif_camera camera = dif_camera_orbit(target, distance, theta_rad, phi_rad, fov_y_rad);
        const dif_projection projection = dif_scene_projection(&camera, aspect);
        const dif_vec3 forward = dif_vec3_unit(dif_vec3_add(camera.target, -1.0, camera.eye));
        const dif_vec3 right = dif_vec3_unit(dif_vec3_cross(forward, camera.up)), up = dif_vec3_cross(right, forward);
        double low[2], high[2];
        outline(mesh, &projection, low, high);
        target = dif_vec3_add(target, 0.5 * (low[0] + high[0]) * tangent * aspect * distance, right);
        target = dif_vec3_add(target, 0.5 * (low[1] + high[1]) * tangent * distance, up);
        const double reach = 0.5 * fmax(high[0] - low[0], high[1] - low[1]);
        /* never so near that the mesh could be behind the camera; a mesh that is seen edge-on as a point stays whole */
        distance = reach > 0.0 ? fmin(fmax(distance * reach / share, 0.25 * whole), 4.0 * whole) : whole;
    }
    return dif_camera_orbit(target, distance, theta_rad, phi_rad, fov_y_rad);
}

void dif_scene_turn(dif_scene *scene, dif_vec3 centre, double turn_rad)
{
    static const dif_vec3 z = {0.0, 0.0, 1.0};
    dif_camera *camera = &scene->camera;
    for (int i = 0; i < scene->n_light; i++)
        scene->light[i] = dif_vec3_turn(scene->light[i], z, -turn_rad);
    camera->eye = dif_vec3_add(centre, 1.0, dif_vec3_turn(dif_vec3_add(camera->eye, -1.0, centre), z, -turn_rad));
    camera->target = dif_vec3_add(centre, 1.0, dif_vec3_turn(dif_vec3_add(camera->target, -1.0, centre), z, -turn_rad));
    camera->up = dif_vec3_turn(camera->up, z, -turn_rad);
}

dif_projection dif_scene_projection(const dif_camera *camera, double aspect)
{
    const dif_vec3 view = dif_vec3_add(camera->target, -1.0, camera->eye), forward = dif_vec3_unit(view);
    const dif_vec3 right = dif_vec3_unit(dif_vec3_cross(forward, camera->up)), up = dif_vec3_cross(right, forward);
    const double tangent = tan(0.5 * camera->fov_y_rad);
    const dif_vec3 axis[3] = {right, up, forward};
    const double scale[3] = {1.0 / (tangent * aspect), 1.0 / tangent, 1.0};
    dif_projection projection = {.near_depth = 1e-3 * sqrt(dif_vec3_dot(view, view))};
    for (int i = 0; i < 3; i++) {
        double *row = projection.row[i];
        row[0] = scale[i] * axis[i].x;
        row[1] = scale[i] * axis[i].y;
        row[2] = scale[i] * axis[i].z;
        row[3] = -scale[i] * dif_vec3_dot(axis[i], camera->eye);
    }
    return projection;
}

dif_frame3 dif_scene_frame(dif_vec3 normal, dif_vec3 tangent, double groove_rad)
{
    const dif_vec3 n = dif_vec3_unit(normal);
    const dif_vec3 along = dif_vec3_unit(dif_vec3_add(tangent, -dif_vec3_dot(tangent, n), n));
    const dif_vec3 turned = dif_vec3_turn(along, n, groove_rad);
    return (dif_frame3){n, turned, dif_vec3_cross(n, turned)};
}
