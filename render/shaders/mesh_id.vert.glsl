// A corner of a triangle in the device's frame. The subtraction from the device's place is in double precision, so that
// far from the world's origin, and far from the device, a corner falls where it does nearby.
layout(location = 0) in vec3 position; // world mm

layout(location = 0) uniform dvec3 apex;
// rows: right and up, over the tangent of half the angle or the radius; forward
layout(location = 1) uniform dmat3 device_from_world;
layout(location = 2) uniform bool parallel; // a cylinder's rays

flat out uint triangle;

void main()
{
    dvec3 place = device_from_world * (dvec3(position) - apex);
    // z = 0 passes every clipping plane as long as the corner is before the apex: there is no near or far plane.
    gl_Position = vec4(vec2(place.xy), 0.0, parallel ? 1.0 : float(place.z));
    triangle = uint(gl_VertexID); // the last corner's counts: see id_pass.h
}
