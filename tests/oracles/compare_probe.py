#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus query --probe against numpy: random probes of ProbeInterface in a random volume of labels with an area tree.

Positions, units, turned probes, channels and names follow from the files by a second reading. The area at a contact is
the label of its voxel. The tables of the draft BEP032 are checked by its rules: columns and their order, names that
are unique and refer to each other, L and R, ids, the method in one place only, and for each probe the smallest area of
the tree that contains all contacts. Of several thousand sites every answer is that of its point alone.

usage: compare_probe.py CONUS; exit 77 = skipped."""

import csv
import io
import json
import os
import subprocess
import sys
import tempfile

from compare_query import nibabel  # or skips

import numpy as np

TREE = {1: ("A one", 21), 2: ("A two", 21), 3: ("B, three", 22), 4: ("B four", 22), 5: ("C five", 11),
        21: ("A", 11), 22: ("B", 11), 11: ("brain", None), 6: ("alone", None)}
MICROMETRES = {"um": 1, "mm": 1e3, "m": 1e6}


def conus(program, *words):
    return subprocess.run([program, "query", *words], check=True, capture_output=True, text=True)


def table(text):
    return list(csv.DictReader(io.StringIO(text), delimiter="\t", quoting=csv.QUOTE_NONE))


def write_volume(random):
    """Blocks of 4 mm, some of them empty, on voxels of 1 mm around x = 0."""
    blocks = random.choice([0, 1, 2, 3, 4, 5, 6], size=(12, 12, 12), p=[0.1] + [0.15] * 6)
    labels = np.kron(blocks, np.ones((4, 4, 4), int)).astype("u1")
    affine = np.diag([1, 1, 1, 1.0])
    affine[:3, 3] = -23.5
    nibabel.Nifti1Image(labels, affine).to_filename("atlas.nii")
    with open("atlas.tsv", "w", encoding="utf-8") as out:
        out.write("index\tname\tparent_id\n")
        out.writelines(f"{label}\t{name}\t{parent or 'n/a'}\n" for label, (name, parent) in TREE.items())
    return labels


def make_probe(random, shanks, dims, unit, span):
    """A probe, and of its contacts the ids, shanks, channels, and offsets in mm across, along, off its plane."""
    count = int(random.integers(2, 9)) * shanks
    across = np.repeat(np.arange(shanks) * 250.0, count // shanks) + random.integers(0, 3, count) * 16
    along, off = random.uniform(0, span, count), random.uniform(-50, 50, count) * (dims == 3)
    origin = random.uniform(-1000, 1000, 2)  # anywhere: the maker's choice
    tip = np.array([20.0, -random.uniform(20, 300)])
    contour = [[-10, span + 500], [-10, 0], tip, [60, 0], [60, span + 500]]
    start = int(random.integers(5))
    contour = (contour[start:] + contour[:start])[:: int(random.choice([-1, 1]))]
    axes = np.eye(3)[:, random.permutation(3)] if dims == 3 else np.eye(3)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])

    def file_points(points):
        points = np.array([[*p, 0][:3] for p in points]) + [*origin, 0]
        return ((points @ axes.T)[:, :dims] / MICROMETRES[unit]).tolist()

    order = random.permutation(count)
    across, along, off = across[order], along[order], off[order]
    names = [f"e{i}" for i in random.permutation(count)] if random.random() < 0.7 else None
    channels = np.where(random.random(count) < 0.2, -1, random.permutation(count)) if random.random() < 0.7 else None
    shank = [str(int(x // 250)) for x in across]
    probe = {"ndim": dims, "si_units": unit, "contact_positions": file_points(np.c_[across, along, off]),
             "probe_planar_contour": file_points(contour), "annotations": {"name": "random"}}
    if dims == 3:
        probe["contact_plane_axes"] = [[axes[:, 0].tolist(), axes[:, 1].tolist()]] * count
    if names:
        probe["contact_ids"] = names
    if channels is not None:
        probe["device_channel_indices"] = channels.tolist()
    if shanks > 1:
        probe["shank_ids"] = shank
    offsets = np.c_[across - tip[0], along - tip[1], off] / 1000
    known = {"ids": names or [str(i) for i in range(count)], "shanks": shank if shanks > 1 else ["n/a"] * count,
             "channels": ["n/a"] * count if channels is None else [str(c) for c in channels], "offsets": offsets,
             "positions": np.array(probe["contact_positions"]) * MICROMETRES[unit]}
    return probe, known


def random_rotation(random):
    matrix, _ = np.linalg.qr(random.normal(size=(3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))


def place(known, tip, rotation, roll):
    """Columns of the rotation: the device's right, up, and away from where it points."""
    right, up, back = rotation.T
    right, up = np.cos(roll) * right - np.sin(roll) * up, np.cos(roll) * up + np.sin(roll) * right
    across, along, off = known["offsets"].T[:, :, None]
    return tip + across * right + along * back - off * up


