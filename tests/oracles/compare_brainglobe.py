#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_brainglobe.py CONUS SHARED_DATA: a whole BrainGlobe folder against the NIfTI volume that it is made of.

AAL at 2 mm becomes annotation.tiff, reference.tiff, structures.json, metadata.json and meshes/ID.obj, in several
orientations. BrainGlobe puts a point of c micrometres into voxel int(c / resolution) (brainglobe_atlasapi, core.py,
_idx_from_coords): c counts from the corner of the grid, and voxel n's centre is (n + 1/2) resolution. So axis a, which
starts at the letter's side, has its voxel n at sign * (n + 1/2) * resolution / 1000 mm. A NIfTI of the same array, whose
affine numpy makes of that, must get the same answer of every cone, voxel for voxel; the meshes, which here are the faces
of the voxels, the same first hits.

Then the samples of the third release, which another program wrote: names, parents, colours and voxels of areas as their
expected.json and terminology.csv say, and the answers of a stack of the equal NIfTI's voxels; one that leads outside is refused.

Exit 77 = skipped."""

import csv
import io
import json
import os
import subprocess
import sys
import tempfile

try:
    import nibabel
    import numpy as np
    import tifffile
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample import LONG, every

AAL = "/usr/share/mricron/templates/aal.nii.gz"
ROOT, LEFT, RIGHT = 9000, 9001, 9002
UM = np.array([2000.0, 2500.0, 1500.0])  # along x, y, z: no two alike, and in mm exact in NIfTI's float32
SIDES = {"L": (0, 1), "R": (0, -1), "P": (1, 1), "A": (1, -1), "I": (2, 1), "S": (2, -1)}
WORDS = ("query", "kind", "rank", "index", "name", "abbreviation", "parent", "hemisphere")
COUNT = 200 if LONG else 100  # cones of a sample of the third release
ORIENTATIONS = ("asr", "ras", "lpi", "sal", "ipr")


def names():
    with open(AAL.replace(".gz", ".txt"), encoding="utf-8") as file:
        return {int(line.split()[0]): line.split()[1] for line in file if line.strip()}


def into(orientation, volume):
    """The array that starts at these sides, of one over x, y, z; and (world axis, sign) of each of its axes."""
    sides = [SIDES[letter.upper()] for letter in orientation]
    array = np.transpose(volume, [axis for axis, _ in sides])
    flips = tuple(slice(None, None, sign) for _, sign in sides)
    return np.ascontiguousarray(array[flips]), sides


def faces_of(mask):
    """Vertices, in voxels from the corner, and triangles of the outer faces of a mask's voxels."""
    padded = np.pad(mask, 1)
    corners, triangles = [], []
    for axis in range(3):
        for step in (1, -1):
            inner = np.argwhere(padded & ~np.roll(padded, -step, axis)) - 1
            u, v = (axis + 1) % 3, (axis + 2) % 3
            square = np.zeros((4, 3))
            square[:, axis] = step > 0
            square[[1, 2], u] = 1
            square[[2, 3], v] = 1
            if step < 0:
                square = square[::-1]
            first = 4 * len(triangles)
            for voxel in inner:
                corners.append(voxel + square)
                triangles.append(first)
                first += 4
    if not corners:
        return np.zeros((0, 3)), np.zeros((0, 3), int)
    points, where = np.unique(np.concatenate(corners), axis=0, return_inverse=True)
    quads = where.reshape(-1, 4)
    return points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def write_obj(path, points, triangles):
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(f"v {x:.1f} {y:.1f} {z:.1f}\n" for x, y, z in points)
        file.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in triangles)


def make_atlas(folder, orientation, volume, labels, meshes):
    """Writes the folder, and the same array as NIfTI beside it; returns the latter's path."""
    array, sides = into(orientation, volume)
    resolution = [UM[axis] for axis, _ in sides]
    os.makedirs(os.path.join(folder, "meshes"))
    tifffile.imwrite(os.path.join(folder, "annotation.tiff"), array.astype("u4"), photometric="minisblack",
                     compression="zlib" if orientation != "ras" else None)
    tifffile.imwrite(os.path.join(folder, "reference.tiff"), (array * 7 % 1000 + 100).astype("u2"))
    tifffile.imwrite(os.path.join(folder, "hemispheres.tiff"), np.ones(array.shape, "u1"), compression="zlib")
    with open(os.path.join(folder, "metadata.json"), "w", encoding="utf-8") as file:
        json.dump({"name": "aal", "orientation": orientation, "resolution": resolution, "shape": array.shape}, file)
    tree = [(ROOT, "root", [ROOT]), (LEFT, "left", [ROOT, LEFT]), (RIGHT, "right", [ROOT, RIGHT])]
    tree += [(n, labels[n], [ROOT, LEFT if labels[n].endswith("_L") else RIGHT, n]) for n in labels]
    with open(os.path.join(folder, "structures.json"), "w", encoding="utf-8") as file:
        json.dump([{"id": n, "acronym": f"a{n}", "name": name, "structure_id_path": path,
                    "rgb_triplet": [n % 256, 7, 9]} for n, name, path in tree], file)
    for n in meshes:
        points, triangles = faces_of(array == n)
        mirrored = np.linalg.det(np.eye(3)[[axis for axis, _ in sides]] * [[sign] for _, sign in sides]) < 0
        write_obj(os.path.join(folder, f"meshes/{n}.obj"), points * resolution,
                  triangles[:, ::-1] if mirrored else triangles)
    affine = np.zeros((4, 4))
    affine[3, 3] = 1
    for a, (axis, sign) in enumerate(sides):
        affine[axis, a] = sign * UM[axis] / 1000
        affine[axis, 3] = sign * UM[axis] / 2000
    nifti = folder + ".nii"
    nibabel.save(nibabel.Nifti1Image(array.astype("i4"), affine), nifti)
    with open(folder + ".txt", "w", encoding="utf-8") as file:
        file.writelines(f"{n} {name}\n" for n, name in labels.items())
    return nifti, affine


