/* The interpolation itself, written once: response.c includes this for each number type and tap count.
 * Wants DIF_REAL, DIF_LZ (planes read per tap row: 8 or 16) and DIF_NAME(x). No include guard on purpose. */

typedef DIF_REAL DIF_NAME(vec) __attribute__((vector_size(64)));
typedef DIF_REAL DIF_NAME(view) __attribute__((vector_size(64), aligned(sizeof(DIF_REAL)), may_alias));

enum {
    DIF_NAME(LANES) = 64 / sizeof(DIF_REAL),
    DIF_NAME(TAP_VECS) = DIF_SHEET_TAPS / DIF_NAME(LANES),
    DIF_NAME(ROW_VECS) = 2 * DIF_LZ / DIF_NAME(LANES)
};

/* Tap weights of one axis (0 = s, 1 = y, 2 = z) at offset t. */
DIF_INLINE void DIF_NAME(taps)(const DIF_REAL *coef, int degree, int axis, DIF_REAL t, DIF_REAL *out)
{
    const DIF_REAL *row = coef + (size_t)(degree * 3 + axis) * DIF_SHEET_TAPS;
    DIF_NAME(vec) sum[DIF_NAME(TAP_VECS)];
    for (int v = 0; v < DIF_NAME(TAP_VECS); v++)
        sum[v] = *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
    for (int k = degree - 1; k >= 0; k--) {
        row -= 3 * DIF_SHEET_TAPS;
        for (int v = 0; v < DIF_NAME(TAP_VECS); v++)
            sum[v] = sum[v] * t + *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
    }
    for (int v = 0; v < DIF_NAME(TAP_VECS); v++)
        *(DIF_NAME(view) *)(out + v * DIF_NAME(LANES)) = sum[v];
}

/* sum over planes of tap weight times the row sums: real and imaginary parts. */
DIF_INLINE void DIF_NAME(contract)(const DIF_NAME(vec) * acc, const DIF_REAL *tap_z, DIF_REAL *re, DIF_REAL *im)
{
    DIF_REAL row[2 * DIF_LZ], twice[2 * DIF_LZ];
    for (int j = 0; j < DIF_LZ; j++)
        twice[2 * j] = twice[2 * j + 1] = tap_z[j];
    for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
        *(DIF_NAME(view) *)(row + v * DIF_NAME(LANES)) =
            acc[v] * *(const DIF_NAME(view) *)(twice + v * DIF_NAME(LANES));
    for (int half = DIF_LZ; half >= 2; half /= 2)
        for (int j = 0; j < half; j++)
            row[j] += row[j + half];
    *re = row[0];
    *im = row[1];
}

/* One point of a line sheet. */
DIF_INLINE void DIF_NAME(line)(const dif_sheet *sheet, const DIF_REAL *coef, const dif_place *s, const dif_place *z,
                               DIF_REAL *re, DIF_REAL *im)
{
    DIF_REAL tap_s[DIF_SHEET_TAPS], tap_z[DIF_SHEET_TAPS];
    DIF_NAME(taps)(coef, sheet->degree, 0, (DIF_REAL)s->offset, tap_s);
    DIF_NAME(taps)(coef, sheet->degree, 2, (DIF_REAL)z->offset, tap_z);
    const size_t step = 2 * (size_t)sheet->stride;
    const DIF_REAL *row = (const DIF_REAL *)sheet->planes + step * (size_t)s->first + 2 * (size_t)z->first;
    DIF_NAME(vec) acc[DIF_NAME(ROW_VECS)];
    for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
        acc[v] = tap_s[0] * *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
    for (int i = 1; i < sheet->s.kernel.width; i++) {
        row += step;
        for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
            acc[v] += tap_s[i] * *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
    }
    DIF_NAME(contract)(acc, tap_z, re, im);
}

/* One point of a volume sheet; two sums at a time hide the latency of the additions. */
DIF_INLINE void DIF_NAME(volume)(const dif_sheet *sheet, const DIF_REAL *coef, const dif_place *x, const dif_place *y,
                                 const dif_place *z, DIF_REAL *re, DIF_REAL *im)
{
    DIF_REAL tap_x[DIF_SHEET_TAPS], tap_y[DIF_SHEET_TAPS], tap_z[DIF_SHEET_TAPS];
    DIF_NAME(taps)(coef, sheet->degree, 0, (DIF_REAL)x->offset, tap_x);
    DIF_NAME(taps)(coef, sheet->degree, 1, (DIF_REAL)y->offset, tap_y);
    DIF_NAME(taps)(coef, sheet->degree, 2, (DIF_REAL)z->offset, tap_z);
    const size_t step_y = 2 * (size_t)sheet->stride, step_x = step_y * (size_t)sheet->y.n;
    const DIF_REAL *column =
        (const DIF_REAL *)sheet->planes + step_x * (size_t)x->first + step_y * (size_t)y->first + 2 * (size_t)z->first;
    DIF_NAME(vec) acc[2][DIF_NAME(ROW_VECS)] = {0};
    for (int i = 0; i < sheet->s.kernel.width; i++, column += step_x) {
        const DIF_REAL *row = column;
        for (int j = 0; j < sheet->y.kernel.width; j++, row += step_y) {
            const DIF_REAL weight = tap_x[i] * tap_y[j];
            for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
                acc[i & 1][v] += weight * *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
        }
    }
    for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
        acc[0][v] += acc[1][v];
    DIF_NAME(contract)(acc[0], tap_z, re, im);
}

