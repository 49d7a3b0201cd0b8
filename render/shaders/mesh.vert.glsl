// A corner of a triangle as the camera sees it; like mesh_id.vert.glsl relative to the eye in double precision.
layout(location = 0) in vec3 position; // world mm
layout(location = 1) in vec3 normal;   // world
layout(location = 2) in uint object;
layout(location = 3) in vec2 map_value; // of a map; 0 without one

uniform dvec3 eye;
uniform dmat3 camera_from_world; // rows: right and up, in halves of the picture from its middle; forward
uniform vec2 shift;              // of the rays, in units of half the picture

out vec3 side;
out float depth;
out vec2 value;
flat out uint number;

const float NEAR = 0.1; // mm before the eye, as the rays'

void main()
{
    vec3 place = vec3(camera_from_world * (dvec3(position) - eye));
    gl_Position = vec4(place.xy - shift * place.z, NEAR, place.z); // reversed: 1 at NEAR, 0 at infinity
    side = normal;
    depth = place.z;
    value = map_value;
    number = object;
}