def run(conus, *arguments):
    done = subprocess.run([conus, *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{arguments}: {done.stderr}"
    return done.stdout


def write_aims(base, aims, away=300):
    """A table for --pose of (goal, way). Devices are that far away, outside the brain: a mesh, unlike voxels, begins
    where it is entered."""
    path = os.path.join(base, "aims.tsv")
    with open(path, "w", encoding="utf-8") as file:
        file.write("x\ty\tz\ttx\tty\ttz\n")
        for goal, way in aims:
            file.write("\t".join(f"{x:.3f}" for x in [*(goal - away * way), *goal]) + "\n")
    return path


def answers(conus, atlas, table, *more):
    """The rows of each aim of a table, in their order."""
    text = run(conus, "query", atlas, "--pose", table, "--format", "tsv", "-q", *more)
    found = {}
    for row in csv.DictReader(io.StringIO(text), delimiter="\t"):
        found.setdefault(row["query"], []).append(row)
    return list(found.values())


def differences(a, b, tolerances):
    """Rows of both answers, by name, whose columns differ by more than their tolerance (mm, or parts)."""
    a, b = ({row["name"]: row for row in answer} for answer in (a, b))
    if a.keys() != b.keys():
        return [f"areas {sorted(a.keys() ^ b.keys())}"]
    wrong = []
    for name in a:
        for key, tolerance in tolerances.items():
            x, y = a[name][key], b[name][key]
            same = x == y or ("n/a" not in (x, y) and abs(float(x) - float(y)) <= tolerance)
            wrong += [] if same else [f"{name}: {key} {x} and {y}"]
    return wrong


def poses(volume, affine_xyz, count=8, jitter=1):
    generator = np.random.default_rng(3)
    filled = np.argwhere(volume > 0)
    for _ in range(count):
        way = generator.normal(size=3)
        goal = affine_xyz(filled[generator.integers(len(filled))])
        yield np.round(goal + generator.uniform(-jitter, jitter, 3), 3), way / np.linalg.norm(way)


def check(conus, base, orientation, volume, labels, meshes):
    folder = os.path.join(base, orientation)
    nifti, affine = make_atlas(folder, orientation, volume, labels, meshes)
    array, sides = into(orientation, volume)

    def world(voxel):  # of an index over x, y, z
        index = [voxel[axis] if sign > 0 else volume.shape[axis] - 1 - voxel[axis] for axis, sign in sides]
        return nibabel.affines.apply_affine(affine, index)

    def compared(aims, one, other, tolerances):
        """The other's answers, and how those of `one` differ: each an atlas and its options."""
        table = write_aims(base, aims)
        both = [answers(conus, atlas, table, *more) for atlas, more in (one, other)]
        assert len(both[0]) == len(both[1]) == len(aims)
        return both[1], [line for pair in zip(*both) for line in differences(*pair, tolerances(pair[0][0]))]

    def measured(row):
        return {key: 1e-9 for key in row if key not in WORDS}

    wrong = []
    aims = list(poses(volume, world))
    for more in ([], ["--layers", "all"], ["--radius", "6", "--layers", "all"]):
        wrong += compared(aims, (nifti, more), (folder, more), measured)[1]
    alone = (os.path.join(folder, "annotation.tiff"), [])
    wrong += compared(aims, (folder, []), alone, lambda _: {"share": 0, "pixels": 0})[1]
    if meshes:
        aims = list(poses(volume * np.isin(volume, meshes), world))
        one = (folder, ["--angle", "5", "--only", ",".join(labels[n] for n in meshes)])
        other = (os.path.join(folder, "meshes"), ["--angle", "5"])
        seen, apart = compared(aims, one, other, lambda _: {"share": 0.02, "distance_mm": 0.05})
        wrong += apart
        hit = sum(row["name"] in labels.values() for shape in seen for row in shape)
        assert hit >= 8, f"{orientation}: the cones hit {hit} areas on the meshes"
    roles = {volume["role"]: os.path.basename(volume["path"])
             for volume in json.loads(run(conus, "info", folder, "--format", "json"))["volumes"]}
    assert roles == {"parcellation": "annotation.tiff", "context": "reference.tiff"}, roles
    sidecar = json.loads(run(conus, "query", folder, "--origin=0,0,0", "--toward=1,1,1", "--format", "json", "-q"))
    read = {os.path.basename(file["path"]) for file in sidecar["Atlas"]["files"]}
    assert read == {"metadata.json", "structures.json"}, read
    tree = run(conus, "info", folder, "--format", "tree")
    assert "root" in tree and "Precentral_L" in tree
    run(conus, "manifest", folder, "--name", "made", "-q")
    with open(os.path.join(folder, "made.atlas.json"), encoding="utf-8") as file:
        made = json.load(file)
    assert made == {"conus_atlas": 1, "parcellation": {"file": "annotation.tiff"}, "context": {"file": "reference.tiff"}}
    scene = (os.path.join(folder, "made.atlas.json"), [])
    wrong += compared(aims, (folder, []), scene, lambda _: {"share": 0})[1]
    print(f"{orientation}: {array.shape}, {len(wrong)} differ")
    return wrong


def check_third(conus, base, shared):
    samples = os.path.join(shared, "files-2026")
    if not os.path.isdir(samples):
        print(f"skipped: the samples of the third release: {samples} is not there")
        return []
    wrong = []
    with open(os.path.join(samples, "brainglobe/expected.json"), encoding="utf-8") as file:
        expected = json.load(file)
    for path, wanted in expected.items():
        manifest = os.path.join(samples, "brainglobe", path)
        version = os.path.dirname(manifest)
        root = os.path.abspath(os.path.join(version, "../../.."))
        with open(manifest, encoding="utf-8") as file:
            terminology = root + json.load(file)["terminology"]["location"] + "/terminology.csv"
        with open(terminology, encoding="utf-8", newline="") as file:
            colours = {row["annotation_value"]: row["color_hex_triplet"].lower() for row in csv.DictReader(file)}
        info = json.loads(run(conus, "info", version, "--format", "json"))
        found = {str(o["index"]): o for o in info["objects"]}
        assert {n: o["name"] for n, o in found.items()} == wanted["names"], found
        assert {n: o["parent"] for n, o in found.items()} == wanted["parents"], found
        assert {n: o["color"].lower() for n, o in found.items()} == colours, found
        voxels = {n: count for n, count in wanted["voxels_by_label"].items() if n != "0"}
        assert {n: o["voxels"] for n, o in found.items() if o["voxels"]} == voxels, found
        nifti = os.path.join(samples, "brainglobe", wanted["equal_to"])
        image = nibabel.load(nifti)
        array = np.asarray(image.dataobj)
        aims = poses(array, lambda v, a=image.affine: nibabel.affines.apply_affine(a, v), COUNT, 0.1)
        table = write_aims(base, aims, 4)
        stack = os.path.join(base, "third.tiff")  # 100 micrometres exactly, which NIfTI's matrix of 24 bits has not
        tifffile.imwrite(stack, array.T.astype("u4"), photometric="minisblack")
        stack += f",resolution={wanted['resolution_um'][0]},orientation=asr"
        for more in ([], ["--layers", "all"]):
            other = answers(conus, stack, table, "--labels", terminology, *more)
            hit = {row["name"] for answer in other for row in answer}
            assert len(other) == COUNT and hit >= {wanted["names"][n] for n in voxels}, hit
            for one in (version, os.path.dirname(version), manifest):
                rows = answers(conus, one, table, *more)
                assert len(rows) == len(other)
                keys = {key: 0 for key in rows[0][0] if key not in WORDS}
                wrong += [f"{one}: {line}" for pair in zip(rows, other) for line in differences(*pair, keys)]
    outside = os.path.join(samples, "zarr_hostile/escape_brainglobe/brainglobe-atlasapi/atlases/toy_mouse_100um")
    done = subprocess.run([conus, "info", outside], capture_output=True, text=True, check=False)
    assert done.returncode == 3 and "is no folder below the one that holds atlases/" in done.stderr, done.stderr
    print(f"third release: {len(expected)} samples, {len(wrong)} differ")
    return wrong


def main():
    conus, shared = sys.argv[1:3]
    if not os.path.exists(AAL):
        print("skipped: no mricron-data")
        sys.exit(77)
    volume = np.asarray(nibabel.load(AAL).dataobj)[::2, ::2, ::2].astype(int)
    labels = names()
    with_meshes = os.path.exists(os.path.join(os.path.dirname(conus), "conus-mesh"))
    meshes = [n for n in labels if n % 8 < 2] if with_meshes else []
    wrong = []
    with tempfile.TemporaryDirectory() as base:
        for orientation in every(2, ORIENTATIONS):
            wrong += check(conus, base, orientation, volume, labels, meshes)
        wrong += check_third(conus, base, shared)
    print("\n".join(wrong[:20]), end="\n" if wrong else "")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
