/* The DFT, on OpenCV: forward kernel exp(+i 2 pi q n / N), unscaled (core/conventions.h).
 * Does not: plan or cache; sizes should come from dif_fft_size. */
#ifndef DIF_FFT_H
#define DIF_FFT_H

#include <stdbool.h>

#include "core/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Smallest fast size >= n (products of 2, 3, 5), n >= 1. */
int dif_fft_size(int n);

/* Transforms each of n_row rows of n complex numbers, in place. single: data are float pairs, else double pairs.
 * Status    DIF_ERR_ARG, DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_fft_rows(void *data, int n_row, int n, bool single, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