def chain(label):
    found = []
    while label:
        found.append(label)
        label = TREE[label][1]
    return found


def smallest_common(labels):
    chains = [chain(label) for label in labels]
    return next((area for area in chains[0] if all(area in other for other in chains)), None)


def label_at(labels, points):
    voxels = np.floor(points + 24).astype(int)
    inside = ((voxels >= 0) & (voxels < 48)).all(axis=1)
    return np.where(inside, labels[tuple(np.clip(voxels, 0, 47).T)], 0)


def check_draft(text, probes_text, sidecar, names, knowns, points, found):
    rows, probes = table(text), table(probes_text)
    assert text.splitlines()[0].split("\t") == [
        "name", "probe_name", "x", "y", "z", "hemisphere", "shank_id", "anatomical_location", "anatomical_location_id",
        "localization_method"]
    assert probes_text.splitlines()[0].split("\t")[:2] == ["probe_name", "type"]
    assert [row["name"] for row in rows] == names and len(set(names)) == len(names)
    assert [probe["probe_name"] for probe in probes] == [f"probe{i + 1}" for i in range(len(knowns))]
    owners = np.repeat(np.arange(len(knowns)), [len(known["ids"]) for known in knowns])
    assert [row["probe_name"] for row in rows] == [f"probe{i + 1}" for i in owners]
    assert "draft" in sidecar["BIDSExtension"] and "LocalizationMethod" not in sidecar
    assert set(rows[0]) <= set(sidecar)  # each column is described
    assert all(row["localization_method"].startswith("conus ") for row in rows)
    assert {row["anatomical_location_id"] for row in rows} == {"n/a"}  # of an atlas without public ids
    written = np.array([[float(row[axis]) if row[axis] != "n/a" else np.nan for axis in "xyz"] for row in rows])
    wanted = np.concatenate([np.pad(k["positions"], ((0, 0), (0, 3 - k["positions"].shape[1])), constant_values=np.nan)
                             for k in knowns])
    assert np.array_equal(np.isnan(written), np.isnan(wanted))
    assert np.nanmax(np.abs(written - wanted)) < 1e-4
    sides = ["L" if x < 0 else "R" for x in points[:, 0]]
    assert [row["hemisphere"] for row in rows] == sides
    assert [row["anatomical_location"] for row in rows] == [TREE[f][0] if f else "n/a" for f in found]
    for i, probe in enumerate(probes):
        own = found[owners == i]
        common = smallest_common(own) if own.all() else None
        assert probe["anatomical_location"] == (TREE[common][0] if common else "n/a"), (probe, own)
        side = {sides[k] for k in np.flatnonzero(owners == i)}
        assert probe["hemisphere"] == (side.pop() if len(side) == 1 else "n/a")


