#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""cuts.py CONUS: the label at each pixel of conus render's cuts, and the length of the scale bar, found again.

Written here: blocks.nii.gz, an atlas that no axis, side or turn leaves as it is, with voxels of three lengths that lie
obliquely and run from right to left; blocks.txt, its names and colours. Where the pixels of a cut lie in the world
follows from the extent of its coloured pixels and of the labels in the plane, so from nothing that conus says.
"""
import itertools
import subprocess
import sys

import nibabel
import numpy
import OpenImageIO as oiio

SHAPE, SIZES = (36, 44, 30), (1.7, 1.3, 2.1)
COLOURS = {1: (230, 30, 30), 2: (30, 200, 40), 3: (40, 60, 240), 4: (240, 200, 20), 5: (200, 40, 220)}
PLANES = {"axial": (2, (1, 0, 0), (0, 1, 0)), "coronal": (1, (1, 0, 0), (0, 0, 1)), "sagittal": (0, (0, 1, 0), (0, 0, 1))}


def rotation(axis, degrees):
    c, s = numpy.cos(numpy.radians(degrees)), numpy.sin(numpy.radians(degrees))
    turned = numpy.eye(3)
    a, b = [n for n in range(3) if n != axis]
    turned[a, a], turned[a, b], turned[b, a], turned[b, b] = c, -s, s, c
    return turned


def write_atlas():
    i, j, k = numpy.indices(SHAPE)
    labels = numpy.zeros(SHAPE, numpy.uint8)
    labels[(i - 18) ** 2 / 14**2 + (j - 22) ** 2 / 19**2 + (k - 14) ** 2 / 12**2 < 1] = 1
    labels[(labels > 0) & (i > 21) & (j < 20)] = 2  # i grows to the left
    labels[(labels > 0) & (j > 28) & (k > 12)] = 3
    labels[(labels > 0) & (k < 9) & (i < 16)] = 4
    labels[(i - 12) ** 2 + (j - 20) ** 2 + (k - 18) ** 2 < 16] = 5
    affine = numpy.eye(4)
    affine[:3, :3] = rotation(0, 7) @ rotation(2, -9) @ numpy.diag((-SIZES[0], SIZES[1], SIZES[2]))
    affine[:3, 3] = numpy.array((4, -7, 11)) - affine[:3, :3] @ (numpy.array(SHAPE) / 2)
    nibabel.save(nibabel.Nifti1Image(labels, affine), "blocks.nii.gz")
    with open("blocks.txt", "w") as table:
        for label, colour in COLOURS.items():
            print(label, f"area{label}", *colour, 0, file=table)
    return labels, numpy.linalg.inv(affine)


def labels_at(atlas, world):
    labels, voxel_from_world = atlas
    voxel = numpy.floor(world @ voxel_from_world[:3, :3].T + voxel_from_world[:3, 3] + 0.5).astype(int)
    inside = ((voxel >= 0) & (voxel < SHAPE)).all(-1)
    voxel[~inside] = 0
    return numpy.where(inside, labels[tuple(numpy.moveaxis(voxel, -1, 0))], 0)


def picture_of(conus, name, *options):
    subprocess.run((conus, "render", "blocks.nii.gz", "--labels", "blocks.txt", "-o", name, "--background", "white",
                    "--quiet", "--legend", "none", *options), check=True)
    return oiio.ImageInput.open(name).read_image(oiio.UINT8)[..., :3].astype(int)  # not ImageBuf, which has a cache


def found_labels(pixels):
    found = numpy.zeros(pixels.shape[:2], int)
    for label, colour in COLOURS.items():
        found[(pixels == colour).all(-1)] = label
    return found


def box(mask):
    """(first, one past the last) of columns and of rows."""
    return [(where[0], where[-1] + 1) for where in (numpy.flatnonzero(mask.any(axis)) for axis in (0, 1))]


def check(conus, atlas, plane, place, radiological):
    axis, right, up = (numpy.array(value) if n else value for n, value in enumerate(PLANES[plane]))
    if radiological and plane != "sagittal":
        right = -right
    pixels = picture_of(conus, "cut.png", "--cuts", f"{plane}:{place}", "--fill", "1", "--size", "700x600",
                        *["--radiological"] * radiological)
    found = found_labels(pixels)
    # Finds the labels in the plane, by points of 0.1 mm.
    step, reach = 0.1, 80
    along = numpy.arange(-reach, reach, step) + step / 2
    fine = numpy.zeros((along.size, along.size, 3)) + along[None, :, None] * right - along[:, None, None] * up
    fine[..., axis] = place
    columns, rows = box(labels_at(atlas, fine) > 0)
    found_columns, found_rows = box(found > 0)
    scales = [step * (mm[1] - mm[0]) / (px[1] - px[0]) for mm, px in ((columns, found_columns), (rows, found_rows))]
    assert abs(scales[0] / scales[1] - 1) < 0.01, scales
    scale = sum(scales) / 2
    left, top = -reach + step * columns[0] - scale * found_columns[0], reach - step * rows[0] + scale * found_rows[0]
    y, x = numpy.indices(found.shape) + 0.5

    def expected(column, row):
        world = (left + scale * column)[..., None] * right + (top - scale * row)[..., None] * up
        world[..., axis] = place
        return labels_at(atlas, world)

    area = found > 0
    assert area.sum() > 20000, area.sum()
    differing = found != expected(x, y)
    assert differing[area].mean() < 0.08, f"{plane} {place}: {differing[area].mean():.3f} of the pixels differ"
    # The extents are known to a pixel, and a border is smooth by half a voxel: every differing pixel has one that near.
    near = numpy.zeros(differing.sum(), bool)
    for dx, dy in itertools.product(numpy.linspace(-1, 1, 7) * (1.5 + 0.5 * max(SIZES) / scale), repeat=2):
        near |= found[differing] == expected(x[differing] + dx, y[differing] + dy)
    assert near.all(), f"{plane} {place}: {(~near).sum()} pixels have a label that is nowhere near"
    # The bar is the longest dark row below the cut.
    dark = (pixels < 110).all(-1)
    dark[: found_rows[1]] = False
    bar = max(sum(row) for row in dark if row.any() and numpy.ptp(numpy.flatnonzero(row)) < row.sum())
    lengths = [m * 10.0**n for n in range(3) for m in (1, 2, 5)]
    length = min(lengths, key=lambda mm: abs(bar * scale - mm))
    short = max(SIZES) / (step * min(columns[1] - columns[0], rows[1] - rows[0]))  # half a voxel at each end
    assert -3 <= bar - length / scale <= 3 + short * bar, f"a bar of {bar} pixels of {scale:.4f} mm"
    return set(found[area].tolist())


def main():
    conus, atlas, seen = sys.argv[1], write_atlas(), set()
    for plane, places in {"axial": (-6, 12.5), "coronal": (-15, 3.7), "sagittal": (-9, 8.2)}.items():
        for place in places:
            for radiological in (False, True):
                seen |= check(conus, atlas, plane, place, radiological)
    assert seen == set(COLOURS), seen
    # All cuts of one sheet go through a point: each has pixels of the area in which the point is.
    at = nibabel.load("blocks.nii.gz").affine @ (12, 20, 18, 1)
    sheet = found_labels(picture_of(conus, "sheet.png", "--cuts", "axial,coronal,sagittal", "--fill", "1",
                                    f"--at={at[0]},{at[1]},{at[2]}", "--size", "1200x500"))
    assert all((sheet[:, 400 * n : 400 * n + 400] == 5).sum() > 100 for n in range(3))


main()
