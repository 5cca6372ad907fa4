/* Writes the seed corpus: make_corpus FOLDER. Each file is what its target takes, a byte that chooses options first. */
#define _POSIX_C_SOURCE 200809L /* mkdir */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/field_raw.h"
#include "core/io/table_impl.h"
#include "core/units.h"
#include "tests/exr_sample.h"
#include "tests/gwy_sample.h"
#include "tests/gzip_sample.h"
#include "tests/x3p_sample.h"

static const char *root;

/* Leaves out the `skip` magic bytes that the target puts before its input. */
static void save(const char *kind, int number, int options, const void *data, size_t n, size_t skip)
{
    char path[1000];
    snprintf(path, sizeof path, "%s/%s", root, kind);
    mkdir(path, 0777);
    snprintf(path, sizeof path, "%s/%s/%02d", root, kind, number);
    FILE *file = fopen(path, "wb");
    if (!file || fputc(options, file) == EOF || fwrite((const char *)data + skip, 1, n - skip, file) != n - skip ||
        fclose(file) != 0) {
        fprintf(stderr, "%s: cannot write\n", path);
        exit(1);
    }
}

static void check(dif_status status, const dif_error *err)
{
    if (status) {
        fprintf(stderr, "%s\n", err->text);
        exit(1);
    }
}

static void save_fields(void)
{
    static const char UNSCALED[] = "Gwyddion Simple Field 1.0\nXRes = 1\nYRes = 1\nTitle=x\n\0\0\0\0\0\0\0\0";
    dif_field field;
    dif_error err;
    dif_manifest manifest = {0};
    unsigned char *data = NULL;
    size_t n = 0;
    check(dif_manifest_set(&manifest, "command", "diffbench", &err), &err);
    check(dif_field_create(3, 2, 0.05, 0.1, &field, &err), &err);
    for (int i = 0; i < 6; i++)
        field.z_um[i] = 0.1 * i;
    check(dif_gsf_encode(&field, &manifest, &data, &n, &err), &err);
    save("gsf", 0, 0, data, n, 26);
    dif_release(data);
    size_t n_header = sizeof UNSCALED - 1;
    save("gsf", 1, 9, UNSCALED, n_header - n_header % 4, 26);
    check(dif_exr_field_encode(&field, &manifest, &data, &n, &err), &err);
    save("exr", 0, 0, data, n, 4);
    dif_release(data);
    dif_field_free(&field);
    dif_manifest_free(&manifest);
}

static void save_exr_samples(void)
{
    int number = 2;
    for (int compression = 0; compression < EXR_COMPRESSION_DWAA; compression++) {
        exr_sample sample = exr_sample_make(7, 3);
        sample.compression = (exr_compression_t)compression;
        sample.type = compression % 2 ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
        sample.tile = compression % 3 == 2 ? 16 : 0;
        sample.n_channel = compression > 4 ? 2 : 1;
        sample.names[0] = compression > 4 ? "R" : "height";
        sample.names[1] = "G";
        sample.keys[0] = "Gwy::XReal";
        sample.texts[0] = "1e-6";
        sample.keys[1] = "Gwy::ZUnit";
        sample.texts[1] = "um";
        exr_sample_write(&sample);
        save("exr", number++, 25, sample.data, sample.n, 4);
    }
}

static void save_table(void)
{
    dif_plan plan;
    dif_table table;
    dif_error err;
    unsigned char *data = NULL;
    size_t n = 0;
    check(dif_plan_create(3, 2, &plan, &err), &err);
    plan.fixed_rad = dif_rad_from_deg(75.0);
    for (int i = 0; i < 3; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-50.0 + i);
    plan.lambda_um[0] = 0.5;
    plan.lambda_um[1] = 0.6;
    check(dif_table_create(&plan, DIF_QUANTITY_RHO, &table, &err), &err);
    check(dif_table_exr_encode(&table, NULL, &data, &n, &err), &err);
    save("exr", 1, 0, data, n, 4);
    dif_release(data);
    dif_table_free(&table);
    dif_plan_free(&plan);
}

