#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""ccf.py: a made-up annotation on the Allen CCF's grid, in the forms in which that comes, with Python's own library.

The array is 66 x 40 x 57 voxels of 200 micrometres: AP from anterior, DV from superior, ML as the Allen Institute
counts, from the left. Written here: allen.nrrd, with the header of the Allen Institute; ras.nii, turned to RAS, with
another origin; globe/, as BrainGlobe has it; points.txt and expected.txt: positions in CCF and the labels there;
bregma.txt: the same positions in mm from bregma. The array in other storage: left.nii, along L, A, S; plain.nii and
turned.nii, whose axes AP, DV, ML are called x, y, z, and -x, y, z; third/, BrainGlobe's third release. probe.json,
devices.tsv, bare.tsv (without up) and devices_ccf.tsv: three probes of four shanks, and contacts.txt, bare.txt: the
labels at their contacts, contacts_30.txt those after a roll of 30 degrees.
"""
import array
import itertools
import json
import math
import pathlib
import struct

SHAPE = 66, 40, 57
BREGMA = 5400, 332, 5739  # AP, DV, ML


def label(i, j, k):
    """Blocks of 6 x 8 x 19 voxels, each with a label of its own, so that no axis can be mistaken for another."""
    return 1 + i // 6 + 11 * (j // 8) + 55 * (k // 19)


def write_nrrd(path):
    head = """NRRD0004
type: unsigned short
dimension: 3
space: left-posterior-superior
sizes: 66 40 57
space directions: (200,0,0) (0,200,0) (0,0,200)
kinds: domain domain domain
endian: little
encoding: raw
space origin: (0,0,0)

