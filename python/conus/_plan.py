# SPDX-License-Identifier: BSD-3-Clause
"""Plans: which needles reach some structures and stay clear of others, and how far they may be off."""
from __future__ import annotations

import contextlib
import io
import math
import os
import tempfile
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Iterator, Mapping, Optional, Sequence

import numpy as np

from ._answers import Array
from ._conus import ffi, lib
from ._library import (
    ArgumentError, Bound, check, flag, items, numbers, optional, owned, path_of, real, shown, text, utf8, vector,
    whole,
)  # fmt: skip
from ._pose_file import Poses
from ._poses import PoseArray
from ._space import mirrors
from ._table import Table, ask_table

if TYPE_CHECKING:
    import pandas
    from ._atlas import Selector

_FORMATS = {".tsv": "tsv", ".csv": "csv", ".json": "json", ".ndjson": "ndjson", ".jsonl": "ndjson", ".txt": "table"}

_SHANKS = {"any": -1, "all": -2}  # CONUS_SHANK_ANY, CONUS_SHANK_ALL
_POINTS = ("tip", "crossed")  # of an axis, without a number
_OF_CONTACTS = ("contacts", "probability")
_MEASURES = {"reach": (*_POINTS, *_OF_CONTACTS, "share", "pierced", "volume", "fraction", "streamlines"),
             "avoid": ("share", "pierced")}
_ERRORS = ("entry", "target", "depth")  # of both ends of a needle


def structures_of(name: str, given: Any) -> list[tuple[str, Any]]:
    """The names of each structure, between commas, and what is asked of it; None = nothing more."""
    if isinstance(given, str):
        given = [given]
    pairs = given.items() if isinstance(given, Mapping) else [(names, None) for names in items(name, given)]
    return [(names if isinstance(names, str) else ",".join(names), asked) for names, asked in pairs]


def _pairs(name: str, given: Any, wanted: str) -> list[Any]:
    pairs = [tuple(one) if isinstance(one, (tuple, list)) else (one,) for one in items(name, given)]
    for one in pairs:
        if len(one) != 2:
            raise ArgumentError(f"{name}: {shown(one)}, wanted is a list of {wanted}")
    return pairs


class Constraints:
    """The constraints of the library, in the order of the arguments, and what must live as long as they."""

    def __init__(self, contacts: Any = None) -> None:
        """contacts: (count, columns, pitch, tip), or None."""
        self.rows: list[dict[str, Any]] = []
        self.contacts: Any = None
        if contacts is not None:
            count, columns, pitch, tip = vector("contacts", contacts, 4)
            if not (1 <= count <= 65536 and count == int(count) and 1 <= columns <= 65536 and columns == int(columns)):
                raise ArgumentError(f"contacts: {shown(contacts)}, wanted are two whole numbers from 1 on, pitch and tip")
            self.contacts = {"count": int(count), "columns": int(columns), "pitch": pitch, "tip": tip}

    def add(self, kind: str, **members: Any) -> None:
        self.rows.append({"kind": getattr(lib, f"CONUS_CONSTRAINT_{kind.upper()}"), **members})

    def add_structures(self, kind: str, main: str, given: Any) -> None:
        for names, asked in structures_of(kind, given):
            members: dict[str, Any] = {"names": utf8(kind, names)}
            keys = asked if isinstance(asked, Mapping) else {asked: None} if isinstance(asked, str) else {main: asked}
            for key, value in keys.items():
                if key == "shank":
                    by_word = isinstance(value, str) and value in _SHANKS
                    members["shank"] = _SHANKS[value] if by_word else whole(f"{kind}: shank", value, 1, 1000)
                elif key == "part" and kind == "reach":
                    members["part"] = vector(f"{kind}: part", value, 2)
                elif key in _MEASURES[kind] and "measure" not in members and (value is None) == (key in _POINTS):
                    members["measure"] = getattr(lib, f"CONUS_MEASURE_{key.upper()}")
                    members["limit"] = real(f"{kind}: {key}", value) if value is not None else 0
                    if key in _OF_CONTACTS and self.contacts:
                        members["contacts"] = self.contacts
                elif key != main or isinstance(asked, str):
                    raise ArgumentError(f"{kind}: {shown(asked)} of {names} is not what {kind} can ask")
                elif value is not None:
                    members["limit"] = real(f"{kind}: {key}", value)
            self.add(kind, **members)

    def reached(self) -> Any:
        """The names of the first reach; NULL = there is none."""
        names = [row["names"] for row in self.rows if row["kind"] == lib.CONUS_CONSTRAINT_REACH]
        return names[0] if names else ffi.NULL

    def array(self) -> Any:
        array = ffi.new("conus_constraint[]", max(1, len(self.rows)))
        for entry, row in zip(array, self.rows):
            entry.struct_size = ffi.sizeof("conus_constraint")
            for member, value in row.items():
                setattr(entry, member, value)
        return array


