#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus connect and query --endpoints against numpy and nibabel (Eq. 20): on real tractograms.

Each tractogram of the shared data that nibabel reads gets a labelled volume of its own around it: blobs and holes of
random labels on a turned grid. An end has the label of its voxel; where that is 0, every cell within a window is
measured. Streamlines in a ball are those with a segment no farther from its centre than the radius. Pairs of labels,
counts and mean lengths must be the same, for all streamlines and for those in the ball, at several radii.

usage: compare_endpoints.py CONUS SHARED_DATA; exit 77 = skipped."""

import csv
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips

import numpy as np

FILES = ("fsleyes/dipy_tracks.trk", "fsleyes/spirals.trk", "mrtrix/tracks.tck", "mrtrix/tensor_det.tck",
         "nibabel/complex.trk", "nibabel/simple.tck", "nibabel/standard.trk", "nibabel/standard.LPS.trk")
RADII = (0, 2, 3.3)
LIMIT = 1000  # streamlines of a file that are compared
TURN = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, 0.28, -0.96], [0, 0.96, 0.28]])


def label_grid(random, points):
    """Labels 0 to 12 and world_from_voxel of a grid round the points; half of its voxels are 0."""
    middle, size = (points.max(0) + points.min(0)) / 2, np.ptp(points, axis=0).max() * 1.2 + 4
    spacing = np.array([1, 1.3, 0.9]) * size / 40
    labels = np.kron(random.integers(1, 13, (10, 10, 10)), np.ones((4, 4, 4), int))
    labels[random.uniform(size=labels.shape) < 0.5] = 0
    matrix = np.eye(4)
    matrix[:3, :3] = TURN * spacing
    matrix[:3, 3] = middle - matrix[:3, :3] @ np.array([19.5, 19.5, 19.5])
    return labels, matrix.astype("f4").astype("f8")


def label_at(labels, matrix, point, radius):
    at = np.linalg.solve(matrix[:3, :3], point - matrix[:3, 3])
    cell = np.floor(at + 0.5).astype(int)
    if (cell >= 0).all() and (cell < labels.shape).all() and labels[tuple(cell)]:
        return labels[tuple(cell)]
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    reach = np.ceil(radius / spacing).astype(int) + 1
    low, high = np.maximum(cell - reach, 0), np.minimum(cell + reach + 1, labels.shape)
    if radius == 0 or (low >= high).any():
        return 0
    window = labels[low[0]:high[0], low[1]:high[1], low[2]:high[2]]
    index = np.argwhere(window)
    distance = np.linalg.norm(np.maximum(np.abs(index + low - at) - 0.5, 0) * spacing, axis=1)
    if not len(index) or distance.min() > radius:
        return 0
    return window[tuple(index[distance <= distance.min() + 1e-9].T)].min()


def distance_to(centre, line):
    """From a point to a polyline."""
    if len(line) == 1:
        return np.linalg.norm(line[0] - centre)
    start, step = line[:-1], np.diff(line, axis=0)
    square = np.maximum((step**2).sum(1), 1e-300)
    s = np.clip(((centre - start) * step).sum(1) / square, 0, 1)
    return np.linalg.norm(start + s[:, None] * step - centre, axis=1).min()


def count(lines, labels, matrix, radius):
    """{pair of labels: [how many, their mean length]}"""
    found = {}
    for line in lines:
        ends = [label_at(labels, matrix, end, radius) for end in (line[0], line[-1])]
        key = tuple(sorted(ends, key=lambda label: label or 99))
        found.setdefault(key, []).append(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    return {key: (len(lengths), np.mean(lengths)) for key, lengths in found.items()}


def read(path):
    with open(path, newline="") as table:
        rows = list(csv.DictReader(table, delimiter="\t"))
    number = {"n/a": 0}
    return {tuple(int(number.get(row[f"end_{end}_index"], row[f"end_{end}_index"])) for end in "ab"):
            (int(row["streamlines"]), float(row["mean_length_mm"])) for row in rows}


def same(got, wanted, what):
    if {key: n for key, (n, _) in got.items()} != {key: n for key, (n, _) in wanted.items()}:
        sys.exit(f"{what}: conus {sorted(got.items())}, numpy {sorted(wanted.items())}")
    for key, (_, length) in wanted.items():
        if abs(got[key][1] - length) > 1e-6 * max(1, length):
            sys.exit(f"{what}: {key}: conus {got[key][1]} mm, numpy {length} mm")


def compare(conus, path, random, folder):
    tractogram = nibabel.streamlines.load(path).tractogram
    lines = [np.asarray(line, "f4").astype("f8") for line in tractogram.streamlines if len(line)][:LIMIT]
    file = os.path.join(folder, "some.tck")
    some = nibabel.streamlines.Tractogram([line.astype("f4") for line in lines], affine_to_rasmm=np.eye(4))
    nibabel.streamlines.save(some, file)
    labels, matrix = label_grid(random, np.concatenate(lines))
    volume = os.path.join(folder, "labels.nii")
    image = nibabel.Nifti1Image(labels.astype("u1"), matrix)
    image.set_sform(matrix, 2)
    nibabel.save(image, volume)
    middle = lines[len(lines) // 2]
    centre, ball = np.round(middle[len(middle) // 2], 3), float(np.round(np.ptp(np.concatenate(lines), axis=0).max() / 6, 3))
    away = np.array([distance_to(centre, line) for line in lines])
    if (np.abs(away - ball) < 1e-6).any():
        sys.exit(f"{path}: a streamline touches the ball, choose another radius")
    rows = os.path.join(folder, "rows.tsv")
    for radius in RADII:
        words = [f"--streamlines={file}", f"--endpoint-radius={radius}", "-q"]
        subprocess.run([conus, "connect", volume, *words, "-o", rows, "--force"], check=True)
        same(read(rows), count(lines, labels, matrix, radius), f"{path}, all, {radius} mm")
        point = "--point=" + ",".join(f"{x:.3f}" for x in centre)
        subprocess.run([conus, "query", volume, *words, point, f"--radius={ball}", "--endpoints", rows, "--force"],
                       check=True, stdout=subprocess.DEVNULL)
        chosen = [line for line, distance in zip(lines, away) if distance <= ball]
        same(read(rows), count(chosen, labels, matrix, radius), f"{path}, in the ball, {radius} mm")
    return len(lines), int((away <= ball).sum())


def main():
    conus, tracts = sys.argv[1], os.path.join(sys.argv[2], "tracts")
    if not os.path.isdir(tracts):
        print(f"{tracts} is not there: skipped")
        sys.exit(77)
    random = np.random.default_rng(20)
    totals = np.zeros(2, int)
    for name in FILES:
        with tempfile.TemporaryDirectory() as folder:
            counts = compare(conus, os.path.join(tracts, name), random, folder)
        print(f"{name}: {counts[0]} streamlines, {counts[1]} in the ball: equal")
        totals += counts
    print(f"{len(FILES)} files, {totals[0]} streamlines, {totals[1]} in balls: equal at radii of {RADII} mm")
    if totals[1] < 20:
        sys.exit("too few streamlines in balls")


if __name__ == "__main__":
    main()
