# SPDX-License-Identifier: BSD-3-Clause
"""Several needles planned together, and the proof that no combination is better."""
from __future__ import annotations

import contextlib
import inspect
import math
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Mapping, Optional

import numpy as np

from ._answers import Array
from ._callback import Callback
from ._conus import ffi, lib
from ._library import ArgumentError, Bound, flag, items, owned, real, shown, text, utf8, vector, whole
from ._plan import constraints_of, frame_of_rows, needle_of, report_text, structures_of
from ._pose_file import Poses
from ._table import Table, ask_table

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas, Selector

_OF_SELECTOR = ("radius", "range", "space", "bregma", "layers", "resolution")
_OF_CONSTRAINTS = tuple(name for name in inspect.signature(constraints_of).parameters if name not in ("pitch", "covers"))
_OF_CANDIDATES = ("poses", "origins", "directions", "entries", "targets", "tilt", "roll", "near", "depth")
_OWN = ("once", "arc", "parts")
_ARCS = ("spacing", "slider", "same", "most", "each", "pitch")


def _given(asked: Mapping[str, Any], keys: tuple[str, ...]) -> dict[str, Any]:
    return {key: asked[key] for key in keys if key in asked}


def _known(number: float) -> Optional[float]:
    return None if math.isnan(number) else number


class _Question:
    """One question: its selector, its constraints, and how its candidates are opened, each time that C asks."""

    def __init__(
        self, atlas: Atlas, names: str, asked: Mapping[str, Any], threads: Any, is_given: bool, state: Callback,
        pitch: float, covers: bool,
    ) -> None:
        self.state, self.is_given = state, is_given
        for key in asked:
            if key not in (*_OF_SELECTOR, *_OF_CONSTRAINTS, *_OF_CANDIDATES, *_OWN, "shanks", "angle"):
                raise ArgumentError(f"{names}: there is no argument {key}")
        self.selector: Selector = atlas._selector(_given(asked, _OF_SELECTOR))
        reading = {"reach": (), "avoid": (), "length": None, "lean": (), "apart": (), "first": (), "entry_angle": None,
                   "arc_window": None, "contacts": None, **_given(asked, _OF_CONSTRAINTS)}
        self.constraints = constraints_of(**reading, pitch=pitch, covers=covers)
        if covers and self.constraints.contacts is None:
            raise ArgumentError(f"{names}: cover counts contacts, and there are none")
        self.stream: Optional[Callable[[], ContextManager[Any]]] = None
        far: Optional[float] = None
        places = _given(asked, _OF_CANDIDATES)
        if not is_given or places:
            self.stream, far, _ = self.selector._candidates(self.constraints, None, **places)
        self.options, self.shanks = needle_of(far, threads, asked.get("angle"), asked.get("shanks"))
        self.names, self.arc = utf8("needles", names), utf8("arc", asked.get("arc", ""))
        self.once, self.limits = flag("once", asked.get("once", False)), self.constraints.array()
        parts = [vector("parts", part[:3], 3) + list(part[3:]) for part in items("parts", asked.get("parts", ()))]
        self.parts = ffi.new("conus_part[]", max(1, len(parts)))
        self.part_count, self.opened = len(parts), contextlib.ExitStack()
        for out, (radius, low, high, *more) in zip(self.parts, parts):
            place = vector("parts", [one for one in more if one != "tip"] or (0, 0), 2)
            out.radius, out.low, out.high, (out.x, out.y), out.from_tip = radius, low, high, place, "tip" in more
        self.rows: Any = None
        self.handle = ffi.new_handle(self)

    def fill(self, out: Any) -> None:
        out.needles, out.once, out.selector, out.arc = self.names, self.once, self.selector._p, self.arc
        out.constraints, out.constraint_count, out.options = self.limits, len(self.constraints.rows), self.options
        out.parts, out.part_count, out.user = self.parts, self.part_count, self.handle
        out.contacts = self.constraints.contacts or {}
        if self.stream is not None:
            out.open, out.close = _open, _close

    def open(self, out: Any) -> None:
        if self.stream is not None:
            self.rows = self.opened.enter_context(self.stream())  # the stream lives as long as this
            out[0] = self.rows

    def close(self) -> None:
        self.rows = None
        self.opened.close()


