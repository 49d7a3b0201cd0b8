// Meshes for the colour pass: normal and depth, and the object, or the colour that a map gives its vertices. With PEEL without
// the objects that earlier layers have at the pixel: so each layer has the nearest surface of the objects that are left.
in vec3 side;
in float depth;
in vec2 value; // of the map, as mesh_layer.c has it
flat in uint number;

uniform uint mapped;      // the surface that has a map; 0 = none
uniform vec3 ramp[STEPS + 1]; // sRGB

#if PEEL
layout(binding = 0) uniform usampler2DArray taken_object;
uniform int taken; // layers
#endif

layout(location = 0) out vec4 surface;
layout(location = 1) out uint object;

const uint TUBE_OWN_COLOUR = 0x80000000u; // as in id_pass.h

// Where most of the corners have no value, the surface has its own colour.
uint painted()
{
    float at = clamp(value.x / max(value.y, 1e-6), 0.0, 1.0) * float(STEPS);
    int step_ = min(int(at), STEPS - 1);
    vec3 colour = mix(ramp[step_], ramp[step_ + 1], at - float(step_));
    bool has_value = number == mapped && value.y >= 0.5;
    return has_value ? TUBE_OWN_COLOUR | packUnorm4x8(vec4(colour, 0.0)) : number;
}

void main()
{
#if PEEL
    for (int n = 0; n < taken; n++) {
        uint other = texelFetch(taken_object, ivec3(gl_FragCoord.xy, n), 0).x;
        if (((other & TUBE_OWN_COLOUR) != 0u ? mapped : other) == number) {
            discard;
        }
    }
#endif
    vec3 outward = side / max(length(side), 1e-6);
    surface = vec4(gl_FrontFacing ? outward : -outward, depth);
    object = painted();
}
