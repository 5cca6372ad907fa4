/* What `info` tells of a surface and of a table, as text or JSON.
 * Does not: read files. */
#ifndef DIF_INFO_H
#define DIF_INFO_H

#include "bench/cli/cli.h"

DIF_MUST_USE dif_status dif_info_surface(const dif_cli *cli, const dif_field_file *file, double lambda_min_nm,
                                         double lambda_max_nm, dif_error *err);
DIF_MUST_USE dif_status dif_info_table(const dif_cli *cli, const dif_cli_input *input, dif_error *err);

#endif