def constraints_of(reach: Any, avoid: Any, length: Any, lean: Any, apart: Any, first: Any,
                   entry_angle: Any, arc_window: Any, contacts: Any, pitch: float = 0, covers: bool = False) -> Constraints:
    """The constraints of these arguments of :meth:`Selector.plan`; of a pitched rig; whether contacts are counted by covers."""
    found = Constraints(contacts)
    found.add_structures("reach", "length", reach)
    found.add_structures("avoid", "margin", avoid)
    if length is not None:
        low, high = vector("length", length, 2)
        found.add("length", limit=low, most=high)
    for direction, degrees in _pairs("lean", lean, "(direction, degrees)"):
        found.add("lean", direction=vector("lean", direction), limit=real("lean", degrees))
    for ends, distance in _pairs("apart", apart, "(ends, mm)"):
        needles = np.ascontiguousarray(numbers("apart", ends))
        if needles.ndim != 3 or needles.shape[1:] != (2, 3):
            raise ArgumentError(f"apart: an array of shape {needles.shape}, wanted is (n, 2, 3)")
        pointer = ffi.from_buffer("double[]", needles)
        found.add("apart", needles=pointer, needle_count=len(needles), limit=real("apart", distance))
    for names, _ in structures_of("first", first):
        found.add("first", names=utf8("first", names))
    if entry_angle is not None:
        found.add("entry_angle", limit=real("entry_angle", entry_angle))
    if arc_window is not None:
        windows = [vector("arc_window", one, 2) for one in items("arc_window", arc_window)]
        if len(windows) != 2:
            raise ArgumentError(f"arc_window: {shown(arc_window)}, wanted is ((A0, A1), (M0, M1)), degrees")
        for kind, (low, high) in zip(("arc", "slider"), windows):
            found.add(kind, limit=low, most=high, pitch=pitch if kind == "arc" else 0)
    if found.contacts and not covers and not any("contacts" in row for row in found.rows):
        raise ArgumentError("contacts have no effect without a reach by contacts or probability")
    return found


def errors() -> Table:
    """The published errors that ``jitter`` knows by name: standard deviations per axis, mm, and degrees of the tilt.

    That of vr-controller is of a target 4 degrees wide; ``jitter="vr-controller:2"`` is of one of 2.
    """
    return ask_table(lib.conus_list_choices, b"errors")


def error_of(argument: str, name: str) -> Any:
    """The published error of this name."""
    error = ffi.new("conus_pose_error *")
    if status := lib.conus_pose_error_find(error, utf8(argument, name)):
        check(status)
    return error


def _jitter_of(jitter: Any, samples: int) -> Any:
    """A conus_jitter_options of (degrees, mm), {"entry": mm, "target": mm, "depth": mm} or a name; NULL of None."""
    if jitter is None:
        if samples:
            raise ArgumentError("samples have no effect without jitter")
        return ffi.NULL
    options = ffi.new("conus_jitter_options *")
    options.samples = whole("samples", samples)
    if isinstance(jitter, str):
        error = error_of("jitter", jitter)
        options.tilt, options.shift = error.tilt_deg, error.shift
        options.entry, options.target, options.depth = error.entry, error.target, error.depth
    elif isinstance(jitter, Mapping):
        for key, value in jitter.items():
            if key not in _ERRORS:
                raise ArgumentError(f"jitter: there is no key {shown(key)}, allowed are {', '.join(_ERRORS)}")
            setattr(options, key, real(f"jitter: {key}", value))
    else:
        degrees, options.shift = vector("jitter", jitter, 2)
        options.tilt = degrees
    return options