/* n points whose places are known. */
DIF_CLONES static void DIF_NAME(line_points)(const dif_sheet *sheet, const DIF_REAL *coef, int n, const dif_place *s,
                                             const dif_place *z, double (*amp)[2])
{
    for (int i = 0; i < n; i++) {
        DIF_REAL re, im;
        DIF_NAME(line)(sheet, coef, s + i, z + i, &re, &im);
        amp[i][0] = (double)re;
        amp[i][1] = (double)im;
    }
}

DIF_CLONES static void DIF_NAME(volume_points)(const dif_sheet *sheet, const DIF_REAL *coef, int n, const dif_place *x,
                                               const dif_place *y, const dif_place *z, double (*amp)[2])
{
    for (int i = 0; i < n; i++) {
        DIF_REAL re, im;
        DIF_NAME(volume)(sheet, coef, x + i, y + i, z + i, &re, &im);
        amp[i][0] = (double)re;
        amp[i][1] = (double)im;
    }
}

/* A row of a rectangle: the x taps of each point and the y taps of the row are given; kz < 0 marks no point. */
DIF_CLONES static void DIF_NAME(grid_row)(const dif_sheet *sheet, const DIF_REAL *coef, int n, const dif_place *x,
                                          const DIF_REAL *tap_x, int y_first, const DIF_REAL *tap_y, const double *kz,
                                          float *power)
{
    const double inv_z = 1.0 / sheet->z.step;
    const size_t step_y = 2 * (size_t)sheet->stride, step_x = step_y * (size_t)sheet->y.n;
    const int width_x = sheet->s.kernel.width, width_y = sheet->y.kernel.width;
    for (int i = 0; i < n; i++) {
        if (kz[i] < 0.0) {
            power[i] = 0.0f;
            continue;
        }
        DIF_REAL tap_z[DIF_SHEET_TAPS], re, im;
        const dif_place z = place_on(&sheet->z, inv_z, kz[i]);
        DIF_NAME(taps)(coef, sheet->degree, 2, (DIF_REAL)z.offset, tap_z);
        const DIF_REAL *column = (const DIF_REAL *)sheet->planes + step_x * (size_t)x[i].first +
                                 step_y * (size_t)y_first + 2 * (size_t)z.first;
        DIF_NAME(vec) acc[DIF_NAME(ROW_VECS)] = {0};
        for (int a = 0; a < width_x; a++, column += step_x) {
            const DIF_REAL *row = column;
            DIF_NAME(vec) line[DIF_NAME(ROW_VECS)] = {0};
            for (int b = 0; b < width_y; b++, row += step_y)
                for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
                    line[v] += tap_y[b] * *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
            for (int v = 0; v < DIF_NAME(ROW_VECS); v++)
                acc[v] += tap_x[i * DIF_SHEET_TAPS + a] * line[v];
        }
        DIF_NAME(contract)(acc, tap_z, &re, &im);
        power[i] = (float)(re * re + im * im);
    }
}

/* Taps of all points of one axis: tap[n][DIF_SHEET_TAPS]. */
DIF_CLONES static void DIF_NAME(axis_taps)(const dif_sheet *sheet, const DIF_REAL *coef, int axis, int n,
                                           const dif_place *place, DIF_REAL *tap)
{
    for (int i = 0; i < n; i++)
        DIF_NAME(taps)(coef, sheet->degree, axis, (DIF_REAL)place[i].offset, tap + i * DIF_SHEET_TAPS);
}

/* A rectangle of at most DIF_RESPONSE_GRID points a side. */
static void DIF_NAME(grid)(const dif_sheet *sheet, const DIF_REAL *coef, int nx, const dif_place *x, int ny,
                           const dif_place *y, const double *kz, size_t kz_stride, float *power, size_t power_stride)
{
    DIF_REAL tap_x[DIF_RESPONSE_GRID * DIF_SHEET_TAPS], tap_y[DIF_RESPONSE_GRID * DIF_SHEET_TAPS];
    DIF_NAME(axis_taps)(sheet, coef, 0, nx, x, tap_x);
    DIF_NAME(axis_taps)(sheet, coef, 1, ny, y, tap_y);
    for (int j = 0; j < ny; j++)
        DIF_NAME(grid_row)
    (sheet, coef, nx, x, tap_x, y[j].first, tap_y + j * DIF_SHEET_TAPS, kz + (size_t)j * kz_stride,
     power + (size_t)j * power_stride);
}

