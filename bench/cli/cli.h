/* What the verbs share: surface and measurement options, reading a surface, provenance, JSON, talk.
 * Does not: parse the command line (bench/cli/options.h). */
#ifndef DIF_CLI_H
#define DIF_CLI_H

#include <jansson.h>

#include "bench/cli/cmd.h"
#include "bench/cli/options.h"
#include "bench/cli/prep.h"
#include "bench/cli/progress.h"
#include "bench/measure.h"
#include "core/io/field_io.h"
#include "core/io/manifest.h"
#include "core/plan.h"

#define DIF_COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

/* What the user says about a surface file; NaN and NULL = not said. */
typedef struct dif_cli_surface {
    double pixel_nm, size_um, height_um;
    const char *z_unit, *channel;
    dif_cli_prep prep; /* what is done to the heights before anything else */
} dif_cli_surface;

dif_cli_surface dif_cli_surface_default(void);
void dif_cli_add_surface(dif_cli *cli, dif_cli_surface *surface);
dif_field_request dif_cli_surface_request(const dif_cli_surface *surface);

/* Reads a surface, passes its warning on and prepares it as the user said; says so, and what each step did, and hints at
 * heights that were not levelled. Status as dif_field_read and of the steps, and DIF_ERR_SIZE for less than 2 x 2
 * samples. */
DIF_MUST_USE dif_status dif_cli_surface_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                             dif_field_file *out, dif_error *err);

/* How to measure. */
typedef struct dif_cli_measure {
    double tol;
    int method, quantity, window, average; /* the enums' numbers; average also DIF_AVERAGE_BY_SURFACE */
    int n_terms;
    bool single, no_jacobian;     /* taylor and thesis in float; nmm as the source had it        */
    double period_nm, groove_deg; /* pq, stam; NaN = from the surface                        */
    int n_replica;
    double sigma_um;
    double index_n, index_kappa;
    int n_check;
    int shadowing; /* the enum's number */
} dif_cli_measure;

#define DIF_AVERAGE_BY_SURFACE (-1) /* none for a synthetic surface of ours, welch for any other */

dif_cli_measure dif_cli_measure_default(void);

/* Adds the measurement options; `with_quantity` also --quantity, which only tables have. */
void dif_cli_add_measure(dif_cli *cli, dif_cli_measure *measure, bool with_quantity);

/* The options of bench/measure.h for a surface. */
dif_measure_opts dif_cli_measure_opts(const dif_cli *cli, const dif_cli_measure *measure, const dif_field_file *file,
                                      dif_progress *progress);

/* Adds --shadowing, for verbs that measure rho or the BRDF. */
void dif_cli_add_shadowing(dif_cli *cli, dif_cli_measure *measure);

/* Prepares the shadowing that was asked for and gives it to *opts; *shadow is freed with dif_shadow_free.
 * Status of dif_shadow_create */
DIF_MUST_USE dif_status dif_cli_measure_shadow(const dif_cli *cli, const dif_cli_measure *measure,
                                               const dif_field_file *file, dif_measure_opts *opts, dif_shadow *shadow,
                                               dif_error *err);

/* Gives pq and stam the period that the user did not: a harmonic fit of the heights. Says what it found.
 * Status of dif_fit_surface */
DIF_MUST_USE dif_status dif_cli_measure_period(const dif_cli *cli, const dif_field_file *file, dif_measure_opts *opts,
                                               dif_error *err);

/* Tells libraries that ask OpenMP how many threads --threads allows. */
void dif_cli_use_threads(const dif_cli *cli);

/* Starts the provenance: program, command line, and the input unless `path` is NULL. */
DIF_MUST_USE dif_status dif_cli_manifest(const dif_cli *cli, const char *path, dif_manifest *out, dif_error *err);
DIF_MUST_USE dif_status dif_cli_manifest_surface(dif_manifest *manifest, const dif_field_file *file, dif_error *err);
DIF_MUST_USE dif_status dif_cli_manifest_measure(dif_manifest *manifest, double tol, const dif_measure_opts *opts,
                                                 const dif_measure_stats *stats, dif_error *err);

/* A number, or null for NaN and infinities (JSON has none). */
json_t *dif_json_number(double value);
json_t *dif_json_manifest(const dif_manifest *manifest);
json_t *dif_json_stats(const dif_measure_stats *stats);

/* Prints a value on stdout and drops it; DIF_EXIT_DONE, or DIF_EXIT_RESOURCE with a line if memory is short. */
int dif_json_print(const dif_cli *cli, json_t *value);

/* Fails now, before the work, if an output could not be written: path NULL or "-" is stdout. */
DIF_MUST_USE dif_status dif_cli_check_out(const char *path, dif_error *err);

/* One line on stderr unless --quiet. */
void dif_cli_say(const dif_cli *cli, const char *format, ...) DIF_PRINTF(2, 3);
void dif_cli_say_stats(const dif_cli *cli, const dif_measure_stats *stats);

/* The kind of a synthetic surface of ours ("blazed") by its title, or NULL for any other. */
const char *dif_cli_fixture_kind(const char *title);

/* The same of a file. */
const char *dif_cli_fixture_name(const dif_field_file *file);

/* An operand that may be a response table or a surface, told apart by content: a table names its wavelengths. */
typedef struct dif_cli_input {
    bool is_table;
    dif_table table;       /* owned, if is_table           */
    dif_manifest manifest; /* owned, the table's own       */
    dif_field_file file;   /* owned, if not                */
    dif_channels channels; /* owned, if they were asked for */
} dif_cli_input;

DIF_MUST_USE dif_status dif_cli_input_read(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                           dif_cli_input *out, dif_error *err);

/* The same, and lists the channels of what is no table; they are there even if reading fails. */
DIF_MUST_USE dif_status dif_cli_input_read_listed(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                                                  dif_cli_input *out, dif_error *err);
void dif_cli_input_free(dif_cli_input *input);

#endif
