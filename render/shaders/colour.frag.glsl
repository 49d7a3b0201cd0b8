// The colour pass (Eq. 8): areas, context volume and cone in one walk along the ray, front to back, on planes that
// are perpendicular to the view axis (Eq. 7). All positions are in camera space (mm, looking down -z) and t is the depth
// of a plane, so a ray is t * direction with direction.z = -1.
//
// Parts that an atlas lacks are left out (AREAS, CONTEXT): a machine that runs both sides of every branch would look
// them up for every sample.

layout(std140, binding = 0) uniform View
{
    mat4 context_from_camera; // texture coordinates, 0 to 1 over the grid
    mat4 areas_from_camera;
    mat4 world_from_camera; // rotation
    vec4 context_bricks;    // xyz: bricks along the edges, with the fraction; w: 1 where there is a context
    vec4 areas_bricks;      // likewise
    vec4 lens;              // xy: half the picture at depth 1; zw: pixels
    vec4 middle;            // xy: of the picture, at depth 1
    vec4 planes;            // x: depth where the range begins; y: spacing; z: count; w: 1 to skip empty bricks
    vec4 light;             // xyz: towards the light, in world axes; w: how much of the context's extinction is left
    vec4 apex;              // xyz: the cone's; w: tangent of half its angle
    vec4 axis;              // xyz: along it, unit length; w: its length, mm
    vec4 cone_shape;        // x: its radius at the apex, mm; y: depth at which it begins; z: its reach; w: 0 = no cone
    vec4 cone_colour;       // of walls and axis; w: a wall's opacity
    vec4 line;              // x: radius of the axis, y: half the width of the rim and the footprint's outline, mm;
                            // zw: shift of the rays from the pixels' centres, pixels
    ivec4 counts;           // x: markers; y: 1 where there are meshes; z: layers of translucent ones; w: 1 to draw only tiles
    vec4 markers[MARKER_LIMIT]; // xyz: centre, w: radius
    vec4 marker_colours[MARKER_LIMIT];
    mat4 haze_from_camera;
    vec4 haze_shape; // w: 1 where there is haze
    vec4 pale;       // of what is pale; w: 0 = paler than its own
};

layout(binding = 0) uniform sampler3D context_field;  // gradient, density
layout(binding = 1) uniform usampler3D context_empty; // distance to the next brick that shows
layout(binding = 2) uniform sampler3D transfer;       // linear R, G, B; extinction per mm
layout(binding = 3) uniform sampler3D areas_field;
layout(binding = 4) uniform usampler3D areas_empty;
layout(binding = 5) uniform usampler3D area_objects;
layout(binding = 6) uniform sampler2D mesh_surface; // normal in world axes, depth; 0 = nothing
layout(binding = 7) uniform usampler2D mesh_object;
layout(std430, binding = 0) readonly buffer Palette
{
    vec4 palette[]; // per object: linear R, G, B; its emphasis: 0 pale, 1 full, 2 hatched, 3 glass
};

#if SLICES
layout(location = 0) flat in float slice; // number of the plane that is drawn
#endif
layout(std430, binding = TILE_BUFFER) readonly buffer Tiles
{
    uint tiles[]; // with counts.w those of the picture, row by row: 0 = not to be drawn
};
layout(location = 0) out vec4 colour; // linear radiance times opacity, opacity

const uint TUBE_OWN_COLOUR = 0x80000000u; // as in id_pass.h
const uint TUBE_PALE = 0x40000000u;
const float OPAQUE = 0.995;
const float GHOST = 0.3; // how much the cone, its axis and the markers show through areas before them
const float HATCH = 8.0; // pixels from stripe to stripe
const float SILHOUETTE = 0.35; // what is left of the light where a surface is seen from its side
const float NEAR = 0.1; // mm before the eye
const float NEVER = 1e9;
const float SURFACE = (float(FIELD_SURFACE) - 0.5) / 255.0;

