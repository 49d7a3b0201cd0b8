#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus overlap` on AAL against numpy (Eq. 16): a mask on the atlas's grid, maps with thresholds of both signs, random
regions on grids of 1, 2 and 2.5 mm, parallel to AAL's (any order and direction of axes) and oblique, and, where they
are, the Jülich fibre pathways.

Voxels of parallel grids have in common the product of what their edges have; of oblique ones the volume is Lawrence's
sum over the vertices of the polytope of their twelve planes, for a linear functional c: (c v)^3 / (3! |det| g0 g1 g2)
with g from the normals of the three planes at v. That is no clipping and has no order of faces.

usage: compare_overlap.py CONUS [DATA] [COUNT]: COUNT random regions, else 3, 12 in scripts/test --long; exit 77 = skipped."""
import csv
import glob
import io
import itertools
import os
import subprocess
import sys
import tempfile

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"
PARALLEL = 1e-9  # of the region; the nine digits of the table allow 5e-10
OBLIQUE = 1e-8  # and the rounding of Lawrence's sum
SLIVER = 1e-6  # of a voxel: of a peak there rounding may decide

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)

from sample import LONG, every

if not os.path.exists(ATLAS):
    print("skipped: no mricron-data")
    sys.exit(77)


def rows_of(conus, path, threshold):
    command = [conus, "overlap", ATLAS, path, "--format", "tsv", "--quiet"]
    command += ["--threshold", str(threshold)] if threshold else []
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return list(csv.DictReader(io.StringIO(text), delimiter="\t"))


def is_parallel(linear):
    return all(np.count_nonzero(row) == 1 for row in linear)


def cells_of(linear, centres, reach):
    """Pairs of a region's voxel and a cell of the atlas that its bounds meet: numbers of voxels, cells."""
    low = np.floor(centres - reach + 0.5).astype(int)
    high = np.ceil(centres + reach - 0.5).astype(int)
    shifts = np.indices((high - low).max(axis=0) + 1).reshape(3, -1).T
    voxel = np.repeat(np.arange(len(centres)), len(shifts))
    cell = (low[:, None] + shifts).reshape(-1, 3)
    there = np.all(cell <= high[voxel], axis=1)
    return voxel[there], cell[there]


def parallel_volumes(linear, centres, voxel, cell):
    half = np.abs(linear).sum(axis=1) / 2
    common = np.minimum(centres[voxel] + half, cell + 0.5) - np.maximum(centres[voxel] - half, cell - 0.5)
    return np.prod(np.maximum(common, 0), axis=1)


def oblique_volumes(linear, centres, voxel, cell):
    """By Lawrence's formula, coordinates from the cell's middle on."""
    exact = np.longdouble
    place = (centres[voxel] - cell).astype(exact)
    inverse = np.linalg.inv(linear)
    normals = np.vstack([np.eye(3), -np.eye(3), inverse, -inverse])
    towards = place @ inverse.T.astype(exact)
    half = np.full((len(place), 3), exact(0.5))
    bounds = np.hstack([half, half, towards + 0.5, 0.5 - towards])
    c = np.array([0.61, -0.37, 0.83])
    total = np.zeros(len(place), exact)
    for three in itertools.combinations(range(12), 3):
        matrix = normals[list(three)]
        if abs(np.linalg.det(matrix)) < 1e-9:
            continue
        gamma = np.linalg.solve(matrix.T, c)
        inverted = np.linalg.inv(matrix)
        inverted = inverted.astype(exact)
        inverted = inverted @ (2 * np.eye(3, dtype=exact) - matrix.astype(exact) @ inverted)  # Newton's step
        vertex = bounds[:, list(three)] @ inverted.T
        others = [k for k in range(12) if k not in three]
        feasible = np.all(vertex @ normals[others].T.astype(exact) <= bounds[:, others], axis=1)
        term = (vertex[feasible] @ c.astype(exact)) ** 3
        total[feasible] += term / exact(6 * abs(np.linalg.det(matrix)) * np.prod(gamma))
    return np.maximum(total, 0).astype(float)


def shares_of(atlas, labels, affine, voxels):
    """{label: volume of each voxel in it}, in parts of a voxel."""
    transform = np.linalg.solve(atlas.affine, affine)
    linear = transform[:3, :3]
    centres = voxels @ linear.T + transform[:3, 3]
    shares = {}
    for begin in range(0, len(voxels), 4096):
        some = centres[begin:begin + 4096]
        voxel, cell = cells_of(linear, some, np.abs(linear).sum(axis=1) / 2)
        measure = parallel_volumes if is_parallel(linear) else oblique_volumes
        volume = measure(linear, some, voxel, cell) / abs(np.linalg.det(linear))
        inside = np.all((cell >= 0) & (cell < labels.shape), axis=1)
        label = np.zeros(len(cell), int)
        label[inside] = labels[tuple(cell[inside].T)]
        for one in np.unique(label[volume > 0]):
            each = shares.setdefault(one, np.zeros(len(voxels)))
            each[begin:begin + 4096] += np.bincount(voxel[label == one], volume[label == one], len(some))
    return shares


