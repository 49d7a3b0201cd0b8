#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Names, numbers and colours of real label tables against a few lines of Python each.

Every table is read by `conus info`: those of mricron through their volumes, the others with --labels on one of them.
The parsers here know their one file each and guess nothing, where conus tells the formats apart by content. Python's
own writers also write AAL's names in further formats, which conus must find beside copies of its volume, or refuse.

usage: compare_labels.py CONUS [TEMPLATE_FOLDER] [SHARED_FOLDER]; exit 77 = skipped."""

import csv
import gzip
import io
import json
import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

CONUS = sys.argv[1]
TEMPLATES = sys.argv[2] if len(sys.argv) > 2 else "/usr/share/mricron/templates"
HERE = os.path.dirname(os.path.abspath(__file__))
SHARED = sys.argv[3] if len(sys.argv) > 3 else os.environ.get(
    "CONUS_SHARED_DATA", os.path.join(HERE, "../../../shared/data"))


def areas(atlas, labels=None):
    command = [CONUS, "info", atlas, "--format", "tsv"] + (["--labels", labels] if labels else [])
    text = subprocess.run(command, check=True, capture_output=True, encoding="utf-8").stdout
    rows = csv.DictReader(io.StringIO(text), delimiter="\t", quoting=csv.QUOTE_NONE)
    return {int(row["index"]): (row["name"], row["color"]) for row in rows if row["kind"] == "area"}


def text_of(path, encoding="utf-8"):
    with open(path, "rb") as file:
        return file.read().decode(encoding)


def numbered(text, name_of):
    found = {}
    for line in re.split(r"[\r\n]+", text):
        if line.strip():
            number, name = re.match(r"\s*(\d+)\s+(.*)", line).groups()
            found.setdefault(int(number), name_of(name.strip()))
    return found


def embedded(path):
    with gzip.open(path) as file:
        head = file.read(352)
        offset = int(struct.unpack("<f", head[108:112])[0])
        return file.read(offset - 352).decode("ascii").strip(" \0")


def lut(path):
    data = open(path, "rb").read()
    colors = {k: "#%02x%02x%02x" % (data[k], data[256 + k], data[512 + k]) for k in range(256)}
    return {k: None if color == "#000000" else color for k, color in colors.items()}  # black: an unused entry


def hexadecimal(r, g, b):
    return "#%02x%02x%02x" % (int(r), int(g), int(b))


def freesurfer(text):
    rows = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return {int(r[0]): (r[1], hexadecimal(*r[2:5])) for r in reversed(rows)}


def itk_snap(text):
    rows = re.findall(r'^\s*(\d+)\s+(\d+)\s+(\d+)\s+(\d+)\s.*"(.*)"\s*$', text, re.M)
    return {int(r[0]): (r[4], hexadecimal(*r[1:4])) for r in rows}


def fsleyes(text):
    rows = [line.split(None, 4) for line in text.splitlines() if line.strip()]
    return {int(r[0]): (r[4].strip(), "#%02x%02x%02x" % tuple(int(float(c) * 255 + 0.5) for c in r[1:4])) for r in rows}


def bids(text):
    rows = csv.DictReader(io.StringIO(text), delimiter="\t")
    return {int(row["index"]): (row["name"], None) for row in rows}


def brainglobe(text):
    return {s["id"]: (s["name"], hexadecimal(*s["rgb_triplet"])) for s in json.loads(text)}


def niivue(text):
    lists = json.loads(text)
    return {i: (name, hexadecimal(lists["R"][i], lists["G"][i], lists["B"][i]))
            for i, name in enumerate(lists["labels"]) if name}


def fsl(text, first):
    root = ElementTree.fromstring(text)
    return {int(e.get("index")) + first: (e.text.strip(), None) for e in root.iter("label")}


def compare(what, got, wanted):
    wanted = {number: row for number, row in wanted.items() if number}
    for number, (name, color) in sorted(wanted.items()):
        row = got.get(number)
        if row is None or row[0] != name or (color and row[1] != color):
            sys.exit(f"{what}: label {number} is {row}, wanted {(name, color)}")
    extra = {n: row for n, row in got.items() if n not in wanted and row[0] != str(n)}
    if extra:
        sys.exit(f"{what}: names of nowhere: {extra}")
    print(f"{what}: {len(wanted)} labels equal")


def compare_templates():
    code = lambda name: re.sub(r" \d+$", "", name)
    for name in ["aal", "AICHAmc", "JHU-WhiteMatter-labels-1mm", "JHU-WhiteMatter-labels-2mm"]:
        stem = os.path.join(TEMPLATES, name + ".nii")
        colors = lut(stem + ".lut")
        wanted = {n: (label, colors[n]) for n, label in numbered(text_of(stem + ".txt"), code).items()}
        compare(name, areas(stem + ".gz"), wanted)
    for name in ["HarvardOxford-cort-maxprob-thr0-1mm", "inia19-NeuroMaps", "jhu189", "natbrainlab"]:
        path = os.path.join(TEMPLATES, name + ".nii.gz")
        compare(name, areas(path), {n: (label, None) for n, label in numbered(embedded(path), str).items()})


def compare_shared():
    carrier = os.path.join(TEMPLATES, "brodmann.nii.gz")
    for path, parse in [
        ("labels/freesurfer/FreeSurferColorLUT.txt", freesurfer),
        ("labels/itksnap/MRIcrop-seg.label", itk_snap),
        ("labels/fsleyes-lut/harvard-oxford-cortical.lut", fsleyes),
        ("labels/bids/tpl-MNI152NLin2009cAsym_atlas-4S_scale-156_res-01_dseg.tsv", bids),
        ("labels/bids/tpl-MNI152NLin6Asym_atlas-HOCPAL_dseg.tsv", bids),
        ("labels/brainglobe/ccf25.structures.json", brainglobe),
        ("labelvol/bigbrain-subcort/bigbrain.json", niivue),
        ("labelvol/julich31/Julich.json", niivue),
        ("prob/fsl/atlases/JHU-labels.xml", lambda text: fsl(text, 0)),
        ("prob/fsl/atlases/JHU-tracts.xml", lambda text: fsl(text, 1)),
        ("prob/fsl/atlases/Thalamus.xml", lambda text: fsl(text, 1)),
    ]:
        full = os.path.join(SHARED, path)
        if os.path.exists(full):
            compare(path, areas(carrier, full), parse(text_of(full)))
        else:
            print(f"left out: no {full}")
    for path in ["labelvol/bigbrain-subcort/bigbrain.nii.gz", "labelvol/julich31/JulichBrainAtlas31_LH.nii.gz"]:
        full = os.path.join(SHARED, path)
        if os.path.exists(full):
            compare(path, areas(full), {n: (label, None) for n, label in numbered(embedded(full), str).items()})


def as_csv(names, header, separator):
    out = io.StringIO()
    rows = csv.writer(out, delimiter=separator)
    rows.writerows(([header] if header else []) + [[number, name] for number, name in names.items()])
    return out.getvalue()


def as_spm(names):
    root = ElementTree.Element("atlas", version="2.0")
    data = ElementTree.SubElement(root, "data")
    for number, name in names.items():
        label = ElementTree.SubElement(data, "label")
        ElementTree.SubElement(label, "index").text = str(number)
        ElementTree.SubElement(label, "name").text = name
    return ElementTree.tostring(root, encoding="unicode")


def compare_written():
    names = numbered(text_of(os.path.join(TEMPLATES, "aal.nii.txt")), lambda name: re.sub(r" \d+$", "", name))
    volume = "atlas_AAL.nii.gz"
    shifted = {number - 1: name for number, name in names.items()}
    few = {number: name for number, name in names.items() if number < 100}
    found = [
        ("labels_AAL.csv", as_csv(names, None, ",")),
        ("AAL.csv", as_csv(names, None, ";")),
        ("aal-names.tsv", as_csv(names, ["value", "label"], "\t")),
        ("labels.csv", as_csv(names, ["ROIid", "ROIname"], ";")),
        ("lut_AAL.json", json.dumps({str(number): name for number, name in names.items()}, indent=1)),
        ("AAL_list.json", json.dumps([{"label": number, "name": name} for number, name in names.items()])),
        ("atlas_AAL.xml", as_spm(names)),
    ]
    refused = [
        ("labels_AAL.csv", as_csv(shifted, None, ",")),
        ("labels_AAL.json", json.dumps({str(number): name for number, name in few.items()})),
        ("labels_AICHA.csv", as_csv(names, None, ",")),
        ("results_AAL.csv", as_csv(names, None, ",")),
    ]
    for tables, wanted in [(found, names), (refused, {})]:
        for name, text in tables:
            with tempfile.TemporaryDirectory() as folder:
                shutil.copy(os.path.join(TEMPLATES, "aal.nii.gz"), os.path.join(folder, volume))
                with open(os.path.join(folder, name), "w", encoding="utf-8", newline="") as file:
                    file.write(text)
                got = areas(os.path.join(folder, volume))
                compare(f"{name} {'beside' if wanted else 'refused beside'} {volume}", got,
                        {number: (label, None) for number, label in wanted.items()})


if not os.path.exists(os.path.join(TEMPLATES, "brodmann.nii.gz")):
    print(f"skipped: no mricron-data in {TEMPLATES}")
    sys.exit(77)
compare_templates()
compare_shared()
compare_written()