#if DIF_LZ == 8 /* whole columns have no tap rows: one version a number type is enough */

/* Sums `n_vec` vectors of planes (from plane 0 up) over the lateral taps of one point. With n_vec known when compiled the
 * sums stay in registers. */
DIF_INLINE void DIF_NAME(sum_planes)(const dif_sheet *sheet, const dif_place *x, const DIF_REAL *tap_x,
                                     const dif_place *y, const DIF_REAL *tap_y, int n_vec, size_t offset, DIF_REAL *out)
{
    const size_t step_y = 2 * (size_t)sheet->stride, step_x = step_y * (size_t)sheet->y.n;
    const DIF_REAL *column =
        (const DIF_REAL *)sheet->planes + step_x * (size_t)x->first + step_y * (size_t)y->first + offset;
    DIF_NAME(vec) acc[4] = {0};
    for (int a = 0; a < sheet->s.kernel.width; a++, column += step_x) {
        const DIF_REAL *row = column;
        for (int b = 0; b < sheet->y.kernel.width; b++, row += step_y) {
            const DIF_REAL weight = tap_x[a] * tap_y[b];
            for (int v = 0; v < n_vec; v++)
                acc[v] += weight * *(const DIF_NAME(view) *)(row + v * DIF_NAME(LANES));
        }
    }
    for (int v = 0; v < n_vec; v++)
        *(DIF_NAME(view) *)(out + v * DIF_NAME(LANES)) = acc[v];
}

/* All planes of one point: planes[2 * (z.n + DIF_SHEET_PAD)]. */
DIF_INLINE void DIF_NAME(all_planes)(const dif_sheet *sheet, const dif_place *x, const DIF_REAL *tap_x,
                                     const dif_place *y, const DIF_REAL *tap_y, DIF_REAL *planes)
{
    const int n_vec = (2 * sheet->z.n + DIF_NAME(LANES) - 1) / DIF_NAME(LANES);
    int done = 0;
    for (; done + 4 <= n_vec; done += 4)
        DIF_NAME(sum_planes)
    (sheet, x, tap_x, y, tap_y, 4, (size_t)(done * DIF_NAME(LANES)), planes + done * DIF_NAME(LANES));
    const size_t at = (size_t)(done * DIF_NAME(LANES));
    switch (n_vec - done) {
    case 3:
        DIF_NAME(sum_planes)(sheet, x, tap_x, y, tap_y, 3, at, planes + at);
        break;
    case 2:
        DIF_NAME(sum_planes)(sheet, x, tap_x, y, tap_y, 2, at, planes + at);
        break;
    case 1:
        DIF_NAME(sum_planes)(sheet, x, tap_x, y, tap_y, 1, at, planes + at);
        break;
    }
}

/* n lateral points, each at the same n_z values of kappa_z. */
DIF_CLONES static void DIF_NAME(columns)(const dif_sheet *sheet, const DIF_REAL *coef, int n, const dif_place *x,
                                         const dif_place *y, int n_z, const dif_place *z, float *power)
{
    DIF_REAL tap_z[DIF_RESPONSE_DEPTHS * DIF_SHEET_TAPS];
    DIF_REAL planes[2 * (DIF_RESPONSE_PLANES + DIF_SHEET_PAD + DIF_NAME(LANES))];
    for (int k = 0; k < n_z; k++)
        DIF_NAME(taps)(coef, sheet->degree, 2, (DIF_REAL)z[k].offset, tap_z + k * DIF_SHEET_TAPS);
    for (int i = 0; i < n; i++) {
        DIF_REAL tap_x[DIF_SHEET_TAPS], tap_y[DIF_SHEET_TAPS];
        DIF_NAME(taps)(coef, sheet->degree, 0, (DIF_REAL)x[i].offset, tap_x);
        DIF_NAME(taps)(coef, sheet->degree, 1, (DIF_REAL)y[i].offset, tap_y);
        DIF_NAME(all_planes)(sheet, x + i, tap_x, y + i, tap_y, planes);
        for (int k = 0; k < n_z; k++) {
            const DIF_REAL *from = planes + 2 * z[k].first, *tap = tap_z + k * DIF_SHEET_TAPS;
            DIF_REAL re = 0, im = 0;
            for (int j = 0; j < sheet->z.kernel.width; j++) {
                re += tap[j] * from[2 * j];
                im += tap[j] * from[2 * j + 1];
            }
            power[i * n_z + k] = (float)(re * re + im * im);
        }
    }
}

#endif

#undef DIF_REAL
#undef DIF_LZ
#undef DIF_NAME
