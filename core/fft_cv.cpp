#include "core/fft.h"

#include <opencv2/core.hpp>

#include "core/guard.hpp"

int dif_fft_size(int n)
{
    return cv::getOptimalDFTSize(n);
}

dif_status dif_fft_rows(void *data, int n_row, int n, bool single, dif_error *err)
{
    return dif_guard(err, [&] {
        if (!data || n_row < 1 || n < 1)
            return dif_fail(err, DIF_ERR_ARG, "DFT of %d rows of %d", n_row, n);
        cv::Mat rows(n_row, n, single ? CV_32FC2 : CV_64FC2, data);
        // OpenCV's inverse kernel is exp(+i...), which is our forward one; without DFT_SCALE it is unscaled.
        cv::dft(rows, rows, cv::DFT_INVERSE | cv::DFT_ROWS);
        return DIF_OK;
    });
}
