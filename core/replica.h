/* A period patch repeated N times along x and y: the exact geometric factor that turns one patch's amplitude into that
 * of all of them.
 *
 *   (1/N) sum_{j=0}^{N-1} exp(i kappa T (j - (N-1)/2)) = sin(N kappa T/2) / (N sin(kappa T/2)),  real, in [-1, 1]
 *
 * The sum is centred, so a patch given in the frame of core/conventions.h stands for replicas about that frame's
 * origin. Divided by N, so that |P / sum W| of one patch times this stays in [0, 1].
 * Does not: cut the patch (bench/measure.h), evaluate its amplitude. */
#ifndef DIF_REPLICA_H
#define DIF_REPLICA_H

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_REPLICA_MAX = 1000000 }; /* along one axis */

typedef struct dif_replica {
    int nx, ny;                      /* replicas along x and y, 1 ... DIF_REPLICA_MAX */
    double period_x_um, period_y_um; /* T along each, > 0                             */
} dif_replica;

/* DIF_OK, or DIF_ERR_ARG if a count or a period is out of range. */
DIF_MUST_USE dif_status dif_replica_check(const dif_replica *replica, dif_error *err);

/* sin(n x) / (n sin x), its limit +-1 at x = pi j.
 *
 * Given     n  1 ... DIF_REPLICA_MAX;  x finite
 * Returns   in [-1, 1].  Accuracy 1e-15 n |x| absolute: the rounding of x itself */
double dif_replica_ratio(int n, double x);

/* The factor of both axes at lateral kappa, rad/um. */
double dif_replica_factor(const dif_replica *replica, double kappa_x, double kappa_y);

#ifdef __cplusplus
}
#endif
#endif
