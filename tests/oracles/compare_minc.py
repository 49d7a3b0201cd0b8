#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""compare_minc.py DUMP_VOLUME CONUS_HDF5 SHARED_DATA: MINC 2 volumes that h5py writes here by the file format reference,
of random types, orders of dimensions, directions, ranges and scales, read by conus and by nibabel. Values and places must
be equal, and labels those that the file was made from. Then one that minc-tools wrote.

Exit 77 = skipped."""

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

TRIALS = 72
TYPES = ("u1", "i1", "u2", "i2", "u4", "i4", "f4", "f8")


def rotation(rng):
    """A random one, by a quaternion."""
    w, x, y, z = (q := rng.normal(size=4)) / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def write(path, rng, trial):
    """One file. Returns its labels as they were meant, in the order of the file; None for an image."""
    kind = TYPES[trial % len(TYPES)]
    names = [f"{axis}space" for axis in rng.permutation(list("xyz"))]
    shape = tuple(int(n) for n in rng.integers(2, 9, 3))
    has_time = trial % 5 == 0 and trial // 8 % 3 < 2
    cosines = rotation(rng) if trial % 3 else np.eye(3)
    is_label = trial % 2 == 0
    scaled_over = 0 if kind[0] == "f" else trial // 8 % 3
    real = rng.integers(0, 100, shape).astype(float) if is_label else rng.normal(0, 50, shape)
    over = tuple(range(scaled_over, 3))
    with h5py.File(path, "w") as file:
        image = file.create_group("minc-2.0/image/0")
        order = (["time"] if has_time else []) + names
        if kind[0] == "f":
            stored = real.astype(kind)
            for name, value in (("image-min", real.min()), ("image-max", real.max())):
                image.create_dataset(name, data=value)
        else:
            info = np.iinfo(kind)
            low, high = float(info.min), float(info.max)
            if trial % 4 < 2:  # not the whole type
                low, high = (0.0 if trial % 8 < 4 else low + 3), high - 100
            least, most = real.min(axis=over), real.max(axis=over)
            if is_label and trial % 3 == 0 and low <= 0 and high >= 100:  # stored as they are
                least, most = np.full_like(least, low), np.full_like(most, high)
            spread = least.reshape(least.shape + (1,) * len(over)), most.reshape(most.shape + (1,) * len(over))
            width = np.where(spread[1] > spread[0], spread[1] - spread[0], 1)
            stored = np.rint((real - spread[0]) / width * (high - low) + low).astype(kind)
            if scaled_over and has_time:
                least, most = least[None], most[None]
            for name, values in (("image-min", least), ("image-max", most)):
                node = image.create_dataset(name, data=values)
                if values.ndim:
                    node.attrs["dimorder"] = np.bytes_(",".join(order[: values.ndim]))
        node = image.create_dataset("image", data=stored[None] if has_time else stored, chunks=True,
                                    compression=4 if trial % 2 else None)
        node.attrs["dimorder"] = np.bytes_(",".join(order))
        if kind[0] != "f" and not (low == info.min and high == info.max and trial % 2):
            node.attrs["valid_range"] = np.array([low, high])
        for name, length in zip(order, node.shape):
            dimension = file.create_dataset(f"minc-2.0/dimensions/{name}", data=np.int32(0))
            dimension.attrs["length"] = np.int32(length)
            dimension.attrs["spacing"] = np.bytes_("regular__")
            if name != "time":
                dimension.attrs["start"] = rng.normal(0, 40)
                dimension.attrs["step"] = rng.uniform(0.2, 3) * rng.choice([-1, 1])
                dimension.attrs["direction_cosines"] = cosines[:, "xyz".index(name[0])]
                dimension.attrs["units"] = np.bytes_("mm")
    steps_of_label = kind[0] == "f" or 50 / (high - low) < 1e-3  # half a step is finer than the slack
    return real if is_label and steps_of_label else None


def by_nibabel(path):
    """Values and affine in the order of the file, without time."""
    image = nibabel.load(path)
    data = np.asarray(image.dataobj, dtype=float)
    return (data[0] if data.ndim == 4 else data), image.affine


def by_conus(dump, path, folder):
    """The same, and labels or None; or the message."""
    outputs = [os.path.join(folder, name) for name in ("values", "labels")]
    for output in outputs:
        if os.path.exists(output):
            os.remove(output)
    done = subprocess.run([dump, path, *outputs], capture_output=True, text=True, check=False)
    if done.returncode:
        return done.stderr.strip()
    facts = dict(line.split(" ", 1) for line in done.stdout.splitlines())
    shape = [int(n) for n in facts["dim"].split()][::-1]
    affine = np.array(facts["affine"].split(), float).reshape(4, 4)
    affine = affine[:, [2, 1, 0, 3]]  # the slowest first, as nibabel has it
    labels = np.fromfile(outputs[1], "<u4").reshape(shape) if os.path.exists(outputs[1]) else None
    return np.fromfile(outputs[0], "<f4").reshape(shape), affine, labels


def differences(dump, path, folder, meant):
    """What is not equal, in words; "" where all is."""
    values, affine = by_nibabel(path)
    got = by_conus(dump, path, folder)
    if isinstance(got, str):
        return got
    if got[0].shape != values.shape or not np.allclose(got[0], values, rtol=2e-7, atol=1e-5):
        return f"values differ by {np.abs(got[0] - values).max() if got[0].shape == values.shape else got[0].shape}"
    if not np.allclose(got[1], affine, rtol=1e-12, atol=1e-9):
        return f"affine {got[1].tolist()}, nibabel has {affine.tolist()}"
    if meant is not None and (got[2] is None or not np.array_equal(got[2], meant)):
        return "labels are not those that were meant"
    return ""


def main():
    dump, os.environ["CONUS_HDF5"], shared = sys.argv[1:]
    rng = np.random.default_rng(20261124)
    equal = labels = 0
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "random.mnc")
        for trial in range(TRIALS):
            meant = write(path, rng, trial)
            words = differences(dump, path, folder, meant)
            equal += not words
            labels += meant is not None
            if words:
                print(f"trial {trial}: {words}")
        sample = os.path.join(shared, "files-2026", "minc")
        fine = True
        if os.path.isdir(sample):
            with open(os.path.join(sample, "expected.json"), encoding="utf-8") as file:
                expected = json.load(file)["labels0.mnc"]
            _, affine, found = by_conus(dump, os.path.join(sample, "labels0.mnc"), folder)
            source = np.asarray(nibabel.load(os.path.join(sample, expected["equal_to"])).dataobj)
            counts = {str(label): int(n) for label, n in zip(*np.unique(found, return_counts=True))}
            fine = (counts == expected["voxels_by_label"] and np.array_equal(found, source.T) and
                    np.allclose(affine, expected["affine_as_stored"], atol=1e-9))
            print(f"nii2mnc's: {'equal' if fine else 'different'}")
    print(f"{equal} of {TRIALS} files equal, {labels} of them label volumes")
    return 0 if fine and equal == TRIALS and labels > 20 else 1


if __name__ == "__main__":
    sys.exit(main())
