// A box on the screen around a run of a streamline's segments (Eq. 18): all pixels whose centres its capsules can cover.
// Its edges lie between pixels, so that the driver's grid does not matter.
layout(binding = LEAF_UNIT) uniform usamplerBuffer leaves; // see tract_texels_fill()

uniform dvec3 apex;
uniform dmat3 device_from_world; // rows: right, up, forward
uniform bool parallel;           // a cylinder's rays
uniform float width;             // half the buffer's edge: at depth 1, or everywhere
uniform float radius, slack;     // mm; the most slack that a ray has
uniform int resolution;

flat out vec3 from, to;  // world mm; the run is no farther from that segment than its thickness
flat out vec2 thickness; // mm; and more than what rounding to bytes moves an end by
flat out uint run;

const uint BYTE = 0xffu;
const vec4 NOWHERE = vec4(2, 2, 0, 1);

vec3 end(uint word, vec3 low, vec3 way)
{
    return vec3(word & BYTE, word >> 8 & BYTE, word >> 16 & BYTE) * way + low;
}

// The range on the buffer, -1 to 1, of a box from `low` to `high` to one side and at depths from `near` to `far`, which
// is above 0.
vec2 places(float low, float high, float near, float far)
{
    if (parallel) {
        return vec2(low, high) / width;
    }
    near *= width;
    far *= width;
    return vec2(low >= 0 ? low / far : near > 0 ? low / near : -2, high <= 0 ? high / far : near > 0 ? high / near : 2);
}

// The same for the hull of two balls: if both lie before the apex that of both boxes, else that of the box around both.
vec2 places_between(vec2 side, vec2 depth, float reach)
{
    float low = min(side.x, side.y) - reach;
    float high = max(side.x, side.y) + reach;
    float near = min(depth.x, depth.y) - reach;
    float far = max(depth.x, depth.y) + reach;
    if (near <= 0 || parallel) {
        return places(low, high, near, far);
    }
    vec2 first = places(side.x - reach, side.x + reach, depth.x - reach, depth.x + reach);
    vec2 last = places(side.y - reach, side.y + reach, depth.y - reach, depth.y + reach);
    return vec2(min(first.x, last.x), max(first.y, last.y));
}

// The first pixel whose centre lies between two places, and one past the last.
vec2 pixels_of(vec2 range)
{
    float n = float(resolution);
    float margin = 0.01 + 1e-5 * n;
    vec2 at = ((clamp(range, -2.0, 2.0) + 1.0) * n - 1.0) / 2.0;
    return vec2(max(ceil(at.x - margin), 0.0), min(floor(at.y + margin) + 1.0, n));
}

void main()
{
    int number = gl_VertexID / 4;
    int texel = number / LEAF_RUNS * LEAF_TEXELS;
    uvec4 first = texelFetch(leaves, texel);
    vec3 way = uintBitsToFloat(texelFetch(leaves, texel + 1).xyz);
    uvec4 two = texelFetch(leaves, texel + 2 + number % LEAF_RUNS / 2);
    uvec2 one = number % 2 == 0 ? two.xy : two.zw;
    run = uint(number);
    from = end(one.x, uintBitsToFloat(first.xyz), way);
    to = end(one.y, uintBitsToFloat(first.xyz), way);
    thickness = vec2(float(one.x >> 24) * uintBitsToFloat(first.w), 0.875 * max(way.x, max(way.y, way.z)));
    vec3 a = vec3(device_from_world * (dvec3(from) - apex));
    vec3 b = vec3(device_from_world * (dvec3(to) - apex));
    float reach = (radius + thickness.x + 4.0 * slack) * 1.00001;
    vec2 depth = vec2(a.z, b.z);
    vec2 across = pixels_of(places_between(vec2(a.x, b.x), depth, reach));
    vec2 up = pixels_of(places_between(vec2(a.y, b.y), depth, reach));
    vec2 corner = vec2((gl_VertexID & 1) == 0 ? across.x : across.y, (gl_VertexID & 2) == 0 ? up.x : up.y);
    bool is_off = (one.y & uint(SHOWN)) == 0u || max(a.z, b.z) + reach <= 0 || across.x >= across.y || up.x >= up.y;
    gl_Position = is_off ? NOWHERE : vec4(2.0 * corner / float(resolution) - 1.0, 0, 1);
}
