#include "core/io/hemisphere_io.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"

#define ATTRIBUTE(key) DIF_EXR_PREFIX key
#define LAYOUT         "hemisphere: x, y = direction cosines"
enum { N_CHANNEL = 4, FILE_MAX = 1 << 30 };

static const char *const CHANNELS[N_CHANNEL] = {"ndf", "masking", "texel_sr", "texel_area"};

/* pixel[n * n][N_CHANNEL] */
static void fill(const dif_ndf *ndf, const float *masking, float *pixel)
{
    for (int iy = 0; iy < ndf->n; iy++)
        for (int ix = 0; ix < ndf->n; ix++) {
            const size_t at = (size_t)iy * (size_t)ndf->n + (size_t)ix;
            const dif_hemisphere_texel texel = dif_hemisphere_texel_at(ndf->n, ix, iy);
            pixel[N_CHANNEL * at] = (float)ndf->d[at];
            pixel[N_CHANNEL * at + 1] = masking[at];
            pixel[N_CHANNEL * at + 2] = (float)texel.sr;
            pixel[N_CHANNEL * at + 3] = (float)texel.area;
        }
}

dif_status dif_hemisphere_write(const char *path, const dif_ndf *ndf, const float *masking,
                                const dif_manifest *manifest, dif_error *err)
{
    const dif_exr_attribute attributes[] = {
        {ATTRIBUTE("layout"), LAYOUT, 0.0},
        {ATTRIBUTE("x_axis"), "sin(theta) cos(phi) = (2 ix + 1)/n - 1", 0.0},
        {ATTRIBUTE("y_axis"), "sin(theta) sin(phi) = 1 - (2 iy + 1)/n, row 0 at the top", 0.0},
        {ATTRIBUTE("ndf"), "distribution of normals per sr, sum of ndf texel_area = 1", 0.0},
        {ATTRIBUTE("masking"), "G(k) = cos_k / int max(0, k.h) D(h) d omega_h", 0.0},
        {ATTRIBUTE("texel_sr"), "solid angle of the texel inside the disc; texel_area: its area there", 0.0},
    };
    const size_t n_pixel = (size_t)ndf->n * (size_t)ndf->n;
    float *pixel = dif_alloc(n_pixel, N_CHANNEL * sizeof *pixel);
    unsigned char *data = NULL;
    size_t n = 0;
    if (!pixel)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: no memory for %zu normals", path, n_pixel);
    fill(ndf, masking, pixel);
    dif_exr_layer layer[N_CHANNEL];
    for (int c = 0; c < N_CHANNEL; c++)
        layer[c] = (dif_exr_layer){CHANNELS[c], pixel + c, N_CHANNEL};
    const dif_exr_image image = {.nx = ndf->n,
                                 .ny = ndf->n,
                                 .layer = layer,
                                 .n_layer = N_CHANNEL,
                                 .attribute = attributes,
                                 .n_attribute = sizeof attributes / sizeof *attributes,
                                 .manifest = manifest};
    dif_status status = dif_exr_encode(&image, &data, &n, err);
    if (!status)
        status = dif_file_write(path, data, n, err);
    dif_release(data);
    dif_release(pixel);
    return status;
}

static dif_status check_head(const char *path, const dif_exr *exr, int *n, dif_error *err)
{
    const char *layout = dif_exr_text(exr, ATTRIBUTE("layout"));
    int ny = 0;
    dif_exr_size(exr, n, &ny);
    if (!layout || strcmp(layout, LAYOUT) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: no hemisphere of diffbench (attribute %s)", path,
                        ATTRIBUTE("layout"));
    if (*n != ny || *n < 3 || *n > DIF_HEMISPHERE_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: hemisphere of %d x %d pixels, want a square of 3 ... %d", path, *n, ny,
                        DIF_HEMISPHERE_MAX);
    return DIF_OK;
}

static dif_status parse(const char *path, dif_exr *exr, dif_ndf *ndf, dif_error *err)
{
    int n = 0;
    float *pixel = NULL;
    char found[DIF_EXR_CHANNEL_SIZE];
    dif_status status = check_head(path, exr, &n, err);
    if (!status)
        status = dif_exr_read_channel(exr, CHANNELS[0], &pixel, found, err);
    if (status)
        return status;
    const size_t n_pixel = (size_t)n * (size_t)n;
    double *d = dif_alloc(n_pixel, sizeof *d);
    for (size_t i = 0; d && i < n_pixel; i++)
        d[i] = (double)pixel[i];
    status = d ? dif_hemisphere_ndf_from_image(d, n, ndf, err)
               : dif_fail(err, DIF_ERR_NOMEM, "%s: no memory for %zu normals", path, n_pixel);
    dif_release(d);
    dif_release(pixel);
    return status;
}

dif_status dif_hemisphere_read(const char *path, dif_ndf *ndf, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    dif_exr *exr = NULL;
    *ndf = (dif_ndf){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (status)
        return status;
    const dif_source source = dif_source_of(data, n, path);
    status = dif_exr_open(&source, &exr, err);
    if (!status)
        status = parse(path, exr, ndf, err);
    dif_exr_close(exr);
    dif_release(data);
    return status;
}