static void save_gwy(void)
{
    gwy_file file;
    gwy_full(&file);
    save("gwy", 0, 0, file.data, file.n, 4);
    size_t at = gwy_begin(&file, "GWYP");
    gwy_key(&file, "/0/data", 'o');
    gwy_field_object(&file, 1e-9, NULL, "nm");
    gwy_close(&file, at);
    save("gwy", 1, 9, file.data, file.n, 4);
    at = gwy_begin(&file, "GWYO");
    gwy_key_v1(&file, 80, "/0/data");
    gwy_field_object(&file, 1e-9, "m", "m");
    gwy_key_v1(&file, 64, "/0/data/title");
    gwy_bytes(&file, "Old", 4);
    gwy_close(&file, at);
    save("gwy", 2, 16, file.data, file.n, 4);
}

/* Binary and text; the first byte chooses the magic, which the target puts. */
static void save_sdf(void)
{
    static const char TEXT[] =
        "\nManufacID = x\nNumPoints = 2\nNumProfiles = 2\nXscale = 1E-6\nYscale = 1e-6\nZscale = 1e-9\n"
        "Zresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n; remark\n*\n1 2.5\nBAD 4\n*\n< A > b < / A "
        ">\n*";
    static const unsigned char SIZES[] = {1, 2, 4, 4, 1, 2, 4, 8};
    const double scales[4] = {1e-6, 2e-6, 1e-9, -1.0};
    for (int type = 0; type < 8; type++) {
        unsigned char file[81 + 32] = {0};
        memset(file + 8, '1', 34);
        file[42] = file[44] = 2;
        memcpy(file + 46, scales, sizeof scales);
        file[79] = (unsigned char)type;
        for (int i = 0; i < 4; i++)
            file[81 + i * SIZES[type]] = (unsigned char)i;
        save("sdf", type, type % 2 << 4, file, 81 + 4 * (size_t)SIZES[type], 8);
    }
    save("sdf", 8, 2 << 4, TEXT, sizeof TEXT - 1, 0);
    save("sdf", 9, 3 << 4 | 9, TEXT, sizeof TEXT - 1, 0);
}

static void save_x3p(void)
{
    static const char BITMAP[] =
        "<DataLink><PointDataLink>d</PointDataLink><ValidPointsLink>d</ValidPointsLink>"
        "<MD5ChecksumPointData>d41d8cd98f00b204e9800998ecf8427e</MD5ChecksumPointData></DataLink>";
    static const char *const TYPES[] = {"I", "L", "F", "D"};
    static const size_t SIZES[] = {2, 4, 4, 8};
    char file[X3P_XML + 64] = "";
    for (int i = 0; i < 6; i++) {
        x3p_head head = x3p_head_make();
        head.type = TYPES[i % 4];
        head.data = i == 4   ? "<DataList><Datum>1;2;3</Datum><Datum/><Datum>4</Datum></DataList>"
                    : i == 5 ? BITMAP
                             : "<DataLink><PointDataLink>d</PointDataLink></DataLink>";
        head.size = i == 4 ? "<SizeX>3</SizeX><SizeY>1</SizeY>" : "<SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ>";
        head.z_scale = i % 2 ? "<Increment>1e-9</Increment><Offset>1e-6</Offset>" : "";
        const size_t n = (size_t)x3p_xml(&head, file) + 1;
        memset(file + n, i, 48);
        save("x3p", i, 16 + 9 * (i == 2), file, n + 6 * SIZES[i % 4], 0);
    }
    const x3p_head head = x3p_head_make();
    const x3p_file points[] = {{"bindata/data.bin", X3P_SIX, sizeof X3P_SIX}, {0}};
    const zip_bytes whole = x3p_make(&head, points), inside = x3p_make_in("a/", &head, points);
    save("x3p", 6, 128, whole.data, whole.n, 4);
    save("x3p", 7, 128 | 32, inside.data, inside.n, 4);
    free(whole.data);
    free(inside.data);
}

static void save_gzip(void)
{
    unsigned char packed[1000];
    size_t n = gzip_sample("1 2\n3 4\n", 8, packed, sizeof packed);
    save("gzip", 0, 1, packed, n, 0);
    save("text", 20, 9, packed, n, 0);
    n += gzip_sample("aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", 35, packed + n, sizeof packed - n);
    save("gzip", 1, 0, packed, n, 0);
}

typedef struct seed {
    int options;
    const char *text;
} seed;

static void save_texts(const char *kind, const seed *seeds, size_t n)
{
    for (size_t i = 0; i < n; i++)
        save(kind, (int)i, seeds[i].options, seeds[i].text, strlen(seeds[i].text), 0);
}

