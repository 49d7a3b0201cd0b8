#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces and labels of vertices against nibabel: real files, files that nibabel writes here, and broken ones.

Same vertices (1e-5), triangles (but those without area) and labels with names. Where conus refuses what nibabel reads,
it is in a table with the reason. And what `conus query` hits first on them, against every triangle tried here
(the areas of a manifest by 4 needles, by 20 in scripts/test --long).

usage: compare_meshes.py DUMP_MESH CONUS [SHARED_FOLDER]; exit 77 = skipped."""

import glob
import gzip
import json
import os
import re
import subprocess
import sys
import tempfile

try:
    import nibabel as nib
    import numpy as np
    from nibabel import freesurfer, gifti
except ImportError:
    print("skipped: no nibabel")
    sys.exit(77)

from sample import LONG

DUMP = sys.argv[1]
HERE = os.path.dirname(os.path.abspath(__file__))
CONUS = sys.argv[2]
SHARED = sys.argv[3] if len(sys.argv) > 3 else os.environ.get(
    "CONUS_SHARED_DATA", os.path.join(HERE, "../../../shared/data"))

# Real files that nibabel reads, at least in part, and conus refuses.
REFUSED = {
    "nibabel-gifti/ascii_flat_data.gii": ("vertex index", "its indices are of another, larger surface"),
    "nibabel-gifti/base64bin.gii": ("vertex index", "its indices are of another, larger surface"),
    "nibabel-gifti/external.gii": ("other files are not read", "files beside it are read only where allowed"),
    "nibabel-gifti/external.gii.gz": ("other files are not read", "files beside it are read only where allowed"),
    "format-zoo/lh.tinysurface": ("no triangle with an area", "all its vertices are one point"),
}


def dump(mode, path, *more):
    """What conus says of the file: (message or None, lines, bytes)."""
    with tempfile.NamedTemporaryFile() as out:
        run = subprocess.run([DUMP, mode, path, out.name, *more], capture_output=True, encoding="utf-8", check=False)
        if run.returncode not in (0, 1):
            sys.exit(f"{path}: dump_mesh ended with {run.returncode}: {run.stderr}")
        return (run.stderr.strip() if run.returncode else None), run.stdout.splitlines(), out.read()


def is_surface(path):
    return re.search(r"\.gii(\.gz)?$", path) is not None


def surface_of(path):
    """Vertices, triangles by nibabel, or None where it is no surface."""
    if not is_surface(path):
        return freesurfer.read_geometry(path)
    image = nib.load(path)
    points = image.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    triangles = image.get_arrays_from_intent("NIFTI_INTENT_TRIANGLE")
    return (points[0].data.reshape(-1, 3), triangles[0].data.reshape(-1, 3)) if points and triangles else None


def with_area(points, triangles):
    corners = points.astype(np.float32).astype(np.float64)[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return triangles[np.linalg.norm(normals, axis=1) > 0]


def compare_surface(path, short, wanted=None, *more):
    message, lines, data = dump("surface", path, *more)
    points, triangles = wanted or surface_of(path)
    if message:
        sys.exit(f"{short}: refused: {message}")
    counts = dict(line.split(" ", 1) for line in lines if line.startswith(("vertices", "triangles")))
    split = 12 * int(counts["vertices"])
    got = np.frombuffer(data[:split], "<f4").reshape(-1, 3)
    got_triangles = np.frombuffer(data[split:], "<u4").reshape(-1, 3)
    kept = with_area(points, triangles)
    if got.shape != points.shape or np.abs(got - points).max() > 1e-5:
        sys.exit(f"{short}: vertices differ: {got.shape}, {points.shape}")
    if not np.array_equal(got_triangles, kept):
        sys.exit(f"{short}: triangles differ: {got_triangles.shape}, {kept.shape}")
    return len(points), len(kept)


def labels_of(path):
    """Labels, {number: name} by nibabel."""
    if is_surface(path):
        image = nib.load(path)
        names = {label.key: label.label for label in image.labeltable.labels}
        return image.get_arrays_from_intent("NIFTI_INTENT_LABEL")[0].data.ravel().astype(np.int64), names
    colours, table, names = freesurfer.read_annot(path, orig_ids=True)
    labels = np.zeros(len(colours), np.int64)
    for number in range(len(names)):
        labels[(colours == table[number, 4]) & (colours != 0)] = number
    return labels, {k: name.decode() for k, name in enumerate(names)}


def compare_labels(path, short):
    message, lines, data = dump("labels", path)
    labels, names = labels_of(path)
    if message:
        sys.exit(f"{short}: refused: {message}")
    table = {int(n): name for n, _, name in (line.split(" ", 3)[1:] for line in lines if line.startswith("label "))}
    if not np.array_equal(np.frombuffer(data, "<u4"), labels):
        sys.exit(f"{short}: labels differ")
    if table != {k: v for k, v in names.items() if k > 0}:
        sys.exit(f"{short}: names differ: {table}, {names}")
    return labels, len(table)


def compare_split(surface, annot):
    """Each part has as many triangles as have most of their corners in it."""
    _, lines, _ = dump("split", surface, annot)
    labels, _ = labels_of(annot)
    corners = labels[surface_of(surface)[1]]
    winner = np.where(corners[:, 1] == corners[:, 2], corners[:, 1], corners[:, 0])
    wanted = {int(n): int((winner == n).sum()) for n in np.unique(winner) if n}
    got = {int(n): int(t) for n, _, t in (line.split()[1:] for line in lines if line.startswith("part "))}
    if got != wanted or not wanted:
        sys.exit(f"{surface} by {annot}: {got}, wanted {wanted}")
    print(f"{os.path.basename(surface)} by {os.path.basename(annot)}: {len(got)} parts, {sum(got.values())} triangles")


def first_hit(corners, origin, direction):
    """Distance to the first triangle along the ray, and its number (Moeller and Trumbore)."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p = np.cross(direction, ac)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1 / np.einsum("ij,ij->i", ab, p)
        u = np.einsum("ij,ij->i", origin - a, p) * scale
        q = np.cross(origin - a, ab)
        v = (q @ direction) * scale
        t = np.where((u >= 0) & (v >= 0) & (u + v <= 1), np.einsum("ij,ij->i", ac, q) * scale, np.inf)
    t[~(t > 0)] = np.inf
    return t.min(), int(t.argmin())


