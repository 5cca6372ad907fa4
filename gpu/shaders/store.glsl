// The end of each evaluating shader: fetch coordinates, call dif_answer, store.
#ifdef DIF_COMPUTE
layout(local_size_x = DIF_GROUP, local_size_y = DIF_GROUP) in;
layout(rgba32f, binding = 0) uniform writeonly highp image2D result;
uniform ivec2 size;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (at.x < size.x && at.y < size.y)
        imageStore(result, at, dif_answer(at, size.x));
}
#else
uniform ivec2 size;
layout(location = 0) out vec4 result;

void main()
{
    result = dif_answer(ivec2(gl_FragCoord.xy), size.x);
}
#endif
