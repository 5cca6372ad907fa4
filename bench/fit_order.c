#include "bench/fit_order.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

/* Centres may be off by this share of the line's width before a ridge is no order any more; more if the angles may be
 * off, too. */
static double centre_share(const dif_fit_order_input *in)
{
    return in->loose ? 1.0 : 0.2;
}

/* Ridges that are no orders may hold this share of the weight. */
static const double left_over_share = 0.05;

static bool is_specular(const dif_fit_order_input *in, int k)
{
    return fabs(in->f_per_um[k]) < in->sigma_per_um;
}

/* Strongest ridge that is not the specular one, -1 if there is none. */
static int strongest(const dif_fit_order_input *in)
{
    int best = -1;
    for (int k = 0; k < in->n; k++)
        if (!is_specular(in, k) && (best < 0 || in->weight[k] > in->weight[best]))
            best = k;
    return best;
}

/* The order of ridge k for a base frequency, DIF_FIT_ORDER_NONE if it is none; m_strong scales the error of g. */
static int order_at(const dif_fit_order_input *in, int k, double g, int m_strong)
{
    if (is_specular(in, k))
        return 0;
    const double m = round(in->f_per_um[k] / g);
    const double allowed = centre_share(in) * in->sigma_per_um * fmax(1.0, fabs(m / m_strong));
    if (m == 0.0 || fabs(m) > 1000.0 || fabs(in->f_per_um[k] - m * g) > allowed)
        return DIF_FIT_ORDER_NONE;
    return (int)m;
}

/* Share of the weight (without the specular ridge) that orders of g explain; fills order[n]. Of two ridges with one
 * order the weaker is left over. */
static double explained(const dif_fit_order_input *in, double g, int m_strong, int *order)
{
    double sum = 0.0, total = 0.0;
    for (int k = 0; k < in->n; k++)
        order[k] = order_at(in, k, g, m_strong);
    for (int k = 0; k < in->n; k++)
        for (int j = 0; j < in->n; j++)
            if (j != k && order[k] != DIF_FIT_ORDER_NONE && order[j] == order[k] && in->weight[j] > in->weight[k])
                order[k] = DIF_FIT_ORDER_NONE;
    for (int k = 0; k < in->n; k++) {
        if (is_specular(in, k))
            continue;
        total += in->weight[k];
        sum += order[k] == DIF_FIT_ORDER_NONE ? 0.0 : in->weight[k];
    }
    return total > 0.0 ? sum / total : 0.0;
}

/* Nonzero orders inside the scan up to the highest one seen. */
static int orders_in_scan(const dif_fit_order_input *in, double g, int m_max)
{
    const double margin = 2.0 * in->sigma_per_um;
    int n = 0;
    for (int m = -m_max; m <= m_max; m++)
        n += m != 0 && m * g > in->f_low + margin && m * g < in->f_high - margin;
    return n;
}

/* Is a match by chance unlikely? Each further ridge lands within the tolerance of some order with chance
 * 2 tolerance / g; and a base frequency of which most orders are missing explains anything. */
static bool credible(const dif_fit_order_input *in, double g, int m_strong, const int *order)
{
    double chance = 1.0;
    int n_seen = 0, m_max = 1;
    for (int k = 0; k < in->n; k++) {
        if (order[k] == DIF_FIT_ORDER_NONE || order[k] == 0)
            continue;
        if (n_seen++ > 0)
            chance *= fmin(1.0, 2.0 * centre_share(in) * in->sigma_per_um / g);
        m_max = abs(order[k]) > m_max ? abs(order[k]) : m_max;
    }
    return (n_seen < 2 || chance < 0.1) && (m_strong == 1 || 2 * n_seen >= orders_in_scan(in, g, m_max));
}

static int gcd(int a, int b)
{
    while (b != 0) {
        const int r = a % b;
        a = b;
        b = r;
    }
    return a < 0 ? -a : a;
}

/* Common divisor of the orders, their number (without 0), and the two ends. */
static int common_divisor(int n, const int *order, int *n_seen)
{
    int divisor = 0;
    *n_seen = 0;
    for (int k = 0; k < n; k++)
        if (order[k] != DIF_FIT_ORDER_NONE && order[k] != 0) {
            divisor = gcd(divisor, order[k]);
            (*n_seen)++;
        }
    return divisor;
}

