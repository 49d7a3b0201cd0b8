/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Finds the hull and the ends of a leaf's runs: the body of one instruction set's kernel. Its source defines
 * KERNEL (the function's name), includes this once, and is compiled with that set's flags. */
#include "atlas/tracts/tract_leaf.h"

#include <string.h>

/* Points k of all runs, from 0 to the longest run's last one. */
static inline float (*points_of(struct tract_runs *runs, uint32_t k))[TRACT_LEAF]
{
    return k < runs->longest ? runs->points[k] : runs->last;
}

static struct hull hull_of_runs(struct tract_runs *runs)
{
    float low[3][TRACT_LEAF];
    float high[3][TRACT_LEAF];
    double least[TRACT_DIAGONALS][TRACT_LEAF];
    double most[TRACT_DIAGONALS][TRACT_LEAF];
    for (uint32_t k = 0; k <= runs->longest; k++) {
        float(*points)[TRACT_LEAF] = points_of(runs, k);
        for (int a = 0; a < 3; a++) {
            for (int lane = 0; lane < TRACT_LEAF; lane++) {
                float at = points[a][lane];
                low[a][lane] = k && !(at < low[a][lane]) ? low[a][lane] : at;
                high[a][lane] = k && !(at > high[a][lane]) ? high[a][lane] : at;
            }
        }
        for (int d = 0; d < TRACT_DIAGONALS; d++) {
            for (int lane = 0; lane < TRACT_LEAF; lane++) {
                double at = tract_diagonal(d, 0) * (double)points[0][lane] +
                            tract_diagonal(d, 1) * (double)points[1][lane] +
                            tract_diagonal(d, 2) * (double)points[2][lane];
                least[d][lane] = k && !(at < least[d][lane]) ? least[d][lane] : at;
                most[d][lane] = k && !(at > most[d][lane]) ? most[d][lane] : at;
            }
        }
    }
    struct hull hull = no_hull();
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        const struct hull of_run = {
            .box = {{low[0][lane], low[1][lane], low[2][lane]}, {high[0][lane], high[1][lane], high[2][lane]}},
            .low = {least[0][lane], least[1][lane], least[2][lane], least[3][lane]},
            .high = {most[0][lane], most[1][lane], most[2][lane], most[3][lane]}};
        extend_hull(&hull, &of_run);
    }
    return hull;
}

/* A vector of each run, and by what it is divided to have its squared length; by 1 if that is 0. */
struct vectors {
    double at[3][TRACT_LEAF], squared[TRACT_LEAF], inverse[TRACT_LEAF];
};

static void measure_vectors(struct vectors *vectors)
{
    double divisors[TRACT_LEAF];
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        vectors->squared[lane] = 0;
        for (int a = 0; a < 3; a++) {
            vectors->squared[lane] += vectors->at[a][lane] * vectors->at[a][lane];
        }
        divisors[lane] = vectors->squared[lane] > 0 ? vectors->squared[lane] : 1;
    }
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        vectors->inverse[lane] = 1 / divisors[lane];
    }
}

/* Half the vector from the chord of a run to its farthest point, if no other point is on the other side: a segment
 * moved so far is half as far from all of them. */
static void find_shifts(struct tract_runs *runs)
{
    struct vectors chords;
    double weight[TRACT_LEAF];
    double most[TRACT_LEAF] = {0};
    double farthest[3][TRACT_LEAF] = {0};
    double opposite[TRACT_LEAF] = {0};
    for (int a = 0; a < 3; a++) {
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            chords.at[a][lane] = (double)runs->last[a][lane] - (double)runs->points[0][a][lane];
        }
    }
    measure_vectors(&chords);
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        weight[lane] = chords.squared[lane] > 0 ? 0.5 : 0; /* without a chord nothing is moved */
    }
    for (uint32_t k = 1; k < runs->longest; k++) {
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            double way[3];
            double dot = 0;
            double square = 0;
            for (int a = 0; a < 3; a++) {
                way[a] = (double)runs->points[k][a][lane] - (double)runs->points[0][a][lane];
                dot += way[a] * chords.at[a][lane];
            }
            for (int a = 0; a < 3; a++) {
                way[a] += -dot * chords.inverse[lane] * chords.at[a][lane];
                runs->away[k][a][lane] = way[a];
                square += way[a] * way[a];
            }
            for (int a = 0; a < 3; a++) {
                farthest[a][lane] = square > most[lane] ? way[a] : farthest[a][lane];
            }
            most[lane] = square > most[lane] ? square : most[lane];
        }
    }
    for (uint32_t k = 1; k < runs->longest; k++) {
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            double dot = 0;
            for (int a = 0; a < 3; a++) {
                dot += runs->away[k][a][lane] * farthest[a][lane];
            }
            opposite[lane] = dot < opposite[lane] ? dot : opposite[lane];
        }
    }
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        weight[lane] = opposite[lane] < 0 ? 0 : weight[lane];
    }
    for (int a = 0; a < 3; a++) {
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            runs->shift[a][lane] = farthest[a][lane] * weight[lane];
        }
    }
}