"""
    voxels = array.array("H", [label(i, j, k) for k, j, i in itertools.product(*map(range, reversed(SHAPE)))])
    pathlib.Path(path).write_bytes(head.encode() + voxels.tobytes())


def write_nifti(path, shape, steps, firsts, labels):
    """World mm of voxel n along an axis: its first + n times its step."""
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *shape, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 512, 16)
    struct.pack_into("<8f", head, 76, 1, 0.2, 0.2, 0.2, 1, 1, 1, 1)
    struct.pack_into("<2f", head, 108, 352, 1)
    struct.pack_into("<2h", head, 252, 0, 1)
    for row, (step, first) in enumerate(zip(steps, firsts)):
        line = [0.0] * 4
        line[row], line[3] = step, first
        struct.pack_into("<4f", head, 280 + 16 * row, *line)
    head[344:348] = b"n+1\0"
    pathlib.Path(path).write_bytes(bytes(head) + array.array("H", labels).tobytes())


def write_niftis():
    """ras.nii: x = ML - 5.7, y = 5 - AP, z = 1 - DV mm: i is k of the array, j and k count i and j backward."""
    firsts = -5.7 + 0.1, 5 - 13.2 + 0.1, 1 - 8 + 0.1
    ras = [label(65 - b, 39 - c, a) for c in range(40) for b in range(66) for a in range(57)]
    write_nifti("ras.nii", (57, 66, 40), (0.2, 0.2, 0.2), firsts, ras)
    left = [label(65 - b, 39 - c, 56 - a) for c in range(40) for b in range(66) for a in range(57)]
    write_nifti("left.nii", (57, 66, 40), (-0.2, 0.2, 0.2), (5.7 - 0.1, *firsts[1:]), left)
    own = [label(i, j, k) for k, j, i in itertools.product(*map(range, reversed(SHAPE)))]
    write_nifti("plain.nii", SHAPE, (0.2, 0.2, 0.2), (0.1, 0.1, 0.1), own)
    write_nifti("turned.nii", SHAPE, (-0.2, 0.2, 0.2), (-0.1, 0.1, 0.1), own)


def write_tiff(path):
    """Pages along AP, rows along DV, columns along ML; each page is one strip, and its directory follows it."""
    pages, rows, columns = SHAPE
    size = 2 * rows * columns
    data = bytearray(b"II*\0" + struct.pack("<I", 8 + size))
    for i in range(pages):
        start = len(data)
        data += array.array("H", [label(i, j, k) for j in range(rows) for k in range(columns)]).tobytes()
        tags = ((256, columns), (257, rows), (258, 16), (259, 1), (262, 1), (273, start), (277, 1), (278, rows),
                (279, size))
        data += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
        data += struct.pack("<I", len(data) + 4 + size if i + 1 < pages else 0)
    path.write_bytes(bytes(data))


def write_globe(folder):
    folder.mkdir()
    write_tiff(folder / "annotation.tiff")
    names = [{"id": n, "acronym": f"A{n}", "name": f"area {n}", "structure_id_path": [n],
              "rgb_triplet": [n % 256, 9, 9]} for n in range(1, 166)]
    (folder / "structures.json").write_text(json.dumps(names))
    (folder / "metadata.json").write_text(json.dumps(
        {"name": "allen_mouse", "orientation": "asr", "resolution": [200.0] * 3, "shape": SHAPE}))


def write_third(root):
    """One chunk, which nothing packs."""
    def put(path, words):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(words if isinstance(words, str) else json.dumps(words))

    parts = {name: {"name": f"allen_mouse-{name}", "version": "1.0", "location": f"/{folder}/allen_mouse-{name}/1_0"}
             for folder, name in (("terminologies", "terminology"), ("annotation-sets", "annotation"))}
    put(root / "atlases/allen_mouse_200um/1_0/manifest.json",
        {"name": "allen_mouse", "location": "/atlases/allen_mouse_200um/1_0", "resolution": [200.0] * 3,
         "orientation": "asr", "version": "1.0", "shape": SHAPE, "terminology": parts["terminology"],
         "annotation_set": {**parts["annotation"], "terminology": parts["terminology"]}})
    rows = "".join(f"{n},,{n},area {n},A{n},#090909,[{n}]\n" for n in range(1, 166))
    put(root / "terminologies/allen_mouse-terminology/1_0/terminology.csv",
        "identifier,parent_identifier,annotation_value,name,abbreviation,color_hex_triplet,root_identifier_path\n" + rows)
    store = root / "annotation-sets/allen_mouse-annotation/1_0/annotations_compressed.ome.zarr"
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    level = {"path": "s0", "coordinateTransformations": [{"type": "scale", "scale": [0.2] * 3}]}
    put(store / "zarr.json", {"zarr_format": 3, "node_type": "group", "attributes": {"ome": {
        "version": "0.5", "multiscales": [{"axes": axes, "datasets": [level]}]}}})
    put(store / "s0/zarr.json", {
        "zarr_format": 3, "node_type": "array", "shape": SHAPE, "data_type": "uint16",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": SHAPE}}, "fill_value": 0,
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "codecs": [{"name": "bytes", "configuration": {"endian": "little"}}]})
    put(store / "s0/c/0/0/0", "")
    (store / "s0/c/0/0/0").write_bytes(
        array.array("H", [label(*at) for at in itertools.product(*map(range, SHAPE))]).tobytes())


# Of each probe: its tip, its direction and an up, in ML, AP, DV mm from bregma, which are right-handed: right, anterior,
# dorsal. The last one points nearly down.
DEVICES = (((0.7, -1.1, -5.3), (0.2, 0.3, -0.93), (0, 1, 0)),
           ((-1.3, -3.2, -4.1), (0.9, -0.2, -0.4), (0.1, 0.2, 1)),
           ((1.2, -1.5, -5.9), (0.01, -0.02, -1), (1, 0.5, 0)))
CONTACTS = (0, 0), (1000, 300), (2500, 900), (4100, 2100)  # x across the shanks and y above the tip, um


def cross(a, b):
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def unit(a):
    length = math.hypot(*a)
    return [v / length for v in a]


def labels_of_contacts(with_up, roll, hand=1):
    """Eq. 2 in ML, AP, DV: z = -d, x = up x z, y = z x x; y turns towards x. The device's y is not in its contacts."""
    found = []
    for tip, along, up in DEVICES:
        z = [-v for v in unit(along)]
        up = up if with_up else (0, 0, 1) if abs(z[2]) <= 0.999 else (0, 1, 0)
        x = unit(cross(up, z))
        y = cross(z, x)
        x = [hand * (math.cos(roll) * a - math.sin(roll) * b) for a, b in zip(x, y)]
        for right, above in CONTACTS:
            ml, ap, dv = (t + right / 1000 * a + above / 1000 * b for t, a, b in zip(tip, x, z))
            um = BREGMA[0] - 1000 * ap, BREGMA[1] - 1000 * dv, BREGMA[2] + 1000 * ml
            found.append(label(*(int(v // 200) for v in um)))
    return found


def write_devices():
    probe = {"ndim": 2, "si_units": "um", "contact_positions": CONTACTS, "shank_ids": list("0123"),
             "probe_planar_contour": [[0, 0], [9, 99], [-9, 99]]}
    pathlib.Path("probe.json").write_text(json.dumps({"specification": "probeinterface", "probes": [probe] * 3}))
    for name, with_up, roll in (("contacts.txt", True, 0), ("bare.txt", False, 0), ("contacts_30.txt", True, 30)):
        labels = labels_of_contacts(with_up, math.radians(roll))
        assert labels != labels_of_contacts(with_up, math.radians(roll), -1)
        pathlib.Path(name).write_text("".join(f"{n}\n" for n in labels))
    names = [prefix + axis for prefix in ("", "d", "u") for axis in ("ml", "ap", "dv")]
    rows = [[v for part in device for v in part] for device in DEVICES]
    ccf = [[BREGMA[2] + 1000 * tip[0], BREGMA[0] - 1000 * tip[1], BREGMA[1] - 1000 * tip[2],
            *(s * v for part in (along, up) for s, v in zip((1, -1, -1), part))] for tip, along, up in DEVICES]
    for name, lines, count in (("devices.tsv", rows, 9), ("bare.tsv", rows, 6), ("devices_ccf.tsv", ccf, 9)):
        pathlib.Path(name).write_text("".join("\t".join(map(str, line[:count])) + "\n" for line in [names, *lines]))


def main():
    write_nrrd("allen.nrrd")
    write_niftis()
    write_globe(pathlib.Path("globe"))
    write_third(pathlib.Path("third"))
    write_devices()
    points = [(5433, 341, 5761), (30, 40, 50), (13170, 7960, 11350), (8230, 4444, 2020), (1550, 1650, 3750),
              (9990, 6410, 9630)]
    labels = [label(*(um // 200 for um in point)) for point in points]
    mm = [((BREGMA[0] - ap) / 1000, (ml - BREGMA[2]) / 1000, (BREGMA[1] - dv) / 1000) for ap, dv, ml in points]
    for name, rows in (("points.txt", points), ("bregma.txt", mm), ("expected.txt", [(n,) for n in labels])):
        pathlib.Path(name).write_text("".join(" ".join(map(str, row)) + "\n" for row in rows))


main()
