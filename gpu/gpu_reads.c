/* What a colour costs in texture reads: counted as the shaders read, evaluate.glsl and evaluate_lut.glsl. */
#include "gpu/gpu_eval_impl.h"

enum {
    READS_PLACE = 3,   /* coordinates of a direction                                       */
    READS_WAVE = 3,    /* their factors                                                    */
    READS_WEIGHTS = 2, /* (X, Y), Z                                                        */
    READS_OBSERVER = 4 /* nmm: two neighbours of the spectrum, instead of weights          */
};

/* Of the gain: cosines, and for shadowing by a table both directions and what is read of it for each. */
static double reads_of_gain(const dif_model *model)
{
    if (model->quantity == DIF_QUANTITY_POWER)
        return 0.0;
    const bool by_table = model->shadow && model->shadow->n_row > 0;
    return 1.0 + (by_table ? 2.0 + 2.0 * (model->shadow->n_column > 1 ? 4.0 : 2.0) : 0.0);
}

/* Of the taps around one wave of all sheets. */
static double reads_of_taps(const dif_model *model)
{
    const dif_sheet_info info = dif_sheet_info_of(model->sheet[0]);
    const double n_tap = info.n_tap;
    return n_tap * n_tap * (info.is_line ? 1.0 : n_tap);
}

double dif_gpu_reads_of_colour(const dif_model *model, double n_wave)
{
    const double gain = reads_of_gain(model), place = READS_PLACE + READS_WAVE;
    switch (model->kind) {
    case DIF_MODEL_LUT:
        return READS_PLACE + (3 * model->lut->n_map + 3) / 4 + gain;
    case DIF_MODEL_STAM: /* two coordinates */
        return n_wave * (2.0 + 2.0 + READS_WEIGHTS) + (gain > 0.0 ? READS_PLACE + gain : 0.0);
    case DIF_MODEL_SHEET:
    case DIF_MODEL_NMM:
    case DIF_MODEL_PQ:
        break;
    }
    double wave = place + READS_WEIGHTS + reads_of_taps(model), once = gain > 0.0 ? READS_PLACE + gain : 0.0;
    if (model->kind == DIF_MODEL_PQ)
        wave += 4.0; /* two places of a period and their factors */
    if (model->kind == DIF_MODEL_NMM) {
        wave += READS_OBSERVER - READS_WEIGHTS;
        once += 2.0; /* which bins */
    }
    return model->n_sheet * (n_wave * wave + once);
}