@ffi.callback("conus_status(conus_pose_stream **, void *)", error=lib.CONUS_ERROR_DATA)  # type: ignore[misc]
def _open(out: Any, user: Any) -> int:
    question: _Question = ffi.from_handle(user)
    return int(lib.CONUS_OK if question.state.run(question.open, out) else lib.CONUS_ERROR_DATA)


@ffi.callback("void(conus_pose_stream *, void *)")  # type: ignore[misc]
def _close(_stream: Any, user: Any) -> None:
    question: _Question = ffi.from_handle(user)
    question.state.run(question.close)


class Together(Bound):
    """The best combinations of needles that were planned together, the best first: the rows of ``conus plan --needles``.

    ``needles`` are their names; ``poses`` the (n, needles, 4, 4) matrices from device to world, ``far`` the (n,
    needles) far ends, mm from the apex. ``combinations`` has for each whether it is ``proven`` that none is better, and
    if not what none exceeds (``bound_mm``), its ``leeway_mm`` and whose that is, ``sum_mm``, ``depth_mm``, its ``contacts`` in any
    cover and how many each has ``covered``, and whether it is proven to be the ``last``. ``pairs`` is a table of each two needles. Without a combination ``conflict`` names the
    smallest set of ``needles`` that has none, and the distances that would do, where these are known. A plan is a list
    to be checked.
    """

    def __init__(self, selector: Selector, together: Any, covers: int) -> None:
        self._selector, self._p, self._made_of = selector, together, selector._p
        self.needles: list[str] = []
        while needle := lib.conus_together_needle(together, len(self.needles)):
            self.needles.append(text(needle.name))
        count = len(self.needles)
        found: list[Any] = []
        while one := lib.conus_together_combination(together, len(found)):
            found.append(one)
        self.combinations = [{"proven": bool(one.proven), "bound_mm": one.bound, "leeway_mm": one.leeway,
                              "leeway_of": text(one.leeway_of) or None, "sum_mm": one.sum, "depth_mm": one.depth,
                              "contacts": one.contacts, "covered": [one.covered[k] for k in range(covers)],
                              "last": bool(one.last)} for one in found]
        chosen = [one.chosen[i].pose for one in found for i in range(count)]
        matrices = np.array([list(pose.pose.world_from_device) for pose in chosen]).reshape(len(found), count, 4, 4)
        self.poses: Array = matrices.swapaxes(2, 3).copy()
        self.far: Array = np.array([pose.far for pose in chosen], float).reshape(len(found), count)
        self.pairs: Table = ask_table(lib.conus_together_pairs, together)
        self.conflict: Optional[dict[str, Any]] = None
        if conflict := lib.conus_together_conflict(together):
            self.conflict = {"needles": [self.needles[conflict.needles[i]] for i in range(conflict.count)],
                             "between_mm": _known(conflict.between), "entry_distance_mm": _known(conflict.entry_distance)}
            if conflict.by_limits:
                self.conflict["arcs"] = {"most": conflict.arcs_most or None, "each": conflict.arcs_each or None}
                self.conflict["contacts"] = [_known(conflict.contacts[k]) for k in range(covers)]

    def __len__(self) -> int:
        return len(self.combinations)

    def __repr__(self) -> str:
        return f"<conus.Together: {len(self)} combinations of {', '.join(self.needles)}>"

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of ``conus plan --needles``, under the names of their columns."""
        self._selector._check_made(self._made_of)
        return frame_of_rows(report_text(self._selector, "needles", "tsv", lib.conus_report_add_together, self._p))

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


def _set_pair(options: Any, name: str, given: Any, members: tuple[str, str]) -> None:
    """A number, or two of them."""
    values = vector(name, given, 2) if isinstance(given, (tuple, list)) else [real(name, given)]
    for member, value in zip(members, values):
        setattr(options, member, whole(name, value) if member == "differ" else value)


def _set_arcs(options: Any, arcs: Any) -> None:
    """Degrees, or a mapping with the keys of --arcs beside "spacing"."""
    keys = dict(arcs) if isinstance(arcs, Mapping) else {"spacing": arcs}
    options.pitch = real("arcs: pitch", keys.pop("pitch", 0))
    for key, value in {**keys, "spacing": keys.get("spacing", 0)}.items():
        if key not in _ARCS:
            raise ArgumentError(f"arcs: there is no key {shown(key)}, allowed are {', '.join(_ARCS)}")
        if key in ("most", "each"):
            setattr(options, f"arcs_{key}", whole(f"arcs: {key}", value, 1, 16))
        elif not (degrees := real(f"arcs: {key}", value)) > 0:  # 0 would be the default
            raise ArgumentError(f"arcs: {key}: {shown(value)}, wanted is a number of degrees above 0")
        else:
            setattr(options, "arcs" if key == "spacing" else key, degrees)


def together_of(
    atlas: Atlas, needles: Mapping[str, Any], between: Any, entry_distance: float, arcs: Any, cover: Any,
    given: Optional[Poses], top: int, diverse: Any, effort: Optional[float], threads: Optional[int], of_all: Mapping[str, Any],
) -> Together:
    """What :meth:`Atlas.plan_together` gives."""
    options, out = ffi.new("conus_together_options *"), ffi.new("conus_together **")
    _set_pair(options, "between", between, ("between", "parts"))
    options.entry_distance, options.top = real("entry_distance", entry_distance), whole("top", top, 1, 100)
    if (diverse is None) != (options.top == 1):
        raise ArgumentError("diverse: by how much combinations have to differ goes with top above 1")
    _set_pair(options, "diverse", 0 if diverse is None else diverse, ("diverse", "differ"))
    if effort is not None:
        steps = 1000000 * real("effort", effort)
        options.effort = whole("effort", round(steps) if math.isfinite(steps) else steps, 1, 2**64 - 1)
    if arcs is not None:
        _set_arcs(options, arcs)
    covers = [(utf8("cover", names), 0 if least is None else whole("cover", least, 1, 1000000))
              for names, least in structures_of("cover", cover)]
    counted = ffi.new("conus_cover[]", covers)
    options.covers, options.cover_count = counted, len(covers)
    if given is not None:
        given.match(atlas)
        rows = [lib.conus_pose_list_row(given._list, i) for i in range(lib.conus_pose_list_count(given._list))]
        fixed = ffi.new("conus_pose_row[]", [row[0] for row in rows])
        options.given, options.given_count = fixed, len(rows)
    placed = {text(row.id) for row in rows} if given is not None else set()
    asked, state = [], Callback()
    for names, one in needles.items():
        for own in [one] if isinstance(one, Mapping) else items(names, one):
            is_given = {name.strip() for name in names.split(",")} <= placed
            asked.append(_Question(atlas, names, {**of_all, **own}, threads, is_given, state, options.pitch, bool(covers)))
    if idle := [text(question.names) for question in asked if text(question.arc) and not options.arcs]:
        raise ArgumentError(f"{idle[0]}: arc has no effect without arcs")
    questions = ffi.new("conus_question[]", max(1, len(asked)))
    for question, struct in zip(asked, questions):
        question.fill(struct)
    if not asked:
        raise ArgumentError("needles: there are none")
    with contextlib.ExitStack() as locks:
        for selector in sorted({question.selector for question in asked}, key=id):
            locks.enter_context(selector._lock)
        asked[0].selector._call(lib.conus_plan_together, out, questions, len(asked), options, state=state)
    together = owned(out[0], lib.conus_together_destroy, *(question.selector._p for question in asked))
    for i, question in enumerate(asked):
        if not question.is_given and not lib.conus_plan_left(lib.conus_together_question(together, i).plan, 0):
            raise ArgumentError(f"{text(question.names)}: poses: no candidate")
    return Together(asked[0].selector, together, len(covers))
