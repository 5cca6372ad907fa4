#include "bench/cli/cmd.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

/* One row a status, in the order of their numbers. */
static const int EXIT_OF_STATUS[] = {
    [DIF_OK] = DIF_EXIT_DONE,
    [DIF_ERR_ARG] = DIF_EXIT_USAGE,
    [DIF_ERR_TOL] = DIF_EXIT_USAGE,
    [DIF_ERR_NOMEM] = DIF_EXIT_RESOURCE,
    [DIF_ERR_SIZE] = DIF_EXIT_INPUT,
    [DIF_ERR_IO] = DIF_EXIT_INPUT,
    [DIF_ERR_FORMAT] = DIF_EXIT_INPUT,
    [DIF_ERR_SCALE] = DIF_EXIT_INPUT,
    [DIF_ERR_NONFINITE] = DIF_EXIT_INPUT,
    [DIF_ERR_FIT] = DIF_EXIT_OUTSIDE,
    [DIF_ERR_FOREIGN] = DIF_EXIT_RESOURCE,
    [DIF_ERR_RESOURCE] = DIF_EXIT_RESOURCE,
    [DIF_ERR_UNSUPPORTED] = DIF_EXIT_INPUT,
};

int dif_exit_from_status(dif_status status)
{
    const size_t n = sizeof EXIT_OF_STATUS / sizeof EXIT_OF_STATUS[0];
    return (size_t)status < n ? EXIT_OF_STATUS[status] : DIF_EXIT_RESOURCE;
}

static void print_line(const char *verb, const char *text)
{
    fflush(stdout);
    fprintf(stderr, "diffbench%s%s: %s\n", verb && *verb ? " " : "", verb ? verb : "", text);
}

int dif_cmd_fail(const char *verb, const dif_error *err)
{
    print_line(verb, err->text[0] ? err->text : dif_status_text(err->status));
    return dif_exit_from_status(err->status);
}

static void print_format(const char *verb, const char *format, va_list args)
{
    char text[400];
    vsnprintf(text, sizeof text, format, args);
    print_line(verb, text);
}

int dif_cmd_usage(const char *verb, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_format(verb, format, args);
    va_end(args);
    return DIF_EXIT_USAGE;
}

int dif_cmd_outside(const char *verb, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    print_format(verb, format, args);
    va_end(args);
    return DIF_EXIT_OUTSIDE;
}
