# SPDX-License-Identifier: BSD-3-Clause
"""conus.verify, conus.cite and conus.page say what the program says."""
import functools
import json
import os
import signal
import subprocess

import nibabel
import pytest

import conus
from support import AFFINE, call_conus, plates


@pytest.fixture(name="rows")
def make_rows(tmp_path, monkeypatch):
    """A result of the program, rows.tsv, in the current folder."""
    monkeypatch.chdir(tmp_path)
    nibabel.Nifti1Image(plates(), AFFINE).to_filename("plates.nii.gz")
    call_conus("query", "plates.nii.gz", "--origin=-60,19,19", "--toward=19,19,19", "-q", "-o", "rows.tsv")
    return tmp_path / "rows.tsv"


def test_identical(rows):
    found = conus.verify(rows)
    assert found and found.same_rows
    assert (found.verdict, found.why, found.differences, found.lines_that_differ) == ("identical", [], [], 0)
    assert [(file.path, file.state) for file in found.files] == [("plates.nii.gz", "same")]
    assert json.loads(call_conus("verify", "rows.tsv", "--format", "json").stdout)["verdict"] == "identical"


def test_different(rows):
    text = rows.read_bytes()
    assert text.count(b"\t3228\t") == 1
    rows.write_bytes(text.replace(b"\t3228\t", b"\t3227\t"))
    found = conus.verify("rows.tsv")
    assert not found and found.verdict == "different"
    (difference,) = found.differences
    assert difference.line == 2 and difference.where.endswith(": pixels")
    assert (difference.recorded, difference.again) == ("3227", "3228")
    assert "was changed after conus wrote it" in found.why[0]


def test_moved_and_missing(rows, tmp_path):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (tmp_path / "plates.nii.gz").rename(folder / "other.nii.gz")
    found = conus.verify(rows)
    assert (found.verdict, found.files[0].state, found.files[0].found) == ("not verified", "missing", None)
    found = conus.verify(rows, folder=folder)
    assert found and found.files[0].state == "moved"
    assert found.files[0].found == (folder / "other.nii.gz").resolve().as_posix()


def test_page(rows):
    """The rows of the program and the bytes of the atlas are in the page."""
    import base64
    import re

    (rows.parent / "template.html").write_text("<!-- atlas -->\n<p>")
    where = {"origin": (-60, 19, 19), "toward": [19, 19, 19.5]}
    assert conus.page("plates.nii.gz", "page.html", **where, angle=10, template="template.html") == "page.html"
    page = (rows.parent / "page.html").read_text()
    asked = json.loads(re.search(r'id="question">(.*)</script>', page)[1])
    words = ("--origin=-60,19,19", "--toward=19,19,19.5", "--angle=10", "--format=ndjson", "-q")
    assert asked["rows"] == call_conus("query", "plates.nii.gz", *words).stdout.decode()
    inside = re.search(r'data-file="plates.nii.gz">(.*)</script>', page)[1]
    assert base64.b64decode(inside) == (rows.parent / "plates.nii.gz").read_bytes()
    conus.page("plates.nii.gz", "page.html", template="template.html")  # replaces the file without asking
    assert "question" not in (rows.parent / "page.html").read_text()
    with pytest.raises(conus.ArgumentError, match="both"):
        conus.page("plates.nii.gz", "page.html", origin=(0, 0, 0))
    with pytest.raises(conus.DataError, match="nothing.html"):
        conus.page("plates.nii.gz", "page.html", template="nothing.html")


def test_html_of_a_selection(rows, monkeypatch):
    """The page of a selection has its question and rows; where there is none, the table says why."""
    import html
    import re

    (rows.parent / "page.html").write_text("<!-- atlas -->\n<p>")
    program = conus._program.page
    monkeypatch.setattr(conus._program, "page", functools.partial(program, template="page.html"))

    def asked(**words):
        shown = atlas.select((-60, 19, 19), **words).to_html(height=500)
        found = re.search(r'<iframe [^>]* srcdoc="([^"]*)" style="[^"]*height: 500px', shown)
        assert found, shown
        return json.loads(re.search(r'id="question">(.*)</script>', html.unescape(found[1]))[1])

    atlas = conus.load("plates.nii.gz")
    question = asked(toward=(19, 19, 19.5), angle=12)
    words = ("--origin=-60,19,19", "--toward=19,19,19.5", "--angle=12", "--format=ndjson", "-q")
    assert question["rows"] == call_conus("query", "plates.nii.gz", *words).stdout.decode()
    assert asked(direction=(1, 0, 0))["fragment"].startswith("v=1&origin=-60,19,19&toward=40,19,19&angle=10&")

    def refused(selection, why):
        shown = selection.to_html()
        assert shown.startswith("<table>") and "iframe" not in shown
        assert re.search(f"<p>No page: .*{why}", shown)

    refused(atlas.near((19, 19, 19)), "one cone")
    refused(conus.load("plates.nii.gz", hide="1").select((-60, 19, 19), direction=(1, 0, 0)), "another")
    refused(conus.load(plates(), AFFINE).select((-60, 19, 19), direction=(1, 0, 0)), "array|no such|No such|not")
    monkeypatch.setattr(conus._program, "page", functools.partial(program, template="none.html"))
    refused(atlas.select((-60, 19, 19), direction=(1, 0, 0)), "none.html")


def test_cite(rows):
    assert conus.cite(rows) == call_conus("cite", "rows.tsv").stdout.decode()
    assert "full\nopening angle of 10°" in conus.cite(rows)
    assert conus.cite("plates.nii.gz", format="bibtex").startswith("@misc{conus,")


def test_errors(rows, monkeypatch, tmp_path):
    with pytest.raises(conus.DataError, match="none.tsv: cannot open"):
        conus.verify("none.tsv")
    with pytest.raises(conus.ArgumentError, match="^format: "):
        conus.cite(rows, format="apa")
    with pytest.raises(conus.ArgumentError, match="wanted is a path"):
        conus.verify(7)
    with pytest.raises(conus.ArgumentError, match="path"):
        conus.verify("a\0b")
    monkeypatch.setenv("CONUS", str(tmp_path / "no-program"))
    with pytest.raises(conus.FileError, match="no-program"):
        conus.verify(rows)
    monkeypatch.delenv("CONUS")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(conus._program, "_PACKED", str(tmp_path / "no-program"))
    with pytest.raises(conus.FileError, match="no program conus"):
        conus.cite(rows)


def test_ctrl_c_is_the_programs_on_windows(monkeypatch):
    """There the command of a wheel waits for the program, which says and does what belongs to Ctrl-C, and gives its status."""

    def interrupted(words):
        signal.raise_signal(signal.SIGINT)
        return len(words)

    before = signal.getsignal(signal.SIGINT)
    monkeypatch.setattr(os, "name", "nt")
    monkeypatch.setattr(subprocess, "call", interrupted)
    monkeypatch.setattr("sys.argv", ["conus", "query", "--help"])
    try:
        with pytest.raises(SystemExit, match="3"):
            conus._program.main()
    finally:
        signal.signal(signal.SIGINT, before)