/* Sets the ends of runs in bytes, and how far the points at the ends are from them beyond rounding. */
static void set_ends(struct tract_leaf *leaf, struct tract_runs *runs)
{
    double rounding = tract_leaf_rounding(leaf);
    double bends[TRACT_LEAF] = {0};
    for (int e = 0; e < 2; e++) {
        float(*points)[TRACT_LEAF] = e ? runs->last : runs->points[0];
        double squares[TRACT_LEAF] = {0};
        for (int a = 0; a < 3; a++) {
            int wholes[TRACT_LEAF];
            double low = (double)leaf->low[a];
            double step = (double)leaf->step[a];
            double divisor = step > 0 ? step : INFINITY;
            for (int lane = 0; lane < TRACT_LEAF; lane++) {
                double at = ((double)points[a][lane] + runs->shift[a][lane] - low) / divisor + 0.5;
                at = at > 0 ? at : 0;
                wholes[lane] = (int)(at < UINT8_MAX ? at : UINT8_MAX);
            }
            for (int lane = 0; lane < TRACT_LEAF; lane++) {
                double end = low + wholes[lane] * step;
                double off = (double)points[a][lane] - end;
                runs->ends[e][a][lane] = end;
                squares[lane] += off * off;
            }
            for (int lane = 0; lane < TRACT_LEAF; lane++) {
                leaf->ends[e][a][lane] = (uint8_t)wholes[lane];
            }
        }
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            double beyond = sqrt(squares[lane]) - rounding;
            bends[lane] = beyond > bends[lane] ? beyond : bends[lane];
        }
    }
    memcpy(runs->bends, bends, sizeof bends);
}

/* Finds how far the points of each run are from the segment between its ends, at least as far as these. */
static void find_bends(struct tract_runs *runs)
{
    struct vectors sides;
    double most[TRACT_LEAF] = {0};
    for (int a = 0; a < 3; a++) {
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            sides.at[a][lane] = runs->ends[1][a][lane] - runs->ends[0][a][lane];
        }
    }
    measure_vectors(&sides);
    for (uint32_t k = 0; k <= runs->longest; k++) {
        float(*points)[TRACT_LEAF] = points_of(runs, k);
        for (int lane = 0; lane < TRACT_LEAF; lane++) {
            double way[3];
            double dot = 0;
            double square = 0;
            for (int a = 0; a < 3; a++) {
                way[a] = (double)points[a][lane] - runs->ends[0][a][lane];
                dot += way[a] * sides.at[a][lane];
            }
            double along = dot * sides.inverse[lane];
            along = along < 0 ? 0 : along;
            along = along > 1 ? 1 : along;
            for (int a = 0; a < 3; a++) {
                way[a] += -along * sides.at[a][lane];
                square += way[a] * way[a];
            }
            most[lane] = square > most[lane] ? square : most[lane];
        }
    }
    for (int lane = 0; lane < TRACT_LEAF; lane++) {
        double distance = sqrt(most[lane]);
        runs->bends[lane] = (distance > runs->bends[lane] ? distance : runs->bends[lane]) * (1 + TRACT_BEND_SLACK);
    }
}

void KERNEL(struct tract_leaf *leaf, struct hull *hull, struct tract_runs *runs)
{
    *hull = hull_of_runs(runs);
    for (int a = 0; a < 3; a++) {
        leaf->low[a] = hull->box.low[a];
        leaf->step[a] = (float)(((double)hull->box.high[a] - (double)hull->box.low[a]) / UINT8_MAX);
    }
    find_shifts(runs);
    set_ends(leaf, runs);
    find_bends(runs);
}
