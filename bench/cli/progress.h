/* A progress bar on stderr, drawn only if that is a terminal and --quiet was not given.
 * Does not: keep time. */
#ifndef DIF_PROGRESS_H
#define DIF_PROGRESS_H

#include <stdbool.h>

typedef struct dif_progress {
    const char *label;
    bool on;
    int percent; /* last drawn, -1 = none */
} dif_progress;

dif_progress dif_progress_begin(const char *label, bool quiet);

/* Draws share in [0, 1]; `self` is a dif_progress: fits the progress members of dif_measure_opts. */
void dif_progress_draw(void *self, double share);

/* Wipes the bar. */
void dif_progress_end(dif_progress *progress);

#endif
