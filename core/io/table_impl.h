/* What the files of table_io share. Internal to core/io. */
#ifndef DIF_TABLE_IMPL_H
#define DIF_TABLE_IMPL_H

#include "core/io/csv.h"
#include "core/io/number.h"
#include "core/io/table_io.h"

/* The geometry of a table as keys of a header or attributes of an EXR; those of the manifest with these names are not
 * written, and reading takes them out. */
extern const char *const dif_table_keys[]; /* NULL-terminated */
bool dif_table_key_is(const char *key);

/* Looks up a key's text; NULL if it is not there. */
typedef struct dif_table_geometry {
    bool fixed_is_wo, fixed_is_known;
    double fixed_deg, azimuth_deg; /* fixed NaN = not said, azimuth 0 = not said */
    bool quantity_is_known;
    dif_quantity quantity; /* rho = not said */
} dif_table_geometry;

/* Status DIF_ERR_FORMAT for values that are none. `self` goes to look_up. */
DIF_MUST_USE dif_status dif_table_geometry_read(const dif_source *source, const char *(*look_up)(void *, const char *),
                                                void *self, dif_table_geometry *out, dif_error *err);

/* Texts of an axis value, in degrees or nanometres: the shortest one that reading turns into the same radians or
 * micrometres. */
size_t dif_table_print_deg(double angle_rad, char out[DIF_NUMBER_SIZE]);
size_t dif_table_print_nm(double lambda_um, char out[DIF_NUMBER_SIZE]);

/* An axis as numbers with blanks between them, to be released; NULL without memory. */
char *dif_axis_print(const double *axis, int n, size_t (*print)(double, char[DIF_NUMBER_SIZE]));

/* Reads such an attribute into axis[n], converted. Status DIF_ERR_FORMAT: none, no numbers, not n of them. */
struct dif_exr;
DIF_MUST_USE dif_status dif_axis_read(const dif_source *source, const struct dif_exr *exr, const char *name, int n,
                                      double (*convert)(double), double *axis, dif_error *err);

/* Brings both axes into rising order. Status DIF_ERR_FORMAT if one has a value twice, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_table_sort(const dif_source *source, dif_table *table, dif_error *err);

/* Checks a table that was read: plan and no infinite values. */
DIF_MUST_USE dif_status dif_table_check(const dif_source *source, const dif_table *table, dif_error *err);

/* Readers of the layouts; *table is zeroed on failure, *keys gets what the header says. */
DIF_MUST_USE dif_status dif_table_csv_read(const dif_source *source, dif_table *table, dif_manifest *keys,
                                           dif_error *err);
DIF_MUST_USE dif_status dif_table_exr_read(const dif_source *source, dif_table *table, dif_manifest *keys,
                                           dif_error *err);

DIF_MUST_USE dif_status dif_table_exr_encode(const dif_table *table, const dif_manifest *manifest, unsigned char **data,
                                             size_t *n, dif_error *err);
DIF_MUST_USE dif_status dif_table_csv_write(const char *path, const dif_table *table, dif_layout layout,
                                            const dif_manifest *manifest, dif_error *err);

/* One row of a tidy table or of queries, in the order of the columns. */
enum { DIF_COLUMN_THETA_I, DIF_COLUMN_PHI_I, DIF_COLUMN_THETA_R, DIF_COLUMN_PHI_R, DIF_COLUMN_LAMBDA, DIF_N_DIRECTION };

/* Checks the direction and wavelength of the current row; missing azimuths become 0. Status DIF_ERR_FORMAT. */
DIF_MUST_USE dif_status dif_csv_check_direction(const dif_csv *csv, double value[DIF_N_DIRECTION], dif_error *err);

/* The tidy layout, of which the header is the current row. */
DIF_MUST_USE dif_status dif_table_tidy_read(dif_csv *csv, const dif_table_geometry *said, dif_table *table,
                                            dif_error *err);

/* Columns of a direction and wavelength, for dif_csv_find_columns. */
extern const dif_csv_column dif_direction_columns[DIF_N_DIRECTION];

#endif
