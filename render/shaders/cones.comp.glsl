// A count of first hits: a workgroup is a cone, or a part of one with more than GROUP rays. It makes its rays (Eq. 3),
// walks them (Eq. 5) and adds up what they hit first, per object (Eq. 4, Eq. 11). Follows id.comp.glsl. Every operation is
// one that GLSL rounds correctly, in the order of the CPU: so rays, hits and sums have the CPU's bits.
//
// Dispatched once per volume; rays keep their nearer hit from one to the next, and the last one counts.
//
// MAKE only writes the rays, where id.comp.glsl takes them. CHECK inverts numbers, by which a driver shows that it rounds
// as it must.

struct Cone { // struct cone_place
    double right_x, right_y, right_z, up_x, up_y, up_z, back_x, back_y, back_z, apex_x, apex_y, apex_z;
    double radius; // of a cylinder; else 0
    uint shape, unused;
};

struct Aim { // struct cone_aim
    double right, up, forward, u, v;
    uint rank, unused;
};

struct Spot { // struct cone_spot
    double weight;
    uint pixel, square; // pixel with BORDER where its neighbour is in no cone
};

struct Row { // struct cone_row
    double nearest, contact, weight;
    uint object, own, pixels, pixel, voxel, border;
};

struct Known { // the hit of a ray in the volumes before
    double t;
    uint id, voxel;
};

layout(std430, binding = CONE_BUFFER) restrict readonly buffer Cones { Cone cones[]; };
layout(std430, binding = AIM_BUFFER) restrict readonly buffer Aims { Aim aims[]; };
layout(std430, binding = SPOT_BUFFER) restrict readonly buffer Spots { Spot spots[]; };
layout(std430, binding = GROUP_BUFFER) restrict readonly buffer Groups { uint groups[]; }; // as what each is reported
layout(std430, binding = KNOWN_BUFFER) restrict buffer Knowns { Known knowns[]; };
layout(std430, binding = ROW_BUFFER) restrict writeonly buffer Rows { Row rows[]; };
layout(std430, binding = HEAD_BUFFER) restrict buffer Heads
{
    uint row_count, unused;
    uvec2 heads[]; // of each part: its first row, and how many
};

layout(location = 2) uniform uint ray_count; // of a cone
layout(location = 3) uniform bool has_known; // volumes before this one
layout(location = 4) uniform bool is_last;   // and none after it
layout(location = 5) uniform dmat4 index_from_world;

const uint KEYS = 2u * uint(GROUP);
const uint BORDER = 0x80000000u;
const uint NOTHING = 0xffffffffu; // no key, no voxel; as an object VOLUME_BLOCKER

shared uint ids[GROUP], owns[GROUP], voxels[GROUP];
shared uvec2 times[GROUP]; // doubles that are not negative: their bits are in their order
shared uint keys[KEYS], firsts[KEYS]; // a hash table of the objects: number, and its first pixel's rank
shared uint part_rows, first_row, leaders[GROUP]; // the first pixels, one after the other

// a * b - 1 without any error, where a * b is so near to 1 that a double holds it (Dekker 1971).
double excess(double a, double b)
{
    precise double a_scaled = 134217729.0lf * a; // 2^27 + 1 (Veltkamp)
    precise double b_scaled = 134217729.0lf * b;
    precise double a_high = a_scaled - (a_scaled - a);
    precise double b_high = b_scaled - (b_scaled - b);
    precise double a_low = a - a_high;
    precise double b_low = b - b_high;
    precise double product = a * b;
    precise double error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    precise double result = (product - 1.0lf) + error;
    return result;
}

