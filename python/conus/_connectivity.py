# SPDX-License-Identifier: BSD-3-Clause
"""Which areas the streamlines of bundles connect, as tables."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._library import ArgumentError, UnsupportedError, choice, real
from ._table import Table

if TYPE_CHECKING:
    import pandas


_MOST = 8192  # as of conus_report_matrix()


def radius_of(radius: float) -> float:
    """The library's, where 0 is the default, and none is below that."""
    radius = real("radius", radius)
    if not 0 <= radius <= 100:
        raise ArgumentError(f"radius: {radius:g} mm round an end, allowed are 0 to 100")
    return radius if radius > 0 else -1


class Connectivity(Table):
    """Which areas streamlines connect: a row for each bundle and pair of areas.

    ``pairs`` has the streamlines of all bundles together, each once, and ``areas`` those that a matrix has: all with
    voxels or triangles, or, of an atlas loaded with ``only``, its areas in that order, so that tables of several
    subjects have one size; the last row is that of ends in no area. ``pairs["area_a"]`` and ``pairs["area_b"]`` are
    rows of ``areas``.
    """

    def __init__(self, pointer: Any) -> None:
        super().__init__(pointer)
        self.pairs, self.areas = self.part("pairs"), self.part("areas")

    def matrix(self, of: str = "streamlines") -> pandas.DataFrame:
        """Areas by areas, under their names: the table of ``--connectivity``.

        Parameters
        ----------
        of
            "streamlines": how many connect two areas, on the diagonal with both ends in one; or "mean_length_mm",
            NaN where there are none.
        """
        import pandas

        choice("of", of, ("streamlines", "mean_length_mm"))
        values, names = self.pairs[of], self.areas["name"]
        if len(names) > _MOST:
            raise UnsupportedError(f"areas: {len(names)} of them, a matrix has up to {_MOST}; pairs has all")
        out = np.full(2 * (len(names),), np.nan if values.dtype.kind == "f" else 0, values.dtype)
        a, b = self.pairs["area_a"], self.pairs["area_b"]
        out[a, b] = out[b, a] = values
        return pandas.DataFrame(out, names, names)
