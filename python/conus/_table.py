# SPDX-License-Identifier: BSD-3-Clause
"""Answers of studies: rows in typed columns."""
from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, Callable, Optional

import numpy as np

from ._answers import Array, of_poses, queries_of, with_errors
from ._conus import ffi, lib
from ._library import ArgumentError, Bound, UnsupportedError, check, choice, owned, text

if TYPE_CHECKING:
    import pandas

_MOST_AREAS = 8192  # as of conus_report_matrix()
_TOGETHER = 1024  # so many tables, which take more memory than their rows, are joined to one


class _Lent:
    """An array of the library, which lives as long as what owns it; numpy asks for ``__array_interface__``."""

    def __init__(self, owner: Any, pointer: Any, count: int, kind: str) -> None:
        self._owner = owner
        address = int(ffi.cast("uintptr_t", pointer))
        self.__array_interface__ = {"version": 3, "data": (address, True), "shape": (count,), "typestr": kind}


def frame_of(columns: dict[Any, Array]) -> pandas.DataFrame:
    """The columns that :meth:`Table.arrays` gives."""
    import pandas

    def series(name: str, values: Array) -> Any:
        if values.dtype == object:  # no categories: those of two answers could not be compared
            return values
        if values.dtype == np.float64:
            return np.where(np.isfinite(values), values, np.nan)
        return pandas.arrays.IntegerArray(values.copy(), columns["missing", name].copy())

    return pandas.DataFrame({key: series(key, values) for key, values in columns.items() if isinstance(key, str)})


def _kept(values: Array) -> Array:
    """The array, from now on read-only."""
    values.flags.writeable = False
    return values


def _joined(parts: list[dict[Any, Array]]) -> dict[Any, Array]:
    return {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}


