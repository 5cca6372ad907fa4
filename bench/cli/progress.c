#define _POSIX_C_SOURCE 200809L /* isatty */

#include "bench/cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

dif_progress dif_progress_begin(const char *label, bool quiet)
{
    return (dif_progress){.label = label, .on = !quiet && isatty(STDERR_FILENO), .percent = -1};
}

void dif_progress_draw(void *self, double share)
{
    enum { N_MARK = 40 };
    static const char marks[] = "########################################";
    dif_progress *progress = self;
    const int percent = (int)(100.0 * fmin(fmax(share, 0.0), 1.0));
    if (!progress->on || percent == progress->percent)
        return;
    progress->percent = percent;
    const int n_mark = percent * N_MARK / 100;
    fprintf(stderr, "\r%s [%.*s%*s] %3d %%", progress->label, n_mark, marks, N_MARK - n_mark, "", percent);
    fflush(stderr);
}

void dif_progress_end(dif_progress *progress)
{
    if (progress->on && progress->percent >= 0)
        fprintf(stderr, "\r\033[K");
    progress->on = false;
}
