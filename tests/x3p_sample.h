/* zip archives and x3p surfaces made in memory, with each part free to be wrong. */
#ifndef DIF_TEST_X3P_SAMPLE_H
#define DIF_TEST_X3P_SAMPLE_H

#include "tests/near.h"

#include <string.h>
#include <zip.h>

#include "core/io/md5.h"

enum { X3P_FILES = 6, X3P_XML = 4096 };

typedef struct x3p_file {
    const char *path; /* NULL ends the list; one that ends in a slash is a folder */
    const void *data;
    size_t n;
} x3p_file;

typedef struct zip_bytes {
    unsigned char *data; /* data[n], the caller frees */
    size_t n;
} zip_bytes;

static inline zip_bytes zip_make(const x3p_file *files, zip_int32_t method)
{
    zip_error_t reason;
    zip_stat_t about;
    zip_source_t *target = zip_source_buffer_create(NULL, 0, 0, &reason);
    assert_non_null(target);
    zip_source_keep(target); /* closing the archive would free it */
    zip_t *zip = zip_open_from_source(target, ZIP_TRUNCATE, &reason);
    assert_non_null(zip);
    for (int i = 0; files[i].path; i++) {
        if (files[i].path[strlen(files[i].path) - 1] == '/') {
            assert_true(zip_dir_add(zip, files[i].path, 0) >= 0);
            continue;
        }
        zip_source_t *bytes = zip_source_buffer(zip, files[i].data, files[i].n, 0);
        assert_non_null(bytes);
        const zip_int64_t index = zip_file_add(zip, files[i].path, bytes, 0);
        assert_true(index >= 0);
        assert_int_equal(zip_set_file_compression(zip, (zip_uint64_t)index, method, 9), 0);
        assert_int_equal(zip_file_set_mtime(zip, (zip_uint64_t)index, 1700000000, 0), 0);
    }
    assert_int_equal(zip_close(zip), 0);
    zip_stat_init(&about);
    assert_int_equal(zip_source_stat(target, &about), 0);
    zip_bytes out = {malloc(about.size), about.size};
    assert_non_null(out.data);
    assert_int_equal(zip_source_open(target), 0);
    assert_int_equal(zip_source_read(target, out.data, about.size), (zip_int64_t)about.size);
    zip_source_close(target);
    zip_source_free(target);
    return out;
}

/* What main.xml says; the first form is a whole surface of 3 x 2 doubles. */
typedef struct x3p_head {
    const char *before, *prefix, *revision, *feature; /* `before` stands above the root element */
    const char *x_axis, *y_axis, *z_axis, *type;      /* `x_axis` ... are AxisTypes              */
    const char *x_step, *y_step, *z_scale;            /* elements of CX, CY, CZ                  */
    const char *size;                                 /* MatrixDimension                         */
    const char *data;                                 /* DataLink or DataList                    */
} x3p_head;

static inline x3p_head x3p_head_make(void)
{
    const x3p_head head = {.before = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n",
                           .prefix = "p:",
                           .revision = "ISO5436 - 2000",
                           .feature = "SUR",
                           .x_axis = "I",
                           .y_axis = "I",
                           .z_axis = "A",
                           .type = "D",
                           .x_step = "<Increment>2e-6</Increment><Offset>7</Offset>",
                           .y_step = "<Increment>1e-6</Increment><Offset>8</Offset>",
                           .z_scale = "",
                           .size = "<SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ>",
                           .data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>"};
    return head;
}

static inline int x3p_xml(const x3p_head *head, char xml[X3P_XML])
{
    const char *p = head->prefix, *q = p[0] ? ":" : "";
    return snprintf(
        xml, X3P_XML,
        "%s<%sISO5436_2 xmlns%s%.*s=\"http://www.opengps.eu/2008/ISO5436_2\">\n<Record1><Revision>%s</Revision>"
        "<FeatureType>%s</FeatureType><Axes><CX><AxisType>%s</AxisType><DataType>D</DataType>%s</CX><CY><AxisType>%s"
        "</AxisType><DataType>D</DataType>%s</CY><CZ><AxisType>%s</AxisType><DataType>%s</DataType>%s</CZ></Axes>"
        "</Record1><Record2><Comment>&lt;Record3&gt; &amp; <![CDATA[<x>]]></Comment></Record2>\n<Record3>"
        "<MatrixDimension>%s</MatrixDimension>%s</Record3>\n<Record4><ChecksumFile>md5checksum.hex</ChecksumFile>"
        "</Record4></%sISO5436_2>\n",
        head->before, p, q, p[0] ? (int)strlen(p) - 1 : 0, p, head->revision, head->feature, head->x_axis, head->x_step,
        head->y_axis, head->y_step, head->z_axis, head->type, head->z_scale, head->size, head->data, p);
}

/* main.xml, its right check sum and the files beside it. */
static inline zip_bytes x3p_make_in(const char *folder, const x3p_head *head, const x3p_file *more)
{
    static char xml[X3P_XML];
    char sum[40], paths[X3P_FILES + 2][100];
    x3p_file files[X3P_FILES + 3] = {{0}};
    const int n_xml = x3p_xml(head, xml);
    dif_md5 md5 = dif_md5_begin();
    dif_md5_add(&md5, xml, (size_t)n_xml);
    dif_md5_hex(&md5, sum);
    const x3p_file own[] = {{"main.xml", xml, (size_t)n_xml}, {"md5checksum.hex", strcat(sum, "\n"), 33}};
    int n = 0;
    for (int i = 0; i < 2 || more[i - 2].path; i++) {
        files[n] = i < 2 ? own[i] : more[i - 2];
        snprintf(paths[n], sizeof paths[n], "%s%s", folder, files[n].path);
        files[n].path = paths[n];
        n++;
    }
    return zip_make(files, ZIP_CM_DEFLATE);
}

static inline zip_bytes x3p_make(const x3p_head *head, const x3p_file *more)
{
    return x3p_make_in("", head, more);
}

static const double X3P_SIX[6] = {1, 2, 3, 4, 5, 6};

#endif
