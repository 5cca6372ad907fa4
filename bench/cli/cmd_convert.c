/* diffbench convert SURFACE...: any known format to EXR, GSF, PNG or text, prepared on the way. */
#define _POSIX_C_SOURCE 200809L /* stat, mkdir */

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "bench/cli/cli.h"
#include "core/alloc.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE...",
    "Reads surfaces of any known format, prepares their heights as asked and writes them with their provenance as EXR\n"
    "(float, um), GSF, 16-bit PNG that holds its scale (keys that Gwyddion reads), or text. One surface goes to the\n"
    "file --out, whose extension is the format; several, or any with --to, into the folder --out, or beside each "
    "input\n"
    "without it. A file that cannot be converted does not stop the others; then the exit code is 3.\n",
    "  diffbench fixture sine --period-nm 1600 --height-nm 120 --size-um 20 --pixels 128 --out sine.gsf\n"
    "  diffbench convert sine.gsf --rotate-deg 30 --crop-um 2:12,2:12 --out turned.exr\n"
    "  diffbench convert sine.gsf turned.exr --level plane --to png --out pictures\n",
};

enum { PATH_SIZE = 4096 };
static const char FORMATS[] = "exr|gsf|png|txt";
static const char *const EXTENSIONS[] = {".exr", ".gsf", ".png", ".txt"};

typedef struct convert_args {
    dif_cli_surface surface;
    const char *out;
    int to; /* index of a format, -1 = not said */
} convert_args;

/* One run over the operands. */
typedef struct convert_run {
    const dif_cli *cli;
    const convert_args *args;
    bool into_folder;
    char (*target)[PATH_SIZE]; /* of each operand, "" = none */
    json_t *list;              /* NULL without --json        */
} convert_run;

static bool is_folder(const char *path)
{
    struct stat about;
    const size_t n = strlen(path);
    return (n > 0 && path[n - 1] == '/') || (stat(path, &about) == 0 && S_ISDIR(about.st_mode));
}

static bool is_same_file(const char *a, const char *b)
{
    struct stat about_a, about_b;
    return stat(a, &about_a) == 0 && stat(b, &about_b) == 0 && about_a.st_dev == about_b.st_dev &&
           about_a.st_ino == about_b.st_ino;
}

/* Length of a file's name without its extension. Numbers are part of it (NanoScope's scan.000, scan.001 ...). */
static size_t stem_length(const char *name)
{
    size_t n = strlen(name);
    if (n > 3 && strcmp(name + n - 3, ".gz") == 0)
        n -= 3;
    for (size_t i = n; i-- > 1;)
        if (name[i] == '.')
            return strspn(name + i + 1, "0123456789") == n - i - 1 ? n : i;
    return n;
}

/* The file that operand i is written to. */
static dif_status find_target(const convert_run *run, int i, dif_error *err)
{
    const char *input = run->cli->operand[i], *slash = strrchr(input, '/'), *name = slash ? slash + 1 : input;
    const char *out = run->args->out;
    char *target = run->target[i];
    int n;
    if (!run->into_folder) {
        n = snprintf(target, PATH_SIZE, "%s", out);
    } else {
        const char *extension = EXTENSIONS[run->args->to < 0 ? 0 : run->args->to];
        const int n_folder = out ? (int)strlen(out) : (int)(name - input);
        const bool needs_slash = out && out[n_folder - 1] != '/';
        n = snprintf(target, PATH_SIZE, "%.*s%s%.*s%s", n_folder, out ? out : input, needs_slash ? "/" : "",
                     (int)stem_length(name), name, extension);
    }
    if (n < 0 || n >= PATH_SIZE)
        return dif_fail(err, DIF_ERR_ARG, "%.100s: its output's path is longer than %d bytes", input, PATH_SIZE - 1);
    for (int k = 0; k < run->cli->n_operand; k++)
        if (is_same_file(target, run->cli->operand[k]))
            return dif_fail(err, DIF_ERR_ARG, "%.100s: %.100s is one of the inputs, expected another --out", input,
                            target);
    for (int k = 0; k < i; k++)
        if (strcmp(target, run->target[k]) == 0)
            return dif_fail(err, DIF_ERR_ARG, "%.100s: %.100s is already the output of an earlier one", input, target);
    return DIF_OK;
}

static dif_status make_manifest(const convert_run *run, const char *input, const dif_field_file *file,
                                dif_manifest *manifest, dif_error *err)
{
    const char *fixture = dif_cli_fixture_name(file);
    dif_status status = dif_cli_manifest(run->cli, input, manifest, err);
    if (!status && fixture) /* a synthetic surface stays one */
        status = dif_manifest_set(manifest, "fixture", fixture, err);
    return status ? status : dif_cli_manifest_surface(manifest, file, err);
}

