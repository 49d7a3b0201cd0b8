# SPDX-License-Identifier: BSD-3-Clause
"""Installed atlases by name: the list is that of the program, and a name loads what it says."""
import csv
import io
import os
import pathlib

import nibabel
import numpy as np
import pandas
import pytest

import conus
from support import AAL, AFFINE, call_conus, needs_aal, plates, same

VARIABLES = ("FSLDIR", "SUBJECTS_DIR", "FREESURFER_HOME", "TEMPLATEFLOW_HOME", "AFNI_ATLAS_PATH", "AFNI_PLUGINPATH",
             "AFNI_SUPP_ATLAS_DIR", "SPM_DIR", "NILEARN_DATA", "NILEARN_SHARED_DATA", "MRICROGL_DIR", "XDG_DATA_HOME",
             "XDG_CACHE_HOME")


@pytest.fixture(name="own")
def make_own(tmp_path, monkeypatch):
    """A folder of two atlases, which are all that there are."""
    own = tmp_path / "own"
    own.mkdir()
    nibabel.Nifti1Image(plates(), AFFINE).to_filename(own / "plates_atlas.nii.gz")
    (own / "plates_atlas.tsv").write_text("index\tname\n1\tleft\n2\tright\n")
    nibabel.Nifti1Image(plates(), np.diag([1, 1, 3, 1])).to_filename(own / "other_parcellation.nii.gz")
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("CONUS_ATLAS_PATH", str(own))
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_DATA_DIRS", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    return own


def test_list_is_that_of_the_program(own):
    rows = list(csv.DictReader(io.StringIO(call_conus("atlases", "--format", "tsv").stdout.decode()), delimiter="\t"))
    found = conus.atlases()
    assert [(atlas.name, atlas.source, atlas.kind, atlas.path) for atlas in found] == [
        (row["name"], row["source"], row["kind"], row["path"]) for row in rows
    ]
    assert found[0] == conus.InstalledAtlas("other_parcellation", "own", "volume", (1, 1, 3),
                                            (own / "other_parcellation.nii.gz").as_posix(), None)
    assert list(pandas.DataFrame(found)["name"]) == ["other_parcellation", "plates_atlas"]


@pytest.mark.usefixtures("own")
@pytest.mark.parametrize("name", ["plates_atlas", "own:plates_atlas", "Plates Atlas"])
def test_name_loads(name):
    atlas = conus.load(name)
    assert [row.name for row in atlas.info().itertuples() if row.kind == "area"] == ["left", "right"]


def test_path_comes_first(own):
    os.rename(own / "other_parcellation.nii.gz", "plates_atlas")
    assert [row.name for row in conus.load("plates_atlas").info().itertuples()] == ["1", "2"]


def test_wrong_names(own):
    with pytest.raises(conus.FileError, match=r"no installed atlas has that name .*did you mean plates_atlas\?"):
        conus.load("plate_atlas")
    with pytest.raises(conus.FileError, match="none.nii: cannot open: No such file or directory"):
        conus.load("none.nii")
    (own / "deeper").mkdir()
    os.link(own / "other_parcellation.nii.gz", own / "deeper" / "new.nii.gz")
    nibabel.Nifti1Image(plates(), AFFINE).to_filename(own / "deeper" / "plates_atlas.nii.gz")
    with pytest.raises(conus.ArgumentError, match="2 atlases have that name"):
        conus.load("plates_atlas")


def test_labels_of_the_list_and_others(own, monkeypatch):
    """FreeSurfer's table comes with a segmentation; labels= replaces it."""
    subject = own / "subject" / "mri"
    subject.mkdir(parents=True)
    nibabel.MGHImage(plates("i4"), AFFINE).to_filename(subject / "aseg.mgz")
    (own / "FreeSurferColorLUT.txt").write_text("1 Left-A 10 20 30 0\n2 Right-A 40 50 60 0\n")
    (own / "mine.txt").write_text("1 mine\n2 yours\n")
    monkeypatch.setenv("SUBJECTS_DIR", str(own))
    monkeypatch.setenv("FREESURFER_HOME", str(own))
    assert list(conus.load("subject.aseg").info()["name"]) == ["Left-A", "Right-A"]
    assert list(conus.load("subject.aseg", labels=own / "mine.txt").info()["name"]) == ["mine", "yours"]


@needs_aal
def test_aal(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_DATA_DIRS", str(pathlib.Path(AAL).parents[2]))
    monkeypatch.chdir(tmp_path)
    assert conus.load("mricron:aal").info().equals(conus.load(AAL).info())


@needs_aal
def test_a_context_by_its_name():
    """mricron's ch2 is an image beside AAL: it blocks by its name what it blocks by its path."""
    path = os.path.join(os.path.dirname(AAL), "ch2.nii.gz")
    if not os.path.exists(path):
        pytest.skip("no ch2")
    aim = {"origin": (-90, 0, 20), "toward": (0, 0, 20), "angle": 20}
    by_path, by_name = (conus.load(AAL, context=context, context_blocks=90).select(**aim) for context in (path, "ch2"))
    assert same(by_name.results, by_path.results)
    with pytest.raises(conus.FileError, match="no installed image has that name; did you mean ch2"):
        conus.load(AAL, context="ch22")
