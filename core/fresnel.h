/* Fresnel reflectance in Schlick's form.  Does not: polarisation. */
#ifndef DIF_FRESNEL_H
#define DIF_FRESNEL_H

#ifdef __cplusplus
extern "C" {
#endif

/* Complex refractive index n + i kappa of the sample. */
typedef struct dif_index {
    double n, kappa; /* n > 0, kappa >= 0 */
} dif_index;

/* n = 1.5, kappa = 0. */
dif_index dif_index_default(void);

/* Power reflectance R = [(n-1)^2 + 4n(1-c)^5 + kappa^2] / [(n+1)^2 + kappa^2]      Schlick 1994 with absorption
 *
 * Given     cos_h  cosine between wo and the half vector, in [0, 1]
 * Returns   R in [0, 1], ratio of powers */
double dif_fresnel_schlick(dif_index index, double cos_h);

#ifdef __cplusplus
}
#endif
#endif
