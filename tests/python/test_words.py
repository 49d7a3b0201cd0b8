# SPDX-License-Identifier: BSD-3-Clause
"""Messages and notes name the arguments of Python, not the options of the programs."""
import json
import logging
import pathlib
import re

import nibabel
import numpy as np
import pytest

import conus
from conus._library import python_words
from support import AFFINE, call_conus, plates

ROOT = pathlib.Path(__file__).parents[2]
FOLDERS = ("atlas", "base", "loaders", "pack", "poses", "render", "selection", "sources")


def library_words():
    """All that looks like an option in a string of the library."""
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*.c"):
            for string in re.findall(r'"((?:[^"\\\n]|\\.)*)"', path.read_text(encoding="utf-8")):
                yield from re.findall(r"(?<![\w-])--[a-z][a-z-]*", string)


def test_every_option_in_a_message_is_an_argument_here():
    """Words such as --ref are of other programs, which messages name, too; --from is flirt's, not that of conus plan, --out is
    convertwarp's, not that of conus positions."""
    commands = json.loads(call_conus("help", "--json").stdout)["commands"]
    ours = {f"--{row['name']}" for command in commands for row in command["options"] if command["name"] != "plan"}
    words = {*library_words()} & ours - {"--out"}
    assert len(words) > 8 and len(ours) > 60
    assert not [word for word in words if python_words(word) == word], "an argument, or _RENAMED of python/conus/_library.py"


@pytest.mark.parametrize(
    "line, wanted",
    [
        ("--context draws it, --labels-anyway takes it", "context= draws it, labels_anyway= takes it"),
        ("--probability: is 3, allowed is 0 to 1", "probability: is 3, allowed is 0 to 1"),
        ("8 bytes, allowed are 4 (--max-memory)", "8 bytes, allowed are 4 (max_memory=)"),
        ("give it as ATLAS, --pathway or --context", "give it as source, pathways= or context="),
        ("(--pathway FILE,name=NAME)", "(pathways=[(map, {name: (low, high)})])"),
        ("'invwarp --ref=IMAGE --warp=FILE'", "'invwarp --ref=IMAGE --warp=FILE'"),
        ("/data/--context/a.nii: cannot open", "/data/--context/a.nii: cannot open"),
        ("/data/as ATLAS/a.nii: cannot open", "/data/as ATLAS/a.nii: cannot open"),
        ("x--labels y --labels-of", "x--labels y --labels-of"),
    ],
)
def test_options_become_arguments(line, wanted):
    assert python_words(line) == wanted


def test_messages_and_notes_have_arguments(caplog, tmp_path):
    caplog.set_level(logging.INFO, "conus")
    grey = np.random.default_rng(1).normal(size=(30, 30, 30)).astype("f4")
    nibabel.save(nibabel.Nifti1Image(grey, AFFINE), tmp_path / "t1.nii")
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "a.nii")
    (tmp_path / "surface.ply").write_text("ply\n")
    for call in (
        lambda: conus.load(grey, AFFINE),
        lambda: conus.load(tmp_path / "t1.nii"),
        lambda: conus.load(tmp_path / "a.nii", max_memory=10),
        lambda: conus.load(tmp_path / "a.nii", probability=0.5),
        lambda: conus.load(tmp_path / "a.nii", probability=2),
        lambda: conus.load(tmp_path / "a.nii", labels=tmp_path / "surface.ply"),
        lambda: conus.load(tmp_path / "a.nii", pathways=[tmp_path / "surface.ply"]),
    ):
        with pytest.raises(conus.Error) as caught:
            call()
        said = str(caught.value)
        assert not re.search(r"--[a-z]|\bATLAS\b", said), said
        assert re.search(r"\b(context|max_memory|probability|labels|source)\b", said), said
    for record in caplog.records:
        assert "--" not in record.getMessage()
