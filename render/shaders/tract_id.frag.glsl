// The pass of streamlines: notes which runs of segments a pixel's ray may hit, as near as it is known to get or nearer.
// It searches as tract_search_lanes.h does, with as much slack; what it notes is settled on the CPU in double.
flat in vec3 from, to;
flat in vec2 thickness;
flat in uint run;

struct Hit {
    uint pixel, run;
    float enter; // mm from where the search begins: not before that is the run hit
};

layout(std430, binding = NEAREST_BUFFER) restrict coherent buffer Nearest
{
    uint nearest[]; // bits of how far each ray gets, as a float: for these, greater bits are a greater number
};

layout(std430, binding = HIT_BUFFER) restrict buffer Hits // see shader_list.h
{
    uint hit_count, unused;
    Hit hits[];
};

layout(binding = RAY_UNIT) uniform samplerBuffer rays; // where the search begins, and the slack, 0 = no ray; direction

uniform float radius; // mm
uniform int resolution, first_pixel;
uniform ivec2 pixels;  // the first, and the first that is not to be drawn
uniform bool has_bound; // only first hits are asked for

// Where the ray enters the capsule of a radius round a + h e, at depth + h along it. `rest` is negative where it
// misses.
float entry(out float rest, vec3 a, vec3 e, float depth, float deeper, float square, float closest, float reach)
{
    vec3 foot = a + closest * e;
    float chord = sqrt(max(0.0, reach * reach - dot(foot, foot)));
    float sine = deeper / sqrt(square * (square + deeper * deeper));
    float h = clamp(closest - chord * sine, 0.0, 1.0);
    vec3 place = a + h * e;
    rest = reach * reach - dot(place, place);
    return h * deeper + depth - sqrt(max(0.0, rest));
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int pixel = first_pixel + at.y * resolution + at.x;
    vec4 start = texelFetch(rays, 2 * pixel);
    float slack = start.w;
    if (slack == 0.0 || pixel < pixels.x || pixel >= pixels.y) {
        return;
    }
    vec3 direction = texelFetch(rays, 2 * pixel + 1).xyz;
    vec3 a = from - start.xyz;
    vec3 b = to - start.xyz;
    float depth = dot(a, direction);
    float last = dot(b, direction);
    float deeper = last - depth;
    a -= depth * direction;
    vec3 e = b - last * direction - a;
    float square = max(dot(e, e), slack * slack);
    float closest = -dot(a, e) / square;
    float outer = radius + 2.0 * slack + thickness.x;
    vec3 foot = a + clamp(closest, 0.0, 1.0) * e;
    if (dot(foot, foot) > outer * outer || max(depth, last) + outer < -slack) {
        return;
    }
    float rest;
    float enter = entry(rest, a, e, depth, deeper, square, closest, outer);
    enter = max(square <= 16.0 * slack * slack ? min(depth, last) - outer : enter, 0.0);
    if (enter > uintBitsToFloat(nearest[pixel])) {
        return;
    }
    float inner = radius - 2.0 * slack - thickness.y - thickness.x;
    float sure = entry(rest, a, e, depth, deeper, square, closest, inner) + slack;
    if (has_bound && inner >= 0.0 && rest >= 0.0 && sure >= 2.0 * slack) {
        atomicMin(nearest[pixel], floatBitsToUint(sure));
    }
    uint place = atomicAdd(hit_count, 1u);
    if (place < uint(hits.length())) {
        hits[place] = Hit(uint(pixel), run, enter);
    }
}
