#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The readers of tractograms against nibabel's, which has its own of TrackVis and MRtrix: every such file of the shared
data, and random ones that nibabel writes, of which the headers are bent to both byte orders and all directions of axes.

nibabel rounds its matrix into the world to float32 and then each product. So positions are compared with nibabel's to
within a few of these roundings, and to half a step of float32 with the same matrix applied in float64. Scalars, counts
and MRtrix's points are equal.

usage: compare_tracts.py DUMP_TRACT [SHARED_DATA]; exit 77 = skipped."""

import gzip
import io
import itertools
import os
import subprocess
import sys
import tempfile
import warnings

try:
    import numpy as np
    import nibabel as nib
    from nibabel.orientations import aff2axcodes, axcodes2ornt, inv_ornt_aff, ornt_transform
    from nibabel.streamlines import Tractogram, TckFile, TrkFile
    from nibabel.streamlines.trk import header_2_dtype
except ImportError:
    print("skipped: no python3-nibabel")
    sys.exit(77)

DUMP = sys.argv[1]
faults = []


def expect(truth, words):
    if not truth:
        faults.append(words)
        print("FAULT", words)


def dump(path):
    """What conus reads; None and the message where it refuses."""
    with tempfile.NamedTemporaryFile() as out:
        done = subprocess.run([DUMP, path, out.name], capture_output=True, text=True)
        lines = done.stderr.splitlines()
        if done.returncode:
            return None, lines
        data = out.read()
    head, rest = data.split(b"\n\n", 1)
    fields = [line.split("\t") for line in head.decode().splitlines()]
    numbers = {field[0]: field[1] for field in fields[:4]}
    streamlines, points = int(numbers["streamlines"]), int(numbers["points"])
    stream = io.BytesIO(rest)
    found = {
        "format": numbers["format"],
        "first": np.frombuffer(stream.read(8 * (streamlines + 1)), "u8"),
        "points": np.frombuffer(stream.read(12 * points), "f4").reshape(-1, 3),
    }
    for kind, name, components in fields[4:]:
        rows = points if kind == "per_point" else streamlines
        values = np.frombuffer(stream.read(4 * rows * int(components)), "f4").reshape(rows, -1)
        found.setdefault(kind, {})[name] = values
    expect(not stream.read(), f"{path}: more bytes than numbers")
    return found, lines


def raw_points(path, header):
    """The points of a .trk as stored, by a reader of this file's own."""
    data = (gzip.open if path.endswith(".gz") else open)(path, "rb").read()
    order = header["endianness"]
    at, points = 1000, [np.empty((0, 3))]
    scalars, properties = int(header["nb_scalars_per_point"]), int(header["nb_properties_per_streamline"])
    while at < len(data):
        count = int(np.frombuffer(data, order + "i4", 1, at)[0])
        rows = np.frombuffer(data, order + "f4", count * (3 + scalars), at + 4).reshape(count, 3 + scalars)
        points.append(rows[:, :3].astype("f8"))
        at += 4 + 4 * count * (3 + scalars) + 4 * properties
    return np.concatenate(points)


def world_of(header):
    """nibabel's rule of header to world, in float64."""
    scale = np.diag([*(1 / header["voxel_sizes"].astype("f8")), 1])
    corner = np.eye(4)
    corner[:3, 3] = -0.5
    start = axcodes2ornt(header["voxel_order"].item().decode().upper())
    end = axcodes2ornt("".join(aff2axcodes(header["voxel_to_rasmm"])))
    turn = inv_ornt_aff(ornt_transform(start, end), header["dimensions"].astype("f8"))
    return header["voxel_to_rasmm"].astype("f8") @ turn @ corner @ scale


