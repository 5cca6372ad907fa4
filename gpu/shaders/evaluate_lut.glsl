// Colours of listed directions from the wavelength-integrated table.  Set before: DIF_QUANTITY, DIF_SHADOWING.

uniform sampler2D directions; // entries of DIF_DIR_STRIDE pairs
uniform sampler2DArray maps;
uniform sampler2D masking; // core/shadow.h's table

layout(std140) uniform dif_block {
    vec4 shape; // columns, rows, s0, row step
    vec4 more;  // maps, factor of the stored numbers; n, kappa of the material
    ivec4 job;  // items
    vec4 root;  // of the slopes' covariance: dif_shadow_place
} p;

vec4 dif_answer(ivec2 at, int width)
{
    int i = at.y * width + at.x, d = i * DIF_DIR_STRIDE;
    if (i >= p.job.x)
        return vec4(0.0);
    vec2 u = dif_list(directions, d), v = dif_list(directions, d + 1), w = dif_list(directions, d + 2);
    vec3 uvw = vec3(u.x + u.y, v.x + v.y, w.x + w.y);
    vec3 xyz = dif_lut_colour(maps, p.shape, p.more.xy, uvw);
#if DIF_QUANTITY == DIF_QUANTITY_IS_RHO
    vec2 cosines = dif_list(directions, d + DIF_DIR_COSINES);
    xyz *= dif_gain_rho(uvw, cosines, p.more.zw);
#if DIF_SHADOWING != DIF_SHADOWING_IS_NONE
    xyz *= dif_shadow_factor(masking, p.root.xyz, uvw, vec3(dif_list(directions, d + DIF_DIR_WI), cosines.x),
                             vec3(dif_list(directions, d + DIF_DIR_WO), cosines.y));
#endif
#endif
    return vec4(xyz, 0.0);
}
