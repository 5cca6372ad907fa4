/* BRDF maps as files: EXR for numbers (linear R, G, B and X, Y, Z, optionally one layer a wavelength), PNG to look at.
 * Does not: measure. */
#ifndef DIF_MAP_IO_H
#define DIF_MAP_IO_H

#include "core/colour.h"
#include "core/io/manifest.h"
#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A map: pixel (ix, iy), row 0 at the top, is the direction
 *   x = (2 ix + 1) / n - 1,  y = 1 - (2 iy + 1) / n;  outside the unit disc everything is 0. */
typedef struct dif_map_image {
    int n_pixel;               /* across                                                             */
    bool fixed_is_wo;          /* false: light fixed, the map shows detectors; true: the reverse     */
    double theta_rad, phi_rad; /* of the fixed direction                                             */
    dif_quantity quantity;
    int n_lambda;
    double *lambda_um; /* lambda_um[n_lambda]                                                              */
    float *xyz;        /* xyz[n_pixel * n_pixel][3]                                                        */
    float *layer;      /* layer[n_lambda][n_pixel * n_pixel], or NULL                                      */
} dif_map_image;

/* Writes an EXR, whole or not at all. Channels R, G, B (linear, sRGB's primaries, not clipped) and X, Y, Z; layers as
 * T.550,000000nm with spectralLayoutVersion 1.0 (Fichet, Pacanowski, Wilkie 2021); axes and manifest as attributes
 * "diffbench.KEY". `exposure` is noted, not applied.
 * Status    DIF_ERR_ARG (two wavelengths within 1e-6 nm), DIF_ERR_IO, DIF_ERR_FOREIGN, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_map_write(const char *path, const dif_map_image *map, double exposure,
                                      const dif_manifest *manifest, dif_error *err);

/* Reads such a file; *manifest (may be NULL) becomes its text attributes "diffbench.KEY".
 * Status    DIF_ERR_IO, DIF_ERR_FORMAT (no map, another version, damaged), DIF_ERR_NONFINITE, DIF_ERR_SIZE,
 *           DIF_ERR_NOMEM; *map zeroed on failure
 * Owns      the caller frees with dif_map_image_free */
DIF_MUST_USE dif_status dif_map_read(const char *path, dif_map_image *map, dif_manifest *manifest, dif_error *err);
DIF_MUST_USE dif_status dif_map_parse(const unsigned char *data, size_t n, const char *name, dif_map_image *map,
                                      dif_manifest *manifest, dif_error *err);
void dif_map_image_free(dif_map_image *map);

/* How a map becomes a picture. */
typedef struct dif_map_look {
    double exposure; /* what XYZ is multiplied by, > 0, or DIF_EXPOSURE_AUTO */
    dif_gamut gamut;
} dif_map_look;

#define DIF_EXPOSURE_AUTO       (-1.0)
#define DIF_EXPOSURE_AUTO_SHARE 0.1 /* of the light, in the pixels above white      */
#define DIF_EXPOSURE_AUTO_AWAY  0.1 /* direction cosines from the mirror direction  */

/* Automatic exposure, clip. */
dif_map_look dif_map_look_default(void);

/* The automatic exposure: the pixels that become brighter than white (largest of R, G, B above 1) carry
 * DIF_EXPOSURE_AUTO_SHARE of the light that falls more than DIF_EXPOSURE_AUTO_AWAY away from the mirror direction, to 1 %.
 * Of all the light if next to none (1e-3) falls there; 1 for a map without light. */
double dif_map_exposure(const dif_map_image *map);

/* Draws the map: encoded sRGB, circles of theta every 15 degrees, azimuths around it, what it shows below it.
 *
 * Gives     rgb[*ny * *nx * 3], freed with dif_release. Maps of fewer than 256 pixels are enlarged by a whole number.
 * Status    DIF_ERR_NOMEM, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_map_draw(const dif_map_image *map, const dif_map_look *look, uint8_t **rgb, int *nx,
                                     int *ny, dif_error *err);

/* The same as a PNG, whole or not at all, with the manifest in its texts "diffbench.KEY". Status also DIF_ERR_IO. */
DIF_MUST_USE dif_status dif_map_write_png(const char *path, const dif_map_image *map, const dif_map_look *look,
                                          const dif_manifest *manifest, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
