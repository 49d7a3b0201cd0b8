/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The walk of traverse_pierce() for LANES rays at a time, beside that of traverse_lanes.h. Its source also defines
 * PIERCE, the function's name. * Rays go from box to box of one object. Where the colour changes, or where there is
 * none, the lane's entry into the voxel is noted as an event. Objects are looked up later, when many events are dealt
 * to their rays, so that nothing waits for memory. */
#include "selection/engine/voxels/traverse_lanes.h"

enum { EVENTS = 1024, FETCHED_AHEAD = 24, NO_VOXEL = -1 };

static const uint32_t NO_PIXEL = UINT32_MAX;

/* Where rays come into cells, in the order in which each ray does; lanes behind the last one are written, too. */
struct events {
    size_t count;
    int32_t slot[EVENTS + LANES];
    int32_t voxel[EVENTS + LANES]; /* NO_VOXEL: nothing there      */
    float cell[3][EVENTS + LANES]; /* as in struct walk            */
    double t[EVENTS + LANES];      /* find_times()                 */
};

struct piercing {
    struct traverse_piercing *all;
    conus_interval begun[TRAVERSE_BUNDLE];          /* the intervals of its rays that have begun; object 0: none */
    alignas(64) int32_t kind[TRAVERSE_BUNDLE];      /* what of their codes is not the radius                     */
    alignas(64) double inverse[3][TRAVERSE_BUNDLE]; /* INFINITY where a ray does not move */
    struct events events;
};

/* The ray enters a voxel of `object`: ends the interval that it has begun, and begins the next. There is memory for
 * both. The exit is written there only: copying what was just written in pieces would stall. */
static INLINE void change_object(struct piercing *piercing, size_t slot, double t, uint32_t object, int32_t voxel)
{
    struct layers *out = piercing->all->out;
    conus_interval *begun = &piercing->begun[slot];
    out->intervals[out->count] = (conus_interval){begun->pixel, begun->object, begun->entry, t, begun->voxel};
    out->count += begun->object != 0;
    begun->object = object;
    begun->entry = t;
    begun->voxel = object ? (uint64_t)voxel : 0;
}

/* The entries into cells of rays that begin at `start`: the last crossing of a face towards each. */
static INLINE doubles entry_into_cell(const doubles start[3], const doubles cell[3], const doubles inverse[3])
{
    doubles t = all_doubles(0);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        doubles half = choose_doubles(less_doubles(all_doubles(0), inverse[a]), all_doubles(0.5), all_doubles(-0.5));
        halves moves = less_doubles(inverse[a], all_doubles(INFINITY));
        doubles entry = ((cell[a] - half) - start[a]) * inverse[a];
        t = choose_doubles(moves & less_doubles(t, entry), entry, t);
    }
    return t;
}

/* Computes when rays enter the cells of the events, side by side for any rays. */
static void find_times(struct piercing *piercing, const struct walk *walk)
{
    struct events *events = &piercing->events;
    const struct traverse_bundle *bundle = walk->bundle;
    store_wholes(events->slot + events->count, all_wholes(0)); /* of a ray, too */
    for (size_t i = 0; i < events->count; i += HALF) {
        doubles start[3], cell[3], inverse[3];
        EACH_AXIS
        for (int a = 0; a < 3; a++) {
            start[a] =
                bundle->is_apart ? doubles_from(bundle->starts[a], events->slot + i) : all_doubles(bundle->start[a]);
            cell[a] = load_as_doubles(events->cell[a] + i) + (double)walk->middle[a];
            inverse[a] = doubles_from(piercing->inverse[a], events->slot + i);
        }
        store_doubles(events->t + i, entry_into_cell(start, cell, inverse));
    }
}

/* Gives the events to their rays. */
static conus_status deal_events(struct piercing *piercing, const struct walk *walk)
{
    const struct volume *volume = piercing->all->volume;
    struct events *events = &piercing->events;
    conus_status status = layers_reserve(piercing->all->out, events->count + 1);
    find_times(piercing, walk);
    for (size_t i = 0; i < events->count && !status; i++) {
        int32_t voxel = events->voxel[i];
        size_t slot = (size_t)events->slot[i];
        size_t ahead = i + FETCHED_AHEAD < events->count ? i + FETCHED_AHEAD : i;
        volume_fetch(volume, events->voxel[ahead] == NO_VOXEL ? 0 : (size_t)events->voxel[ahead]);
        uint32_t object = voxel == NO_VOXEL ? 0 : volume_occupant(volume, (size_t)voxel);
        if (object != piercing->begun[slot].object) {
            change_object(piercing, slot, events->t[i], object, voxel);
        }
    }
    events->count = 0;
    return status;
}

