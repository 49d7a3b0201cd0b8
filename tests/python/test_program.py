# SPDX-License-Identifier: BSD-3-Clause
"""conus.verify, conus.cite and conus.page say what the program says."""
import json

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
    text = rows.read_text()
    assert text.count("\t208\t") == 1
    rows.write_text(text.replace("\t208\t", "\t207\t"))
    found = conus.verify("rows.tsv")
    assert not found and found.verdict == "different"
    (difference,) = found.differences
    assert difference.line == 2 and difference.where.endswith(": pixels")
    assert (difference.recorded, difference.again) == ("207", "208")
    assert "was changed after conus wrote it" in found.why[0]


def test_moved_and_missing(rows, tmp_path):
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (tmp_path / "plates.nii.gz").rename(folder / "other.nii.gz")
    found = conus.verify(rows)
    assert (found.verdict, found.files[0].state, found.files[0].found) == ("not verified", "missing", None)
    for search in (folder, [str(folder)]):
        found = conus.verify(rows, search=search)
        assert found and found.files[0].state == "moved"
        assert found.files[0].found == str((folder / "other.nii.gz").resolve())


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
    conus.page("plates.nii.gz", "page.html", template="template.html")  # replaces it, without a question
    assert "question" not in (rows.parent / "page.html").read_text()
    with pytest.raises(conus.ArgumentError, match="both"):
        conus.page("plates.nii.gz", "page.html", origin=(0, 0, 0))
    with pytest.raises(conus.DataError, match="nothing.html"):
        conus.page("plates.nii.gz", "page.html", template="nothing.html")


def test_cite(rows):
    assert conus.cite(rows) == call_conus("cite", "rows.tsv").stdout.decode()
    assert "full\nopening angle of 10°" in conus.cite(rows)
    assert conus.cite("plates.nii.gz", format="bibtex").startswith("@misc{conus,")


def test_errors(rows, monkeypatch, tmp_path):
    with pytest.raises(conus.DataError, match="none.tsv: cannot open"):
        conus.verify("none.tsv")
    with pytest.raises(conus.ArgumentError, match="--format"):
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
    with pytest.raises(conus.FileError, match="no program conus"):
        conus.cite(rows)
