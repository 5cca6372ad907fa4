#define _POSIX_C_SOURCE 200809L /* mkdir */

#include "bench/cli/folder.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

dif_status dif_folder_make(const char *path, dif_error *err)
{
    struct stat about;
    if (mkdir(path, 0777) == 0)
        return DIF_OK;
    const int why = errno;
    if (why == EEXIST && stat(path, &about) == 0 && S_ISDIR(about.st_mode))
        return DIF_OK;
    return dif_fail(err, DIF_ERR_IO, "%s: cannot make the folder: %s", path, strerror(why));
}

void dif_folder_slug(const char *path, int number, int n_surface, char slug[64])
{
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    int n = 0;
    if (n_surface > 1)
        n = snprintf(slug, 64, "%d-", number);
    const char *dot = strrchr(name, '.');
    for (; *name && name != dot && n < 60; name++) {
        const unsigned char c = (unsigned char)*name;
        if (isalnum(c) && c < 0x80)
            slug[n++] = (char)tolower(c);
        else if (n > 0 && slug[n - 1] != '-')
            slug[n++] = '-';
    }
    while (n > 0 && slug[n - 1] == '-')
        n--;
    slug[n] = '\0';
    if (n == 0 || strcmp(slug, "results") == 0 || strcmp(slug, "report") == 0 || strcmp(slug, "compare") == 0)
        snprintf(slug, 64, "surface-%d", number);
}