// Ends the pixels that are not to be drawn.
void skip_tiles()
{
    ivec2 tile = ivec2(gl_FragCoord.xy) / TILE;
    if (counts.w != 0 && tiles[tile.y * ((int(lens.z) + TILE - 1) / TILE) + tile.x] == 0u) {
        discard;
    }
}

float min3(vec3 v)
{
    return min(v.x, min(v.y, v.z));
}

float max3(vec3 v)
{
    return max(v.x, max(v.y, v.z));
}

float depth_of(float plane)
{
    return planes.x + (plane + 0.5) * planes.y;
}

float plane_after(float depth)
{
    return ceil((depth - planes.x) / planes.y - 0.5);
}

struct Track {
    vec3 from, along, inverse; // at depth t: from + t * along
    float first, end;          // planes first, first + 1, ... end - 1 lie in the volume
};

Track make_track(mat4 from_camera, float is_there, vec3 direction)
{
    Track track;
    track.from = from_camera[3].xyz;
    track.along = mat3(from_camera) * direction;
    track.along = mix(track.along, vec3(1e-9), lessThan(abs(track.along), vec3(1e-9)));
    track.inverse = 1.0 / track.along;
    vec3 a = -track.from * track.inverse;
    vec3 b = (1.0 - track.from) * track.inverse;
    track.first = max(plane_after(max(max3(min(a, b)), NEAR)), 0.0);
    track.end = min(plane_after(min3(max(a, b))), planes.z);
    if (is_there == 0.0 || track.first >= track.end) {
        track.first = track.end = NEVER;
    }
    return track;
}

vec3 place_on(Track track, float depth)
{
    return track.from + depth * track.along;
}

bool is_on(Track track, float plane)
{
    return plane >= track.first && plane < track.end;
}

// The plane up to which the volume is empty or a brick may be visible, from `plane` on; `shows` is set for such a
// brick.
float look_ahead(Track track, usampler3D empty, vec3 bricks, float plane, inout bool shows)
{
    vec3 brick = clamp(floor(place_on(track, depth_of(plane)) * bricks), vec3(0.0), ceil(bricks) - 1.0);
    float gap = float(texelFetch(empty, ivec3(brick), 0).x);
    vec3 side = step(0.0, track.along) + sign(track.along) * max(gap - 1.0, 0.0);
    vec3 leave = ((brick + side) / bricks - track.from) * track.inverse;
    shows = shows || is_on(track, plane) && gap == 0.0;
    float until = plane < track.first ? track.first : plane < track.end ? plane_after(min3(leave)) : NEVER;
    return max(plane + 1.0, until);
}

float look_ahead_both(Track context, Track areas, float plane, inout bool shows)
{
    float known = NEVER;
#if AREAS
    known = look_ahead(areas, areas_empty, areas_bricks.xyz, plane, shows);
#endif
#if CONTEXT
    known = min(known, look_ahead(context, context_empty, context_bricks.xyz, plane, shows));
#endif
    return known;
}

vec3 decode_gradient(vec3 texel)
{
    return texel * (255.0 / 127.0) - 128.0 / 127.0;
}

float diffuse(vec3 normal)
{
    return max(dot(normal, light.xyz), 0.0);
}

// Context: colour and opacity by the transfer function over `mm` of the ray; shaded where there is a gradient.
vec4 context_sample(vec3 place, float mm)
{
    if (CONTEXT == 0) {
        return vec4(0.0);
    }
    vec4 field = textureLod(context_field, place, 0.0);
    vec4 entry = texelFetch(transfer, ivec3(int(field.a * float(TRANSFER_ENTRIES - 1) + 0.5), 0, 0), 0);
    if (entry.a == 0.0) {
        return vec4(0.0);
    }
    vec3 gradient = decode_gradient(field.xyz);
    float strength = length(gradient);
    float shade = 1.0 - strength + strength * (0.35 + 0.8 * diffuse(-gradient / max(strength, 1e-6)));
    float opacity = 1.0 - exp2(-entry.a * light.w * mm);
    return vec4(entry.rgb * shade * opacity, opacity);
}

