# SPDX-License-Identifier: BSD-3-Clause
"""Answers of studies to many poses."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from ._answers import Array, of_poses, queries_of, with_errors
from ._conus import ffi, lib
from ._library import ArgumentError, check
from ._table import Table, frame_of

if TYPE_CHECKING:
    import pandas

_TOGETHER = 1024  # so many tables, which take more memory than their rows, are joined to one


def _joined(parts: list[dict[Any, Array]]) -> dict[Any, Array]:
    return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}


class Tables:
    """Tables of many poses, one below the other: ``tables["entry_mm"]`` is the column of all rows.

    Rows ``starts[i]`` to ``starts[i + 1] - 1`` are about pose ``i``, and ``errors`` has the reason for each pose that has
    none, by its index. Columns are those of a :class:`Table`.
    """

    def __init__(self, array: Any, selector: Any, ask: Callable[[Any], Table]) -> None:
        pose = ffi.new("conus_pose *")
        counts = np.zeros(len(array) + 1, np.int64)
        chunks: list[dict[Any, Array]] = []
        parts: list[dict[Any, Array]] = []
        self.errors: dict[int, str] = {}
        try:
            for i in range(len(array)):
                try:
                    check(array.fill(pose, i) or lib.conus_selector_set_range(selector, array.range(i)))
                    table = ask(pose)
                    counts[i + 1] = len(table)
                    parts.append(table.arrays())
                except ArgumentError as error:
                    self.errors[i] = array.reasons.get(i, str(error))
                if len(parts) == _TOGETHER:
                    chunks.append(_joined(parts))
                    parts = []
        finally:
            lib.conus_selector_set_range(selector, ffi.NULL)
        self._names = array.names
        if not chunks and not parts:  # a table says which columns there are
            parts = [{key: values[:0] for key, values in ask(ffi.new("conus_pose *", {"world_from_device": np.eye(4).ravel().tolist()})).arrays().items()}]
        self._arrays = _joined([*chunks, *parts])
        self.columns = tuple(key for key in self._arrays if isinstance(key, str))
        self.starts = np.cumsum(counts)
        self.objects = self._arrays["objects",]  #: numbers in the atlas; 0 = none

    def __len__(self) -> int:
        return int(self.starts[-1])

    def __repr__(self) -> str:
        return f"<conus.Tables: {len(self)} rows about {len(self.starts) - 1} poses of {', '.join(self.columns)}>"

    def __getitem__(self, name: str) -> Array:
        """A column, as of a :class:`Table`."""
        if name not in self.columns:
            raise KeyError(name)
        return self._arrays[name]

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of the program; ``query`` is the pose's id in its file or its number from 1.

        A pose without an answer has one row of kind "error", whose name is the reason.
        """
        import pandas

        pose = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        queries = queries_of(self._names, len(self.starts) - 1)
        frame = pandas.DataFrame(of_poses(queries, pose)).join(frame_of(self._arrays))
        return with_errors(frame, pose, queries, self.errors)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())
