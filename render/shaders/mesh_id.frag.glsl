// The mesh ID pass (Eq. 9): notes which triangle covers the pixel's centre, unless one is known that is nearer by more
// than rounding. What it notes is settled on the CPU in double precision.
flat in uint triangle;

struct Pixel {
    uint nearest; // bits of the smallest distance so far, as a float: for these, greater bits are a greater number
    uint count;   // triangles noted, or more, which did not fit
    uint triangles[CAPACITY];
};

layout(std430, binding = PIXEL_BUFFER) restrict buffer Pixels
{
    Pixel pixels[];
};

layout(binding = POSITION_UNIT) uniform samplerBuffer positions;
layout(binding = CORNER_UNIT) uniform usamplerBuffer corners;

layout(location = 0) uniform dvec3 apex;
layout(location = 3) uniform int resolution;
layout(location = 6) uniform int first_pixel;
// columns: right and up, times the tangent of half the angle; forward
layout(location = 4) uniform dmat3 direction_from_place;
layout(location = 5) uniform dmat2x3 origin_from_place; // columns: right and up, times a cylinder's radius

const float SLACK = 1.000001;
const double BEHIND = -1e-3; // mm: far more than rounding

dvec3 corner(uint number)
{
    return dvec3(texelFetch(positions, int(number)).xyz) - apex;
}

// Distance to the triangle's plane, within the triangle's reach along the ray: mesh_distance() in atlas/surface/mesh.h.
double distance_to(uint number, dvec3 origin, dvec3 direction)
{
    uvec3 at = texelFetch(corners, int(number)).xyz;
    dvec3 a = corner(at.x) - origin;
    dvec3 b = corner(at.y) - origin;
    dvec3 c = corner(at.z) - origin;
    dvec3 reach = dvec3(dot(a, direction), dot(b, direction), dot(c, direction));
    double low = min(reach.x, min(reach.y, reach.z));
    double high = max(reach.x, max(reach.y, reach.z));
    dvec3 normal = cross(b - a, c - a);
    double along = dot(normal, direction);
    return along == 0.0 ? low : clamp(dot(normal, a) / along, low, high);
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    dvec2 place = dvec2(2 * at + 1) / double(resolution) - 1.0;
    dvec3 direction = normalize(direction_from_place * dvec3(place, 1.0));
    double reached = distance_to(triangle, origin_from_place * place, direction);
    if (reached < BEHIND) {
        return;
    }
    int pixel = first_pixel + at.y * resolution + at.x;
    float t = float(max(reached, 0.0));
    // what may lie behind the ray's start hides nothing
    uint before = atomicMin(pixels[pixel].nearest, reached < 0.0 ? 0xffffffffu : floatBitsToUint(t));
    if (t <= uintBitsToFloat(before) * SLACK) {
        uint slot = atomicAdd(pixels[pixel].count, 1u);
        if (slot < uint(CAPACITY)) {
            pixels[pixel].triangles[slot] = triangle;
        }
    }
}
