// The walk of the colour pass where something is translucent: surfaces of areas and meshes that transmit light, and
// pathways as haze (Eq. 8). It follows colour.frag.glsl. Between two planes the ray is cut where a surface begins, so
// that haze lies before and behind it in the right lengths.

layout(binding = 8) uniform sampler3D haze_field; // linear R, G, B times extinction; extinction per mm
layout(binding = 9) uniform sampler2DArray layer_surface; // normal in world axes, depth; 0 = nothing
layout(binding = 10) uniform usampler2DArray layer_object;
layout(std430, binding = 2) readonly buffer Opacities
{
    float opacities[]; // per object; 0: of the surface that has a map
};

const int SEEN = 16; // translucent areas along one ray
const float OUTLINE_OPACITY = 0.8; // of surfaces around the areas
const float LEAST_GRADIENT = 0.25; // of the stored gradient (colour.h)
const float EDGE = 0.3; // cosine between normal and view

bool lies_in(vec3 place)
{
    return place == clamp(place, 0.0, 1.0);
}

// Context and haze from depth `from` to `to`, sampled in the middle.
void blend_haze(inout vec4 sum, Track context, Track haze, float from, float to, float per_depth)
{
    float mm = (to - from) * per_depth;
    vec3 place = place_on(context, 0.5 * (from + to));
    if (CONTEXT == 1 && context.first < NEVER && lies_in(place)) {
        blend(sum, context_sample(place, mm));
    }
    place = place_on(haze, 0.5 * (from + to));
    if (HAZE == 1 && haze.first < NEVER && lies_in(place)) {
        vec4 texel = textureLod(haze_field, place, 0.0);
        float opacity = 1.0 - exp2(-texel.a * mm);
        blend(sum, vec4(texel.rgb / max(texel.a, 1e-9) * opacity, opacity));
    }
}

// Whether the place is in an area. `is_clear`: it is outside all, or its nearest voxel is that of `before`, an area.
bool find_area(out bool is_clear, Track areas, vec3 place, uint before)
{
    bool found = areas.first < NEVER && lies_in(place) && shows_area(place);
    ivec3 size = textureSize(area_objects, 0);
    ivec3 nearest = clamp(ivec3(place * vec3(size)), ivec3(0), size - 1);
    is_clear = !found || before != 0u && texelFetch(area_objects, nearest, 0).x == before;
    return found;
}

// The object of an area at a place in one, 0 if it is not visible.
uint visible_at(vec3 place)
{
    uint object = object_at(place);
    return opacities[object] > 0.0 ? object : 0u;
}

// The depth at which the object begins that is found at `inside` and not at `outside`; 0 = any area.
float object_depth(Track areas, uint object, float outside, float inside)
{
    for (int n = 0; n < 6; n++) {
        float middle = 0.5 * (outside + inside);
        vec3 place = place_on(areas, middle);
        bool found = lies_in(place) && shows_area(place) && (object == 0u || object_at(place) == object);
        inside = found ? middle : inside;
        outside = found ? outside : middle;
    }
    return inside;
}

// The fraction of the eight voxels around `place`, by their weights, that is the object's.
float weight_of(uint object, vec3 place)
{
    ivec3 size = textureSize(area_objects, 0);
    vec3 corner = place * vec3(size) - 0.5;
    ivec3 base = ivec3(floor(corner));
    vec3 part = corner - vec3(base);
    float sum = 0.0;
    for (int n = 0; n < 8; n++) {
        ivec3 step_ = ivec3(n & 1, n >> 1 & 1, n >> 2);
        vec3 w = mix(1.0 - part, part, vec3(step_));
        bool own = texelFetch(area_objects, clamp(base + step_, ivec3(0), size - 1), 0).x == object;
        sum += own ? w.x * w.y * w.z : 0.0;
    }
    return sum;
}

// The normal of the border between two objects, in world axes: their occupancy has no gradient there. Borders mostly lie
// along the ray, so that they would be dark: they are lit as if turned towards the eye.
vec3 border_normal(uint object, vec3 place, vec3 view)
{
    vec3 reach = 1.5 / vec3(textureSize(area_objects, 0));
    vec3 x = vec3(reach.x, 0.0, 0.0), y = vec3(0.0, reach.y, 0.0), z = vec3(0.0, 0.0, reach.z);
    vec3 gradient = vec3(weight_of(object, place + x) - weight_of(object, place - x),
                         weight_of(object, place + y) - weight_of(object, place - y),
                         weight_of(object, place + z) - weight_of(object, place - z)) / reach;
    gradient = mat3(world_from_camera) * (transpose(mat3(areas_from_camera)) * gradient);
    return normalize(-gradient / max(length(gradient), 1e-6) - view);
}

