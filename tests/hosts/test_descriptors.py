# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/descriptors writes, taken by bosh and by 3D Slicer's own parser and logic. scripts/hosts python runs it."""
import json
import os
import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONUS = os.environ["CONUS"]
TEMPLATES = pathlib.Path(os.environ.get("CONUS_TEMPLATES", "/usr/share/mricron/templates"))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("share")
    subprocess.run([ROOT / "scripts" / "descriptors", folder], check=True)
    return folder


def test_boutiques(made, tmp_path):
    bosh = pytest.importorskip("boutiques").bosh
    files = sorted((made / "boutiques").glob("*.json"))
    assert len(files) >= 18
    for file in files:
        bosh(["validate", str(file)])
    subprocess.run([CONUS, "phantom", "nested", "-o", tmp_path, "--size", "24"], check=True)
    asked = {"atlas": str(tmp_path / "nested.nii.gz"), "origin": "0,0,90.5", "toward": "0,0,0", "angle": 20, "quiet": True,
             "hide": ["Core"], "output": "rows.tsv"}
    (tmp_path / "asked.json").write_text(json.dumps(asked))
    simulated = bosh(["exec", "simulate", str(made / "boutiques" / "conus-query.json"), "-i", str(tmp_path / "asked.json")])
    line = next(line for line in str(simulated).splitlines() if line.startswith("conus query"))
    done = subprocess.run([CONUS, *line.split()[1:]], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    plain = subprocess.run([CONUS, "query", "nested.nii.gz", *"--origin 0,0,90.5 --toward 0,0,0 --angle 20 -q --hide Core --format tsv".split()],
                           cwd=tmp_path, capture_output=True, text=True, check=True)
    assert (tmp_path / "rows.tsv").read_text() == plain.stdout


def test_slicer(made):
    pytest.importorskip("slicer_core")
    atlas, labels = TEMPLATES / "aal.nii.gz", TEMPLATES / "aal.nii.txt"
    if not atlas.exists():
        pytest.skip("no mricron-data")
    said = subprocess.run([sys.executable, pathlib.Path(__file__).with_name("in_slicer.py"), made / "slicer", atlas, labels],
                          capture_output=True, text=True)
    assert said.returncode == 0, said.stderr[-2000:]
    answer = json.loads(said.stdout.splitlines()[-1])
    plain = subprocess.run([CONUS, "query", atlas, *"--origin -90,20,20 --toward 0,-10,10 --angle 20 --format tsv -q".split()],
                           capture_output=True, text=True, check=True).stdout
    keep = ("name", "index", "pixels", "share", "distance_mm", "contact_x")

    def columns(text):
        head, *rows = (line.split("\t") for line in text.splitlines())
        return [[row[head.index(name)].replace("_", " ") for name in keep] for row in rows]  # as Slicer's colour table has it

    assert columns(answer["rows"]) == columns(plain) and len(columns(plain)) >= 2
