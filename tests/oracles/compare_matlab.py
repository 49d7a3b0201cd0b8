#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The reader of MATLAB's files against scipy's, on files that MATLAB wrote: those that Debian's python3-scipy has for its
own tests, of MATLAB 5.3 to 8, of Solaris (big-endian), Linux and Windows, packed and not. Then the same files once more
as level 7.3, which h5py writes here by MATLAB's layout.

usage: compare_matlab.py DUMP_MATLAB [CONUS_HDF5 SHARED_DATA]; exit 77 = skipped."""

import json
import os
import subprocess
import sys
import tempfile
import warnings

try:
    import numpy as np
    import scipy.io
except ImportError:
    print("skipped: no python3-scipy")
    sys.exit(77)

try:
    import h5py
except ImportError:
    h5py = None

FOLDER = os.path.join(os.path.dirname(scipy.io.__file__), "matlab", "tests", "data")

# Refused or changed by scipy: a name that is not ASCII, and fields of one name, which scipy renames; conus finds the
# first.
LEFT_OUT = {"bad_miutf8_array_name.mat", "nasty_duplicate_fieldnames.mat"}


def plain(value):
    """What scipy gives, as dump_matlab writes it; None for what conus does not read."""
    is_object = isinstance(value, (scipy.io.matlab.MatlabObject, scipy.io.matlab.MatlabFunction))
    if is_object or not isinstance(value, np.ndarray) or value.dtype.kind == "c":
        return None
    if value.dtype.names:
        return [{name: plain(element[name]) for name in value.dtype.names} for element in value.ravel("F")]
    if value.dtype.kind == "U":
        return "" if value.size == 0 else str(value[0]) if value.size == 1 else None
    if value.dtype.kind == "O":  # cells; an element that is None is a structure without fields
        return [{} if element is None else plain(element) for element in value.ravel("F")]
    return {"rows": value.shape[0], "columns": value.shape[1], "values": [float(n) for n in value.ravel("F")]}


def known(variables):
    """Those that are read; MATLAB's notes to itself have no name."""
    return {name: value for name, value in variables.items() if name and value is not None}


