// Smooths the edges of a picture, as render/colour/edges.c does on the CPU, to the bit. FIND_EDGES marks the squares of
// TILE pixels that are drawn again, an invocation each; else what was drawn of them is mixed in, pixel by pixel.

layout(local_size_x = GROUP, local_size_y = GROUP) in;

layout(rgba32f, binding = 0) uniform restrict image2D picture;
layout(rgba32f, binding = 1) uniform restrict readonly image2D drawn;
layout(std430, binding = TILE_BUFFER) restrict buffer Tiles { uint tiles[]; };

layout(location = 0) uniform int work;
layout(location = 1) uniform float threshold;

uint tile_of(ivec2 pixel, ivec2 size)
{
    ivec2 tile = pixel / TILE;
    return uint(tile.y * ((size.x + TILE - 1) / TILE) + tile.x);
}

bool differ(vec4 a, vec4 b)
{
    vec4 gap = abs(a - b);
    return max(max(gap.x, gap.y), max(gap.z, gap.w)) > threshold;
}

void find(ivec2 first, ivec2 size)
{
    ivec2 end = min(first + TILE, size);
    bool found = false;
    for (int y = first.y; y < end.y && !found; y++) {
        for (int x = first.x; x < end.x && !found; x++) {
            vec4 pixel = imageLoad(picture, ivec2(x, y));
            found = x + 1 < size.x && differ(pixel, imageLoad(picture, ivec2(x + 1, y)));
            found = found || (y + 1 < size.y && differ(pixel, imageLoad(picture, ivec2(x, y + 1))));
        }
    }
    if (first.x < size.x && first.y < size.y) {
        tiles[tile_of(first, size)] = found ? 1u : 0u;
    }
}

// The ray at the lower left corner of a pixel, which may be beyond the picture's end; `own` where none was drawn.
vec4 corner_at(ivec2 pixel, ivec2 size, vec4 own)
{
    pixel = min(pixel, size - 1);
    return tiles[tile_of(pixel, size)] != 0u ? imageLoad(drawn, pixel) : own;
}

void take(ivec2 pixel, ivec2 size)
{
    if (pixel.x >= size.x || pixel.y >= size.y || tiles[tile_of(pixel, size)] == 0u) {
        return;
    }
    vec4 colour = imageLoad(drawn, pixel);
    if (work == MIX_CORNERS) {
        vec4 own = imageLoad(picture, pixel);
        precise vec4 sum = 4.0 * own + colour;
        sum += corner_at(pixel + ivec2(1, 0), size, own);
        sum += corner_at(pixel + ivec2(0, 1), size, own);
        sum += corner_at(pixel + ivec2(1, 1), size, own);
        colour = sum / 8.0;
    }
    imageStore(picture, pixel, colour);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(picture);
    if (work == FIND_EDGES) {
        find(at * TILE, size);
    } else {
        take(at, size);
    }
}
