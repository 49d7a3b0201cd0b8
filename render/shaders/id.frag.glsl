// The ID pass: per ray, the first voxel along it that belongs to an object (Eq. 5), or the first of the planes of Eq. 7
// on which it samples one. In double precision and `precise`, so that it takes the very cells that the CPU takes. Rays
// come prepared from the CPU, of as many pixels and cones as there are. Dispatched once per volume; a later volume
// only overwrites what is farther. PIERCE appends every interval of the ray inside an object to a list instead
// (Eq. 10).
//
// A fragment is a ray; 4 x 2 fragments are neighbours in the list, since they are walked in step.
//
// Defines: SLICES, PIERCE (0 or 1), and the bindings *_UNIT (textures) and *_BUFFER.

layout(binding = OBJECTS_UNIT) uniform usampler3D objects;
layout(binding = IDENTIFIER_UNIT) uniform usamplerBuffer identifiers;
layout(binding = RAY_UNIT) uniform usamplerBuffer rays; // struct id_ray, two doubles per texel
layout(location = 2) uniform ivec4 range; // of rays: the first, and the first not to trace; not 0 behind other volumes;
                                          // fragments across

#if !SLICES
layout(binding = DISTANCE_UNIT) uniform usampler3D distances; // codes: 0 = an object; else 1 + voxels to skip each way
layout(location = 0) uniform ivec3 box[2]; // the first and the last cell with objects
#endif

#if PIERCE
struct Interval { // struct id_interval
    uint ray, id;
    double entry, exit;
    uint cell[3];
};

layout(std430, binding = OUT_BUFFER) restrict buffer Intervals // see gl.h
{
    uint interval_count, unused;
    Interval intervals[];
};
#else
struct Found { // struct id_hit
    double t;
    uint id, cell[3];
};

layout(std430, binding = OUT_BUFFER) restrict buffer Hits { Found hits[]; };
#endif

#define NEVER packDouble2x32(uvec2(0u, 0x7ff00000u)) // infinity; to glslang not a constant

// Where the origin is nearer than FAR voxels, positions along a ray are exact to far less than NEAR voxels.
const double FAR = 33554432.0lf;
const double NEAR = 1e-6lf;

struct Ray { // in index space
    dvec3 origin, direction;
    dvec3 inverse; // infinite where the ray does not move; with SLICES the planes' start, spacing and count
#if SLICES
    double per_depth;
#else
    dvec3 sign;
    double clear; // so far from its middle a cell is surely the one that position along the ray tells
#endif
};

struct Place { // in a cell since t
    dvec3 cell;
    double t;
};

struct Hit {
    uint id; // 0: none
    Place place;
};

dvec2 load_pair(int at)
{
    uvec4 words = texelFetch(rays, at);
    return dvec2(packDouble2x32(words.xy), packDouble2x32(words.zw));
}

Ray load_ray(int number)
{
    dvec2 a = load_pair(5 * number), b = load_pair(5 * number + 1), c = load_pair(5 * number + 2);
    dvec2 d = load_pair(5 * number + 3), e = load_pair(5 * number + 4);
    dvec3 origin = dvec3(a, b.x), direction = dvec3(b.y, c), inverses = dvec3(d, e.x);
#if SLICES
    return Ray(origin, direction, inverses, e.y);
#else
    dvec3 signs = mix(dvec3(1.0), dvec3(-1.0), lessThan(direction, dvec3(0.0)));
    return Ray(origin, direction, inverses, signs, all(lessThan(abs(origin), dvec3(FAR))) ? 0.5 - NEAR : -1.0);
#endif
}

uint identify(dvec3 cell)
{
    uint last = uint(textureSize(identifiers)) - 1u;
    return texelFetch(identifiers, int(min(texelFetch(objects, ivec3(cell), 0).r, last))).r;
}

#if SLICES
Hit walk(Ray ray, double limit)
{
    ivec3 dim = textureSize(objects, 0);
    for (double k = 0.0; k < ray.inverse.z; k++) {
        precise double depth = ray.inverse.x + (k + 0.5) * ray.inverse.y;
        precise double t = depth * ray.per_depth;
        precise dvec3 cell = floor(ray.origin + t * ray.direction + 0.5);
        if (t > limit) {
            break;
        }
        if (is_inside(ivec3(cell), dim)) {
            uint id = identify(cell);
            if (id != 0u) {
                return Hit(id, Place(cell, t));
            }
        }
    }
    return Hit(0u, Place(dvec3(0.0), NEVER));
}
#else
// Index of the cell [i - 1/2, i + 1/2) that holds x, independent of how x + 1/2 is rounded.
dvec3 cell_of(dvec3 x)
{
    precise dvec3 cell = floor(x + 0.5);
    cell = mix(cell, cell - 1.0, greaterThan(cell - 0.5, x));
    return mix(cell, cell + 1.0, lessThanEqual(cell + 0.5, x));
}

