/* A small set of result files for the tests of reports/: a 48 x 32 surface, a 61 x 9 table, a few maxima and lines. */
#ifndef DIF_TEST_REPORT_FILES_H
#define DIF_TEST_REPORT_FILES_H

#include "near.h"

#include <dirent.h>
#include <jansson.h>
#include <string.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/field.h"
#include "core/io/field_io.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/table_io.h"
#include "core/plan.h"
#include "core/units.h"
#include "reports/result.h"

/* A title that must be escaped everywhere. */
#define REPORT_TITLE "<script>alert(\"1\")</script> & 'grating' </title>"

/* The result object of the test surface; parts are replaced by the tests. */
static inline json_t *report_doc(void)
{
    static const char text[] =
        "{\"schema\": \"" DIF_RESULT_SCHEMA "\", \"title\": \"?\", \"description\": \"<b>made</b> & measured\","
        "\"files\": {\"height\": \"a.height.exr\", \"table\": \"a.table.exr\", \"table_csv\": \"a.table.csv\","
        "  \"maxima\": \"a.maxima.csv\", \"lines\": \"a.lines.csv\"},"
        "\"known\": {\"period_nm\": 2500, \"exact\": true},"
        "\"surface\": {\"nx\": 48, \"ny\": 32, \"pitch_x_nm\": 100, \"pitch_y_nm\": 100, \"size_x_um\": 4.8,"
        "  \"size_y_um\": 3.2, \"range_nm\": 250, \"rms_nm\": 88.4, \"slope_x_rms\": 0.2, \"slope_y_rms\": 0,"
        "  \"slope_max\": 0.31, \"step_nm\": 0.98},"
        "\"plan\": {\"fixed\": \"theta_i\", \"fixed_deg\": 75, \"azimuth_deg\": 0, \"angle_deg_min\": -70,"
        "  \"angle_deg_max\": -10, \"angle_deg_step\": 1, \"n_angle\": 61, \"lambda_nm_min\": 400,"
        "  \"lambda_nm_max\": 720, \"lambda_nm_step\": 40, \"n_lambda\": 9, \"quantity_text\": \"relative BRDF\","
        "  \"window_text\": \"Gaussian\", \"index_n\": 1.5, \"index_kappa\": 0, \"tol\": 1e-6},"
        "\"measure\": {\"bound\": 6.1e-7, \"method_text\": \"Method: sheet.\"},"
        "\"check\": {\"n_sample\": 200, \"worst_amplitude\": 4.6e-8, \"worst_angle_deg\": -33.5,"
        "  \"worst_lambda_nm\": 428, \"worst_value\": 0.83, \"worst_direct\": 0.83},"
        "\"below_tol2\": {\"n\": 3, \"share\": 0.005, \"p_min\": 1.1e-16},"
        "\"fit_table\": {\"ok\": true, \"common_period\": true, \"period_nm\": 2500.003, \"u_nm\": 0.012,"
        "  \"u_covariance_nm\": 0.004, \"u_scatter_nm\": 0.012, \"u_model_nm\": 0.007, \"residual_share\": 0.01, "
        "\"n_data\": 500,"
        "  \"n_parameter\": 40, \"n_ridge\": 1, \"n_iteration\": 9, \"n_part\": 4, \"note\": \"\","
        "  \"ridges\": [{\"order\": 1, \"f_per_um\": 0.4, \"u_f_per_um\": 1e-6, \"period_nm\": 2500.003,"
        "    \"u_covariance_nm\": 0.004, \"u_scatter_nm\": 0.012, \"weight\": 1, \"width_per_um\": 0.0069}]},"
        "\"fit_surface\": {\"ok\": false, \"text\": \"nothing <periodic> in it\"},"
        "\"maxima\": {\"n\": 3, \"first_order\": {\"n\": 9, \"order\": 1, \"mean_nm\": 2500.04, \"sd_nm\": 0.4},"
        "  \"orders\": [{\"order\": 1, \"n\": 3, \"mean_deg\": 0.001, \"rms_deg\": 0.002, \"worst_deg\": -0.003,"
        "    \"period_mean_nm\": 2500.04, \"period_sd_nm\": 0.4}]},"
        "\"energy\": {\"text\": \"Scalar theory.\", \"rows\": [{\"theta_i_deg\": 0, \"lambda_nm\": 560,"
        "  \"albedo\": 1.001, \"reference\": 1.0, \"reference_text\": \"sum of the orders\"}]},"
        "\"orders\": {\"lambda_nm\": 560, \"worst\": 1e-9, \"limit\": 1e-6, \"text\": \"No walls.\", \"rows\":"
        "  [{\"order\": -1, \"angle_deg\": 12.5, \"sampled\": 0.05, \"closed\": 0.05, \"difference\": 1e-12,"
        "    \"efficiency\": 0.06}]},"
        "\"domain\": [{\"level\": \"beyond\", \"text\": \"d/lambda < 2\"}],"
        "\"timings\": {\"rows\": [{\"stage\": \"table\", \"wall_s\": 0.5, \"cpu_s\": 0.9}], \"text\": \"fast\"},"
        "\"verdicts\": [{\"name\": \"period\", \"pass\": true, \"label\": \"\", \"value\": 0.003, \"limit\": 0.024,"
        "    \"unit\": \"nm\"}, {\"name\": \"error\", \"pass\": false, \"label\": \"\", \"value\": 2e-6,"
        "    \"limit\": 1e-6, \"unit\": \"\"}, {\"name\": \"energy\", \"pass\": null, \"label\": \"\","
        "    \"value\": null, \"limit\": null, \"unit\": \"\"}],"
        "\"provenance\": {\"command\": \"report <surface> & more\", \"n\": 3}}";
    json_error_t why;
    json_t *doc = json_loads(text, JSON_REJECT_DUPLICATES, &why);
    if (!doc)
        fail_msg("test document: line %d column %d: %s", why.line, why.column, why.text);
    json_object_set_new(doc, "title", json_string(REPORT_TITLE));
    return doc;
}

