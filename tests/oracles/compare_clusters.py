#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus overlap --clusters` on AAL against scipy and numpy: clusters by scipy.ndimage.label with 26 neighbours, their
sizes, order, peaks and centres of mass, local maxima by a filter over 3 x 3 x 3 voxels and a greedy search, the area of
each, and the volume of each cluster in each area as compare_overlap.py finds it (Eq. 16). The maps are smooth noise with
hills, on AAL's grid and on others of 2 and 3 mm, parallel and oblique, with thresholds of both signs, also rounded to
halves, where peaks are equal and tops are flat.

usage: compare_clusters.py CONUS [COUNT]: COUNT random maps, else 3, 12 in scripts/test --long; exit 77 = skipped."""
import csv
import os
import subprocess
import sys
import tempfile

try:
    from scipy import ndimage
except ImportError:
    print("skipped: no python3-scipy")
    sys.exit(77)

import compare_overlap as overlap
from sample import LONG

nibabel, np = overlap.nibabel, overlap.np
APART = 8 * (1 - 1e-9)  # mm
CUBE = np.ones((3, 3, 3), int)


def file_order(voxels, shape):
    """Numbers of voxels, i fastest."""
    return np.ravel_multi_index(np.transpose(voxels), shape, order="F")


def world(affine, voxels):
    return np.asarray(voxels) @ affine[:3, :3].T + affine[:3, 3]


def maxima_of(height, inside, affine):
    """Voxels of the local maxima of one cluster, the highest first, at least 8 mm apart."""
    low = np.where(inside, height, -np.inf)
    top = inside & (low >= ndimage.maximum_filter(low, footprint=CUBE, mode="constant", cval=-np.inf))
    found = []
    for value in np.unique(low[top]):
        flats, count = ndimage.label(inside & (low == value), CUBE)
        for flat in range(1, count + 1):
            voxels = np.argwhere(flats == flat)
            if top[tuple(voxels.T)].all():
                found.append((-value, file_order(voxels, inside.shape).min()))
    kept = []
    for value, number in sorted(found):
        voxel = np.array(np.unravel_index(number, inside.shape, order="F"))
        place = world(affine, voxel)
        if all(np.linalg.norm(place - other) >= APART for _, other in kept):
            kept.append((voxel, place))
    return kept


def clusters_of(values, region, sign):
    """Lists of voxels, in the order of conus: by size, peak and place of the peak; each with its peak's voxel."""
    marks, count = ndimage.label(region, CUBE)
    found = []
    for mark, box in enumerate(ndimage.find_objects(marks), 1):
        voxels = np.argwhere(marks[box] == mark) + [part.start for part in box]
        voxels = voxels[np.argsort(file_order(voxels, values.shape))]
        height = sign * values[tuple(voxels.T)]
        found.append((-len(voxels), -height.max(), file_order(voxels[[height.argmax()]], values.shape)[0], voxels,
                      voxels[height.argmax()]))
    assert len(found) == count
    return [entry[3:] for entry in sorted(found, key=lambda entry: entry[:3])]


def number(row, name):
    return float(row[name])


def place_of(row, name):
    return [number(row, f"{name}_{axis}") for axis in "xyz"]


