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
        FUZZ_PROMISE(dif_field_check(&file->field, &err_check) == DIF_OK);
        FUZZ_PROMISE(memchr(file->title, '\0', sizeof file->title) &&
                     memchr(file->warning, '\0', sizeof file->warning));
    }
    return status;
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
    return request;
}

#endif
