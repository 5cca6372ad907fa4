/* The result files of one CPU/GPU comparison, as they lie in its folder:
 *
 *   compare.json  {"schema", "title", "provenance": {...}, "device": {renderer ...}, "conditions": {...},
 *                  "thresholds": {...}, "verdict": {"pass", "n", "n_failed"}, "surfaces": [{"slug", "title",
 *                  "description", "skipped": [{"method", "text"}], "cases": [CASE ...]}], "baseline": {...} or absent}
 *   SLUG.METHOD.QUESTION.PATH.{device,reference,difference}.png   pictures that a CASE names
 *   SLUG.sheet.table.{device,reference}.exr                       the tables' numbers, for others
 *
 * A CASE is what bench/cli/compare_json.c writes. Numbers that do not exist, and infinite ones, are null.
 * Does not: compute results. */
#ifndef DIF_COMPARE_H
#define DIF_COMPARE_H

#include <jansson.h>
#include <stdio.h>

#include "core/status.h"

#define DIF_COMPARE_SCHEMA "diffbench compare 1"

/* Makes FOLDER/index.html and FOLDER/junit.xml from FOLDER/compare.json and the pictures that it names.
 * Status DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_compare_build(const char *folder, dif_error *err);

/* The document as JUnit XML: a suite for each surface, a test for each case, and one suite for the baseline. */
void dif_compare_junit(FILE *xml, const json_t *doc);

/* The page but for its head and foot. */
DIF_MUST_USE dif_status dif_compare_page(FILE *html, const char *folder, const json_t *doc, dif_error *err);

/* Numbers of cases as a table: for this page and a surface's part of the report. */
void dif_compare_cases(FILE *html, const json_t *cases);

#endif
