# SPDX-License-Identifier: BSD-3-Clause
"""overwrite.py CONUS: every output of every command over every file that it reads: by its own name, by a symbolic and a
hard link, and by a path with "..". Each time the file must have its bytes afterwards, and the command must refuse with
one line that names both. Prints what went wrong, and how many tries there were. Without CONUS_TEST_LONG each pair of
an output and a file is tried in one of these ways, in turn.

An output that is not in a row of ROWS fails; the rows of `conus help --json` say which options write."""
import concurrent.futures
import gzip
import json
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile

CONUS = os.path.abspath(sys.argv[1])
LONG = os.environ.get("CONUS_TEST_LONG")

AIM = "--origin 40,0,0 --toward 0,0,0 --angle 20"
MORE = "--labels own.tsv --streamlines bundle.tck --atlas-transform shift.txt"
NEEDLE = "--origin 40,0,0 --toward 0,0,0 --range 0,60"
PLAN = "plan u-shape.nii.gz --toward targets.tsv --depth target+5 --reach Ball --apart apart.tsv,1"
# The command, its outputs with their endings, and the files that it reads.
ATLAS = ["u-shape.nii.gz", "u-shape.tsv"]
ROWS = [
    (f"query u-shape.nii.gz {AIM} --layers all", {"output": ".tsv", "mask": ".nii.gz", "image": ".exr"}, ATLAS),
    (f"query u-shape.nii.gz {AIM} {MORE} --context grey.nii.gz --context-blocks 0.5 --voxels-of all",
     {"output": ".csv", "sidecar": ".json", "voxels": ".tsv", "endpoints": ".tsv", "connectivity": ".tsv", "streamlines-out": ".tck"},
     ["u-shape.nii.gz", "own.tsv", "bundle.tck", "shift.txt", "grey.nii.gz"]),
    (f"query u-shape.nii.gz {NEEDLE}", {"output": ".tsv", "segments": ".tsv", "clearance": ".tsv"}, ATLAS),
    ("query u-shape.nii.gz --pose poses.tsv --only @list.txt", {"output": ".tsv"}, [*ATLAS, "poses.tsv", "list.txt"]),
    ("query u-shape.nii.gz --probe probe.json --origin 40,0,0 --toward 0,0,0 --format bep032",
     {"output": ".tsv", "probes": ".tsv", "coordsystem": ".json"}, [*ATLAS, "probe.json"]),
    ("query both.atlas.json " + AIM, {"output": ".tsv", "mask": ".nii.gz"},
     ["both.atlas.json", "u-shape.nii.gz", "u-shape.tsv", "grey.nii.gz", "bundle.tck"]),
    ("query pair.hdr " + AIM, {"output": ".tsv", "mask": ".nii.gz"}, ["pair.hdr", "pair.img", "pair.tsv"]),
    ("batch u-shape.nii.gz --poses poses.tsv", {"output": ".tsv", "segments": ".csv", "clearance": ".ndjson"},
     [*ATLAS, "poses.tsv"]),
    ("track u-shape.nii.gz --poses track.tsv", {"output": ".tsv", "sidecar": ".json"}, [*ATLAS, "track.tsv"]),
    (f"sweep u-shape.nii.gz --pose poses.tsv {MORE}", {"output": ".tsv", "sidecar": ".json"},
     ["u-shape.nii.gz", "own.tsv", "poses.tsv", "bundle.tck", "shift.txt"]),
    ("overlap u-shape.nii.gz region.nii.gz grey.nii.gz", {"output": ".tsv", "sidecar": ".json", "clusters": ".csv"},
     [*ATLAS, "region.nii.gz", "grey.nii.gz"]),
    ("connect u-shape.nii.gz bundle.tck", {"output": ".tsv", "sidecar": ".json", "connectivity": ".tsv"},
     [*ATLAS, "bundle.tck"]),
    (PLAN + " --from entries.tsv", {"output": ".tsv", "sidecar": ".json", "poses-out": ".tsv", "constraints": ".tsv",
                                    "tolerance": ".tsv"}, [*ATLAS, "entries.tsv", "targets.tsv", "apart.tsv"]),
    (PLAN.replace("--toward targets.tsv", "--toward voxels,spacing=3") + " --from skin.func.gii,spacing=20,without=region.nii.gz --avoid U",
     {"output": ".tsv", "map": ".func.gii", "target-map": ".nii.gz", "profile": ".tsv"},
     [*ATLAS, "skin.func.gii", "region.nii.gz", "apart.tsv"]),
    ("plan u-shape.nii.gz --poses poses.tsv --reach Ball,@list.txt,length=1",
     {"output": ".tsv", "poses-out": ".mrk.json"}, [*ATLAS, "poses.tsv", "list.txt"]),
    ("plan u-shape.nii.gz --needles needles.tsv --given given.tsv --reach Ball",
     {"output": ".tsv", "pairs": ".tsv", "poses-out": ".tsv", "candidates": ".tsv"}, [*ATLAS, "needles.tsv", "poses.tsv", "given.tsv"]),
    ("calibrate --poses trials.tsv", {"output": ".tsv", "sidecar": ".json"}, ["trials.tsv"]),
    ("calibrate u-shape.nii.gz --poses trials.tsv --weight gauss=2", {"output": ".tsv"}, [*ATLAS, "trials.tsv"]),
    ("positions C3 --scalp head.surf.gii,nasion=0:90:0,inion=0:-90:0,lpa=-90:0:0,rpa=90:0:0", {"output": ".tsv", "sidecar": ".json"},
     ["head.surf.gii"]),
    (f"render u-shape.nii.gz {AIM} --context grey.nii.gz --size 16x16 --camera camera.txt --palette palette.txt --transfer transfer.txt",
     {"output": ".png", "caption": ".txt"}, [*ATLAS, "grey.nii.gz", "camera.txt", "palette.txt", "transfer.txt"]),
    ("pack both.atlas.json --labels own.tsv --context region.nii.gz", {"output": ".conus"},
     ["both.atlas.json", "u-shape.nii.gz", "own.tsv", "grey.nii.gz", "bundle.tck", "region.nii.gz"]),
    (f"query both.conus {AIM}", {"output": ".tsv", "mask": ".nii.gz"}, ["both.conus"]),
    (f"query both.conus --atlas pair.conus {AIM}", {"output": ".tsv"}, ["both.conus", "pair.conus"]),
    ("batch both.conus --poses poses.tsv", {"output": ".tsv", "segments": ".csv"}, ["both.conus", "poses.tsv"]),
    ("pack pair.hdr", {"output": ".conus"}, ["pair.hdr", "pair.img", "pair.tsv"]),
    ("page both.atlas.json --template template.html", {"output": ".html"},
     ["both.atlas.json", "u-shape.nii.gz", "u-shape.tsv", "grey.nii.gz", "bundle.tck", "template.html"]),
    ("page u-shape.nii.gz --context region.nii.gz --template template.html", {"output": ".html"},
     [*ATLAS, "region.nii.gz", "template.html"]),
]


