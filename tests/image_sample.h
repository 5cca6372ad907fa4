/* Small BMP, TIFF and PNG pictures made in memory, so that each field of their headers can be wrong. */
#ifndef DIF_TEST_IMAGE_SAMPLE_H
#define DIF_TEST_IMAGE_SAMPLE_H

#include <stdint.h>
#include <string.h>

typedef struct image_sample {
    unsigned char data[4096];
    size_t n;
} image_sample;

static inline void image_put(image_sample *file, uint32_t value, int n_byte, int big)
{
    for (int i = 0; i < n_byte; i++)
        file->data[file->n++] = (unsigned char)(value >> 8 * (big ? n_byte - 1 - i : i));
}

/* Grey value of a picture's pixel: differs along both axes. */
static inline uint32_t image_value(int ix, int iy, int bits)
{
    return bits == 8 ? (uint32_t)(10 * ix + 60 * iy) & 255u : (uint32_t)(1000 * ix + 20000 * iy + 7) & 65535u;
}

/* 24-bit BMP, bottom row first, all channels equal. */
static inline image_sample image_bmp(int nx, int ny)
{
    image_sample file = {.n = 0};
    const uint32_t n_row = ((uint32_t)nx * 24 + 31) / 32 * 4;
    image_put(&file, 'B' | 'M' << 8, 2, 0);
    image_put(&file, 54 + n_row * (uint32_t)ny, 4, 0);
    image_put(&file, 0, 4, 0);
    image_put(&file, 54, 4, 0);
    image_put(&file, 40, 4, 0);
    image_put(&file, (uint32_t)nx, 4, 0);
    image_put(&file, (uint32_t)ny, 4, 0);
    image_put(&file, 1 | 24 << 16, 4, 0);
    for (int i = 0; i < 6; i++)
        image_put(&file, 0, 4, 0);
    for (int iy = ny - 1; iy >= 0; iy--) {
        for (int ix = 0; ix < nx; ix++)
            image_put(&file, image_value(ix, iy, 8) * 0x10101u, 3, 0);
        while ((file.n - 54) % 4)
            file.data[file.n++] = 0;
    }
    return file;
}

/* Grey TIFF, uncompressed, two rows a strip; entries tag, type, count, value. */
typedef struct image_tiff_kind {
    int nx, ny, bits, big, photometric, orientation, format, samples;
} image_tiff_kind;

static inline image_sample image_tiff(const image_tiff_kind *kind)
{
    image_sample file = {.n = 0};
    const int big = kind->big, n_strip = (kind->ny + 1) / 2;
    const uint32_t n_row = (uint32_t)(kind->nx * kind->bits / 8);
    const uint32_t n_pixel = n_row * (uint32_t)kind->ny, lists = 8 + n_pixel, directory = lists + 8 * (uint32_t)n_strip;
    memcpy(file.data, big ? "MM\0*" : "II*\0", 4);
    file.n = 4;
    image_put(&file, directory, 4, big);
    for (int iy = 0; iy < kind->ny; iy++) {
        for (int ix = 0; ix < kind->nx; ix++)
            image_put(&file, image_value(ix, iy, kind->bits), kind->bits / 8, big);
    }
    for (int i = 0; i < n_strip; i++)
        image_put(&file, 8 + 2 * n_row * (uint32_t)i, 4, big);
    for (int i = 0; i < n_strip; i++)
        image_put(&file, n_row * (2 * i + 1 < kind->ny ? 2u : 1u), 4, big);
    const uint32_t entries[][4] = {
        {256, 4, 1, (uint32_t)kind->nx},
        {257, 4, 1, (uint32_t)kind->ny},
        {258, 3, 1, (uint32_t)kind->bits},
        {259, 3, 1, 1},
        {262, 3, 1, (uint32_t)kind->photometric},
        {273, 4, (uint32_t)n_strip, lists},
        {274, 3, 1, (uint32_t)kind->orientation},
        {277, 3, 1, (uint32_t)kind->samples},
        {278, 3, 1, 2},
        {279, 4, (uint32_t)n_strip, lists + 4 * (uint32_t)n_strip},
        {339, 3, 1, (uint32_t)kind->format},
    };
    const int n_entry = (int)(sizeof entries / sizeof *entries);
    image_put(&file, (uint32_t)n_entry, 2, big);
    for (int i = 0; i < n_entry; i++) {
        image_put(&file, entries[i][0], 2, big);
        image_put(&file, entries[i][1], 2, big);
        image_put(&file, entries[i][2], 4, big);
        image_put(&file, entries[i][3], entries[i][1] == 3 ? 2 : 4, big);
        if (entries[i][1] == 3)
            image_put(&file, 0, 2, big);
    }
    image_put(&file, 0, 4, big);
    return file;
}

