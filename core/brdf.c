#include "core/brdf.h"

#include <math.h>

double dif_brdf_reflectance(dif_index index, dif_vec3 wi, dif_vec3 wo)
{
    /* wo . half = sqrt((1 + wi.wo) / 2) for unit vectors */
    return dif_fresnel_schlick(index, sqrt(fmax(0.5 * (1.0 + dif_vec3_dot(wi, wo)), 0.0)));
}

double dif_brdf_gain_rho(dif_index index, dif_vec3 wi, dif_vec3 wo)
{
    const double share = dif_brdf_reflectance(index, wi, wo) / dif_fresnel_schlick(index, 1.0);
    const double g = (1.0 + dif_vec3_dot(wi, wo)) / (wi.z + wo.z);
    return share * g * g / wo.z;
}

double dif_brdf_gain_per_sr(dif_index index, dif_vec3 wi, dif_vec3 wo, double lambda_um, double area_um2)
{
    const double reflectance = dif_brdf_reflectance(index, wi, wo);
    return dif_brdf_gain_efficiency(reflectance, wi, wo) * area_um2 / (lambda_um * lambda_um);
}

double dif_brdf_gain(dif_quantity quantity, dif_index index, dif_vec3 wi, dif_vec3 wo, double lambda_um,
                     double area_um2)
{
    switch (quantity) {
    case DIF_QUANTITY_POWER:
        return 1.0;
    case DIF_QUANTITY_RHO:
        return dif_brdf_gain_rho(index, wi, wo);
    case DIF_QUANTITY_BRDF:
        return dif_brdf_gain_per_sr(index, wi, wo, lambda_um, area_um2);
    }
    return NAN;
}

double dif_brdf_gain_efficiency(double reflectance, dif_vec3 wi, dif_vec3 wm)
{
    const double g = (1.0 + dif_vec3_dot(wi, wm)) / (wi.z + wm.z);
    return reflectance * g * g / (wi.z * wm.z);
}
