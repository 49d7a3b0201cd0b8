# SPDX-License-Identifier: BSD-3-Clause
"""Names of areas for nilearn's table of clusters.

nilearn and its pandas are the user's; nothing else of conus needs them.
"""
from __future__ import annotations

import logging
from typing import Any, Sequence

import numpy as np

from ._atlas import Atlas, load
from ._library import ArgumentError, DataError

_NONE = "none"
_log = logging.getLogger("conus")


def name_clusters(table: Any, label_maps: Sequence[Any], atlas: Any, *, least: float = 0.05) -> Any:
    """The table with two columns more: what is at each peak, and which areas each cluster covers.

    >>> table, label_maps = get_clusters_table(image, 3.1, return_label_maps=True)  # doctest: +SKIP
    >>> conus.nilearn.name_clusters(table, label_maps, "aal")  # doctest: +SKIP

    Parameters
    ----------
    table, label_maps
        What ``nilearn.reporting.get_clusters_table()`` gives with ``return_label_maps=True``, in the atlas's space.
    atlas
        An :class:`Atlas`, or what :func:`load` takes.
    least
        Smallest share of a cluster that is listed.

    Returns
    -------
    pandas.DataFrame
        A copy with ``Peak Area``: the areas that hold the peak, or "none"; and in rows of clusters ``Cluster Areas``:
        "66.1 % Insula_L; 21.0 % none", by volume, measured on the cluster's own grid against the atlas's, and
        what is in none, last. Areas of probabilities may overlap.

    Raises
    ------
    ArgumentError
        For a table of surfaces, which has no X, Y, Z.
    DataError
        Where no map has a cluster at a peak: the maps are not of this table.
    """
    if "X" not in table:
        raise ArgumentError("table: has no X, Y, Z; the clusters of a surface have names by their vertices alone")
    maps = [label_maps] if hasattr(label_maps, "affine") else list(label_maps)
    asked = atlas if isinstance(atlas, Atlas) else load(atlas)
    _warn_of_space(maps, asked)
    peaks, clusters = [], []
    for _, row in table.iterrows():
        peak = np.array([float(row[axis]) for axis in "XYZ"])
        here = [hit.name for hit in asked.near(peak) if hit.kind == "area" and hit.distance_mm == 0]
        peaks.append("; ".join(here) or _NONE)
        is_cluster = row["Cluster Size (mm3)"] != ""  # which a subpeak has not
        clusters.append(_shares(asked, _cluster_at(maps, peak), least) if is_cluster else "")
    return table.assign(**{"Peak Area": peaks, "Cluster Areas": clusters})


def _warn_of_space(maps: Sequence[Any], atlas: Atlas) -> None:
    """As far as the grid of the maps says whose brain they are of."""
    brains = {load(np.ones(image.shape[:3], np.uint8), image.affine, labels={1: "1"}).brain for image in maps}
    for brain in brains - {"unknown", atlas.brain} if atlas.brain != "unknown" else ():
        _log.warning("label_maps: their grid is that of %s, and the atlas is of %s: areas lie elsewhere there, by some mm",
                     brain, atlas.brain)


def _cluster_at(maps: Sequence[Any], peak: Any) -> tuple[Any, Any]:
    """The cluster of a peak, a mask and its affine. Its ID does not say which: in two-sided tables the IDs of negative
    clusters also count the subpeaks before them, and a sign without clusters has no map (nilearn 0.14)."""
    for image in maps:
        labels = np.asarray(image.dataobj)
        voxel = np.rint(np.linalg.solve(image.affine, [*peak, 1])[:3]).astype(int)
        is_inside = np.all(voxel >= 0) and np.all(voxel < labels.shape[:3])
        if is_inside and labels[tuple(voxel)]:
            return (labels == labels[tuple(voxel)]).astype(np.uint8), image.affine
    raise DataError(f"label_maps: none has a cluster at the peak {peak.tolist()}; are they of this table?")


def _shares(atlas: Atlas, cluster: tuple[Any, Any], least: float) -> str:
    rows = atlas.overlap(cluster)
    words = [
        f"{100 * share:.1f} % {_NONE if kind == 'unassigned' else name}"
        for kind, name, share in zip(rows["kind"], rows["name"], rows["region_fraction"])
        if kind in ("area", "unassigned") and share >= least
    ]
    return "; ".join(words) or _NONE
