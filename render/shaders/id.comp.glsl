// The ID pass: per ray, the first voxel along it that belongs to an object (Eq. 5), or the first of the planes of Eq. 7
// on which it samples one. In double precision and `precise`, so that it takes the very cells that the CPU takes. Rays
// come prepared from the CPU, of as many pixels and cones as there are. Dispatched once per volume; a later volume
// (MERGE) only overwrites what is farther. PIERCE appends every piece of the ray inside an object to a list instead
// (Eq. 10).
//
// Defines: SLICES, MERGE, PIERCE (0 or 1), GROUP, BRICK_SHIFT, and the bindings *_UNIT (textures) and *_BUFFER.

layout(local_size_x = GROUP) in;

struct Ray { // struct id_ray
    double origin[3], direction[3];
    double inverse[4]; // the last is unused; with SLICES the planes: start, spacing, count, mm per mm of depth
};

layout(binding = OBJECTS_UNIT) uniform usampler3D objects;
layout(std430, binding = IDENTIFIER_BUFFER) readonly restrict buffer Identifiers { uint identifiers[]; };
layout(std430, binding = RAY_BUFFER) readonly restrict buffer Rays { Ray rays[]; };
uniform ivec2 range; // of rays: the first, and the first that is not to be looked along

#if !SLICES
layout(binding = BRICKS_UNIT) uniform usampler3D bricks;
#endif

#if PIERCE
struct Piece { // struct id_piece
    uint ray, id;
    double entry, exit;
    uint cell[3];
};

layout(std430, binding = OUT_BUFFER) restrict buffer Pieces // see shader_list.h
{
    uint piece_count, unused;
    Piece pieces[];
};
#else
struct Found { // struct id_hit
    double t;
    uint id, cell[3];
};

layout(std430, binding = OUT_BUFFER) restrict buffer Hits { Found hits[]; };
#endif

#define NEVER packDouble2x32(uvec2(0u, 0x7ff00000u)) // infinity; to glslang not a constant

struct Way {
    dvec3 origin, direction, inverse; // in index space; inverse is infinite where the ray does not move
};

struct Hit {
    uint id; // 0: none
    dvec3 cell;
    double t;
};

Way load_way(int ray)
{
    Ray r = rays[ray];
    return Way(dvec3(r.origin[0], r.origin[1], r.origin[2]), dvec3(r.direction[0], r.direction[1], r.direction[2]),
               dvec3(r.inverse[0], r.inverse[1], r.inverse[2]));
}

uint identify(dvec3 cell)
{
    uint last = uint(identifiers.length() - 1);
    return identifiers[min(texelFetch(objects, ivec3(cell), 0).r, last)];
}

#if SLICES
Hit walk(int number, ivec3 dim, double limit)
{
    Way ray = load_way(number);
    dvec3 planes = ray.inverse;
    double per_depth = rays[number].inverse[3];
    for (double k = 0.0; k < planes.z; k++) {
        precise double depth = planes.x + (k + 0.5) * planes.y;
        precise double t = depth * per_depth;
        precise dvec3 cell = floor(ray.origin + t * ray.direction + 0.5);
        if (t > limit) {
            break;
        }
        if (is_inside(ivec3(cell), dim)) {
            uint id = identify(cell);
            if (id != 0u) {
                return Hit(id, cell, t);
            }
        }
    }
    return Hit(0u, dvec3(0.0), NEVER);
}
#else
// Index of the cell [i - 1/2, i + 1/2) that holds x, whichever way x + 1/2 is rounded.
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
dvec3 crossing_times(Way ray, dvec3 sign, dvec3 cell, double half_cell)
{
    precise dvec3 t = ((cell + half_cell * sign) - ray.origin) * ray.inverse;
    return t;
}

// Which axes' crossings at t come before `crossing`; equal times are in the order of the axes.
bvec3 are_before(dvec3 t, Crossing crossing)
{
    return mix(lessThan(t, dvec3(crossing.t)), lessThanEqual(t, dvec3(crossing.t)),
               lessThan(ivec3(0, 1, 2), ivec3(crossing.axis)));
}

// Where axes are just after a crossing of another one, when they were in `from` before; they stop at `end`.
// The guess is off by one at most; the crossings themselves decide.
dvec3 catch_up(Way ray, dvec3 sign, Crossing crossing, dvec3 from, dvec3 end)
{
    dvec3 cell = clamp(floor(ray.origin + crossing.t * ray.direction + 0.5), min(from, end), max(from, end));
    for (;;) {
        bvec3 late = not(are_before(crossing_times(ray, sign, cell, -0.5), crossing));
        dvec3 earlier = mix(cell, cell - sign, late);
        earlier = mix(earlier, cell, equal(cell, from));
        if (earlier == cell) {
            break;
        }
        cell = earlier;
    }
    for (;;) {
        bvec3 early = are_before(crossing_times(ray, sign, cell, 0.5), crossing);
        dvec3 later = mix(cell, cell + sign, early);
        later = mix(later, cell, equal(cell, end));
        if (later == cell) {
            break;
        }
        cell = later;
    }
    return cell;
}

