#define _POSIX_C_SOURCE 200809L /* getopt's declarations */

#include "bench/cli/options.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/cli/cmd.h"
#include "bench/scan.h"

void dif_cli_begin(dif_cli *cli, int argc, char **argv, const dif_cli_help *help)
{
    *cli = (dif_cli){.argc = argc, .argv = argv, .verb = argc > 1 ? argv[1] : "", .help = help};
}

void dif_cli_add(dif_cli *cli, const dif_opt *opt, int n)
{
    for (int i = 0; i < n && cli->n_opt < DIF_OPT_MAX; i++)
        cli->opt[cli->n_opt++] = opt[i];
}

static void add_common(dif_cli *cli)
{
    const dif_opt common[] = {
        {"Common", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"json", DIF_OPT_FLAG, &cli->json, NULL, NULL, "results as one JSON object on stdout", NULL},
        {"quiet", DIF_OPT_FLAG, &cli->quiet, NULL, NULL, "say nothing on stderr but errors", NULL},
        {"threads", DIF_OPT_INT, &cli->n_thread, "[1, 1024]", "N", "threads to use (default: all)", NULL},
        {"help", DIF_OPT_FLAG, &cli->want_help, NULL, NULL, "this text", NULL},
        {"version", DIF_OPT_FLAG, &cli->want_version, NULL, NULL, "the version", NULL},
    };
    dif_cli_add(cli, common, (int)(sizeof common / sizeof common[0]));
}

bool dif_cli_in_interval(double value, const char *interval)
{
    char *end = NULL;
    const double low = strtod(interval + 1, &end);
    const double high = strtod(end + 1, &end);
    const bool above = *interval == '[' ? value >= low : value > low;
    return above && (*end == ']' ? value <= high : value < high);
}

/* The interval in words. */
static void interval_words(const char *interval, char words[80])
{
    char *end = NULL;
    const double low = strtod(interval + 1, &end);
    const double high = strtod(end + 1, &end);
    const bool low_in = *interval == '[', high_in = *end == ']';
    if (isinf(low) && isinf(high))
        snprintf(words, 80, "a finite number");
    else if (isinf(high))
        snprintf(words, 80, low_in ? "at least %g" : "more than %g", low);
    else if (low == -high && !low_in && !high_in)
        snprintf(words, 80, "strictly between %g and %g", low, high);
    else
        snprintf(words, 80, "%s%g and %s%g", low_in ? "at least " : "more than ", low,
                 high_in ? "at most " : "less than ", high);
}

static int bad_value(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    char words[80] = "";
    if (opt->kind == DIF_OPT_CHOICE)
        return dif_cmd_usage(cli->verb, "--%s '%s': unknown, expected one of %s", opt->name, text, opt->limits);
    interval_words(opt->limits, words);
    return dif_cmd_usage(cli->verb, "--%s '%s': out of range, expected %s", opt->name, text, words);
}

static int set_real(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    dif_range range;
    if (strchr(text, ':') || dif_range_parse(text, &range, NULL) != DIF_OK)
        return dif_cmd_usage(cli->verb, "--%s '%s': not a number, expected a plain decimal number", opt->name, text);
    if (!dif_cli_in_interval(range.min, opt->limits))
        return bad_value(cli, opt, text);
    *(double *)opt->target = range.min;
    return DIF_CLI_GO;
}

static int set_int(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    char *end = NULL;
    errno = 0;
    const long value = strtol(text, &end, 10);
    const size_t n_plain = strspn(text, "+-0123456789");
    if (end == text || *end != '\0' || text[n_plain] != '\0' || errno == EINVAL)
        return dif_cmd_usage(cli->verb, "--%s '%s': not a whole number", opt->name, text);
    if (errno == ERANGE || !dif_cli_in_interval((double)value, opt->limits))
        return bad_value(cli, opt, text);
    *(int *)opt->target = (int)value;
    return DIF_CLI_GO;
}

static int set_range(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    dif_range range;
    dif_error err;
    if (dif_range_parse(text, &range, &err) != DIF_OK)
        return dif_cmd_usage(cli->verb, "--%s: %s", opt->name, err.text);
    if (!dif_cli_in_interval(range.min, opt->limits) || !dif_cli_in_interval(range.max, opt->limits))
        return bad_value(cli, opt, text);
    *(dif_range *)opt->target = range;
    return DIF_CLI_GO;
}