int main(int argc, char **argv)
{
    static const seed TEXT[] = {
        {0, "# Channel: T\n# Width: 6 \xc2\xb5m\n# Height: 500 nm\n# Value units: nm\n1 2 3\n4 5e-007 6\n"},
        {0, "# Kanal: T\n# Breite: 6,5 \xb5m\n# H\xc3\xb6he: 5 nm\n# Value units: m\n1,5;2\n3;4\n"},
        {0, "h=2 w=2\npixel size=3e-007 m\ndata unit=rad\nheight conversion factor (-> m)=2e-008\n1 2\n3 4\n"},
        {9, "1\t2\tNaN\n4\tBAD\t***\n"},
        {9, "0 0 1\n1 0 1\n0 1 1\n1 1 1\n"},
        {9, "; remark\n1,2,3,\n4,5,6,\n"},
        {9, "\xef\xbb\xbf"
            "1 2\n"},
        {0, "\\*File list\r\n"},
    };
    static const seed CSV[] = {
        {0, "# quantity: rho\n# fixed_deg: 75\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n"
            "75,90,-55,90,380,1e-3\n75,90,55,270,390,nan\n"},
        {0, "# fixed_angle: theta_r\n# fixed_deg: 75\n# azimuth_deg: "
            "30\nlambda_nm\\theta_i_deg,-55,-54\n380,0,1\n390,2,3\n"},
        {0, "wavelength_nm;power;theta_r_deg;theta_i_deg\n600;4;-10;75\n500,5;1;-20;75\n"},
        {0, "theta_i_deg theta_r_deg lambda_nm brdf\n\"1\" 2 3 4\n"},
        {1, "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm\n60,0,30,180,550\n0,0,89.9,10,400\n"},
        {1, "Lambda_nm\ttheta_r_deg\ttheta_i_deg\r\n550\t30\t60\r\n"},
    };
    /* behind the magic line; the samples follow at once, the bytes that the offsets name */
    static const seed NANOSCOPE[] = {
        {0, "\\Version: 0x07200000\r\n\\*Scanner list\r\n\\@Sens. Zsens: V 20.5 nm/V\r\n\\*Ciao scan list\r\n"
            "\\Lines: 2\r\n\\@Sens. Phase: V 1.0 \r\n"
            "\\*Ciao image list\r\n\\Data offset: 500\r\n\\Data length: 8\r\n\\Bytes/pixel: 2\r\n\\Samps/line: 2\r\n"
            "\\Number of lines: 2\r\n\\Aspect Ratio: 2:1\r\n\\Scan Size: 3 2 ~m\r\n"
            "\\@2:Image Data: S [Height] \"Height\"\r\n\\@2:Z scale: V [Sens. Zsens] (0.5 V/LSB) 10.0 V\r\n"
            "\\*File list end\r\n................................................................................"
            "................................................................................................"},
        {9, "\\Version: 0x09700105\r\n\\*Image list\r\n\\Data offset: 230\r\n\\Data length: 32\r\n\\Bytes/pixel: 4\r\n"
            "\\Samps/line: 2\r\n\\Number of lines: 8\r\n\\Valid data len Y: 4\r\n\\Scan size: 0 nm\r\n"
            "\\@2:Z scale: V (0.0055 \xba/LSB) 360 \xba\r\n\\*File list end\r\n"
            "............................................................................................"},
        {9,
         "\\*Controller list\r\n\\Z max: 4\r\n\\*Microscope list\r\n\\Z sensitivity: 7\r\n\\*AFM image list\r\n"
         "\\Data offset: 300\r\n\\Data length: 8\r\n\\Samps/line: 2\r\n\\Number of lines: 2\r\n\\Scan size: 300 nm\r\n"
         "\\Image data: Height\r\n\\Z scale height: 0.5\r\n\\*File list end\r\n"
         "............................................................................................"},
    };
    if (argc != 2) {
        fprintf(stderr, "usage: make_corpus FOLDER\n");
        return 2;
    }
    root = argv[1];
    mkdir(root, 0777);
    save_fields();
    save_exr_samples();
    save_table();
    save_gwy();
    save_texts("nanoscope", NANOSCOPE, sizeof NANOSCOPE / sizeof *NANOSCOPE);
    save_sdf();
    save_x3p();
    save_gzip();
    save_texts("text", TEXT, sizeof TEXT / sizeof *TEXT);
    save_texts("csv", CSV, sizeof CSV / sizeof *CSV);
    save("text", (int)(sizeof TEXT / sizeof *TEXT), 9,
         "\xff\xfe"
         "1\0 \0"
         "2\0\n\0",
         10, 0);
    return 0;
}
