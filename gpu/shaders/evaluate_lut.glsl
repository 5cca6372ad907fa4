// Colours of listed directions from the wavelength-integrated table.  Set before: DIF_QUANTITY.

uniform sampler2D directions; // entries of DIF_DIR_STRIDE pairs
uniform sampler2DArray maps;

layout(std140) uniform dif_block {
    vec4 shape; // columns, rows, s0, row step
    vec4 more;  // maps, factor of the stored numbers; n, kappa of the material
    ivec4 job;  // items
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
    xyz *= dif_gain_rho(uvw, dif_list(directions, d + DIF_DIR_COSINES), p.more.zw);
#endif
    return vec4(xyz, 0.0);
}
