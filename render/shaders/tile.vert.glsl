// One square of TILE pixels per instance: glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, tiles).

layout(std430, binding = 1) readonly buffer Tiles
{
    uint tiles[]; // its first pixel: x in the lower 16 bits, y in the upper ones
};

layout(location = 0) uniform vec2 size; // of the picture, pixels

void main()
{
    vec2 first = vec2(tiles[gl_InstanceID] & 0xffffu, tiles[gl_InstanceID] >> 16);
    vec2 corner = first + float(TILE) * vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * corner / size - 1.0, 0.0, 1.0);
}
