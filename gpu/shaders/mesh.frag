// A mesh that wears a surface: XYZ(rho) of the integrated table in the tangent frame, shadowing, a diffuse base.
// The same steps as core/shade.c.

uniform sampler2DArray maps;
uniform sampler2D masking; // core/shadow.h's table
uniform sampler2D albedo;

in vec3 at_position;
in vec3 at_normal;
in vec3 at_tangent;
in vec2 at_uv;

layout(location = 0) out vec4 light_out; // diffracted light and coverage
layout(location = 1) out vec4 base_out;

// G(k) of one direction.
float dif_masking(vec3 k)
{
    float across = r.slopes.x * k.x * k.x + 2.0 * r.slopes.z * k.x * k.y + r.slopes.y * k.y * k.y;
    float t = k.z / (k.z + sqrt(max(across, 0.0)));
    float rows = float(r.size.x), columns = float(r.job.w);
    return texture(masking, vec2(dif_atan_turns(k.y, k.x) + 0.5 / columns, (t * (rows - 1.0) + 0.5) / rows)).r;
}

float dif_shadowing(vec3 wi, vec3 wo)
{
    if (r.job.y == DIF_SHADOWING_IS_NONE)
        return 1.0;
    if (r.job.y == DIF_SHADOWING_IS_VCAVITY) {
        vec3 h = normalize(wi + wo);
        return min(1.0, 2.0 * h.z * min(wi.z, wo.z) / max(dot(wo, h), 1e-12));
    }
    return dif_masking(wi) * dif_masking(wo);
}

void main()
{
    vec3 n = normalize(at_normal);
    vec3 along = normalize(at_tangent - dot(at_tangent, n) * n);
    vec3 t = r.look.x * along + r.look.y * cross(n, along); // Rodrigues, for a vector across the axis
    vec3 b = cross(n, t);
    vec3 to_eye = normalize(r.eye.xyz - at_position);
    vec3 wo = vec3(dot(to_eye, t), dot(to_eye, b), dot(to_eye, n));
    vec3 albedo_here = r.job.z == 1 ? texture(albedo, vec2(at_uv.x, 1.0 - at_uv.y)).rgb : r.base.rgb;
    vec3 xyz = vec3(0.0), diffuse = vec3(0.0);
    for (int i = 0; i < r.job.x; i++) {
        vec3 wi = vec3(dot(r.light[i].xyz, t), dot(r.light[i].xyz, b), dot(r.light[i].xyz, n));
        diffuse += max(wi.z, 0.0) * albedo_here;
        if (wi.z > r.look.z && wo.z > r.look.z) {
            vec3 uvw = -(wi + wo);
            xyz += dif_gain_rho(uvw, vec2(wi.z, wo.z), r.more.zw) * dif_shadowing(wi, wo) *
                   dif_lut_colour(maps, r.shape, r.more.xy, uvw);
        }
    }
    light_out = vec4(dif_rgb_from_xyz(xyz), 1.0);
    base_out = vec4(diffuse, 1.0);
}
