// Slopes within a pixel: moments of the mesostructure, and the table blurred by those that are seen (slope.glsl).
// As core/meso.c, core/lut_filter.c and core/shade_slopes.c.

// Axes of the ellipse that (a b) maps the unit circle to: xy = unit major axis, z = major, w = minor half axis.
vec4 dif_ellipse(vec2 a, vec2 b)
{
    float p = dot(vec2(a.x, b.x), vec2(a.x, b.x)), q = dot(vec2(a.y, b.y), vec2(a.y, b.y));
    float m = a.x * a.y + b.x * b.y, mean = 0.5 * (p + q), spread = length(vec2(0.5 * (p - q), m));
    float major = sqrt(max(mean + spread, 0.0)), minor = major > 0.0 ? abs(a.x * b.y - a.y * b.x) / major : 0.0;
    float angle = 0.5 * atan(m, 0.5 * (p - q) == 0.0 && m == 0.0 ? 1.0 : 0.5 * (p - q));
    return vec4(cos(angle), sin(angle), major, minor);
}

// Moments over a footprint: relief.xyzw = means and variances along x and y in a block, product.r = covariance.  size:
// texels of level 0.
dif_gauss dif_relief_moments(sampler2D relief, sampler2D product, vec2 size, float n_level, float tiles, vec2 uv, vec2 dx, vec2 dy)
{
    vec4 e = dif_ellipse(dx * tiles * size, dy * tiles * size);
    float minor = max(max(e.w, e.z / float(DIF_RELIEF_PROBES)), 1e-12);
    int n = int(clamp(ceil(e.z / minor - 1e-4), 1.0, float(DIF_RELIEF_PROBES)));
    float level = clamp(log2(minor), 0.0, n_level - 1.0), low = min(floor(level), n_level - 2.0);
    float mean_level = clamp(log2(minor / sqrt(3.0)), 0.0, n_level - 1.0); // a linear read of blocks is wider
    level = low + (exp2(2.0 * (level - low)) - 1.0) / 3.0;
    float reach = n > 1 ? sqrt(max(e.z * e.z - minor * minor, 0.0) / (1.0 - 1.0 / float(n * n))) : 0.0;
    vec4 mean = vec4(0.0);
    vec3 square = vec3(0.0);
    vec2 first = vec2(0.0);
    float cross_mean = 0.0;
    for (int k = 0; k < n; k++) {
        vec2 at = tiles * uv + reach * ((float(k) + 0.5) / float(n) - 0.5) * e.xy / size;
        at.y = 1.0 - at.y;
        vec4 here = vec4(textureLod(relief, at, mean_level).xy, textureLod(relief, at, level).zw);
        first = k == 0 ? here.xy : first;
        here.xy -= first;
        mean += here / float(n);
        square += vec3(here.xy * here.xy, here.x * here.y) / float(n);
        cross_mean += textureLod(product, at, level).r / float(n);
    }
    float within = min(minor * minor, 1.0);
    vec2 v = within * mean.zw + max(square.xy - mean.xy * mean.xy, vec2(0.0));
    float most = sqrt(v.x * v.y);
    return dif_gauss(first + mean.xy, vec3(v, clamp(within * cross_mean + square.z - mean.x * mean.y, -most, most)));
}

// Clenshaw's sum over one place of a table or of a level of the pyramid; the texels as in dif_lut_colour.
vec3 dif_maps_sum(sampler2DArray maps, vec2 at, float level, float n_map, float t)
{
    vec3 next = vec3(0.0), after = vec3(0.0);
    int layer = -1;
    vec4 high = vec4(0.0), low = vec4(0.0);
    for (int n = int(n_map) - 1; n >= 0; n--) {
        int want = (3 * n) >> 2, last = (3 * n + 2) >> 2;
        if (layer != want) {
            high = last == layer ? low : last == want ? high : textureLod(maps, vec3(at, float(last)), level);
            low = textureLod(maps, vec3(at, float(want)), level);
            layer = want;
        }
        int part = (3 * n) & 3;
        vec3 q = part == 0 ? low.xyz : part == 1 ? low.yzw : part == 2 ? vec3(low.zw, high.x) : vec3(low.w, high.xy);
        vec3 here = q + (n == 0 ? t : 2.0 * t) * next - after;
        after = next;
        next = here;
    }
    return next;
}

// Mean colour over a Gaussian of covariance `cov` around uvw at fixed w.  place: side and levels of the pyramid, radius and
// variance of the spot; factor: that undoes the scale of its stored numbers; spot: XYZ of the spot's light at this w.
vec3 dif_lut_blurred(sampler2DArray maps, vec4 shape, vec2 more, sampler2DArray pyramid, vec4 place, float factor, vec3 spot,
                     vec3 uvw, vec3 cov)
{
    float mean = 0.5 * (cov.x + cov.y), half_gap = 0.5 * (cov.x - cov.y), spread = length(vec2(half_gap, cov.z));
    float major = sqrt(max(mean + spread, 0.0)), thin = sqrt(max(mean - spread, 0.0));
    float angle = spread > 0.0 ? 0.5 * atan(cov.z, half_gap) : 0.0;
    float minor = max(max(thin, 2.5 * major / float(DIF_BLUR_PROBES)), 1e-12);
    float along = sqrt(max(major * major - minor * minor, 0.0));
    int n = int(clamp(ceil(2.5 * along / minor - 1e-4), 1.0, float(DIF_BLUR_PROBES)));
    float level = log2(2.0 * minor * place.x / 4.0), share = clamp(level + 1.0, 0.0, 1.0);
    float sum = 0.0, variance = 0.0;
    for (int i = 0; i < n; i++) {
        float at = 5.0 * ((float(i) + 0.5) / float(n) - 0.5), weight = dif_exp_minus(0.5 * at * at);
        sum += weight;
        variance += weight * at * at;
    }
    vec2 stride = n > 1 ? along / sqrt(variance / sum) * vec2(cos(angle), sin(angle)) : vec2(0.0);
    vec3 colour = vec3(0.0);
    for (int i = 0; i < n; i++) {
        float at = 5.0 * ((float(i) + 0.5) / float(n) - 0.5), weight = dif_exp_minus(0.5 * at * at) / sum;
        vec3 probe = vec3(uvw.xy + at * stride, uvw.z);
        if (share < 1.0)
            colour += weight * (1.0 - share) * dif_lut_colour(maps, shape, more, probe);
        if (share > 0.0)
            colour += weight * share * factor *
                      dif_maps_sum(pyramid, (probe.xy + 2.0) / 4.0, clamp(level, 0.0, place.y - 1.0), more.x, dif_lut_depth(probe));
    }
    float uu = cov.x + place.w, vv = cov.y + place.w, det = uu * vv - cov.z * cov.z;
    if (place.z > 0.0 && det > 0.0) {
        float q = (vv * uvw.x * uvw.x - 2.0 * cov.z * uvw.x * uvw.y + uu * uvw.y * uvw.y) / det;
        colour += share * dif_exp_minus(0.5 * q) / (DIF_TWO_PI * sqrt(det)) * spot;
    }
    return colour;
}