static int set_choice(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    const size_t n_text = strlen(text);
    int index = 0;
    for (const char *at = opt->limits; *at; index++) {
        const size_t n = strcspn(at, "|");
        if (n == n_text && strncmp(at, text, n) == 0) {
            *(int *)opt->target = index;
            return DIF_CLI_GO;
        }
        at += n + (at[n] == '|');
    }
    return bad_value(cli, opt, text);
}

static int add_text(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    dif_opt_list *list = opt->target;
    if (*text == '\0')
        return dif_cmd_usage(cli->verb, "--%s: empty, expected %s", opt->name, opt->value);
    if (list->n == DIF_OPT_LIST_MAX)
        return dif_cmd_usage(cli->verb, "--%s: given more than %d times", opt->name, DIF_OPT_LIST_MAX);
    list->text[list->n++] = text;
    return DIF_CLI_GO;
}

static int take_step(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    const dif_opt_sink *sink = opt->target;
    dif_error err;
    if (text && *text == '\0')
        return dif_cmd_usage(cli->verb, "--%s: empty, expected %s", opt->name, opt->value);
    if (sink->take(sink->self, opt->name, text, &err))
        return dif_cmd_usage(cli->verb, "--%s%s%s%s: %s", opt->name, text ? " '" : "", text ? text : "",
                             text ? "'" : "", err.text);
    return DIF_CLI_GO;
}

static int set_option(const dif_cli *cli, const dif_opt *opt, const char *text)
{
    if (opt->given)
        *opt->given = true;
    switch (opt->kind) {
    case DIF_OPT_FLAG:
        *(bool *)opt->target = true;
        return DIF_CLI_GO;
    case DIF_OPT_TEXT:
        if (*text == '\0')
            return dif_cmd_usage(cli->verb, "--%s: empty, expected %s", opt->name, opt->value);
        *(const char **)opt->target = text;
        return DIF_CLI_GO;
    case DIF_OPT_LIST:
        return add_text(cli, opt, text);
    case DIF_OPT_STEP:
        return take_step(cli, opt, text);
    case DIF_OPT_REAL:
        return set_real(cli, opt, text);
    case DIF_OPT_INT:
        return set_int(cli, opt, text);
    case DIF_OPT_RANGE:
        return set_range(cli, opt, text);
    case DIF_OPT_CHOICE:
        return set_choice(cli, opt, text);
    case DIF_OPT_HEADING:
        break;
    }
    return DIF_CLI_GO;
}

/* The flag that was meant by a mistyped one: the longest common beginning, at least three letters. */
static const char *nearest_flag(const dif_cli *cli, const char *word)
{
    const char *best = NULL;
    size_t n_best = 2;
    for (int i = 0; i < cli->n_opt; i++) {
        size_t n = 0;
        while (word[n] && word[n] != '=' && word[n] == cli->opt[i].name[n])
            n++;
        if (cli->opt[i].kind != DIF_OPT_HEADING && n > n_best) {
            n_best = n;
            best = cli->opt[i].name;
        }
    }
    return best;
}

static int unknown_flag(const dif_cli *cli, const char *word)
{
    const char *meant = strncmp(word, "--", 2) == 0 ? nearest_flag(cli, word + 2) : NULL;
    if (meant)
        return dif_cmd_usage(cli->verb, "%s: unknown flag, did you mean --%s?", word, meant);
    return dif_cmd_usage(cli->verb, "%s: unknown flag", word);
}

/* True if the word that getopt matched spells the flag's whole name. */
static bool is_spelled_out(const char *word, const char *name)
{
    const size_t n = strlen(name);
    return strncmp(word, "--", 2) == 0 && strncmp(word + 2, name, n) == 0 &&
           (word[2 + n] == '\0' || word[2 + n] == '=');
}

/* Whether a value follows: by the kind, and for steps by how the help calls it. */
static int wants_value(const dif_opt *opt)
{
    if (opt->kind == DIF_OPT_FLAG || (opt->kind == DIF_OPT_STEP && !opt->value))
        return no_argument;
    return opt->kind == DIF_OPT_STEP && opt->value[0] == '[' ? optional_argument : required_argument;
}

