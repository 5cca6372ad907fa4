/* Preparation of a surface on the command line: steps in the order in which they were given.
 * Does not: compute (core/prep.h). */
#ifndef DIF_CLI_PREP_H
#define DIF_CLI_PREP_H

#include "bench/cli/options.h"
#include "core/io/field_io.h"

enum { DIF_CLI_STEP_MAX = 16 };

typedef enum dif_cli_step_kind {
    DIF_STEP_LEVEL,         /* degree; LEVEL_AUTO, LEVEL_NONE       */
    DIF_STEP_LINES,         /* method                               */
    DIF_STEP_DESPIKE_NM,    /* value                                */
    DIF_STEP_DESPIKE_SIGMA, /* value                                */
    DIF_STEP_SCARS_NM,      /* value                                */
    DIF_STEP_SCARS_SIGMA,   /* value                                */
    DIF_STEP_FILL,          /* method                               */
    DIF_STEP_CROP,          /* box: x0, x1, y0, y1 um               */
    DIF_STEP_RESAMPLE,      /* value: nm                            */
    DIF_STEP_ROTATE,        /* value: deg                           */
    DIF_STEP_HIGHPASS,      /* value: um                            */
    DIF_STEP_WHOLE_PERIODS, /*                                      */
    DIF_STEP_CALIBRATE      /* value: nm                            */
} dif_cli_step_kind;

typedef struct dif_cli_step {
    dif_cli_step_kind kind;
    double value;
    double box[4];
    int choice;       /* a degree or a method */
    const char *text; /* as given, or NULL    */
} dif_cli_step;

enum { DIF_LEVEL_CHOICE_AUTO = -1, DIF_LEVEL_CHOICE_NONE = -2 };

typedef struct dif_cli_prep {
    int n;
    dif_cli_step step[DIF_CLI_STEP_MAX];
    const char *calibrate_with; /* file of a calibration scan, or NULL */
    dif_opt_sink sink;          /* of the options, set by dif_cli_add_prep */
} dif_cli_prep;

struct dif_cli_surface; /* bench/cli/cli.h */

/* Adds the steps' options; *prep must stay where it is until the command line is parsed. */
void dif_cli_add_prep(dif_cli *cli, dif_cli_prep *prep);

/* The flag of a step, without dashes. */
const char *dif_cli_step_name(dif_cli_step_kind kind);

/* Takes one step from the command line.  Status DIF_ERR_ARG */
DIF_MUST_USE dif_status dif_cli_prep_take(dif_cli_prep *prep, const char *name, const char *text, dif_error *err);

/* Runs the steps on a surface that was read; says and notes in its history what each did. */
DIF_MUST_USE dif_status dif_cli_prep_apply(const dif_cli *cli, const char *path, const struct dif_cli_surface *surface,
                                           dif_field_file *file, dif_error *err);

#endif