// 1 / d rounded correctly, for |d| from 2^-900 to 2^900, by what GLSL promises: double +, - and * rounded correctly, a
// float's / within 2.5 units. No operand or partial product is a denormal.
double reciprocal(double d)
{
    uvec2 words = unpackDouble2x32(d);
    uint exponent = (words.y >> 20) & 0x7ffu;
    double m = packDouble2x32(uvec2(words.x, (words.y & 0xfffffu) | 0x3ff00000u)); // in [1, 2)
    double guess = double(1.0 / float(m));                                        // 2^-21
    precise double better = min(guess + guess * (1.0lf - m * guess), 1.0lf);      // 2^-42
    precise double y = min(better - better * excess(m, better), 1.0lf);           // half a unit, and 2^-30 of one
    // One of its neighbours may be nearer; 2^-53 is the unit of [1/2, 1), and below 1. No tie: 1 / m is no half unit.
    precise double twice = 2.0lf * excess(m, y);
    precise double unit = m * 1.1102230246251565e-16lf;
    if (twice > unit) {
        y -= 1.1102230246251565e-16lf;
    } else if (-twice > unit) {
        y += 1.1102230246251565e-16lf;
    }
    uvec2 made = unpackDouble2x32(y);
    return packDouble2x32(uvec2(made.x, (made.y - ((exponent - 1023u) << 20)) | (words.y & 0x80000000u)));
}

// As mat4_direction().
dvec3 into_index_space(dvec3 v)
{
    precise dvec3 sum = index_from_world[0].xyz * v.x + index_from_world[1].xyz * v.y + index_from_world[2].xyz * v.z;
    return sum;
}

// As mat4_point().
dvec3 place_in_index_space(dvec3 p)
{
    precise dvec3 sum = into_index_space(p) + index_from_world[3].xyz;
    return sum;
}

// As cone_rays_from(), cone_origin() and traverse_ray_init(), operation by operation.
Ray make_ray(Cone cone, Aim aim)
{
    dvec3 right = dvec3(cone.right_x, cone.right_y, cone.right_z);
    dvec3 up = dvec3(cone.up_x, cone.up_y, cone.up_z);
    dvec3 back = dvec3(cone.back_x, cone.back_y, cone.back_z);
    dvec3 start = dvec3(cone.apex_x, cone.apex_y, cone.apex_z);
    precise dvec3 world = right * aim.right + up * aim.up - back * aim.forward;
    if (cone.radius > 0.0lf) {
        precise double u = aim.u * cone.radius, v = aim.v * cone.radius;
        precise dvec3 beside = start + u * right;
        precise dvec3 above = beside + v * up;
        start = above;
    }
    dvec3 origin = place_in_index_space(start);
    dvec3 direction = into_index_space(world);
    bvec3 moves = greaterThanEqual(abs(direction), dvec3(1.1830521861667747e-271lf)); // 2^-900
    dvec3 inverses = dvec3(reciprocal(direction.x), reciprocal(direction.y), reciprocal(direction.z));
    origin = mix(cell_of(origin), origin, moves);
    direction = mix(dvec3(0.0lf), direction, moves);
    inverses = mix(dvec3(NEVER), inverses, moves);
    dvec3 signs = mix(dvec3(1.0lf), dvec3(-1.0lf), lessThan(direction, dvec3(0.0lf)));
    return Ray(origin, direction, inverses, signs, all(lessThan(abs(origin), dvec3(FAR))) ? 0.5lf - NEAR : -1.0lf);
}

// What the ray hits first in this volume and those before; of equally near objects the one with the lower number.
Known find_hit(Ray ray, uint number)
{
    Known known = Known(NEVER, 0u, NOTHING);
    if (has_known) {
        known = knowns[number];
    }
    Hit hit = walk(ray, known.t);
    bool is_nearer = hit.id != 0u && (hit.place.t < known.t || hit.id < known.id);
    uvec3 cell = uvec3(hit.place.cell), dim = uvec3(textureSize(objects, 0));
    if (is_nearer) {
        known = Known(hit.place.t, hit.id, cell.x + dim.x * (cell.y + dim.y * cell.z));
    }
    return known;
}

// Notes that an object has a pixel, the one with that rank.
void enter_object(uint id, uint rank)
{
    uint at = (id * 2654435761u) % KEYS;
    for (;;) {
        uint known = atomicCompSwap(keys[at], NOTHING, id);
        if (known == NOTHING || known == id) {
            break;
        }
        at = (at + 1u) % KEYS;
    }
    atomicMin(firsts[at], rank);
}

// Puts the hit where its pixel's rank is. What blocks is nothing, as in evidence_drop_blocked().
void enter_hit(Known known, uint rank)
{
    bool is_object = known.id != 0u && known.id != NOTHING;
    uvec2 t = unpackDouble2x32(is_object ? known.t : NEVER);
    uint own = is_object ? known.id : 0u;
    uint id = groups[own];
    times[rank] = uvec2(t.x, t.y & 0x7fffffffu); // -0 becomes 0
    ids[rank] = id;
    owns[rank] = own;
    voxels[rank] = is_object ? known.voxel : NOTHING;
    enter_object(id, rank);
}

