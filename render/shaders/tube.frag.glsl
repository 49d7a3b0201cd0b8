// The nearest point of a capsule along the pixel's ray, as mesh.frag.glsl tells it.
flat in vec3 from, to;
flat in uint number;

uniform mat3 world_from_camera; // ends of rays at depth 1
uniform vec2 shift, size;       // size: pixels
uniform float radius;

layout(location = 0) out vec4 surface;
layout(location = 1) out uint object;
layout(depth_less) out float gl_FragDepth; // reversed: what is behind the box's front is no nearer

const float NEAR = 0.1;
const float NEVER = 3.0e38;

float ball(vec3 centre, vec3 ray)
{
    float along = dot(centre, ray);
    vec3 away = centre - along * ray;
    float inside = radius * radius - dot(away, away);
    return inside < 0.0 ? NEVER : along - sqrt(inside);
}

// `a` to `b` relative to a point of the ray that is near them; the unit vector `ray`.
float capsule(vec3 a, vec3 b, vec3 ray)
{
    float span = length(b - a);
    vec3 axis = span > 0.0 ? (b - a) / span : vec3(0);
    vec3 across = ray - axis * dot(ray, axis);
    vec3 offset = -a + axis * dot(a, axis);
    float square = dot(across, across);
    float cap = min(ball(a, ray), ball(b, ray));
    if (span == 0.0 || square < 1e-10) {
        return cap;
    }
    float closest = -dot(offset, across) / square;
    vec3 miss = offset + closest * across;
    float inside = radius * radius - dot(miss, miss);
    if (inside < 0.0) {
        return NEVER;
    }
    float t = closest - sqrt(inside / square);
    float place = dot(t * ray - a, axis);
    return place >= 0.0 && place <= span ? t : cap;
}

void main()
{
    vec2 at = 2.0 * gl_FragCoord.xy / size - 1.0 + shift;
    vec3 direction = world_from_camera * vec3(at, 1);
    float per_depth = length(direction);
    vec3 ray = direction / per_depth;
    float near = dot(0.5 * (from + to), ray);
    vec3 a = from - near * ray;
    vec3 b = to - near * ray;
    float t = capsule(a, b, ray);
    float depth = (near + t) / per_depth;
    if (t >= NEVER || depth < NEAR) {
        discard;
    }
    vec3 hit = t * ray;
    float span = dot(b - a, b - a);
    float along = span > 0.0 ? clamp(dot(hit - a, b - a) / span, 0.0, 1.0) : 0.0;
    surface = vec4(normalize(hit - mix(a, b, along)), depth);
    object = number;
    gl_FragDepth = NEAR / depth;
}
