#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_ccf.py CONUS SHARED: --space ccf and bregma on the Allen Institute's own surfaces, and on random arrays in numpy.

The vertices of the Allen Institute's OBJ files are AP, DV, ML in micrometres. So the nearest area to a vertex, given as
that position, lies within the surfaces' rounding of it. The surfaces are in the folder SHARED; where it
lacks them, that part is skipped.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import nibabel
import numpy as np

CONUS = sys.argv[1]
BREGMA = np.array([5400.0, 332.0, 5739.0])  # AP, DV, ML: iblatlas, ALLEN_CCF_LANDMARKS_MLAPDV_UM


def bregma_of(ccf):
    """As iblatlas has it: forward, right and up of bregma, here as AP, ML, DV in mm."""
    ap, dv, ml = (np.asarray(ccf, float) - BREGMA).T
    return np.stack([-ap, ml, -dv], 1) / 1000


def labels_at(atlas, space, points, folder, radius):
    """For each point the labels of the areas within the radius, mm, by distance."""
    path = folder / f"{space}.txt"
    np.savetxt(path, points, fmt="%.9g")
    text = subprocess.run([CONUS, "query", str(atlas), "--space", space, "--pose", str(path), "--radius", str(radius),
                           "--format", "ndjson", "--quiet"], check=True, capture_output=True, text=True).stdout
    found = [[] for _ in points]
    for row in map(json.loads, text.splitlines()):
        if row["kind"] == "area":
            found[int(row["query"]) - 1].append((row["index"], row["distance_mm"], row["contact_x"]))
    return found


def compare_arrays(folder):
    """A random array on the CCF's grid of 200 micrometres, as NIfTI of any axis order and sign."""
    rng = np.random.default_rng(7)
    array = rng.integers(1, 5000, (66, 40, 57)).astype(np.uint16)  # AP, DV, ML, each from its first voxel
    points = rng.uniform(0, 1, (200, 3)) * [13199, 7999, 11399]
    voxels = np.floor(points / 200).astype(int)
    wanted = array[tuple(voxels.T)]
    world_from_array = np.array([[0, 0, 0.2, -3], [-0.2, 0, 0, 4], [0, -0.2, 0, 5], [0, 0, 0, 1]])
    for turn in ([0, 1, 2], [2, 0, 1], [1, 2, 0]):
        for signs in ([1, 1, 1], [-1, 1, -1], [-1, -1, -1]):
            turned = np.transpose(array, turn)[tuple(slice(None, None, s) for s in signs)]
            array_from_turned = np.zeros((4, 4))
            array_from_turned[3, 3] = 1
            for axis, (of, sign) in enumerate(zip(turn, signs)):
                array_from_turned[of, axis] = sign
                array_from_turned[of, 3] = 0 if sign > 0 else array.shape[of] - 1
            path = folder / "turned.nii.gz"
            nibabel.save(nibabel.Nifti1Image(np.ascontiguousarray(turned), world_from_array @ array_from_turned), path)
            for space, given in (("ccf", points), ("bregma", bregma_of(points))):
                found = [areas[0][0] for areas in labels_at(path, space, given, folder, 1e-4)]
                assert found == wanted.tolist(), (turn, signs, space)
    print("18 layouts of a random array: the label at 200 positions in CCF and from bregma is numpy's")


def vertices_of(path):
    rows = [line.split()[1:4] for line in path.read_text().splitlines() if line.startswith("v ")]
    return np.array(rows, float)


def compare_surfaces(data, folder):
    meshes = data / "meshes" / "brainglobe-allen-ccf2017-subset"
    rng = np.random.default_rng(3)
    points, wanted = [], []
    for path in sorted((meshes / "meshes").glob("*.obj")):
        vertices = vertices_of(path)
        for vertex in vertices[rng.integers(0, len(vertices), 5)]:
            points.append(vertex)
            wanted.append(int(path.stem))
    worst = 0
    for space, given in (("ccf", np.array(points)), ("bregma", bregma_of(points))):
        for label, areas in zip(wanted, labels_at(meshes, space, given, folder, 0.01)):
            distances = [distance for index, distance, _ in areas if index == label]
            assert distances, (space, label, areas)
            worst = max(worst, distances[0])
    assert worst < 1e-5, worst
    print(f"{len(points)} vertices of {len(set(wanted))} surfaces: their area within {worst:.1e} mm")


with tempfile.TemporaryDirectory() as scratch:
    compare_arrays(pathlib.Path(scratch))
    shared = pathlib.Path(sys.argv[2])
    if (shared / "meshes" / "brainglobe-allen-ccf2017-subset").is_dir():
        compare_surfaces(shared, pathlib.Path(scratch))
    else:
        print(f"{shared} has no Allen surfaces: they are skipped")
