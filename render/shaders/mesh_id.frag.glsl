// The mesh ID pass (Eq. 9): notes which triangle covers the pixel's centre, unless one is known that is nearer by more
// than rounding. What it notes is settled on the CPU in double precision.
flat in uint triangle;

struct Pixel {
    uint nearest; // bits of the smallest distance so far, as a float: for these, greater bits are a greater number
    uint count;   // triangles noted, or more where there was no room
    uint triangles[ROOM];
};

layout(std430, binding = PIXEL_BUFFER) restrict buffer Pixels
{
    Pixel pixels[];
};

layout(binding = POSITION_UNIT) uniform samplerBuffer positions;
layout(binding = CORNER_UNIT) uniform usamplerBuffer corners;

uniform dvec3 apex;
uniform dmat3 world_from_device; // columns: right and up, times the tangent of half the angle; forward
uniform int resolution;

const float SLACK = 1.000001;

dvec3 corner(uint number)
{
    return dvec3(texelFetch(positions, int(number)).xyz) - apex;
}

// Distance to the triangle's plane, within the triangle's reach along the ray: mesh_distance() in atlas/mesh.h.
float distance_to(uint number, dvec3 direction)
{
    uvec3 at = texelFetch(corners, int(number)).xyz;
    dvec3 a = corner(at.x);
    dvec3 b = corner(at.y);
    dvec3 c = corner(at.z);
    dvec3 reach = dvec3(dot(a, direction), dot(b, direction), dot(c, direction));
    double low = min(reach.x, min(reach.y, reach.z));
    double high = max(reach.x, max(reach.y, reach.z));
    dvec3 normal = cross(b - a, c - a);
    double along = dot(normal, direction);
    double t = along == 0.0 ? low : clamp(dot(normal, a) / along, low, high);
    return float(max(t, 0.0));
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    dvec2 place = dvec2(2 * at + 1) / double(resolution) - 1.0;
    float t = distance_to(triangle, normalize(world_from_device * dvec3(place, 1.0)));
    int pixel = at.y * resolution + at.x;
    uint before = atomicMin(pixels[pixel].nearest, floatBitsToUint(t));
    if (t <= uintBitsToFloat(before) * SLACK) {
        uint slot = atomicAdd(pixels[pixel].count, 1u);
        if (slot < uint(ROOM)) {
            pixels[pixel].triangles[slot] = triangle;
        }
    }
}
