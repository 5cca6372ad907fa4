// A mesh that wears a surface: XYZ(rho) of the integrated table in the tangent frame, shadowing, a diffuse base.
// The same steps as core/shade.c.

uniform sampler2DArray maps;
uniform sampler2D masking; // core/shadow.h's table
uniform sampler2D albedo;
uniform sampler2D relief;  // core/meso.h: means and variances
uniform sampler2D product; // covariance
uniform sampler2DArray pyramid; // core/lut_filter.h

in vec3 at_position;
in vec3 at_normal;
in vec3 at_tangent;
in vec2 at_uv;

layout(location = 0) out vec4 light_out; // diffracted light and coverage
layout(location = 1) out vec4 base_out; // and how much of the facet is seen

// G(k) of one direction, filtered.
float dif_masking(vec3 k)
{
    vec2 place = dif_shadow_place(r.root.xyz, k);
    float rows = float(r.size.x), columns = float(r.job.w);
    return texture(masking, vec2(place.x + 0.5 / columns, (place.y * (rows - 1.0) + 0.5) / rows)).r;
}

float dif_shadowing(vec3 wi, vec3 wo)
{
    if (r.job.y == DIF_SHADOWING_IS_NONE)
        return 1.0;
    if (r.job.y == DIF_SHADOWING_IS_VCAVITY)
        return dif_shadow_vcavity(wi + wo, vec2(wi.z, wo.z));
    return dif_masking(wi) * dif_masking(wo);
}

// The light of the mirror's spot at w.
vec3 dif_spot(float w)
{
    float t = clamp(abs(w) - 1.0, -1.0, 1.0);
    vec3 next = vec3(0.0), after = vec3(0.0);
    for (int n = int(r.more.x) - 1; n >= 0; n--) {
        vec3 here = r.spot[n].xyz + (n == 0 ? t : 2.0 * t) * next - after;
        after = next;
        next = here;
    }
    return next;
}

// Slopes along tangent and bitangent become those along the turned ones.
vec2 dif_turned(vec2 s)
{
    return vec2(r.look.x * s.x + r.look.y * s.y, -r.look.y * s.x + r.look.x * s.y);
}

// The slopes in the footprint, in the turned frame (t, b): the relief's, and what the mesh's curvature adds.
dif_gauss dif_slopes(vec3 t, vec3 b, vec2 uv_dx, vec2 uv_dy, vec3 n_dx, vec3 n_dy)
{
    dif_gauss g = dif_gauss(vec2(0.0), vec3(0.0));
    if (r.size.z == 1) {
        g = dif_relief_moments(relief, product, r.relief.xy, r.relief.z, r.relief.w, at_uv, uv_dx, uv_dy);
        float c = r.look.x, s = r.look.y;
        g = dif_gauss(dif_turned(g.mean), vec3(max(c * c * g.cov.x + 2.0 * c * s * g.cov.z + s * s * g.cov.y, 0.0),
                                               max(s * s * g.cov.x - 2.0 * c * s * g.cov.z + c * c * g.cov.y, 0.0),
                                               c * s * (g.cov.y - g.cov.x) + (c * c - s * s) * g.cov.z));
    }
    vec2 x = vec2(dot(n_dx, t), dot(n_dx, b)), y = vec2(dot(n_dy, t), dot(n_dy, b));
    g.cov += (vec3(x.x * x.x, x.y * x.y, x.x * x.y) + vec3(y.x * y.x, y.y * y.y, y.x * y.y)) / 12.0;
    return g;
}

void main()
{
    vec3 n = normalize(at_normal);
    vec2 uv_dx = dFdx(at_uv) * r.extra.y, uv_dy = dFdy(at_uv) * r.extra.y;
    vec3 n_dx = dFdx(at_normal) * r.extra.y / length(at_normal), n_dy = dFdy(at_normal) * r.extra.y / length(at_normal);
    n_dx -= dot(n_dx, n) * n;
    n_dy -= dot(n_dy, n) * n;
    vec3 along = normalize(at_tangent - dot(at_tangent, n) * n);
    vec3 t = r.look.x * along + r.look.y * cross(n, along); // Rodrigues, for a vector across the axis
    vec3 b = cross(n, t);
    vec3 to_eye = normalize(r.eye.xyz - at_position);
    vec3 wo = vec3(dot(to_eye, t), dot(to_eye, b), dot(to_eye, n));

    float seen = 1.0;
    vec2 slope = vec2(0.0);
    vec3 blur = vec3(0.0);
    if (r.size.y == DIF_FILTER_IS_SLOPES) {
        dif_gauss g = dif_slopes(t, b, uv_dx, uv_dy, n_dx, n_dy);
        if (wo.z > 0.0)
            g = dif_slope_visible(g, wo).gauss;
        slope = g.mean;
        blur = g.cov;
    } else if (r.size.y == DIF_FILTER_IS_MIP) {
        slope = dif_slopes(t, b, uv_dx, uv_dy, n_dx, n_dy).mean;
    } else if (r.size.z == 1) {
        vec2 at = r.relief.w * at_uv;
        slope = dif_turned(textureLod(relief, vec2(at.x, 1.0 - at.y), 0.0).xy);
        seen = wo.z > 0.0 ? max(1.0 - dot(slope, wo.xy) / wo.z, 0.0) : 0.0;
    }
    vec3 up = normalize(n - slope.x * t - slope.y * b);
    t = normalize(t + slope.x * n);
    n = up;
    b = cross(n, t);
    wo = vec3(dot(to_eye, t), dot(to_eye, b), dot(to_eye, n));

    vec3 albedo_here = r.job.z == 1 ? texture(albedo, vec2(at_uv.x, 1.0 - at_uv.y)).rgb : r.base.rgb;
    vec3 xyz = vec3(0.0), diffuse = vec3(0.0);
    for (int i = 0; i < r.job.x; i++) {
        vec3 wi = vec3(dot(r.light[i].xyz, t), dot(r.light[i].xyz, b), dot(r.light[i].xyz, n));
        diffuse += max(wi.z, 0.0) * albedo_here;
        if (wi.z > r.look.z && wo.z > r.look.z) {
            vec3 uvw = -(wi + wo);
            vec3 colour = r.size.y == DIF_FILTER_IS_SLOPES
                              ? dif_lut_blurred(maps, r.shape, r.more.xy, pyramid, r.blur, r.extra.x, dif_spot(uvw.z), uvw,
                                                uvw.z * uvw.z * blur)
                              : dif_lut_colour(maps, r.shape, r.more.xy, uvw);
            xyz += dif_gain_rho(uvw, vec2(wi.z, wo.z), r.more.zw) * dif_shadowing(wi, wo) * colour;
        }
    }
    light_out = vec4(seen * dif_rgb_from_xyz(xyz), 1.0);
    base_out = vec4(seen * diffuse, seen);
}