// The object with the largest weight among the eight voxels around `place`.
uint object_at(vec3 place)
{
    vec3 size = vec3(textureSize(area_objects, 0));
    vec3 corner = place * size - 0.5;
    ivec3 base = ivec3(floor(corner));
    vec3 part = corner - vec3(base);
    uint objects[8];
    float weights[8];
    for (int n = 0; n < 8; n++) {
        ivec3 step_ = ivec3(n & 1, n >> 1 & 1, n >> 2);
        vec3 w = mix(1.0 - part, part, vec3(step_));
        objects[n] = texelFetch(area_objects, clamp(base + step_, ivec3(0), ivec3(size) - 1), 0).x;
        weights[n] = objects[n] == 0u ? 0.0 : w.x * w.y * w.z;
    }
    uint best = 0u;
    float most = -1.0;
    for (int n = 0; n < 8; n++) {
        float sum = 0.0;
        for (int m = 0; m < 8; m++) {
            sum += objects[m] == objects[n] ? weights[m] : 0.0;
        }
        bool wins = objects[n] != 0u && sum > most;
        best = wins ? objects[n] : best;
        most = wins ? sum : most;
    }
    return best;
}

// Distance of the point from the cone's wall, mm, negative inside; NEVER before the apex and beyond its reach.
float distance_to_cone(vec3 p)
{
    vec3 q = p - apex.xyz;
    float h = dot(q, axis.xyz);
    if (cone_shape.w == 0.0 || h <= cone_shape.y || h > cone_shape.z) {
        return NEVER;
    }
    return (length(q - h * axis.xyz) - cone_shape.x - h * apex.w) * inversesqrt(1.0 + apex.w * apex.w);
}

vec3 lit(vec3 albedo, vec3 normal, vec3 view)
{
    float highlight = pow(max(dot(normal, normalize(light.xyz - view)), 0.0), 30.0);
    return albedo * (0.30 + 0.75 * diffuse(normal)) + 0.06 * highlight;
}

