/* What the fuzz targets share: a copy of the input of its own exact size, and promises that end the program if broken. */
#ifndef DIF_FUZZ_H
#define DIF_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/io/field_io.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);

#define FUZZ_PROMISE(condition)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: broken promise: %s\n", __FILE__, __LINE__, #condition);                            \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/* Reads bytes as a heightfield and holds the result to what field_io.h says of it. */
static inline dif_status fuzz_field(const unsigned char *data, size_t n, const dif_field_request *request,
                                    dif_field_file *file)
{
    dif_error err = {0}, err_check;
    const dif_status status = dif_field_parse(data, n, "input", request, file, &err);
    FUZZ_PROMISE(status == err.status || status == DIF_OK);
    if (status) {
        FUZZ_PROMISE(strncmp(err.text, "input: ", 7) == 0);
        FUZZ_PROMISE(!file->field.z_um && file->field.nx == 0);
    } else {
        const dif_status check = dif_field_check(&file->field, &err_check);
        FUZZ_PROMISE(check == DIF_OK || (check == DIF_ERR_NONFINITE && request && request->allow_missing));
        FUZZ_PROMISE(memchr(file->title, '\0', sizeof file->title) &&
                     memchr(file->warning, '\0', sizeof file->warning));
    }
    return status;
}

/* Lists the channels and reads the first few, each of which must be as listed, and hold a sample for every so many bytes
 * of the file at most. */
static inline void fuzz_channels(const unsigned char *data, size_t n, const dif_field_request *request, size_t bytes)
{
    dif_channels channels;
    dif_error err = {0};
    const dif_status status = dif_field_channels_parse(data, n, "input", &channels, &err);
    FUZZ_PROMISE(status ? strncmp(err.text, "input: ", 7) == 0 && !channels.channel : channels.n > 0);
    FUZZ_PROMISE(status || (channels.preferred >= -1 && channels.preferred < channels.n));
    for (int i = 0; i < channels.n && i < 4; i++) {
        const dif_channel *channel = &channels.channel[i];
        dif_field_request numbered = *request;
        dif_field_file file;
        char number[16];
        int index = -1;
        FUZZ_PROMISE(memchr(channel->name, '\0', sizeof channel->name) &&
                     memchr(channel->unit, '\0', sizeof channel->unit));
        snprintf(number, sizeof number, "%d", i + 1);
        numbered.channel = number;
        if (dif_channels_find(&channels, number, &index, NULL) == DIF_OK && index == i &&
            fuzz_field(data, n, &numbered, &file) == DIF_OK) {
            FUZZ_PROMISE(file.channel == i + 1 && file.n_channel == channels.n);
            FUZZ_PROMISE(file.field.nx == channel->nx && file.field.ny <= channel->ny);
            FUZZ_PROMISE(dif_field_n(&file.field) <= n / bytes);
            dif_field_file_free(&file);
        }
    }
    dif_channels_free(&channels);
}

/* Everything a file may leave unsaid, or nothing, by a bit of the input. */
static inline dif_field_request fuzz_request(int bits)
{
    dif_field_request request = dif_field_request_default();
    if (bits & 1)
        request.pixel_um = 0.05;
    else if (bits & 2)
        request.size_um = 65.0;
    if (bits & 4)
        request.height_um = 0.3;
    if (bits & 8)
        request.z_unit = "nm";
    request.allow_missing = bits & 16;
    return request;
}

/* Reads an input as a file with channels: the first byte says what the request leaves unsaid, the rest follows a magic. */
static inline void fuzz_after_magic(const char *magic, size_t n_magic, const uint8_t *data, size_t n, size_t bytes)
{
    unsigned char *file = malloc(n_magic + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, magic, n_magic);
    memcpy(file + n_magic, data + 1, n - 1);
    const dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    (void)!fuzz_field(file, n_magic + n - 1, &request, &field);
    dif_field_file_free(&field);
    fuzz_channels(file, n_magic + n - 1, &request, bytes);
    free(file);
}

#endif
