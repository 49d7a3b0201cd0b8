# SPDX-License-Identifier: BSD-3-Clause
"""The commands that tests/equal/outputs runs, and the input files that they read.

`write_inputs` writes files of poses, label tables, streamlines and scripts from fixed formulas, and copies the
corpora. Each function in GROUPS is one group of commands, which runs beside others, but in its order. It calls
`ask(WORDS)` for each command:

    WORDS   stand behind `conus`; {o} is a new folder for the outputs of this command
    stdout  is the ending of the file that gets standard output. Without it, --format decides; tables,
            trees and all other words are texts.
    stdin   is a file for standard input
    makes   is a folder to make first
    before  are pairs (FROM, TO) of files and folders to copy first
    within  is the folder in which the command runs
    program is another program than conus

A file outside {o} belongs to the group that names its folder; no other group may write to it.
`ask.facts` is what `find_facts()` of tests/equal/outputs found.
"""
import itertools
import json
import math
import os
import pathlib
import shlex
import shutil

AIM = "--origin=-90,20,20 --toward=0,-10,10"
BRAIN_AIM = "--origin=-110,-60,60 --toward=-30,-20,25"
BALL_AIM = "--origin=3,-100,5 --toward=0,0,0"
WINDOWS = {"window-nested": "ph/nested.nii.gz", "window-brain": "ph/brain/brain.atlas.json",
           "window-tubes": "ph/tubes.nii.gz"}
PHANTOMS = ["sphere", "nested", "slabs", "torus", "u-shape", "tubes"]
FORMATS = ["tsv", "csv", "json", "ndjson", "afni"]
TEMPLATES = "in/templates"
SHARED = "in/shared"
SCORES = ["share", "centre", "distance", "nearness", "visibility", "proximity", "mrtk", "smallest",
          "'0.5*share+0.5*centre'", "'-distance/2+(share*3-centre)'"]
ANGLES = [1, 5, 10, 20, 40, 60, 90, 130]


# input files
def spiral(count, radius, centre=(0, 0, 0)):
    """(origin, target, angle) of COUNT devices on a sphere around the centre; all look to its inside."""
    for i in range(count):
        height = 1 - 2 * (i + 0.5) / count
        ring, turn = math.sqrt(1 - height * height), i * 2.399963229728653
        place = (ring * math.cos(turn), ring * math.sin(turn), height)
        aside = (math.sin(1.7 * i), math.cos(2.3 * i), math.sin(0.9 * i + 1))
        yield ([c + radius * p for c, p in zip(centre, place)],
               [c + 0.3 * radius * a for c, a in zip(centre, aside)], ANGLES[i % len(ANGLES)])


def pose_table(path, count, radius, centre=(0, 0, 0), bad=False):
    lines = ["query_id\tx\ty\tz\ttx\tty\ttz\tangle"]
    for i, (origin, target, angle) in enumerate(spiral(count, radius, centre)):
        numbers = "\t".join(f"{v:.4f}" for v in origin + target)
        lines.append(f"p{i}\t{numbers}\t{angle}")
    if bad:
        lines[3] = "same\t1\t2\t3\t1\t2\t3\t10"
        lines[7] = "word\t1\tx\t3\t0\t0\t0\t10"
        lines[9] = "short\t1\t2"
        lines[11] = "wide\t1\t2\t90\t0\t0\t0\t180"
    write(path, "\n".join(lines) + "\n")


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8", newline="") as file:
        file.write(text)


