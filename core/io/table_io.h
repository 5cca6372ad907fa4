/* Response tables from and to files: tidy CSV, matrix CSV, EXR. Query and sample lists as CSV.
 * Does not: measure. */
#ifndef DIF_TABLE_IO_H
#define DIF_TABLE_IO_H

#include "core/io/manifest.h"
#include "core/plan.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_layout { DIF_LAYOUT_TIDY, DIF_LAYOUT_MATRIX } dif_layout;

/* Writes a table: .exr by extension, else CSV in the given layout; path NULL or "-" = CSV on stdout.
 * Tidy columns: theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value (angles of the plane signed, phi its
 * azimuth); `#` header lines `# key: value` carry the manifest. Numbers are %.9g or better, C locale, NaN = nan.
 * EXR: x = angle, y = wavelength, one float channel named after the quantity, axes and manifest as attributes. */
DIF_MUST_USE dif_status dif_table_write(const char *path, const dif_table *table, dif_layout layout,
                                        const dif_manifest *manifest, dif_error *err);

/* Reads any of the three (recognised by content), also a bare CSV of a real instrument with the same columns in any
 * order (lambda_nm or wavelength_nm; value or power or rho or brdf). One side must be fixed within 1e-6 degrees and
 * all directions lie in one plane; missing cells become NaN.
 * Status    DIF_ERR_IO, DIF_ERR_FORMAT (with the line), DIF_ERR_NONFINITE, DIF_ERR_SIZE, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_table_read(const char *path, dif_table *table, dif_manifest *manifest, dif_error *err);
DIF_MUST_USE dif_status dif_table_parse(const unsigned char *data, size_t n, const char *name, dif_table *table,
                                        dif_manifest *manifest, dif_error *err);

/* Queries: columns theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm by name, any order, `#` comments.
 * Gives     queries[n] (directions) and degrees[n][5] as read; both freed with dif_release
 * Status    DIF_ERR_FORMAT with the line; |theta| >= 90 or lambda <= 0 likewise */
DIF_MUST_USE dif_status dif_queries_parse(const unsigned char *data, size_t n, const char *name, size_t *n_query,
                                          dif_query **query, double (**degrees)[5], dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