def gifti(points, triangles):
    """A surface as text: an octahedron needs no packing."""
    def array(intent, kind, rows):
        cells = " ".join(str(cell) for row in rows for cell in row)
        return (f'<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{kind}" Dimensionality="2" Dim0="{len(rows)}" '
                f'Dim1="3" ArrayIndexingOrder="RowMajorOrder" Encoding="ASCII" Endian="LittleEndian"><Data>{cells}</Data></DataArray>')
    return ('<?xml version="1.0"?><GIFTI Version="1.0" NumberOfDataArrays="2">' + array("POINTSET", "FLOAT32", points) +
            array("TRIANGLE", "INT32", triangles) + "</GIFTI>")


def run(folder, words, **more):
    # -view shares what is checked here: the library's one writer
    return subprocess.run([CONUS, *words], cwd=folder, capture_output=True, text=True, check=False, **more)


def ball(radius, bands):
    """Points and triangles of a closed ball: a pole, rings, a pole."""
    around = 2 * bands
    rings = [[math.pi * i / bands, 2 * math.pi * k / around] for i in range(1, bands) for k in range(around)]
    points = [(0, 0, radius), *((radius * math.sin(t) * math.cos(f), radius * math.sin(t) * math.sin(f), radius * math.cos(t))
                                for t, f in rings), (0, 0, -radius)]
    last = len(points) - 1
    triangles = []
    for k in range(around):
        after = (k + 1) % around
        triangles += [(0, 1 + k, 1 + after), (last, last - around + after, last - around + k)]
        for i in range(bands - 2):
            a, b = 1 + i * around + k, 1 + i * around + after
            triangles += [(a, a + around, b + around), (a, b + around, b)]
    return points, triangles


