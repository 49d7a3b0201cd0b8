#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus batch --clearance against distances from every cell, triangle and capsule (Eq. 21, needles.py).

Needles of all sorts, with lengths and radii of their own, are asked of AAL, of a grid that is turned, flipped and sheared,
of surfaces of the Allen atlas, of streamlines, of groups (--level) and of pathways. The same objects must have rows, in
the same order; distances agree within 1e-6 mm, the depth is that of the nearest place (of several one of them, and the least
where the needle comes in), the two points are as far apart as the row says and the second one is of the object.

usage: compare_clearance.py CONUS SHARED_DATA; exit 77 = skipped."""

import csv
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips
from compare_levels import group_at_depth, random_tree, write_table
from compare_scenes import brainglobe
import needles as by

import numpy as np

AAL = "/usr/share/mricron/templates/aal.nii.gz"
ALLEN = "meshes/brainglobe-allen-ccf2017-subset"
TRACTS = "tracts/mrtrix/tensor_det.tck"
LONG = bool(os.environ.get("CONUS_TEST_LONG"))


def tolerance(value):
    """Of a number with 9 digits."""
    return 1e-6 + 1e-8 * abs(value)


def ask(conus, atlas, table, options, within):
    """{number of a needle: its rows}; a table has x y z dx dy dz near far."""
    with tempfile.TemporaryDirectory() as folder:
        poses, rows = os.path.join(folder, "needles.tsv"), os.path.join(folder, "rows.tsv")
        with open(poses, "w", encoding="utf-8") as file:
            file.write("\t".join("x y z dx dy dz near far".split()[:len(table[0])]) + "\n")
            file.writelines("\t".join(map(repr, map(float, row))) + "\n" for row in table)
        subprocess.run([conus, "batch", atlas, "--poses", poses, "--clearance", f"{rows},within={within!r}", "-q",
                        *options], check=True)
        found = {}
        with open(rows, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file, delimiter="\t"):
                found.setdefault(int(row["query"]), []).append(row)
        return found


def check_row(row, line, radius, pieces, found, touches):
    """The difference of the distance, mm. touches: the needle may touch cells, which rounding may tell or not."""
    distance, depth = float(row["distance_mm"]), float(row["depth_mm"])
    at, near = (np.array([float(row[f"{prefix}{axis}"]) for axis in "xyz"]) for prefix in ("", "near_"))
    off, coarse = abs(distance - found.distance), tolerance(abs(at).max())
    assert off <= tolerance(distance), (row, found)
    assert abs(float(row["clearance_mm"]) - (found.distance - radius)) <= tolerance(distance), (row, found)
    assert abs(at - (line.origin + depth * line.axis)).max() <= coarse + tolerance(depth), (row, line)
    assert abs(np.linalg.norm(at - near) - distance) <= 4 * coarse, (row, found)
    slack = 4 * tolerance(max(depth, line.near)) + 1e-6
    first = found.first.min()
    if found.distance == 0 and not touches:
        assert abs(depth - first) <= slack, (row, found)
    else:
        tied = (found.first - slack <= depth) & (depth <= found.last + slack)
        assert tied.any(), (row, found)
        inside = found.pieces[tied[:len(found.pieces)]]
        assert not len(inside) or pieces.away(inside, near).min() <= 4 * coarse, (row, found)
    return off


def compare(name, conus, atlas, kinds, table, radius=0.0, within=10.0, options=(), depths=(0.0, np.inf), touches=False):
    """kinds: {kind: list of pieces}; no owner is in two of a list."""
    options = list(options) + (["--radius", repr(radius)] if radius else [])
    options += ["--range", "{!r},{!r}".format(*depths)] if depths[1] < np.inf else []
    rows, worst, count, zero, least = ask(conus, atlas, table, options, within), 0.0, 0, 0, 0
    for number, entry in enumerate(table, 1):
        line, mine = by.needle_from_row(entry, *depths), rows.get(number, [])
        wanted = {(kind, owner): (pieces, found) for kind, several in kinds.items() for pieces in several
                  for owner, found in pieces.nearest(line, within + radius + 1e-6).items()}
        keys = [(row["kind"], int(row["index"])) for row in mine]
        assert len(set(keys)) == len(keys), (name, number, keys)
        for key in set(keys) ^ set(wanted):  # only an object exactly at the limit may be missing in one of both
            assert key in wanted and abs(wanted[key][1].distance - radius - within) <= tolerance(within + radius), \
                (name, number, entry, key, wanted.get(key), [row for row in mine if (row["kind"], int(row["index"])) == key])
        order = [float(row["clearance_mm"]) for row in mine]
        assert order == sorted(order), (name, number, order)
        entered = [float(row["depth_mm"]) for row in mine if row["distance_mm"] == "0"]
        assert entered == sorted(entered), (name, number, entered)
        for key, row in zip(keys, mine):
            try:
                worst = max(worst, check_row(row, line, radius, *wanted[key], touches))
            except AssertionError as error:
                raise AssertionError(name, number, entry) from error
            zero += wanted[key][1].distance == 0
            least += len(wanted[key][1].first) > 1
        count += len(mine)
    print(f"{name}: {len(table)} needles, {count} objects, {zero} of them entered, {least} as near at several pieces; "
          f"distances within {worst:.2g} mm")
    return count


def random_needles(random, count, low, high):
    """From in and around a box towards points in it: short and long ones, from inside, from far away, some past all."""
    size = high - low
    table = []
    for k in range(count):
        target = random.uniform(low, high)
        way = random.normal(size=3)
        away = np.linalg.norm(size) * random.choice([0.02, 0.2, 0.7, 5.0])
        origin = target + away * way / np.linalg.norm(way)
        near = random.choice([0.0, away * random.uniform(0, 1)])
        far = near + random.choice([1e-4, 1e-2, away * random.uniform(0.1, 1), away * 2], p=[0.05, 0.05, 0.6, 0.3])
        table.append([*np.round(origin, 4), *np.round(target - origin, 4), round(near, 5), round(far, 5)])
    return table


def lattice_needles(affine, shape, random, count):
    """Along faces, edges and diagonals of voxels, from their corners, faces and centres: ties and touches."""
    table = []
    for _ in range(count):
        voxel = random.integers(0, np.array(shape) * 2) / 2
        way = random.integers(-1, 2, 3)
        way[random.integers(3)] = 1
        table.append([*(affine[:3, :3] @ voxel + affine[:3, 3]), *(affine[:3, :3] @ way), 0.0,
                      float(random.integers(1, 40))])
    return table


def golden(pieces, piece, line):
    """Least distance of a piece by golden sections of the needle: it is convex along it."""
    low, high, ratio = line.near, pieces.end(line), (5**0.5 - 1) / 2
    def away(t):
        return pieces.away(np.array([piece]), line.origin + t * line.axis)[0]
    for _ in range(32):
        left, right = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, right) if away(left) <= away(right) else (left, high)
    return away((low + high) / 2)


def check_arithmetic(random):
    """The oracle's own formulas against golden sections and closed forms."""
    turned = np.eye(4)
    turned[:3, :3] = [[1.2, 0.3, 0.1], [-0.2, 0.9, 0.4], [0.1, -0.3, -1.5]]
    straight = np.diag([1.5, -0.7, 2.0, 1.0])
    voxels = random.integers(-3, 4, (20, 3))
    owners = np.arange(20)
    walk = random.normal(size=(21, 3)).cumsum(0)
    kinds = [by.Cells(affine, voxels, owners) for affine in (turned, straight)]
    kinds += [by.Triangles({k: [random.normal(size=(1, 3, 3)) * 2] for k in range(20)}),
              by.Capsules({k: ([walk[k:k + 2]], 0.1) for k in range(20)})]
    for pieces in kinds:
        for _ in range(2):
            line = by.needle(random.normal(size=3) * 4, random.normal(size=3), 1.0, 9.0)
            mine = pieces.measure(np.arange(20), line)
            for k in random.integers(0, 20, 2):
                assert abs(golden(pieces, k, line) - mine[0][k]) < 1e-5, (pieces, k, line)
                at = pieces.away(np.array([k]), line.origin + mine[1][k] * line.axis)[0]
                assert abs(at - mine[0][k]) < 1e-9, (pieces, k, line)
    offsets, speed = random.normal(size=(300, 3)) * 3, line.axis
    boxes = by.box_distance(offsets, speed, np.array([0.5, 1.0, 0.2]), 0.5, 6.0)
    matrix = np.column_stack([speed, -np.diag([1.0, 2.0, 0.4])])
    others = by.least_square(matrix, offsets, np.array([0.5, -0.5, -0.5, -0.5]), np.array([6.0, 0.5, 0.5, 0.5]))
    assert abs(boxes[0] - others[0]).max() < 1e-12 and abs(boxes[1] - others[1]).max() < 1e-5
    # A unit cube about 0: a needle beside it, one that touches an edge, one that ends before it.
    cube = by.Cells(np.eye(4), np.zeros((1, 3), int), np.array([1]))
    for origin, axis, far, wanted in (([-3, 1.5, 0], [1, 0, 0], 9, (1.0, 2.5)), ([-2.5, 0, -1.5], [1, 0, 1], 9, (0.0, 2.0)),
                                      ([-3, 0, 0], [1, 0, 0], 2, (0.5, 2.0)), ([2, 2, 0.2], [1, 1, 0], 0, (1.5 * 2**0.5, 0))):
        first, depth, _ = cube.measure(np.array([0]), by.needle(origin, axis, 0, far))
        length = np.linalg.norm(axis) if wanted[0] == 0 else 1
        assert abs(first[0] - wanted[0]) < 1e-12 and abs(depth[0] - wanted[1] * length) < 1e-9, (origin, first, depth)


