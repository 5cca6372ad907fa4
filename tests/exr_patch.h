/* Changes in the bytes of an EXR file: the damage that readers must see. */
#ifndef DIF_TEST_EXR_PATCH_H
#define DIF_TEST_EXR_PATCH_H

#include "tests/near.h"

#include <string.h>

/* The text of a string attribute in the bytes of a file; fails if there is none. */
static inline unsigned char *exr_patch_text(unsigned char *data, size_t n, const char *name)
{
    const size_t n_name = strlen(name) + 1;
    for (size_t at = 0; at + n_name + 11 < n; at++)
        if (memcmp(data + at, name, n_name) == 0 && memcmp(data + at + n_name, "string", 7) == 0)
            return data + at + n_name + 7 + 4; /* behind the type and the length */
    fail_msg("no attribute %s", name);
    return NULL;
}

#endif
