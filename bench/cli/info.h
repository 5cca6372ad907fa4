/* What `info` tells of a surface and of a table, as text or JSON.
 * Does not: read files. */
#ifndef DIF_INFO_H
#define DIF_INFO_H

#include "bench/cli/cli.h"

DIF_MUST_USE dif_status dif_info_surface(const dif_cli *cli, const dif_cli_input *input, double lambda_min_nm,
                                         double lambda_max_nm, dif_error *err);
DIF_MUST_USE dif_status dif_info_table(const dif_cli *cli, const dif_cli_input *input, dif_error *err);

/* Prints the channels of a file that has several; `chosen` is the number of the one that is read, 0 = none. */
void dif_info_channels_print(const dif_channels *channels, int chosen);
json_t *dif_info_channels_json(const dif_channels *channels, int chosen);

/* What can be told of a file with several channels none of which was read. */
void dif_info_unread(const dif_cli *cli, const dif_cli_input *input);

#endif
