// Like mesh.frag.glsl, without the objects that earlier layers have at the pixel: so each layer has the nearest surface of
// the objects that are left.
in vec3 side;
in float depth;
flat in uint number;

layout(binding = 0) uniform usampler2DArray taken_object;
uniform int taken; // layers

layout(location = 0) out vec4 surface;
layout(location = 1) out uint object;

void main()
{
    for (int n = 0; n < taken; n++) {
        if (texelFetch(taken_object, ivec3(gl_FragCoord.xy, n), 0).x == number) {
            discard;
        }
    }
    vec3 outward = side / max(length(side), 1e-6);
    surface = vec4(gl_FrontFacing ? outward : -outward, depth);
    object = number;
}
