# SPDX-License-Identifier: BSD-3-Clause
"""python3 hdf5.py KIND OUT [N]: a file of HDF5 of another program. Exit code 77 where there is no h5py. KIND is

lead-dbs  MATLAB 7.3: reco.mni.coords_mm, contacts at (10, 20, 30 + i) and none on the left, and native, 1 mm beside
simnibs   MATLAB 7.3: pos(1, 2), each with a name and a matsimnibs
table     MATLAB 7.3: reco is an object
minc      MINC 2: N = 20 voxels of 1 mm each way around 0, a box of label 3 (10 mm) in label 1; each slice has a scale
image     MINC 2: the same grid, values from 0 to 1e-4
colour    MINC 2 with a vector_dimension
chunks    MINC 2 whose chunks are of 20 MB each, and which stores none
heap      MINC 2 whose chunk says that it has 3 GiB
nwb       electrodes at the positions "x y z" of the lines of points.txt, in micrometres
allensdk  the same, but that z is y
field     a mesh of SimNIBS around 0: tetrahedra of 36 mm3 (tissue 2, |E| 1) and 72 mm3 (tissue 1, |E| 2), J is 10 E
localized electrodes at 0, and their positions in a table of ndx-anatomical-localization, the last one first"""
import struct
import sys

try:
    import h5py
    import numpy as np
except ImportError:
    sys.exit(77)


def matlab(path, fill):
    """A file of level 7.3 that `fill` fills."""
    with h5py.File(path, "w", userblock_size=512) as file:
        fill(file)
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\0\2IM")


def put(file, path, kind, data):
    """A dataset of the class `kind`, or a group, where data is None. MATLAB's first dimension is the last one here."""
    node = file.create_group(path) if data is None else file.create_dataset(path, data=data)
    node.attrs["MATLAB_class"] = np.bytes_(kind)
    return node


def references(*nodes):
    """Those to a row of arrays."""
    out = np.empty((len(nodes), 1), h5py.ref_dtype)
    out[:, 0] = [node.ref for node in nodes]
    return out


def lead_dbs(file):
    none = put(file, "#refs#/none", "double", np.zeros(2, "u8"))
    none.attrs["MATLAB_empty"] = np.uint8(1)
    put(file, "reco", "struct", None)
    for i, space in enumerate(["mni", "native"]):
        put(file, f"reco/{space}", "struct", None)
        contacts = np.array([[10 + i, 20, 30 + z] for z in range(4)], float)
        right = put(file, f"#refs#/{space}", "double", contacts.T)
        put(file, f"reco/{space}/coords_mm", "cell", references(right, none))


def simnibs(file):
    names = []
    poses = []
    for i, name in enumerate(["M1 left", "häufig"]):
        units = np.frombuffer(name.encode("utf-16-le"), "<u2")
        names.append(put(file, f"#refs#/name{i}", "char", units[:, None]))
        pose = np.array([[-1, 0, 0, 1 + i], [0, 1, 0, 2], [0, 0, -1, 90], [0, 0, 0, 1]], float)
        poses.append(put(file, f"#refs#/pose{i}", "double", pose.T))
    put(file, "pos", "struct", None)
    file["pos/name"] = references(*names)
    file["pos/matsimnibs"] = references(*poses)


def table(file):
    put(file, "reco", "table", np.zeros((1, 6), "u4")).attrs["MATLAB_object_decode"] = np.int32(3)


def minc(file, values, names):
    """A volume in 16 bits, which a scale of each slice makes of the values."""
    file.create_group("minc-2.0/info")
    low, high = values.min(axis=(1, 2)), values.max(axis=(1, 2))
    width = (high - low)[:, None, None]
    stored = np.rint((values - low[:, None, None]) / np.where(width, width, 1) * 65535).astype("u2")
    for name, data in (("image", stored), ("image-min", low), ("image-max", high)):
        node = file.create_dataset(f"minc-2.0/image/0/{name}", data=data)
        node.attrs["dimorder"] = np.bytes_(",".join(names[: data.ndim]))
    for name, length in zip(names, stored.shape):
        node = file.create_dataset(f"minc-2.0/dimensions/{name}", data=np.int32(0))
        facts = {"start": 0.5 - length / 2, "step": 1.0, "length": length, "spacing": np.bytes_("regular__")}
        node.attrs.update(facts)