/* There is room for a packet's events, always. */
static INLINE conus_status make_room(struct piercing *piercing, const struct walk *walk)
{
    return piercing->events.count + LANES > EVENTS ? deal_events(piercing, walk) : CONUS_OK;
}

static INLINE void add_events(const struct walk *walk, struct piercing *piercing, size_t slot, truths changed,
                              truths full)
{
    const int32_t columns = (int32_t)walk->map->dim[0];
    const int32_t rows = (int32_t)walk->map->dim[1];
    struct events *events = &piercing->events;
    wholes x = wholes_from_singles(singles_at(walk->cell[0] + slot)) + walk->middle[0];
    wholes y = wholes_from_singles(singles_at(walk->cell[1] + slot)) + walk->middle[1];
    wholes z = wholes_from_singles(singles_at(walk->cell[2] + slot)) + walk->middle[2];
    wholes voxel = x + columns * (y + rows * z);
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        keep_singles(events->cell[a] + events->count, changed, singles_at(walk->cell[a] + slot));
    }
    keep_wholes(events->slot + events->count, changed, lane_numbers() + (int32_t)slot);
    events->count +=
        keep_wholes(events->voxel + events->count, changed, choose_wholes(full, voxel, all_wholes(NO_VOXEL)));
}

/* The ray comes into a cell that is out of the box. */
static void add_end(struct piercing *piercing, const struct walk *walk, size_t slot, const double cell[3])
{
    struct events *events = &piercing->events;
    events->slot[events->count] = (int32_t)slot;
    events->voxel[events->count] = NO_VOXEL;
    for (int a = 0; a < 3; a++) {
        events->cell[a][events->count] = (float)(cell[a] - walk->middle[a]);
    }
    events->count++;
}

static void cell_of(double cell[3], const struct walk *walk, size_t slot)
{
    for (int a = 0; a < 3; a++) {
        cell[a] = walk->cell[a][slot] + (double)walk->middle[a];
    }
}

/* The ray leaves the box of that radius in double; false where it is out then. */
static bool leave_in_double(struct walk *walk, struct piercing *piercing, size_t slot, int radius)
{
    struct traverse_ray ray = traverse_bundle_at(walk->bundle, slot);
    struct traverse_place at;
    cell_of(at.cell, walk, slot);
    if (!traverse_skip(walk->map, &ray, radius, &at)) {
        add_end(piercing, walk, slot, at.cell);
        return false;
    }
    for (int a = 0; a < 3; a++) {
        walk->cell[a][slot] = (float)(at.cell[a] - walk->middle[a]);
    }
    return true;
}

static INLINE void settle_again(struct walk *walk, size_t slot)
{
    const singles cell[3] = {singles_at(walk->cell[0] + slot), singles_at(walk->cell[1] + slot),
                             singles_at(walk->cell[2] + slot)};
    settle(walk, slot, cell);
}

/* Unclear lanes leave the box in double, and are clear again then. */
static conus_status clear_up(struct walk *walk, struct piercing *piercing, size_t packet, wholes radii)
{
    conus_status status = make_room(piercing, walk);
    for (int l = 0; l < LANES && !status; l++) {
        if (is_true(walk->unclear[packet], l) &&
            leave_in_double(walk, piercing, packet * LANES + (size_t)l, radii[l] - 1)) {
            walk->live[packet] |= only(l);
        }
    }
    walk->unclear[packet] = none();
    settle_again(walk, packet * LANES);
    return status;
}

/* Live lanes leave the box in which all is the same. Before, they note what they are in, if it is something else than
 * before. Without a colour it may be where the box is one cell, at a border. */
