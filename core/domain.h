/* How far a result of scalar theory can be trusted, as rules of thumb held against rigorous theory.
 * Source: sweeps of sinusoidal and blazed gratings, perfect conductor, unpolarised, over period/wavelength 1.3 to 20,
 * height/wavelength 0.05 to 1 and angles of incidence to 75 degrees; tests/test_domain.c holds the rules to them.
 * Does not: correct anything; the places of orders (grating equation) hold whatever this says. */
#ifndef DIF_DOMAIN_H
#define DIF_DOMAIN_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_relief {
    DIF_RELIEF_SMOOTH,  /* no walls: sinusoid, and anything whose slopes stay gentle               */
    DIF_RELIEF_WALLS,   /* vertical or steep steps: blazed, lamellar                               */
    DIF_RELIEF_MEASURED /* a scan: judged as smooth, but never more than DIF_TRUST_DOMINANT        */
} dif_relief;

typedef enum dif_trust {
    DIF_TRUST_NONE,     /* powers are not to be trusted                                            */
    DIF_TRUST_DOMINANT, /* each order's share of the power is right to 10 % of the whole: the strongest
                           orders may be believed, the weak ones not                               */
    DIF_TRUST_SHARES    /* shares of the power are right to 5 % of the whole, all orders together  */
} dif_trust;

/* "none", "dominant", "shares". */
const char *dif_trust_name(dif_trust trust);

/* The verdict on order powers.
 *
 *   smooth    shares    d/lambda >= 5 with (theta <= 30 deg and h/lambda <= 0.35, or theta <= 75 deg and h/lambda <= 0.1)
 *             dominant  d/lambda >= 2.5, theta <= 75 deg, h/lambda <= 0.35;  d/lambda >= 5, theta <= 30 deg, h/lambda <= 1
 *   walls     dominant  theta <= 15 deg with (d/lambda >= 2.5 and h/lambda <= 0.5, or d/lambda >= 5 and h/lambda <= 1)
 *   measured  dominant  where smooth has dominant or shares
 *
 * Given     d_over_lambda  shortest main period over wavelength, > 0
 *           h_over_lambda  peak-to-valley height of the structure over wavelength, >= 0
 *           theta_rad      the steepest angle of incidence, sign ignored
 *           line           receives one plain sentence (static storage); may be NULL
 * Returns   the trust; DIF_TRUST_NONE also for NaN */
dif_trust dif_domain_verdict(dif_relief relief, double d_over_lambda, double h_over_lambda, double theta_rad,
                             const char **line);

#ifdef __cplusplus
}
#endif
#endif