def volume(kind, path, n="20"):
    centred = np.indices([int(n)] * 3) - (int(n) - 1) / 2
    values = np.where((np.abs(centred) < 5).all(axis=0), 3.0, 1.0)
    if kind == "image":
        values = (centred[2] / (int(n) - 1) + 0.5) * 1e-4
    names = ["zspace", "yspace", "vector_dimension" if kind == "colour" else "xspace"]
    with h5py.File(path, "w") as file:
        minc(file, values, names)
        if kind in ("chunks", "heap"):
            old = file["minc-2.0/image/0/image"]
            stored, order = old[:], old.attrs["dimorder"]
            del file["minc-2.0/image/0/image"]
            chunks = (10000000, 1, 1) if kind == "chunks" else (20, 20, 20)
            node = file.create_dataset("minc-2.0/image/0/image", stored.shape, "u2", maxshape=(None,) * 3, chunks=chunks,
                                       compression="gzip")
            node.attrs["dimorder"] = order
            if kind == "heap":
                node[:] = stored
    if kind == "heap":  # the key of a B-tree's node begins with the bytes of a chunk
        data = bytearray(open(path, "rb").read())
        struct.pack_into("<I", data, data.rindex(b"TREE\x01") + 24, 3 << 30)
        open(path, "wb").write(data)


def nwb(kind, path):
    points = np.loadtxt("points.txt", ndmin=2)[:, :3]
    points[:, 2] = points[:, 1] if kind == "allensdk" else points[:, 2]
    with h5py.File(path, "w") as file:
        table = file.create_group("general/extracellular_ephys/electrodes")
        for name, column in zip("xyz", points.T):
            table[name] = column.astype("f4") * (kind != "localized")
        table["id"] = np.arange(len(points))
        table["group_name"] = np.array(["probe"] * len(points), h5py.string_dtype())
        if kind == "localized":
            space = file.create_group("general/localization/CCF")
            space.attrs.update({"space_name": "AllenCCFv3", "units": "um", "orientation": "PIR",
                                "origin": "Anterior-Superior-Left (ASL) corner of the 3D image volume"})
            places = file.create_group("general/localization/places")
            for name, column in zip("xyz", points[::-1].T):
                places[name] = column
            places["localized_entity"] = np.arange(len(points))[::-1]
            places["localized_entity"].attrs["table"] = table.ref
            places["space"] = h5py.SoftLink("/general/localization/CCF")


def field(path):
    with h5py.File(path, "w") as file:
        mesh = file.create_group("mesh_roi")
        mesh["nodes/node_coord"] = np.array([[0, 0, 0], [6, 0, 0], [0, 6, 0], [0, 0, 6], [6, 6, 6]], float)
        mesh["elm/elm_type"] = np.array([2, 4, 4], "i4")
        mesh["elm/tag1"] = np.array([1002, 2, 1], "i4")
        mesh["elm/node_number_list"] = np.array([[1, 2, 3, -1], [1, 2, 3, 4], [5, 2, 3, 4]], "i4")
        mesh["elmdata/E"] = np.array([[9, 0, 0], [0, 1, 0], [0, 0, -2]], "f4")
        mesh["elmdata/J"] = 10 * mesh["elmdata/E"][:]


if sys.argv[1] == "field":
    field(sys.argv[2])
elif sys.argv[1] in ("nwb", "allensdk", "localized"):
    nwb(*sys.argv[1:])
elif sys.argv[1] in ("minc", "image", "colour", "chunks", "heap"):
    volume(*sys.argv[1:])
else:
    matlab(sys.argv[2], {"lead-dbs": lead_dbs, "simnibs": simnibs, "table": table}[sys.argv[1]])
