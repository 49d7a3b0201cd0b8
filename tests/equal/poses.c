/* SPDX-License-Identifier: BSD-3-Clause */
/* tests/equal/ranks: a table of N poses round the head, in whole mm, 22 bytes each. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* A number from 0 to below 1: the upper 24 bits of a linear congruential generator modulo 2^64. */
static double next_uniform(uint64_t *state)
{
    *state = *state * 6364136223846793005U + 1442695040888963407U;
    return (double)(*state >> 40) / 16777216.0;
}

/* Writes a pose from 110 to 160 mm around (0, -20, 10), towards a point of a box of 60 x 80 x 60 mm within the head. */
static void write_pose(uint64_t *state)
{
    double height = 2 * next_uniform(state) - 1;
    double turn = 2 * 3.14159265358979323846 * next_uniform(state);
    double distance = 110 + 50 * next_uniform(state);
    double across = distance * sqrt(1 - height * height);
    int x = (int)lround(across * cos(turn));
    int y = (int)lround(across * sin(turn)) - 20;
    int z = (int)lround(distance * height) + 10;
    int to_x = (int)(60 * next_uniform(state)) - 30;
    int to_y = (int)(80 * next_uniform(state)) - 60;
    int to_z = (int)(60 * next_uniform(state)) - 20;
    printf("%d\t%d\t%d\t%d\t%d\t%d\n", x, y, z, to_x - x, to_y - y, to_z - z);
}

int main(int argc, char **argv)
{
    if (argc != 2) {
        fputs("usage: poses N\n", stderr);
        return 2;
    }
    uint64_t state = 20261122;
    puts("x\ty\tz\tdx\tdy\tdz");
    for (long long left = strtoll(argv[1], NULL, 10); left > 0; left--) {
        write_pose(&state);
    }
    return fflush(stdout) ? 1 : 0;
}
