/* The verbs of the command line: their one signature, the exit codes and the error line.
 * Options, operands and provenance: bench/cli/options.h and bench/cli/cli.h.
 * Does not: measure anything. */
#ifndef DIF_CMD_H
#define DIF_CMD_H

#include "core/status.h"

/* Exit codes of the whole program. */
enum {
    DIF_EXIT_DONE = 0,
    DIF_EXIT_OUTSIDE = 1, /* measured outside tolerance, fit not believed                    */
    DIF_EXIT_USAGE = 2,   /* unknown verb or flag, a flag's value out of its range            */
    DIF_EXIT_INPUT = 3,   /* files that are missing, damaged, without a scale, not writable   */
    DIF_EXIT_RESOURCE = 4 /* memory, a helper program or a device is missing                  */
};

/* Every verb: argc and argv are those of main (argv[1] is the verb), so that provenance can hold the whole command
 * line; the result is the exit code. */
typedef int dif_cmd_fn(int argc, char **argv);

dif_cmd_fn dif_cmd_compare, dif_cmd_convert, dif_cmd_eval, dif_cmd_fit, dif_cmd_fixture, dif_cmd_info, dif_cmd_lut,
    dif_cmd_map, dif_cmd_maxima, dif_cmd_orders, dif_cmd_render, dif_cmd_report, dif_cmd_slopes, dif_cmd_table,
    dif_cmd_view;

/* The exit code of a status. */
int dif_exit_from_status(dif_status status);

/* Prints the one error line `diffbench VERB: TEXT` on stderr; returns the exit code that belongs to it. */
int dif_cmd_fail(const char *verb, const dif_error *err);

/* The same for a mistake on the command line; returns DIF_EXIT_USAGE. */
int dif_cmd_usage(const char *verb, const char *format, ...) DIF_PRINTF(2, 3);

/* The same for a result outside its tolerance; returns DIF_EXIT_OUTSIDE. */
int dif_cmd_outside(const char *verb, const char *format, ...) DIF_PRINTF(2, 3);

#endif
