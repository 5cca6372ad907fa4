/* The CIE tables that colour needs, 380 to 780 nm. Not installed.  Does not: interpolate (core/spectrum.h). */
#ifndef DIF_CIE_DATA_H
#define DIF_CIE_DATA_H

enum { DIF_CIE_N_OBSERVER = 401, DIF_CIE_N_D65 = 81 };

extern const double dif_cie_observer[DIF_CIE_N_OBSERVER][3]; /* x, y, z bar, from 380 nm, 1 nm apart */
extern const double dif_cie_d65[DIF_CIE_N_D65];              /* relative power, from 380 nm, 5 nm apart */

#endif
