// All layers of the meshes (Eq. 10): every triangle that covers a pixel's centre, in any order. Where the ray hits it is
// computed on the CPU in double precision.
flat in uint triangle;

layout(std430, binding = HIT_BUFFER) restrict buffer Hits // see gl.h
{
    uint hit_count, unused;
    uvec2 hits[]; // pixel, triangle
};

layout(location = 3) uniform int resolution;
layout(location = 4) uniform ivec2 pixels; // the first, and the first that is not to be drawn

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    int pixel = at.y * resolution + at.x;
    if (pixel >= pixels.x && pixel < pixels.y) {
        uint place = atomicAdd(hit_count, 1u);
        if (place < uint(hits.length())) {
            hits[place] = uvec2(pixel, triangle);
        }
    }
}