// The first cell in the grid: the origin's, or that behind the last crossing that brings the ray in. False: it misses.
bool enter_grid(Way ray, dvec3 sign, dvec3 end, dvec3 dim, out dvec3 cell, out double t)
{
    Crossing last = Crossing(0.0, -1);
    dvec3 first = mix(dvec3(0.0), dim - 1.0, lessThan(sign, dvec3(0.0)));
    dvec3 entry = crossing_times(ray, sign, first, -0.5);
    cell = cell_of(ray.origin);
    for (int axis = 0; axis < 3; axis++) {
        if ((first[axis] - cell[axis]) * sign[axis] > 0.0) {
            if (entry[axis] >= last.t) {
                last = Crossing(entry[axis], axis);
            }
            cell[axis] = first[axis];
        }
    }
    t = last.t;
    if (!(t < NEVER) || any(greaterThanEqual((cell - end) * sign, dvec3(0.0)))) {
        return false;
    }
    if (last.axis >= 0) {
        cell = mix(catch_up(ray, sign, last, cell, end), cell, equal(ivec3(0, 1, 2), ivec3(last.axis)));
    }
    return is_inside(ivec3(cell), ivec3(dim));
}

// Leaves the box whose last cells in the ray's direction are `last`, all of it empty; the time of it.
double leave_box(Way ray, dvec3 sign, dvec3 end, dvec3 last, inout dvec3 cell)
{
    dvec3 t = crossing_times(ray, sign, last, 0.5);
    Crossing first = Crossing(t.x, 0);
    if (t.y < first.t) {
        first = Crossing(t.y, 1);
    }
    if (t.z < first.t) {
        first = Crossing(t.z, 2);
    }
    bvec3 crossed = equal(ivec3(0, 1, 2), ivec3(first.axis));
    if (last != cell) {
        cell = catch_up(ray, sign, first, cell, end);
    }
    cell = mix(cell, last + sign, crossed);
    return first.t;
}

// Leaves the cell, or the box of empty bricks around it, `empty` of them each way less one; the time of it.
double leave(Way ray, dvec3 sign, dvec3 end, int empty, inout dvec3 cell)
{
    ivec3 brick = ivec3(cell) >> BRICK_SHIFT;
    dvec3 high = dvec3(((brick + empty) << BRICK_SHIFT) - 1);
    dvec3 low = dvec3((brick + 1 - empty) << BRICK_SHIFT);
    return leave_box(ray, sign, end, empty == 0 ? cell : mix(high, low, lessThan(sign, dvec3(0.0))), cell);
}

int count_empty_bricks(dvec3 cell)
{
    return int(texelFetch(bricks, ivec3(cell) >> BRICK_SHIFT, 0).r);
}

dvec3 signs_of(Way ray)
{
    return mix(dvec3(1.0), dvec3(-1.0), lessThan(ray.direction, dvec3(0.0)));
}

#if PIERCE
// Ends the piece at t and begins one of `id` there.
void change(inout Piece piece, uint id, double t, dvec3 cell)
{
    if (piece.id != 0u) {
        piece.exit = t;
        uint place = atomicAdd(piece_count, 1u);
        if (place < uint(pieces.length())) {
            pieces[place] = piece;
        }
    }
    piece.id = id;
    piece.entry = t;
    piece.cell = uint[](uint(cell.x), uint(cell.y), uint(cell.z));
}

// Eq. 10: runs of cells with the same object.
void pierce(int number, ivec3 dim)
{
    Way ray = load_way(number);
    dvec3 sign = signs_of(ray);
    dvec3 end = mix(dvec3(dim), dvec3(-1.0), lessThan(sign, dvec3(0.0)));
    Piece piece = Piece(uint(number), 0u, 0.0, 0.0, uint[](0u, 0u, 0u));
    dvec3 cell;
    double t;
    if (!enter_grid(ray, sign, end, dvec3(dim), cell, t)) {
        return;
    }
    while (is_inside(ivec3(cell), dim)) {
        int empty = count_empty_bricks(cell);
        uint id = empty == 0 ? identify(cell) : 0u;
        if (id != piece.id) {
            change(piece, id, t, cell);
        }
        t = leave(ray, sign, end, empty, cell);
    }
    change(piece, 0u, t, dvec3(0.0));
}
#else
Hit walk(int number, ivec3 dim, double limit)
{
    Way ray = load_way(number);
    dvec3 sign = signs_of(ray);
    dvec3 end = mix(dvec3(dim), dvec3(-1.0), lessThan(sign, dvec3(0.0)));
    dvec3 cell;
    double t;
    if (!enter_grid(ray, sign, end, dvec3(dim), cell, t)) {
        return Hit(0u, dvec3(0.0), NEVER);
    }
    while (t <= limit && is_inside(ivec3(cell), dim)) {
        int empty = count_empty_bricks(cell);
        uint id = empty == 0 ? identify(cell) : 0u;
        if (id != 0u) {
            return Hit(id, cell, t);
        }
        t = leave(ray, sign, end, empty, cell);
    }
    return Hit(0u, dvec3(0.0), NEVER);
}
#endif
#endif

void main()
{
    int ray = range.x + int(gl_GlobalInvocationID.x);
    ivec3 dim = textureSize(objects, 0);
    if (ray >= range.y) {
        return;
    }
#if PIERCE
    pierce(ray, dim);
#else
    double limit = NEVER;
    uint rival = 0u;
#if MERGE
    limit = hits[ray].t;
    rival = hits[ray].id;
#endif
    Hit hit = walk(ray, dim, limit);
#if MERGE
    if (hit.id == 0u || (hit.t == limit && rival < hit.id)) {
        return;
    }
#endif
    uvec3 cell = uvec3(hit.cell);
    hits[ray] = Found(hit.t, hit.id, uint[](cell.x, cell.y, cell.z));
#endif
}
