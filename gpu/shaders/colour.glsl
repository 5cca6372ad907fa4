// Colours for a screen: as core/colour.c.

// Linear sRGB from XYZ, D65, Y = 1 for white.          IEC 61966-2-1
vec3 dif_rgb_from_xyz(vec3 xyz)
{
    return vec3(dot(vec3(3.2404541621, -1.5371385128, -0.4985314096), xyz),
                dot(vec3(-0.9692660305, 1.8760108454, 0.0415560175), xyz),
                dot(vec3(0.0556434310, -0.2040259135, 1.0572251882), xyz));
}

// The sRGB transfer curve of values in [0, 1].
vec3 dif_srgb_encode(vec3 linear)
{
    vec3 power = 1.055 * pow(max(linear, vec3(1e-9)), vec3(1.0 / 2.4)) - 0.055;
    return mix(power, 12.92 * linear, vec3(lessThanEqual(linear, vec3(0.0031308))));
}

// Towards the grey of equal luminance until no channel is negative, then clipped: DIF_GAMUT_DESATURATE.
vec3 dif_fit_gamut(vec3 rgb)
{
    float grey = max(dot(vec3(0.2126728514, 0.7151521553, 0.0721749934), rgb), 0.0);
    float least = min(min(rgb.r, rgb.g), rgb.b);
    if (least < 0.0)
        rgb = vec3(grey) + (rgb - vec3(grey)) * (grey / max(grey - least, 1e-30));
    return clamp(rgb, 0.0, 1.0);
}
