#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus overlap` on AAL against numpy (Eq. 16): a mask on the atlas's grid, a map on one of 2 mm and an oblique one,
and, where they are, the Jülich fibre pathways.

usage: compare_overlap.py CONUS [DATA]; exit 77 = skipped."""
import csv
import glob
import io
import os
import subprocess
import sys
import tempfile

ATLAS = "/usr/share/mricron/templates/aal.nii.gz"

try:
    import nibabel
    import numpy as np
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)
if not os.path.exists(ATLAS):
    print("skipped: no mricron-data")
    sys.exit(77)


def rows_of(conus, path, threshold):
    command = [conus, "overlap", ATLAS, path, "--format", "tsv", "--quiet"]
    command += ["--threshold", str(threshold)] if threshold else []
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return list(csv.DictReader(io.StringIO(text), delimiter="\t"))


def parts_of(affine):
    """Into how many parts of at most 1 mm, AAL's voxels, each edge of a voxel is cut."""
    return [int(np.ceil(np.linalg.norm(affine[:3, axis]) - 1e-4)) for axis in range(3)]


def labels_at(atlas, labels, points):
    index = np.floor(points @ np.linalg.inv(atlas.affine)[:3, :3].T + np.linalg.inv(atlas.affine)[:3, 3] + 0.5)
    index = index.astype(int)
    inside = np.all((index >= 0) & (index < labels.shape), axis=1)
    found = np.zeros(len(points), int)
    found[inside] = labels[tuple(index[inside].T)]
    return found


def compare(conus, atlas, labels, path, threshold):
    image = nibabel.load(path)
    values = image.get_fdata(dtype=np.float32)
    region = values >= np.float32(threshold) if threshold > 0 else values <= np.float32(threshold)
    region = region if threshold else values != 0
    voxels = np.argwhere(region)
    found = []
    parts = parts_of(image.affine)
    for part in np.ndindex(*parts):
        at = voxels + (np.array(part) + 0.5) / parts - 0.5
        found.append(labels_at(atlas, labels, at @ image.affine[:3, :3].T + image.affine[:3, 3]))
    found = np.stack(found)
    part_mm3 = abs(np.linalg.det(image.affine[:3, :3])) / np.prod(parts)
    atlas_mm3 = abs(np.linalg.det(atlas.affine[:3, :3]))
    rows = rows_of(conus, path, threshold)
    assert {int(row["index"].replace("n/a", "0")) for row in rows} == set(np.unique(found)), path
    for row in rows:
        label = int(row["index"].replace("n/a", "0"))
        volume = np.count_nonzero(found == label) * part_mm3
        there = np.any(found == label, axis=0)
        inside = values[region][there]
        peak = inside.max() if threshold >= 0 else inside.min()
        assert np.isclose(float(row["volume_mm3"]), volume, rtol=1e-7), (path, row, volume)
        assert np.isclose(float(row["region_fraction"]), np.mean(found == label), rtol=1e-7), (path, row)
        assert np.isclose(float(row["peak"]), peak, rtol=1e-6), (path, row, peak)
        place = np.linalg.solve(image.affine, [float(row["peak_" + axis]) for axis in "xyz"] + [1])[:3]
        assert np.float32(values[tuple(np.rint(place).astype(int))]) == peak, (path, row)
        if label:
            whole = np.count_nonzero(labels == label) * atlas_mm3
            assert np.isclose(float(row["fraction"]), min(volume / whole, 1), rtol=1e-7), (path, row)
    volumes = [float(row["volume_mm3"]) for row in rows if row["kind"] != "unassigned"]
    assert volumes == sorted(volumes, reverse=True)
    return len(rows)


def write(folder, name, values, affine):
    image = nibabel.Nifti1Image(values, affine)
    image.set_sform(affine, 4)
    path = os.path.join(folder, name)
    nibabel.save(image, path)
    return path


def main():
    atlas = nibabel.load(ATLAS)
    labels = np.asarray(atlas.dataobj)
    conus = sys.argv[1]
    compared = 0
    random = np.random.default_rng(7)
    with tempfile.TemporaryDirectory() as folder:
        grid = np.indices(labels.shape)
        mask = (sum((grid[a] - (70, 100, 80)[a]) ** 2 for a in range(3)) < 30 ** 2).astype(np.uint8)
        compared += compare(conus, atlas, labels, write(folder, "mask.nii", mask, atlas.affine), 0)
        smooth = random.normal(size=(60, 70, 50)).astype(np.float32)
        coarse = np.diag([2.0, 2, 2, 1])
        coarse[:3, 3] = -60, -80, -40
        path = write(folder, "map.nii.gz", smooth, coarse)
        for threshold in (1.5, -2):
            compared += compare(conus, atlas, labels, path, threshold)
        turn = np.array([[2.1, 0.3, -0.2], [-0.25, 1.4, 0.35], [0.15, -0.3, 0.9]])
        oblique = np.eye(4)
        oblique[:3, :3] = turn
        oblique[:3, 3] = -50, -60, -30
        compared += compare(conus, atlas, labels, write(folder, "oblique.nii", smooth, oblique), 1.2)
    pathways = sorted(glob.glob(os.path.join(sys.argv[2], "prob/juelich-fibre-pathways-u16/**/*.nii.gz"),
                                recursive=True)) if len(sys.argv) > 2 else []
    for path in pathways:
        compared += compare(conus, atlas, labels, path, 6554)  # a tenth of uint16's range
    print(f"{compared} areas covered as numpy has them, {len(pathways)} of the regions Jülich pathways")


if __name__ == "__main__":
    main()
