/* A picture's scene: a mesh that wears a surface, a perspective camera, distant lights.
 * Frame: the mesh's own, right-handed, z up; pictures have row 0 at the top.
 * Does not: draw (core/raster.h, core/shade.h). */
#ifndef DIF_SCENE_H
#define DIF_SCENE_H

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_LIGHT_MAX = 8, DIF_FRAME_SIDE_MAX = 8192 };

typedef struct dif_camera {
    dif_vec3 eye, target, up;
    double fov_y_rad; /* whole angle from the top to the bottom of the picture, in (0, pi) */
} dif_camera;

/* A picture in linear sRGB, row 0 at the top. */
typedef struct dif_texture {
    int nx, ny;
    float *rgb; /* rgb[ny*nx][3], owned */
} dif_texture;

void dif_texture_free(dif_texture *texture);

/* The texture repeated over the plane, linear between texel centres; uv[1] runs from the picture's bottom to its top. */
void dif_texture_read(const dif_texture *texture, const double uv[2], double rgb[3]);

typedef struct dif_scene {
    const dif_mesh *mesh;
    dif_camera camera;
    int n_light;                   /* 1 ... DIF_LIGHT_MAX                                                */
    dif_vec3 light[DIF_LIGHT_MAX]; /* directions to distant lights, unit; each as bright as the other    */
    double groove_rad;             /* the patch is turned by this on the mesh, about the normal          */
    const dif_texture *base;       /* diffuse colour under the diffraction, or NULL                      */
    double base_rgb[3];            /* the same without a texture, linear; 0 = none                       */
} dif_scene;

/* DIF_OK, or DIF_ERR_ARG: lights, camera; a base texture on a mesh without texture coordinates. */
DIF_MUST_USE dif_status dif_scene_check(const dif_scene *scene, dif_error *err);

/* A camera on a sphere around a centre: theta from +z, phi from +x, both as in core/conventions.h; up is +z. Straight down,
 * the picture's top lies away from phi: phi = -90 degrees has +y up. */
dif_camera dif_camera_orbit(dif_vec3 centre, double distance, double theta_rad, double phi_rad, double fov_y_rad);

/* The distance from which a ball of the given radius just fills the height or the width of a picture. */
double dif_camera_distance(double radius, double fov_y_rad, double aspect);

/* The camera from a direction (as dif_camera_orbit) that has the whole mesh in the middle of the picture, its outline
 * reaching `share` of the half-width or half-height, whichever is reached first. The mesh has an extent. */
dif_camera dif_camera_framing(const dif_mesh *mesh, double theta_rad, double phi_rad, double fov_y_rad, double aspect,
                              double share);

/* Turns camera and lights about the vertical through a centre by -turn: what is seen is the mesh turned by +turn. */
void dif_scene_turn(dif_scene *scene, dif_vec3 centre, double turn_rad);

/* Clip coordinates are linear in the position: x/w and y/w in [-1, 1] with y up, w the depth along the view axis.
 *   (x, y, w)_i = row[i][0] px + row[i][1] py + row[i][2] pz + row[i][3] */
typedef struct dif_projection {
    double row[3][4];
    double near_depth; /* nothing nearer is drawn */
} dif_projection;

dif_projection dif_scene_projection(const dif_camera *camera, double aspect);

/* What is seen at one place of the mesh. */
typedef struct dif_frame3 {
    dif_vec3 normal, tangent, bitangent; /* z, x and y of the turned patch; orthonormal, right-handed */
} dif_frame3;

/* The patch's frame from an interpolated normal and tangent: both made orthonormal, then turned about the normal
 * (Rodrigues). */
dif_frame3 dif_scene_frame(dif_vec3 normal, dif_vec3 tangent, double groove_rad);

/* A direction in that frame. */
static inline dif_vec3 dif_frame3_local(const dif_frame3 *frame, dif_vec3 direction)
{
    const dif_vec3 local = {dif_vec3_dot(direction, frame->tangent), dif_vec3_dot(direction, frame->bitangent),
                            dif_vec3_dot(direction, frame->normal)};
    return local;
}

#ifdef __cplusplus
}
#endif
#endif