vec3 linear_of(vec3 srgb)
{
    return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

// A colour of base/look.h.
vec3 look(int rgb)
{
    return linear_of(vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0);
}

// Colour and emphasis of an object or, of a streamline, what id_pass.h says: a colour of its own, or pale.
vec4 entry_of(uint number)
{
    bool own = (number & TUBE_OWN_COLOUR) != 0u;
    vec4 entry = own ? vec4(linear_of(unpackUnorm4x8(number).rgb), 1) : palette[number & ~TUBE_PALE];
    return (number & TUBE_PALE) != 0u ? vec4(entry.rgb, 0) : entry;
}

// Darkens a surface where it turns away from the eye, so that one of a single colour shows its shape.
float silhouette(vec3 normal, vec3 view)
{
    return mix(SILHOUETTE, 1.0, smoothstep(0.0, 0.5, abs(dot(normal, view))));
}

// The colour of a surface at depth t: pale where it is not emphasised, with the cone's footprint on the side that
// faces the apex.
vec3 object_colour(uint object, vec3 normal, vec3 direction, vec3 view, float t)
{
    vec4 entry = entry_of(object);
    bool stripe = mod(gl_FragCoord.x + gl_FragCoord.y, HATCH) < 0.5 * HATCH;
    float part = entry.a > 2.5 ? 1.0 : entry.a > 1.5 ? float(stripe) : entry.a;
    vec3 albedo = mix(pale.w > 0.0 ? pale.rgb : 0.16 * entry.rgb + 0.30, entry.rgb, part);
    albedo *= pale.w > 0.0 ? silhouette(normal, view) : 1.0;
    float wall = distance_to_cone(t * direction);
    bool faces = dot(normal, mat3(world_from_camera) * (t * direction - apex.xyz)) < 0.0;
    albedo = abs(wall) < line.y && faces ? cone_colour.rgb : albedo;
    return lit(albedo, normal, view);
}

vec3 area_normal(vec4 field)
{
    vec3 gradient = decode_gradient(field.xyz);
    return -gradient / max(length(gradient), 1e-6);
}

#if PLAIN_AREAS

// Areas as a single sample has them, without a look at its neighbours: what slices can show, for comparison.
uint nearest_object(vec3 place)
{
    return texelFetch(area_objects, ivec3(place * vec3(textureSize(area_objects, 0))), 0).x;
}

bool shows_area(vec3 place)
{
    return textureLod(areas_field, place, 0.0).a >= SURFACE && nearest_object(place) > 0u;
}

float area_depth(Track track, float t)
{
    return t;
}

vec3 area_colour(Track track, vec3 direction, vec3 view, float t)
{
    vec3 place = place_on(track, t);
    return lit(palette[nearest_object(place)].rgb, area_normal(textureLod(areas_field, place, 0.0)), view);
}

#else

bool shows_area(vec3 place)
{
    return AREAS == 1 && textureLod(areas_field, place, 0.0).a >= SURFACE;
}

// The depth at which the ray enters an area between the planes before and at depth t, refined, so that planes leave no
// rings.
float area_depth(Track track, float t)
{
    float outside = t - planes.y;
    float inside = t;
    if (!shows_area(place_on(track, outside))) {
        for (int n = 0; n < 6; n++) {
            float middle = 0.5 * (outside + inside);
            bool found = shows_area(place_on(track, middle));
            inside = found ? middle : inside;
            outside = found ? outside : middle;
        }
    }
    return inside;
}

vec3 area_colour(Track track, vec3 direction, vec3 view, float t)
{
    vec3 place = place_on(track, t);
    return object_colour(object_at(place), area_normal(textureLod(areas_field, place, 0.0)), direction, view, t);
}

#endif

float mesh_depth()
{
    float depth = counts.y == 0 ? 0.0 : texelFetch(mesh_surface, ivec2(gl_FragCoord.xy), 0).w;
    return depth > 0.0 ? depth : NEVER;
}

vec3 mesh_colour(vec3 direction, vec3 view, float t)
{
    uint object = texelFetch(mesh_object, ivec2(gl_FragCoord.xy), 0).x;
    return object_colour(object, texelFetch(mesh_surface, ivec2(gl_FragCoord.xy), 0).xyz, direction, view, t);
}

struct Surface {
    float depth;
    vec4 colour; // times opacity, as everywhere
};

// The cone's wall at depth t, if it is part of the cone that is drawn.
Surface wall_at(float t, vec3 direction)
{
    vec3 q = t * direction - apex.xyz;
    float h = dot(q, axis.xyz);
    Surface wall = Surface(NEVER, vec4(0.0));
    if (t > NEAR && h > cone_shape.y && h < axis.w) {
        vec3 normal = normalize(q - ((1.0 + apex.w * apex.w) * h + cone_shape.x * apex.w) * axis.xyz);
        float facing = abs(dot(normal, normalize(direction)));
        float opacity = min(cone_colour.a / max(facing, 0.08), 0.8);
        opacity = axis.w - h < 2.0 * line.y ? max(opacity, 0.5) : opacity;
        wall = Surface(t, vec4(cone_colour.rgb * opacity, opacity));
    }
    return wall;
}

void find_walls(out Surface near, out Surface far, vec3 direction)
{
    near = far = Surface(NEVER, vec4(0.0));
    if (cone_shape.w == 0.0) {
        return;
    }
    float k = 1.0 + apex.w * apex.w;
    float dh = dot(direction, axis.xyz);
    float h = -dot(apex.xyz, axis.xyz);
    float a = dot(direction, direction) - k * dh * dh;
    float b = -dot(direction, apex.xyz) - (k * h + cone_shape.x * apex.w) * dh;
    float c = dot(apex.xyz, apex.xyz) - (k * h + 2.0 * cone_shape.x * apex.w) * h - cone_shape.x * cone_shape.x;
    float root = b * b - a * c;
    if (root <= 0.0 || abs(a) < 1e-9) {
        return;
    }
    root = sqrt(root);
    Surface one = wall_at((-b - root) / a, direction);
    Surface two = wall_at((-b + root) / a, direction);
    if (one.depth <= two.depth) {
        near = one;
        far = two;
    } else {
        near = two;
        far = one;
    }
}

void hit_axis(inout Surface solid, vec3 direction, vec3 view)
{
    vec3 d = direction - dot(direction, axis.xyz) * axis.xyz;
    vec3 q = -apex.xyz + dot(apex.xyz, axis.xyz) * axis.xyz;
    float a = dot(d, d);
    float b = dot(d, q);
    float root = b * b - a * (dot(q, q) - line.x * line.x);
    if (cone_shape.w == 0.0 || root <= 0.0 || a < 1e-9) {
        return;
    }
    float t = (-b - sqrt(root)) / a;
    float h = dot(t * direction - apex.xyz, axis.xyz);
    if (t > NEAR && t < solid.depth && h > 0.0 && h < axis.w) {
        vec3 normal = mat3(world_from_camera) * ((q + t * d) / line.x);
        solid = Surface(t, vec4(lit(cone_colour.rgb * 0.5, normal, view), 1.0));
    }
}

// Balls in their colour with a dark outline.
void hit_markers(inout Surface solid, vec3 direction, vec3 view)
{
    float a = dot(direction, direction);
    for (int n = 0; n < counts.x; n++) {
        float b = -dot(direction, markers[n].xyz);
        float c = dot(markers[n].xyz, markers[n].xyz) - markers[n].w * markers[n].w;
        float root = b * b - a * c;
        float t = (-b - sqrt(max(root, 0.0))) / a;
        if (root > 0.0 && t > NEAR && t < solid.depth) {
            vec3 normal = mat3(world_from_camera) * ((t * direction - markers[n].xyz) / markers[n].w);
            bool outline = dot(normal, view) > -0.55;
            solid = Surface(t, vec4(outline ? look(LOOK_MARKER_EDGE) : lit(marker_colours[n].rgb, normal, view), 1.0));
        }
    }
}

void blend(inout vec4 sum, vec4 layer)
{
    sum += (1.0 - sum.a) * layer;
}

// Composes the samples on the planes from `plane` to `until`, or to the first one in an area: then `hit` is its depth.
void sample_planes(inout vec4 sum, inout float hit, inout float plane, float until, Track context, Track areas, float mm)
{
    while (plane < until && sum.a < OPAQUE) {
        float t = depth_of(plane);
        if (is_on(areas, plane) && shows_area(place_on(areas, t))) {
            hit = t;
            break;
        }
        if (CONTEXT == 1 && is_on(context, plane)) {
            blend(sum, context_sample(place_on(context, t), mm));
        }
        plane += 1.0;
    }
}

#if TRANSLUCENT
// main() is in colour_layers.glsl.
#elif SLICES

// One sample, for polygons on the planes that the framebuffer blends: the paper's way, which the bench compares with.
void main()
{
    vec3 direction = vec3((gl_FragCoord.xy / lens.zw * 2.0 - 1.0) * lens.xy + middle.xy, -1.0);
    vec3 view = normalize(mat3(world_from_camera) * direction);
    float t = depth_of(slice);
    Track areas;
    areas.from = areas_from_camera[3].xyz;
    areas.along = mat3(areas_from_camera) * direction;
    vec3 here = place_on(areas, t);
    vec3 there = (context_from_camera * vec4(t * direction, 1.0)).xyz;
    bool is_area = here == clamp(here, 0.0, 1.0) && shows_area(here);
    bool is_tissue = context_bricks.w != 0.0 && there == clamp(there, 0.0, 1.0);
    vec4 area = vec4(area_colour(areas, direction, view, t), 1.0);
    vec4 tissue = is_tissue ? context_sample(there, planes.y * length(direction)) : vec4(0.0);
    colour = is_area ? area : tissue;
}

#else

// The context up to an area at `depth`, which was found on the plane at depth `hit`. A sample stands for half a step to
// either side; the difference is made up for here, so that planes leave no stripes.
void hit_area(inout vec4 sum, Track context, vec3 direction, float depth, float hit)
{
    vec3 place = place_on(context, depth);
    if (CONTEXT == 1 && PLAIN_AREAS == 0 && context.first < NEVER && place == clamp(place, 0.0, 1.0)) {
        blend(sum, context_sample(place, (depth - hit + 0.5 * planes.y) * length(direction)));
        sum = max(sum, vec4(0.0));
    }
}

// The mesh at that depth, or an area that begins just before it, between two planes. Returns the hit.
float hit_mesh(inout vec4 sum, Track context, Track areas, vec3 direction, vec3 view, float mesh)
{
    float plane = plane_after(mesh);
    float t = depth_of(plane);
    bool is_area = is_on(areas, plane) && shows_area(place_on(areas, t));
    float hit = is_area ? min(area_depth(areas, t), mesh) : mesh;
    hit_area(sum, context, direction, hit, t);
    blend(sum, vec4(hit < mesh ? area_colour(areas, direction, view, hit) : mesh_colour(direction, view, mesh), 1.0));
    return hit;
}

// The loops are nested so that a machine that runs several pixels in step, and both sides of every branch, only looks
// at bricks where nothing is visible, and only samples where something is.
void main()
{
    skip_tiles();
    vec3 direction = vec3(((gl_FragCoord.xy + line.zw) / lens.zw * 2.0 - 1.0) * lens.xy + middle.xy, -1.0);
    vec3 view = normalize(mat3(world_from_camera) * direction);
    float mm = planes.y * length(direction);
    Surface near, far;
    Surface solid = Surface(NEVER, vec4(0.0));
    find_walls(near, far, direction);
    hit_axis(solid, direction, view);
    hit_markers(solid, direction, view);

    float mesh = mesh_depth();
    Track context = make_track(context_from_camera, context_bricks.w, direction);
    Track areas = make_track(areas_from_camera, areas_bricks.w, direction);
    float end = min(max(context.end < NEVER ? context.end : 0.0, areas.end < NEVER ? areas.end : 0.0),
                    plane_after(min(solid.depth, mesh)));
    float plane = min(context.first, areas.first);
    float hit = NEVER;
    vec4 sum = vec4(0.0);
    while (plane < end && sum.a < OPAQUE && hit == NEVER) {
        float until = min(end, plane_after(near.depth));
        if (until <= plane) {
            blend(sum, near.colour);
            near = far;
            far.depth = NEVER;
            continue;
        }
        bool shows = planes.w == 0.0;
        float known = plane;
        while (!shows && known < until) {
            plane = known;
            known = look_ahead_both(context, areas, plane, shows);
        }
        plane = shows ? plane : until;
        until = planes.w == 0.0 ? until : min(until, known);
        sample_planes(sum, hit, plane, until, context, areas, mm);
    }
    if (AREAS == 1 && hit < NEVER) {
        float depth = area_depth(areas, hit);
        hit_area(sum, context, direction, depth, hit);
        blend(sum, vec4(area_colour(areas, direction, view, depth), 1.0));
    }
    while (hit == NEVER && near.depth < min(mesh, solid.depth)) {
        blend(sum, near.colour);
        near = far;
        far.depth = NEVER;
    }
    if (hit == NEVER && mesh < solid.depth && sum.a < OPAQUE) {
        hit = hit_mesh(sum, context, areas, direction, view, mesh);
    }
    vec4 rest = vec4(0.0);
    while (near.depth < solid.depth) {
        blend(rest, near.colour);
        near = far;
        far.depth = NEVER;
    }
    blend(rest, solid.colour);
    colour = hit < NEVER ? mix(sum, vec4(rest.rgb / max(rest.a, 1e-6), 1.0), GHOST * rest.a) : sum + (1.0 - sum.a) * rest;
}

#endif