def write_inputs(folder, facts):
    def put(name, text):
        write(os.path.join(folder, name), text)

    def table(name, *arguments, **options):
        pose_table(os.path.join(folder, name), *arguments, **options)

    table("ball.tsv", 60, 90)
    table("bad.tsv", 24, 90, bad=True)
    table("many.tsv", 400, 90)
    table("brain.tsv", 48, 130, (0, -15, 10))
    table("ccf.tsv", 24, 12, (6.6, -4, -5.7))
    table("bonsai.tsv", 8, 260, (128, 128, 128))

    # every kind of table
    rows = list(spiral(10, 80))
    way = [[t - o for o, t in zip(origin, target)] for origin, target, _ in rows]
    put("direction.csv", "x,y,z,dx,dy,dz,ux,uy,uz,name\n" + "".join(
        ",".join(f"{v:.3f}" for v in origin + d) + f',0,1,0.2,"d, {i}"\n'
        for i, ((origin, _, _), d) in enumerate(zip(rows, way))))
    put("quaternion.tsv", "x\ty\tz\tqw\tqx\tqy\tqz\terror_deg\terror_mm\n" + "".join(
        "\t".join(f"{v:.3f}" for v in origin + [math.cos(i), math.sin(i), math.cos(2 * i), 0.1]) +
        f"\t{i % 4}\t{0.5 * (i % 3)}\n" for i, (origin, _, _) in enumerate(rows)))
    put("semicolon.csv", "id;x;y;z;tx;ty;tz\n" + "".join(
        f"s{i};" + ";".join(f"{v:.3f}" for v in origin + target) + "\n"
        for i, (origin, target, _) in enumerate(rows)))
    put("matrices.tsv", "\t".join(f"m{r}{c}" for r in range(4) for c in range(4)) + "\tid\n" + "".join(
        "\t".join(str(v) for v in [1, 0, 0, x, 0, 0, -1, -80, 0, 1, 0, z, 0, 0, 0, 1]) + f"\tm {x} {z}\n"
        for x in (-8, 0, 9) for z in (-7, 0, 6)))
    put("matrix.txt", "1 0 0 2\n0 0 -1 -80\n0 1 0 3\n0 0 0 1\n")
    put("points.txt", "# in mm\n0 -8 0 below\n0 0 0\n12,3,-4,beside\n0 x 0 bad\n0 0 90 far\n-5 -20 1 edge\n")
    columns = "Loc. X\tLoc. Y\tLoc. Z\t" + "\t".join(f"m{i}n{j}" for i in range(3) for j in range(3))
    put("brainsight.txt", "# Version: 12\n# Coordinate system: NIfTI:Scanner\n"
        f"# Target Name\t{columns}\n"
        "side\t80\t0\t0\t0\t1\t0\t0\t0\t1\t1\t0\t0\n"
        "front\t0\t80\t5\t1\t0\t0\t0\t0\t-1\t0\t1\t0\n"
        "none\t(null)\t(null)\t(null)\t1\t0\t0\t0\t1\t0\t0\t0\t1\n"
        f"# Electrode Name\t{columns}\n"
        "E1\t5\t4\t3" + "\t(null)" * 9 + "\n")

    def localite(kind, child, attributes, places):
        text = f'<?xml version="1.0" encoding="UTF-8"?>\n<{kind} coordinateSpace="LPS">\n'
        for i, (x, y, z) in enumerate(places):
            numbers = [1, 0, 0, x, 0, 0, -1, y, 0, 1, 0, z, 0, 0, 0, 1]
            matrix = " ".join(f'data{k // 4}{k % 4}="{v}"' for k, v in enumerate(numbers))
            inner = f"<Matrix4D {matrix}/>"
            if child == "InstrumentMarker":
                inner = f'<Marker description="mark {i}" set="true">{inner}</Marker>'
            text += f'<{child} {attributes.format(i, 1000 + 40 * i)}>{inner}</{child}>\n'
        return text + f"</{kind}>\n"

    places = [(-80, 0, 0), (-75, 4, 2), (-70, -6, 1)]
    put("instrument.xml", localite("InstrumentMarkerList", "InstrumentMarker", "", places))
    put("trigger.xml", localite("TriggerMarkerList", "TriggerMarker",
                                'description="stimulus {0}" recordingTime="{1}"', places))

    def markup(kind, name, *points):
        return {"type": kind, "coordinateSystem": "LPS", "coordinateUnits": "mm", "name": name,
                "controlPoints": [{"label": f"{name} {i}", "position": list(p), "positionStatus": "defined"}
                                  for i, p in enumerate(points)]}
    put("lines.mrk.json", json.dumps({"markups": [
        markup("Line", "side", (-80, 0, 0), (0, 0, 0)), markup("Line", "top", (3, 4, 90), (0, 1, 2)),
        markup("Fiducial", "F", (0, 5, 0), (12, 0, 3)), markup("Plane", "P", (0, 0, 0))]}, indent=1) + "\n")
    shafts = "".join(f"{shaft}{k}\t{x + 3.5 * k:.1f}\t{y - 0.7 * k:.1f}\t{z + 0.4 * k:.1f}\t{k}\t{shaft}\n"
                     for shaft, x, y, z in (("A", -34, 1, 2), ("B'", -30, 12, -6)) for k in range(1, 19))
    put("sub-01_space-MNI152Lin_electrodes.tsv",
        "name\tx\ty\tz\tsize\tgroup\n" + shafts + "R1\tn/a\t0\t0\t1\tR\n")
    put("sub-01_space-MNI152Lin_coordsystem.json", json.dumps(
        {"iEEGCoordinateSystem": "MNI152Lin", "iEEGCoordinateUnits": "mm"}) + "\n")
    put("plain_electrodes.tsv", "name\tx\ty\tz\tsize\tgroup\n" + shafts)

    # a trembling hand, with a trigger, a gap and a row out of time
    lines = ["time_s\tx\ty\tz\ttx\tty\ttz\ttrigger"]
    for i in range(90):
        time = i / 30 + (3 if i > 70 else 0)
        aim = (14 * math.sin(i / 9) + 3 * math.sin(5.1 * i), 9 * math.cos(i / 7), 4 * math.sin(2.2 * i))
        lines.append(f"{time:.4f}\t2\t-95\t4\t" + "\t".join(f"{v:.3f}" for v in aim) + f"\t{int(i % 25 > 21)}")
    put("hand.tsv", "\n".join(lines) + "\n")
    put("trials.tsv", "".join(f"{line}\t{aims}\n" for line, aims in zip(
        lines, ["aim_x\taim_y\taim_z\tmeant", *(f"{i % 7 - 3}\t5\t{i % 5}\t{('Core', '300', 'Shell outer')[i % 3]}" for i in range(90))])))
    lines.insert(40, "0.5\t2\t-95\t4\t0\t0\t0\t0")
    put("hand-late.tsv", "\n".join(lines) + "\n")

    put("tree.tsv", "index\tname\tparent_id\tabbreviation\tcolor\themisphere\n1\tOuter, "
        "thick\t20\tOu\t#102030\tL\n"
        "300\tInner\t20\tIn\t#a0b0c0\tR\n20\tShell\t40\tSh\tn/a\tB\n4000000001\tCore\t40\tCo\t#ff0000\tn/a\n"
        "40\tBall\tn/a\tBa\tn/a\tn/a\n")
    put("names.txt", "# one per line\nOuter, thick\nCore\n")
    put("pairs.txt", "".join(f"{k} {name}\n" for k, name in enumerate(
        ("Arch_L", "Arch_R", "left middle", "right middle", "Rim L", "Rim"), 1)))
    put("grey.transfer", "relative\n# value r g b opacity\n0.1 0 0 0 0\n0.4 0.8 0.7 0.6 0.05\n1 1 1 1 0.3\n")
    put("cube.obj", "o Lower, part\nv 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 0 0 9\nv 9 0 9\nv 9 9 9\nv 0 9 9\n"
        "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\no Tip\nv 4 4 9.5\nv 7 4 9.5\nv 4 7 9.5\n"
        "v 4 4 15\nf 9 11 10\nf 9 10 12\nf 10 11 12\nf 11 9 12\n")
    put("outside.atlas.json", json.dumps({
        "conus_atlas": 1, "allow_outside": True, "parcellation": {"file": "../ph/nested.nii.gz"},
        "areas": [{"file": "cube.obj", "label": 7, "name": "Cube", "color": "#ff4000", "parent": 1}],
        "pathways": [{"file": "../ph/brain/brain-pathway.nii.gz", "name": "Arc", "threshold": 30000}],
        "context": {"file": "../ph/brain/brain-context.nii.gz", "transfer": "brain"}}, indent=1) + "\n")
    for name in WINDOWS:
        put(f"{name}.txt", f"size 600 400\nangle 8\naim 30 80 40 0 0 0\nsettle\nresults {name}/rows.tsv\n"
            f"picture {name}/scene.png 200 150\nsave {name}/session.json\nscreenshot {name}/window.png\nkey l\n"
            f"angle 30\nsettle\nresults {name}/all.tsv\norbit 40 20\nsettle\nscreenshot {name}/layers.png\n")
    # a pyramid: a surface of five vertices, as many as annotations of the corpora have
    put("five.surf.gii", '<GIFTI Version="1.0" NumberOfDataArrays="2">\n' + "".join(
        f'<DataArray Intent="NIFTI_INTENT_{intent}" DataType="NIFTI_TYPE_{kind}" ArrayIndexingOrder="RowMajorOrder" '
        f'Dimensionality="2" Dim0="{len(rows)}" Dim1="3" Encoding="ASCII" Endian="LittleEndian"><Data>'
        f'{" ".join(str(v) for row in rows for v in row)}</Data></DataArray>\n' for intent, kind, rows in (
            ("POINTSET", "FLOAT32", [(0, 0, 0), (9, 0, 0), (9, 9, 0), (0, 9, 0), (4, 4, 9)]),
            ("TRIANGLE", "INT32", [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]))) + "</GIFTI>\n")
    # a bundle of three arcs through the nested shells, and a table of needles
    points = [(24 * math.cos(math.pi * i / 8), -24 + 8 * k, 24 * math.sin(math.pi * i / 8))
              for k in (1, 3, 5) for i in range(9)]
    put("arcs.vtk", "# vtk DataFile Version 3.0\narcs\nASCII\nDATASET POLYDATA\nPOINTS 27 float\n" +
        "".join(f"{x:.3f} {y:.3f} {z:.3f}\n" for x, y, z in points) + "LINES 3 30\n" +
        "".join(" ".join(str(n) for n in [9, *range(9 * k, 9 * k + 9)]) + "\n" for k in range(3)))
    put("needles.tsv", "query_id\tx\ty\tz\ttx\tty\ttz\tfar\n" + "".join(
        f"n{x}_{z}\t{x}\t-60\t{z}\t{x}\t0\t{-z}\t{64 + x}\n" for x in (-9, 0, 7) for z in (-6, 0, 11)))
    here = pathlib.Path(__file__).parent
    for source, target in [*itertools.chain(*facts["corpora"].values()), (here / "calls.py", "calls.py"),
                           (here.parent / "fuzz/corpus/probe_interface/two_shanks.json", "probe.json")]:
        os.makedirs(os.path.join(folder, os.path.dirname(target)), exist_ok=True)
        shutil.copyfile(source, os.path.join(folder, target))


# groups of commands
def phantoms(ask):
    for kind in PHANTOMS:
        ask(f"phantom {kind} -o ph")
    ask("phantom brain -o ph/brain")
    for number, (kind, options) in enumerate(itertools.product(
            ("nested", "tubes"), ("--size 32 --spacing 2,2,2", "--size 40 --spacing 1,1,2.5 --oblique 30",
                                  "--flip x --size 33",
                                  "--flip xyz --oblique -75 --spacing 0.5,1,1.5 --size 48"))):
        ask(f"phantom {kind} -o ph/grid{number} {options}")


