/* The options of preparation and how their values are read. */
#include "bench/cli/prep.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/scan.h"
#include "core/prep.h"

/* A plain number in an interval. */
static dif_status read_real(const char *text, const char *interval, const char *want, double *out, dif_error *err)
{
    dif_range range;
    if (strchr(text, ':') || dif_range_parse(text, &range, NULL) != DIF_OK)
        return dif_fail(err, DIF_ERR_ARG, "not a number, expected a plain decimal number");
    if (!dif_cli_in_interval(range.min, interval))
        return dif_fail(err, DIF_ERR_ARG, "out of range, expected %s", want);
    *out = range.min;
    return DIF_OK;
}

static dif_status read_above_0(const char *text, dif_cli_step *step, dif_error *err)
{
    return read_real(text, "(0, inf)", "more than 0", &step->value, err);
}

static dif_status read_angle(const char *text, dif_cli_step *step, dif_error *err)
{
    return read_real(text, "[-360, 360]", "at least -360 and at most 360", &step->value, err);
}

static dif_status read_level(const char *text, dif_cli_step *step, dif_error *err)
{
    static const struct {
        const char *name;
        int choice;
    } words[] = {{"none", DIF_LEVEL_CHOICE_NONE}, {"auto", DIF_LEVEL_CHOICE_AUTO}, {"mean", 0}, {"plane", 1}};
    double degree = 0.0;
    for (int i = 0; i < DIF_COUNT(words); i++)
        if (strcmp(text, words[i].name) == 0) {
            step->choice = words[i].choice;
            return DIF_OK;
        }
    if (strncmp(text, "poly:", 5) != 0 || read_real(text + 5, "[0, 8]", "", &degree, NULL) || degree != floor(degree))
        return dif_fail(err, DIF_ERR_ARG, "unknown, expected none, auto, mean, plane or poly:N with N from 0 to %d",
                        DIF_LEVEL_DEGREE_MAX);
    step->choice = (int)degree;
    return DIF_OK;
}

static dif_status read_lines(const char *text, dif_cli_step *step, dif_error *err)
{
    const bool is_median = strcmp(text, "median") == 0;
    step->choice = is_median ? DIF_LINES_MEDIAN : DIF_LINES_DIFF;
    return is_median || strcmp(text, "diff") == 0 ? DIF_OK
                                                  : dif_fail(err, DIF_ERR_ARG, "unknown, expected median or diff");
}

static dif_status read_fill(const char *text, dif_cli_step *step, dif_error *err)
{
    const bool is_plate = !text || strcmp(text, "plate") == 0;
    step->choice = is_plate ? DIF_FILL_PLATE : DIF_FILL_LAPLACE;
    return is_plate || strcmp(text, "laplace") == 0 ? DIF_OK
                                                    : dif_fail(err, DIF_ERR_ARG, "unknown, expected plate or laplace");
}

static dif_status read_nothing(const char *text, dif_cli_step *step, dif_error *err)
{
    (void)text;
    (void)step;
    (void)err;
    return DIF_OK;
}

/* X0:X1,Y0:Y1 */
static dif_status read_box(const char *text, dif_cli_step *step, dif_error *err)
{
    static const char ends[] = ":,:";
    char number[64];
    for (int i = 0; i < 4; i++) {
        const size_t n = i < 3 ? strcspn(text, (char[2]){ends[i], '\0'}) : strlen(text);
        if (n >= sizeof number || (i < 3 && !text[n]))
            return dif_fail(err, DIF_ERR_ARG, "not a box, expected X0:X1,Y0:Y1 in um from the lower left corner");
        memcpy(number, text, n);
        number[n] = '\0';
        const dif_status status = read_real(number, "[0, inf)", "lengths of at least 0", &step->box[i], err);
        if (status)
            return status;
        text += n + (i < 3);
    }
    if (!(step->box[0] < step->box[1] && step->box[2] < step->box[3]))
        return dif_fail(err, DIF_ERR_ARG, "an empty box, expected X0 < X1 and Y0 < Y1");
    return DIF_OK;
}

