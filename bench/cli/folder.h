/* Folders of results: making one, and names of files in it.
 * Does not: write files. */
#ifndef DIF_FOLDER_H
#define DIF_FOLDER_H

#include "core/status.h"

/* Makes the folder unless it is there. Status DIF_ERR_IO with the reason. */
DIF_MUST_USE dif_status dif_folder_make(const char *path, dif_error *err);

/* A name for the files of surface `number` (1, 2 ...): letters, digits and dashes of its file's name, with the number in
 * front if there are several; never a name that result files have themselves. */
void dif_folder_slug(const char *path, int number, int n_surface, char slug[64]);

#endif