static inline void report_write_text(const char *folder, const char *name, const char *text)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(dif_file_write(path, text, strlen(text), NULL), DIF_OK);
}

static inline void report_write_doc(const char *folder, const char *name, const json_t *doc)
{
    char *text = json_dumps(doc, JSON_INDENT(1));
    assert_non_null(text);
    report_write_text(folder, name, text);
    free(text);
}

static inline void report_write_png(const char *folder, const char *name, int side)
{
    uint8_t rgb[64 * 64 * 3];
    unsigned char *png;
    char path[512];
    size_t n;
    assert_in_range(side, 1, 64);
    for (int i = 0; i < 3 * side * side; i++)
        rgb[i] = (uint8_t)(i * 7);
    assert_int_equal(dif_image_encode_png(rgb, side, side, &png, &n, NULL), DIF_OK);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(dif_file_write(path, png, n, NULL), DIF_OK);
    dif_release(png);
}

/* Adds a BRDF map and a comparison of methods to a result object; the pictures are named a.map.png, a.map-level.png. */
static inline void report_add_parts(json_t *doc)
{
    static const char text[] =
        "{\"map\": {\"n_pixel\": 16, \"n_lambda\": 81, \"lambda_nm_step\": 5, \"theta_i_deg\": 30, \"azimuth_deg\": "
        "180,"
        "  \"tol\": 1e-4, \"n_window\": 9, \"exposure\": 12.34, \"gamut\": \"desaturate\", \"outside_gamut\": 0.42,"
        "  \"luminance_max\": 0.9, \"level_decades\": 6, \"white_share\": 0.1},"
        "\"methods\": {\"period_nm\": 2500.01, \"first_order\": true, \"n_check\": 60, \"angle_deg_min\": -55.5,"
        "  \"angle_deg_max\": -40, \"colour_deg_max\": 85, \"colour_deg_step\": 0.25, \"colour_nm_step\": 2, \"rows\": "
        "["
        "  {\"name\": \"sheet\", \"leaves_out\": \"\", \"ok\": true, \"text\": \"\", \"bound\": 6e-7, \"error_worst\": "
        "5e-8,"
        "   \"error_rms\": 2e-8, \"maxima_nm\": 2500.04, \"maxima_sd_nm\": 0.37, \"de_median\": 0, \"de_p95\": 0,"
        "   \"de_worst\": 0, \"wall_s\": 0.025, \"cpu_s\": 0.04},"
        "  {\"name\": \"nmm\", \"leaves_out\": \"a < b\", \"ok\": true, \"text\": \"\", \"bound\": null, "
        "\"error_worst\": 0.1,"
        "   \"error_rms\": 0.01, \"maxima_nm\": 2501.2, \"maxima_sd_nm\": 1.1, \"de_median\": 0.87, \"de_p95\": 2,"
        "   \"de_worst\": 3, \"wall_s\": 2.5, \"cpu_s\": 4},"
        "  {\"name\": \"nmm without its Jacobian\", \"leaves_out\": \"\", \"ok\": true, \"de_median\": 12.3, "
        "\"shift_x\": -0.031,"
        "   \"shift_y\": -0.052},"
        "  {\"name\": \"pq\", \"leaves_out\": \"all\", \"ok\": false, \"text\": \"no period & no patch\"}]}}";
    json_error_t why;
    json_t *parts = json_loads(text, JSON_REJECT_DUPLICATES, &why);
    if (!parts)
        fail_msg("test parts: line %d column %d: %s", why.line, why.column, why.text);
    json_object_update(doc, parts);
    json_decref(parts);
    json_object_set_new(json_object_get(doc, "files"), "map", json_string("a.map.png"));
    json_object_set_new(json_object_get(doc, "files"), "map_level", json_string("a.map-level.png"));
}