def compare_scalars(path, found, wanted, kind):
    ours, theirs = found.get(kind, {}), dict(wanted)
    expect(sorted(ours) == sorted(theirs), f"{path}: {kind}: {sorted(ours)}, nibabel has {sorted(theirs)}")
    for name in set(ours) & set(theirs):
        values = theirs[name].get_data() if kind == "per_point" else np.asarray(theirs[name])
        values = np.asarray(values, "f4").reshape(ours[name].shape)
        expect(np.array_equal(ours[name], values, equal_nan=True), f"{path}: {kind} {name} differs")


def compare_placed(path, found, header):
    """Points of a .trk against its own numbers through nibabel's matrix, in double, rounded once; the order of sums may
    differ, so that a point that lies between two floats may go to the other."""
    raw = raw_points(path, header)
    wanted = raw @ world_of(header)[:3, :3].T + world_of(header)[:3, 3]
    step = np.spacing(np.abs(wanted).astype("f4"))
    off = np.abs(found["points"] - wanted) > 0.5 * step + 1e-12 * np.abs(wanted).max(initial=1)
    expect(not off.any(), f"{path}: {off.sum()} coordinates are not the float next to the exact one")


def compare(path, kind):
    """Whether both read the file; faults where only one does or they differ."""
    found, lines = dump(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            theirs = kind.load(path)
    except Exception as error:  # pylint: disable=broad-except; of many kinds
        expect(found is None and len(lines) == 1, f"{path}: nibabel says {error}, conus {lines or 'nothing'}")
        print(f"{os.path.basename(path)}: both refuse: {lines[0].split(': ', 1)[1] if lines else ''}")
        return False
    if found is None:
        faults.append(path)
        print("FAULT", lines)
        return False
    streamlines = theirs.streamlines
    lengths = np.diff(found["first"]).astype(int)
    lengths = lengths[lengths > 0]  # nibabel drops streamlines without points
    expect(np.array_equal(lengths, [len(s) for s in streamlines]), f"{path}: numbers of points differ")
    data = streamlines.get_data().reshape(-1, 3)
    if kind is TckFile:
        expect(np.array_equal(found["points"], data), f"{path}: points differ")
    elif found["points"].shape == data.shape:
        size = np.abs(np.concatenate([data.ravel(), world_of(theirs.header).ravel(), raw_points(path, theirs.header).ravel()]))
        expect(np.abs(found["points"] - data).max(initial=0) <= 16 * np.spacing(np.float32(size.max(initial=1))),
               f"{path}: points are up to {np.abs(found['points'] - data).max(initial=0)} mm away from nibabel's")
        compare_placed(path, found, theirs.header)
    compare_scalars(path, found, theirs.tractogram.data_per_point.items(), "per_point")
    compare_scalars(path, found, theirs.tractogram.data_per_streamline.items(), "per_streamline")
    return True


def random_affine(rng, sheared):
    """Voxel sizes and a matrix of any turn; sheared ones keep the lengths of their columns."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    if sheared:
        turn = turn + 0.2 * rng.normal(size=(3, 3))
        turn /= np.linalg.norm(turn, axis=0)
    sizes = rng.uniform(0.3, 4, 3)
    affine = np.eye(4)
    affine[:3, :3] = turn * sizes
    affine[:3, 3] = rng.uniform(-200, 200, 3)
    return sizes, affine


def bent_header(data, order, big):
    """The file @p data with voxel_order @p order, in the other byte order if @p big."""
    header = np.frombuffer(data, header_2_dtype.newbyteorder("<"), 1).copy()
    header["voxel_order"] = order.encode()
    numbers = np.frombuffer(data[1000:], "<u4")
    if big:
        return header.astype(header_2_dtype.newbyteorder(">")).tobytes() + numbers.astype(">u4").tobytes()
    return header.tobytes() + data[1000:]


def write_random(rng, path, big, flips, sheared):
    """A .trk as nibabel writes it, with random scalars; some axes are then said to run the other way."""
    sizes, affine = random_affine(rng, sheared)
    codes = "".join(aff2axcodes(affine.astype("f4")))
    lengths = rng.integers(1, 6, 20)
    streamlines = [rng.uniform(-300, 300, (n, 3)).astype("f4") for n in lengths]
    tractogram = Tractogram(streamlines, affine_to_rasmm=np.eye(4))
    tractogram.data_per_point["fa"] = [rng.normal(size=(n, 1)).astype("f4") for n in lengths]
    tractogram.data_per_point["colour of a point"] = [rng.normal(size=(n, 3)).astype("f4") for n in lengths]
    tractogram.data_per_streamline["mean"] = rng.normal(size=(20, 2)).astype("f4")
    header = {"voxel_sizes": sizes, "voxel_to_rasmm": affine, "voxel_order": codes,
              "dimensions": rng.integers(1, 300, 3)}
    buffer = io.BytesIO()
    TrkFile(tractogram, header).save(buffer)
    other = dict(zip("LRPAIS", "RLAPSI"))
    order = "".join(other[c] if flip else c for c, flip in zip(codes, flips))
    data = bent_header(buffer.getvalue(), order, big)
    (gzip.open if path.endswith(".gz") else open)(path, "wb").write(data)


def compare_random(folder):
    rng = np.random.default_rng(1)
    count = 0
    for big, sheared, *flips in itertools.product((False, True), repeat=5):
        path = os.path.join(folder, f"{count}.trk" + (".gz" if count % 4 == 3 else ""))
        write_random(rng, path, big, flips, sheared)
        count += compare(path, TrkFile)
    for i in range(4):
        path = os.path.join(folder, f"{i}.tck")
        streamlines = [rng.uniform(-200, 200, (n, 3)).astype("f4") for n in rng.integers(1, 50, 30)]
        TckFile(Tractogram(streamlines, affine_to_rasmm=np.eye(4))).save(path)
        count += compare(path, TckFile)
    expect(count == 36, f"{count} of 36 random files are read")
    print(f"{count} random files: as nibabel has them")


def compare_orders(folder):
    """All 48 orders of voxels beside one matrix: nibabel's way is right for the eight that only turn axes round, and
    conus refuses the others, for which it takes sizes of other axes."""
    path = os.path.join(folder, "order.trk")
    write_random(np.random.default_rng(2), path, False, (False, False, False), False)
    data = open(path, "rb").read()
    codes = np.frombuffer(data, header_2_dtype, 1)["voxel_order"][0].decode()
    for letters in itertools.permutations(("LR", "PA", "IS")):
        for order in map("".join, itertools.product(*letters)):
            open(path, "wb").write(bent_header(data, order, False))
            if all(code in pair for pair, code in zip(letters, codes)):
                compare(path, TrkFile)
            else:
                found, lines = dump(path)
                expect(found is None and len(lines) == 1 and f"voxel_order: found {order}, vox_to_ras has {codes};" in lines[0],
                       f"voxel_order {order} beside {codes}: {lines}")


def compare_shared(folder):
    read = refused = 0
    for root, _, names in sorted(os.walk(folder)):
        for name in sorted(names):
            kind = TrkFile if name.endswith(".trk") else TckFile if name.endswith(".tck") else None
            if kind:
                fine = compare(os.path.join(root, name), kind)
                read, refused = read + fine, refused + (not fine)
    print(f"{folder}: {read} files as nibabel has them, {refused} that both refuse")
    expect(read >= 15 and refused >= 3, f"{folder}: fewer files than there were")


def main():
    print(f"nibabel {nib.__version__}")
    with tempfile.TemporaryDirectory() as folder:
        compare_random(folder)
        compare_orders(folder)
    shared = os.path.join(os.environ.get("CONUS_SHARED_DATA") or (sys.argv[2] if len(sys.argv) > 2 else ""), "tracts")
    if os.path.isdir(shared):
        compare_shared(shared)
    else:
        print(f"no {shared}: files of other programs are left out")
    sys.exit(1 if faults else 0)


main()
