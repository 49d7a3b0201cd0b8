# SPDX-License-Identifier: BSD-3-Clause
"""What the axes of devices pass, and how far they stay from objects, as arrays and tables."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from ._answers import Array, identity_of, own_points_of, points_of, of_poses, queries_of, with_errors
from ._conus import ffi, lib
from ._library import CLEARANCE, SEGMENT, ArgumentError, array_of, check, owned

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas
    from ._space import Space


class AxisRows:
    """What Segments and Clearances have in common: the library's functions begin with ``conus_`` and ``_words``."""

    _words = ""
    _word = ""
    _record = np.dtype([])

    def __init__(
        self, atlas: Atlas, records: Array, starts: Optional[Array] = None, errors: Optional[dict[int, str]] = None,
        names: Optional[dict[str, Array]] = None,
    ) -> None:
        self.atlas = atlas
        self.records = records
        self.starts = starts
        self.errors = errors or {}
        self._names = names
        self.space: Optional[Space] = None

    @classmethod
    def ask(cls, call: Any, selector: Any, pose: Any, *more: Any) -> Array:
        """The records of the axis of a pose; ``call`` calls the library."""
        out = ffi.new(f"conus_{cls._words} **")
        call(getattr(lib, f"conus_{cls._words}_create"), out, selector, pose, *more)
        rows = owned(out[0], getattr(lib, f"conus_{cls._words}_destroy"))
        first = getattr(lib, f"conus_{cls._words}_{cls._word}")(rows, 0)
        return array_of(first, getattr(lib, f"conus_{cls._words}_count")(rows), cls._record)

    @classmethod
    def ask_many(cls, atlas: Atlas, array: Any, call: Any, selector: Any, *more: Any) -> Any:
        """The rows of each pose of an array."""
        pose, found, errors = ffi.new("conus_pose *"), [np.empty(0, cls._record)], {}
        starts = np.zeros(len(array) + 1, np.int64)
        try:
            for i in range(len(array)):
                starts[i + 1] = starts[i]
                try:
                    check(array.fill(pose, i) or lib.conus_selector_set_range(selector, array.range(i)))
                    found.append(cls.ask(call, selector, pose, *more))
                    starts[i + 1] += len(found[-1])
                except ArgumentError as error:
                    errors[i] = array.reasons.get(i, str(error))
        finally:
            lib.conus_selector_set_range(selector, ffi.NULL)
        return cls(atlas, np.concatenate(found), starts, errors, array.names)

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        of = "" if self.starts is None else f" of {len(self.starts) - 1} poses"
        return f"<conus.{type(self).__name__}: {len(self)} {self._words}{of}>"

    def _columns(self, place: Array) -> dict[str, Any]:
        """The columns behind ``query``, of rows with these places in their query, from 1."""
        raise NotImplementedError

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of the program; of many poses with ``query``, the pose's id in its file or its number from 1.

        A pose without an answer has one row of kind "error", whose name is the reason.
        """
        import pandas

        starts = np.array([0, len(self)]) if self.starts is None else self.starts
        query = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
        queries = queries_of(self._names, len(starts) - 1)
        columns = {} if self.starts is None else of_poses(queries, query)
        columns.update(self._columns(np.arange(len(self)) - starts[query] + 1))
        return with_errors(pandas.DataFrame(columns), query, queries, self.errors)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


class Segments(AxisRows):
    """The objects that the axis of a device passes: stretches inside each object and between them, the nearest first.

    ``records`` are the library's own. Of many poses, ``records[starts[i]:starts[i + 1]]`` are those of
    pose ``i``, and ``errors`` has the reason for each pose that has none, by its index; of one pose,
    ``starts`` is None.
    """

    _words, _word, _record = "segments", "segment", SEGMENT

    def _columns(self, place: Array) -> dict[str, Any]:
        records = self.records
        columns = {"order": place, **identity_of(self.atlas.objects, records)}
        columns["entry_mm"] = records["entry"]
        columns["exit_mm"] = np.where(np.isfinite(records["exit"]), records["exit"], np.nan)
        columns["length_mm"] = columns["exit_mm"] - columns["entry_mm"]
        for name in ("entry", "exit"):
            columns.update(points_of(f"{name}_", records[f"{name}_at"], self.space))
        for name in ("entry", "exit"):
            columns.update(own_points_of(self.atlas, f"atlas_{name}_", records[f"{name}_at"], self.space))
        return columns


class Clearances(AxisRows):
    """How far a needle stays from objects, the nearest first. ``records``, ``starts`` and ``errors`` are as of Segments."""

    _words, _word, _record = "clearances", "clearance", CLEARANCE

    def _columns(self, place: Array) -> dict[str, Any]:
        records = self.records
        columns = identity_of(self.atlas.objects, records)
        del columns["abbreviation"]
        for name in ("distance", "clearance", "depth"):
            columns[f"{name}_mm"] = records[name]
        columns.update(points_of("", records["at"], self.space))
        columns.update(points_of("near_", records["near"], self.space))
        return columns