/* Adds a study with one row of two pictures and periods beside published ones. */
static inline void report_add_study(json_t *doc)
{
    static const char text[] =
        "{\"study\": {\"theta_i_deg\": 30, \"lambda_nm_step\": 5, \"rows\": [{\"title\": \"Step <x>\", \"text\": \"a & "
        "b\","
        "  \"items\": [{\"label\": \"1 nm\", \"picture\": \"a.study-1-1.png\", \"de_median\": 0, \"de_p95\": 0, "
        "\"de_worst\": 0},"
        "   {\"label\": \"<5> nm\", \"picture\": \"a.study-1-2.png\", \"de_median\": 0.77, \"de_p95\": 8.1, "
        "\"de_worst\": 33}]}],"
        " \"published\": {\"stand_in\": true, \"full_nm\": 1144.262, \"full_sd_nm\": null, \"nmm_nm\": 1144.179,"
        "  \"pq_nm\": 1052.308, \"sides\": [{\"azimuth_deg\": 180, \"thesis_nm\": 1143.82, \"thesis_sd_nm\": 0.32,"
        "  \"right_nm\": 1126.81, \"right_sd_nm\": 0.71, \"nmm_nm\": 1120.7, \"pq_nm\": null}]}}}";
    json_error_t why;
    json_t *parts = json_loads(text, JSON_REJECT_DUPLICATES, &why);
    if (!parts)
        fail_msg("test study: line %d column %d: %s", why.line, why.column, why.text);
    json_object_update(doc, parts);
    json_decref(parts);
}

/* Writes them all. */
static inline void report_write_parts(const char *folder)
{
    json_t *doc = report_doc();
    report_add_parts(doc);
    report_add_study(doc);
    report_write_doc(folder, "a.json", doc);
    json_decref(doc);
    report_write_png(folder, "a.map.png", 16);
    report_write_png(folder, "a.map-level.png", 16);
    report_write_png(folder, "a.study-1-1.png", 9);
    report_write_png(folder, "a.study-1-2.png", 9);
}