static INLINE conus_status pierce_on(struct walk *walk, struct piercing *piercing, size_t packet)
{
    size_t slot = packet * LANES;
    wholes codes = bytes_at(walk->codes, walk->at + slot);
    truths full = is_zero(codes & UNIFORM_EMPTY);
    wholes radii = codes & choose_wholes(full, all_wholes(UNIFORM_RADIUS), all_wholes(UNIFORM_EMPTY_RADIUS));
    wholes kind = codes & choose_wholes(full, all_wholes(UNIFORM_COLOUR), all_wholes(UNIFORM_EMPTY));
    truths same =
        is_zero(kind ^ wholes_at(piercing->kind + slot)) & ~(is_zero(kind ^ UNIFORM_NO_COLOUR) & is_zero(radii - 1));
    truths changed = walk->live[packet] & ~same;
    conus_status status = CONUS_OK;
    if (any(changed)) {
        status = make_room(piercing, walk);
        add_events(walk, piercing, slot, changed, full);
        store_wholes(piercing->kind + slot, kind);
    }
    leave(walk, packet, radii, walk->live[packet]);
    if (any(walk->unclear[packet]) && !status) {
        status = clear_up(walk, piercing, packet, radii);
    }
    return status;
}

static bool is_in_box(const struct walk *walk, size_t slot)
{
    double cell[3];
    bool inside = true;
    cell_of(cell, walk, slot);
    for (int a = 0; a < 3; a++) {
        inside = inside && cell[a] >= walk->map->first[a] && cell[a] <= walk->map->last[a];
    }
    return inside;
}

/* Rays that are unclear where they come in, or start on a face of the box, are for traverse_pierce(). */
static void put_off_unclear(struct walk *walk, bool again[TRAVERSE_BUNDLE])
{
    for (size_t slot = 0; slot < walk->bundle->count; slot++) {
        size_t packet = slot / LANES;
        int lane = (int)(slot % LANES);
        bool on_face = is_true(walk->live[packet], lane) && !is_in_box(walk, slot);
        again[slot] = on_face || is_true(walk->unclear[packet], lane);
        walk->live[packet] &= ~(on_face ? only(lane) : none());
    }
    for (size_t packet = 0; packet * LANES < walk->bundle->count; packet++) {
        walk->unclear[packet] = none();
    }
}

/* Drops the intervals, from number `first` on, of rays that only fill a packet. */
static void drop_fillers(struct layers *out, size_t first)
{
    size_t kept = first;
    for (size_t i = first; i < out->count; i++) {
        if (out->intervals[i].pixel != NO_PIXEL) {
            out->intervals[kept++] = out->intervals[i];
        }
    }
    out->count = kept;
}

static void piercing_init(struct piercing *piercing, const struct walk *walk, struct traverse_piercing *all)
{
    piercing->all = all;
    for (size_t slot = 0; slot < walk->bundle->count; slot += HALF) {
        for (int a = 0; a < 3; a++) {
            doubles inverse = 1 / doubles_at(walk->exact[a] + slot);
            halves moves = less_doubles(magnitude_of_doubles(inverse), all_doubles(INFINITY));
            store_doubles(piercing->inverse[a] + slot, choose_doubles(moves, inverse, all_doubles(INFINITY)));
        }
    }
    piercing->events.count = 0;
    for (uint32_t slot = 0; slot < TRAVERSE_BUNDLE; slot++) {
        piercing->begun[slot] = (conus_interval){.pixel = slot < all->count ? (uint32_t)all->pixel[slot] : NO_PIXEL};
        piercing->kind[slot] = UNIFORM_EMPTY;
    }
}

conus_status PIERCE(struct traverse_piercing *all, struct traverse_bundle *bundle)
{
    struct walk walk;
    struct piercing piercing;
    uint8_t under_way[PACKETS];
    size_t first = all->out->count;
    conus_status status = CONUS_OK;
    if (!walk_init(&walk, all->uniform, bundle)) {
        memset(all->again, 0, sizeof all->again);
        return CONUS_OK;
    }
    piercing_init(&piercing, &walk, all);
    size_t count = enter_all(&walk, under_way);
    put_off_unclear(&walk, all->again);
    while (count > 0 && !status) {
        size_t left = 0;
        for (size_t i = 0; i < count && !status; i++) {
            size_t packet = under_way[i];
            status = pierce_on(&walk, &piercing, packet);
            under_way[left] = (uint8_t)packet;
            left += any(walk.live[packet]);
        }
        count = left;
    }
    status = status ? status : deal_events(&piercing, &walk);
    if (bundle->count > all->count) {
        drop_fillers(all->out, first);
    }
    return status;
}
