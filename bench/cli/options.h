/* The options of a verb: one table that parsing, range checks and --help are made from.
 * getopt_long does the splitting. Abbreviated flags are refused, because the unit is part of a flag's name.
 * Does not: know any verb. */
#ifndef DIF_OPTIONS_H
#define DIF_OPTIONS_H

#include <stdbool.h>

#include "core/status.h"

typedef enum dif_opt_kind {
    DIF_OPT_FLAG,   /* bool: set by the flag's presence                                */
    DIF_OPT_TEXT,   /* const char *: any text                                          */
    DIF_OPT_LIST,   /* dif_opt_list: any text, once for each time that the flag is given */
    DIF_OPT_REAL,   /* double: one plain decimal number                                */
    DIF_OPT_INT,    /* int                                                             */
    DIF_OPT_RANGE,  /* dif_range: MIN:MAX:STEP or one number                           */
    DIF_OPT_STEP,   /* dif_opt_sink: taken in the order of the command line; no value if `value` is NULL, an optional
                       one ("--fill=X") if it begins with '[' */
    DIF_OPT_CHOICE, /* int: index of one of the names in `limits`                      */
    DIF_OPT_HEADING /* no option: a line in the help                                   */
} dif_opt_kind;

typedef struct dif_opt {
    const char *name; /* without dashes; of a heading, its text                                     */
    dif_opt_kind kind;
    void *target;       /* written only if the flag was given                                         */
    const char *limits; /* REAL, INT, RANGE: an interval such as "(0, inf)"; CHOICE: "gauss|flat"       */
    const char *value;  /* what the help calls the value, e.g. "NM"                                   */
    const char *help;
    bool *given; /* set to true if the flag was given; may be NULL                             */
} dif_opt;

enum { DIF_OPT_LIST_MAX = 16 };

typedef struct dif_opt_list {
    int n;
    const char *text[DIF_OPT_LIST_MAX]; /* point into argv */
} dif_opt_list;

/* Where the values of DIF_OPT_STEP go; text is NULL without a value. A failure's text becomes the error line. */
typedef struct dif_opt_sink {
    dif_status (*take)(void *self, const char *name, const char *text, dif_error *err);
    void *self;
} dif_opt_sink;

enum { DIF_OPT_MAX = 80, DIF_OPERAND_MAX = 1024 };

/* What a verb says of itself in --help. */
typedef struct dif_cli_help {
    const char *operands; /* "SURFACE", "" ...                                       */
    const char *about;    /* what it does, whole lines                               */
    const char *example;  /* shell lines, each of which is run by the tests          */
} dif_cli_help;

/* One run of a verb. Set up by dif_cli_begin, filled by dif_cli_parse. */
typedef struct dif_cli {
    int argc;
    char **argv; /* the whole command line; argv[1] is the verb          */
    const char *verb;
    const dif_cli_help *help;
    bool json, quiet; /* common to all verbs                                  */
    int n_thread;     /* 0 = all                                              */
    bool want_help, want_version;
    int n_opt;
    dif_opt opt[DIF_OPT_MAX];
    int n_operand;
    const char *operand[DIF_OPERAND_MAX]; /* point into argv */
} dif_cli;

/* Starts a verb. */
void dif_cli_begin(dif_cli *cli, int argc, char **argv, const dif_cli_help *help);

/* Adds options opt[n] to the table. */
void dif_cli_add(dif_cli *cli, const dif_opt *opt, int n);

/* What dif_cli_parse returns if the verb is to go on. */
#define DIF_CLI_GO (-1)

/* Parses the command line: adds --json, --quiet, --threads, --help, --version, checks every value and the number of
 * operands, answers --help and --version.
 * Returns   DIF_CLI_GO, or the exit code with which to end */
int dif_cli_parse(dif_cli *cli, int n_operand_min, int n_operand_max);

/* Prints the help text of a verb on stdout. */
void dif_cli_print_help(const dif_cli *cli);

/* True if value lies in an interval text "[a, b)"; every bracket may be round (end excluded) or square. NaN is never. */
bool dif_cli_in_interval(double value, const char *interval);

#endif