/* One row a step, in the order of their enum. */
static const struct {
    const char *name;
    dif_status (*read)(const char *text, dif_cli_step *step, dif_error *err);
    const char *value, *help;
} STEPS[] = {
    [DIF_STEP_LEVEL] =
        {"level", read_level, "none|auto|mean|plane|poly:N",
         "subtract a least-squares plane or a polynomial of total degree N (0 to 8). auto: a plane, then "
         "degree 2 and 3 as long as each takes more than 5 % of the variance that is left"},
    [DIF_STEP_LINES] = {"lines", read_lines, "median|diff",
                        "shift each scan line: median of its heights to one height, or median of the steps from the "
                        "line before to 0"},
    [DIF_STEP_DESPIKE_NM] = {"despike-nm", read_above_0, "NM",
                             "replace points that differ by more from the median of the 5 x 5 around them"},
    [DIF_STEP_DESPIKE_SIGMA] = {"despike-sigma", read_above_0, "N",
                                "the same, in robust standard deviations of that difference"},
    [DIF_STEP_SCARS_NM] = {"scars-nm", read_above_0, "NM",
                           "replace strokes along x, up to 3 lines thick and at least 8 samples long, that differ by "
                           "more from the lines on both sides"},
    [DIF_STEP_SCARS_SIGMA] = {"scars-sigma", read_above_0, "N",
                              "the same, in robust standard deviations of the steps from line to line"},
    [DIF_STEP_FILL] = {"fill", read_fill, "[=plate|laplace]",
                       "interpolate missing points: plate (least bending, default) or laplace (never beyond the rim)"},
    [DIF_STEP_CROP] = {"crop-um", read_box, "X0:X1,Y0:Y1", "keep a part, in um from the lower left corner"},
    [DIF_STEP_RESAMPLE] = {"resample-nm", read_above_0, "NM", "resample to square pixels of this pitch"},
    [DIF_STEP_ROTATE] = {"rotate-deg", read_angle, "DEG",
                         "turn the sample counter-clockwise; keeps the largest rectangle inside"},
    [DIF_STEP_HIGHPASS] = {"highpass-um", read_above_0, "UM",
                           "subtract the Gaussian mean surface of this cut-off: a scanner's bow"},
    [DIF_STEP_WHOLE_PERIODS] = {"whole-periods", read_nothing, NULL,
                                "cut a grating to whole periods, its normal turned to the nearer axis (period and "
                                "direction are fitted)"},
    [DIF_STEP_CALIBRATE] = {"calibrate-nm", read_above_0, "NM",
                            "multiply the pitch so that the fitted period becomes this known one"},
};

const char *dif_cli_step_name(dif_cli_step_kind kind)
{
    return STEPS[kind].name;
}

dif_status dif_cli_prep_take(dif_cli_prep *prep, const char *name, const char *text, dif_error *err)
{
    if (prep->n == DIF_CLI_STEP_MAX)
        return dif_fail(err, DIF_ERR_ARG, "more than %d steps", DIF_CLI_STEP_MAX);
    dif_cli_step *step = &prep->step[prep->n];
    for (int i = 0; i < DIF_COUNT(STEPS); i++)
        if (strcmp(name, STEPS[i].name) == 0) {
            *step = (dif_cli_step){.kind = (dif_cli_step_kind)i, .text = text};
            const dif_status status = STEPS[i].read(text, step, err);
            prep->n += status == DIF_OK;
            return status;
        }
    return dif_fail(err, DIF_ERR_ARG, "unknown step");
}

static dif_status take(void *self, const char *name, const char *text, dif_error *err)
{
    return dif_cli_prep_take(self, name, text, err);
}

void dif_cli_add_prep(dif_cli *cli, dif_cli_prep *prep)
{
    const dif_opt heading[] = {
        {"Preparation of its heights (steps run in the order in which they are given)", DIF_OPT_HEADING, NULL, NULL,
         NULL, NULL, NULL},
    };
    const dif_opt with[] = {
        {"calibrate-with", DIF_OPT_TEXT, &prep->calibrate_with, NULL, "FILE",
         "fit that period to this scan of the known grating, not to the surface itself", NULL},
    };
    prep->sink = (dif_opt_sink){.take = take, .self = prep};
    dif_cli_add(cli, heading, DIF_COUNT(heading));
    for (int i = 0; i < DIF_COUNT(STEPS); i++) {
        const dif_opt opt = {STEPS[i].name, DIF_OPT_STEP, &prep->sink, NULL, STEPS[i].value, STEPS[i].help, NULL};
        dif_cli_add(cli, &opt, 1);
    }
    dif_cli_add(cli, with, DIF_COUNT(with));
}
