#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus connect and query beside MRtrix's tck2connectome and tckedit, by their documented definitions, in numpy.

The scenes are those of compare_endpoints.py. tck2connectome assigns an end to the node of its voxel
(-assignment_end_voxels), or to the nearest one within a radius, by the centres of voxels (-assignment_radial_search);
conus asks for the voxel first, then for the nearest cell, box and all. Edges are counts, or weighted by length
(-scale_length), with the mean of that (-stat_edge mean), or the sum. tckedit includes a streamline that has a point in a
ball; conus one that has a segment there.

* By end voxels all edges are equal: counts, mean lengths, and sums of lengths as count times mean.
* By radial search those streamlines differ whose nearest centre is not that of the nearest cell: they are counted.
* The streamlines that tckedit includes are among those of conus; the others have a segment in the ball, and no point.

Where MRtrix is installed its own answers must be those of numpy, else a line says that it was not asked.

usage: compare_mrtrix.py CONUS SHARED_DATA; exit 77 = skipped."""

import os
import shutil
import subprocess
import sys
import tempfile

from compare_endpoints import FILES, LIMIT, count, distance_to, label_at, label_grid, read, same
from compare_query import nibabel  # or skips

import numpy as np

RADII = (2, 4)  # mm; 4 is tck2connectome's default


def nearest_centre(labels, centres, point, radius):
    """The label, of those that are not 0, whose voxel's centre is nearest, within a radius."""
    away = ((centres - point[:, None])**2).sum(0)
    nearest = away.argmin()
    return labels[nearest] if away[nearest] <= radius**2 else 0


def edges_of(lines, assign):
    """{pair of labels: [how many, their mean length]}, 0 last, and the pair of each line."""
    pairs = [tuple(sorted((assign(line[0]), assign(line[-1])), key=lambda label: label or 99)) for line in lines]
    lengths = {}
    for pair, line in zip(pairs, lines):
        lengths.setdefault(pair, []).append(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())
    return {pair: (len(all_), np.mean(all_)) for pair, all_ in lengths.items()}, pairs


def ask_mrtrix(edges, path, volume, words, folder):
    """tck2connectome's counts and means of lengths, and sums of lengths, against edges."""
    if not shutil.which("tck2connectome"):
        return False
    found = []
    for scale in ([], ["-scale_length", "-stat_edge", "mean"], ["-scale_length"]):
        out = os.path.join(folder, "edges.csv")
        subprocess.run(["tck2connectome", path, volume, out, "-quiet", "-force", "-symmetric", "-keep_unassigned",
                        *words, *scale], check=True)
        found.append(np.loadtxt(out, delimiter=None if " " in open(out).readline() else ",", ndmin=2))
    for (a, b), (number, mean) in edges.items():
        got = [matrix[a, b] for matrix in found]
        if got[0] != number or abs(got[1] - mean) > 1e-4 * mean or abs(got[2] - number * mean) > 1e-4 * number * mean:
            sys.exit(f"{path} {words}: nodes {a} and {b}: MRtrix {got}, numpy {number}, {mean}, {number * mean}")
    if np.triu(found[0]).sum() != sum(number for number, _ in edges.values()):
        sys.exit(f"{path} {words}: MRtrix has {np.triu(found[0]).sum()} streamlines")
    return True


def compare(conus, path, random, folder):
    tractogram = nibabel.streamlines.load(path).tractogram
    lines = [np.asarray(line, "f4").astype("f8") for line in tractogram.streamlines if len(line) > 1][:LIMIT]
    file, volume, rows = (os.path.join(folder, name) for name in ("some.tck", "labels.nii", "rows.tsv"))
    nibabel.streamlines.save(nibabel.streamlines.Tractogram([line.astype("f4") for line in lines],
                                                            affine_to_rasmm=np.eye(4)), file)
    labels, matrix = label_grid(random, np.concatenate(lines))
    image = nibabel.Nifti1Image(labels.astype("u1"), matrix)
    image.set_sform(matrix, 2)
    nibabel.save(image, volume)

    def connect(radius):
        subprocess.run([conus, "connect", volume, f"--streamlines={file}", f"--endpoint-radius={radius}", "-q", "-o", rows,
                        "--force"], check=True)
        return read(rows)

    voxels = count(lines, labels, matrix, 0)
    same(connect(0), voxels, f"{path}, end voxels")
    asked = ask_mrtrix(voxels, file, volume, ["-assignment_end_voxels"], folder)
    others = []
    index = np.nonzero(labels)
    named = labels[index]
    places = matrix[:3, :3] @ index + matrix[:3, 3:]
    for radius in RADII:
        edges, centres = edges_of(lines, lambda point: nearest_centre(named, places, point, radius))
        ask_mrtrix(edges, file, volume, ["-assignment_radial_search", str(radius)], folder)
        cells, pairs = edges_of(lines, lambda point: label_at(labels, matrix, point, radius))
        same(connect(radius), cells, f"{path}, {radius} mm")
        others.append(sum(a != b for a, b in zip(pairs, centres)))
    centre = np.round(lines[len(lines) // 2][len(lines[len(lines) // 2]) // 2], 3)
    ball = float(np.round(np.ptp(np.concatenate(lines), axis=0).max() / 6, 3))
    chosen = os.path.join(folder, "chosen.tck")
    subprocess.run([conus, "query", volume, f"--streamlines={file}", "--point=" + ",".join(f"{x:.3f}" for x in centre),
                    f"--radius={ball}", "--streamlines-out", chosen, "--force", "-q"], check=True,
                   stdout=subprocess.DEVNULL)
    ours = {line.tobytes() for line in nibabel.streamlines.load(chosen).streamlines}
    points = {line.astype("f4").tobytes() for line in lines if np.linalg.norm(line - centre, axis=1).min() <= ball}
    segments = {line.astype("f4").tobytes() for line in lines if distance_to(centre, line) <= ball}
    if not points <= ours or ours != segments:
        sys.exit(f"{path}: ball: conus has {len(ours)}, by points {len(points)}, by segments {len(segments)}")
    if shutil.which("tckedit"):
        subprocess.run(["tckedit", file, chosen, "-include", ",".join(f"{x}" for x in (*centre, ball)), "-quiet",
                        "-force"], check=True)
        if {line.tobytes() for line in nibabel.streamlines.load(chosen).streamlines} != points:
            sys.exit(f"{path}: ball: tckedit does not include those with a point in it")
    print(f"{path}: {len(lines)} streamlines, by end voxels equal; by radial search of {RADII} mm {others} differ; "
          f"in the ball {len(ours)}, with a point there {len(points)}")
    return np.array([len(lines), *others, len(ours), len(points)]), asked


def main():
    conus, tracts = sys.argv[1], os.path.join(sys.argv[2], "tracts")
    if not os.path.isdir(tracts):
        print(f"{tracts} is not there: skipped")
        sys.exit(77)
    random = np.random.default_rng(40)
    totals = np.zeros(5, int)
    for name in FILES:
        with tempfile.TemporaryDirectory() as folder:
            counts, asked = compare(conus, os.path.join(tracts, name), random, folder)
        totals += counts
    print(f"{len(FILES)} files, {totals[0]} streamlines: by end voxels all equal, by radial search "
          f"{totals[1]} and {totals[2]} differ; in balls {totals[3]}, with a point there {totals[4]}; "
          f"MRtrix's own answers were {'equal to numpy' if asked else 'not asked for: it is not installed'}")
    if totals[3] < 20 or not totals[1]:
        sys.exit("too few streamlines")


if __name__ == "__main__":
    main()
