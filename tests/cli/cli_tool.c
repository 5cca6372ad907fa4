/* Helper of the command line tests.
 *   cli_tool json PATH <FILE                 prints the value at a dotted path; "PATH#" prints a list's length
 *   cli_tool png NX NY OUT                   writes an 8 bit picture of a sine along x
 *   cli_tool pixels F                        prints size and checksum of a picture's pixels, whatever its texts
 *   cli_tool differ F G                      prints the mean difference of two pictures' values, of 255 */
#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/manifest.h"

static const json_t *step_into(const json_t *at, const char *key, size_t n)
{
    char name[100];
    snprintf(name, sizeof name, "%.*s", (int)n, key);
    if (json_is_array(at))
        return json_array_get(at, (size_t)strtoul(name, NULL, 10));
    return json_object_get(at, name);
}

static int print_value(const json_t *value, bool want_length)
{
    if (!value)
        return 1;
    if (want_length)
        return printf("%zu\n", json_array_size(value)) < 0;
    if (json_is_string(value))
        return printf("%s\n", json_string_value(value)) < 0;
    if (json_dumpf(value, stdout, JSON_ENCODE_ANY | JSON_REAL_PRECISION(15)) != 0)
        return 1;
    return printf("\n") < 0;
}

static int json_main(const char *path)
{
    json_error_t error;
    json_t *root = json_loadf(stdin, 0, &error);
    if (!root) {
        fprintf(stderr, "no JSON: %s at line %d\n", error.text, error.line);
        return 1;
    }
    const size_t n_path = strlen(path);
    const bool want_length = n_path > 0 && path[n_path - 1] == '#';
    const char *stop = path + n_path - (want_length ? 1 : 0);
    const json_t *at = root;
    while (at && path < stop) {
        size_t n = strcspn(path, ".");
        n = path + n > stop ? (size_t)(stop - path) : n;
        at = step_into(at, path, n);
        path += n + (path[n] == '.');
    }
    const int code = print_value(at, want_length);
    json_decref(root);
    return code;
}

static int png_main(int nx, int ny, const char *path)
{
    dif_error err = {0};
    unsigned char *png = NULL;
    size_t n_png = 0;
    uint8_t *rgb = dif_alloc((size_t)nx * (size_t)ny * 3, 1);
    if (!rgb)
        return 1;
    for (size_t i = 0; i < (size_t)nx * (size_t)ny * 3; i++)
        rgb[i] = (uint8_t)(127.5 + 127.5 * sin(0.5 * (double)(i / 3 % (size_t)nx)));
    dif_status status = dif_image_encode_png(rgb, nx, ny, &png, &n_png, &err);
    if (!status)
        status = dif_file_write(path, png, n_png, &err);
    if (status)
        fprintf(stderr, "%s\n", err.text);
    dif_release(png);
    dif_release(rgb);
    return status != DIF_OK;
}

static uint8_t *load_rgb(const char *path, int *nx, int *ny)
{
    dif_error err = {0};
    unsigned char *data = NULL;
    uint8_t *rgb = NULL;
    size_t n = 0;
    dif_status status = dif_file_read(path, (size_t)1 << 30, &data, &n, &err);
    if (!status)
        status = dif_image_decode_rgb(data, n, &rgb, nx, ny, &err);
    if (status)
        fprintf(stderr, "%s\n", err.text);
    dif_release(data);
    return rgb;
}

static int pixels_main(const char *path)
{
    int nx = 0, ny = 0;
    char hex[65];
    uint8_t *rgb = load_rgb(path, &nx, &ny);
    if (rgb) {
        dif_sha256_hex(rgb, 3 * (size_t)nx * (size_t)ny, hex);
        printf("%d %d %s\n", nx, ny, hex);
    }
    dif_release(rgb);
    return rgb == NULL;
}

static int differ_main(const char *a, const char *b)
{
    int nx = 0, ny = 0, mx = 0, my = 0;
    uint8_t *one = load_rgb(a, &nx, &ny), *other = load_rgb(b, &mx, &my);
    const bool good = one && other && nx == mx && ny == my;
    const size_t n = good ? 3 * (size_t)nx * (size_t)ny : 0;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++)
        sum += abs(one[i] - other[i]);
    if (good)
        printf("%.6f\n", sum / (double)n);
    dif_release(one);
    dif_release(other);
    return !good;
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "json") == 0)
        return json_main(argv[2]);
    if (argc == 5 && strcmp(argv[1], "png") == 0)
        return png_main(atoi(argv[2]), atoi(argv[3]), argv[4]);
    if (argc == 3 && strcmp(argv[1], "pixels") == 0)
        return pixels_main(argv[2]);
    if (argc == 4 && strcmp(argv[1], "differ") == 0)
        return differ_main(argv[2], argv[3]);
    fprintf(stderr, "usage: cli_tool json PATH | png NX NY OUT | pixels F | differ F G\n");
    return 2;
}