def check_random(program, labels, random):
    count = int(random.choice([1, 1, 2, 3]))
    made = [make_probe(random, int(random.choice([1, 1, 4])), int(random.choice([2, 3])),
                       str(random.choice(list(MICROMETRES))), random.choice([200, 4000, 20000])) for _ in range(count)]
    knowns = [known for _, known in made]
    with open("probe.json", "w", encoding="utf-8") as out:
        json.dump({"specification": "probeinterface", "version": "0.2.26", "probes": [probe for probe, _ in made]}, out)
    rotations = [random_rotation(random) for _ in range(count)]
    tips = [random.uniform(-15, 15, 3) for _ in range(count)]
    degrees = float(random.choice([0, 0, 90, random.uniform(-180, 180)]))
    for path, flip in (("poses.tsv", [1, 1, 1]), ("lps.tsv", [-1, -1, 1])):
        with open(path, "w", encoding="utf-8") as out:
            out.write("x\ty\tz\tdx\tdy\tdz\tux\tuy\tuz\n")
            for tip, rotation in zip(tips, rotations):
                row = np.array([tip, -rotation[:, 2], rotation[:, 1]]) * flip
                out.write("\t".join(map(repr, map(float, row.ravel()))) + "\n")
    points = np.concatenate([place(known, tip, rotation, np.radians(degrees))
                             for known, tip, rotation in zip(knowns, tips, rotations)])
    words = ["atlas.nii", "--probe", "probe.json", "--pose", "poses.tsv", f"--probe-roll={degrees!r}", "--quiet"]
    answer = json.loads(conus(program, *words, "--format", "json").stdout)
    placed = np.array([query["point_ras"] for query in answer["Queries"]])
    assert np.abs(placed - points).max() < 1e-6, np.abs(placed - points).max()
    names = [(f"probe{i + 1}:" if count > 1 else "") + name for i, known in enumerate(knowns) for name in known["ids"]]
    assert [query["query"] for query in answer["Queries"]] == names
    found = label_at(labels, points)
    first = {row["query"]: row for row in reversed(table(conus(program, *words, "--format", "tsv").stdout))}
    indices = [first[name]["index"] for name in names]
    assert indices == [str(f) if f else "n/a" for f in found]
    assert [first[name]["shank_id"] for name in names] == [s for known in knowns for s in known["shanks"]]
    assert [first[name]["channel"] for name in names] == [c for known in knowns for c in known["channels"]]
    conus(program, *words, "--format", "bep032", "--probes", "sub-1_probes.tsv", "-o", "sub-1_electrodes.tsv", "--force")
    words[4] = "lps.tsv"
    conus(program, *words, "--format", "bep032", "--space", "lps", "--coordsystem", "sub-1_space-x_coordsystem.json",
          "-o", "sub-1_space-x_electrodes.tsv", "--force")
    with open("sub-1_space-x_electrodes.tsv", encoding="utf-8") as text:
        placed = np.array([[float(row[axis]) for axis in "xyz"] for row in table(text.read())])
    assert np.abs(placed * [-1, -1, 1] - points).max() < 1e-6
    with open("sub-1_space-x_coordsystem.json", encoding="utf-8") as text:
        assert json.load(text)["MicroephysCoordinateUnits"] == "mm"
    with open("sub-1_electrodes.tsv", encoding="utf-8") as text, open("sub-1_probes.tsv", encoding="utf-8") as probes, \
            open("sub-1_electrodes.json", encoding="utf-8") as sidecar:
        check_draft(text.read(), probes.read(), json.load(sidecar), names, knowns, points, found)
    return len(points)


def check_many(program, count):
    """Each of many sites is answered as its point alone."""
    sites = [[16.0 * (i % 4), 20.0 * (i // 4)] for i in range(count)]
    probe = {"ndim": 2, "si_units": "um", "contact_positions": sites, "probe_planar_contour": [[-9, 1e5], [24, -50], [57, 1e5]]}
    with open("many.json", "w", encoding="utf-8") as out:
        json.dump({"specification": "probeinterface", "probes": [probe]}, out)
    aim = ["--origin=-3,4,-22", "--direction=0.1,0.2,-1", "--quiet"]
    answer = json.loads(conus(program, "atlas.nii", "--probe", "many.json", *aim, "--format", "json").stdout)
    with open("points.txt", "w", encoding="utf-8") as out:
        out.writelines(f"{x!r} {y!r} {z!r}\n" for q in answer["Queries"] for x, y, z in [q["point_ras"]])
    alone = json.loads(conus(program, "atlas.nii", "--pose", "points.txt", "--radius", "0.000001", "--quiet", "--format", "json").stdout)
    keys = ("kind", "index", "rank", "share", "distance_mm", "volume_mm3")
    assert [[row[key] for key in keys] for row in answer["Rows"]] == [[row[key] for key in keys] for row in alone["Rows"]]


def main():
    program = os.path.abspath(sys.argv[1])
    random = np.random.default_rng(11)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        labels = write_volume(random)
        contacts = sum(check_random(program, labels, random) for _ in range(12))
        check_many(program, 2000)
        os.chdir("/")
    print(contacts, "contacts: positions, names, channels and areas are the same, and so are the tables of BEP032")


main()
