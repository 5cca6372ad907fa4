// What an evaluator answers: sheet, nmm, pq and stam at listed directions.  Set before: DIF_KIND, DIF_JOB, DIF_QUANTITY,
// DIF_SHADOWING.

uniform sampler2D directions; // entries of DIF_DIR_STRIDE pairs
uniform sampler2D waves;      // entries of DIF_WAVE_STRIDE pairs
uniform sampler2D asked;      // nmm: entries of DIF_ASK_STRIDE pairs
uniform sampler2D spectrum;   // nmm: (x, y), (z, D65) from 380 to 780 nm in 1 nm
uniform sampler2D before;     // the sum over the sheets before this one
uniform sampler2D masking;    // core/shadow.h's table
#ifdef DIF_WIDTH_Y
uniform sampler2DArray planes;
#else
uniform sampler2D planes;
#endif

layout(std140) uniform dif_block {
    ivec4 axis_s, axis_y, axis_z; // first stored bin, stored bins, period
    ivec4 job;                    // items; waves; whether `before` counts; 0
    ivec4 few;                    // nmm: fixed waves; bin of the first wave after them; whether the Jacobian counts; 0
    ivec4 copies;                 // pq: nx, ny; stam: 1 if there are orders across, 0, 0
    vec4 gain;                    // share of this sheet; n; kappa; area_um2
    vec4 more;                    // nmm: range_um, weight over lambda^2 times s; stam: (2 pi sigma)^2 over d^2 and d'^2
    vec4 scale;                   // nmm: of X, Y, Z
    vec4 root;                    // of the slopes' covariance: dif_shadow_place
} p;

// p of the direction whose coordinates begin at pair d, u and v at pair t, and the wave that begins at pair q.
float power_of(int d, int t, int q)
{
#if DIF_KIND == DIF_KIND_IS_STAM
    float along = dif_order_distance(dif_list(directions, d), dif_list(waves, q + DIF_WAVE_TURNS));
    float whole, across = dif_rest(dif_list(directions, d + 1), dif_list(waves, q + DIF_WAVE_TURNS + 1), whole);
    across = p.copies.x == 1 ? across - floor(across + 0.5) : across + whole;
#if DIF_FAULT == DIF_FAULT_IS_PLANE
    across = 0.0;
    along *= 2.0;
#elif DIF_FAULT == DIF_FAULT_IS_SIGN
    along = 0.5 - along;
#endif
    return dif_exp_minus(p.more.x * along * along + p.more.y * across * across);
#else
    dif_place z = dif_place_on(dif_list(directions, d + 2), dif_list(waves, q + 2), p.axis_z, DIF_WIDTH_Z);
    dif_place s = dif_place_on(dif_list(directions, d), dif_list(waves, q), p.axis_s, DIF_WIDTH_S);
#ifdef DIF_WIDTH_Y
    dif_place y = dif_place_on(dif_list(directions, d + 1), dif_list(waves, q + 1), p.axis_y, DIF_WIDTH_Y);
    vec2 amplitude = dif_volume_sum(planes, s, y, z, p.axis_z.y);
#else
    vec2 amplitude = dif_line_sum(planes, s, z, p.axis_z.y);
#endif
    float power = dot(amplitude, amplitude);
#if DIF_KIND == DIF_KIND_IS_PQ
    power *= dif_replica_power(p.copies.x, dif_list(directions, t), dif_list(waves, q + DIF_WAVE_TURNS)) *
             dif_replica_power(p.copies.y, dif_list(directions, t + 1), dif_list(waves, q + DIF_WAVE_TURNS + 1));
#endif
    return power;
#endif
}

// Coordinates of the direction at pair d, times a scale.
vec3 coordinates(int d, float scale)
{
    vec2 s = dif_list(directions, d), y = dif_list(directions, d + 1), z = dif_list(directions, d + 2);
    return scale * vec3(s.x + s.y, y.x + y.y, z.x + z.y);
}

float gain_of(vec3 uvw, int d, float lambda_um)
{
#if DIF_QUANTITY == DIF_QUANTITY_IS_POWER
    return 1.0;
#else
    vec2 cosines = dif_list(directions, d + DIF_DIR_COSINES);
#if DIF_QUANTITY == DIF_QUANTITY_IS_RHO
    float gain = dif_gain_rho(uvw, cosines, p.gain.yz);
#else
    float gain = dif_gain_per_sr(uvw, cosines, p.gain.yz, lambda_um, p.gain.w);
#endif
#if DIF_SHADOWING != DIF_SHADOWING_IS_NONE
    gain *= dif_shadow_factor(masking, p.root.xyz, uvw, vec3(dif_list(directions, d + DIF_DIR_WI), cosines.x),
                              vec3(dif_list(directions, d + DIF_DIR_WO), cosines.y));
#endif
    return gain;
#endif
}

#if DIF_JOB == DIF_JOB_IS_VALUES

