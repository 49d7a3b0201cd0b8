# SPDX-License-Identifier: BSD-3-Clause
"""Tables: read-only views of the library's columns, which outlive all that they were made of."""
import gc
import random

import numpy as np
import pytest

import conus


def make_atlas():
    labels = np.zeros((12, 12, 12), "u1")
    labels[:6], labels[6:] = 1, 2
    return conus.load(labels, np.diag([2.0, 2, 2, 1]), labels={1: "left", 2: "right"})


AIM = {"origin": (-40, 11, 11), "toward": (11, 11, 11)}


def test_columns_are_read_only_views():
    sweep = make_atlas().sweep(**AIM, angle=40)
    assert isinstance(sweep, conus.Table) and len(sweep) == 2
    assert sweep.columns[:4] == ("kind", "index", "name", "abbreviation")
    assert sweep["angle_deg"].dtype == np.float64 and sweep["rank"].dtype == np.int64
    # both rows of voxel centres are as far from the axis, so the farther one has the smaller angle
    assert sweep["name"].tolist() == ["right", "left"] and sweep["abbreviation"].tolist() == [None, None]
    assert sweep.unit("x") == "mm" and sweep.unit("rank") == "" and "cone" in sweep.help("angle_deg")
    for name in ("angle_deg", "rank"):
        assert not sweep[name].flags.writeable and not sweep[name].flags.owndata
        with pytest.raises(ValueError):
            sweep[name][0] = 1
        assert sweep[name].ctypes.data == sweep[name].ctypes.data  # no copy
    with pytest.raises(KeyError):
        sweep["no such column"]
    frame = sweep.to_dataframe()
    assert list(frame.columns) == list(sweep.columns) and frame["abbreviation"].isna().all()
    np.testing.assert_array_equal(frame["distance_mm"], sweep["distance_mm"])
    assert "left" in sweep._repr_html_() and "angle_deg" in repr(sweep)


def test_an_answer_without_rows_has_columns():
    empty = make_atlas().sweep(origin=(-40, 11, 11), direction=(-1, 0, 0), angle=10)
    assert len(empty) == 0 and empty["x"].shape == (0,) and list(empty.to_dataframe().columns) == list(empty.columns)


def test_positions_are_in_the_space_of_the_selector():
    atlas = make_atlas()
    ras = atlas.sweep(**AIM)
    lps = atlas.sweep(origin=(40, -11, 11), toward=(-11, -11, 11), space="lps")
    np.testing.assert_array_equal(lps["x"], -ras["x"])
    np.testing.assert_array_equal(lps["y"], -ras["y"])
    np.testing.assert_array_equal(lps["z"], ras["z"])


def test_columns_outlive_table_selector_and_atlas_in_any_order():
    """10^4 orders in which the four end; what is left is read after each end."""
    rng = random.Random(7)
    atlas = make_atlas()
    wanted = {name: np.array(atlas.sweep(**AIM)[name]) for name in ("angle_deg", "rank", "name")}
    for _ in range(10_000):
        if rng.random() < 0.02:
            atlas = make_atlas()
        held = {"atlas": atlas, "selector": atlas.selector() if rng.random() < 0.1 else atlas}
        held["table"] = held["selector"].sweep(**AIM)
        held.update({name: held["table"][name] for name in wanted})
        order = list(held)
        rng.shuffle(order)
        for end in order:
            held.pop(end)
            for name in wanted.keys() & held.keys():
                np.testing.assert_array_equal(held[name], wanted[name])
        if rng.random() < 0.01:
            gc.collect()


def test_an_atlas_lists_what_it_has():
    atlas = make_atlas()
    objects, notes = atlas.table("objects"), atlas.table("notes")
    with pytest.raises(conus.ArgumentError, match="what: areas, allowed are objects, surfaces"):
        atlas.table("areas")
    atlas.close()
    del atlas
    assert objects["name"].tolist() == objects["side"].tolist() == ["left", "right"]
    assert objects["depth"].tolist() == [1, 1] and objects.objects.tolist() == [1, 2]
    assert notes["kind"].tolist() == ["labels"] and notes["text"].tolist() == ["the program"]