struct Crossing {
    double t;
    int axis; // -1: the ray's start
};

// When the ray leaves the cell along each axis (half = 0.5), or enters it (-0.5).
dvec3 crossing_times(Ray ray, dvec3 cell, double half_cell)
{
    precise dvec3 t = ((cell + half_cell * ray.sign) - ray.origin) * ray.inverse;
    return t;
}

// The axes whose crossings at t come before `crossing`; equal times are in the order of the axes.
bvec3 are_before(dvec3 t, Crossing crossing)
{
    return mix(lessThan(t, dvec3(crossing.t)), lessThanEqual(t, dvec3(crossing.t)),
               lessThan(ivec3(0, 1, 2), ivec3(crossing.axis)));
}

// Positions along the axes just after a crossing of another axis, from `from` on; they stop at `end`. The guess is off
// by one at most; the crossings themselves decide.
dvec3 catch_up(Ray ray, Crossing crossing, dvec3 from, dvec3 end)
{
    dvec3 cell = clamp(floor(ray.origin + crossing.t * ray.direction + 0.5), min(from, end), max(from, end));
    for (;;) {
        bvec3 late = not(are_before(crossing_times(ray, cell, -0.5), crossing));
        dvec3 earlier = mix(cell, cell - ray.sign, late);
        earlier = mix(earlier, cell, equal(cell, from));
        if (earlier == cell) {
            break;
        }
        cell = earlier;
    }
    for (;;) {
        bvec3 early = are_before(crossing_times(ray, cell, 0.5), crossing);
        dvec3 later = mix(cell, cell + ray.sign, early);
        later = mix(later, cell, equal(cell, end));
        if (later == cell) {
            break;
        }
        cell = later;
    }
    return cell;
}

// The first cell beyond the box in the ray's direction.
dvec3 end_of(Ray ray)
{
    return mix(dvec3(box[1] + 1), dvec3(box[0] - 1), lessThan(ray.sign, dvec3(0.0)));
}

bool is_in_box(dvec3 cell)
{
    return all(greaterThanEqual(cell, dvec3(box[0]))) && all(lessThanEqual(cell, dvec3(box[1])));
}

// The first place in the box: the origin's, or behind the last crossing that brings the ray in. False: it misses.
bool enter(Ray ray, out Place at)
{
    Crossing last = Crossing(0.0, -1);
    dvec3 first = mix(dvec3(box[0]), dvec3(box[1]), lessThan(ray.sign, dvec3(0.0)));
    dvec3 end = end_of(ray);
    dvec3 entry = crossing_times(ray, first, -0.5);
    at.cell = cell_of(ray.origin);
    bvec3 outside = greaterThan((first - at.cell) * ray.sign, dvec3(0.0));
    if (outside.x && entry.x >= last.t) {
        last = Crossing(entry.x, 0);
    }
    if (outside.y && entry.y >= last.t) {
        last = Crossing(entry.y, 1);
    }
    if (outside.z && entry.z >= last.t) {
        last = Crossing(entry.z, 2);
    }
    at.cell = mix(at.cell, first, outside);
    at.t = last.t;
    if (!(at.t < NEVER) || any(greaterThanEqual((at.cell - end) * ray.sign, dvec3(0.0)))) {
        return false;
    }
    if (last.axis >= 0) {
        at.cell = mix(catch_up(ray, last, at.cell, end), at.cell, equal(ivec3(0, 1, 2), ivec3(last.axis)));
    }
    return is_in_box(at.cell);
}

// Leaves the box of `radius` cells around the place, which is empty unless radius is 0. False: the ray is out then.
bool leave(Ray ray, double radius, inout Place at)
{
    dvec3 reach = at.cell + radius * ray.sign;
    dvec3 t = crossing_times(ray, reach, 0.5);
    Crossing first = Crossing(t.x, 0);
    if (t.y < first.t) {
        first = Crossing(t.y, 1);
    }
    if (t.z < first.t) {
        first = Crossing(t.z, 2);
    }
    dvec3 cell = radius > 0.0 ? catch_up(ray, first, at.cell, end_of(ray)) : at.cell;
    at = Place(mix(cell, reach + ray.sign, equal(ivec3(0, 1, 2), ivec3(first.axis))), first.t);
    return at.t < NEVER && is_in_box(at.cell);
}

