#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_cifti.py DUMP_MESH CONUS [SHARED_FOLDER]: .dlabel.nii against nibabel.

Files that nibabel writes here, of AAL's voxels at 4 mm and of two spheres with random labels and medial walls, in several
types, byte orders and kinds of volume, and every real one in SHARED_FOLDER: the labels of all vertices and voxels, their
names and colours, and where the volume lies, must be those that nibabel reads. Of the files made here conus info must
list, with the surfaces beside them, an area for each label of a structure, with as many triangles as have most of their
corners there, and as many voxels, as numpy counts.

Exit 77 = skipped."""

import collections
import csv
import glob
import io
import os
import subprocess
import sys
import tempfile

try:
    import nibabel as nib
    import numpy as np
    from nibabel import cifti2, gifti
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

DUMP, CONUS = sys.argv[1:3]
SHARED = sys.argv[3] if len(sys.argv) > 3 else ""
AAL = "/usr/share/mricron/templates/aal.nii.gz"
STEP = 10000  # docs/formats.md: between labels that structures share
STRUCTURES = {"CortexLeft": "CIFTI_STRUCTURE_CORTEX_LEFT", "CortexRight": "CIFTI_STRUCTURE_CORTEX_RIGHT"}


def sphere(parts, centre, radius):
    """An octahedron whose faces are cut into parts x parts triangles, on a sphere: points and triangles."""
    points, triangles, index = [], [], {}

    def at(point):
        key = tuple(point)
        if key not in index:
            index[key] = len(points)
            points.append(point / np.linalg.norm(point))
        return index[key]

    for signs in np.ndindex(2, 2, 2):
        corners = np.diag(1 - 2 * np.array(signs))
        if np.linalg.det(corners) < 0:
            corners = corners[[0, 2, 1]]
        for i in range(parts):
            for j in range(parts - i):
                def corner(a, b):
                    return at(a * corners[0] + b * corners[1] + (parts - a - b) * corners[2])
                triangles.append((corner(i, j), corner(i + 1, j), corner(i, j + 1)))
                if i + j < parts - 1:
                    triangles.append((corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)))
    return np.array(points) * radius + centre, np.array(triangles)


def write_surface(path, points, triangles, structure):
    meta = gifti.GiftiMetaData({"AnatomicalStructurePrimary": structure})
    space = gifti.GiftiCoordSystem(1, 1, np.eye(4))
    nib.save(gifti.GiftiImage(darrays=[
        gifti.GiftiDataArray(points.astype(np.float32), "NIFTI_INTENT_POINTSET", coordsys=space, meta=meta),
        gifti.GiftiDataArray(triangles.astype(np.int32), "NIFTI_INTENT_TRIANGLE")]), path)


def colour(key):
    return (key * 37 % 256 / 255, key * 91 % 256 / 255, key * 53 % 256 / 255, 1.0)


def write_cifti(path, axes, labels, dtype, big, exponent):
    image = cifti2.Cifti2Image(labels.astype(dtype), axes)
    volume = image.header.matrix.get_index_map(1).volume
    if volume is not None and exponent != -3:
        matrix = volume.transformation_matrix_voxel_indices_ijk_to_xyz
        scale = np.diag([10.0 ** (-3 - exponent)] * 3 + [1])
        matrix.matrix = scale @ matrix.matrix
        matrix.meter_exponent = exponent
    image.nifti_header.set_intent("NIFTI_INTENT_CONNECTIVITY_DENSE_LABELS")
    image.nifti_header.set_data_dtype(np.dtype(dtype).newbyteorder(">" if big else "<"))
    image.update_headers()
    if big:
        header = nib.Nifti2Header(endianness=">")
        for field in ("dim", "intent_code", "intent_name", "datatype", "bitpix"):
            header[field] = image.nifti_header[field]
        xml = nib.nifti1.Nifti1Extension("comment", image.header.to_xml())
        xml._code = 32  # written by Cifti2Extension, in the byte order of the machine
        header.extensions.append(xml)
        data = labels.astype(dtype).reshape((1, 1, 1, 1) + labels.shape)
        nib.save(nib.Nifti2Image(data, None, header), path)
        return
    nib.save(image, path)


def dump(mode, path, *more):
    with tempfile.NamedTemporaryFile() as out:
        run = subprocess.run([DUMP, mode, path, out.name, *more], capture_output=True, encoding="utf-8", check=False)
        assert run.returncode == 0, (path, run.stderr)
        return run.stdout.splitlines(), np.frombuffer(out.read(), np.uint32)


def check_table(lines, present, table, where):
    got = {}
    for line in lines:
        if line.startswith("label "):
            _, number, rgb, name = line.split(" ", 3)
            got[int(number)] = (rgb, name)
    want = {key: ("".join(f"{int(255 * c + 0.5):02x}" for c in table[key][1][:3]), table[key][0].strip())
            for key in present}
    assert got == want, (where, got, want)


def positive(values):
    return np.where(values > 0, values, 0).astype(np.int64)


def check_labels(path, surface_of):
    """All maps, surfaces and voxels of a file, as nibabel reads it; how many vertices and voxels there were."""
    image = nib.load(path)
    names, models = image.header.get_axis(0), image.header.get_axis(1)
    data = np.asarray(image.dataobj)
    compared = 0
    for k in range(len(names)):
        table, chosen = names.label[k], f"{path},map={k}"
        values = positive(data[k])
        for structure, part, axis in models.iter_structures():
            if structure in models.nvertices:
                surface = surface_of(structure, models.nvertices[structure])
                if not surface:
                    continue
                want = np.zeros(models.nvertices[structure], np.int64)
                want[axis.vertex] = values[part]
                lines, got = dump("labels", chosen, surface)
                assert np.array_equal(got, want), (path, k, structure)
                check_table(lines, set(want[want > 0]), table, (path, k, structure))
                compared += len(want)
        voxels = ~models.surface_mask
        if voxels.any():
            want = np.zeros(models.volume_shape, np.int64)
            want[tuple(models.voxel[voxels].T)] = values[voxels]
            lines, got = dump("voxels", chosen)
            assert lines[0] == "dim {} {} {}".format(*models.volume_shape), lines[0]
            assert np.array_equal(got.reshape(models.volume_shape, order="F"), want), (path, k)
            matrix = image.header.matrix.get_index_map(1).volume.transformation_matrix_voxel_indices_ijk_to_xyz
            world = (np.diag([10.0 ** (matrix.meter_exponent + 3)] * 3 + [1]) @ matrix.matrix)[:3].ravel()
            assert np.allclose([float(x) for x in lines[1].split()[1:]], world, rtol=1e-12), (path, lines[1])
            check_table(lines, set(want[want > 0]), table, (path, k))
            compared += want.size
    return compared


def triangle_labels(labels, triangles):
    """The label of most of a triangle's corners, of three different ones the first's."""
    a, b, c = labels[triangles].T
    return np.where((b == c), b, a)


def check_atlas(path, k, surfaces):
    """conus info against what numpy counts in nibabel's arrays."""
    image = nib.load(path)
    names, models = image.header.get_axis(0), image.header.get_axis(1)
    values = positive(np.asarray(image.dataobj)[k])
    voxels = ~models.surface_mask
    want, taken = {}, set(np.unique(values[voxels])) - {0}
    for key, count in collections.Counter(values[voxels]).items():
        if key:
            want[key] = (names.label[k][key][0], count, 0)
    for structure, part, axis in models.iter_structures():
        if structure not in models.nvertices:
            continue
        triangles = surfaces[structure]
        labels = np.zeros(models.nvertices[structure], np.int64)
        labels[axis.vertex] = values[part]
        keys = set(np.unique(labels)) - {0}
        offset = -(-max(taken) // STEP) * STEP if keys & taken else 0
        taken |= {key + offset for key in keys}
        for key, count in collections.Counter(triangle_labels(labels, triangles)).items():
            if key:
                want[key + offset] = (names.label[k][key][0], 0, count)
    run = subprocess.run([CONUS, "info", f"{path},map={k}", "--format", "tsv"], capture_output=True, text=True,
                         check=True)
    got = {}
    for row in csv.DictReader(io.StringIO(run.stdout), delimiter="\t"):
        numbers = [int(row[column]) if row.get(column) not in (None, "", "n/a") else 0
                   for column in ("voxels", "triangles")]
        got[int(row["index"])] = (row["name"], *numbers)
    assert got == want, (path, k, {x: (got.get(x), want.get(x)) for x in got.keys() ^ want.keys() | {
        x for x in got.keys() & want.keys() if got[x] != want[x]}})
    return len(want)


def make_labels(rng, axis, shared, voxel_labels):
    """Two maps: patches on the surfaces with a few vertices without label, and the voxels' own."""
    labels = np.zeros((2, len(axis)))
    for n, (structure, part, model) in enumerate(axis.iter_structures()):
        if structure in axis.nvertices:
            first = 1 if shared else 1 + 1000 * (n + 1)
            labels[0, part] = first + model.vertex // 97
            labels[1, part] = first + rng.integers(0, 3, len(model.vertex))
            labels[:, part] *= rng.random((2, len(model.vertex))) > 0.02
    labels[0, ~axis.surface_mask] = voxel_labels + (0 if shared else 3 * 10**6)
    return labels


def make_files(folder):
    rng = np.random.default_rng(7)
    surfaces = {}
    axis = None
    for x, name in ((-40.0, "CortexLeft"), (40.0, "CortexRight")):
        points, triangles = sphere(9 if x < 0 else 11, np.array([x, -20, 10]), 30)
        write_surface(os.path.join(folder, f"{name}.surf.gii"), points, triangles, name)
        surfaces[STRUCTURES[name]] = triangles
        keep = np.flatnonzero(rng.random(len(points)) > 0.1)
        part = cifti2.BrainModelAxis.from_surface(keep, len(points), STRUCTURES[name])
        axis = axis + part if axis else part
    surface_axis = axis
    aal = nib.load(AAL)
    voxels = np.asarray(aal.dataobj)[::4, ::4, ::4]
    affine = aal.affine @ np.diag([4, 4, 4, 1])
    inside = voxels > 0
    middle = np.arange(len(voxels))[:, None, None] < len(voxels) // 2
    for name, mask in (("thalamus_left", inside & middle), ("brain_stem", inside & ~middle)):
        axis = axis + cifti2.BrainModelAxis.from_mask(mask, affine=affine, name=name)
    voxel_labels = np.concatenate([voxels[inside & middle], voxels[inside & ~middle]])
    paths = []
    for name, models, shared, dtype, big, exponent in (
            ("apart", axis, False, np.float32, False, -3), ("shared", axis, True, np.int32, False, -6),
            ("cortex", surface_axis, True, np.int16, False, -3), ("big", axis, False, np.float64, True, -3)):
        labels = make_labels(rng, models, shared, voxel_labels if models is axis else np.zeros(0))
        keys = np.unique(labels).astype(int)
        table = {key: (f"area <{key}> & é" if key else "???", colour(key)) for key in [0, *keys, 77]}
        path = os.path.join(folder, f"{name}.dlabel.nii")
        write_cifti(path, (cifti2.LabelAxis(["parts", "noise & more"], [table, table]), models), labels, dtype, big,
                    exponent)
        paths.append(path)
    return paths, surfaces


def main():
    if not os.path.exists(AAL):
        print("skipped: no mricron-data")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        paths, surfaces = make_files(folder)

        def surface_of(structure, _):
            return next(os.path.join(folder, f"{name}.surf.gii") for name, word in STRUCTURES.items()
                        if word == structure)
        compared = sum(check_labels(path, surface_of) for path in paths)
        areas = sum(check_atlas(path, k, surfaces) for path in paths for k in range(2))
    print(f"{len(paths)} files of nibabel: {compared} vertices and voxels and {areas} areas are the same")
    real = sorted(glob.glob(os.path.join(SHARED, "**", "*.dlabel.nii"), recursive=True)) if SHARED else []
    compared = sum(check_labels(path, lambda structure, count: None) for path in real)
    print(f"{len(real)} real files, {compared} voxels")
    return 0


if __name__ == "__main__":
    sys.exit(main())
