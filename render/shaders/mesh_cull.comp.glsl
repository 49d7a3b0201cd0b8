// Culling: the triangles that an n x n buffer can show become the index list of one draw. Left out are clusters outside
// the buffer's pyramid (the square one around the cone; a cylinder's prism), those that touch no pixel's centre, and
// those behind what is known of every pixel that they may cover. Conservative: what is left out cannot be seen.
layout(local_size_x = CLUSTER_RANGE / CLUSTER_GROUP) in;

layout(binding = BALL_UNIT) uniform samplerBuffer balls;        // around clusters, then groups: centre and radius, world mm
layout(binding = CLUSTER_UNIT) uniform usamplerBuffer clusters; // first triangle, count, object
layout(binding = CORNER_UNIT) uniform usamplerBuffer corners;

layout(std430, binding = PIXEL_BUFFER) restrict readonly buffer Pixels
{
    uint pixels[]; // as in mesh_id.frag.glsl; the first of each is the distance
};

layout(std430, binding = INDEX_BUFFER) restrict writeonly buffer Indices
{
    uint indices[];
};

layout(std430, binding = SHOWN_BUFFER) restrict readonly buffer Shown
{
    uint shown[]; // ranges of clusters
};

layout(std430, binding = DRAW_BUFFER) restrict buffer Draws
{
    uint draws[]; // commands of glDrawElementsIndirect(), the first word of which is the number of indices
};

layout(location = 0) uniform dvec3 apex;
layout(location = 1) uniform dmat3 device_from_world; // rows: right and up, over the edge; forward
layout(location = 2) uniform bool parallel;
layout(location = 3) uniform int resolution;
layout(location = 4) uniform dvec3 shape; // half the buffer's edge: tangent of half the angle or radius; cosine and sine
layout(location = 5) uniform ivec2 known; // the first pixel, and words a pixel; 0 where nothing is known
layout(location = 6) uniform ivec2 batch; // its first place in `shown`; the word of its command
layout(location = 7) uniform int count;   // clusters in all

const double MARGIN = 0.02;     // pixels by which a driver's vertex grid may move an edge, and a margin
const double ROUNDING = 1.0e-6; // relative; GLSL rounds divisions and roots of doubles as those of floats at worst
const int MANY = 64;            // pixels that are not asked one by one

// Half the buffer's edge at a depth.
double edge_at(double depth)
{
    return parallel ? shape.x : shape.x * depth;
}

// The first and the last pixel whose centre a ball may cover along one axis; the last is before the first if none.
ivec2 covered(double offset, double radius, double near, double far)
{
    double low = offset - radius;
    double high = offset + radius;
    double n = double(resolution);
    low = ((low / (low < 0.0 ? near : far) + 1.0) * n - 1.0) / 2.0 - MARGIN;
    high = ((high / (high > 0.0 ? near : far) + 1.0) * n - 1.0) / 2.0 + MARGIN;
    return ivec2(int(ceil(clamp(low, 0.0, n))), int(floor(clamp(high, -1.0, n - 1.0))));
}

// Whether the ray of a pixel passes the ball, or so near that a driver may think so.
bool passes(ivec2 pixel, dvec3 at, double radius)
{
    dvec2 side = (dvec2(2 * pixel + 1) / double(resolution) - 1.0) * shape.x;
    double reach = radius + ROUNDING * abs(at.z) + 4.0 * MARGIN / double(resolution) * edge_at(at.z + radius);
    dvec3 off = parallel ? dvec3(at.xy - side, 0.0) : cross(at, dvec3(side, 1.0));
    double square = parallel ? 1.0 : dot(side, side) + 1.0;
    return dot(off, off) <= reach * reach * square;
}

// Whether a pixel's distance, as far as it is known, lets the ball be seen.
bool is_open(ivec2 pixel, double nearest)
{
    return known.y == 0 || nearest <= double(uintBitsToFloat(
        pixels[known.x + (pixel.y * resolution + pixel.x) * known.y])) * (1.0 + ROUNDING);
}

bool is_visible(vec4 ball)
{
    double radius = double(ball.w);
    dvec3 at = device_from_world * (dvec3(ball.xyz) - apex); // to the right, up, forward
    at = dvec3(at.xy * shape.x, at.z);
    double outside = max(abs(at.x), abs(at.y)) - (parallel ? shape.x : 0.0);
    if (at.z <= -radius || outside * shape.y - at.z * shape.z >= radius) {
        return false;
    }
    double near = edge_at(at.z - radius);
    double far = edge_at(at.z + radius);
    ivec2 across = ivec2(0, resolution - 1);
    ivec2 up = across;
    if (near > 0.0) {
        across = covered(at.x, radius, near, far);
        up = covered(at.y, radius, near, far);
    }
    ivec2 size = max(ivec2(across.y - across.x, up.y - up.x) + 1, 0);
    if (size.x > MANY || size.y > MANY || size.x * size.y > MANY) {
        return true;
    }
    double away = parallel ? abs(at.z) : sqrt(dot(at, at));
    double nearest = away * (1.0 - ROUNDING) - radius * (1.0 + ROUNDING);
    bool visible = false;
    for (int i = 0; i < size.x * size.y && !visible; i++) {
        ivec2 pixel = ivec2(across.x + i % size.x, up.x + i / size.x);
        visible = is_open(pixel, nearest) && (at.z <= radius || passes(pixel, at, radius));
    }
    return visible;
}

// Appends the corners of a cluster's triangles to the list.
void list(int number)
{
    uvec3 cluster = texelFetch(clusters, number).xyz;
    uint place = atomicAdd(draws[batch.y], 3u * cluster.y);
    for (uint k = 0u; k < cluster.y; k++) {
        uvec3 corner = texelFetch(corners, int(cluster.x + k)).xyz;
        indices[place + 3u * k] = corner.x;
        indices[place + 3u * k + 1u] = corner.y;
        indices[place + 3u * k + 2u] = corner.z;
    }
}

// A workgroup is a range, and each of its shaders a group of clusters, most of which can be left out at once.
void main()
{
    int range = int(shown[batch.x + int(gl_WorkGroupID.x)]);
    int group = range * int(gl_WorkGroupSize.x) + int(gl_LocalInvocationID.x);
    int number = group * CLUSTER_GROUP;
    int end = min(number + CLUSTER_GROUP, count);
    if (number >= end || !is_visible(texelFetch(balls, count + group))) {
        return;
    }
    for (; number < end; number++) {
        if (is_visible(texelFetch(balls, number))) {
            list(number);
        }
    }
}
