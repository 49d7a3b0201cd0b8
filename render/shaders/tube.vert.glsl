// A box on the screen around a capsule: the streamline from one point to the next, and its radius around it. Drawn as a
// strip of two triangles per segment.
layout(location = 0) in vec3 start; // world mm
layout(location = 1) in vec3 end;
layout(location = 2) in uint paint; // 0 = nothing goes from here to the next point

uniform dvec3 eye;
uniform dmat3 camera_from_world; // as in mesh.vert.glsl
uniform vec2 shift;
uniform float radius;            // mm

flat out vec3 from, to; // relative to the eye, in the axes of the world
flat out uint number;

const float NEAR = 0.1;         // as in mesh.vert.glsl
const uint BALL = 0x20000000u;  // a streamline of one point

// Low and high corner of what a ball covers at most; its centre is at `place` in the camera's axes. For a point moved by
// d, |d| <= r: X' - X = (row d - X forward d) / (z + forward d).
vec4 ball_box(vec3 place)
{
    vec2 at = place.xy / place.z;
    vec2 rows = vec2(length(transpose(mat3(camera_from_world))[0]), length(transpose(mat3(camera_from_world))[1]));
    vec2 reach = radius * (rows + abs(at)) / (place.z - radius);
    return vec4(at - reach, at + reach);
}

void main()
{
    bool is_ball = (paint & BALL) != 0u;
    from = vec3(dvec3(start) - eye);
    to = is_ball ? from : vec3(dvec3(end) - eye);
    number = paint & ~BALL;
    vec3 a = vec3(camera_from_world * (dvec3(start) - eye));
    vec3 b = is_ball ? a : vec3(camera_from_world * (dvec3(end) - eye));
    bool is_off = paint == 0u || max(a.z, b.z) + radius < NEAR;
    vec4 box = vec4(-1, -1, 1, 1);
    float front = 1; // reversed depth that no point of it is before
    if (min(a.z, b.z) > radius + NEAR) {
        front = NEAR / (min(a.z, b.z) - radius);
        vec4 first = ball_box(a);
        vec4 last = ball_box(b);
        box = vec4(min(first.xy, last.xy) - shift, max(first.zw, last.zw) - shift);
    }
    vec2 corner = vec2((gl_VertexID & 1) == 0 ? box.x : box.z, (gl_VertexID & 2) == 0 ? box.y : box.w);
    gl_Position = is_off ? vec4(2, 2, 0.5, 1) : vec4(corner, front, 1);
}
