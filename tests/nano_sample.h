/* Small NanoScope files: a header put together from lines, and samples behind it. */
#ifndef DIF_TEST_NANO_SAMPLE_H
#define DIF_TEST_NANO_SAMPLE_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/io_cases.h"

enum { NANO_HEADER = 4096, NANO_MAX = 16384 };

typedef struct nano_file {
    unsigned char data[NANO_MAX];
    size_t n;      /* of the header while lines are put, then of the file */
    size_t n_data; /* of all samples put so far                          */
} nano_file;

/* A line with its end. */
static inline void nano_line(nano_file *file, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int n = vsnprintf((char *)file->data + file->n, NANO_HEADER - file->n, format, args);
    va_end(args);
    if (n < 0 || file->n + (size_t)n + 2 > NANO_HEADER)
        abort();
    memcpy(file->data + file->n + n, "\r\n", 2);
    file->n += (size_t)n + 2;
}

/* The sections that hold for all channels, as version 7 writes them. */
static inline void nano_begin(nano_file *file, const char *magic, const char *version)
{
    memset(file, 0, sizeof *file);
    nano_line(file, "%s", magic);
    if (version)
        nano_line(file, "\\Version: %s", version);
    nano_line(file, "\\Data length: %d", NANO_HEADER);
    nano_line(file, "\\*Scanner list");
    nano_line(file, "\\@Sens. Zsens: V 20.00000 nm/V");
    nano_line(file, "\\*Ciao scan list");
    nano_line(file, "\\Scan Size: 3000 nm");
    nano_line(file, "\\Lines: 2");
    nano_line(file, "\\@Sens. ZsensSens: V 0.5000000 ~m/V");
    nano_line(file, "\\@Sens. Phase: V 1.000000 ");
    nano_line(file, "\\@Sens. Amplitude Error: V 1.000000 ");
}

/* A channel section of 3 x 2 samples without its kind and scale; its samples follow those before. */
static inline void nano_channel(nano_file *file, int sample_bytes, int bytes_pixel)
{
    nano_line(file, "\\*Ciao image list");
    nano_line(file, "\\Data offset: %zu", (size_t)NANO_HEADER + file->n_data);
    nano_line(file, "\\Data length: %d", 6 * sample_bytes);
    if (bytes_pixel)
        nano_line(file, "\\Bytes/pixel: %d", bytes_pixel);
    nano_line(file, "\\Samps/line: 3");
    nano_line(file, "\\Number of lines: 2");
    nano_line(file, "\\Aspect Ratio: 1:1");
    nano_line(file, "\\Scan Size: 3 2 ~m");
    file->n_data += 6 * (size_t)sample_bytes;
}

/* Ends the header and writes value[n] as samples of so many bytes. */
static inline void nano_end(nano_file *file, int sample_bytes, const long *value, int n)
{
    nano_line(file, "\\*File list end");
    file->data[file->n] = 0x1a;
    file->n = NANO_HEADER;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < sample_bytes; k++)
            file->data[file->n++] = (unsigned char)((unsigned long)value[i] >> (8 * k));
    }
}

static const char NANO_MAGIC[] = "\\*File list", NANO_HEIGHT[] = "\\@2:Image Data: S [Height] \"Height\"",
                  NANO_SCALE[] = "\\@2:Z scale: V [Sens. Zsens] (0.5000000 V/LSB) 10.00000 V";
static const long NANO_SIX[] = {-3, 5, 7, 1000, -32768, 32767}; /* the bottom line first */
static const int NANO_PLACE[] = {3, 4, 5, 0, 1, 2};             /* of each in the picture, row 0 at the top */

/* One height channel of 16 bits under this version, with lines of one's own. */
static inline nano_file nano_make(const char *version, const char *scale)
{
    nano_file file;
    nano_begin(&file, NANO_MAGIC, version);
    nano_channel(&file, 2, 2);
    nano_line(&file, "%s", NANO_HEIGHT);
    nano_line(&file, "%s", scale);
    nano_end(&file, 2, NANO_SIX, 6);
    return file;
}

/* Reads the only or named channel of a file whose samples are NANO_SIX; each is factor_um times its integer. */
static inline void assert_nano_six(const nano_file *nano, const char *channel, double factor_um)
{
    dif_field_request request = dif_field_request_default();
    dif_field_file file;
    dif_error err;
    request.channel = channel;
    if (parse_bytes(nano->data, nano->n, &request, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "nanoscope");
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    for (int i = 0; i < 6; i++)
        assert_near(file.field.z_um[NANO_PLACE[i]], (double)NANO_SIX[i] * factor_um, 1e-15, 0.0); /* four products */
    dif_field_file_free(&file);
}

#endif
