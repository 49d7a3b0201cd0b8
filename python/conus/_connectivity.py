# SPDX-License-Identifier: BSD-3-Clause
"""Which areas the streamlines of bundles connect, as arrays and tables."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._answers import Array
from ._conus import ffi, lib
from ._library import ArgumentError, array_of, check, dtype_of, owned, real

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas

CONNECTION = dtype_of("conus_connection")


def options_of(radius: float) -> Any:
    """A conus_connectivity_options; its 0 is the default, and none is below that."""
    radius = real("radius", radius)
    if not 0 <= radius <= 100:
        raise ArgumentError(f"radius: {radius:g} mm round an end, allowed are 0 to 100")
    options = ffi.new("conus_connectivity_options *")
    options.radius = radius if radius > 0 else -1
    return options


class Connectivity:
    """Which areas streamlines connect.

    ``records`` has the connections of each bundle and ``pairs`` those of all bundles together, each
    streamline once, as the library's own records: numbers of objects (0 = unassigned), counts, lengths in mm.
    ``areas`` has the numbers of the areas of ``streamlines`` and ``lengths_mm``, which are symmetric tables
    of areas by areas: how many connect them, and their mean length, NaN where there are none. They have all areas
    with voxels or triangles, or, of an atlas loaded with ``only``, its areas in that order: tables of several
    subjects have one size.
    """

    def __init__(self, atlas: Atlas, pointer: Any) -> None:
        self.atlas = atlas
        found = owned(pointer, lib.conus_connectivity_destroy)
        count, pairs = lib.conus_connectivity_count(found), lib.conus_connectivity_pair_count(found)
        self.records: Array = array_of(lib.conus_connectivity_connection(found, 0), count, CONNECTION)
        self.pairs: Array = array_of(lib.conus_connectivity_pair(found, 0), pairs, CONNECTION)
        self._p = found

    def _matrix(self) -> Any:
        out = ffi.new("conus_connection_matrix *")
        check(lib.conus_connectivity_matrix(out, self._p))
        return out

    @property
    def areas(self) -> Array:
        """(n,) numbers of the areas of the tables, ascending or in the order of ``only``; 0, ends in no area, is last."""
        matrix = self._matrix()
        return array_of(matrix.areas, matrix.count, np.dtype("u4")).copy()

    def _table(self, name: str, dtype: str) -> Array:
        matrix = self._matrix()
        return array_of(getattr(matrix, name), matrix.count**2, np.dtype(dtype)).reshape(2 * (matrix.count,)).copy()

    @property
    def streamlines(self) -> Array:
        """(n, n) how many streamlines connect two areas; on the diagonal both ends are in one."""
        return self._table("streamlines", "u8")

    @property
    def lengths_mm(self) -> Array:
        """(n, n) their mean length."""
        return self._table("length", "f8")

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        return f"<conus.Connectivity: {len(self)} connections, {self.pairs['streamlines'].sum()} streamlines>"

    def to_dataframe(self) -> pandas.DataFrame:
        """The rows of ``conus connect`` or ``--endpoints``, under the names of their columns."""
        import pandas

        objects, records = self.atlas.objects, self.records
        label = pandas.array(objects.labels, dtype="UInt32")
        label[0] = pandas.NA
        return pandas.DataFrame({
            "kind": np.full(len(self), "bundle", object),
            "bundle": objects.names[records["bundle"]],
            "end_a": objects.names[records["area_a"]],
            "end_b": objects.names[records["area_b"]],
            "streamlines": records["streamlines"],
            "fraction": records["fraction"],
            "mean_length_mm": records["length"],
            "bundle_index": objects.labels[records["bundle"]],
            "end_a_index": label[records["area_a"]],
            "end_b_index": label[records["area_b"]],
        })

    def matrix(self) -> pandas.DataFrame:
        """``streamlines`` under the areas' names: the table of ``--connectivity``."""
        import pandas

        names = self.atlas.objects.names[self.areas]
        return pandas.DataFrame(self.streamlines, names, names)

    def _repr_html_(self) -> str:
        return str(self.to_dataframe()._repr_html_())