/* An order inside the scan that lies between multiples of the divisor, 0 if there is none. */
static int missing_order(const dif_fit_order_input *in, double g, int divisor)
{
    const double margin = 2.0 * in->sigma_per_um;
    const int low = (int)fmax(-1000.0, ceil((in->f_low + margin) / g));
    const int high = (int)fmin(1000.0, floor((in->f_high - margin) / g));
    for (int m = low; m <= high; m++)
        if (m % divisor != 0)
            return m;
    return 0;
}

/* A given order is held against what is there: if all orders share a divisor and the orders between them, inside the
 * scan, are missing, then the order is wrong or nothing supports it. */
static dif_status check_given(const dif_fit_order_input *in, double g, const int *order, int m, char note[160],
                              dif_error *err)
{
    int n_seen = 0;
    const int divisor = common_divisor(in->n, order, &n_seen);
    const int missing = divisor > 1 ? missing_order(in, g, divisor) : 0;
    if (n_seen > 1 && missing != 0)
        return dif_fail(err, DIF_ERR_FIT,
                        "order %d of the strongest ridge: all %d ridges would be multiples of %d while order %d inside "
                        "the scan is missing; order %d explains the same ridges",
                        m, n_seen, divisor, missing, m / divisor);
    if (n_seen == 1)
        snprintf(note, 160, "order %d as given: one ridge cannot check it%s", m,
                 missing ? ", and its neighbours are missing" : "");
    else if (divisor > 1)
        snprintf(note, 160, "order %d as given: all orders in the scan are multiples of %d", m, divisor);
    return DIF_OK;
}

/* The order of the strongest ridge that the caller fixes, by order or by a start period; 0 if none. */
static dif_status given_order(const dif_fit_order_input *in, int k, int *m, dif_error *err)
{
    *m = 0;
    const double f = in->f_per_um[k];
    if (in->order != DIF_FIT_ORDER_FIND) {
        *m = in->order;
        if (in->order * f < 0.0)
            return dif_fail(err, DIF_ERR_FIT, "order %d is given, but the strongest ridge lies at %.6g per um",
                            in->order, f);
    } else if (isfinite(in->period_start_um)) {
        const double place = f * in->period_start_um;
        if (!(fabs(place) > 0.5 && fabs(place) < 1000.0 && fabs(place - round(place)) < 0.2))
            return dif_fail(err, DIF_ERR_FIT, "the strongest ridge (%.6g per um) is no order of the start period %g um",
                            f, in->period_start_um);
        *m = (int)round(place);
    }
    return DIF_OK;
}

dif_status dif_fit_order_assign(const dif_fit_order_input *in, int *order, double *g_per_um, char note[160],
                                dif_error *err)
{
    note[0] = '\0';
    const int k = strongest(in);
    if (k < 0)
        return dif_fail(err, DIF_ERR_FIT, "only the specular ridge is in the scan: it has no period");
    int m = 0;
    dif_status status = given_order(in, k, &m, err);
    if (status != DIF_OK)
        return status;
    const int sign = in->f_per_um[k] < 0.0 ? -1 : 1;
    const int first = m != 0 ? m * sign : 1, last = m != 0 ? m * sign : DIF_FIT_ORDER_STRONGEST_MAX;
    for (int a = first; a <= last; a++) {
        const double g = fabs(in->f_per_um[k]) / a;
        if (explained(in, g, a, order) < 1.0 - left_over_share || (m == 0 && !credible(in, g, a, order)))
            continue;
        *g_per_um = g;
        if (m != 0)
            return check_given(in, g, order, m, note, err);
        int n_seen = 0;
        common_divisor(in->n, order, &n_seen);
        if (n_seen == 1)
            snprintf(note, 160, "order %d assumed: one ridge cannot determine its order", sign * a);
        return DIF_OK;
    }
    if (m != 0)
        return dif_fail(err, DIF_ERR_FIT,
                        "with order %d for the strongest ridge the %d ridges are not orders of one period", m, in->n);
    return dif_fail(err, DIF_ERR_FIT, "the %d ridges are not orders of one period", in->n);
}
