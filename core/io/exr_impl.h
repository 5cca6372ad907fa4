/* An opened EXR file, for the files that read it. */
#ifndef DIF_EXR_IMPL_H
#define DIF_EXR_IMPL_H

#include <openexr.h>

#include "core/io/exr_io.h"

struct dif_exr {
    dif_source source;
    exr_context_t context;
    int nx, ny, x0, y0; /* data window */
    bool tiled;
    bool no_memory;   /* the library was refused memory; it does not always say so in its result */
    char reason[160]; /* first complaint of the library */
};

/* The status of a result code, with the library's first complaint. */
dif_status dif_exr_fail(const dif_exr *exr, exr_result_t code, const char *what, dif_error *err);

#endif
