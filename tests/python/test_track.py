# SPDX-License-Identifier: BSD-3-Clause
"""Selection over time. $CONUS is the program conus."""
import gc
import threading
import warnings

import numpy as np
import pandas
import pytest

import conus
from support import AAL, assert_rows_of_the_program, needs_aal, run_conus, same

CENTRE, LEFT, RIGHT, UP = (0, 0, 0), (-1, 0, 0), (1, 0, 0), (0, 0, 1)


def trembling_hand(steps):
    """Times, origins, directions and a trigger: a hand beside AAL that sweeps, trembles and presses now and then."""
    random = np.random.default_rng(2)
    times = np.round(np.cumsum(random.uniform(0.005, 0.05, steps)), 4)
    times[steps // 2 :] += 5  # a gap longer than the window
    origins = np.array([-90, 20, 20]) + random.normal(size=(steps, 3))
    targets = np.column_stack([np.zeros(steps), 60 * np.sin(3 * times), 20 + 10 * np.cos(2 * times)])
    directions = targets - origins + random.normal(size=(steps, 3)) * 4
    return times, origins, directions, (np.arange(steps) % 17 > 12).astype(float)


def write_poses(path, times, origins, directions, trigger, angle=None):
    table = pandas.DataFrame(np.hstack([origins, directions]), columns=["x", "y", "z", "dx", "dy", "dz"])
    table.insert(0, "time_s", times)
    table["trigger"] = trigger.astype(int)
    if angle is not None:
        table["angle"] = angle
    table.to_csv(path, sep="\t", index=False, float_format="%.17g")


def assert_track_of_the_program(frame, rows):
    assert "query" in frame.columns
    assert_rows_of_the_program(frame, rows)


CASES = {
    "defaults": ({}, {}),
    "IntenSelect": ({"score": "intenselect", "stickiness": 0.9, "snappiness": 0.2, "rate": 50, "exponent": 0.5}, {}),
    "IntenSelect+": ({"score": "intenselect_plus", "growth": 4, "decay": 1, "delay": 0.4}, {}),
    "window": ({"score": "0.5*time+0.5*stability", "window": 0.3, "layers": "all", "resolution": 8}, {}),
    "no delay": ({"score": "share", "delay": 0}, {}),
    "selected": ({"score": "intenselect"}, {"selected": True}),
}


@needs_aal
@pytest.mark.parametrize("case", CASES)
def test_rows_are_those_of_the_program(tmp_path, case):
    options, shown = CASES[case]
    times, origins, directions, trigger = trembling_hand(120)
    write_poses(tmp_path / "hand.tsv", times, origins, directions, trigger)
    words = [f"--{name}={value}" for name, value in options.items() if value is not None]
    words += [f"--{name}" for name in shown]
    rows = run_conus("track", AAL, "--poses", tmp_path / "hand.tsv", "--angle=8", "--format=tsv", "-q", *words)
    track = conus.load(AAL).track(times, origins, directions, angle=8, trigger=trigger, **options)
    assert_track_of_the_program(track.to_dataframe(**shown), rows)
    assert rows["confirmed"].sum() > 1 and rows.loc[rows["selected"] == 1, "name"].nunique() > 2


@needs_aal
def test_lost_frames_and_angles_are_those_of_the_program(tmp_path):
    times, origins, directions, trigger = trembling_hand(40)
    angle = np.linspace(2, 30, 40)
    origins[3, 0], directions[9], angle[20], times[30] = np.nan, 0, 200, times[10]
    write_poses(tmp_path / "hand.tsv", times, origins, directions, trigger, angle)
    rows = run_conus("track", AAL, "--poses", tmp_path / "hand.tsv", "--score=intenselect", "--format=tsv", "-q")
    with pytest.warns(conus.PoseWarning, match="^4 of 40 steps are left out, the first is step 3: .*nan"):
        track = conus.load(AAL).track(times, origins, directions, angle=angle, trigger=trigger, score="intenselect")
    assert_track_of_the_program(track.to_dataframe(), rows)
    assert list(track.errors) == [3, 9, 20, 30] and "before the last step" in track.errors[30]
    assert all(len(track[i]) == 0 for i in track.errors) and len(track) == 40
    assert list(track.steps["time_s"]) == list(times)


@needs_aal
def test_a_tracker_takes_the_same_steps():
    atlas = conus.load(AAL)
    times, origins, directions, trigger = trembling_hand(60)
    track = atlas.track(times, origins, directions, trigger=trigger, score="intenselect", stickiness=0.8)
    tracker = atlas.selector(score="intenselect").tracker(stickiness=0.8)
    for i, time in enumerate(times):
        hits = tracker.step(time, origin=origins[i], direction=directions[i], trigger=trigger[i])
        assert same(hits.results, track[i])
        assert (hits.step.time_s, hits.step.selected) == (time, track.selected[i])
        assert tracker.selected() == track.selected[i]
    frame, last = track.to_dataframe(), hits.to_dataframe()
    rows = frame[frame["query"] == 60].drop(columns="query").reset_index(drop=True)
    pandas.testing.assert_frame_equal(last.astype(object), rows.astype(object))


def test_a_press_confirms_what_was_selected_before_it(atlas):
    """Left at 0 and 0.1 s, right from 0.2 s on. 0.15 s before 0.2 s the left one was selected."""
    tracker = atlas.selector().tracker()
    assert tracker.selected() is None
    for time in (0, 0.1):
        step = tracker.step(time, origin=CENTRE, direction=LEFT).step
        assert step == conus.Step(time, "left", None)
    assert tracker.step(0.2, origin=CENTRE, direction=RIGHT, trigger=True).step == conus.Step(0.2, "right", "left")
    assert tracker.step(0.3, origin=CENTRE, direction=RIGHT, trigger=True).step == conus.Step(0.3, "right", None)
    assert [tracker.selected(ago) for ago in (0, 0.1, 0.15, 0.3, 2)] == ["right", "right", "left", "left", "left"]
    assert tracker.step(0.4, origin=CENTRE, direction=UP).step == conus.Step(0.4, None, None)
    assert repr(tracker) == "<conus.Tracker, selected: None>"


def test_a_selected_object_has_true_in_its_row(atlas):
    track = atlas.track([0, 1], [CENTRE] * 2, [LEFT, UP], trigger=[False, True], delay=1)
    frame = track.to_dataframe()
    assert list(zip(frame["query"], frame["name"], frame["selected"], frame["confirmed"])) == [
        (1, "left", True, False), (1, "unassigned", False, False),
        (2, "left", False, True), (2, "unassigned", False, False),
    ]  # fmt: skip
    assert list(track.selected) == ["left", None] and frame["time_s"].tolist() == [0, 0, 1, 1]
    assert list(track.to_dataframe(selected=True)["name"]) == ["left", "left"]
    assert repr(track) == "<conus.Track of 2 steps: 4 results, 0 errors>"


def test_poses_are_matrices_too(atlas):
    poses = np.tile(np.eye(4), (2, 1, 1))
    poses[0, :3, :3] = [[0, 0, -1], [0, 1, 0], [1, 0, 0]]
    poses[1, :3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    assert list(atlas.track([0, 1], poses=poses).selected) == ["right", "left"]
    assert atlas.selector().tracker().step(0, poses[0])[0].name == "right"


def test_no_steps_are_a_track(atlas):
    track = atlas.track([], np.empty((0, 3)), np.empty((0, 3)))
    assert len(track) == 0 and len(track.to_dataframe()) == 0 and "selected" in track.to_dataframe()


def test_only_a_track_that_is_all_astray_is_warned_of(atlas):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        atlas.track([0, 1], [(100, 0, 0)] * 2, [LEFT, UP])
    with pytest.warns(conus.PoseWarning, match="2 of 2 cones point away from the atlas, the first is pose 0") as caught:
        atlas.track([0, 1], [(100, 0, 0)] * 2, [UP, UP])
    assert [w.filename for w in caught] == [__file__]


def test_a_step_that_fails_leaves_the_tracker_as_it_was(atlas):
    tracker = atlas.selector().tracker()
    tracker.step(1, origin=CENTRE, direction=LEFT)
    for time, aim in (
        (0.5, {"origin": CENTRE, "direction": RIGHT}),
        (np.nan, {"origin": CENTRE, "direction": RIGHT}),
        (2, {"pose": np.full((4, 4), np.nan)}),
        (2, {"origin": (np.nan, 0, 0), "direction": RIGHT}),
        (2, {"origin": CENTRE, "direction": RIGHT, "angle": 180}),
        (2, {}),
    ):
        with pytest.raises(conus.ArgumentError):
            tracker.step(time, **aim)
    assert tracker.selected() == "left"
    assert tracker.step(1, origin=CENTRE, direction=RIGHT).step.selected == "right"  # not before the last step


@pytest.mark.parametrize(
    "constants",
    [
        *({name: bad} for name in conus.Tracker.CONSTANTS for bad in (-1, np.nan, np.inf)),
        *({name: 0} for name in conus.Tracker.CONSTANTS if name != "delay"),
        {"stickiness": 1},
        {"snappiness": 1.1},
        {"exponent": 1.1},
        {"window": 0.1, "delay": 0.2},
        {"window": "a"},
        {"rate": [1]},
        {"delay": "a"},
    ],
)
def test_bad_constant_is_an_error(atlas, constants):
    with pytest.raises(conus.ArgumentError, match=next(reversed(constants))):
        atlas.selector().tracker(**constants)
    with pytest.raises(conus.ArgumentError):
        atlas.track([0], [CENTRE], [LEFT], **constants)


@pytest.mark.parametrize(
    "arrays",
    [
        {"times_s": [0], "origins": [CENTRE] * 2, "directions": [LEFT] * 2},
        {"times_s": [[0, 1]], "origins": [CENTRE] * 2, "directions": [LEFT] * 2},
        {"times_s": [0, 1], "origins": [CENTRE] * 2, "directions": [LEFT] * 2, "trigger": [1]},
        {"times_s": [0, 1]},
        {"times_s": [0, 1], "origins": [CENTRE] * 2, "directions": [LEFT] * 2, "angle": [1, 2, 3]},
    ],
)
def test_bad_arrays_are_an_error(atlas, arrays):
    with pytest.raises(conus.ArgumentError):
        atlas.track(**arrays)


@pytest.mark.parametrize("ago", [-0.1, 2.1, np.nan, "a"])
def test_bad_ago_is_an_error(atlas, ago):
    with pytest.raises(conus.ArgumentError, match="ago"):
        atlas.selector().tracker().selected(ago)


@pytest.mark.parametrize("how", [{"time_s": "a"}, {"time_s": [0]}, {"time_s": 0, "trigger": "no"}])
def test_a_bad_step_is_an_error(atlas, how):
    tracker = atlas.selector().tracker()
    with pytest.raises(conus.ArgumentError):
        tracker.step(**how, origin=CENTRE, direction=LEFT)


def test_a_score_with_a_history_is_for_tracks(atlas):
    with pytest.raises(conus.ArgumentError, match="history"):
        atlas.select(CENTRE, direction=LEFT, score="intenselect")
    assert atlas.select(CENTRE, direction=LEFT).step is None


def test_progress_is_told_and_its_exception_ends_the_track(atlas):
    heard = []
    arrays = ([0, 1, 2], [CENTRE] * 3, [LEFT] * 3)
    atlas.track(*arrays, progress=lambda done, total: heard.append((done, total)))
    assert heard == [(1, 3), (2, 3), (3, 3)]
    with pytest.raises(ZeroDivisionError):
        atlas.track(*arrays, progress=lambda done, total: 1 // 0)


def test_a_tracker_keeps_its_selector_and_not_a_closed_atlas(atlas):
    tracker = atlas.selector().tracker()
    gc.collect()
    hits = tracker.step(0, origin=CENTRE, direction=LEFT)
    atlas.close()
    gc.collect()
    assert hits[0].name == "left"
    for ask in (lambda: tracker.step(1, origin=CENTRE, direction=LEFT), lambda: atlas.track([0], [CENTRE], [LEFT])):
        with pytest.raises(conus.ArgumentError, match="closed"):
            ask()


def test_trackers_of_one_selector_do_not_mix(atlas):
    """One thread's device points left, the other's right; what one remembers is not what the other selects."""
    selector, failures = atlas.selector(score="intenselect"), []

    def move(direction, name):
        tracker = selector.tracker()
        for i in range(300):
            hits = tracker.step(0.01 * i, origin=CENTRE, direction=direction)
            if hits.step.selected != name or len(hits) != 2:
                failures.append(i)

    threads = [threading.Thread(target=move, args=a) for a in ((LEFT, "left"), (RIGHT, "right"))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failures
