/* The plane factors: from heights to exp(-i W_l h) for all planes by a three-term recurrence. */
#include <string.h>

#include "core/sheet_impl.h"
#include "core/simd.h"

enum { LANES = 8, GROUPS = DIF_SHEET_BLOCK / LANES };

/* The recurrence's start for one block: factors of two neighbouring planes and twice the cosine of the step. */
typedef struct seeds {
    double c0[DIF_SHEET_BLOCK], s0[DIF_SHEET_BLOCK];
    double c1[DIF_SHEET_BLOCK], s1[DIF_SHEET_BLOCK];
    double twice_cos[DIF_SHEET_BLOCK];
} seeds;

/* Heights about the middle and weights times the height correction; lanes beyond n get weight 0. */
DIF_INLINE void load_block(const dif_plane_factors *f, int n, const double *z_um, const double *weight,
                           double weight_row, double *h, double *amp)
{
    for (int j = 0; j < n; j++) {
        h[j] = z_um[j] - f->mid_um;
        amp[j] = weight[j] * weight_row;
    }
    for (int j = n; j < DIF_SHEET_BLOCK; j++)
        h[j] = amp[j] = 0.0;
}

DIF_CLONES static void make_seeds(const dif_plane_factors *f, const double *h, double *amp, int plane0, seeds *out)
{
    const double inv_half = 1.0 / f->half_um, start = f->first + plane0;
    const int degree = f->height_gain.degree;
    double phase[DIF_SHEET_BLOCK], step[DIF_SHEET_BLOCK], cos_step[DIF_SHEET_BLOCK], sin_step[DIF_SHEET_BLOCK];
    for (int j = 0; j < DIF_SHEET_BLOCK; j += LANES) {
        const dif_v8d share = *(const dif_v8du *)(h + j) * inv_half;
        const dif_v8d x = share * share - 0.5;
        dif_v8d gain = x * 0.0 + f->height_gain.coef[degree];
        for (int k = degree - 1; k >= 0; k--)
            gain = gain * x + f->height_gain.coef[k];
        *(dif_v8du *)(amp + j) *= gain;
    }
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++) {
        step[j] = -f->step * h[j];
        phase[j] = start * step[j];
    }
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++)
        cos_step[j] = cos(step[j]);
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++)
        sin_step[j] = sin(step[j]);
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++)
        out->c0[j] = cos(phase[j]);
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++)
        out->s0[j] = sin(phase[j]);
#pragma omp simd
    for (int j = 0; j < DIF_SHEET_BLOCK; j++) {
        const double c0 = amp[j] * out->c0[j], s0 = amp[j] * out->s0[j];
        out->c0[j] = c0;
        out->s0[j] = s0;
        out->c1[j] = c0 * cos_step[j] - s0 * sin_step[j];
        out->s1[j] = s0 * cos_step[j] + c0 * sin_step[j];
        out->twice_cos[j] = 2.0 * cos_step[j];
    }
}

/* cos((l+1)t) = 2 cos t cos(l t) - cos((l-1)t), likewise the sine: two multiply-adds a plane. */
DIF_CLONES static void add_waves(const seeds *start, int n_plane, double *acc)
{
    for (int j = 0; j < DIF_SHEET_BLOCK; j += LANES) {
        const dif_v8d t = *(const dif_v8du *)(start->twice_cos + j);
        dif_v8d c0 = *(const dif_v8du *)(start->c0 + j), c1 = *(const dif_v8du *)(start->c1 + j);
        dif_v8d s0 = *(const dif_v8du *)(start->s0 + j), s1 = *(const dif_v8du *)(start->s1 + j);
        double *at = acc + j;
        for (int l = 0; l < n_plane; l++, at += (size_t)2 * DIF_SHEET_BLOCK) {
            *(dif_v8du *)at += c0;
            *(dif_v8du *)(at + DIF_SHEET_BLOCK) += s0;
            const dif_v8d c2 = t * c1 - c0, s2 = t * s1 - s0;
            c0 = c1;
            c1 = c2;
            s0 = s1;
            s1 = s2;
        }
    }
}

/* Powers ((h - mid)/half)^l: the Taylor method's planes. */
DIF_CLONES static void add_powers(const dif_plane_factors *f, const double *h, const double *amp, int plane0,
                                  int n_plane, double *acc)
{
    const double inv_half = 1.0 / f->half_um;
    for (int j = 0; j < DIF_SHEET_BLOCK; j += LANES) {
        const dif_v8d share = *(const dif_v8du *)(h + j) * inv_half;
        dif_v8d power = *(const dif_v8du *)(amp + j);
        for (int l = 0; l < plane0; l++)
            power *= share;
        double *at = acc + j;
        for (int l = 0; l < n_plane; l++, at += (size_t)2 * DIF_SHEET_BLOCK) {
            *(dif_v8du *)at += power;
            power *= share;
        }
    }
}

void dif_plane_factors_add(const dif_plane_factors *factors, int n, const double *z_um, const double *weight,
                           double weight_row, int plane0, int n_plane, double *acc)
{
    double h[DIF_SHEET_BLOCK], amp[DIF_SHEET_BLOCK];
    load_block(factors, n, z_um, weight, weight_row, h, amp);
    if (factors->basis == DIF_BASIS_POWERS) {
        add_powers(factors, h, amp, plane0, n_plane, acc);
        return;
    }
    seeds start;
    make_seeds(factors, h, amp, plane0, &start);
    add_waves(&start, n_plane, acc);
}