bool is_less(uvec2 a, uvec2 b)
{
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

// The row of the object whose first pixel is `first`, pixel after pixel as add_run() of statistics.c.
Row gather(uint first, uint count, uint first_spot)
{
    uint id = ids[first], pixels = 0u, contact = first, square = NOTHING, border = 0u;
    uvec2 contact_t = uvec2(0u, 0x7ff00000u), nearest = uvec2(0u, 0x7ff00000u);
    precise double weight = 0.0lf;
    for (uint k = first; k < count; k++) {
        if (ids[k] == id) {
            Spot spot = spots[first_spot + k];
            uvec2 t = times[k];
            if (spot.square < square || (spot.square == square && is_less(t, contact_t))) {
                contact = k;
                square = spot.square;
                contact_t = t;
            }
            nearest = is_less(t, nearest) ? t : nearest;
            weight += spot.weight;
            pixels++;
            border |= spot.pixel & BORDER;
        }
    }
    return Row(packDouble2x32(nearest), packDouble2x32(contact_t), weight, id, owns[contact], pixels,
               spots[first_spot + contact].pixel & ~BORDER, voxels[contact], border);
}

#if CHECK
layout(std430, binding = VALUE_BUFFER) restrict buffer Values { double values[]; };

void main()
{
    values[gl_GlobalInvocationID.x] = reciprocal(values[gl_GlobalInvocationID.x]);
}
#elif MAKE
struct MadeRay { // struct id_ray
    double origin[3], direction[3], inverse[3], unused;
};

layout(std430, binding = LIST_BUFFER) restrict readonly buffer List { uint list[]; }; // which rays: of all cones
layout(std430, binding = RAY_BUFFER) restrict writeonly buffer Made { MadeRay made_rays[]; };

layout(location = 6) uniform uint list_count;

void main()
{
    uint at = gl_GlobalInvocationID.x;
    if (at < list_count) {
        Cone cone = cones[list[at] / ray_count];
        Ray ray = make_ray(cone, aims[cone.shape * ray_count + list[at] % ray_count]);
        made_rays[at] = MadeRay(double[](ray.origin.x, ray.origin.y, ray.origin.z),
                                double[](ray.direction.x, ray.direction.y, ray.direction.z),
                                double[](ray.inverse.x, ray.inverse.y, ray.inverse.z), 0.0lf);
    }
}
#else
void main()
{
    uint slot = gl_LocalInvocationIndex, part = gl_WorkGroupID.y;
    uint number = part * uint(GROUP) + slot;
    uint count = min(ray_count - part * uint(GROUP), uint(GROUP));
    uint first_aim = cones[gl_WorkGroupID.x].shape * ray_count + part * uint(GROUP);
    if (slot == 0u) {
        part_rows = 0u;
    }
    for (uint i = slot; i < KEYS; i += uint(GROUP)) {
        keys[i] = firsts[i] = NOTHING;
    }
    barrier();
    if (slot < count) {
        uint ray = gl_WorkGroupID.x * ray_count + number;
        Aim aim = aims[first_aim + slot];
        Known known = find_hit(make_ray(cones[gl_WorkGroupID.x], aim), ray);
        if (is_last) {
            enter_hit(known, aim.rank);
        } else {
            knowns[ray] = known;
        }
    }
    barrier();
    for (uint i = slot; i < KEYS; i += uint(GROUP)) {
        if (keys[i] != NOTHING) {
            leaders[atomicAdd(part_rows, 1u)] = firsts[i];
        }
    }
    barrier();
    if (slot == 0u && is_last) {
        first_row = atomicAdd(row_count, part_rows);
        heads[gl_WorkGroupID.x * gl_NumWorkGroups.y + part] = uvec2(first_row, part_rows);
    }
    barrier();
    // By neighbours, which work in step. A row that has no place shows in row_count.
    if (slot < part_rows && first_row + slot < uint(rows.length())) {
        rows[first_row + slot] = gather(leaders[slot], count, first_aim);
    }
}
#endif
