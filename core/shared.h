/* Numbers that C and GLSL agree on: preprocessor lines only, valid in both. */
#ifndef DIF_SHARED_H
#define DIF_SHARED_H

/* Lists of number pairs travel as textures of 2^DIF_LIST_SHIFT texels a row. */
#define DIF_LIST_SHIFT 11

/* Work groups of the compute shaders: DIF_GROUP x DIF_GROUP. */
#define DIF_GROUP 8

/* dif_model_kind */
#define DIF_KIND_IS_SHEET 0
#define DIF_KIND_IS_NMM   1
#define DIF_KIND_IS_PQ    2
#define DIF_KIND_IS_LUT   3
#define DIF_KIND_IS_STAM  4

/* dif_quantity */
#define DIF_QUANTITY_IS_POWER 0
#define DIF_QUANTITY_IS_RHO   1
#define DIF_QUANTITY_IS_BRDF  2

/* dif_gpu_fault */
#define DIF_FAULT_IS_NONE  0
#define DIF_FAULT_IS_PLANE 1
#define DIF_FAULT_IS_SIGN  2
#define DIF_FAULT_IS_TAP   3

/* dif_shadowing */
#define DIF_SHADOWING_IS_NONE    0
#define DIF_SHADOWING_IS_VCAVITY 1

/* Lights of a rendering: DIF_LIGHT_MAX. */
#define DIF_RENDER_LIGHTS 8
/* DIF_LUT_MAP_MAX, DIF_MESO_PROBES, DIF_LUT_FILTER_PROBES, dif_filter. */
#define DIF_RENDER_MAPS      48
#define DIF_RELIEF_PROBES    16
#define DIF_BLUR_PROBES      9
#define DIF_FILTER_IS_NONE   0
#define DIF_FILTER_IS_MIP    1
#define DIF_FILTER_IS_SLOPES 2

/* What a shader answers: one texel holds 4 queries, 4 angles of one wavelength, or the colour of 1 direction. */
#define DIF_JOB_IS_VALUES  0
#define DIF_JOB_IS_TABLE   1
#define DIF_JOB_IS_COLOURS 2

/* Entries of the lists, in pairs. A direction: 3 coordinates on the sheet's axes, the two cosines, and from
 * DIF_DIR_MORE on what the method adds: pq (u, v); nmm the coordinates over s, (first bin, number of bins), D s. A query's
 * coordinates are those times 2 pi / lambda; its DIF_DIR_BINS is the wavelength that is read, DIF_DIR_REACH the one asked.
 * Last, for shadowing, (x, y) of the two directions. */
#define DIF_DIR_COSINES 3
#define DIF_DIR_MORE    4
#define DIF_DIR_BINS    7
#define DIF_DIR_REACH   8
#define DIF_DIR_WI      9
#define DIF_DIR_WO      10
#define DIF_DIR_STRIDE  11
/* A wave: factors of the 3 coordinates that give positions in bins; 2 of (u, v) that give turns of a period; weights
 * (X, Y), (Z, wavelength in um). */
#define DIF_WAVE_TURNS  3
#define DIF_WAVE_XY     5
#define DIF_WAVE_Z      6
#define DIF_WAVE_STRIDE 7
/* A wavelength asked of nmm: 1/lambda, (index of the fixed wave that stands for it, the wavelength itself). */
#define DIF_ASK_STRIDE 2

#endif