def save(path, values, affine):
    image = nibabel.Nifti1Image(values, affine)
    image.set_sform(affine, 1)
    nibabel.save(image, path)
    return nibabel.load(path).affine


def blobs(random, shape, count):
    """Labels: the nearest of some points, and nothing far from all."""
    grid = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), -1)
    middles = random.uniform(0, 1, (count, 3)) * shape
    away = np.linalg.norm(grid[..., None, :] - middles, axis=-1)
    return np.where(away.min(-1) < 4, away.argmin(-1) + 1, 0).astype("i2")


GRIDS = {"as AAL": np.diag([1.0, 1, 1, 1]),
         "flipped, of three sizes": np.diag([-0.5, 2, 1.25, 1]),
         "turned": np.array([[0.8, -0.6, 0, 0], [0.6, 0.8, 0, 0], [0, 0, 1.5, 0], [0, 0, 0, 1]]),
         "sheared": np.array([[1, 0.5, 0.2, 0], [0.1, -1.2, 0.4, 0], [-0.3, 0.2, 0.9, 0], [0, 0, 0, 1]]),
         "hardly sheared": np.array([[1, 1e-5, 0, 0], [0, 1, 1e-4, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
         "tiny": np.diag([1e-3, 1e-3, 2e-3, 1]), "thin": np.diag([0.1, 0.1, 5, 1])}


def check_grids(conus, random, folder):
    shape = (24, 20, 16)
    path, image = os.path.join(folder, "blobs.nii"), os.path.join(folder, "map.nii")
    for name, affine in GRIDS.items():
        affine = affine.copy()
        scale = np.abs(affine[:3, :3]).max()
        affine[:3, 3] = [-7.25 * scale, 3.5 * scale, -12 * scale]
        labels = blobs(random, shape, 30)
        affine = save(path, labels, affine)
        area = by.cells_of_labels(affine, labels)
        corners = area.centres.T + area.middle
        table = random_needles(random, 300 if LONG else 20, corners.min(0), corners.max(0))
        compare(f"grid {name}", conus, path, {"area": [area]}, table, radius=0.4 * scale, within=3.0 * scale)
        table = lattice_needles(affine, shape, random, 300 if LONG else 20)
        compare(f"grid {name}, touched", conus, path, {"area": [area]}, table, within=3.0 * scale, touches=name != "as AAL")
    # Pathways with a grid of their own, one of a file with several volumes, and an infinite needle.
    values = random.uniform(0, 1, (12, 10, 8, 3)).astype("f4")
    values[random.uniform(size=values.shape) < 0.01] = np.nan
    other = save(image, values, np.array([[2, 0.1, 0, -4], [0, 2, 0, -1], [0.3, 0, 3, -12], [0, 0, 0, 1.0]]))
    affine = save(path, blobs(random, shape, 30), GRIDS["sheared"])
    labels = np.asanyarray(nibabel.load(path).dataobj)
    area = by.cells_of_labels(affine, labels)
    with np.errstate(invalid="ignore"):
        pathway = by.cells_of_labels(other, (values[..., 2] >= 0.9).astype("i1"))
    corners = pathway.centres.T + pathway.middle
    table = random_needles(random, 60 if LONG else 20, corners.min(0), corners.max(0))
    options = ["--pathway", f"{image},volume=2,threshold=0.9,name=Vessels"]
    compare("pathway of a 4-D file", conus, path, {"area": [area], "pathway": [pathway]}, table, 0.25, 2.0, options)
    bare = [row[:6] for row in table]
    compare("without an end", conus, path, {"area": [area], "pathway": [pathway]}, bare, 0.25, 2.0, options)
    compare("of one range", conus, path, {"area": [area]}, bare, 0.0, 2.0, [], (2.5, 11.0))


def check_aal(conus, random, folder):
    image = nibabel.load(AAL)
    labels = np.asanyarray(image.dataobj)
    area = by.cells_of_labels(image.affine, labels)
    low, high = np.array([-90, -125, -71.0]), np.array([90, 91, 109.0])
    table = random_needles(random, 1950 if LONG else 40, low, high)
    table += lattice_needles(image.affine, labels.shape, random, 50 if LONG else 20)  # of whole numbers and halves: exact
    compare("AAL", conus, AAL, {"area": [area]}, table, radius=0.65)
    compare("AAL, far ones", conus, AAL, {"area": [area]}, table[:10], within=1000.0)
    import random as plain
    tree = random_tree([int(label) for label in np.unique(labels) if label], plain.Random(21))
    group = np.zeros(labels.max() + 1, "i4")
    for label in np.unique(labels)[1:]:
        group[label] = group_at_depth(tree, int(label), 1)
    write_table(os.path.join(folder, "tree.tsv"), tree)
    compare("AAL by groups", conus, AAL, {"area": [by.cells_of_labels(image.affine, group[labels])]},
            table[:200 if LONG else 20], 1.5, 30.0, ["--labels", os.path.join(folder, "tree.tsv"), "--level", "1"])


def as_kept(vertices):
    """In single precision, as in the file, in micrometres, and then in mm."""
    return ((vertices * 1000).astype("f4").astype(float) * 0.001).astype("f4").astype(float)


def check_surfaces(conus, random, path):
    surfaces = {label: [as_kept(vertices)[triangles]] for (label, _), vertices, triangles in brainglobe(path)}
    area = by.Triangles(surfaces)
    corners = area.corners.reshape(-1, 3)
    table = random_needles(random, 500 if LONG else 30, corners.min(0), corners.max(0))
    compare("Allen", conus, path, {"area": [area]}, table, radius=0.035, within=1.0)


def check_streamlines(conus, random, folder, path):
    lines = [np.asarray(line) for line in nibabel.streamlines.load(path).streamlines]
    bundle = by.Capsules({1: (lines, 0.5)})
    corners = np.concatenate(lines)
    volume = os.path.join(folder, "beside.nii")
    affine = np.diag([4.0, 4, 4, 1])
    affine[:3, 3] = corners.min(0)
    labels = blobs(random, (10, 10, 10), 5)
    affine = save(volume, labels, affine)
    table = random_needles(random, 500 if LONG else 60, corners.min(0), corners.max(0))
    compare("streamlines", conus, volume, {"area": [by.cells_of_labels(affine, labels)], "bundle": [bundle]}, table, 0.3,
            5.0, ["--streamlines", f"{path},radius=0.5"])


def main():
    conus, shared = sys.argv[1], os.environ.get("CONUS_SHARED_DATA", sys.argv[2])
    random = np.random.default_rng(21)
    check_arithmetic(random)
    with tempfile.TemporaryDirectory() as folder:
        check_grids(conus, random, folder)
        if os.path.exists(AAL):
            check_aal(conus, random, folder)
        if os.path.isdir(os.path.join(shared, "meshes")):
            check_surfaces(conus, random, os.path.join(shared, ALLEN))
            check_streamlines(conus, random, folder, os.path.join(shared, TRACTS))
        print("".join(f"left out: no {path}\n" for path in (AAL, shared) if not os.path.exists(path)), end="")


if __name__ == "__main__":
    main()
