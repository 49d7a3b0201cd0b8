#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""phantom.py FOLDER KIND...: checks phantoms with nibabel and numpy, knowing nothing of conus but the files' contract.

Every voxel is computed again from the shapes in KIND.json and compared; so are sform, qform and the label table.
"""
import csv
import json
import sys

import nibabel
import numpy as np


def ball(shape, p):
    return (p**2).sum(-1) <= shape["radius"] ** 2


def box(shape, p):
    return (abs(p) <= shape["half_edges"]).all(-1)


def ring(shape, p):
    """Nearest of many points on the centre line would do; the angle clamped to the arc is the same, exactly."""
    axis = "xyz".index(shape["axis"])
    a, b, h = p[..., (axis + 1) % 3], p[..., (axis + 2) % 3], p[..., axis]
    start, end = np.radians(shape["from_deg"]), np.radians(shape["to_deg"])
    middle = (start + end) / 2
    turn = np.arctan2(np.sin(np.arctan2(b, a) - middle), np.cos(np.arctan2(b, a) - middle))
    angle = middle + np.clip(turn, start - middle, end - middle)
    radius = shape["radius"]
    off = (a - radius * np.cos(angle)) ** 2 + (b - radius * np.sin(angle)) ** 2 + h**2
    return off <= shape["tube_radius"] ** 2


def painted(truth, affine, dim):
    voxels = np.stack(np.meshgrid(*map(np.arange, dim), indexing="ij"), -1)
    world = nibabel.affines.apply_affine(affine, voxels)
    labels = np.zeros(dim, np.int64)
    for shape in truth["shapes"]:
        inside = {"ball": ball, "box": box, "ring": ring}[shape["shape"]](shape, world - shape["center"])
        labels[inside] = shape["index"]
    return labels


def check(folder, kind):
    with open(f"{folder}/{kind}.json", encoding="utf-8") as file:
        truth = json.load(file)
    with open(f"{folder}/{kind}.tsv", encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file, delimiter="\t"))
    image = nibabel.load(f"{folder}/{kind}.nii.gz")
    assert list(table[0]) == ["index", "name", "abbreviation", "color"], table[0]
    assert [int(row["index"]) for row in table] == [area["index"] for area in truth["areas"]]
    assert [row["name"] for row in table] == [area["name"] for area in truth["areas"]]

    header = image.header
    affine = np.array(truth["world_from_voxel"])
    scale = abs(affine[:3, :3]).max()
    assert header.get_sform(coded=True)[1] == header.get_qform(coded=True)[1] == 1
    assert np.allclose(header.get_sform(), affine, rtol=0, atol=1e-6 * scale + 1e-6)
    # A reader gets w = sqrt(1 - x^2 - y^2 - z^2) from floats: near half a turn that is good to the root of 2^-24 only.
    assert np.allclose(header.get_qform(), affine, rtol=0, atol=4e-4 * scale), header.get_qform() - affine
    assert header.get_intent()[0] == "label" and header.get_xyzt_units()[0] == "mm"

    labels = np.asarray(image.dataobj)
    assert labels.dtype == {1: np.uint8, 2: np.uint16, 4: np.uint32}[labels.dtype.itemsize]
    assert list(labels.shape) == truth["dim"], labels.shape
    wrong = labels != painted(truth, image.affine, labels.shape)
    assert not wrong.any(), f"{kind}: {wrong.sum()} voxels of {labels.size} differ"


for name in sys.argv[2:]:
    check(sys.argv[1], name)
