// Meshes for the colour pass: normal and depth, and the object.
in vec3 side;
in float depth;
flat in uint number;

layout(location = 0) out vec4 surface;
layout(location = 1) out uint object;

void main()
{
    vec3 outward = side / max(length(side), 1e-6);
    surface = vec4(gl_FrontFacing ? outward : -outward, depth);
    object = number;
}