def answers(ask):
    """Each format, on standard output and in a file with its sidecar."""
    for kind in PHANTOMS:
        for form in FORMATS:
            ask(f"query ph/{kind}.nii.gz {BALL_AIM} --angle 30 --format {form}")
        for form in FORMATS[:4]:
            ask(f"query ph/{kind}.nii.gz --pose in/ball.tsv -o {{o}}/rows.{form}")
            ask(f"query ph/{kind}.nii.gz --pose in/ball.tsv --layers all -o {{o}}/rows.{form}")
        ask(f"query ph/{kind}.nii.gz --pose in/ball.tsv --format afni -o {{o}}/afni.txt")
    for number in range(8):
        kind = ("nested", "tubes")[number // 4]
        ask(f"query ph/grid{number}/{kind}.nii.gz --pose in/ball.tsv --layers all -o {{o}}/rows.tsv")
    ask("query ph/sphere.nii.gz --pose in/ball.tsv -o {o}/rows.jsonl")
    ask("query ph/sphere.nii.gz --pose - --format tsv", stdin="in/ball.tsv")
    for atlas in ("ph/brain/brain.atlas.json", "in/outside.atlas.json"):
        for layers, form in itertools.product(("visible", "all"), ("tsv", "csv", "json", "ndjson")):
            ask(f"query {atlas} --pose in/brain.tsv --layers {layers} -o {{o}}/rows.{form}")


def looks(ask):
    """How the device looks: options of the cone, the buffer and the ranking."""
    atlases = ("ph/nested.nii.gz", "ph/u-shape.nii.gz", "ph/brain/brain.atlas.json")
    options = ["--aperture square", "--resolution 1", "--resolution 33", "--resolution 64 --aperture square",
               "--sampling slices", "--sampling slices --slices 300", "--range 60,95", "--space lps",
               "--layers all --range 60,110", "--layers all --resolution 40", "--up 1,2,3"]
    for atlas, option in itertools.product(atlases, options):
        for angle in (3, 25, 150) if atlas.startswith("ph/n") else (25,):
            ask(f"query {atlas} {BALL_AIM} --angle {angle} {option} --format tsv")
    for atlas, layers, radius in itertools.product(atlases, ("visible", "all"), ("0.3", "6")):
        ask(f"query {atlas} {BALL_AIM} --radius {radius} --layers {layers} --format tsv")
        ask(f"query {atlas} {BALL_AIM} --radius {radius} --range 70,100 --layers {layers} --format json")
    for atlas, point in itertools.product(atlases, ("0,0,0", "0,-23,0", "14,9,-6.5", "300,0,0")):
        for radius, form in (("0.5", "tsv"), ("5", "json"), ("20", "tsv")):
            ask(f"query {atlas} --point {point} --radius {radius} --format {form}")
    for atlas, score in itertools.product(atlases, SCORES):
        ask(f"query {atlas} --pose in/ball.tsv --score {score} --format tsv")
    for atlas in atlases:
        ask(f"query {atlas} --pose in/ball.tsv --layers all --score unoccluded --format tsv")
        ask(f"query {atlas} --origin 3,-100,5 --direction 0.1,1,0.05 --angle 12 --format json")


def areas(ask):
    """Levels, hemispheres, what is hidden, contexts, pathways."""
    tree = "ph/nested.nii.gz --labels in/tree.tsv"
    for level in ("1", "2", "3", "Shell", "'\"Outer, thick\",Core'", "@in/names.txt", "Ba"):
        for layers in ("visible", "all"):
            ask(f"query {tree} {BALL_AIM} --angle 40 --level {level} --layers {layers} --format tsv")
        ask(f"query {tree} --pose in/ball.tsv --level {level} --layers all -o {{o}}/rows.csv")
    for form in ("tsv", "json", "tree"):
        ask(f"info {tree} --format {form}")
    for kind, how in itertools.product(("slabs", "sphere"), ("as-is", "split")):
        ask(f"query ph/{kind}.nii.gz --pose in/ball.tsv --hemispheres {how} --layers all -o {{o}}/rows.tsv")
        ask(f"info ph/{kind}.nii.gz --hemispheres {how} --format json")
    for how in ("as-is", "merged"):
        ask(f"query ph/tubes.nii.gz --labels in/pairs.txt --pose in/ball.tsv --hemispheres {how} -o "
            f"{{o}}/rows.tsv")
        ask(f"info ph/tubes.nii.gz --labels in/pairs.txt --hemispheres {how} --format json")
    for shown in ("--hide Core", "--only Shell", "--only Shell --hide In", "--hide @in/names.txt",
                  "--only 4000000001"):
        ask(f"query {tree} --pose in/ball.tsv {shown} -o {{o}}/rows.tsv")
        ask(f"query {tree} --pose in/ball.tsv {shown} --layers all -o {{o}}/rows.json")
        ask(f"query {tree} {BALL_AIM} --angle 30 --image {{o}}/seen.exr --mask {{o}}/mask.nii.gz {shown} -o "
            f"{{o}}/rows.tsv")
    arc = "--pathway ph/brain/brain-pathway.nii.gz"
    for options in ("", ",threshold=9000", ",threshold=60000,name=Bow", ",volume=0"):
        for layers in ("visible", "all"):
            ask(f"query ph/nested.nii.gz {arc}{options} --pose in/brain.tsv --layers {layers} -o "
                f"{{o}}/rows.tsv")
    ask(f"query ph/nested.nii.gz {arc} {arc},threshold=50000,name=Two --pose in/ball.tsv -o {{o}}/rows.json")
    context = "--context ph/brain/brain-context.nii.gz --context-blocks"
    for blocks in ("20000", "1", "200"):
        for options in ("", "--layers all"):
            ask(f"query ph/nested.nii.gz {BALL_AIM} --angle 30 {context} {blocks} {options} --format tsv")
    ask(f"query ph/brain/brain.atlas.json --pose in/brain.tsv {context} 30000 -o {{o}}/rows.json")


def poses(ask):
    tables = ["bad.tsv", "direction.csv", "quaternion.tsv", "semicolon.csv", "matrices.tsv", "matrix.txt",
              "brainsight.txt", "instrument.xml", "trigger.xml", "lines.mrk.json", "ball.tsv"]
    for table in tables:
        for form in ("tsv", "csv", "json", "ndjson"):
            ask(f"query ph/tubes.nii.gz --pose in/{table} --any-space -o {{o}}/rows.{form}")
        ask(f"query ph/tubes.nii.gz --pose in/{table} --any-space --space lps --format tsv")
        for command in ("batch ph/nested.nii.gz --poses", "sweep ph/nested.nii.gz --format tsv --pose"):
            ask(f"{command} in/{table} --any-space", stdout="tsv")
    ask("track ph/nested.nii.gz --poses in/trigger.xml --format tsv")
    for table, axis in [*itertools.product(("matrices.tsv", "brainsight.txt", "instrument.xml"),
                                           ("+x", "-x", "+y", "-y", "+z", "-z")),
                        ("lines.mrk.json", "+z"), ("lines.mrk.json", "-z")]:
        ask(f"query ph/nested.nii.gz --pose in/{table} --any-space --axis={axis} --angle 60 --format tsv")
    for table in ("points.txt", "plain_electrodes.tsv", "sub-01_space-MNI152Lin_electrodes.tsv",
                  "lines.mrk.json",
                  "brainsight.txt"):
        for radius, layers in itertools.product(("0.8", "4"), ("visible", "all")):
            ask(f"query ph/nested.nii.gz --pose in/{table} --any-space --radius {radius} --layers {layers} "
                f"--format tsv")
            ask(f"batch ph/nested.nii.gz --poses in/{table} --any-space --radius {radius} --layers {layers} "
                "-o {o}/rows.tsv")
    for options in ("", "--radius 2 --range 0,10", "--radius 1 --layers all"):
        ask(f"query ph/nested.nii.gz --pose in/plain_electrodes.tsv --along-shafts {options} -o "
            f"{{o}}/rows.tsv")
        ask(f"batch ph/nested.nii.gz --poses in/plain_electrodes.tsv --along-shafts {options} -o "
            f"{{o}}/rows.ndjson")


def other_programs(ask):
    tables = ("plain_electrodes.tsv", "sub-01_space-MNI152Lin_electrodes.tsv")
    for form, table, kind in itertools.product(("bids", "afni", "spikeglx", "open-ephys"), tables, ("nested", "tubes")):
        name = "bids.tsv" if form == "bids" else form + ".txt"
        for radius in ("1", "4"):
            ask(f"query ph/{kind}.nii.gz --pose in/{table} --radius {radius} --format {form}")
            ask(f"query ph/{kind}.nii.gz --pose in/{table} --radius {radius} --format {form} -o {{o}}/{name}")
        ask(f"batch ph/{kind}.nii.gz --poses in/{table} --radius 2 --format {form} --threads 2 -o "
            f"{{o}}/{name}")


def pictures_of_answers(ask):
    """Voxels, images, masks."""
    for atlas, aim in (("ph/nested.nii.gz", BALL_AIM), ("ph/tubes.nii.gz", BALL_AIM), ("ph/u-shape.nii.gz", BALL_AIM),
                       ("ph/grid7/tubes.nii.gz", BALL_AIM), ("ph/brain/brain.atlas.json", BRAIN_AIM),
                       ("in/outside.atlas.json", BALL_AIM)):
        for options in ("--angle 25", "--angle 140", "--radius 7", "--angle 30 --range 50,90",
                        "--angle 30 --aperture square --resolution 20"):
            both = "--image {o}/seen.exr --voxels {o}/voxels.tsv --voxels-of all -o {o}/rows.tsv"
            ask(f"query {atlas} {aim} {options} {both}")
            ask(f"query {atlas} {aim} {options} --layers all {both}")
            ask(f"query {atlas} {aim} {options} --image {{o}}/seen.png -o {{o}}/rows.csv")
        if atlas.endswith(".nii.gz") or atlas.startswith("in/"):
            for name in ("mask.nii.gz", "cone_dseg.nii.gz", "cone_mask.nii"):
                ask(f"query {atlas} {aim} --angle 25 --mask {{o}}/{name} -o {{o}}/rows.tsv")
            for of in ("areas", "all", "labels"):
                ask(f"query {atlas} {aim} --radius 9 --mask {{o}}/mask.nii.gz --mask-of {of} --format tsv")
            ask(f"query {atlas} --point 0,-9,3 --radius 12 --mask {{o}}/mask.nii.gz --voxels "
                f"{{o}}/voxels.tsv "
                "--voxels-of all --format tsv")
    arc = "query ph/brain/brain.atlas.json --mask {o}/"
    for aim in (f"{BRAIN_AIM} --angle 30", "--point=-42,-23,32 --radius 15"):
        ask(f"{arc}arc_probseg.nii.gz --mask-object Arc {aim} --format tsv")
        ask(f"{arc}mask.nii.gz --mask-object Arc {aim} --voxels {{o}}/voxels.tsv --format tsv")
    ask(f"query ph/nested.nii.gz --labels in/tree.tsv --mask {{o}}/mask.nii.gz --mask-object Shell "
        f"{BALL_AIM} --format tsv")
    ask(f"query ph/nested.nii.gz --labels in/tree.tsv --mask {{o}}/x_dseg.nii.gz --level 2 {BALL_AIM} "
        f"--format tsv")


def gl(ask):
    """The OpenGL engine, whatever the driver is."""
    for atlas, table in (("ph/nested.nii.gz", "ball.tsv"), ("ph/tubes.nii.gz", "bad.tsv"),
                         ("ph/brain/brain.atlas.json", "brain.tsv"), ("in/outside.atlas.json", "ball.tsv")):
        for options in ("", "--layers all", "--sampling slices", "--range 50,100",
                        "--aperture square --resolution 24"):
            ask(f"query {atlas} --engine gl --pose in/{table} {options} -o {{o}}/rows.tsv")
        for block in (1, 64):
            ask(f"batch {atlas} --engine gl --poses in/{table} --block {block} -o {{o}}/rows.tsv")
        ask(f"query {atlas} --engine gl {BALL_AIM} --angle 30 --image {{o}}/seen.exr --layers all "
            "-o {o}/rows.json")
        ask(f"query {atlas} --engine gl {BALL_AIM} --angle 30 --image {{o}}/seen.png --format ndjson")
        ask(f"sweep {atlas} --engine gl {BALL_AIM} --angle 8 --jitter 2,1 --samples 64 --format tsv")
        ask(f"track {atlas} --engine gl --poses in/hand.tsv --score intenselect -o {{o}}/rows.tsv")


def batches(ask):
    for atlas in ("ph/nested.nii.gz", "ph/brain/brain.atlas.json"):
        for form in ("tsv", "csv", "ndjson"):
            ask(f"batch {atlas} --poses in/many.tsv -o {{o}}/rows.{form}")
            ask(f"batch {atlas} --poses in/many.tsv --summary -o {{o}}/summary.{form}")
            ask(f"batch {atlas} --poses in/bad.tsv --layers all --format {form}")
        for threads, block in ((1, 1), (2, 7), (3, 256), (4, 65536)):
            ask(f"batch {atlas} --poses in/many.tsv --threads {threads} --block {block} -o {{o}}/rows.tsv")
        ask(f"batch {atlas} --poses - --threads 2", stdout="tsv", stdin="in/many.tsv")
        ask(f"batch {atlas} --poses in/many.tsv --sampling slices --score mrtk -o {{o}}/rows.tsv")
        ask(f"batch {atlas} --poses in/many.tsv --layers all --range 40,95 --radius 3 -o {{o}}/rows.tsv")
        ask(f"batch {atlas} --poses in/bad.tsv --format afni")
    for form, extra in (("tsv", ""), ("csv", "--summary"), ("ndjson", "--layers all")):
        for part in ("0/3", "02/3", "1/3", "all/3"):
            ask(f"batch ph/tubes.nii.gz --poses in/bad.tsv {extra} --shard {part} -o parts-{form}/rows.{form}",
                makes=f"parts-{form}")
        ask(f"batch ph/tubes.nii.gz --poses in/bad.tsv {extra} --shard all/3 -o {{o}}/rows.{form}")
    ask("batch ph/sphere.nii.gz --poses in/ball.tsv -o again/rows.tsv", makes="again")
    ask("batch ph/sphere.nii.gz --poses in/ball.tsv -o again/rows.tsv")
    ask("batch ph/sphere.nii.gz --poses in/bad.tsv -o again/rows.tsv")
    ask("batch ph/sphere.nii.gz --poses in/bad.tsv --force -o again/rows.tsv")


def sweeps(ask):
    for atlas, aim in (("ph/nested.nii.gz", BALL_AIM), ("ph/tubes.nii.gz", BALL_AIM),
                       ("in/outside.atlas.json", BALL_AIM),
                       ("ph/brain/brain.atlas.json", BRAIN_AIM)):
        for form in ("tsv", "csv", "json", "ndjson"):
            ask(f"sweep {atlas} {aim} --angle 60 --format {form}")
            ask(f"sweep {atlas} --pose in/bad.tsv -o {{o}}/rows.{form}")
            ask(f"sweep {atlas} {aim} --angles 2:40:4 -o {{o}}/rows.{form}")
            ask(f"sweep {atlas} {aim} --angle 6 --jitter 3,2 --samples 256 -o {{o}}/rows.{form}")
            ask(f"query {atlas} {aim} --weight gauss=2 --score posterior -o {{o}}/rows.{form}")
        ask(f"sweep {atlas} {aim} --angle 40 --range 60,100 --format tsv")
        ask(f"sweep {atlas} {aim} --angles 5,30,150 --sampling slices --format tsv")
        ask(f"sweep {atlas} {aim} --radius 2 --jitter 4,0 --samples 64 --layers all --format json")
        ask(f"sweep {atlas} --pose in/quaternion.tsv --angle 20 --jitter columns --samples 64 -o "
            f"{{o}}/rows.tsv")
    for form in ("tsv", "csv", "json", "ndjson", "txt"):
        ask(f"calibrate --poses in/trials.tsv -o {{o}}/rows.{form}")
        ask(f"positions Fp2 C3 F9 Oz --handle 30 --out 5 -o {{o}}/rows.{form}")
        ask(f"calibrate ph/nested.nii.gz --poses in/trials.tsv --weight gauss=2 -o {{o}}/rows.{form}")
    ask(f"sweep ph/nested.nii.gz --labels in/tree.tsv --level 2 {BALL_AIM} --angle 50 --format json")
    ask(f"sweep ph/slabs.nii.gz --hemispheres split {BALL_AIM} --angle 50 --hide 1300 --format tsv")


def tracks(ask):
    scores = ["share", "time", "stability", "intenselect", "intenselect_plus",
              "'0.7*intenselect_plus+0.3*time'",
              "proximity", "smallest"]
    for atlas in ("ph/tubes.nii.gz", "ph/brain/brain.atlas.json"):
        for score in scores:
            ask(f"track {atlas} --poses in/hand.tsv --score {score} -o {{o}}/rows.tsv")
        for form in ("tsv", "csv", "json", "ndjson"):
            ask(f"track {atlas} --poses in/hand.tsv --score intenselect_plus --selected --format {form}")
            ask(f"track {atlas} --poses in/hand-late.tsv --score time -o {{o}}/rows.{form}")
        ask(f"track {atlas} --poses - --format ndjson", stdin="in/hand.tsv")
        ask(f"track {atlas} --poses in/hand.tsv --score intenselect --stickiness 0.8 --snappiness 0.2 --rate "
            f"30 --exponent 0.5 "
            "--delay 0.3 --window 1 --layers all -o {o}/rows.json")
        ask(f"track {atlas} --poses in/hand.tsv --score intenselect_plus --growth 3 --decay 9 --radius 2 -o "
            f"{{o}}/rows.csv")


def manifests(ask):
    kinds = [("ph/nested.nii.gz", "one/nested.nii.gz"), ("ph/nested.tsv", "one/nested.tsv"),
             ("ph/brain/brain-pathway.nii.gz", "one/arc.nii.gz"), ("ph/brain/brain-context.nii.gz", "one/t1.nii.gz"),
             ("in/cube.obj", "one/cubes/12_Cube.obj")]
    ask("manifest one", before=kinds)
    ask("manifest one --name again")
    ask("info one/one.atlas.json --format json")
    ask(f"query one/one.atlas.json {BALL_AIM} --angle 30 -o {{o}}/rows.tsv")
    surfaces = [(f"ph/brain/{name}", f"two/lh/{name}") for name in
                ("brain-01-AntL.surf.gii", "brain-03-SupL.surf.gii", "brain-05-PosL.surf.gii")]
    ask("manifest two", before=surfaces)
    ask("info two/two.atlas.json --format tsv")
    for atlas in [f"ph/{kind}.nii.gz" for kind in PHANTOMS] + [
            "ph/brain/brain.atlas.json", "in/outside.atlas.json", "ph/brain", "in/cube.obj"]:
        for form in ("tsv", "json", "tree"):
            ask(f"info {atlas} --format {form}")
    ask(f"query in/cube.obj {BALL_AIM} --layers all --format tsv")
    ask("manifest in/nowhere")


def meshes(ask):
    for form in ("gii", "vtp", "obj", "ply", "stl"):
        for atlas in ("ph/nested.nii.gz", "ph/grid7/tubes.nii.gz", "ph/brain/brain.atlas.json"):
            ask(f"mesh {atlas} -o {{o}}/meshes --format {form}")
            ask(f"mesh {atlas} -o {{o}}/meshes --format {form} --smooth 12 --pass-band 0.2 --decimate 0.6")
        ask(f"mesh ph/u-shape.nii.gz -o {{o}}/meshes --format {form} --smooth 0")
        ask(f"mesh ph/torus.nii.gz -o surfaces-{form} --format {form}")
        ask(f"query surfaces-{form} {BALL_AIM} --layers all -o {{o}}/rows.tsv")


def renders(ask):
    small = "--size 240x180"
    for kind in PHANTOMS:
        ask(f"render ph/{kind}.nii.gz {small} -o {{o}}/scene.png")
        ask(f"render ph/{kind}.nii.gz {small} {BALL_AIM} --angle 30 --no-legend -o {{o}}/cone.exr")
    brain, context = "ph/brain/brain.atlas.json", "--context ph/brain/brain-context.nii.gz"
    camera = "--camera-origin=-250,170,130 --camera-toward=-20,-30,28 --field-of-view 34"
    for form in ("png", "exr"):
        ask(f"render {brain} {small} {BRAIN_AIM} --angle 20 {camera} --no-legend -o {{o}}/cone.{form}")
        # the view from the device itself
        ask(f"render {brain} {small} {BRAIN_AIM} --angle 20 --camera-origin=-110,-60,60 "
            f"--camera-toward=-30,-20,25 "
            f"--field-of-view 60 --no-legend -o {{o}}/sight.{form}")
        ask(f"render {brain} {small} --camera in/matrix.txt --frustum=-0.3,0.4,-0.2,0.5 --no-legend -o "
            f"{{o}}/off.{form}")
        ask(f"render ph/nested.nii.gz {small} {context} --no-legend {BALL_AIM} --layers all -o "
            f"{{o}}/context.{form}")
    for transfer in ("brain", "surface", "grey", "bright", "in/grey.transfer"):
        ask(f"render ph/tubes.nii.gz {small} {context} --transfer {transfer} --no-legend -o "
            f"{{o}}/context.png")
    for option in ("--slices 40", "--camera-up 0,1,1", "--hide 1 --only 1,300",
                   "--labels in/tree.tsv --level 2", "--pathway ph/brain/brain-pathway.nii.gz", "--engine gl",
                   "--range 60,90", "--radius 5", "--aperture square --resolution 40", "--sampling slices"):
        ask(f"render ph/nested.nii.gz {small} {BALL_AIM} --camera-origin 90,-160,70 --camera-toward 0,0,0 "
            f"--no-legend {option} "
            "-o {o}/scene.png")


def legends(ask):
    """Pictures with words in them: those of the legend."""
    brain, small = "ph/brain/brain.atlas.json", "--size 640x360"
    ask(f"render {brain} {small} {BRAIN_AIM} --angle 20 -o {{o}}/legend.png")
    ask(f"render {brain} {small} {BRAIN_AIM} --angle 20 --layers all -o {{o}}/legend.exr")
    ask(f"render ph/tubes.nii.gz {small} {BALL_AIM} --angle 30 --score mrtk -o {{o}}/legend.png")
    ask(f"render ph/nested.nii.gz {small} {BALL_AIM} --angle 30 --pathway ph/brain/brain-pathway.nii.gz -o "
        f"{{o}}/legend.png")
    ask(f"query {brain} {BRAIN_AIM} --angle 20 --resolution 64 --image {{o}}/seen.png -o {{o}}/rows.tsv")


def diffs(ask):
    """What `conus diff` says: words."""
    ask(f"query ph/nested.nii.gz --pose in/ball.tsv -o pair/a.tsv --voxels pair/va.tsv --voxels-of all",
        makes="pair")
    ask(f"query ph/nested.nii.gz --pose in/ball.tsv -o pair/b.csv --aperture square")
    ask(f"query ph/nested.nii.gz {BALL_AIM} --image pair/a.exr -o pair/c.json")
    ask(f"query ph/nested.nii.gz {BALL_AIM} --image pair/b.exr -o pair/d.json --angle 11")
    for a, b in (("a.tsv", "a.tsv"), ("a.tsv", "b.csv"), ("a.exr", "b.exr"), ("a.exr", "a.exr"), ("va.tsv", "va.tsv"),
                 ("a.tsv", "b.csv --tolerance 1e-1")):
        ask(f"diff pair/{a} pair/{b}")


def examples(ask):
    ask("in/samples/u-shape.nii.gz", program="select_one")
    ask("ph/nested.nii.gz", program="select_one")


def samples(ask):
    sample = "in/samples/u-shape.nii.gz"
    for form in ("tsv", "csv", "json", "ndjson", "afni"):
        ask(f"query {sample} --pose in/ball.tsv --layers all --format {form}")
    ask(f"info {sample} --format json")
    ask(f"batch {sample} --poses in/many.tsv -o {{o}}/rows.tsv")
    ask(f"query {sample} {BALL_AIM} --angle 30 --image {{o}}/seen.exr --mask {{o}}/mask.nii.gz -o "
        f"{{o}}/rows.json")


def windows(ask):
    """What a script of the window writes: rows, sessions, the 3-D picture, pictures of the window."""
    for name, atlas in WINDOWS.items():
        ask(f"view {atlas} --script in/{name}.txt --size 600x400 --scale 0.62", makes=name)


# Commands that end with an error.
REFUSED = """
query
query ph/none.nii.gz --origin 0,0,0 --toward 1,1,1
query ph/nested.nii.gz BALL --angle 180
query in/ball.tsv --origin 0,0,0 --toward 1,1,1
query ph/nested.nii.gz BALL --score nothing
query ph/nested.nii.gz BALL --level None
query ph/nested.nii.gz BALL --hide Nothing
query ph/brain/brain-context.nii.gz BALL
batch ph/nested.nii.gz
nothing
diff in/ball.tsv
query ph/nested.nii.gz BALL --max-memory 1K
render ph/nested.nii.gz
track ph/nested.nii.gz
query ph/nested.nii.gz --pose in/tree.tsv --format tsv
merge in/ball.tsv -o {o}/rows.tsv
query ph/nested.nii.gz BALL -o {o}/rows.xyz
sweep ph/nested.nii.gz --pose in/hand.tsv --angles 0
query ph/nested.nii.gz --origin 0,0,0 --toward 0,0,0
info ph
mesh ph/nested.nii.gz

query --help --nonsense
qeury
select
help select
query a.nii --angel 20
query a.nii --orig=1,2,3
query a.nii --zebra all
query a.nii -x
query --origin 1,2,3
info a.nii b.nii
diff a.tsv
info ''
query a.nii --up 1,2,3 20, 20
query a.nii --angle 20 --angle=30
query --help=yes
query a.nii --angle
query a.nii --labels --format tsv
query a.nii --labels=
query a.nii --origin 0,0,90 --toward 0,0,0 --angle 20deg
query a.nii --origin 0,0,90 --toward 0,0,0 --angle nan
query a.nii --origin 0,0,90 --toward 0,0,0 --angle 0x14
query a.nii --origin 0,0,90 --toward 0,0,0 --angle 1,5
query a.nii --origin 0,0,90 --toward 0,0,0 --angle 0
query a.nii --origin 0,0,90 --toward 0,0,0 --angle -5
query a.nii --origin 0,0,90 --toward 0,0,0 --angle=180
query a.nii --origin 1,2
query a.nii --origin=0,inf,0
query a.nii --origin=1e999,0,0
query a.nii --origin 0,0,90 --toward 0,0,0 --resolution 0
query a.nii --origin 0,0,90 --toward 0,0,0 --resolution 99999999999
query a.nii --origin 0,0,90 --toward 0,0,0 --resolution 16.5
query a.nii --origin 0,0,90 --toward 0,0,0 --max-memory 2GB
query a.nii --aperture circel
query a.nii --format xml
query a.nii --space mni
query a.nii --score volume
query a.nii --origin 0,0,90 --toward 0,0,0 --slices 100
query a.nii --origin 0,0,90 --toward 0,0,0 --slices 100 --sampling exact
query a.nii --origin 0,0,90 --toward 0,0,0 --slice-fraction 0.5
query a.nii --origin 0,0,90 --toward 0,0,0 --slice-fraction 0.2 --sampling exact
batch a.nii --poses p.tsv --slice-fraction 1
sweep a.nii --origin 0,0,90 --toward 0,0,0 --angles 5,10 --slice-fraction 1
track a.nii --poses p.tsv --slice-fraction 1
render a.nii -o p.png --origin 0,0,90 --toward 0,0,0 --slice-fraction 1
render a.nii -o p.png --slice-fraction 1
query a.nii --origin 0,0,90 --toward 0,0,0 --sampling slices --slice-fraction=0
query a.nii --origin 0,0,90 --toward 0,0,0 --sampling slices --slice-fraction=-0.2
query a.nii --origin 0,0,90 --toward 0,0,0 --sampling slices --slice-fraction=1.01
query a.nii --origin 0,0,90 --toward 0,0,0 --sampling slices --slice-fraction=40
query a.nii --origin 0,0,90 --toward 0,0,0 --voxels-of all
query a.nii --origin 0,0,90 --toward 0,0,0 --direction 0,0,1
query a.nii --origin 0,0,90 --toward 0,0,0 --pose poses.tsv
query a.nii --up 0,0,1 --pose poses.tsv
query a.nii --toward 0,0,1
query a.nii --origin 0,0,1
query a.nii
"""


def refusals(ask):
    """Words that are refused before or after files are read."""
    for words in filter(None, REFUSED.split("\n")):
        ask(words.replace("BALL", BALL_AIM))


def help_texts(ask):
    """Short and long help, and what a command says that gets nothing, an unknown option or too much."""
    for command in ask.facts["commands"]:
        for words in (f"{command} -h", f"{command} --help", command, f"{command} --nonsense",
                      f"{command} a b c d e f g --nothing"):
            ask(words)
    for words in ("-h", "--help", "--version", "", "nonsense", "help", "help query", "help query --long",
                  "help nonsense", "--nonsense"):
        ask(words)
    for program in ("conus-view", "conus-mesh"):
        for words in ("-h", "--help", "--version", "--nonsense", "nonsense"):
            ask(words, program=program)


def tables(ask):
    """Tables for people, and other words that a command says of what it did."""
    nested, brain, tree = "ph/nested.nii.gz", "ph/brain/brain.atlas.json", "ph/nested.nii.gz --labels in/tree.tsv"
    for command in ("atlases", "atlases --places"):
        ask(command)
    arcs, hand = "--streamlines in/arcs.vtk", "--poses in/hand.tsv"
    for atlas, aim in ((nested, BALL_AIM), (brain, BRAIN_AIM), ("in/outside.atlas.json", BALL_AIM), (tree, BALL_AIM),
                       (f"{nested} {arcs}", BALL_AIM), ("ph/slabs.nii.gz --hemispheres split", BALL_AIM)):
        ask(f"query {atlas} {aim} --angle 30")
        ask(f"query {atlas} {aim} --angle 30 --layers all")
        ask(f"query {atlas} --point 4,-14,3 --radius 6")
        ask(f"query {atlas} --point 4,-14,3")
        ask(f"query {atlas} {aim} --range 0,150 --segments -")
        ask(f"query {atlas} {aim} --range 0,150 --clearance - --radius 1")
        ask(f"sweep {atlas} {aim} --angle 40")
        ask(f"sweep {atlas} {aim} --angles 5:25:5")
        ask(f"sweep {atlas} {aim} --angle 5 --jitter 3,2 --samples 64")
        ask(f"info {atlas}")
        ask(f"info {atlas} --format tree")
    for pose in ("in/quaternion.tsv", "in/bad.tsv", "in/lines.mrk.json", "in/plain_electrodes.tsv --radius 2"):
        ask(f"query {nested} --pose {pose} --any-space")
        ask(f"sweep {nested} --pose {pose} --any-space --angle 20")
    for options in ("--radius 5 --layers all", "--angle 12 --range 60,90 --score mrtk", "--angle 30 --space lps"):
        ask(f"query {nested} {BALL_AIM} {options}")
    for atlas in (nested, tree, f"{nested} {arcs}"):
        ask(f"query {atlas} {BALL_AIM} --angle 30 --voxels - --voxels-of all")
        ask(f"query {atlas} --atlas ph/slabs.nii.gz {BALL_AIM} --angle 30")
        ask(f"track {atlas} {hand} --score intenselect")
        ask(f"track {atlas} {hand} --selected")
        ask(f"batch {atlas} --poses in/bad.tsv --summary -o {{o}}/rows.tsv -v")
        ask(f"connect {atlas}")
        for roi in ("ph/u-shape.nii.gz", "ph/u-shape.nii.gz --threshold 1",
                    "ph/brain/brain-pathway.nii.gz --threshold 30000", "ph/sphere.nii.gz --threshold 1 --level 1"):
            ask(f"overlap {atlas} {roi}")
    plan = f"plan {tree} --poses in/needles.tsv --reach Core"
    for options in ("", "--avoid 1,margin=1", "--radius 1 --avoid 300,margin=30 --infeasible", "--tolerance -",
                    "--jitter 2,1 --samples 64", "--constraints -", "--avoid 1 --profile -",
                    "--reach 300,length=4 --rank -depth --top 3"):
        ask(f"{plan} {options}")
    ask(f"plan {tree} --from in/cube.obj,spacing=3 --toward centroid --reach 300 --depth target")
    ask(f"query {nested} {arcs} {BALL_AIM} --angle 60 --endpoints -")
    ask(f"query {nested} --probe in/probe.json --origin 0,-20,0 --direction 0,1,0.1")
    ask(f"query {nested} --probe in/probe.json --pose in/needles.tsv --layers all")
    # what is said of a result
    ask(f"query {nested} --pose in/ball.tsv -o told/rows.tsv", makes="told")
    ask(f"query {nested} --pose in/ball.tsv -o told/rows.tsv")
    ask(f"query {nested} --pose in/ball.tsv -o told/rows.tsv --force -v")
    ask(f"query {nested} --pose in/ball.tsv --aperture square -o told/square.tsv")
    for command in ("verify", "cite", "cite --format bibtex"):
        for rows in ("told/rows.tsv", "told/square.tsv", "in/ball.tsv"):
            ask(f"{command} {rows}")
    ask("verify told/rows.tsv --sidecar told/square.json")
    ask("report told/rows.tsv -o {o}/report")
    ask("cite ph/nested.nii.gz")
    ask("diff told/rows.tsv told/square.tsv")
    ask("page ph/nested.nii.gz -o {o}/page.html")


# How commands read a file of a corpus of tests/fuzz: its name, where its own will not do, and the commands. {f} is the
# file, {d} its folder, {t} what it says.
LABELS, VOLUME, LINES = "info ph/nested.nii.gz --labels {f}", "info {f}", "connect ph/nested.nii.gz --streamlines {f}"
SURFACE, SURFACE_LABELS = "info {f}", "info in/five.surf.gii --labels {f}"
POSES = "batch ph/nested.nii.gz --any-space --radius 2 -o {o}/rows.tsv --poses {f}"
MOVE = f"query ph/nested.nii.gz {BALL_AIM} --atlas-transform {{f}}"
READERS = {
    "afni": ("x+orig.HEAD", VOLUME),
    "annot": ("lh.x.annot", SURFACE_LABELS),
    "batch_record": ("rows.json", "verify {d}/rows.tsv"),
    "brainglobe_atlas": ("atlases/x/1_0/manifest.json", "info {d}/atlases/x/1_0", "info {f}"),
    "brainglobe_metadata": ("metadata.json", "info {d}", "info {f}"),
    "cifti": ("x.dlabel.nii", VOLUME),
    "coordsystem": ("sub-01_coordsystem.json", "batch ph/nested.nii.gz --radius 2 --poses {d}/sub-01_electrodes.tsv"),
    "deformation": ("x.nii", MOVE),
    "exr": (None, "diff {f} {f}"),
    "file_kind": (None, VOLUME, POSES),
    **{f"foreign_{name}": (None, SURFACE) for name in ("mz3", "obj", "off", "ply", "stl", "vtk")},
    "foreign_vtp": ("x.vtp", SURFACE),
    "formula": (None, f"query ph/nested.nii.gz {BALL_AIM} --score {{t}}"),
    "freesurfer": ("lh.white", SURFACE),
    "gifti": ("x.surf.gii", SURFACE, SURFACE_LABELS),
    "labels": (None, LABELS),
    "labels_xml": (None, LABELS, "info {f}"),
    "level": (None, f"query ph/nested.nii.gz --labels in/tree.tsv {BALL_AIM} --level {{t}}"),
    "manifest": (None, "info {f}"),
    "matlab": ("x.mat", POSES),
    "matrix": (None, POSES),
    "metaimage": ("x.mha", VOLUME),
    "mgh": ("x.mgz", VOLUME),
    "nifti": ("x.nii", VOLUME),
    "nrrd": ("x.nrrd", VOLUME),
    "png": (None, "diff {f} {f}"),
    "poses": (None, POSES),
    "probe_interface": (None, "query ph/nested.nii.gz --probe {f} --origin 0,-20,0 --direction 0,1,0.1"),
    "results": (None, "diff {f} {f}", "diff in/ball.tsv {f}"),
    "sidecar": ("rows.json", "verify {d}/rows.tsv", "cite {d}/rows.tsv"),
    "table": (None, POSES),
    "tiff": ("x.tif", VOLUME),
    "tract": (None, LINES),
    "transfer": (None, "render ph/nested.nii.gz --size 64x48 --context ph/brain/brain-context.nii.gz --transfer {f} "
                       "-o {o}/x.png"),
    "transform": (None, MOVE),
    "trx": ("x.trx", LINES),
    "vtk_lines": ("x.vtk", LINES),
    "weight": (None, f"query ph/nested.nii.gz {BALL_AIM} --weight {{f}}"),
    "words_place": (None, "query ph/nested.nii.gz --point {t} --radius 5"),
    "zarr": ("x.zarr/.zarray", "info {d}/x.zarr"),
    "zip": ("x.trx", LINES),
}
# Corpora that no command reads as a file: of the window, which needs a display; streams of conus-hdf5, conus-mesh and
# the network; damage to packed atlases; pieces of files.
UNREAD = ("place", "recent", "script", "session", "thumbnail", "hdf5_stream", "minc", "nwb", "simnibs", "transform_chain",
          "mesh_request", "mesh_stream", "igtl", "atlas_pack", "pack", "gzip", "text", "keys")
# Files beside that which is asked about.
BESIDE = {"batch_record": "rows.tsv", "sidecar": "rows.tsv", "coordsystem": "sub-01_electrodes.tsv"}


def corpora(tests):
    """{corpus: [(file, path below in/)]}, of tests/fuzz/corpus; each file has a folder of its own."""
    found = {}
    for folder in sorted((tests / "fuzz/corpus").iterdir()):
        if folder.name not in UNREAD:
            name = READERS[folder.name][0]
            found[folder.name] = [(file, f"fuzz/{folder.name}/{file.name}/{name or file.name}")
                                  for file in sorted(folder.iterdir())]
    return found


def files_of_fuzzers(ask):
    """Each file that the fuzzers begin with, asked about as whoever has it would."""
    for corpus, files in ask.facts["corpora"].items():
        for source, target in files:
            folder = f"in/fuzz/{corpus}/{source.name}"
            beside = [("in/plain_electrodes.tsv", f"{folder}/{BESIDE[corpus]}")] if corpus in BESIDE else []
            for words in READERS[corpus][1:]:
                words = words.replace("{f}", f"in/{target}").replace("{d}", folder)
                if "{t}" in words:
                    text = source.read_bytes().decode("utf-8", "replace").replace("\0", "")
                    words = words.replace("{t}", shlex.quote(text))
                ask(words, before=beside)


def files_of_corpus(ask):
    """Each file of tests/corpus, asked about as its facts.json says, in a folder of its own with what is named there."""
    for file in ask.facts["facts"]:
        form, rows = file.parent, json.loads(file.read_text(encoding="utf-8"))
        for name, row in ((name, row) for name, some in rows.items()
                          for row in (some if isinstance(some, list) else [some])):
            row = {**rows.get(row.get("like"), {}), **row}
            words = [word.replace("{}", name) for word in row.get("with", ())]
            words = words if any(name in word for word in words) else [name, *words]
            beside = {place.split("/")[0] for word in words for place in (word, word.split(",")[0])}
            within = f"in/corpus/{form.name}/{name.replace('/', '_')}"
            ask(f"info {shlex.join(words)} --format json", within=within,
                before=[(form / top, f"{within}/{top}") for top in sorted(beside) if (form / top).exists()])


def python(ask):
    """What a script of a user gets: tables, and errors."""
    ask("query ph/nested.nii.gz --pose in/ball.tsv -o python/rows.tsv", makes="python")
    ask("in/calls.py", program="python")


# data that may be absent
def labelled(ask, atlas, table, aim):
    """What is asked of every atlas."""
    ask(f"info {atlas} --format json")
    ask(f"info {atlas} --format tree")
    ask(f"query {atlas} --pose {table} -o {{o}}/rows.tsv")
    ask(f"query {atlas} --pose {table} --layers all --format ndjson")
    ask(f"batch {atlas} --poses {table} --threads 2 --layers all -o {{o}}/rows.csv")
    ask(f"query {atlas} {aim} --angle 20 --layers all --image {{o}}/seen.exr -o {{o}}/rows.json")
    ask(f"sweep {atlas} {aim} --angle 60 --format tsv")


def templates(ask):
    for name in ("aal", "brodmann", "natbrainlab", "AICHAmc", "HarvardOxford-cort-maxprob-thr0-1mm", "jhu189",
                 "JHU-WhiteMatter-labels-1mm", "JHU-WhiteMatter-labels-2mm", "inia19-NeuroMaps"):
        labelled(ask, f"{TEMPLATES}/{name}.nii.gz", "in/brain.tsv", AIM)
    aal = f"{TEMPLATES}/aal.nii.gz"
    for how in ("split", "merged"):
        for name in ("aal", "brodmann"):
            ask(f"query {TEMPLATES}/{name}.nii.gz --pose in/brain.tsv --hemispheres {how} --layers all -o "
                f"{{o}}/rows.tsv")
    for options in ("--sampling slices", "--aperture square --resolution 32", "--engine gl",
                    "--engine gl --layers all",
                    "--context in/templates/ch2.nii.gz --context-blocks 100", "--radius 3 --layers all"):
        ask(f"query {aal} --pose in/brain.tsv {options} -o {{o}}/rows.tsv")
    ask(f"batch {aal} --poses in/many.tsv --engine gl -o {{o}}/rows.tsv")
    ask(f"query {aal} {AIM} --angle 30 --mask {{o}}/x_dseg.nii.gz --voxels {{o}}/voxels.tsv --voxels-of all "
        f"-o {{o}}/rows.tsv")
    ask(f"query {aal} {AIM} --angle 30 --image {{o}}/seen.png --format tsv")
    ask(f"sweep {aal} {AIM} --angle 10 --jitter 2,1.5 -o {{o}}/rows.tsv")
    ask(f"track {aal} --poses in/hand.tsv --score intenselect -o {{o}}/rows.tsv")
    ask(f"mesh {aal} -o {{o}}/meshes")
    ask(f"render {aal} --context {TEMPLATES}/ch2bet.nii.gz {AIM} --angle 20 --size 320x240 --no-legend -o "
        f"{{o}}/scene.png")
    for name in ("ch2", "ch2bet", "ch2better", "inia19-t1-brain"):
        ask(f"info {TEMPLATES}/{name}.nii.gz --labels-anyway --format tsv")
        ask(f"info {TEMPLATES}/{name}.nii.gz")


def shared_volumes(ask):
    for name in ("julich31/JulichBrainAtlas31_LH", "julich31/JulichBrainAtlas31_RH",
                 "bigbrain-subcort/bigbrain"):
        labelled(ask, f"{SHARED}/labelvol/{name}.nii.gz", "in/brain.tsv", AIM)
    atlases = f"{SHARED}/prob/fsl/atlases"
    labelled(ask, f"{atlases}/JHU-labels.xml", "in/brain.tsv", AIM)
    ask(f"info {atlases}/JHU-tracts.xml --format json")
    ask(f"query {atlases}/Thalamus/Thalamus-maxprob-thr25-2mm.nii.gz --pose in/brain.tsv --layers all -o "
        f"{{o}}/rows.tsv")
    ask(f"query {atlases}/JHU/JHU-ICBM-tracts-maxprob-thr25-1mm.nii.gz --pose in/brain.tsv -o {{o}}/rows.tsv")
    for volume in (0, 7):
        ask(f"query {atlases}/JHU-labels.xml --pathway "
            f"{atlases}/JHU/JHU-ICBM-tracts-prob-2mm.nii.gz,volume={volume} "
            "--pose in/brain.tsv --layers all -o {o}/rows.json")
    ask(f"manifest fsl", before=[(f"{atlases}/{name}", f"fsl/{name}") for name in (
        "JHU-tracts.xml", "JHU/JHU-ICBM-tracts-prob-2mm.nii.gz")])
    ask(f"query fsl/fsl.atlas.json --pose in/brain.tsv --layers all -o {{o}}/rows.tsv")
    fibres = f"{SHARED}/prob/juelich-fibre-pathways-u16"
    paths = " ".join(f"--pathway {fibres}/{name}" for name in (
        "Fornix.nii.gz", "Callosal_body.nii.gz", "Cingulum_L.nii.gz,threshold=20000"))
    left = f"{SHARED}/labelvol/julich31/JulichBrainAtlas31_LH.nii.gz"
    for options in ("", "--layers all", "--engine gl", "--sampling slices"):
        ask(f"query {left} {paths} --pose in/brain.tsv {options} -o {{o}}/rows.tsv")
    ask(f"query {left} {paths} {AIM} --angle 40 --mask {{o}}/f_probseg.nii.gz --mask-object Fornix --layers "
        f"all "
        "--voxels {o}/voxels.tsv -o {o}/rows.json")
    for table in ("fsleyes-lut/harvard-oxford-cortical.lut", "itksnap/MRIcrop-seg.label",
                  "freesurfer/FreeSurferColorLUT.txt",
                  "bids/tpl-MNI152NLin6Asym_atlas-HOCPAL_dseg.tsv", "brainglobe/ccf25.structures.json",
                  "bids/tpl-MNI152NLin2009cAsym_atlas-4S_scale-156_res-01_dseg.tsv"):
        ask(f"info {left} --labels {SHARED}/labels/{table} --format json")
    bonsai = f"{SHARED}/bonsai/bonsai.nii.gz"
    ask(f"query ph/nested.nii.gz --pathway {bonsai},threshold=60 --pose in/bonsai.tsv --layers all -o "
        f"{{o}}/rows.tsv")
    ask(f"query {bonsai} --labels-anyway --pose in/bonsai.tsv -o {{o}}/rows.tsv")
    ask(f"query ph/nested.nii.gz --pathway {bonsai},threshold=60 --pose in/bonsai.tsv --sampling slices "
        f"--engine gl "
        "-o {o}/rows.tsv")


def shared_surfaces(ask):
    allen, left = f"{SHARED}/meshes/brainglobe-allen-ccf2017-subset", f"{SHARED}/meshes/julich31-areas/lh"
    labelled(ask, allen, "in/ccf.tsv", "--origin=6,-4,6 --toward 6,-4,-6")
    ask(f"query {allen} --pose in/ccf.tsv --level 4 --layers all -o {{o}}/rows.tsv")
    ask(f"query {allen} --pose in/ccf.tsv --only Isocortex,TH --format tsv")
    labelled(ask, left, "in/brain.tsv", AIM)
    ask(f"query {left} --pose in/brain.tsv --engine gl -o {{o}}/rows.tsv")
    ask(f"batch {left} --poses in/many.tsv -o {{o}}/rows.tsv")
    fs5 = f"{SHARED}/meshes/fsaverage5"
    for surface in ("pial", "white", "infl"):
        for side in ("left", "right"):
            labels = f"--labels {fs5}/{side[0]}h.aparc.annot"
            ask(f"info {fs5}/{surface}_{side}.gii.gz {labels} --format tsv")
            ask(f"query {fs5}/{surface}_{side}.gii.gz {labels} --pose in/brain.tsv --layers all -o "
                f"{{o}}/rows.tsv")
            ask(f"query {fs5}/{surface}_{side}.gii.gz --pose in/brain.tsv -o {{o}}/rows.json")
    ask(f"query {fs5}/pial_left.gii.gz --labels {fs5}/lh.aparc.annot {AIM} --angle 40 --image {{o}}/seen.exr "
        f"--layers all -o {{o}}/rows.tsv")


def shared_foreign(ask):
    """Mesh files of other programs."""
    for name in ("allen-root/root_997.ply", "aseg-ply/aseg_017.ply", "format-zoo/cube.stl",
                 "format-zoo/cube_bin.stl",
                 "format-zoo/cube.ply", "format-zoo/cube.vtk", "format-zoo/cube.gii",
                 "format-zoo/lh.tinysurface.gii", "aseg-ply"):
        ask(f"info {SHARED}/meshes/{name} --format json")
        ask(f"query {SHARED}/meshes/{name} {BALL_AIM} --angle 60 --layers all --format tsv")
    ask("manifest aseg", before=[(f"{SHARED}/meshes/aseg-ply/aseg_0{n}.ply",
                                  f"aseg/aseg_0{n}.ply") for n in (10, 17, 53)])
    ask(f"query aseg/aseg.atlas.json {BALL_AIM} --angle 60 -o {{o}}/rows.tsv")


def shared_hostile(ask):
    """Files that break readers: an exit code, and for some an answer."""
    for file in ask.facts["hostile"]:
        ask(f"info '{file}' --format json")
        ask(f"query '{file}' --origin 0,0,200 --toward 0,0,0 --format tsv")


GROUPS = {
    "phantoms": phantoms, "answers": answers, "looks": looks, "areas": areas, "poses": poses,
    "other-programs": other_programs, "pictures-of-answers": pictures_of_answers, "gl": gl,
    "batches": batches, "sweeps": sweeps, "tracks": tracks, "manifests": manifests, "meshes": meshes,
    "renders": renders, "legends": legends, "diffs": diffs, "examples": examples, "samples": samples,
    "windows": windows, "refusals": refusals, "help": help_texts, "tables": tables,
    "files-of-fuzzers": files_of_fuzzers, "files-of-corpus": files_of_corpus, "python": python,
    "templates": templates, "shared-volumes": shared_volumes, "shared-surfaces": shared_surfaces,
    "shared-foreign": shared_foreign, "shared-hostile": shared_hostile,
}
# Groups of which tests/equal/expected says what is expected.
RECORDED = ("help", "tables")