@contextlib.contextmanager
def stream_of(array: PoseArray, poses: Any, near: Any, far: Any) -> Iterator[Any]:
    """A conus_pose_stream of them: the library reads candidates from a file, here with all digits."""
    pose = ffi.new("conus_pose *")
    columns, options = [f"m{r}{c}" for r in range(4) for c in range(4)], ffi.new("conus_pose_options *")
    if is_turned := mirrors(array.frame):  # and matrices of files do not
        columns, options.frame = "x y z dx dy dz ux uy uz".split(), array.frame
    lines = ["\t".join(["query_id", *columns, "angle", "near", "far"])]
    ends = np.full((len(array), 2), np.nan)
    angles = np.full(len(array), np.nan)
    if isinstance(poses, Poses):
        angles = poses.angles
        ends[:] = [list(lib.conus_pose_list_row(poses._list, i).range) for i in range(len(array))]
    for column, (name, given) in enumerate((("near", near), ("far", far))):
        if given is not None:
            ends[:, column] = numbers(name, given)
    for i, (low, high) in enumerate(ends):
        name = str(i + 1) if array.names is None else str(array.names["query"][i])
        place = np.full(len(columns), np.nan)
        if i not in array.reasons:
            check(array.fill(pose, i))
            matrix = np.array(list(pose.world_from_device)).reshape(4, 4).T
            place = matrix.ravel()
            if is_turned:
                place = np.array([matrix[:3, 3], -matrix[:3, 2], matrix[:3, 1]])
                for row, from_world in enumerate((lib.conus_frame_from_world, *2 * (lib.conus_frame_direction_from_world,))):
                    at = ffi.cast("double *", place[row].ctypes.data)
                    from_world(at, array.frame, at)
        cells = [*place.ravel(), angles[i], low, high]
        name = name.replace('"', '""')
        lines.append("\t".join([f'"{name}"', *("n/a" if math.isnan(cell) else repr(float(cell)) for cell in cells)]))
    out = ffi.new("conus_pose_stream **")
    with tempfile.NamedTemporaryFile("w", suffix=".tsv", encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")
        file.flush()
        check(lib.conus_pose_stream_open(out, os.fsencode(file.name), options))
        yield owned(out[0], lib.conus_pose_stream_destroy)


_TEXTS = ("query", "name", "broken", "leeway_of", "clearance_of", "breaks", "needle", "all_leeway_of")


def report_text(selector: Selector, rows: str, form: str, add: Any, made: Any, *more: Any) -> str:
    """The text of a report of ``made``, which ``add`` adds to it."""
    options, out = ffi.new("conus_report_options *"), ffi.new("conus_report **")
    text_out, size = ffi.new("char **"), ffi.new("size_t *")
    words = ffi.new("char[]", rows.encode()), ffi.new("char[]", form.encode())
    options.rows, options.format = words
    options.frame = selector.space._frame if selector.space else ffi.NULL
    selector._call(lib.conus_report_create, out, selector._p, options)
    report = owned(out[0], lib.conus_report_destroy, made)
    selector._call(add, report, made, *more)
    check(lib.conus_report_text(text_out, size, report))
    return bytes(ffi.buffer(text_out[0], size[0])).decode()


def frame_of_rows(table: str) -> pandas.DataFrame:
    """The rows of a report's TSV."""
    import pandas

    return pandas.read_csv(io.StringIO(table), sep="\t", na_values="n/a", keep_default_na=False,
                           dtype={name: str for name in _TEXTS}, quoting=3)


_MAPS = ("leeway_mm", "slack_mm", "depth_mm", "entry_angle_deg", "reach1", "feasible", "candidate")


class Plan(Bound):
    """The poses that break no constraint, the best first: the rows of ``conus plan``.

    ``poses`` are their (n, 4, 4) matrices from device to world, ``near`` and ``far`` the ends of the needles, mm from
    the apex, ``ids`` their names, ``leeway_mm`` how far no point of the needle may be off. ``constraints`` words what
    is asked, in order; ``entries`` and ``targets`` are the numbers of candidates, from 1, 0 of other poses; ``funnel``
    counts how many of the ``candidates`` hold the first, the first two, and so on; ``misses`` has for each the pose
    that breaks it alone, by the least, where none is feasible, else None. A plan is a list to be checked.
    """

    def __init__(self, selector: Selector, plan: Any, errors: Mapping[int, str], sources: Mapping[str, Array]) -> None:
        self._selector, self._p, self._made_of = selector, plan, selector._p
        rows = [lib.conus_plan_pose(plan, i) for i in range(lib.conus_plan_count(plan))]
        constraints = self._list("constraints")
        self.ids: Array = np.array([text(row.id) for row in rows], object)
        matrices = np.array([list(row.pose.world_from_device) for row in rows]).reshape(len(rows), 4, 4)
        self.poses: Array = matrices.transpose(0, 2, 1).copy()
        self.near, self.far, self.leeway_mm = (
            np.array([getattr(row, name) for row in rows], float) for name in ("near", "far", "leeway"))
        self.entries, self.targets = (np.array([getattr(row, name) for row in rows], np.uint64)
                                      for name in ("entry", "target"))
        self.candidates = int(lib.conus_plan_left(plan, 0))
        self.constraints: list[str] = list(constraints["asked"])
        self.funnel = [int(left) for left in constraints["left"]]
        self.misses: list[Optional[str]] = list(constraints["miss"])
        self.errors = dict(errors)  #: why a pose of a file is none, by its index
        self.sources = dict(sources)  #: of "entries" and "targets" of maps, their numbers in what they are of, from 0

    def __len__(self) -> int:
        return len(self.ids)

    def __repr__(self) -> str:
        return f"<conus.Plan: {len(self)} poses listed, {self.funnel[-1]} of {self.candidates} candidates are feasible>"

    def _list(self, what: str) -> Table:
        return ask_table(lib.conus_plan_list, self._p, utf8("what", what))

    def _text(self, rows: str, form: str, step: Any = None) -> str:
        add = "plan" if step is None else rows
        return report_text(self._selector, rows, form, getattr(lib, f"conus_report_add_{add}"), self._p,
                           *(() if step is None else (step,)))

    def _table(self, rows: str, step: Any = None) -> pandas.DataFrame:
        return frame_of_rows(self._text(rows, "tsv", step))

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of ``conus plan``, under the names of their columns."""
        return self._table("plan")

    def verdicts(self) -> pandas.DataFrame:
        """A row for each pose and constraint: those of ``--constraints``."""
        return self._table("constraints")

    def profile(self, step: float = 1) -> pandas.DataFrame:
        """How far each needle is from what it is to avoid, from ``step`` to ``step`` mm of depth: ``--profile``."""
        return self._table("profile", real("step", step))

    def try_pose(self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
                 near: Optional[float] = None, depth: Optional[float] = None) -> dict[str, Any]:
        """What the list would say of this pose, also where it breaks constraints.

        ``broken`` is the index of the first constraint that breaks, or None; ``verdicts`` has for each constraint
        whether it ``holds``, its ``value``, ``slack`` and ``leeway``, angles in degrees, and with jitter ``p``. mm.
        """
        row, out = ffi.new("conus_pose_row *"), ffi.new("conus_planned **")
        name = ffi.new("char[]", b"")
        row.id, row.pose = name, self._selector._pose(origin, toward, direction, up, pose)[0]
        row.range = [math.nan if end is None else real("depth", end) for end in (near, depth)]
        self._selector._check_made(self._made_of)
        self._selector._call(lib.conus_plan_try, out, self._p, row)
        planned = out[0]
        numbers_of = {key: getattr(planned, key) for key in ("leeway", "slack", "clearance", "near", "far", "score", "p_ok")}
        verdicts = [{"holds": bool(one.holds), **{key: getattr(one, key) for key in ("value", "slack", "leeway", "p")}}
                    for one in planned.verdicts[0:len(self.constraints)]]
        broken = None if planned.feasible else int(planned.broken)
        return {"feasible": bool(planned.feasible), "broken": broken, **numbers_of, "verdicts": verdicts}

    def tolerance(self, pivot: Any = "entry") -> pandas.DataFrame:
        """By how much each pose may be off along each degree of freedom before a constraint breaks (Eq. 23).

        The needle turns about ``pivot``: "entry", the device's position; "tip", its far end; or a depth in mm. The
        rows are those of ``--tolerance``.
        """
        options = ffi.new("conus_tolerance_options *")
        options.pivot_at_tip = pivot == "tip"
        if not isinstance(pivot, str):
            options.pivot = real("pivot", pivot)
        elif pivot not in ("entry", "tip"):
            raise ArgumentError(f"pivot: {shown(pivot)} is neither a number nor entry nor tip")
        return self._table("tolerance", options)

    def map(self, key: str, of: str = "entries") -> Array:
        """A number of the best pose of each entry, or target, listed or not: the values of ``--map``.

        ``key`` is "leeway_mm", "slack_mm", "depth_mm", "entry_angle_deg", "reach1" (what the first reach measures) or
        "candidate", its number: NaN, or 0, where none is feasible; or "feasible", how many poses are. ``sources[of]``
        has the vertex of the surface, or the voxel (x fastest), that each is of. Needs a plan with ``maps=True``.
        """
        if key not in _MAPS:
            raise ArgumentError(f"map: {shown(key)}, wanted is one of {', '.join(_MAPS)}")
        if of not in self.sources or not len(self.sources[of]):
            raise ArgumentError(f"map: no {shown(of)}; wanted are entries or targets, of a plan with maps=True")
        values = self._list(of)[key]
        return values.astype(np.uint64) if key in ("feasible", "candidate") else values.copy()

    def save(self, path: Any) -> None:
        """Writes the rows; the ending says the format: .tsv, .csv, .json, .ndjson or, for people, .txt."""
        ending = os.path.splitext(os.fspath(path))[1]
        if ending not in _FORMATS:
            raise ArgumentError(f"path: {shown(path)} ends in none of {', '.join(_FORMATS)}")
        rows = self._text("plan", _FORMATS[ending]).encode()
        check(lib.conus_write_file(path_of("path", path), rows, len(rows)))

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


def needle_of(far: Optional[float], threads: Optional[int], angle: Any, shanks: Any) -> tuple[Any, Any]:
    """The conus_plan_options of a needle, and the array that must live as long."""
    options, places = ffi.new("conus_plan_options *"), None
    options.threads = 0 if threads is None else whole("threads", threads)
    options.far = 0 if far is None else far
    options.angle = 0 if angle is None else real("angle", angle)
    if shanks is not None:
        places = np.ascontiguousarray(numbers("shanks", shanks))
        if places.ndim != 2 or places.shape[1] != 2:
            raise ArgumentError(f"shanks: an array of shape {places.shape}, wanted is (n, 2)")
        options.shanks, options.shank_count = ffi.from_buffer("double[]", places), len(places)
    return options, places


def plan_of(
    selector: Selector, constraints: Constraints, stream: Callable[[], ContextManager[Any]], errors: Mapping[int, str],
    far: Optional[float], infeasible: bool, top: Optional[int], threads: Optional[int], angle: Any, shanks: Any,
    words: Sequence[Optional[str]], jitter: Any, samples: int, sources: Optional[Mapping[str, Array]],
) -> Plan:
    """What :meth:`Selector.plan` gives; ``words`` are rank and score, ``sources`` what has maps."""
    options, places = needle_of(far, threads, angle, shanks)
    out = ffi.new("conus_plan **")
    options.top = 2**64 - 1 if top is None else whole("top", top, 1, 2**64 - 1)
    options.infeasible = flag("infeasible", infeasible)
    texts = [optional(utf8, name, word) for name, word in zip(("rank", "score"), words)]
    options.rank, options.score = texts
    errors_of_pose = _jitter_of(jitter, samples)
    options.jitter = errors_of_pose
    rows = constraints.array()
    with stream() as poses:
        if sources is not None:
            options.entries, options.targets = len(sources["entries"]), len(sources["targets"])
        selector._call(lib.conus_plan_create, out, selector._p, rows, len(constraints.rows), options)
        plan = owned(out[0], lib.conus_plan_destroy, selector._p)
        selector._call(lib.conus_plan_run, plan, poses, 2**64 - 1)
    faults = lib.conus_plan_rejected(plan)
    if not lib.conus_plan_left(plan, 0):
        raise ArgumentError(f"poses: no candidate{f': {text(faults.why)}' if faults.count else ''}")
    return Plan(selector, plan, errors, sources or {})