def compare(conus, atlas, labels, path, threshold, tolerance):
    """Returns how many rows there are, and the largest error of a volume, in parts of the region."""
    image = nibabel.load(path)
    values = image.get_fdata(dtype=np.float32)
    region = values >= np.float32(threshold) if threshold > 0 else values <= np.float32(threshold)
    region = region if threshold else values != 0
    shares = shares_of(atlas, labels, image.affine, np.argwhere(region))
    mm3 = abs(np.linalg.det(image.affine[:3, :3])) * np.count_nonzero(region)
    atlas_mm3 = abs(np.linalg.det(atlas.affine[:3, :3]))
    rows = rows_of(conus, path, threshold)
    found = {int(row["index"].replace("n/a", "0")): row for row in rows}
    worst = 0
    for label in set(shares) | set(found):
        volume = shares[label].mean() if label in shares else 0
        got = float(found[label]["region_fraction"]) if label in found else 0
        worst = max(worst, abs(got - volume))
        assert abs(got - volume) <= tolerance, (path, label, got, volume)
        if label not in found:
            continue
        row = found[label]
        assert np.isclose(float(row["volume_mm3"]), got * mm3, rtol=1e-8, atol=0), (path, row)
        whole = np.count_nonzero(labels == label) * atlas_mm3
        assert not label or np.isclose(float(row["fraction"]), got * mm3 / whole, rtol=1e-8, atol=0), (path, row)
        assert not label or 0 < float(row["fraction"]) <= 1, (path, row)
        peak = np.float32(row["peak"])
        sign = 1 if threshold >= 0 else -1
        inside = sign * values[region]
        sure = inside[shares[label] > SLIVER] if label in shares else inside[:0]
        assert not sure.size or sign * peak >= sure.max() * (1 - 1e-6), (path, row)
        assert sure.size and sign * peak <= sure.max() * (1 + 1e-6) or volume * region.sum() < 1 or \
            tolerance > PARALLEL, (path, row)
        place = np.linalg.solve(image.affine, [float(row["peak_" + axis]) for axis in "xyz"] + [1])[:3]
        assert np.isclose(values[tuple(np.rint(place).astype(int))], peak, rtol=1e-6), (path, row)
    volumes = [float(row["volume_mm3"]) for row in rows if row["kind"] != "unassigned"]
    assert volumes == sorted(volumes, reverse=True)
    return len(rows), worst


def write(folder, name, values, affine):
    image = nibabel.Nifti1Image(values, affine)
    image.set_sform(affine, 4)
    path = os.path.join(folder, name)
    nibabel.save(image, path)
    return path


def random_region(random, number, oblique):
    """A ball with a rough rim on a grid of 1, 2 or 2.5 mm in AAL, its axes in any order and direction or turned."""
    dim = random.integers(8, 16, 3)
    linear = np.eye(3)[random.permutation(3)] * random.choice([-1, 1], 3)
    if oblique:
        linear = np.linalg.qr(random.normal(size=(3, 3)))[0]
    affine = np.eye(4)
    affine[:3, :3] = linear * (1, 2, 2.5)[number % 3]
    middle = random.uniform((-45, -75, -20), (45, 45, 55))
    if number % 2:
        middle = np.round(middle)  # so that borders of voxels may coincide
    affine[:3, 3] = middle - affine[:3, :3] @ (dim // 2)
    away = sum((axis / n - 0.5) ** 2 for axis, n in zip(np.indices(dim), dim)) ** 0.5
    return (away + random.uniform(0, 0.1, dim) < random.uniform(0.25, 0.5)).astype(np.uint8), affine


def main():
    atlas = nibabel.load(ATLAS)
    labels = np.asarray(atlas.dataobj).astype(int)
    conus = sys.argv[1]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 12 if LONG else 3
    random = np.random.default_rng(7)
    compared = 0
    worst = {PARALLEL: 0, OBLIQUE: 0}

    def check(path, threshold, tolerance):
        nonlocal compared
        rows, error = compare(conus, atlas, labels, path, threshold, tolerance)
        compared += rows
        worst[tolerance] = max(worst[tolerance], error)

    with tempfile.TemporaryDirectory() as folder:
        grid = np.indices(labels.shape)
        mask = (sum((grid[a] - (70, 100, 80)[a]) ** 2 for a in range(3)) < 30 ** 2).astype(np.uint8)
        check(write(folder, "mask.nii", mask, atlas.affine), 0, PARALLEL)
        smooth = random.normal(size=(60, 70, 50)).astype(np.float32)
        coarse = np.diag([2.0, 2, 2, 1])
        coarse[:3, 3] = -60, -80, -40
        for threshold in (1.5, -2):
            check(write(folder, "map.nii.gz", smooth, coarse), threshold, PARALLEL)
        oblique = np.array([[2.1, 0.3, -0.2, 8], [-0.25, 1.4, 0.35, -20], [0.15, -0.3, 0.9, 2], [0, 0, 0, 1]])
        check(write(folder, "oblique.nii", smooth[:16, :16, :16], oblique), 1.2, OBLIQUE)
        for number in range(count):
            for is_oblique in (False, True):
                region, affine = random_region(random, number, is_oblique)
                check(write(folder, f"{number}.nii", region, affine), 0, OBLIQUE if is_oblique else PARALLEL)
    pathways = sorted(glob.glob(os.path.join(sys.argv[2], "prob/juelich-fibre-pathways-u16/**/*.nii.gz"),
                                recursive=True)) if len(sys.argv) > 2 else []
    pathways = every(9, pathways)
    for path in pathways:
        check(path, 6554, PARALLEL)  # a tenth of uint16's range
    print(f"{compared} rows as numpy has them, {2 * count} of the regions random and {len(pathways)} Jülich pathways; "
          f"largest errors {worst[PARALLEL]:.1e} and, oblique, {worst[OBLIQUE]:.1e} of a region")


if __name__ == "__main__":
    main()
