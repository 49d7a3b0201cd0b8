// The beginning of every shader.

// Whether a voxel, or a brick, lies in a grid of `dim`.
bool is_inside(ivec3 cell, ivec3 dim)
{
    return all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, dim));
}
