// A mesh's vertex: its place in the picture, and what fragments need in the mesh's own frame.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 tangent;
layout(location = 3) in vec2 uv;

out vec3 at_position;
out vec3 at_normal;
out vec3 at_tangent;
out vec2 at_uv;

void main()
{
    vec4 p = vec4(position, 1.0);
    float depth = dot(r.row_w, p);
    at_position = position;
    at_normal = normal;
    at_tangent = tangent;
    at_uv = uv;
    gl_Position = vec4(dot(r.row_x, p) + r.shift.x * depth, dot(r.row_y, p) + r.shift.y * depth,
                       depth * r.shift.z + r.shift.w, depth);
}