static void long_options(const dif_cli *cli, struct option longs[DIF_OPT_MAX + 1], int which[DIF_OPT_MAX])
{
    int n = 0;
    for (int i = 0; i < cli->n_opt; i++) {
        if (cli->opt[i].kind == DIF_OPT_HEADING)
            continue;
        which[n] = i;
        longs[n++] = (struct option){cli->opt[i].name, wants_value(&cli->opt[i]), NULL, 2};
    }
    longs[n] = (struct option){NULL, 0, NULL, 0};
}

static int take_operand(dif_cli *cli, const char *word)
{
    if (cli->n_operand == DIF_OPERAND_MAX)
        return dif_cmd_usage(cli->verb, "%s: more than %d operands", word, DIF_OPERAND_MAX);
    cli->operand[cli->n_operand++] = word;
    return DIF_CLI_GO;
}

/* One step of getopt's answer; `word` is the argument that it came from. */
static int take(dif_cli *cli, int answer, const char *word, int index)
{
    const dif_opt *opt = index >= 0 ? &cli->opt[index] : NULL;
    if (answer == 1)
        return take_operand(cli, optarg);
    if (answer == ':')
        return dif_cmd_usage(cli->verb, "%s: needs a value", word);
    if (answer != 2 || !opt || !is_spelled_out(word, opt->name))
        return unknown_flag(cli, word);
    return set_option(cli, opt, optarg);
}

static int take_all(dif_cli *cli)
{
    struct option longs[DIF_OPT_MAX + 1];
    int which[DIF_OPT_MAX];
    long_options(cli, longs, which);
    opterr = 0;
    optind = 2;
    for (;;) {
        const char *word = optind < cli->argc ? cli->argv[optind] : "";
        int at = -1;
        const int answer = getopt_long(cli->argc, cli->argv, "-:", longs, &at);
        if (answer == -1)
            break;
        const int code = take(cli, answer, word, at >= 0 ? which[at] : -1);
        if (code != DIF_CLI_GO)
            return code;
    }
    while (optind < cli->argc) /* what follows "--" */
        if (take_operand(cli, cli->argv[optind++]) != DIF_CLI_GO)
            return DIF_EXIT_USAGE;
    return DIF_CLI_GO;
}

int dif_cli_parse(dif_cli *cli, int n_operand_min, int n_operand_max)
{
    add_common(cli);
    const int code = take_all(cli);
    if (code != DIF_CLI_GO)
        return code;
    if (cli->want_help) {
        dif_cli_print_help(cli);
        return DIF_EXIT_DONE;
    }
    if (cli->want_version) {
        printf("diffbench %s\n", DIF_VERSION);
        return DIF_EXIT_DONE;
    }
    if (cli->n_operand < n_operand_min)
        return dif_cmd_usage(cli->verb, "expected %s", cli->help->operands);
    if (cli->n_operand > n_operand_max)
        return dif_cmd_usage(cli->verb, "%s: one operand too many, expected %s", cli->operand[n_operand_max],
                             n_operand_max ? cli->help->operands : "none");
    return DIF_CLI_GO;
}

/* Prints words wrapped at 100 columns; lines after the first begin at `column`, too. */
static void print_wrapped(const char *text, int column)
{
    enum { WIDTH = 100 };
    int at = column;
    while (*text) {
        const int n = (int)strcspn(text, " ");
        const bool fits = at + 1 + n <= WIDTH;
        if (at > column)
            at += fits ? printf(" ") : printf("\n%*s", column, "") - 1 - at;
        at += printf("%.*s", n, text);
        text += n;
        text += strspn(text, " ");
    }
    putchar('\n');
}

void dif_cli_print_help(const dif_cli *cli)
{
    enum { HELP_COLUMN = 28 };
    const char *operands = cli->help->operands;
    printf("usage: diffbench %s%s%s [options]\n\n%s", cli->verb, *operands ? " " : "", operands, cli->help->about);
    for (int i = 0; i < cli->n_opt; i++) {
        const dif_opt *opt = &cli->opt[i];
        if (opt->kind == DIF_OPT_HEADING) {
            printf("\n%s\n", opt->name);
            continue;
        }
        const char *value = opt->kind == DIF_OPT_CHOICE ? opt->limits : opt->value ? opt->value : "";
        int column = printf("  --%s%s%s", opt->name, *value && *value != '[' ? " " : "", value);
        if (column > HELP_COLUMN - 2)
            column = printf("\n") - 1;
        printf("%*s", HELP_COLUMN - column, "");
        print_wrapped(opt->help, HELP_COLUMN);
    }
    printf("\nExample\n%s", cli->help->example);
}
