/* diffbench info FILE: what a surface or a table is like. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/info.h"
#include "bench/scan.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE|TABLE",
    "Tells what a surface is like (channels, size, pitch, heights, slopes, main periods, quantisation), whether its\n"
    "pitch is fine enough for the shortest wavelength, how many planes or terms each accuracy needs, and where scalar\n"
    "theory stops being trustworthy. Of a response table it tells axes, values and provenance.\n",
    "  diffbench fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 256 --out sine.exr\n"
    "  diffbench info sine.exr --lambda-nm 400:700:10\n",
};

int dif_cmd_info(int argc, char **argv)
{
    dif_cli_surface surface = dif_cli_surface_default();
    dif_range lambda_nm = {380.0, 780.0, 1.0, 401};
    const dif_opt opts[] = {
        {"Question", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"lambda-nm", DIF_OPT_RANGE, &lambda_nm, "(0, inf)", "MIN:MAX:STEP",
         "wavelengths that the surface is to be used with (default 380:780:1)", NULL},
    };
    dif_cli cli;
    dif_cli_input input;
    dif_error err = {0};
    dif_cli_begin(&cli, argc, argv, &HELP);
    dif_cli_add(&cli, opts, DIF_COUNT(opts));
    dif_cli_add_surface(&cli, &surface);
    int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    dif_cli_use_threads(&cli);
    dif_status status = dif_cli_input_read_listed(&cli, cli.operand[0], &surface, &input, &err);
    code = DIF_EXIT_DONE;
    if (!status)
        status = input.is_table ? dif_info_table(&cli, &input, &err)
                                : dif_info_surface(&cli, &input, lambda_nm.min, lambda_nm.max, &err);
    if (status) {
        dif_info_unread(&cli, &input);
        code = dif_cmd_fail(cli.verb, &err);
    }
    dif_cli_input_free(&input);
    return code;
}
