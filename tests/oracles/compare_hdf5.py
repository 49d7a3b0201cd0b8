#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""conus-hdf5 against h5py: files of every type and storage are read alike, and hostile ones are refused in one line, with
no file of the user opened and no memory beyond the limit.

usage: compare_hdf5.py DUMP_HDF5 CONUS_HDF5 [SHARED_DATA [CONUS]]; exit 77 = skipped."""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy as np
except ImportError:
    print("skipped: no python3-h5py")
    sys.exit(77)

DUMP, PROGRAM = (os.path.abspath(path) for path in sys.argv[1:3])
SHARED = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
CONUS = os.path.abspath(sys.argv[4]) if len(sys.argv) > 4 else None
LIMIT = 1 << 24
LIBRARIES = 32 << 20
os.environ["CONUS_HDF5"] = PROGRAM


def dump(path, *patterns, limit=LIMIT, environment=None):
    return subprocess.run([DUMP, path, str(limit), *patterns], capture_output=True, text=True, timeout=60, check=False,
                          env={**os.environ, **(environment or {})})


def read(path, *patterns, **options):
    done = dump(path, *patterns, **options)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def refused(path, part, *patterns, **options):
    done = dump(path, *patterns or ("/**",), **options)
    assert done.returncode and done.stdout == "", f"{path} was read: {done.stdout}"
    assert done.stderr.count("\n") == 1 and part in done.stderr, f"{path}: {done.stderr!r} does not say {part!r}"


def flat(array, kind):
    return [str(v) if kind == "string" else float(v) if kind == "float" else int(v) for v in np.ravel(array)]


def text_of(value):
    return value.decode("utf-8", "surrogateescape") if isinstance(value, bytes) else value


def every_type(folder):
    """Every class, size, byte order, rank and storage that is read."""
    path, random = folder / "types.h5", np.random.default_rng(1)
    arrays = {}
    for order in "<>":
        for name in ("f2", "f4", "f8", "i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8"):
            array = random.integers(0, 100, (3, 5)) * (-1 if name[0] != "u" else 1)
            arrays[f"{'big' if order == '>' else 'little'}_{name}"] = array.astype(order + name)
    arrays["top_u8"] = np.array([2**64 - 1, 2**63], "u8")
    arrays["scalar"] = np.float64(0.1)
    arrays["nothing"] = np.zeros((0, 3), "f4")
    arrays["eight"] = random.normal(size=(1, 2, 1, 2, 1, 2, 1, 2))
    arrays["fixed"] = np.array([b"a", b"", b"four"], "S4")
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, array in arrays.items():
            file[name] = array
        for name, array in arrays.items():
            file["scalar"].attrs[name] = array
        file["grid"] = np.arange(6000, dtype="f4").reshape(60, 100)
        for name, options in {"deflate": {"compression": 5}, "shuffle": {"shuffle": True, "compression": 1},
                              "sum": {"fletcher32": True}}.items():
            file.create_dataset(name, data=file["grid"][:], chunks=(7, 13), **options)
        text = h5py.string_dtype()
        file.create_dataset("variable", data=["Affine", "", "\u00e4\u20ac"], dtype=text)
        file["variable"].attrs["word"] = "one"
        spaces = h5py.h5t.C_S1.copy()
        spaces.set_size(6)
        spaces.set_strpad(h5py.h5t.STR_SPACEPAD)
        space = h5py.h5s.create_simple((1,))
        h5py.h5d.create(file.id, b"spaces", spaces, space).write(space, space, np.array([b"ab    "], "S6"), spaces)
        letters = np.empty(2, object)
        letters[:] = [np.array([b"a", b"b"], "S1"), np.array([b"c"], "S1")]
        file["scalar"].attrs.create("fields", letters, dtype=h5py.vlen_dtype(np.dtype("S1")))
        file.create_dataset("references", (3,), dtype=h5py.ref_dtype)
        file["references"][0] = file["grid"].ref
        file["references"][2] = file.create_group("nested/group").ref
        file["flag"] = np.array([True, False])  # an enumeration
        file["compound"] = np.zeros(2, [("x", "f4")])
        file["empty"] = h5py.Empty("f4")
        file["soft"] = h5py.SoftLink("/nested/./soft2")
        file["nested/soft2"] = h5py.SoftLink("/grid")
        file["dangling"] = h5py.SoftLink("/nowhere")
    found = {item["path"][1:]: item for item in read(path, "/*")}
    for name, array in arrays.items():
        for value in (found[name]["value"], found["scalar"]["attributes"][name]):
            kind = {"f": "float", "i": "signed", "u": "unsigned", "S": "string"}[array.dtype.kind]
            assert value["class"] == kind and value["dims"] == list(array.shape), (name, value)
            wanted = [v.decode() for v in array] if kind == "string" else flat(array, kind)
            assert value["values"] == wanted, (name, value, wanted)
    for name in ("grid", "deflate", "shuffle", "sum", "soft"):
        assert found[name]["value"]["values"] == list(range(6000)), name
    assert found["variable"]["value"]["values"] == ["Affine", "", "\u00e4\u20ac"]
    assert found["variable"]["attributes"]["word"]["values"] == ["one"]
    assert found["spaces"]["value"]["values"] == ["ab"]
    assert found["scalar"]["attributes"]["fields"]["values"] == ["ab", "c"]
    assert found["flag"]["value"]["values"] == [1, 0]
    assert found["compound"]["value"]["class"] == "other"
    assert found["empty"]["value"]["dims"] == [0]
    assert "dangling" not in found
    everything = {item["path"]: item for item in read(path, "/**")}
    assert everything["/references"]["value"]["values"][0] in ("/grid", "/soft", "/nested/soft2")
    assert everything["/references"]["value"]["values"][1:] == ["", "/nested/group"]
    assert [item["path"] for item in read(path, "/nested/*", "/grid", "/absent/*/x")] == \
        ["/grid", "/nested/group", "/nested/soft2"]
    print(f"every type: {len(found)} objects equal")


def hostile(folder):
    """Small files of each kind that section by section of the format allows, and that must not be read."""
    secret = folder / "secret"
    secret.write_bytes(b"the user's own file" * 100)
    made = {}

    def make(name, part, limit=LIMIT):
        path = folder / f"{name}.h5"
        made[path] = (part, limit)
        return h5py.File(path, "w")

    with make("external_link", "/x: a link to another file") as file:
        file["x"] = h5py.ExternalLink("other.h5", "/x")
    with h5py.File(folder / "other.h5", "w") as file:
        file["x"] = np.arange(3.)
    with make("external_through_soft", "/x: a link to another file") as file:
        file["z/a"] = h5py.ExternalLink("other.h5", "/")
        file["x"] = h5py.SoftLink("/z/a/x")
    with make("external_storage", "/x: its data are stored in another file") as file:
        file.create_dataset("x", (8,), "u1", external=[(str(secret), 0, 8)])
    with make("virtual", "/x: a virtual dataset") as file:
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "x", (3,))
        file.create_virtual_dataset("x", layout)
    with make("soft_loop", "more than 8 soft links") as file:
        file["x"], file["y"] = h5py.SoftLink("/y"), h5py.SoftLink("/x")
    with make("soft_fan", "more than 8 soft links") as file:  # each link leads to the next two: 2^40 steps
        for i in range(40):
            file.create_group(f"g{i}")["n"] = h5py.SoftLink(f"/g{i + 1}/n/n")
    with make("circle", "a group that lies within itself") as file:
        file.create_group("a/b")
        file["a/b/c"] = file["a"]
    with make("doubling", "262144 objects and attributes", limit=1 << 30) as file:  # 2^40 paths
        for i in range(40):
            group = file.require_group(f"g{i}")
            if i:
                file[f"g{i - 1}/a"] = file[f"g{i - 1}/b"] = group
    with make("deep", "groups more than 64 deep") as file:
        file.create_group("/".join("a" * 100))
    with make("huge", "3000000000000000 elements of 4 bytes") as file:
        file.create_dataset("x", (3 * 10**15,), "f4", chunks=(1024,), compression=1)
    with make("huge_product", "more elements than a number of 64 bits counts") as file:
        file.create_dataset("x", (2**40, 2**40), "f4", chunks=(1, 1024))
    with make("many_attributes", "elements of 1 bytes, allowed are", limit=1 << 16) as file:
        for i in range(200):
            file.attrs[f"a{i}"] = np.zeros(1000, "u1")
    with make("fixed_text", "elements of 1000000 bytes") as file:
        file.create_dataset("x", (10**6,), "S1000000", chunks=(1,))
    with make("shared_text", "/x: cannot read it", limit=1 << 22) as file:  # one of 1 MiB, a hundred times by one copy
        file.create_dataset("x", data=["x" * (1 << 20)] * 100, dtype=h5py.string_dtype())
    with make("nine", "9 dimensions, up to 8") as file:
        file["x"] = np.zeros((1,) * 9)
    with make("filter", "/x: filter 32000") as file:
        file.create_dataset("x", data=np.arange(1000), compression="lzf")
    for name, part in {"damaged": "/x: cannot read it", "cut": "cannot open it: "}.items():
        with make(name, part) as file:
            file.create_dataset("x", data=np.arange(5000.), chunks=(5000,), compression=5)
            offset = file["x"].id.get_chunk_info(0).byte_offset
        bytes_ = bytearray((folder / f"{name}.h5").read_bytes())
        if name == "cut":
            bytes_ = bytes_[:len(bytes_) // 2]
        else:
            bytes_[offset + 100:offset + 200] = bytes(100)
        (folder / f"{name}.h5").write_bytes(bytes_)
    most = 0
    for path, (part, limit) in made.items():
        refused(path, part, limit=limit)
        beyond = peak(path, limit) - limit - path.stat().st_size
        assert beyond < LIBRARIES, f"{path}: {beyond} bytes more than it may"
        most = max(most, beyond)
    print(f"hostile: {len(made)} files refused, the program's memory ends at most {most >> 20} MiB above the limit")
    return made


def peak(path, limit):
    """The most bytes that the program holds while it refuses the file. A small process starts it: what starts it counts."""
    starter = ("import os, sys\nos.dup2(0, 3)\nchild = os.fork()\nif not child:\n    os.execv(sys.argv[1], sys.argv[1:])\n"
               "_, status, usage = os.wait4(child, 0)\nprint(status, usage.ru_maxrss, file=sys.stderr)")
    with open(path, "rb") as file:
        done = subprocess.run([sys.executable, "-S", "-E", "-c", starter, PROGRAM, str(limit), "/**"], stdin=file,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=True)
    status, kilobytes = done.stderr.splitlines()[-1].split()
    assert os.waitstatus_to_exitcode(int(status)) >= 0, f"{path}: {done.stderr}"
    return int(kilobytes) << 10


def of_users():
    """conus itself says one line and ends with 3, wherever a mesh, a volume or a transform holds what must not be read."""
    if not CONUS:
        print("conus: skipped, not given")
        return
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        volume = folder / "one.nrrd"
        volume.write_text("NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nspace: RAS\nspace directions: (1,0,0) (0,1,0) "
                          "(0,0,1)\nspace origin: (0,0,0)\nencoding: text\n\n1 2\n")
        (folder / "secret").write_bytes(bytes(100))
        uses = {"mesh_roi/nodes/node_coord": ["overlap", volume, None, "--threshold", "1"],
                "minc-2.0/image/0/image": ["info", None],
                "TransformGroup/0/TransformParameters": ["info", volume, "--atlas-transform", None],
                "reco/mni/coords_mm": ["query", volume, "--pose", None],
                "general/extracellular_ephys/electrodes/x": ["query", volume, "--pose", None]}
        for number, (place, words) in enumerate(uses.items()):
            for kind in ("link", "storage", "virtual", "loop", "huge"):
                path = folder / f"{kind}{number}{'.mat' if place[0] == 'r' else '.nwb' if place[0] == 'g' else '.h5'}"
                with h5py.File(path, "w", userblock_size=512 if place[0] == "r" else 0) as file:
                    if kind == "link":
                        file[place] = h5py.ExternalLink("other.h5", "/x")
                    elif kind == "storage":
                        file.create_dataset(place, (8,), "u1", external=[(str(folder / "secret"), 0, 8)])
                    elif kind == "virtual":
                        layout = h5py.VirtualLayout((3,), "f8")
                        layout[:] = h5py.VirtualSource(str(folder / "other.h5"), "x", (3,))
                        file.create_virtual_dataset(place, layout)
                    elif kind == "loop":
                        file[place] = h5py.SoftLink("/" + place)
                    else:
                        file.create_dataset(place, (3 * 10**15,), "f4", chunks=(1024,), compression=1)
                if place[0] == "r":
                    with open(path, "r+b") as file:
                        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + b"\0\2IM")
                done = subprocess.run([CONUS, *(str(word or path) for word in words)], capture_output=True, text=True,
                                      timeout=60, check=False)
                assert done.returncode == 3 and not done.stdout and done.stderr.count("\n") == 1, (path, done)
                assert f"conus: {path}: " in done.stderr and place.split("/")[0] in done.stderr, (path, done.stderr)
    print(f"conus: 5 kinds in {len(uses)} places, each is refused in one line with exit code 3")


def traced(made):
    """What the program opens: nothing but libraries, by strace where it is there."""
    made = [path for path in made if path.stem != "doubling"]  # strace would take long for this one
    try:
        subprocess.run(["strace", "-V"], capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        print("traced: skipped, no strace")
        return
    for path in made:
        with open(path, "rb") as file:
            log = subprocess.run(["bash", "-c", 'exec 3<"$1"; exec strace -f -o /dev/stdout -e trace=%file "$2" 16777216 "/**"',
                                  "-", path, PROGRAM], stdin=file, capture_output=True, check=False)
        lines = log.stdout.decode("utf-8", "replace").splitlines()
        opened = [line for line in lines if re.search(r"\b(open|openat|stat|access)\w*\(", line)]
        strange = [line for line in opened if not re.search(r'\.so|"/dev/null/image"|"/(proc|sys|lib|usr/lib)/', line)]
        assert opened and not strange, f"{path}: {strange}"
    print(f"traced: {len(made)} files, none opened another")


def plugins(folder):
    """A filter of the file is not looked for, even where the environment says where it is."""
    path = folder / "filter.h5"
    refused(path, "filter 32000", environment={"HDF5_PLUGIN_PATH": str(folder), "HDF5_DRIVER": "nonsense"})


def prefixes(folder):
    """A file that is cut off anywhere is refused, or what is read of it is what it holds."""
    path, cut = folder / "small.h5", folder / "prefix.h5"
    with h5py.File(path, "w", libver="latest") as file:
        file["x"] = np.arange(4.)
    whole = path.read_bytes()
    for size in range(0, len(whole), 29):
        cut.write_bytes(whole[:size])
        done = dump(cut, "/x")
        assert done.returncode and done.stderr.count("\n") == 1, (size, done)
    print(f"prefixes: {len(range(0, len(whole), 29))} refused")


def memory(folder):
    """A dataset of 48 MB by a limit of 64 MB: the program holds it once."""
    path = folder / "large.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", data=np.zeros((12 << 20,), "f4"), chunks=(1 << 20,), compression=1)
    with open(path, "rb") as file, subprocess.Popen(["bash", "-c", 'exec "$1" 67108864 /x 3<&0', "-", PROGRAM],
                                                    stdin=file, stdout=subprocess.PIPE) as child:
        child.stdout.read(47 << 20)  # it waits to write the rest
        peak = int(re.search(r"VmHWM:\s*(\d+) kB", pathlib.Path(f"/proc/{child.pid}/status").read_text())[1])
        child.stdout.read()
    assert child.returncode == 0 and 48 << 10 < peak < 90 << 10, (child.returncode, peak)
    refused(path, "12582912 elements of 4 bytes", "/x", limit=1 << 25)
    print(f"memory: {peak >> 10} MiB for 48")


def shared():
    folder = SHARED / "files-2026/hdf5_hostile" if SHARED else None
    if not folder or not folder.is_dir():
        print("shared data: skipped, absent")
        return
    names = [name for name in json.loads((folder / "expected.json").read_text()) if name.endswith(".h5")]
    for name in names:
        refused(folder / name, name)
    print(f"shared data: {len(names)} files refused")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        every_type(folder)
        traced(hostile(folder))
        plugins(folder)
        prefixes(folder)
        memory(folder)
    of_users()
    shared()


main()