def make_inputs(folder):
    def write(name, text):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)
    for words in ("phantom u-shape -o . --size 32", "phantom bundle -o .", "phantom sphere -o other --size 16",
                  "phantom sphere -o other2 --size 24"):
        run(folder, words.split()).check_returncode()
    shutil.move(f"{folder}/other/sphere.nii.gz", f"{folder}/region.nii.gz")
    shutil.move(f"{folder}/other2/sphere.nii.gz", f"{folder}/grey.nii.gz")
    for name in ("other", "other2", "u-shape.json", "bundle.json", "bundle.atlas.json"):
        path = os.path.join(folder, name)
        shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)
    with gzip.open(f"{folder}/u-shape.nii.gz") as file:
        volume = bytearray(file.read())
    volume[108:112] = struct.pack("<f", 0)
    volume[344:348] = b"ni1\0"
    with open(f"{folder}/pair.hdr", "wb") as head, open(f"{folder}/pair.img", "wb") as voxels:
        head.write(volume[:352])
        voxels.write(volume[352:])
    shutil.copy(f"{folder}/u-shape.tsv", f"{folder}/pair.tsv")
    write("own.tsv", "index\tname\n1\tArm\n2\tRound\n")
    write("shift.txt", "1 0 0 1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
    write("list.txt", "U\nBall\n")
    write("poses.tsv", "query_id\tx\ty\tz\tdx\tdy\tdz\tfar\n" + "".join(f"p{i}\t40\t{i}\t0\t-1\t0\t0\t45\n" for i in range(4)))
    write("track.tsv", "time_s\tx\ty\tz\tdx\tdy\tdz\n" + "".join(f"{i}\t40\t{i}\t0\t-1\t0\t0\n" for i in range(3)))
    write("trials.tsv", "x\ty\tz\tdx\tdy\tdz\taim_x\taim_y\taim_z\tmeant\n" + "".join(
        f"40\t0\t0\t-60\t{n % 3}\t{n % 5}\t0\t0\t0\tU\n" for n in range(12)))
    write("apart.tsv", "query_id\tx\ty\tz\tdx\tdy\tdz\tfar\na\t40\t0\t40\t-1\t0\t0\t30\n")
    write("needles.tsv", "needle\tposes\nA\tposes.tsv\nB\tposes.tsv\n")
    write("given.tsv", "query_id\tx\ty\tz\tdx\tdy\tdz\tfar\nB\t40\t0\t2\t-1\t0\t0\t45\n")
    write("entries.tsv", "40 0 0\n30 20 0\n")
    write("targets.tsv", "0 0 0\n")
    write("camera.txt", "1 0 0 0\n0 1 0 0\n0 0 1 200\n0 0 0 1\n")
    write("transfer.txt", "0 1 1 1 0\n1 1 1 1 1\n")
    write("palette.txt", "#112233 #445566\n")
    write("template.html", "<html>\n<!-- atlas -->\n")
    write("probe.json", json.dumps({"specification": "probeinterface", "version": "0.2.26", "probes": [
        {"ndim": 2, "si_units": "mm", "contact_positions": [[0, i] for i in range(40)],
         "contact_ids": [f"e{i}" for i in range(40)], "probe_planar_contour": [[-1, 60], [-1, 0], [1, 0], [1, 60]]}]}))
    write("both.atlas.json", json.dumps({"conus_atlas": 1, "parcellation": {"file": "u-shape.nii.gz"},
                                         "context": {"file": "grey.nii.gz"}, "streamlines": [{"file": "bundle.tck"}]}))
    for words in ("pack both.atlas.json -o both.conus", "pack pair.hdr -o pair.conus"):
        run(folder, words.split()).check_returncode()
    write("head.surf.gii", gifti(*ball(90, 60)))
    signs = [(20, 0, 0), (-20, 0, 0), (0, 20, 0), (0, -20, 0), (0, 0, 20), (0, 0, -20)]
    write("skin.func.gii", gifti(signs, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]))


