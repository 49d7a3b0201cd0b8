# SPDX-License-Identifier: BSD-3-Clause
"""progress=True, with and without tqdm."""
import sys
import types

import nibabel
import numpy as np
import pytest

import conus
from support import AFFINE, plates

POSES = np.zeros((1000, 3)), np.tile([1.0, 0, 0], (1000, 1))


@pytest.fixture(name="path")
def save_atlas(tmp_path):
    nibabel.save(nibabel.Nifti1Image(plates(), AFFINE), tmp_path / "atlas.nii")
    return tmp_path / "atlas.nii"


class Bar:
    """What of tqdm's bar is used; it remembers all bars."""

    bars: list["Bar"] = []

    def __init__(self, total, unit):
        self.n, self.total, self.unit, self.closed = 0, total, unit, 0
        Bar.bars.append(self)

    def update(self, n):
        self.n += n

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.closed += 1


@pytest.fixture(name="bars")
def pretend_tqdm(monkeypatch):
    module = types.ModuleType("tqdm.auto")
    module.tqdm = Bar
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", module)
    Bar.bars.clear()
    return Bar.bars


def ask_all(atlas, path, progress):
    """The answers of each call that has a progress."""
    loaded = conus.load(path, progress=progress)
    answers = atlas.select_many(*POSES, progress=progress)
    track = atlas.track(np.arange(10), POSES[0][:10], POSES[1][:10], progress=progress)
    return len(loaded), len(answers), len(track)


def test_bar_goes_to_its_end_and_is_closed(atlas, path, bars):
    assert ask_all(atlas, path, True) == (2, 1000, 10)
    assert [(bar.n, bar.total, bar.unit, bar.closed) for bar in bars] == [
        (1, 1, "file", 1), (1000, 1000, "pose", 1), (10, 10, "step", 1)
    ]  # fmt: skip


def test_bar_of_a_call_that_fails_stays_where_it_is_and_is_closed(atlas, path, bars):
    path.write_bytes(path.read_bytes()[:400])
    for call in (
        lambda: conus.load(path, progress=True),
        lambda: atlas.select_many(*POSES, progress=True, threads=5000),
    ):
        with pytest.raises(conus.Error):
            call()
    assert [(bar.n, bar.closed) for bar in bars] == [(0, 1), (0, 1)]


def test_no_bar_without_poses_is_not_an_error(atlas, bars):
    assert len(atlas.select_many(np.empty((0, 3)), np.empty((0, 3)), progress=True)) == 0
    assert [(bar.n, bar.total, bar.closed) for bar in bars] == [(0, 0, 1)]


@pytest.mark.parametrize("progress", [False, None])
def test_no_bar_is_shown_that_nobody_wants(atlas, path, bars, progress):
    assert ask_all(atlas, path, progress) == (2, 1000, 10)
    assert not bars


def test_without_tqdm_nothing_is_shown(atlas, path, monkeypatch, capfd):
    monkeypatch.setitem(sys.modules, "tqdm", None)  # importing it then fails
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    assert ask_all(atlas, path, True) == (2, 1000, 10)
    assert capfd.readouterr() == ("", "")


def test_tqdm_itself_shows_all(atlas, path, capfd):
    pytest.importorskip("tqdm", reason="python3-tqdm is not installed")
    assert ask_all(atlas, path, True) == (2, 1000, 10)
    shown = capfd.readouterr().err
    assert all(f"{count}/{count} " in shown for count in (1, 1000, 10)) and shown.count("100%") >= 3