def compare_queries(what, atlas, corners, names, count=20):
    """A needle from outside through random points: which of `names` (one per triangle) it hits, and how far away."""
    random = np.random.default_rng(1)
    middle = corners.reshape(-1, 3).mean(axis=0)
    hits = 0
    for _ in range(count):
        direction = random.normal(size=3)
        direction /= np.linalg.norm(direction)
        origin = middle + random.uniform(-15, 15, 3) - 200 * direction
        distance, triangle = first_hit(corners, origin, direction)
        text = subprocess.run(
            [CONUS, "query", *atlas, "--origin=" + ",".join(f"{x:.9g}" for x in origin),
             "--direction=" + ",".join(f"{x:.9g}" for x in direction), "--angle", "0.001", "--format", "tsv"],
            check=True, capture_output=True, encoding="utf-8").stdout
        rows = [dict(zip(text.splitlines()[0].split("\t"), row.split("\t"))) for row in text.splitlines()[1:]]
        best = rows[0]
        if not np.isfinite(distance):
            if best["kind"] != "unassigned":
                sys.exit(f"{what}: from {origin} along {direction}: {best}, wanted nothing")
            continue
        hits += 1
        if best["name"] != names[triangle] or abs(float(best["distance_mm"]) - distance) > 0.02:
            sys.exit(f"{what}: from {origin} along {direction}: {best['name']} at {best['distance_mm']}, wanted "
                     f"{names[triangle]} at {distance}")
    print(f"{what}: {count} queries equal, {hits} of them hits")


def query_labelled(surface, annot):
    points, triangles = surface_of(surface)
    labels, names = labels_of(annot)
    owner = labels[triangles]
    owner = np.where(owner[:, 1] == owner[:, 2], owner[:, 1], owner[:, 0])
    corners = points.astype(np.float64)[triangles][owner > 0]
    what = f"{os.path.basename(surface)} by {os.path.basename(annot)}"
    compare_queries(what, [surface, "--labels", annot], corners, [names[int(k)] for k in owner[owner > 0]])


