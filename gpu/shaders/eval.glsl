// The physics on a GPU: functions only, one source for compute and fragment shaders and for a browser.
// Macros that the library sets before it: the sheet's kernels (gpu/gpu_eval_source.c), DIF_FAULT.

#ifndef DIF_FAULT
#define DIF_FAULT 0
#endif

// ---- elementary functions, accurate to 1e-7 everywhere: built-in ones differ by driver ----

// (cos, sin) of a phase in turns: reduced to the nearest quarter, then polynomials on [-1/8, 1/8].
vec2 dif_cis(float turns)
{
    float a = turns - floor(turns + 0.5), quarter = floor(4.0 * a + 0.5), r = a - 0.25 * quarter, x = r * r;
    float s = r * (6.28318531 + x * (-41.341702 + x * (81.6051807 + x * (-76.6958219 + x * 41.4146861))));
    float c = 1.0 + x * (-19.7392088 + x * (64.9393939 + x * (-85.4567689 + x * (60.238436 + x * -26.0640204))));
    vec2 even = abs(quarter) == 2.0 ? vec2(-c, -s) : vec2(c, s);
    return quarter == 1.0 ? vec2(-s, c) : quarter == -1.0 ? vec2(s, -c) : even;
}

// exp(-x), x >= 0
float dif_exp_minus(float x)
{
    float y = min(x, 87.0) * -1.44269504;
    float n = floor(y + 0.5);
    // the rest in two parts, so that it keeps its digits
    float r = (-min(x, 87.0) - n * 0.693359375) + n * 2.12194440e-4;
    float p = 0.0083748158 + r * 0.00138368453;
    p = 1.0 + r * (1.00000004 + r * (0.499999921 + r * (0.166664202 + r * (0.0416682256 + r * p))));
    return p * intBitsToFloat((int(n) + 127) << 23);
}

// atan(y, x) in turns, in (-1/2, 1/2]; 0 at the origin
float dif_atan_turns(float y, float x)
{
    float big = max(abs(x), abs(y)), small = min(abs(x), abs(y));
    if (big == 0.0)
        return 0.0;
    // halve the angle once more so that a short polynomial does: tan(a/2) = t / (1 + sqrt(1 + t^2))
    float t = small / big;
    t = t / (1.0 + sqrt(1.0 + t * t)); // [0, tan(pi/8)]
    float z = t * t;
    float a = t * (0.318309885 + z * (-0.106103097 + z * (0.0636525015 + z * (-0.0452769091 + z * (0.0333607683 + z * -0.0185822553)))));
    a = abs(y) > abs(x) ? 0.25 - a : a;
    a = x < 0.0 ? 0.5 - a : a;
    return y < 0.0 ? -a : a;
}

// asinh(x), x >= 0, to 1e-7 absolute
float dif_asinh(float x)
{
    return x < 0.03 ? x * (1.0 - x * x * (1.0 / 6.0)) : log(x + sqrt(x * x + 1.0));
}

// ---- positions: products of two numbers, each given as a pair (hi, lo) whose hi has 12 bits ----
// hi * hi is exact in float32, so that its whole part can be taken off before the rest is added, whatever a compiler
// contracts. A single float32 product would have no digits left for the fraction.

// Entry i of a list.
vec2 dif_list(sampler2D list, int i)
{
    return texelFetch(list, ivec2(i & ((1 << DIF_LIST_SHIFT) - 1), i >> DIF_LIST_SHIFT), 0).rg;
}

// a * b less its nearest whole number, which is `whole`.
float dif_rest(vec2 a, vec2 b, out float whole)
{
    float high = a.x * b.x;
    whole = floor(high + 0.5);
    return (high - whole) + (a.x * b.y + a.y * b.x + a.y * b.y);
}

// A pair from a float.
vec2 dif_pair(float x)
{
    float high = intBitsToFloat((floatBitsToInt(x) + 0x800) & ~0xfff);
    return vec2(high, x - high);
}

// A tap row: index of its first tap among the stored bins, and the place of the wanted point from the row's centre.
struct dif_place {
    int first;
    float t;
};

