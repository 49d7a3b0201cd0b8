# SPDX-License-Identifier: BSD-3-Clause
"""Selection over time: what a moving device means, with what came before."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np

from ._answers import Array, Selection, Track
from ._conus import ffi, lib
from ._library import RESULT, STEP, ArgumentError, Bound, array_of, check, flag, message, owned, real
from ._poses import Aims, PoseArray, notes_of, rows_of, warn

if TYPE_CHECKING:
    from ._atlas import Selector

Tell = Optional[Callable[..., object]]


class Tracker(Bound):
    """Follows a device: what its selector finds, ranked with what came before, as ``conus track`` does.

    A trembling hand so selects one area and not several, where the selector's score has a history:
    ``atlas.selector(score="intenselect").tracker()``. :meth:`Selector.tracker` makes one.

    Parameters
    ----------
    selector : Selector
        The selector that answers; its score may be one that needs a history.
    window : float
        Time over which the scores time and stability are measured, s. After a longer gap between
        steps the history starts afresh.
    stickiness : float
        IntenSelect's c_s: part of the score that a frame keeps, between 0 and 1.
    snappiness : float
        IntenSelect's c_g: part of the new score that a frame adds, up to 1.
    rate : float
        Frames per second for these two, whatever the rate of the steps.
    growth, decay : float
        Rates at which a score of IntenSelect+ grows and decays, 1/s.
    exponent : float
        k of IntenSelect and IntenSelect+, up to 1; with 1 the distance does not matter.
    delay : float, optional
        A press of the trigger confirms what was selected so many seconds before it, up to the
        window; 0.15 if not given.

    Raises
    ------
    ArgumentError
        For a number out of its range.
    """

    CONSTANTS = ("window", "stickiness", "snappiness", "rate", "growth", "decay", "exponent", "delay")

    def __init__(
        self,
        selector: Selector,
        *,
        window: float = 2,
        stickiness: float = 0.5,
        snappiness: float = 0.5,
        rate: float = 60,
        growth: float = 7.5,
        decay: float = 5,
        exponent: float = 0.8,
        delay: Optional[float] = None,
    ) -> None:
        given = {"window": window, "stickiness": stickiness, "snappiness": snappiness, "rate": rate, "growth": growth,
                 "decay": decay, "exponent": exponent}
        for name, value in given.items():
            if real(name, value) == 0:  # which is the library's word for its default
                raise ArgumentError(f"{name}: 0, allowed is more than 0")
        if delay is not None and not real("delay", delay) >= 0:
            raise ArgumentError(f"delay: {delay} s, allowed is 0 to the window, {window} s")
        given["delay"] = 0 if delay is None else delay or -1  # 0 is the default, below 0 is none
        out = ffi.new("conus_tracker **")
        selector._call(lib.conus_tracker_create, out, selector._p, ffi.new("conus_tracker_options *", given))
        self.selector = selector
        self._window = window
        self._p, self._made_of = owned(out[0], lib.conus_tracker_destroy, selector._p), selector._p

    def step(
        self,
        time_s: float,
        pose: Any = None,
        *,
        origin: Any = None,
        toward: Any = None,
        direction: Any = None,
        up: Any = None,
        angle: Optional[float] = None,
        trigger: bool = False,
    ) -> Selection:
        """Answers what the device selects now.

        Parameters
        ----------
        time_s : float
            Seconds of any clock; never less than at the step before.
        pose, origin, toward, direction, up, angle
            As of :meth:`Atlas.select`.
        trigger : bool
            It is held down. The step at which it goes down confirms what was selected before.

        Returns
        -------
        Selection
            Its ``step`` says what is selected and confirmed. Objects that left the cone stay in it
            while they have a score.

        Raises
        ------
        ArgumentError
            For a time before the last step, or a pose that is none. The tracker is then as it was.
        """
        selector, out = self.selector, ffi.new("conus_selection **")
        aim = selector._pose(origin, toward, direction, up, pose)
        time, opening, down = real("time_s", time_s), selector._angle(angle), flag("trigger", trigger)
        selector._check_made(self._made_of)
        selector._call(lib.conus_tracker_step, out, self._p, time, aim, opening, down)
        selection: Selection = selector._place(Selection(selector, out[0]))
        return selection

    def selected(self, ago: float = 0) -> Optional[str]:
        """The name of what was selected ``ago`` seconds, 0 to the window, before the last step; None if nothing was."""
        if not 0 <= real("ago", ago) <= self._window:
            raise ArgumentError(f"ago: {ago} s, allowed is 0 to the window, {self._window} s")
        with self.selector._lock:
            number = lib.conus_tracker_selected(self._p, ago)
        return self.selector.atlas.objects.name(number)

    def __repr__(self) -> str:
        return f"<conus.Tracker, selected: {self.selected()}>"


class _Follower:
    """Takes the steps of many poses, one after the other."""

    def __init__(self, tracker: Tracker, poses: PoseArray, times: Array, trigger: Array, angle: float) -> None:
        self.tracker = tracker
        self.poses, self.times, self.trigger, self.angle = poses, times, trigger, angle
        self.results: list[Array] = []
        self.steps = np.zeros(len(poses), STEP)
        self.steps["time_s"] = times
        self.errors: dict[int, str] = {}
        self.aims = Aims(tracker.selector._p)

    def take(self, index: int) -> None:
        pose, out, selector = ffi.new("conus_pose *"), ffi.new("conus_selection **"), self.tracker.selector
        angle = self.poses.angle(index, self.angle)
        with selector._lock:
            status = self.poses.fill(pose, index) or lib.conus_selector_set_range(selector._p, self.poses.range(index))
            if not status:
                self.aims.add(index, pose, angle)
                held = bool(self.trigger[index] > 0)
                status = lib.conus_tracker_step(out, self.tracker._p, self.times[index], pose, angle, held)
            reason = message() if status else ""
            lib.conus_selector_set_range(selector._p, ffi.NULL)
        if status == lib.CONUS_ERROR_ARGUMENT:
            self.errors[index] = self.poses.reasons.get(index, reason)
            self.results.append(np.empty(0, RESULT))
            return
        check(status)
        selection = owned(out[0], lib.conus_selection_destroy)
        count = lib.conus_selection_count(selection)
        self.results.append(array_of(lib.conus_selection_result(selection, 0), count, RESULT))
        self.steps[index] = array_of(lib.conus_selection_step(selection), 1, STEP)[0]

    def notes(self) -> list[str]:
        """A hand points here and there: only where all of the track does it may be in another space or unit."""
        found, selector = self.aims.found, self.tracker.selector
        notes = []
        if self.errors:
            first, reason = next(iter(self.errors.items()))
            left_out = f"{len(self.errors)} of {len(self.poses)} steps are left out"
            notes.append(f"{left_out}, the first is step {first}: {reason}")
        if found.poses and found.poses in (found.away.count, found.inside.count, found.tiny.count):
            with selector._lock:
                notes += notes_of(found, selector._p, selector.atlas._p, many=True)
        return notes


def follow(tracker: Tracker, times_s: Any, poses: PoseArray, angle: float, trigger: Any, tell: Tell) -> Track:
    """Takes every step; one that has no answer is left out, as a lost frame is."""
    times = rows_of("times_s", times_s, ())
    held = np.zeros(len(poses)) if trigger is None else rows_of("trigger", trigger, ())
    if not len(times) == len(held) == len(poses):
        raise ArgumentError(f"poses: {len(poses)}, with {len(times)} times_s and {len(held)} of trigger")
    follower = _Follower(tracker, poses, times, held, angle)
    for index in range(len(poses)):
        follower.take(index)
        if tell:
            tell(index + 1, len(poses))
    warn(follower.notes())
    starts = np.cumsum([0, *map(len, follower.results)])
    results = np.empty(starts[-1], RESULT)
    np.concatenate([np.empty(0, RESULT), *follower.results], out=results)
    selector = tracker.selector
    names = poses.names and {"query": poses.names["query"]}  # steps have their own times
    return Track(selector.atlas, results, starts, follower.errors, selector._layers, follower.steps, names)
