/* The program: finds the verb, ends with its exit code and makes sure that stdout arrived. */
#define _POSIX_C_SOURCE 200809L /* SIGPIPE */

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cmd.h"

typedef struct dif_cmd {
    const char *name;
    dif_cmd_fn *fn;
    const char *help;
} dif_cmd;

static const dif_cmd COMMANDS[] = {
    {"fixture", dif_cmd_fixture, "make a synthetic surface"},
    {"info", dif_cmd_info, "what a surface or a table is like, and whether its sampling is fine enough"},
    {"convert", dif_cmd_convert, "read any format, prepare the heights, write EXR, GSF, PNG or text"},
    {"table", dif_cmd_table, "measure an angle-wavelength response table"},
    {"eval", dif_cmd_eval, "measure arbitrary directions and wavelengths"},
    {"map", dif_cmd_map, "measure all directions for one direction of light, in colour"},
    {"lut", dif_cmd_lut, "build the wavelength-integrated table of a surface, or read colours from one"},
    {"compare", dif_cmd_compare, "hold the GPU's shaders against the CPU"},
    {"render", dif_cmd_render, "draw a mesh that wears a surface"},
    {"slopes", dif_cmd_slopes, "slopes of a surface, which of them are seen, normals and masking"},
    {"view", dif_cmd_view, "false-colour picture of a surface from any distance, without aliasing"},
    {"orders", dif_cmd_orders, "grating equation and order efficiencies of a named profile"},
    {"maxima", dif_cmd_maxima, "maxima of a table against the grating equation"},
    {"fit", dif_cmd_fit, "grating periods with uncertainties, from a table or a surface"},
    {"report", dif_cmd_report, "everything on one HTML page"},
};
enum { N_COMMAND = sizeof COMMANDS / sizeof COMMANDS[0] };

static int print_overview(void)
{
    printf("diffbench %s: a virtual diffraction measurement bench for measured heightfields\n\n"
           "usage: diffbench VERB [operands] [options]\n\n",
           DIF_VERSION);
    for (int i = 0; i < N_COMMAND; i++)
        printf("  %-8s  %s\n", COMMANDS[i].name, COMMANDS[i].help);
    printf("\n`diffbench VERB --help` lists a verb's options, their units and an example.\n"
           "Data go to stdout, talk to stderr. Exit codes: 0 done, 1 measured outside tolerance or fit not believed,\n"
           "2 usage, 3 bad input, 4 resource missing.\n");
    return DIF_EXIT_DONE;
}

static const dif_cmd *find(const char *name)
{
    for (int i = 0; i < N_COMMAND; i++)
        if (strcmp(COMMANDS[i].name, name) == 0)
            return &COMMANDS[i];
    return NULL;
}

static int no_such_verb(const char *name)
{
    char names[200] = "";
    for (int i = 0; i < N_COMMAND; i++) {
        const size_t n = strlen(names);
        snprintf(names + n, sizeof names - n, "%s%s", i ? ", " : "", COMMANDS[i].name);
    }
    return dif_cmd_usage(NULL, "%s: unknown %s, expected one of %s", name, *name == '-' ? "flag" : "verb", names);
}

static int run(int argc, char **argv)
{
    if (argc < 2)
        return dif_cmd_usage(NULL, "no verb given, expected diffbench VERB (diffbench --help lists them)");
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0)
        return print_overview();
    if (strcmp(argv[1], "--version") == 0)
        return printf("diffbench %s\n", DIF_VERSION) > 0 ? DIF_EXIT_DONE : DIF_EXIT_INPUT;
    const dif_cmd *command = find(argv[1]);
    return command ? command->fn(argc, argv) : no_such_verb(argv[1]);
}

/* A full disk behind stdout shows only when the last bytes are pushed out. */
static int close_stdout(int code)
{
    errno = 0;
    const int failed = ferror(stdout) | fclose(stdout);
    if (!failed || code == DIF_EXIT_INPUT)
        return code;
    fprintf(stderr, "diffbench: stdout: write failed: %s\n", errno ? strerror(errno) : "output error");
    return DIF_EXIT_INPUT;
}

int main(int argc, char **argv)
{
    signal(SIGPIPE, SIG_DFL); /* a reader that goes away ends the program quietly, also where a parent ignores it */
    return close_stdout(run(argc, argv));
}