uint code_at(Place at)
{
    return texelFetch(distances, ivec3(at.cell), 0).r;
}

// Goes on to the next cell with an object, which may be the present one. False: out of the box, or beyond the limit.
// Most skips end well within a cell, so that the position along the ray decides which; `leave` does the others, outside
// of the inner loop, because lanes in step go both ways of every branch, but leave a loop when all are done.
bool find_object(Ray ray, double limit, inout Place at)
{
    dvec3 t_end = crossing_times(ray, mix(dvec3(box[1]), dvec3(box[0]), lessThan(ray.sign, dvec3(0.0))), 0.5);
    double stop = min(min(t_end.x, t_end.y), min(t_end.z, limit));
    bool is_under_way = at.t <= limit;
    while (is_under_way) {
        uint code = code_at(at);
        bool is_clear = true;
        while (code != 0u && is_clear) {
            dvec3 reach = at.cell + double(code - 1u) * ray.sign;
            dvec3 t = crossing_times(ray, reach, 0.5);
            double t_first = min(t.x, min(t.y, t.z));
            bvec3 crossed = bvec3(t.x == t_first, t.y == t_first && t.x != t_first, false);
            crossed.z = !crossed.x && !crossed.y;
            dvec3 place = ray.origin + t_first * ray.direction;
            dvec3 cell = floor(place + 0.5);
            dvec3 off = mix(abs(place - cell), dvec3(0.0), crossed);
            is_clear = t_first < stop && max(off.x, max(off.y, off.z)) <= ray.clear;
            if (is_clear) {
                at = Place(mix(cell, reach + ray.sign, crossed), t_first);
                code = code_at(at);
            }
        }
        if (code == 0u) {
            return true;
        }
        is_under_way = leave(ray, double(code - 1u), at) && at.t <= limit;
    }
    return false;
}

#if PIERCE
// Ends the interval at t and begins one of `id` there.
void change(inout Interval interval, uint id, double t, dvec3 cell)
{
    if (interval.id != 0u) {
        interval.exit = t;
        uint place = atomicAdd(interval_count, 1u);
        if (place < uint(intervals.length())) {
            intervals[place] = interval;
        }
    }
    interval.id = id;
    interval.entry = t;
    interval.cell = uint[](uint(cell.x), uint(cell.y), uint(cell.z));
}

// Eq. 10: runs of cells with the same object.
void pierce(Ray ray, uint number)
{
    Interval interval = Interval(number, 0u, 0.0, 0.0, uint[](0u, 0u, 0u));
    Place at;
    bool is_in = enter(ray, at);
    while (is_in && find_object(ray, NEVER, at)) {
        do {
            uint id = identify(at.cell);
            if (id != interval.id) {
                change(interval, id, at.t, at.cell);
            }
            is_in = leave(ray, 0.0, at);
        } while (is_in && code_at(at) == 0u);
        change(interval, 0u, at.t, dvec3(0.0));
    }
}
#else
Hit walk(Ray ray, double limit)
{
    Place at;
    bool is_in = enter(ray, at);
    while (is_in && find_object(ray, limit, at)) {
        uint id = identify(at.cell);
        if (id != 0u) {
            return Hit(id, at);
        }
        is_in = leave(ray, 0.0, at);
    }
    return Hit(0u, Place(dvec3(0.0), NEVER));
}
#endif
#endif

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int number = range.x + ((at.y >> 1) * (range.w >> 2) + (at.x >> 2)) * 8 + (at.y & 1) * 4 + (at.x & 3);
    if (number >= range.y) {
        return;
    }
    Ray ray = load_ray(number);
#if PIERCE
    pierce(ray, uint(number));
#else
    bool has_hits = range.z != 0;
    double limit = has_hits ? hits[number].t : NEVER;
    Hit hit = walk(ray, limit);
    if (has_hits && (hit.id == 0u || (hit.place.t == limit && hits[number].id < hit.id))) {
        return;
    }
    uvec3 cell = uvec3(hit.place.cell);
    hits[number] = Found(hit.place.t, hit.id, uint[](cell.x, cell.y, cell.z));
#endif
}