// Where a * b falls on an axis of kernels of the given width.  axis: first stored bin, number of stored bins, bins after
// which the transform repeats (0: it need not).  As core/response.c, and kept inside the stored bins.
dif_place dif_place_on(vec2 a, vec2 b, ivec4 axis, int width)
{
    float whole, rest = dif_rest(a, b, whole);
    float odd = (width & 1) == 1 ? 0.5 : 0.0, up = ceil(rest - odd);
    if (axis.z > 0)
        whole -= float(axis.z) * floor((whole + 0.5 * float(axis.z)) / float(axis.z));
    int first = int(whole) + int(up) - width / 2 - axis.x;
    return dif_place(clamp(first, 0, axis.y - width), rest - up + 0.5 - odd);
}

// ---- the sheet transform: core/response.h ----

#ifdef DIF_WIDTH_S
#if DIF_FAULT == DIF_FAULT_IS_TAP
#define DIF_TAP(i) (i == DIF_WIDTH_S / 2 ? 0.0 : 1.0)
#else
#define DIF_TAP(i) 1.0
#endif
#if DIF_FAULT == DIF_FAULT_IS_SIGN
#define DIF_SIDE(i) vec2(1.0, i == DIF_WIDTH_S / 2 ? -1.0 : 1.0)
#else
#define DIF_SIDE(i) vec2(1.0)
#endif
#if DIF_FAULT == DIF_FAULT_IS_PLANE
#define DIF_PLANE(l, n) (l == n / 2 ? 0.0 : 1.0)
#else
#define DIF_PLANE(l, n) 1.0
#endif

#ifdef DIF_WIDTH_Y
// Amplitude of a volume sheet, but for its phase: texel (bin y, bin x), layer = plane.  n_plane: of the sheet.
vec2 dif_volume_sum(sampler2DArray planes, dif_place x, dif_place y, dif_place z, int n_plane)
{
    float tap_x[DIF_WIDTH_S], tap_y[DIF_WIDTH_Y], tap_z[DIF_WIDTH_Z];
    dif_taps_s(x.t, tap_x);
    dif_taps_y(y.t, tap_y);
    dif_taps_z(z.t, tap_z);
    vec2 sum = vec2(0.0);
    for (int l = 0; l < DIF_WIDTH_Z; l++) {
        vec2 plane = vec2(0.0);
        for (int i = 0; i < DIF_WIDTH_S; i++) {
            vec2 row = vec2(0.0);
            for (int j = 0; j < DIF_WIDTH_Y; j++)
                row += tap_y[j] * texelFetch(planes, ivec3(y.first + j, x.first + i, z.first + l), 0).rg;
            plane += tap_x[i] * DIF_TAP(i) * DIF_SIDE(i) * row;
        }
        sum += tap_z[l] * DIF_PLANE(z.first + l, n_plane) * plane;
    }
    return sum;
}
#else
// Amplitude of a line sheet, but for its phase: texel (plane, bin).
vec2 dif_line_sum(sampler2D planes, dif_place s, dif_place z, int n_plane)
{
    float tap_s[DIF_WIDTH_S], tap_z[DIF_WIDTH_Z];
    dif_taps_s(s.t, tap_s);
    dif_taps_z(z.t, tap_z);
    vec2 sum = vec2(0.0);
    for (int i = 0; i < DIF_WIDTH_S; i++) {
        vec2 row = vec2(0.0);
        for (int l = 0; l < DIF_WIDTH_Z; l++)
            row += tap_z[l] * DIF_PLANE(z.first + l, n_plane) * texelFetch(planes, ivec2(z.first + l, s.first + i), 0).rg;
        sum += tap_s[i] * DIF_TAP(i) * DIF_SIDE(i) * row;
    }
    return sum;
}
#endif
#endif

// ---- methods for comparison ----

// sin(n x) / (n sin x) squared, x = pi turns.                                          core/replica.h
float dif_replica_power(int n, vec2 a, vec2 b)
{
    float whole, rest = dif_rest(a, b, whole);
    float below = float(n) * dif_cis(0.5 * rest).y;
    float ratio = below == 0.0 ? 1.0 : dif_cis(0.5 * float(n) * rest).y / below;
    return ratio * ratio;
}

// Distance of a * b from the nearest whole number; a fault takes the one below.
float dif_order_distance(vec2 a, vec2 b)
{
    float whole, rest = dif_rest(a, b, whole);
#if DIF_FAULT == DIF_FAULT_IS_TAP
    return rest - floor(rest);
#else
    return rest - floor(rest + 0.5);
#endif
}