// Surfaces on the ray in closed form, or drawn before: walls of the cone, and layers of meshes.
struct Events {
    Surface near, far; // walls
    int layer;         // the next one
    float layer_depth;
};

void next_layer(inout Events events, int layer)
{
    float depth = layer < counts.z ? texelFetch(layer_surface, ivec3(gl_FragCoord.xy, layer), 0).w : 0.0;
    events.layer = layer;
    events.layer_depth = depth > 0.0 ? depth : NEVER;
}

void next_wall(inout Events events)
{
    events.near = events.far;
    events.far.depth = NEVER;
}

float event_depth(Events events)
{
    return min(events.near.depth, events.layer_depth);
}

// 1 where glass is seen edge on, 0 where it faces the eye more than EDGE says.
float outline_of(vec3 normal, vec3 view)
{
    return 1.0 - smoothstep(0.5 * EDGE, EDGE, abs(dot(normal, view)));
}

void blend_surface(inout vec4 sum, vec3 colour_, float opacity)
{
    blend(sum, vec4(colour_ * opacity, opacity));
}

// Blends the next event and goes on to the one after it.
void take_event(inout vec4 sum, inout Events events, vec3 direction, vec3 view)
{
    if (events.near.depth <= events.layer_depth) {
        blend(sum, events.near.colour);
        next_wall(events);
    } else {
        ivec3 texel = ivec3(gl_FragCoord.xy, events.layer);
        uint object = texelFetch(layer_object, texel, 0).x;
        vec3 normal = texelFetch(layer_surface, texel, 0).xyz;
        float opacity = opacities[(object & TUBE_OWN_COLOUR) != 0u ? 0u : object];
        vec3 shade = object_colour(object, normal, direction, view, events.layer_depth);
        float outline = entry_of(object).a > 2.5 ? outline_of(normal, view) : 0.0;
        blend_surface(sum, mix(shade, look(LOOK_GLASS_EDGE), outline), mix(opacity, max(opacity, OUTLINE_OPACITY), outline));
        next_layer(events, events.layer + 1);
    }
}

float end_of(Track track)
{
    return track.end < NEVER ? track.end : 0.0;
}

// How far a ray has come.
struct Walk {
    float plane, known; // the next plane; those before `known` are in the same bricks
    float depth;        // up to which all is blended
    uint before;        // the area at the plane before
    bool shows;         // something may be visible at the next plane
    bool enters, stops; // it comes to an area, or to an event or the ray's last depth
    uint object;        // the area at that plane
    float t;            // its depth
};

// Whether the walk passes an event or the ray's end on its way to depth t.
bool stops_before(float t, float event, float last)
{
    return event < NEVER && event <= t || t >= last;
}

// Leaps to the plane before the next one at which anything may be visible.
void leap(inout Walk walk, Track context, Track areas, Track haze, float end, float event, float last)
{
    while (!walk.shows && !walk.stops) {
        float plane = walk.plane;
        bool each = planes.w == 0.0 || is_on(haze, plane);
        bool shows = each;
        float known = look_ahead_both(context, areas, plane, shows);
        walk.shows = shows && plane < end;
        walk.known = min(!each ? known : planes.w == 0.0 ? end : haze.end, end);
        known = plane < haze.first ? min(known, haze.first) : known;
        float next = max(min(known, end) - 1.0, plane);
        walk.t = plane < end ? min(depth_of(next), last) : last;
        walk.stops = !walk.shows && stops_before(walk.t, event, last);
        if (!walk.shows && !walk.stops) {
            walk.depth = walk.t;
            walk.before = 0u;
            walk.plane = next + 1.0;
        }
    }
}

// Goes on to the next plane, from one at which no other area begins.
void pass_plane(inout Walk walk, inout vec4 sum, uint object, Track context, Track haze, float per_depth)
{
    blend_haze(sum, context, haze, walk.depth, walk.t, per_depth);
    walk.depth = walk.t;
    walk.before = object;
    walk.plane += 1.0;
    walk.shows = walk.plane < walk.known;
}

uint seen[SEEN]; // areas that the ray has come to
int seen_count = 0;

bool is_seen(uint object)
{
    bool found = seen_count == SEEN;
    for (int n = 0; n < seen_count; n++) {
        found = found || seen[n] == object;
    }
    return found;
}

// The depth at which the walk enters an area. From outside of all it is the one that the surface has there, which need
// not be that of the plane behind: else borders on a surface have teeth as wide as planes are apart.
float entry_depth(inout Walk walk, Track areas)
{
    vec3 place = place_on(areas, walk.depth);
    if (walk.before == 0u && !(lies_in(place) && shows_area(place))) {
        float depth = object_depth(areas, 0u, walk.depth, walk.t);
        uint object = visible_at(place_on(areas, depth));
        if (object != 0u && !is_seen(object)) {
            walk.object = object;
            return depth;
        }
    }
    return object_depth(areas, walk.object, walk.depth, walk.t);
}

