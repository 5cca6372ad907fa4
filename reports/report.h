/* The report: result files of a folder in, one self-contained page (index.html) and report.json out.
 * What the files hold: reports/result.h.
 * Does not: measure, fit or compare anything; every number on the page stands in the files. */
#ifndef DIF_REPORT_H
#define DIF_REPORT_H

#include "core/status.h"

/* Builds FOLDER/index.html and FOLDER/report.json from FOLDER/results.json and the files it names. The same files give
 * the same bytes. Both outputs are replaced atomically.
 *
 * Status    DIF_ERR_IO (missing or unreadable file), DIF_ERR_FORMAT (not a result file; the text names the file and
 *           the place), DIF_ERR_SCALE, DIF_ERR_NONFINITE, DIF_ERR_SIZE (damaged picture or table),
 *           DIF_ERR_RESOURCE (no gnuplot), DIF_ERR_FOREIGN (gnuplot failed), DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_report_build(const char *folder, dif_error *err);

#endif