static dif_status convert(const convert_run *run, int i, dif_field_file *file, dif_error *err)
{
    const char *input = run->cli->operand[i];
    dif_manifest manifest = {0};
    dif_status status = find_target(run, i, err);
    if (!status)
        status = dif_cli_surface_read(run->cli, input, &run->args->surface, file, err);
    if (!status)
        status = make_manifest(run, input, file, &manifest, err);
    if (!status)
        status = dif_field_write(run->target[i], &file->field, &manifest, err);
    dif_field_loss loss = {.step_um = 0.0};
    if (!status)
        loss = dif_field_loss_of(run->target[i], &file->field);
    if (loss.warning[0])
        dif_cli_say(run->cli, "%s: %s", run->target[i], loss.warning);
    dif_manifest_free(&manifest);
    return status;
}

/* What became of one operand: a line on stdout or an entry of the list. */
static void report(const convert_run *run, int i, const dif_field_file *file, const dif_error *failed)
{
    const dif_field *field = &file->field;
    const double pitch_x_nm = dif_nm_from_um(field->pitch_x_um), pitch_y_nm = dif_nm_from_um(field->pitch_y_um);
    if (run->list && failed)
        json_array_append_new(
            run->list, json_pack("{s:s, s:b, s:s}", "input", run->cli->operand[i], "ok", 0, "text", failed->text));
    else if (run->list)
        json_array_append_new(run->list, json_pack("{s:s, s:b, s:s, s:s, s:i, s:i, s:f, s:f, s:s}", "input",
                                                   run->cli->operand[i], "ok", 1, "output", run->target[i], "format",
                                                   file->format, "nx", field->nx, "ny", field->ny, "pitch_x_nm",
                                                   pitch_x_nm, "pitch_y_nm", pitch_y_nm, "preparation", file->history));
    else if (!failed)
        printf("%s -> %s: %d x %d samples of %.6g x %.6g nm\n", run->cli->operand[i], run->target[i], field->nx,
               field->ny, pitch_x_nm, pitch_y_nm);
}

/* All operands; returns the exit code. */
static int convert_all(const convert_run *run)
{
    const int n = run->cli->n_operand;
    int n_failed = 0, code = DIF_EXIT_DONE;
    for (int i = 0; i < n; i++) {
        dif_field_file file = {0};
        dif_error err = {0};
        const bool failed = convert(run, i, &file, &err) != DIF_OK;
        if (failed) {
            run->target[i][0] = '\0';
            code = dif_cmd_fail(run->cli->verb, &err);
            n_failed++;
        }
        report(run, i, &file, failed ? &err : NULL);
        dif_field_file_free(&file);
    }
    if (n == 1)
        return code;
    fflush(stdout);
    dif_cli_say(run->cli, "%d of %d surfaces converted, %d failed", n - n_failed, n, n_failed);
    return n_failed ? DIF_EXIT_INPUT : DIF_EXIT_DONE;
}

static dif_status make_folder(const char *path, dif_error *err)
{
    if (!path || is_folder(path) || mkdir(path, 0777) == 0 || (errno == EEXIST && is_folder(path)))
        return DIF_OK;
    return dif_fail(err, DIF_ERR_IO, "%.150s: %s", path, errno == EEXIST ? "not a folder" : strerror(errno));
}

static int execute(const dif_cli *cli, const convert_args *args)
{
    const bool is_single = cli->n_operand == 1 && args->to < 0 && args->out && !is_folder(args->out);
    convert_run run = {.cli = cli, .args = args, .into_folder = !is_single};
    dif_error err = {0};
    dif_status status = is_single ? dif_field_write_check(args->out, &err) : make_folder(args->out, &err);
    if (status)
        return dif_cmd_fail(cli->verb, &err);
    run.target = dif_alloc((size_t)cli->n_operand, sizeof *run.target);
    run.list = cli->json ? json_array() : NULL;
    if (!run.target || (cli->json && !run.list)) {
        dif_release(run.target);
        dif_fail(&err, DIF_ERR_NOMEM, "list of %d surfaces", cli->n_operand);
        return dif_cmd_fail(cli->verb, &err);
    }
    int code = convert_all(&run);
    if (run.list) {
        const int printed = dif_json_print(cli, run.list);
        code = printed == DIF_EXIT_DONE ? code : printed;
    }
    dif_release(run.target);
    return code;
}

int dif_cmd_convert(int argc, char **argv)
{
    convert_args args = {.surface = dif_cli_surface_default(), .to = -1};
    const dif_opt opts[] = {
        {"Output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args.out, NULL, "PATH", "file to write, or folder (made if it is missing)", NULL},
        {"to", DIF_OPT_CHOICE, &args.to, FORMATS, NULL, "format in a folder (default exr)", NULL},
    };
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    dif_cli_add(&cli, opts, DIF_COUNT(opts));
    dif_cli_add_surface(&cli, &args.surface);
    const int code = dif_cli_parse(&cli, 1, DIF_OPERAND_MAX);
    if (code != DIF_CLI_GO)
        return code;
    if (!args.out && args.to < 0)
        return dif_cmd_usage(cli.verb, "no output, expected --out PATH or --to %s", FORMATS);
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