// Query i: its coordinates are rad/um already, wave 0 turns them into bins. nmm may read another wavelength than the
// one that the gain is of.
float value_of(int i)
{
    int d = i * DIF_DIR_STRIDE;
    float read_um = dif_list(directions, d + DIF_DIR_BINS).x, lambda_um = dif_list(directions, d + DIF_DIR_REACH).x;
    return power_of(d, d + DIF_DIR_MORE, 0) * gain_of(coordinates(d, read_um / DIF_TWO_PI), d, lambda_um);
}

vec4 answer(ivec2 at, int width)
{
    int first = 4 * (at.y * width + at.x);
    vec4 result = vec4(0.0);
    for (int i = 0; i < 4; i++)
        if (first + i < p.job.x)
            result[i] = value_of(first + i);
    return result;
}

#elif DIF_JOB == DIF_JOB_IS_TABLE

// Angle i at wavelength j.
float cell_of(int i, int j)
{
    int d = i * DIF_DIR_STRIDE;
#if DIF_KIND == DIF_KIND_IS_NMM
    vec2 bins = dif_list(directions, d + DIF_DIR_BINS), stands = dif_list(asked, j * DIF_ASK_STRIDE + 1);
    float lambda_um = stands.y, whole;
    int from = d, wave = int(stands.x);
    if (bins.y > 0.0) {
        float rest = dif_rest(dif_list(directions, d + DIF_DIR_REACH), dif_list(asked, j * DIF_ASK_STRIDE), whole);
        float bin = clamp(whole + floor(rest + 0.5), bins.x, bins.x + bins.y - 1.0);
        from = d + DIF_DIR_MORE;
        wave = p.few.x + int(bin) - p.few.y;
    }
    float power = power_of(from, d, wave * DIF_WAVE_STRIDE);
#else
    float lambda_um = dif_list(waves, j * DIF_WAVE_STRIDE + DIF_WAVE_Z).y;
    float power = power_of(d, d + DIF_DIR_MORE, j * DIF_WAVE_STRIDE);
#endif
    return power * gain_of(coordinates(d, 1.0), d, lambda_um);
}

vec4 answer(ivec2 at, int width)
{
    vec4 result = vec4(0.0);
    for (int i = 0; i < 4; i++)
        if (4 * at.x + i < p.job.x)
            result[i] = cell_of(4 * at.x + i, at.y);
    return result;
}

#else

// (x, y, z) bar times D65 at a wavelength.
vec3 observer_of(float lambda_um)
{
    float at = (lambda_um - 0.38) * 1000.0, i = clamp(floor(at), 0.0, 399.0), share = clamp(at - i, 0.0, 1.0);
    if (at < -0.001 || at > 400.001)
        return vec3(0.0);
    vec4 low = vec4(dif_list(spectrum, 2 * int(i)), dif_list(spectrum, 2 * int(i) + 1));
    vec4 high = vec4(dif_list(spectrum, 2 * int(i) + 2), dif_list(spectrum, 2 * int(i) + 3));
    vec4 here = mix(low, high, share);
    return here.xyz * here.w;
}

vec3 weights_of(int q)
{
    return vec3(dif_list(waves, q + DIF_WAVE_XY), dif_list(waves, q + DIF_WAVE_Z).x);
}

vec3 colour_of(int d)
{
    vec3 xyz = vec3(0.0);
    int n = p.job.y;
#if DIF_KIND == DIF_KIND_IS_NMM
    vec2 bins = dif_list(directions, d + DIF_DIR_BINS), reach = dif_list(directions, d + DIF_DIR_REACH);
    float reach_um = reach.x + reach.y;
    for (int i = 0; i < int(bins.y); i++) {
        int bin = int(bins.x) + i;
        float lambda_um = reach_um / float(bin);
        float step_um = p.few.z == 1 ? lambda_um * lambda_um * p.more.y / reach_um : p.more.x / bins.y;
        xyz += step_um * p.scale.xyz * observer_of(lambda_um) *
               power_of(d + DIF_DIR_MORE, d, (p.few.x + bin - p.few.y) * DIF_WAVE_STRIDE);
    }
    n = bins.y > 0.0 ? 0 : p.few.x;
#endif
    for (int i = 0; i < n; i++)
        xyz += weights_of(i * DIF_WAVE_STRIDE) * power_of(d, d + DIF_DIR_MORE, i * DIF_WAVE_STRIDE);
    return xyz * gain_of(coordinates(d, 1.0), d, 1.0);
}

vec4 answer(ivec2 at, int width)
{
    int i = at.y * width + at.x;
    return i < p.job.x ? vec4(colour_of(i * DIF_DIR_STRIDE), 0.0) : vec4(0.0);
}

#endif

vec4 dif_answer(ivec2 at, int width)
{
    vec4 sum = p.gain.x * answer(at, width);
    return p.job.z == 1 ? sum + texelFetch(before, at, 0) : sum;
}
