/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Boxes along the axes, and the boxes around points. */
#ifndef CONUS_BASE_BOX3_H
#define CONUS_BASE_BOX3_H

#include "base/geometry/math3.h"

/** Its corners of least and of greatest coordinates; empty where low[0] is above high[0]. */
struct box3 {
    double low[3], high[3];
};

static inline struct box3 box3_empty(void)
{
    return (struct box3){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/** Makes the box hold @p p, too; a coordinate that is NaN does not count. */
static inline void box3_add(struct box3 *box, const double p[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], p[a]);
        box->high[a] = fmax(box->high[a], p[a]);
    }
}

/** Makes the box hold another one, of these corners; of an empty one nothing. */
static inline void box3_join(struct box3 *box, const double low[3], const double high[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], low[a]);
        box->high[a] = fmax(box->high[a], high[a]);
    }
}

/** Corner number 0 to 7: bit a of it stands for the greater coordinate along axis a. */
static inline void box3_corner(double out[3], const struct box3 *box, int corner)
{
    for (int a = 0; a < 3; a++) {
        out[a] = corner >> a & 1 ? box->high[a] : box->low[a];
    }
}

/** The box around the image of @p box under the affine @p m. */
static inline struct box3 box3_image(const struct box3 *box, const double m[16])
{
    struct box3 image = box3_empty();
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        box3_corner(p, box, corner);
        mat4_point(p, m, p);
        box3_add(&image, p);
    }
    return image;
}

#endif