// ---- gains: core/brdf.h ----

// Schlick's reflectance at cos_h of a material (n, kappa).
float dif_schlick(float cos_h, vec2 index)
{
    float q = 1.0 - clamp(cos_h, 0.0, 1.0), q5 = q * q * q * q * q, below = index.x - 1.0, above = index.x + 1.0;
    float kappa2 = index.y * index.y;
    return (below * below + 4.0 * index.x * q5 + kappa2) / (above * above + kappa2);
}

// rho / p and brdf / p of a direction pair: (u, v, w) = -(wi + wo), cosines (wi.z, wo.z).  1 + wi.wo = |uvw|^2 / 2 and
// wo.half = |uvw| / 2 keep their digits where wi.wo nears -1.
float dif_gain_rho(vec3 uvw, vec2 cosines, vec2 index)
{
    float share = dif_schlick(0.5 * length(uvw), index) / dif_schlick(1.0, index);
    float g = 0.5 * dot(uvw, uvw) / uvw.z;
    return share * g * g / cosines.y;
}

float dif_gain_per_sr(vec3 uvw, vec2 cosines, vec2 index, float lambda_um, float area_um2)
{
    float g = 0.5 * dot(uvw, uvw) / (uvw.z * lambda_um);
    return dif_schlick(0.5 * length(uvw), index) * g * g * area_um2 / (cosines.x * cosines.y);
}

// ---- the wavelength-integrated table: core/lut.h ----

// The shape of a table: x: columns, y: rows, z: s0, w: row step.  Maps and factor of the texels in `more`:
// x: number of maps, y: factor that undoes the scale of stored numbers.
//
// Texture coordinates of (u, v): azimuth along s, which repeats, and radius along t.
vec2 dif_lut_place(vec4 shape, vec2 uv)
{
    float row = min(dif_asinh(length(uv) / shape.z) / shape.w, shape.y - 1.0);
    return vec2(dif_atan_turns(uv.y, uv.x) + 0.5 / shape.x, (row + 0.5) / shape.y);
}

// Chebyshev's variable of (u, v, w).
float dif_lut_depth(vec3 uvw)
{
    float range = sqrt(max(4.0 - dot(uvw.xy, uvw.xy), 1e-12));
    return clamp(2.0 * abs(uvw.z) / range - 1.0, -1.0, 1.0);
}

// XYZ of (u, v, w): three numbers a map, four to a texel, so that K maps are ceil(3 K / 4) reads. The sum of Clenshaw runs
// from the last map down; number 3 n + c of a texel's stack is colour c of map n.
vec3 dif_lut_colour(sampler2DArray maps, vec4 shape, vec2 more, vec3 uvw)
{
    vec2 at = dif_lut_place(shape, uvw.xy);
    float t = dif_lut_depth(uvw);
    vec3 next = vec3(0.0), after = vec3(0.0);
    int layer = -1;
    vec4 high = vec4(0.0), low = vec4(0.0); // texels `layer + 1` and `layer`
    for (int n = int(more.x) - 1; n >= 0; n--) {
        int want = (3 * n) >> 2, last = (3 * n + 2) >> 2;
        if (layer != want) {
            high = last == layer ? low : last == want ? high : textureLod(maps, vec3(at, float(last)), 0.0);
            low = textureLod(maps, vec3(at, float(want)), 0.0);
            layer = want;
        }
        int part = (3 * n) & 3;
        vec3 q = part == 0 ? low.xyz : part == 1 ? low.yzw : part == 2 ? vec3(low.zw, high.x) : vec3(low.w, high.xy);
#if DIF_FAULT == DIF_FAULT_IS_PLANE
        q = n == 1 ? vec3(0.0) : q;
#elif DIF_FAULT == DIF_FAULT_IS_SIGN
        q = n == 1 ? -q : q;
#elif DIF_FAULT == DIF_FAULT_IS_TAP
        q = n == 0 ? 0.5 * q : q;
#endif
        vec3 here = q + (n == 0 ? t : 2.0 * t) * next - after;
        after = next;
        next = here;
    }
    return next * more.y;
}
