// Shadowing and masking of a direction pair: core/shadow.h.  Macro set before dif_shadow_factor: DIF_SHADOWING.

// V-cavities, from the cosines (wi.z, wo.z) and 1 + wi.wo = |uvw|^2 / 2.
float dif_shadow_vcavity(vec3 uvw, vec2 cosines)
{
    float facets = 2.0 * (cosines.x + cosines.y) * min(cosines.x, cosines.y), below = 0.5 * dot(uvw, uvw);
    return facets >= below ? 1.0 : facets / below; // 0 / 0 where both graze in opposite directions
}

// Where the table holds G(k): x: azimuth in turns, [0, 1]; y: t in [0, 1].  root: (a, b, c) of the Cholesky factor
// (a 0; b c) of the slopes' covariance, so that the variance along k is a sum of squares and keeps its digits.
vec2 dif_shadow_place(vec3 root, vec3 k)
{
    float up = max(k.z, 0.0), spread = length(vec2(root.x * k.x + root.y * k.y, root.z * k.y));
    float turns = dif_atan_turns(k.y, k.x);
    return vec2(turns - floor(turns), up + spread > 0.0 ? up / (up + spread) : 1.0);
}

// Linear between two rows of a column.
float dif_shadow_column(sampler2D table, int column, int row, float part)
{
    float low = texelFetch(table, ivec2(column, row), 0).r, high = texelFetch(table, ivec2(column, row + 1), 0).r;
    return low + part * (high - low);
}

// Masking G(k) of one direction: a table of one column or of many around the azimuth, exact to float.
float dif_shadow_masking(sampler2D table, vec3 root, vec3 k)
{
    ivec2 size = textureSize(table, 0);
    vec2 place = dif_shadow_place(root, k);
    float t = place.y * float(size.y - 1), column = place.x * float(size.x);
    int row = min(int(t), size.y - 2), j = int(column);
    float part = t - float(row), low = dif_shadow_column(table, j % size.x, row, part);
    if (size.x == 1)
        return low;
    return mix(low, dif_shadow_column(table, (j + 1) % size.x, row, part), column - float(j));
}

#ifdef DIF_SHADOWING
// S(wi, wo); uvw = -(wi + wo).
float dif_shadow_factor(sampler2D table, vec3 root, vec3 uvw, vec3 wi, vec3 wo)
{
#if DIF_SHADOWING == DIF_SHADOWING_IS_NONE
    return 1.0;
#elif DIF_SHADOWING == DIF_SHADOWING_IS_VCAVITY
    return dif_shadow_vcavity(uvw, vec2(wi.z, wo.z));
#else
    return dif_shadow_masking(table, root, wi) * dif_shadow_masking(table, root, wo);
#endif
}
#endif
