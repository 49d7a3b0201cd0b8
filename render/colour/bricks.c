/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the distance from each brick to the nearest brick that shows. */
#include "render/colour/bricks.h"

#include "base/memory.h"

void bricks_finish(struct bricks *bricks)
{
    memory_free(bricks->distance);
    *bricks = (struct bricks){0};
}

/* The least distance among the neighbours (i + di, j + dj, k + dk) with di in -1..1 and (dj, dk) as given. */
static uint8_t least_of_row(const struct bricks *bricks, size_t i, size_t j, size_t k)
{
    const uint8_t *row = bricks->distance + bricks->dim[0] * (j + bricks->dim[1] * k);
    uint8_t least = row[i];
    least = i > 0 && row[i - 1] < least ? row[i - 1] : least;
    return i + 1 < bricks->dim[0] && row[i + 1] < least ? row[i + 1] : least;
}

static uint8_t lesser(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* One brick of a chessboard distance transform (Rosenfeld and Pfaltz 1968): from the half of its neighbours that the
 * pass has already been at; `back` is -1 when indices grow, +1 when they fall. */
static void relax(struct bricks *bricks, size_t i, size_t j, size_t k, int back)
{
    const size_t *dim = bricks->dim;
    size_t before_i = i + (size_t)back, before_j = j + (size_t)back, before_k = k + (size_t)back; /* may wrap: >= dim */
    uint8_t *own = &bricks->distance[i + dim[0] * (j + dim[1] * k)];
    uint8_t least = UINT8_MAX;
    if (before_i < dim[0]) {
        least = lesser(least, own[back]);
    }
    if (before_j < dim[1]) {
        least = lesser(least, least_of_row(bricks, i, before_j, k));
    }
    for (size_t y = j > 0 ? j - 1 : 0; before_k < dim[2] && y <= j + 1 && y < dim[1]; y++) {
        least = lesser(least, least_of_row(bricks, i, y, before_k));
    }
    if (least + 1 < *own) {
        *own = (uint8_t)(least + 1);
    }
}

void bricks_spread(struct bricks *bricks)
{
    for (size_t k = 0; k < bricks->dim[2]; k++) {
        for (size_t j = 0; j < bricks->dim[1]; j++) {
            for (size_t i = 0; i < bricks->dim[0]; i++) {
                relax(bricks, i, j, k, -1);
            }
        }
    }
    for (size_t k = bricks->dim[2]; k-- > 0;) {
        for (size_t j = bricks->dim[1]; j-- > 0;) {
            for (size_t i = bricks->dim[0]; i-- > 0;) {
                relax(bricks, i, j, k, 1);
            }
        }
    }
}