// Adds the part of the cone that shines through the surface at the ray's end, or lies behind what the ray passed.
vec4 with_rest(vec4 sum, Events events, Surface solid, bool is_hit)
{
    vec4 rest = vec4(0.0);
    while (events.near.depth < solid.depth) {
        blend(rest, events.near.colour);
        next_wall(events);
    }
    blend(rest, solid.colour);
    return is_hit ? mix(sum, vec4(rest.rgb / max(rest.a, 1e-6), 1.0), GHOST * rest.a) : sum + (1.0 - sum.a) * rest;
}

// The loops are nested for the reason that colour.frag.glsl gives: all pixels in step leap, then pass planes with one
// look at the field, then those that are near a border look at it, and then those that come to a surface shade it.
void main()
{
    skip_tiles();
    vec3 direction = vec3(((gl_FragCoord.xy + line.zw) / lens.zw * 2.0 - 1.0) * lens.xy + middle.xy, -1.0);
    vec3 view = normalize(mat3(world_from_camera) * direction);
    Events events;
    Surface solid = Surface(NEVER, vec4(0.0));
    find_walls(events.near, events.far, direction);
    next_layer(events, 0);
    hit_axis(solid, direction, view);
    hit_markers(solid, direction, view);

    float mesh = mesh_depth();
    float last = min(solid.depth, mesh);
    Track context = make_track(context_from_camera, context_bricks.w, direction);
    Track areas = make_track(areas_from_camera, areas_bricks.w, direction);
    Track haze = make_track(haze_from_camera, haze_shape.w, direction);
    float per_depth = length(direction);
    float end = max(max(end_of(context), end_of(areas)), end_of(haze));
    float plane = min(min(context.first, areas.first), haze.first);
    Walk walk;
    walk.plane = plane;
    walk.depth = plane < end ? depth_of(plane - 1.0) : 0.0;
    walk.before = 0u;
    float hit = NEVER;
    vec4 sum = vec4(0.0);
    bool ends = false;
    while (hit == NEVER && sum.a < OPAQUE && !ends) {
        float event = event_depth(events);
        walk.shows = walk.enters = walk.stops = false;
        while (!walk.enters && !walk.stops && sum.a < OPAQUE) {
            bool is_clear = true;
            bool found = false;
            while (is_clear && !walk.stops && sum.a < OPAQUE) {
                leap(walk, context, areas, haze, end, event, last);
                while (walk.shows && is_clear && !walk.stops && sum.a < OPAQUE) {
                    walk.t = min(depth_of(walk.plane), last);
                    found = find_area(is_clear, areas, place_on(areas, walk.t), walk.before);
                    walk.stops = stops_before(walk.t, event, last);
                    if (is_clear && !walk.stops) {
                        pass_plane(walk, sum, found ? walk.before : 0u, context, haze, per_depth);
                    }
                }
            }
            walk.object = !is_clear ? visible_at(place_on(areas, walk.t)) : found ? walk.before : 0u;
            walk.enters = !is_clear && walk.object != 0u && walk.object != walk.before && !is_seen(walk.object);
            if (!is_clear && !walk.enters && !walk.stops) {
                pass_plane(walk, sum, walk.object, context, haze, per_depth);
            }
        }
        if (!walk.enters && !walk.stops) {
            break;
        }
        float stop = walk.enters ? entry_depth(walk, areas) : walk.t;
        bool is_event = event < NEVER && event <= stop;
        stop = is_event ? event : stop;
        if (walk.shows && stop > walk.depth) {
            blend_haze(sum, context, haze, walk.depth, stop, per_depth);
        }
        walk.depth = stop;
        if (is_event) {
            take_event(sum, events, direction, view);
        } else if (walk.enters) {
            uint object = walk.object;
            vec3 place = place_on(areas, stop);
            vec4 field = textureLod(areas_field, place, 0.0); // hardly has a gradient at a border with an unseen area
            bool is_outer = walk.before == 0u && length(decode_gradient(field.xyz)) > LEAST_GRADIENT;
            vec3 normal = is_outer ? area_normal(field) : border_normal(object, place, view);
            blend_surface(sum, object_colour(object, normal, direction, view, stop), opacities[object]);
            hit = opacities[object] < 1.0 ? NEVER : stop;
            seen[seen_count++] = object;
            walk.before = object;
        } else {
            ends = true;
        }
    }
    if (hit == NEVER && mesh <= solid.depth && mesh < NEVER && sum.a < OPAQUE) {
        blend(sum, vec4(mesh_colour(direction, view, mesh), 1.0));
        hit = mesh;
    }
    colour = with_rest(sum, events, solid, hit < NEVER);
}
