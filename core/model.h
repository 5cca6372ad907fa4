/* A surface made ready to be read by one method: what an evaluator (core/evaluator.h) takes in, on the CPU as on the GPU.
 * Does not: own what it points to, build it (bench/model_build.h). */
#ifndef DIF_MODEL_H
#define DIF_MODEL_H

#include "core/fresnel.h"
#include "core/lut.h"
#include "core/nmm.h"
#include "core/plan.h"
#include "core/replica.h"
#include "core/shadow.h"
#include "core/sheet.h"
#include "core/stam.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_model_kind {
    DIF_MODEL_SHEET, /* the sheet transform at the wanted wavelength; colours by full sampling        */
    DIF_MODEL_NMM,   /* core/nmm.h on a sheet: a direction's own few wavelengths                      */
    DIF_MODEL_PQ,    /* core/replica.h: one period patch's sheet times the geometric factor           */
    DIF_MODEL_LUT,   /* core/lut.h: colours only                                                      */
    DIF_MODEL_STAM   /* core/stam.h: closed form, no sheet                                            */
} dif_model_kind;

/* "sheet", "nmm", "pq", "lut", "stam". */
const char *dif_model_kind_name(dif_model_kind kind);

/* Members that a kind does not name are ignored. */
typedef struct dif_model {
    dif_model_kind kind;
    int n_sheet;                   /* sheet, nmm, pq: windows whose powers are averaged, >= 1           */
    const dif_sheet *const *sheet; /* sheet[n_sheet]: all lines of one azimuth (tables only) or all volumes */
    const double *share;           /* share[n_sheet], summing to 1                                      */
    dif_nmm nmm;                   /* nmm                                                               */
    dif_replica replica;           /* pq                                                                */
    dif_stam stam;                 /* stam                                                              */
    const dif_lut *lut;            /* lut                                                               */
    int n_lambda;                  /* colours of sheet, pq, stam: the wavelengths that are summed       */
    const double *lambda_um;       /* lambda_um[n_lambda], ascending                                    */
    dif_quantity quantity;         /* of values and colours; lut, and colours in general: power or rho  */
    dif_index index;               /* of the material                                                   */
    double area_um2;               /* (T^2 sum W)^2 / (T^2 sum W^2), for brdf                           */
    const dif_shadow *shadow;      /* S in rho and brdf, of values and colours; NULL = 1                */
} dif_model;

/* DIF_OK if the members of the kind are there and in range; DIF_ERR_ARG or DIF_ERR_UNSUPPORTED otherwise. */
DIF_MUST_USE dif_status dif_model_check(const dif_model *model, dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