static inline uint32_t image_crc(const unsigned char *data, size_t n)
{
    uint32_t crc = 0xffffffffu;
    for (size_t i = 0; i < n; i++) {
        crc ^= data[i];
        for (int k = 0; k < 8; k++)
            crc = crc & 1u ? crc >> 1 ^ 0xedb88320u : crc >> 1;
    }
    return ~crc;
}

static inline void image_png_chunk(image_sample *file, const char *type, const void *data, size_t n)
{
    image_put(file, (uint32_t)n, 4, 1);
    const size_t start = file->n;
    memcpy(file->data + file->n, type, 4);
    if (n)
        memcpy(file->data + file->n + 4, data, n);
    file->n += 4 + n;
    image_put(file, image_crc(file->data + start, 4 + n), 4, 1);
}

/* PNG of the colour type (0 grey, 2 RGB, 4 grey + alpha, 6 RGBA) whose rows are stored uncompressed. The blue channel is
 * `tint` higher. `texts` are key, text pairs, NULL ends. */
static inline image_sample image_png(int nx, int ny, int bits, int colour, int tint, const char *const *texts)
{
    static const int CHANNELS[] = {1, 0, 3, 0, 2, 0, 4};
    image_sample file = {.n = 0}, head = {.n = 0}, raw = {.n = 0}, packed = {.n = 0};
    image_put(&head, (uint32_t)nx, 4, 1);
    image_put(&head, (uint32_t)ny, 4, 1);
    image_put(&head, (uint32_t)(bits << 24 | colour << 16), 4, 1);
    image_put(&head, 0, 1, 1);
    for (int iy = 0; iy < ny; iy++) {
        image_put(&raw, 0, 1, 1); /* no filter */
        for (int ix = 0; ix < nx; ix++) {
            for (int c = 0; c < CHANNELS[colour]; c++) {
                const int is_alpha = (colour == 4 && c == 1) || c == 3;
                const uint32_t value = is_alpha ? 77 : image_value(ix, iy, bits) + (uint32_t)(c == 2 ? tint : 0);
                image_put(&raw, value, bits / 8, 1);
            }
        }
    }
    uint32_t a = 1, b = 0; /* Adler-32 */
    for (size_t i = 0; i < raw.n; i++) {
        a = (a + raw.data[i]) % 65521;
        b = (b + a) % 65521;
    }
    image_put(&packed, 0x7801, 2, 1);
    image_put(&packed, 1, 1, 1);
    image_put(&packed, (uint32_t)raw.n | (~(uint32_t)raw.n & 0xffffu) << 16, 4, 0);
    memcpy(packed.data + packed.n, raw.data, raw.n);
    packed.n += raw.n;
    image_put(&packed, b << 16 | a, 4, 1);
    memcpy(file.data, "\x89PNG\r\n\x1a\n", 8);
    file.n = 8;
    image_png_chunk(&file, "IHDR", head.data, head.n);
    for (; texts && texts[0]; texts += 2) {
        char text[200];
        const size_t n_key = strlen(texts[0]) + 1, n_text = strlen(texts[1]);
        memcpy(text, texts[0], n_key);
        memcpy(text + n_key, texts[1], n_text);
        image_png_chunk(&file, "tEXt", text, n_key + n_text);
    }
    image_png_chunk(&file, "IDAT", packed.data, packed.n);
    image_png_chunk(&file, "IEND", NULL, 0);
    return file;
}

#endif