def query_folder(paths, scratch):
    """All of them as the areas of a manifest, by the names in the files."""
    corners, names = [], []
    for path in paths:
        points, triangles = surface_of(path)
        corners.append(points.astype(np.float64)[triangles])
        names += [nib.load(path).meta["Name"]] * len(triangles)
    manifest = os.path.join(scratch, "all.atlas.json")
    with open(manifest, "w", encoding="utf-8") as file:
        json.dump({"conus_atlas": 1, "allow_outside": True,
                   "areas": [{"files": os.path.join(os.path.dirname(os.path.abspath(paths[0])), "*.gii")}]}, file)
    compare_queries(f"{len(paths)} areas of a manifest", [manifest], np.concatenate(corners), names, 20 if LONG else 4)


def compare_shared(folder):
    surfaces = vertices = triangles = 0
    paths = [p for pattern in ("meshes/julich31-areas/lh/*.gii", "meshes/fsaverage5/*.gii.gz", "meshes/format-zoo/*.gii",
                               "meshes/format-zoo/lh.tinysurface", "hostile/nibabel-gifti/*.gii*")
             for p in sorted(glob.glob(os.path.join(folder, pattern)))]
    for path in paths:
        short = "/".join(path.split("/")[-2:])
        if short in REFUSED:
            message, _, _ = dump("surface", path, "ras")
            if not message or REFUSED[short][0] not in message:
                sys.exit(f"{short}: should be refused ({REFUSED[short][1]}): {message}")
            print(f"{short}: refused, {REFUSED[short][1]}")
        elif surface_of(path):
            found = compare_surface(path, short, None, "ras")
            surfaces, vertices, triangles = surfaces + 1, vertices + found[0], triangles + found[1]
        elif nib.load(path).get_arrays_from_intent("NIFTI_INTENT_LABEL"):
            print(f"{short}: {compare_labels(path, short)[1]} labels equal")
        elif "not a surface" not in (dump("surface", path)[0] or ""):
            sys.exit(f"{short}: neither surface nor labels, and not refused as that")
    print(f"{surfaces} surfaces equal: {vertices} vertices, {triangles} triangles")
    for side, name in (("lh", "left"), ("rh", "right")):
        annot = os.path.join(folder, f"meshes/fsaverage5/{side}.aparc.annot")
        print(f"{side}.aparc.annot: {compare_labels(annot, side)[1]} labels equal")
        surface = os.path.join(folder, f"meshes/fsaverage5/pial_{name}.gii.gz")
        compare_split(surface, annot)
        query_labelled(surface, annot)
    with tempfile.TemporaryDirectory() as scratch:
        query_folder(sorted(glob.glob(os.path.join(folder, "meshes/julich31-areas/lh/*.gii"))), scratch)
        # nibabel does not unpack it
        packed, plain = os.path.join(folder, "meshes/format-zoo/lh.aparc.annot.gz"), os.path.join(scratch, "plain.annot")
        with gzip.open(packed) as source, open(plain, "wb") as target:
            target.write(source.read())
        wanted, _ = compare_labels(plain, "lh.aparc.annot")
        if not np.array_equal(np.frombuffer(dump("labels", packed)[2], "<u4"), wanted):
            sys.exit("lh.aparc.annot.gz: labels differ")


POINTS = np.array([[0, 0, 0], [9.5, 0, 0], [0, 8, 0.25], [0, 0, 7]], np.float32)
TRIANGLES = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]], np.int32)


def document(encoding):
    image = gifti.GiftiImage()
    for data, intent in ((POINTS, "NIFTI_INTENT_POINTSET"), (TRIANGLES, "NIFTI_INTENT_TRIANGLE")):
        image.add_gifti_data_array(gifti.GiftiDataArray(data, intent, encoding=encoding))
    return image.to_xml().decode()


def compare_written(scratch):
    """What nibabel writes: every encoding, and FreeSurfer surfaces in the scanner's space of an oblique volume."""
    for encoding in ("ASCII", "B64BIN", "B64GZ"):
        path = os.path.join(scratch, encoding + ".gii")
        open(path, "w").write(document("GIFTI_ENCODING_" + encoding))
        compare_surface(path, path)
    turn = np.array([[-0.8, 0, 0.6], [0.6, 0, 0.8], [0, -1, 0]])
    size, step, centre = np.array([176, 256, 240]), np.array([1.2, 0.9, 1.0]), np.array([3.5, -4, 5])
    path = os.path.join(scratch, "lh.white")
    freesurfer.write_geometry(path, POINTS, TRIANGLES, volume_info={
        "head": [2, 0, 20], "valid": "1  # volume info valid", "filename": "x.mgz", "volume": size, "voxelsize": step,
        "xras": turn[:, 0], "yras": turn[:, 1], "zras": turn[:, 2], "cras": centre})
    header = nib.freesurfer.mghformat.MGHHeader() # nibabel's own matrices of that volume
    header.set_data_shape(size)
    header["goodRASFlag"], header["delta"], header["Mdc"], header["Pxyz_c"] = 1, step, turn.T, centre
    world = header.get_vox2ras() @ np.linalg.inv(header.get_vox2ras_tkr())
    compare_surface(path, path, (nib.affines.apply_affine(world, POINTS), TRIANGLES))
    compare_surface(path, path, None, "ras")
    print("files that nibabel writes: equal")