def command(folder, row, chosen, path):
    """The words of a row with the file `path` for the output `chosen`; others go to new files."""
    words = [*row[0].split(), "--quiet"]
    for i, (option, ending) in enumerate(row[1].items()):
        value = path if option == chosen else f"new{i}{ending}"
        words += [f"--{option}", value]
    return words


def bytes_of(path):
    with open(path, "rb") as file:
        return file.read()


def name_for(folder, way, ending, source):
    """A path that leads to the file; None where the option would not take its name."""
    if way == "same":
        return source if source.endswith(ending) else None
    if way == "dots":
        os.mkdir(f"{folder}/deep")
        return f"deep/../{source}" if source.endswith(ending) else None
    path = f"way{ending}"
    (os.symlink if way == "link" else os.link)(source if way == "link" else f"{folder}/{source}", f"{folder}/{path}")
    return path


def attempt(inputs, row, option, source, way):
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(inputs, folder, dirs_exist_ok=True)
        path = name_for(folder, way, row[1][option], source)
        if path is None:
            return None
        words = command(folder, row, option, path)
        words += ["--force"] if words[0] != "render" else [] # which always replaces
        before = {name: bytes_of(f"{folder}/{name}") for name in row[2]}
        there = sorted(os.listdir(folder))
        done = run(folder, words)
        lost = [name for name, data in before.items() if not os.path.exists(f"{folder}/{name}") or bytes_of(f"{folder}/{name}") != data]
        says = done.stderr.strip().splitlines()
        named = len(says) == 1 and path in says[0] and "would overwrite the input" in says[0]
        is_link = done.returncode == 3 and "is a link, which a file would replace" in done.stderr # of a batch, which replaces none
        kept = done.returncode == 2 and named or is_link
        new = [name for name in os.listdir(folder) if name not in there] # it was found before anything was written
        return None if kept and not lost and not new else (
            f"conus {' '.join(words)}  ({way} {source}): {done.returncode}, lost {lost}, wrote {new}, said {says}")


def check_row(inputs, row):
    """The command itself does what it says: all its outputs are written."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(inputs, folder, dirs_exist_ok=True)
        words = command(folder, row, "column" if "column" in row[1] else None, "new0.tsv")
        done = run(folder, words)
        missing = [f"new{i}{ending}" for i, ending in enumerate(row[1].values()) if not os.path.exists(f"{folder}/new{i}{ending}")]
        return f"conus {' '.join(words)}: {done.returncode}, no {missing}: {done.stderr}" if missing and done.returncode != 4 else None


def check_options():
    """Every option that writes a file is an output of a row."""
    rows = {(row[0].split()[0], option) for row in ROWS for option in row[1]} | {(name, "output") for name in ("mesh", "phantom", "report")}
    for command in json.loads(run(".", ["help", "--json"]).stdout)["commands"]:
        for option in command["options"]:
            if option["role"] == "writes" and (command["name"], option["name"]) not in rows:
                yield f"conus {command['name']} --{option['name']}: no row of ROWS has it"


def main():
    with tempfile.TemporaryDirectory() as inputs, concurrent.futures.ThreadPoolExecutor(2) as threads:
        make_inputs(inputs)
        faults = list(check_options())
        faults += filter(None, threads.map(lambda row: check_row(inputs, row), ROWS))
        if faults: # then refusals mean nothing
            print("\n".join(faults))
            return 1
        ways = ("link", "hard", "same", "dots")
        tries = [(row, option, source) for row in ROWS for option in row[1] for source in row[2]]
        tries = [(*what, way) for i, what in enumerate(tries) for k, way in enumerate(ways) if LONG or k == i % 2 or k == 2]
        faults += filter(None, threads.map(lambda what: attempt(inputs, *what), tries))
        print("\n".join(faults) + ("\n" if faults else "") + f"{len(tries)} tries")
        return len(faults) > 0


sys.exit(main())