def compare(conus, atlas, labels, folder, name, values, affine, threshold):
    path, table = overlap.write(folder, name, values, affine), os.path.join(folder, "clusters.tsv")
    affine = nibabel.load(path).affine  # in single precision
    command = [conus, "overlap", overlap.ATLAS, path, "--quiet", "--force", "--clusters", table,
               "-o", os.path.join(folder, "areas.tsv")]
    subprocess.run(command + ([f"--threshold={threshold}"] if threshold else []), check=True)
    with open(table) as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    sign = -1 if threshold < 0 else 1
    bound = np.float32(threshold)
    region = values <= bound if threshold < 0 else values >= bound if threshold > 0 else values != 0
    mm3 = abs(np.linalg.det(affine[:3, :3]))
    tolerance = overlap.PARALLEL if overlap.is_parallel(np.linalg.solve(atlas.affine, affine)[:3, :3]) else \
        overlap.OBLIQUE
    at = 0
    wanted = clusters_of(values, region, sign)
    for index, (voxels, peak) in enumerate(wanted, 1):
        own = []
        while at < len(rows) and int(rows[at]["cluster"]) == index:
            own.append(rows[at])
            at += 1
        whole = own[0]
        assert whole["kind"] == "cluster" and int(whole["voxels"]) == len(voxels), (path, index, whole)
        assert np.isclose(number(whole, "volume_mm3"), len(voxels) * mm3, rtol=1e-8), (path, whole)
        assert np.isclose(number(whole, "peak"), values[tuple(peak)], rtol=1e-6), (path, whole)
        assert np.allclose(place_of(whole, "peak"), world(affine, peak), atol=1e-5), (path, whole)
        weight = np.abs(values[tuple(voxels.T)].astype(float))
        centre = world(affine, (weight[:, None] * voxels).sum(axis=0) / weight.sum())
        assert np.allclose(place_of(whole, "centre"), centre, atol=1e-5), (path, whole, centre)
        shares = overlap.shares_of(atlas, labels, affine, voxels)
        parts = {int(row["index"].replace("n/a", "0")): row for row in own
                 if row["kind"] in ("area", "unassigned")}
        for label in set(shares) | set(parts):
            part = shares[label].mean() if label in shares else 0
            got = number(parts[label], "cluster_fraction") if label in parts else 0
            assert abs(part - got) <= tolerance, (path, index, label, part, got)
        maxima = [row for row in own if row["kind"] == "maximum"]
        inside = np.zeros(values.shape, bool)
        inside[tuple(voxels.T)] = True
        tops = maxima_of(sign * values, inside, affine) if threshold else []
        assert len(maxima) == len(tops), (path, index, maxima, tops)
        for row, (voxel, place) in zip(maxima, tops):
            assert np.allclose(place_of(row, "peak"), place, atol=1e-5), (path, row, place)
            assert np.isclose(number(row, "peak"), values[tuple(voxel)], rtol=1e-6), (path, row)
            each = overlap.shares_of(atlas, labels, affine, voxel[None])
            most = max(share[0] for share in each.values())
            label = int(row["index"].replace("n/a", "0"))
            assert each[label][0] >= most - 1e-7, (path, row, each)
    assert at == len(rows), (path, rows[at])
    return len(wanted), sum(row["kind"] == "maximum" for row in rows)


def random_map(random, kind):
    """Smooth noise with hills and hollows."""
    dim = random.integers(14, 26, 3)
    values = ndimage.gaussian_filter(random.normal(size=dim), random.uniform(0.6, 1.4))
    values /= values.std()
    for sign in (1, -1):
        middle = random.uniform(0.2, 0.8, 3) * dim
        away = sum((axis - m) ** 2 for axis, m in zip(np.indices(dim), middle))
        values += sign * 5 * np.exp(-away / random.uniform(8, 40))
    linear = np.eye(3)[random.permutation(3)] * random.choice([-1, 1], 3)
    if kind % 3 == 2:
        linear = np.linalg.qr(random.normal(size=(3, 3)))[0]
    affine = np.eye(4)
    affine[:3, :3] = linear * (2, 3, 2)[kind % 3]
    affine[:3, 3] = np.round(random.uniform((-40, -70, -10), (40, 40, 50))) - affine[:3, :3] @ (dim // 2)
    return values.astype(np.float32), affine


def main():
    atlas = nibabel.load(overlap.ATLAS)
    labels = np.asarray(atlas.dataobj).astype(int)
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 12 if LONG else 3
    random = np.random.default_rng(100)
    clusters = maxima = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind in range(count):
            values, affine = random_map(random, kind)
            halves = np.round(values * 2).astype(np.float32) / 2
            mask = (values > 1.5).astype(np.float32) * 3
            noisy = values.copy()
            noisy.flat[:: 97] = np.nan
            for name, these, threshold in (("map", values, 2.3), ("map", values, -2.3), ("halves", halves, 2),
                                           ("halves", halves, -1.5), ("mask", mask, 0), ("noisy", noisy, 2.3)):
                with np.errstate(invalid="ignore"):
                    found = compare(sys.argv[1], atlas, labels, folder, f"{name}{kind}.nii", these, affine, threshold)
                clusters += found[0]
                maxima += found[1]
    print(f"{clusters} clusters and {maxima} local maxima of {6 * count} maps as scipy and numpy have them")


if __name__ == "__main__":
    main()