static inline void report_make_field(dif_field *field)
{
    assert_int_equal(dif_field_create(48, 32, 0.1, 0.1, field, NULL), DIF_OK);
    for (int iy = 0; iy < field->ny; iy++) {
        for (int ix = 0; ix < field->nx; ix++)
            field->z_um[iy * field->nx + ix] = 0.125 * sin(DIF_TWO_PI * dif_field_x_um(field, ix) / 2.5) + 0.001 * iy;
    }
}

/* One ridge of period 2.5 um, first order, incidence at 75 degrees. */
static inline void report_make_table(dif_table *table)
{
    dif_plan plan;
    assert_int_equal(dif_plan_create(61, 9, &plan, NULL), DIF_OK);
    plan.fixed_rad = dif_rad_from_deg(75.0);
    for (int i = 0; i < 61; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-70.0 + i);
    for (int i = 0; i < 9; i++)
        plan.lambda_um[i] = 0.4 + 0.04 * i;
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_RHO, table, NULL), DIF_OK);
    for (int i = 0; i < 61 * 9; i++) {
        double sin_sum, cos_sum;
        dif_plan_transfer(&plan, i % 61, &sin_sum, &cos_sum);
        const double off = sin_sum / plan.lambda_um[i / 61] - 1.0 / 2.5;
        table->value[i] = exp(-0.5 * off * off / (0.02 * 0.02)) + 1e-9;
    }
    dif_plan_free(&plan);
}

/* Writes results.json, a.json and its files. */
static inline void report_write_all(const char *folder)
{
    dif_field field;
    dif_table table;
    const dif_manifest none = {0};
    char path[512];
    report_make_field(&field);
    report_make_table(&table);
    snprintf(path, sizeof path, "%s/a.height.exr", folder);
    assert_int_equal(dif_field_write(path, &field, &none, NULL), DIF_OK);
    snprintf(path, sizeof path, "%s/a.table.exr", folder);
    assert_int_equal(dif_table_write(path, &table, DIF_LAYOUT_TIDY, &none, NULL), DIF_OK);
    dif_field_free(&field);
    dif_table_free(&table);
    report_write_text(folder, "a.maxima.csv",
                      "# made: for a test\n" DIF_RESULT_MAXIMA_HEADER "\n400,-53.6,0.9,1,0.001,2500.1,1,0,1\n"
                      "440,-52.1,0.8,1,-0.002,2499.9,1,0,1\n480,-69.9,0.7,0,nan,nan,0,1,0\n");
    report_write_text(folder, "a.lines.csv",
                      DIF_RESULT_LINES_HEADER "\n0.39,1e-4,12\n0.4,0.5,13\n0.41,1e-4,9\n0.42,0,0\n");
    json_t *doc = report_doc();
    report_write_doc(folder, "a.json", doc);
    json_decref(doc);
    report_write_text(
        folder, "results.json",
        "{\"schema\": \"" DIF_RESULT_LIST_SCHEMA "\", \"title\": \"Report <1> & more\","
        " \"provenance\": {\"program\": \"diffbench\", \"version\": \"<0>\"}, \"surfaces\": [\"a.json\"]}");
}

/* A new folder with all the files; the caller removes it with report_folder_remove. */
static inline char *report_folder(char folder[64])
{
    snprintf(folder, 64, "/tmp/dif_report_XXXXXX");
    assert_non_null(mkdtemp(folder));
    report_write_all(folder);
    return folder;
}

static inline void report_folder_remove(const char *folder)
{
    char path[512];
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    for (const struct dirent *entry; (entry = readdir(dir));) {
        snprintf(path, sizeof path, "%s/%.200s", folder, entry->d_name);
        if (entry->d_name[0] != '.')
            assert_int_equal(unlink(path), 0);
    }
    closedir(dir);
    assert_int_equal(rmdir(folder), 0);
}

/* The text of FOLDER/NAME; freed with dif_release. */
static inline char *report_read(const char *folder, const char *name)
{
    char path[512];
    unsigned char *data;
    size_t n;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(dif_file_read(path, (size_t)1 << 26, &data, &n, NULL), DIF_OK);
    return (char *)data;
}

#endif
