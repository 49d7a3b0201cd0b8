#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""`conus overlap` of tetrahedra (Eq. 16) against numpy: meshes with fields that h5py writes here by the layout of SimNIBS
(Msh.write_hdf5), of any group, type, order of nodes, tissues and field, in random labels on grids that are parallel to
the world's axes or oblique, of one atlas or two.

What a tetrahedron has in common with a cell is Lawrence's sum over the vertices of the polytope of their ten planes, for a
linear functional c: (c v)^3 / (3! |det| g0 g1 g2) with g from the normals of the three planes at v. That is no clipping
and has no order of faces. Then the sample of another writer.

usage: compare_simnibs.py CONUS CONUS_HDF5 SHARED_DATA [COUNT]: COUNT random meshes, else 20, 60 in scripts/test --long; exit
77 = skipped."""
import csv
import io
import itertools
import json
import os
import subprocess
import sys
import tempfile

try:
    import h5py
    import nibabel
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample import LONG

TOLERANCE = 2e-8  # of the region: nine digits of the table, the rounding of Lawrence's sum, and of slivers
exact = np.longdouble


def lawrence(normals, bounds):
    """Volume of each polytope normals[n, 10, 3] x <= bounds[n, 10]."""
    c = np.array([0.61, -0.37, 0.83], exact)
    total = np.zeros(len(normals), exact)
    for three in map(list, itertools.combinations(range(normals.shape[1]), 3)):
        a, b, d = (normals[:, k] for k in three)
        rows = np.stack([np.cross(b, d), np.cross(d, a), np.cross(a, b)], axis=2)  # det * inverse, by columns
        det = np.einsum("ni,ni->n", a, np.cross(b, d))
        ok = np.abs(det) > 1e-12
        inverse = rows[ok] / det[ok, None, None]
        vertex = np.einsum("nij,nj->ni", inverse, bounds[ok][:, three])
        gamma = np.einsum("nij,i->nj", inverse, c)
        others = [k for k in range(normals.shape[1]) if k not in three]
        inside = np.all(np.einsum("nki,ni->nk", normals[ok][:, others], vertex) <= bounds[ok][:, others], axis=1)
        term = (vertex @ c) ** 3 / (6 * np.abs(det[ok]) * np.prod(gamma, axis=1))
        total[np.flatnonzero(ok)[inside]] += term[inside]
    return total


def planes_of(corners):
    """Normals, of length 1 and outwards, and bounds of the four faces of each tetrahedron."""
    normals, bounds = [], []
    for k in range(4):
        base, one, two, across = (corners[:, (k + i) % 4] for i in range(4))
        normal = np.cross(one - base, two - base)
        normal /= np.linalg.norm(normal.astype(float), axis=1)[:, None]
        normal *= -np.sign(np.einsum("ni,ni->n", normal, across - base))[:, None]
        normals.append(normal)
        bounds.append(np.einsum("ni,ni->n", normal, base))
    return np.stack(normals, axis=1), np.stack(bounds, axis=1)


def volumes_of(corners):
    edges = corners[:, 1:] - corners[:, :1]
    return np.abs(np.linalg.det(edges.astype(float))) / 6


def shares_of(labels, affine, corners):
    """{label: volume of all tetrahedra in it}, mm3, and {label: those that are in it}."""
    inverse = np.linalg.inv(affine)
    place = corners @ inverse[:3, :3].T.astype(exact) + inverse[:3, 3].astype(exact)
    low = np.floor(place.min(axis=1).astype(float) + 0.5).astype(int)
    high = np.ceil(place.max(axis=1).astype(float) - 0.5).astype(int)
    shifts = np.indices((high - low).max(axis=0) + 1).reshape(3, -1).T
    which = np.repeat(np.arange(len(corners)), len(shifts))
    cell = (low[:, None] + shifts).reshape(-1, 3)
    some = np.all(cell <= high[which], axis=1) & np.all((cell >= 0) & (cell < labels.shape), axis=1)
    which, cell = which[some], cell[some]
    normals, bounds = planes_of(place)
    box = np.vstack([np.eye(3), -np.eye(3)]).astype(exact)
    bounds = bounds[which] - np.einsum("nki,ni->nk", normals[which], cell.astype(exact))
    volume = lawrence(np.concatenate([normals[which], np.broadcast_to(box, (len(which), 6, 3))], axis=1),
                      np.hstack([bounds, np.full((len(which), 6), exact(0.5))]))
    volume = np.maximum(volume.astype(float), 0) * abs(np.linalg.det(affine))
    label = labels[tuple(cell.T)]
    found = {one: volume[label == one].sum() for one in np.unique(label)}
    return found, {one: np.unique(which[(label == one) & (volume > 1e-6)]) for one in found}


def write_mesh(path, random, trial):
    """Returns the corners of the tetrahedra, their values, tissues, and how to name the field."""
    count, flat = int(random.integers(10, 60)), int(random.integers(0, 8))
    nodes = random.uniform(-12, 12, (int(random.integers(20, 60)), 3))
    corners = np.array([random.choice(len(nodes), 4, False) for _ in range(count)])
    small = random.random(count) < 0.5  # as in heads: near each other
    for i in np.flatnonzero(small):
        near = np.argsort(np.linalg.norm(nodes - nodes[corners[i, 0]], axis=1))[:8]
        corners[i] = random.permutation(near)[:4]
    vector = random.normal(0, 1, (count + flat, 3))
    types = random.permutation(np.repeat([4, 2], [count, flat]))
    numbers = np.full((count + flat, 4), -1)
    numbers[types == 4] = corners + 1
    numbers[types == 2, :3] = random.integers(1, len(nodes) + 1, (flat, 3))
    tags = random.integers(1, 6, count + flat)
    group = ("", "mesh_roi/", "mesh_leadfield/")[trial % 3]
    whole = ("<i4", "<i8", ">i4", "<i2")[trial % 4]
    real = ("<f4", "<f8", ">f8")[trial % 3]
    with h5py.File(path, "w") as file:
        pack = {"compression": 4, "shuffle": True, "chunks": True} if trial % 2 else {}
        file.create_dataset(group + "nodes/node_coord", data=nodes.astype(real), **pack)
        file.create_dataset(group + "elm/elm_type", data=types.astype(whole), **pack)
        file.create_dataset(group + "elm/tag1", data=tags.astype(whole), **pack)
        file.create_dataset(group + "elm/tag2", data=tags.astype(whole))
        file.create_dataset(group + "elm/node_number_list", data=numbers.astype(whole), **pack)
        file.create_dataset(group + "elmdata/E", data=vector.astype(real), **pack)
        length = np.linalg.norm(vector.astype(real).astype(float), axis=1)
        if trial % 5 < 2:
            length = random.normal(1, 1, count + flat)
            file.create_dataset(group + f"elmdata/{('magnE', 'normE')[trial % 5]}", data=length.astype(real))
        file.create_dataset(group + "elmdata/J", data=10 * vector.astype(real))
        if trial % 7 == 0:  # another mesh, without a field
            file.create_dataset("mesh_electrodes/nodes/node_coord", data=nodes[:4])
            file.create_dataset("mesh_electrodes/elm/elm_type", data=np.int32([4]))
            file.create_dataset("mesh_electrodes/elm/tag1", data=np.int32([1]))
            file.create_dataset("mesh_electrodes/elm/node_number_list", data=np.int32([[1, 2, 3, 4]]))
    key = ""
    if trial % 4 == 3:
        key, length = ",field=J", 10 * np.linalg.norm(vector.astype(real).astype(float), axis=1)
    length = length.astype(real).astype(np.float32)
    stored = nodes.astype(real).astype(float)
    return stored[corners], length[types == 4], tags[types == 4], key


def rows_of(conus, atlases, path, threshold):
    command = [conus, "overlap", atlases[0], path, "--format", "tsv", "--quiet", "--threshold", repr(threshold)]
    for atlas in atlases[1:]:
        command += ["--atlas", atlas]
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    return list(csv.DictReader(io.StringIO(text), delimiter="\t"))


def write_atlas(path, random, oblique):
    affine = np.diag(np.append(random.uniform(2, 5, 3) * random.choice([-1, 1], 3), 1))
    if oblique:
        affine[:3, :3] = np.linalg.qr(random.normal(size=(3, 3)))[0] @ affine[:3, :3]
    affine = affine.astype(np.float32).astype(float)
    affine[:3, 3] = (-affine[:3, :3] @ [3.5, 3.5, 3.5]).astype(np.float32)
    labels = random.integers(0, 4, (8, 8, 8)).astype(np.uint8)
    image = nibabel.Nifti1Image(labels, affine)
    image.set_sform(affine, 1)
    image.set_qform(None, 0)
    nibabel.save(image, path)
    return labels.astype(int), affine


def compare(rows, name, meant, labels, affine):
    corners, values = meant
    volumes = volumes_of(corners)
    shares, members = shares_of(labels, affine, corners.astype(exact))
    shares.pop(0, None)
    rows = [row for row in rows if row.get("atlas", name) == name]
    found = {int(row["index"]): row for row in rows if row["kind"] == "area"}
    worst = 0
    for label, volume in shares.items():
        whole = np.count_nonzero(labels == label) * abs(np.linalg.det(affine))
        volume = min(volume, whole)  # tetrahedra of the samples overlap
        got = float(found[label]["region_fraction"]) if label in found else 0
        worst = max(worst, abs(got - volume / volumes.sum()))
        assert worst <= TOLERANCE, (name, label, got, volume / volumes.sum())
        if label not in found:
            continue
        row = found[label]
        assert np.isclose(float(row["volume_mm3"]), got * volumes.sum(), rtol=1e-8)
        assert np.isclose(float(row["fraction"]), got * volumes.sum() / whole, rtol=1e-8)
        peak = members[label][np.argmax(values[members[label]])]
        assert np.float32(row["peak"]) >= values[peak] * np.float32(1 - 1e-6), (row, values[peak])
        at = [float(row["peak_" + axis]) for axis in "xyz"]
        owners = np.all(np.isclose(corners.mean(axis=1), at, rtol=1e-7, atol=1e-7), axis=1)
        assert np.isclose(values[owners], float(row["peak"]), rtol=1e-6).any(), (row, values[owners])
    assert set(found) <= set(shares)
    rest = [float(row["region_fraction"]) for row in rows if row["kind"] == "unassigned"]
    assert abs(sum(rest) - 1 + sum(shares.values()) / volumes.sum()) <= TOLERANCE * 4, (rest, shares)
    return len(rows), worst


def check_sample(conus, folder, atlas, made):
    """What another writer made."""
    path = os.path.join(folder, "simnibs_efield.hdf5")
    if not os.path.exists(path):
        return "no sample"
    with open(os.path.join(folder, "expected.json"), encoding="utf-8") as file:
        facts = json.load(file)["simnibs_efield.hdf5"]
    with h5py.File(path) as file:
        mesh = file["mesh_roi"]
        values = mesh["elmdata/magnE"][:]
        solid = mesh["elm/elm_type"][:] == 4
        nodes, numbers = mesh["nodes/node_coord"][:], mesh["elm/node_number_list"][:]
    assert (len(nodes), np.count_nonzero(solid)) == (facts["nodes"], facts["tetrahedra"])
    assert np.isclose(values.sum(), facts["magnE_sum"])
    threshold = float(np.median(values))
    region = solid & (values >= np.float32(threshold))
    compare(rows_of(conus, [atlas], path, threshold), "a", (nodes[numbers[region] - 1], values[region]), *made)
    return "the sample, too"


def main():
    conus, os.environ["CONUS_HDF5"], shared = sys.argv[1:4]
    count = int(sys.argv[4]) if len(sys.argv) > 4 else 60 if LONG else 20
    random = np.random.default_rng(39)
    compared, worst = 0, 0
    with tempfile.TemporaryDirectory() as folder:
        mesh = os.path.join(folder, "mesh.hdf5")
        for trial in range(count):
            names = ["a", "b"][: 1 + (trial % 3 == 0)]
            atlases = [os.path.join(folder, name + ".nii") for name in names]
            made = [write_atlas(path, random, bool(random.integers(2))) for path in atlases]
            corners, values, tags, key = write_mesh(mesh, random, trial)
            threshold = float(np.quantile(values, 0.3))
            if threshold <= 0:
                threshold = float(values[values > 0].min())
            region = values >= np.float32(threshold)
            if trial % 2:
                tissues = random.permutation(np.unique(tags[region]))[:2]
                key += ",tissue=" + ":".join(map(str, tissues))
                region &= np.isin(tags, tissues)
            rows = rows_of(conus, atlases, mesh + key, threshold)
            for name, (labels, affine) in zip(names, made):
                number, error = compare(rows, name, (corners[region], values[region]), labels, affine)
                compared += number
                worst = max(worst, error)
        sample = check_sample(conus, os.path.join(shared, "files-2026/hdf5"), atlases[0], made[0])
    print(f"{compared} rows of {count} random meshes as numpy has them, largest error {worst:.1e} of a region; {sample}")


if __name__ == "__main__":
    main()