class Table(Bound):
    """Rows in typed columns: ``table["distance_mm"]``; ``len()`` counts the rows, ``columns`` names the columns.

    Columns and values are those of the program, without ``query``. Positions are in the space of the selector that
    was asked. Arrays are read-only; they stay valid when table, selector and atlas are gone.

    Of many poses rows ``starts[i]`` to ``starts[i + 1] - 1`` are about pose ``i``, and ``errors`` has the reason for
    each pose that has none, by its index.
    """

    columns: tuple[str, ...]
    starts: Array
    errors: dict[int, str]

    def __init__(self, pointer: Any, whole: Any = None) -> None:
        self._p = owned(pointer, (lambda _: None) if whole else lib.conus_table_destroy, whole)
        found = itertools.takewhile(bool, (lib.conus_table_column(self._p, i) for i in itertools.count()))
        self._columns = {text(column.name): column for column in found}
        self._many: Optional[tuple[dict[Any, Array], Any]] = None  # arrays of many poses, and the names of these
        self.columns = tuple(self._columns)
        self._rows = int(lib.conus_table_rows(self._p))
        self.starts, self.errors = _kept(np.array([0, self._rows])), {}
        self.objects = self._view(lib.conus_table_objects(self._p), "<u4")  #: numbers in the atlas; 0 = none

    @classmethod
    def of_poses(cls, array: Any, selector: Any, ask: Callable[[Any], Table]) -> Table:
        """The tables of many poses, one below the other."""
        pose, errors = ffi.new("conus_pose *"), {}
        counts = np.zeros(len(array) + 1, np.int64)
        chunks: list[dict[Any, Array]] = []
        parts: list[dict[Any, Array]] = []
        try:
            for i in range(len(array)):
                try:
                    check(array.fill(pose, i) or lib.conus_selector_set_range(selector, array.range(i)))
                    table = ask(pose)
                    counts[i + 1] = len(table)
                    parts.append(table.arrays())
                except ArgumentError as error:
                    errors[i] = array.reasons.get(i, str(error))
                if len(parts) == _TOGETHER:
                    chunks.append(_joined(parts))
                    parts = []
        finally:
            lib.conus_selector_set_range(selector, ffi.NULL)
        if not chunks and not parts:  # a table says which columns there are
            table = ask(ffi.new("conus_pose *", {"world_from_device": np.eye(4).ravel().tolist()}))
            parts = [{key: values[:0] for key, values in table.arrays().items()}]
        arrays = _joined([*chunks, *parts])
        for values in arrays.values():
            _kept(values)
        table._many = arrays, array.names
        table.starts, table.errors, table.objects = _kept(np.cumsum(counts)), errors, arrays["objects",]
        return table

    def _view(self, pointer: Any, kind: str) -> Array:
        return np.asarray(_Lent(self._p, pointer, self._rows, kind)) if self._rows else np.empty(0, kind)

    def __len__(self) -> int:
        return int(self.starts[-1])

    def __repr__(self) -> str:
        about = f" about {len(self.starts) - 1} poses" if self._many else ""
        return f"<conus.Table: {len(self)} rows{about} of {', '.join(self.columns)}>"

    def part(self, name: str) -> Table:
        """A part of the answer that is a table of its own."""
        found = lib.conus_table_part(self._p, name.encode())
        if not found:
            raise KeyError(name)
        return Table(found, self._p)

    def unit(self, name: str) -> str:
        """The unit of a column: "mm", "degree", or "" of none."""
        return text(self._columns[name].unit)

    def help(self, name: str) -> str:
        """What a column is, in a line."""
        return text(self._columns[name].help)

    def _words(self, column: Any) -> Array:
        return np.array([text(word) if word else None for word in ffi.unpack(column.words, column.word_count)], object)

    def __getitem__(self, name: str) -> Array:
        """A column: float64, where n/a is NaN; int64, where it is 0; or texts, where it is None."""
        column = self._columns[name]
        if self._many:
            return self._many[0][name]
        if column.type == lib.CONUS_TYPE_NUMBER:
            return self._view(column.numbers, "<f8")
        if column.type == lib.CONUS_TYPE_COUNT:
            return self._view(column.counts, "<i8")
        return _kept(np.asarray(self._words(column)[self._view(column.codes, "<u4")]))

    def arrays(self) -> dict[Any, Array]:
        """The columns by their names; as "missing" and a name where a count is n/a; and the objects."""
        if self._many:
            return dict(self._many[0])
        out: dict[Any, Array] = {name: self[name] for name in self.columns}
        for name, column in self._columns.items():
            if column.type == lib.CONUS_TYPE_COUNT:
                out["missing", name] = self._view(column.missing, "|b1") if column.missing else np.zeros(len(self), bool)
        out["objects",] = self.objects
        return out

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of the program; what is "n/a" there is missing.

        Of many poses ``query`` is the pose's id in its file or its number from 1, and a pose without an answer has one
        row of kind "error", whose name is the reason. Of one there is no such column.
        """
        import pandas

        frame = frame_of(self.arrays())
        if not self._many:
            return frame
        pose = np.repeat(np.arange(len(self.starts) - 1), np.diff(self.starts))
        queries = queries_of(self._many[1], len(self.starts) - 1)
        return with_errors(pandas.DataFrame(of_poses(queries, pose)).join(frame), pose, queries, self.errors)

    def matrix(self, of: str = "streamlines") -> pandas.DataFrame:
        """Of :meth:`Atlas.connectivity`: areas by areas, under their names, as ``--connectivity`` writes them.

        Parameters
        ----------
        of
            "streamlines": how many connect two areas, on the diagonal with both ends in one; or "mean_length_mm",
            NaN where there are none.
        """
        import pandas

        choice("of", of, ("streamlines", "mean_length_mm"))
        pairs, names = self.part("pairs"), self.part("areas")["name"]
        if len(names) > _MOST_AREAS:
            raise UnsupportedError(f"areas: {len(names)} of them, a matrix has up to {_MOST_AREAS}; pairs has all")
        values, a, b = pairs[of], pairs["area_a"], pairs["area_b"]
        out = np.full(2 * (len(names),), np.nan if values.dtype.kind == "f" else 0, values.dtype)
        out[a, b] = out[b, a] = values
        return pandas.DataFrame(out, names, names)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())


def ask_table(function: Any, *question: Any) -> Table:
    """The table that a function of the library makes."""
    out = ffi.new("conus_table **")
    check(function(out, *question))
    return Table(out[0])


def choices(what: bytes) -> list[str]:
    """The words that an option takes."""
    return list(ask_table(lib.conus_list_choices, what)["name"])
