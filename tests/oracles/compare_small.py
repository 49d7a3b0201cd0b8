#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Small files of other programs in the shared data (fiducials, markers, tables of labels, transforms, electrodes of NWB)
against what they hold in expected.json: positions, names, colours and parents; and a refusal in words.

usage: compare_small.py CONUS DUMP_POINTS CONUS_HDF5 SHARED_DATA; exit 77 = skipped."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips

import numpy as np

CONUS, DUMP = (os.path.abspath(path) for path in sys.argv[1:3])
os.environ["CONUS_HDF5"] = os.path.abspath(sys.argv[3])
SAMPLES = pathlib.Path(sys.argv[4]) / "files-2026"


def conus(*words, code=0):
    done = subprocess.run([CONUS, *map(str, words)], capture_output=True, text=True, check=False)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done


def write_atlas(path, labels, affine):
    nibabel.save(nibabel.Nifti1Image(labels, affine), path)


def queries(*words, **more):
    return json.loads(conus("query", *words, "--format", "json", "--quiet", **more).stdout)["Queries"]


def fiducials(name, wanted):
    found = queries("cube.nii", "--pose", SAMPLES / "text" / name, "--radius", 1)
    assert [query["query"] for query in found] == wanted["names"], name
    assert np.abs(np.array([query["point_ras"] for query in found]) - wanted["points"]).max() < 1e-6, name


def markers(name, wanted):
    found = queries("cube.nii", "--pose", SAMPLES / "text" / name, "--angle", 5)
    origins = [[row[3] for row in query["world_from_device_ras"][:3]] for query in found]
    assert len(found) == wanted["rows"] and np.abs(np.array(origins) - wanted["origins"]).max() < 1e-6, name
    assert "MNI" in conus("query", "cube.nii", "--pose", SAMPLES / "text" / name, "--angle", 5).stderr


def transform(name, wanted):
    points = np.array(wanted["points"])
    done = subprocess.run([DUMP, SAMPLES / "text" / name], input=np.ascontiguousarray(points[:, :3]).tobytes(),
                          capture_output=True, check=True)
    assert np.abs(np.frombuffer(done.stdout).reshape(-1, 3) - points[:, 3:]).max() < 1e-9, name


def areas(labels_file, numbers):
    labels = np.zeros((8, 8, 2 * len(numbers)), "u1")
    for i, number in enumerate(numbers):
        labels[1:7, 1:7, 2 * i] = number
    write_atlas("areas.nii", labels, np.eye(4))
    text = conus("info", "areas.nii", "--labels", SAMPLES / "text" / labels_file, "--format", "json").stdout
    return {area["index"]: area for area in json.loads(text)["objects"]}


def tree(name, wanted):
    found = areas(name, [int(number) for number in wanted["labels"]])
    for number, words in wanted["labels"].items():
        area = found[int(number)]
        assert area["name"] == words and found[area["parent"]]["name"] == wanted["parents"][number], (name, area)


def colours(name, wanted):
    found = areas(name, [int(number) for number in wanted["colours"]])
    for number, rgb in wanted["colours"].items():
        assert found[int(number)]["color"] == "#%02x%02x%02x" % tuple(rgb), (name, found[int(number)])


def register(name, wanted):
    """FreeSurfer's surface coordinates of an image without its header's place: the middle of the voxels is 0."""
    refused = conus("query", "cube.nii", "--atlas-transform", SAMPLES / "text" / name, "--point", "0,0,0", code=2).stderr
    assert "from" in refused and "to" in refused, refused
    turned = np.diag([-2.0, 1.5, 1, 1])
    turned[:3, 3] = 7, -3, 5
    shapes = {"anatomical.nii": ((8, 10, 12), turned), "movable.nii": ((6, 6, 4), np.diag([3.4375, 3.4375, 5, 1]))}
    surface = {}
    for path, (shape, affine) in shapes.items():
        write_atlas(path, np.ones(shape, "u1"), affine)
        s, n = np.sqrt((affine[:3, :3] ** 2).sum(axis=0)), np.array(shape)
        own = np.zeros((4, 4))
        own[0, 0], own[1, 2], own[2, 1], own[3, 3] = -s[0], s[2], -s[1], 1
        own[:3, 3] = s[0] * n[0] / 2, -s[2] * n[2] / 2, s[1] * n[1] / 2
        surface[path] = affine @ np.linalg.inv(own)
    matrix = np.array(wanted["matrix_rows"])
    world = surface["movable.nii"] @ matrix @ np.linalg.inv(surface["anatomical.nii"])
    text = conus("info", "movable.nii", "--format", "json", "--atlas-transform",
                 f"{SAMPLES / 'text' / name},from=anatomical.nii,to=movable.nii").stdout
    found = np.array(json.loads(text)["moved"]["atlas_from_world"], float)
    assert np.abs(found - world).max() < 1e-5, (found, world)  # the file has 7 digits


def vertices(name, wanted):
    """Two triangles of its six vertices, and one of others."""
    own = wanted["vertices"]
    faces = [own[:3], own[3:], (1, 2, 3)]
    points = np.random.default_rng(1).uniform(-50, 50, (max(own) + 1, 3))
    with open("lh.off", "w", encoding="ascii") as out:
        out.write(f"OFF\n{len(points)} {len(faces)} 0\n")
        out.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in points)
        out.writelines("3 %d %d %d\n" % tuple(face) for face in faces)
    text = conus("info", "lh.off", "--labels", SAMPLES / "text" / name, "--format", "json").stdout
    assert [area["triangles"] for area in json.loads(text)["objects"]] == [2], text


def electrodes(name, wanted):
    """The CCF's grid at 200 um: AP, DV and ML begin in front, above and at the left."""
    affine = np.array([[0, 0, 0.2, 0.1], [-0.2, 0, 0, -0.1], [0, -0.2, 0, -0.1], [0, 0, 0, 1]])
    write_atlas("ccf.nii", np.ones((66, 40, 57), "u1"), affine)
    found = queries("ccf.nii", "--pose", SAMPLES / "hdf5" / name, "--space", "ccf", "--radius", 0.1)
    world = np.array([query["point_ras"] for query in found])
    assert np.abs(world[:, [1, 2, 0]] * [-1000, -1000, 1000] - wanted["xyz"]).max() < 1e-3, name
    assert len(found) == len(wanted["ids"])


CHECKS = {"ras46.fcsv": fiducials, "lps411.fcsv": fiducials, "TriggerMarkers_MNI.xml": markers,
          "f32_last_row.lta": transform, "meshview_tree.json": tree, "random.lut": colours, "register.dat": register,
          "lh.part.label": vertices, "electrodes.nwb": electrodes}


def main():
    if not SAMPLES.is_dir():
        print(f"skipped: {SAMPLES} is not there")
        sys.exit(77)
    wanted = {}
    for folder in ("text", "hdf5"):
        wanted.update(json.loads((SAMPLES / folder / "expected.json").read_text()))
    others = {"itk_old_spelling.h5", "simnibs_efield.hdf5"}  # of compare_composites and compare_simnibs
    assert set(CHECKS) == set(wanted) - others, set(wanted) ^ set(CHECKS)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        write_atlas("cube.nii", np.ones((60, 60, 60), "u1"), np.array([[3.0, 0, 0, -88.5], [0, 3, 0, -88.5], [0, 0, 3, -88.5], [0, 0, 0, 1]]))
        for name, check in CHECKS.items():
            check(name, wanted[name])
        os.chdir("/")
    print(f"{len(CHECKS)} files: as expected")


main()