# name, encoding, the replaced text and its replacement, whether nibabel reads it, the reason for which conus does not
BROKEN = [
    ("Dim0 too large", "ASCII", ('Dim0="4"', 'Dim0="400"'), True, "numbers are missing"),
    ("Dim0 too large", "B64BIN", ('Dim0="4"', 'Dim0="400"'), False, "numbers are missing"),
    ("Dim0 too large", "B64GZ", ('Dim0="4"', 'Dim0="400"'), False, "numbers are missing"),
    ("Dim0 too small", "ASCII", ('Dim0="4"', 'Dim0="2"'), True, "numbers that no Dim asks for"),
    ("Dim0 too small", "B64BIN", ('Dim0="4"', 'Dim0="2"'), False, "numbers that no Dim asks for"),
    ("Dim0 too small", "B64GZ", ('Dim0="4"', 'Dim0="2"'), False, "numbers that no Dim asks for"),
    ("Dim0 negative", "B64GZ", ('Dim0="4"', 'Dim0="-4"'), True, "no number of vertices"),
    ("Dim0 enormous", "B64GZ", ('Dim0="4"', 'Dim0="2000000000"'), False, "more than the packed bytes can be"),
    ("rank 7", "B64GZ", ('Dimensionality="2"', 'Dimensionality="7"'), False, "the standard has 6"),
    ("arrays missing", "B64GZ", ('Arrays="2"', 'Arrays="20"'), True, "a file that was cut and closed"),
    ("byte order", "B64GZ", ("LittleEndian", "BigEndian"), True, "indices out of range"),
    ("base64", "B64BIN", ("<Data>AAAA", "<Data>!!!!"), False, "no base64"),
    ("base64 with foreign bytes", "B64BIN", ("<Data>AAAA", "<Data>AA!AA"), True, "Python skips what is no base64"),
    ("text", "ASCII", ("<Data>", "<Data>abc "), False, "no number"),
    ("index", "ASCII", ("0 2 1", "0 2 999999"), True, "a vertex that is not there"),
    ("NaN", "ASCII", ("9.500000", "nan"), True, "a vertex that is nowhere"),
    ("no triangles", "B64GZ", ("NIFTI_INTENT_TRIANGLE", "NIFTI_INTENT_SHAPE"), True, "not a surface"),
    ("entities", "ASCII", ("<GIFTI", '<!DOCTYPE GIFTI [<!ENTITY a "x">]><GIFTI'), True, "entities are not read"),
]


def compare_broken(scratch):
    path = os.path.join(scratch, "broken.gii")
    for name, encoding, (old, new), nibabel_reads, reason in BROKEN:
        text = document("GIFTI_ENCODING_" + encoding)
        if name == "entities":
            text = re.sub("<!DOCTYPE[^>]*>", "", text)
        if old not in text:
            sys.exit(f"{name}, {encoding}: {old} is not in the file")
        open(path, "w").write(text.replace(old, new))
        message, _, _ = dump("surface", path)
        try:
            nib.load(path)
            read = True
        except Exception: # of many kinds
            read = False
        if not message:
            sys.exit(f"{name}, {encoding}: was read; it should be refused: {reason}")
        if read != nibabel_reads:
            sys.exit(f"{name}, {encoding}: nibabel {'reads' if read else 'refuses'} it, the table has it otherwise")
        print(f"{name}, {encoding}: refused ({reason}){', nibabel reads it' if read else ''}")


with tempfile.TemporaryDirectory() as folder_of_files:
    compare_written(folder_of_files)
    compare_broken(folder_of_files)
if os.path.isdir(os.path.join(SHARED, "meshes")):
    compare_shared(SHARED)
else:
    print(f"left out: no {SHARED}/meshes")
