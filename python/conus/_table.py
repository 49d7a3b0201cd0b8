# SPDX-License-Identifier: BSD-3-Clause
"""Answers of studies: rows in typed columns."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._conus import ffi, lib
from ._library import Bound, check, owned, text

if TYPE_CHECKING:
    import pandas

Array = np.ndarray[Any, Any]


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


class Table(Bound):
    """Rows in typed columns: ``table["distance_mm"]``; ``len()`` counts the rows, ``columns`` names the columns.

    Columns and values are those of the program, without ``query``. Positions are in the space of the selector that
    was asked. Numbers and counts are read-only views, which stay valid when table, selector and atlas are gone.
    """

    columns: tuple[str, ...]

    def __init__(self, pointer: Any, whole: Any = None) -> None:
        self._p = owned(pointer, (lambda _: None) if whole else lib.conus_table_destroy, whole)
        found = [lib.conus_table_column(self._p, i) for i in range(lib.conus_table_columns(self._p))]
        self._columns = {text(column.name): column for column in found}
        self.columns = tuple(self._columns)
        self.objects = self._view(lib.conus_table_objects(self._p), "<u4")  #: numbers in the atlas; 0 = none

    def _view(self, pointer: Any, kind: str) -> Array:
        return np.asarray(_Lent(self._p, pointer, len(self), kind)) if len(self) else np.empty(0, kind)

    def __len__(self) -> int:
        return int(lib.conus_table_rows(self._p))

    def __repr__(self) -> str:
        return f"<conus.Table: {len(self)} rows of {', '.join(self.columns)}>"

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
        if column.type == lib.CONUS_TYPE_NUMBER:
            return self._view(column.numbers, "<f8")
        if column.type == lib.CONUS_TYPE_COUNT:
            return self._view(column.counts, "<i8")
        return np.asarray(self._words(column)[self._view(column.codes, "<u4")])

    def arrays(self) -> dict[Any, Array]:
        """The columns by their names; as "missing" and a name where a count is n/a; and the objects."""
        out: dict[Any, Array] = {name: self[name] for name in self.columns}
        for name, column in self._columns.items():
            if column.type == lib.CONUS_TYPE_COUNT:
                out["missing", name] = self._view(column.missing, "|b1") if column.missing else np.zeros(len(self), bool)
        out["objects",] = self.objects
        return out

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of the program, without the column ``query``; what is "n/a" there is missing."""
        return frame_of(self.arrays())

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
