// Parameters of a picture: gpu/gpu_render.c's render_block.
layout(std140) uniform dif_render {
    vec4 row_x, row_y, row_w; // clip coordinates of a position
    vec4 shift;               // of the sample in the pixel, as clip x, y; depth = w * z + w
    vec4 eye;                 // xyz
    vec4 light[DIF_RENDER_LIGHTS];
    vec4 shape; // of the table: dif_lut_colour
    vec4 more;  // maps, factor of the stored numbers; n, kappa of the material
    vec4 look;  // cosine and sine of the groove's turn, smallest cosine
    vec4 base;  // rgb of a diffuse base
    vec4 root;  // shadowing: of the slopes' covariance, dif_shadow_place
    ivec4 job;  // lights, shadowing, base is a texture, columns of the shadowing table
    ivec4 size; // rows of the shadowing table; filter, mesostructure is there
    vec4 relief; // of the mesostructure: texels along x and y, levels, tiles
    vec4 blur;   // of the pyramid: side, levels; radius and variance of the spot
    vec4 extra;  // factor of the pyramid's numbers; 1 / samples along a side of a pixel
    vec4 spot[DIF_RENDER_MAPS];
} r;