def read_by_scipy(path):
    """The variables, or None where scipy refuses the file, too."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            variables = scipy.io.loadmat(path, struct_as_record=True)
    except Exception as error:  # pylint: disable=broad-except; of many kinds
        print(f"{os.path.basename(path)}: scipy: {error}")
        return None
    return known({name: plain(value) for name, value in variables.items() if not name.startswith("__")})


class Writer:
    """A file of level 7.3 with the variables that scipy read."""

    def __init__(self, path, variables):
        self.references = 0
        with h5py.File(path, "w", userblock_size=512) as self.file:
            for name, value in variables.items():
                if name and not name.startswith("__"):
                    self.write(name, value)
        with open(path, "r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\0\2IM")

    def put(self, path, matlab_class, data, **attributes):
        """One dataset, dimensions reversed; None is a group."""
        node = self.file.create_group(path) if data is None else self.file.create_dataset(path, data=data)
        node.attrs["MATLAB_class"] = np.bytes_(matlab_class)
        for key, value in attributes.items():
            node.attrs[key] = value
        return node

    def refer(self, value):
        self.references += 1
        path = f"/#refs#/r{self.references}"
        self.write(path, value)
        return self.file[path].ref

    def refer_all(self, values):
        """References to the elements of an array."""
        out = np.empty(values.shape[::-1], h5py.ref_dtype)
        for index in np.ndindex(values.shape):
            out[index[::-1]] = self.refer(values[index])
        return out

    def write_structures(self, path, value):
        names = value.dtype.names
        group = self.put(path, "struct", None)
        letters = np.empty(len(names), object)
        letters[:] = [np.frombuffer(name.encode(), "S1") for name in names]
        group.attrs.create("MATLAB_fields", letters, dtype=h5py.vlen_dtype(np.dtype("S1")))
        for name in names:
            if value.size == 1:
                self.write(f"{path}/{name}", value.flat[0][name])
            else:
                self.file.create_dataset(f"{path}/{name}", data=self.refer_all(value[name]), dtype=h5py.ref_dtype)

    def write(self, path, value):
        if isinstance(value, np.ndarray) and value.dtype.kind == "O" and value.size and all(e is None for e in value.flat):
            value = None
        if value is None:  # a structure without fields
            self.put(path, "struct", None)
        elif isinstance(value, (scipy.io.matlab.MatlabObject, scipy.io.matlab.MatlabFunction)):
            self.put(path, "someclass", np.zeros((1, 6), "u4"), MATLAB_object_decode=np.int32(3))
        elif not isinstance(value, np.ndarray):
            self.put(path, "double", None, MATLAB_sparse=np.uint64(value.shape[0]))
        elif value.size == 0:
            kind = "struct" if value.dtype.names else {"U": "char", "O": "cell"}.get(value.dtype.kind, "double")
            self.put(path, kind, np.array(value.shape if value.ndim > 1 else (0, 0), "u8"), MATLAB_empty=np.uint8(1))
        elif value.dtype.names:
            self.write_structures(path, value)
        elif value.dtype.kind == "O":
            self.put(path, "cell", self.refer_all(value))
        elif value.dtype.kind == "U":
            rows = [np.frombuffer(str(row).ljust(value.itemsize // 4).encode("utf-16-le"), "<u2") for row in value.flat]
            self.put(path, "char", np.array(rows).T, MATLAB_int_decode=np.int32(2))
        elif value.dtype.kind == "c":
            pairs = np.zeros(value.T.shape, [("real", "<f8"), ("imag", "<f8")])
            pairs["real"], pairs["imag"] = value.T.real, value.T.imag
            self.put(path, "double", pairs)
        else:
            name = {"f4": "single", "f8": "double", "b1": "logical"}.get(value.dtype.str[1:], value.dtype.name)
            self.put(path, name, value.T.astype("u1") if name == "logical" else value.T)


def compare_level_7(dump, folder):
    """How many files are equal, and how many different."""
    equal = different = 0
    path = os.path.join(folder, "level7.mat")
    for name in sorted(os.listdir(FOLDER)):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                variables = scipy.io.loadmat(os.path.join(FOLDER, name), struct_as_record=True)
            except Exception:  # pylint: disable=broad-except; scipy's own refusals are counted elsewhere
                continue
        wanted = known({key: plain(value) for key, value in variables.items() if not key.startswith("__")})
        Writer(path, variables)
        run = subprocess.run([dump, path], capture_output=True, text=True, errors="replace", check=False)
        got = known(json.loads(run.stdout)) if run.returncode == 0 else None
        equal += got == wanted
        different += got != wanted
        if got != wanted:
            print(f"{name} as level 7.3: {run.stderr.strip() or str(got)[:600]}, scipy has {str(wanted)[:600]}")
    # The only file written by MATLAB that scipy has: numbers k pi/4.
    with h5py.File(os.path.join(FOLDER, "testhdf5_7.4_GLNX86.mat")) as file:
        wanted = file["testdouble"][()].ravel().tolist()
    run = subprocess.run([dump, os.path.join(FOLDER, "testhdf5_7.4_GLNX86.mat")], capture_output=True, text=True, check=True)
    if json.loads(run.stdout)["testdouble"]["values"] != wanted:
        different += 1
        print(f"testhdf5_7.4_GLNX86.mat: {run.stdout}, h5py has {wanted}")
    print(f"level 7.3: {equal} files equal, {different} files different")
    return different == 0 and equal > 50


def compare_samples(dump, folder):
    """What matio wrote, against what it was given."""
    with open(os.path.join(folder, "expected.json"), encoding="utf-8") as file:
        expected = json.load(file)

    def rows(array):
        return np.reshape(array["values"], (array["columns"], array["rows"])).T.tolist()

    def variables(name):
        return json.loads(subprocess.run([dump, os.path.join(folder, name)], capture_output=True, check=True).stdout)

    reco = variables("ea_reconstruction.mat")["reco"][0]
    fine = np.ravel(rows(variables("matsimnibs.mat")["matsimnibs"])).tolist() == np.ravel(
        expected["matsimnibs.mat"]["rows"]).tolist()
    for space, sides in expected["ea_reconstruction.mat"]["spaces"].items():
        right, left = reco[space][0]["coords_mm"]
        fine = fine and rows(right) == sides["R"] and rows(left) == sides["L"]
    print(f"level 7.3 by matio: {'equal' if fine else 'different'}")
    return fine


def main():
    dump = sys.argv[1]
    if not os.path.isdir(FOLDER):
        print("skipped: python3-scipy without the files of its tests")
        sys.exit(77)
    counts = {"equal": 0, "refused by both": 0, "different": 0}
    for name in sorted(os.listdir(FOLDER)):
        path = os.path.join(FOLDER, name)
        with open(path, "rb") as file:
            if file.read(19) != b"MATLAB 5.0 MAT-file" or name in LEFT_OUT:
                continue
        run = subprocess.run([dump, path], capture_output=True, text=True, errors="replace", check=False)
        wanted = read_by_scipy(path)
        got = known(json.loads(run.stdout)) if run.returncode == 0 else None
        same = got == wanted
        counts["different" if not same else "equal" if got is not None else "refused by both"] += 1
        if not same:
            print(f"{name}: {run.stderr.strip() or str(got)[:300]}, scipy has {str(wanted)[:300]}")
    print(", ".join(f"{count} files {what}" for what, count in counts.items()))
    fine = not counts["different"] and counts["equal"] >= 50
    if h5py and len(sys.argv) > 2:
        os.environ["CONUS_HDF5"] = sys.argv[2]
        with tempfile.TemporaryDirectory() as folder:
            fine = compare_level_7(dump, folder) and fine
        samples = os.path.join(sys.argv[3], "files-2026", "mat73")
        fine = (compare_samples(dump, samples) if os.path.isdir(samples) else True) and fine
    else:
        print("level 7.3 skipped: no python3-h5py, or no conus-hdf5")
    return 0 if fine else 1


if __name__ == "__main__":
    sys.exit(main())
