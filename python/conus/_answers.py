# SPDX-License-Identifier: BSD-3-Clause
"""The answers: selections and answers to many poses, as arrays and tables."""
from __future__ import annotations

import html
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator, Optional, Sequence, Union, overload

import numpy as np

from ._conus import ffi, lib
from ._library import (
    RESULT, STEP, Bound, Error, array_of, check, choice, owned, path_of, text, utf8, whole,
)

if TYPE_CHECKING:
    import pandas
    from ._atlas import Atlas, Selector
    from ._space import Space
    from ._table import Table

Array = np.ndarray[Any, Any]
_KINDS = np.array(["error", "area", "pathway", "unassigned", "bundle"], object)


def _own_frame(atlas: Any) -> Optional[Array]:
    """From world mm to the atlas's own space; None where that is the world."""
    matrix, out = np.eye(4), ffi.new("double[3]")
    for column, point in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0))):
        lib.conus_atlas_own_point(out, atlas, point)
        matrix[:3, column] = list(out)
    matrix[:3, :3] -= matrix[:3, 3:]
    return None if np.array_equal(matrix, np.eye(4)) else matrix


def _own_points(atlas: Atlas, points: Array) -> Optional[Array]:
    """Where world points are in the atlas's own space; None where that is the world."""
    if atlas.objects.is_warped:
        own = np.ascontiguousarray(points, np.float64).copy()
        start = ffi.cast("double *", ffi.from_buffer(own))
        for i in range(len(own)):
            lib.conus_atlas_own_point(start + 3 * i, atlas._p, start + 3 * i)
        return own
    matrix = atlas.objects.own_from_world
    return None if matrix is None else points @ matrix[:3, :3].T + matrix[:3, 3]


def kind_word(kind: int) -> str:
    return str(_KINDS[kind])


class Objects:
    """Names and sRGB colours of an atlas's objects, by their numbers; entry 0 is "unassigned"."""

    def __init__(self, atlas: Any) -> None:
        count = lib.conus_atlas_object_count(atlas)
        objects = [lib.conus_atlas_object(atlas, i) for i in range(1, count + 1)]
        self.names = np.array(["unassigned"] + [text(o.name) for o in objects], object)
        self.abbreviations = np.array([""] + [text(o.abbreviation) for o in objects], object)
        self.labels = np.array([0] + [o.label for o in objects], np.uint32)
        self.colours = np.array([[0xBB] * 3] + [list(o.rgb) for o in objects], np.uint8)
        shown = (o for i, o in enumerate(objects, 1) if not lib.conus_atlas_is_hidden(atlas, i))
        self.has_bundles = any(o.kind == lib.CONUS_KIND_BUNDLE for o in shown)
        self.is_warped = bool(lib.conus_atlas_is_warped(atlas))
        self.own_from_world = None if self.is_warped else _own_frame(atlas)

    def name(self, number: int) -> Optional[str]:
        """The name of an object; None for 0."""
        return str(self.names[number]) if number else None


def _categories(values: Array, codes: Array) -> Any:
    """Texts of the records; "" is missing."""
    import pandas

    unique, inverse = np.unique(values.astype(str), return_inverse=True)
    if unique[0] == "":
        unique, inverse = unique[1:], inverse - 1
    return pandas.Categorical.from_codes(inverse[codes], unique)


def counts(values: Array, missing: Array) -> Any:
    """Whole numbers, some of which are n/a."""
    import pandas

    return pandas.arrays.IntegerArray(np.array(values), np.array(missing))


def _finite(values: Array) -> Array:
    return np.where(np.isfinite(values), values, np.nan)


def identity_of(objects: Objects, records: Array, rank: Optional[Array] = None) -> dict[str, Any]:
    """The columns that say what each record is about, and its rank if it has one."""
    number = records["object"]
    columns = {
        "kind": _categories(_KINDS, records["kind"]),
        "index": counts(objects.labels[number], number == 0),
        "name": _categories(objects.names, number),
        "abbreviation": _categories(objects.abbreviations, number),
    }
    return columns if rank is None else {**columns, "rank": counts(rank, number == 0)}


def points_of(prefix: str, points: Array, space: Optional[Space]) -> dict[str, Array]:
    """Three columns of (n, 3) points in the world."""
    points = space.from_world(points) if space else points
    return {f"{prefix}{axis}": points[:, i] for i, axis in enumerate("xyz")}


def own_points_of(atlas: Atlas, prefix: str, points: Array, space: Optional[Space]) -> dict[str, Array]:
    """The same in the atlas's own space; no columns where that is the world."""
    own = _own_points(atlas, points)
    return {} if own is None else points_of(prefix, points if space and space.is_own else own, space)


def with_errors(
    frame: pandas.DataFrame, pose: Array, queries: dict[str, Array], errors: dict[int, str]
) -> pandas.DataFrame:
    """Rows of many poses, and one of kind "error" for each pose without an answer, whose name is the reason.

    ``pose`` is the index of the pose of each row, ``queries`` has the columns of each pose.
    """
    import pandas

    if not errors:
        return frame
    failed = pandas.DataFrame(of_poses(queries, list(errors)))
    failed["kind"], failed["name"] = "error", list(errors.values())
    for column in ("kind", "name"):
        frame[column] = frame[column].astype(object)
    order = np.argsort(np.concatenate([pose, list(errors)]), kind="stable")
    return pandas.concat([frame, failed]).iloc[order].reset_index(drop=True)


def queries_of(names: Optional[dict[str, Array]], count: int) -> dict[str, Array]:
    """The columns that say which pose it is: query, its id in a file or its number from 1, and what marks it."""
    return {"query": np.arange(1, count + 1)} if names is None else names


def of_poses(queries: dict[str, Array], pose: Any) -> dict[str, Array]:
    """These columns of rows about these poses."""
    return {name: values[pose] for name, values in queries.items()}


def _ordered(results: Array, query: Array, order: str, by_entry: bool) -> Array:
    """The rows of a table, of results in the order of their ranks, the unassigned last, for each query."""
    if not choice("order", order, ("rank", "depth")):
        return results
    depth = results["entry" if by_entry else "distance"]
    places = np.lexsort((np.where(np.isfinite(depth), depth, np.inf), results["object"] == 0, query))
    return np.asarray(results[places])


def _columns(
    atlas: Atlas, results: Array, layers: bool, space: Optional[Space], weights: Sequence[str],
    has_doses: bool = False
) -> dict[str, Any]:
    """The columns of ``conus query``, of results; what is n/a there is missing."""
    unassigned = results["object"] == 0
    columns = identity_of(atlas.objects, results, results["rank"])
    for name in ("score", "pixels", "share"):
        columns[name] = results[name]
    columns["pierced"] = counts(results["pierced"], unassigned) if layers else np.nan
    columns["center_px"] = _finite(results["centre_px"])
    columns["offset_deg"] = _finite(results["offset"])
    columns["distance_mm"] = _finite(results["distance"])
    columns.update(points_of("contact_", results["contact"], space))
    columns.update(own_points_of(atlas, "atlas_", results["contact"], space))
    for name, member in (("entry_mm", "entry"), ("exit_mm", "exit"), ("path_mm", "path"), ("volume_mm3", "volume"),
                         ("fraction", "fraction"), ("mean_value", "mean_value"), ("max_value", "max_value")):
        columns[name] = _finite(results[member]) if layers else np.nan
    if layers:
        for name in ("voxels", "cone_fraction", "sum_value"):
            columns[name] = results[name]
        columns.update(points_of("centroid_", results["centroid"], space))
        with np.errstate(invalid="ignore"):
            columns["unoccluded"] = results["pixels"] / np.where(results["pierced"], results["pierced"], np.nan)
        if atlas.objects.has_bundles:
            columns.update(_bundle_columns(results, space))
    columns.update({name: results[name] for name in weights})
    if weights and (layers or has_doses):
        doses = ("dose", "dose_share", "mean_weight", "max_weight")
        columns.update({name: results[name] for name in doses})
        columns.update(points_of("max_", results["max_at"], space))
        columns.update({name: results[name] for name in ("above", "above_share", "value_dose")})
    columns["contact_value"] = results["contact_value"]
    return columns


def _of_points(columns: dict[str, Any], results: Array, points: Array, radius: float, space: Optional[Space]) -> None:
    """What no ray looks for is missing, and volumes are not where there is no radius; which point each row is about."""
    none = np.ones(len(results), bool)
    columns.update({name: counts(results[name], none) for name in ("pixels", "pierced")})
    if radius == 0 and "voxels" in columns:
        columns["voxels"] = counts(results["voxels"], none)
    for name, member in (("volume_mm3", "volume"), ("fraction", "fraction"), ("mean_value", "mean_value"),
                         ("max_value", "max_value")):
        columns[name] = _finite(results[member])
    columns.update(points_of("", points, space))


def _bundle_columns(results: Array, space: Optional[Space]) -> dict[str, Any]:
    """Number of streamlines."""
    others = results["kind"] != lib.CONUS_KIND_BUNDLE
    columns = {name: counts(results[name], others) for name in ("streamlines", "streamlines_total")}
    columns["length_mm"] = results["length"]
    columns.update(points_of("near_", results["near"], space))
    columns["along"] = results["along"]
    return columns


def _step_columns(steps: Array, results: Array) -> dict[str, Any]:
    """The columns that `conus track` adds, of the step of each result."""
    number = results["object"]
    columns = {"time_s": steps["time_s"]}
    for name in ("selected", "confirmed"):
        columns[name] = (number == steps[name]) & (number > 0)
    return columns


@dataclass(frozen=True)
class Step:
    """Where a selection stands in its track."""

    time_s: float
    selected: Optional[str]  #: the first by rank of what is in the cone or has a score from before
    confirmed: Optional[str]  #: what the trigger, pressed at this step, confirms


@dataclass(frozen=True)
class Hit:
    """One object in the cone, or last of all what hit nothing ("unassigned")."""

    name: str
    kind: str  #: "area", "pathway", "bundle" or "unassigned"
    index: int  #: the atlas's own label; 0 of unassigned
    rank: int  #: from 1; 0 of unassigned
    score: float  #: by which it is ranked; higher is better
    share: float  #: of the cone's solid angle; all shares sum to 1
    pixels: int  #: that hit it first
    distance_mm: float  #: from the device to its nearest hit
    contact: tuple[float, float, float]  #: where, RAS mm or in the selector's space
    contact_value: float  #: value there of a pathway, or probability of an area of probabilities; else NaN


class Streamlines(Bound):
    """Streamlines of an atlas: a sequence of arrays (points, 3) of float32, RAS mm."""

    numbers: Array  #: of each one in its tractogram, from 0, ascending
    tractograms: Array  #: of which tractogram of the atlas each one is, from 0

    def __init__(self, pointer: Any, atlas: Atlas) -> None:
        self._p = owned(pointer, lib.conus_streamline_list_destroy, atlas._p)
        view = lib.conus_streamline_list_data(self._p)
        self.numbers = array_of(view.number, view.count, np.dtype("u4"))
        self.tractograms = array_of(view.tractogram, view.count, np.dtype("u4"))
        self._points = np.empty((view.points, 3), np.float32)
        self._first = np.empty(view.count + 1, np.uint64)
        lib.conus_streamline_list_points(
            ffi.from_buffer("float[]", self._points), ffi.from_buffer("uint64_t[]", self._first), self._p
        )

    def __len__(self) -> int:
        return len(self.numbers)

    def __getitem__(self, index: int) -> Array:
        index = range(len(self))[index]
        return np.asarray(self._points[self._first[index] : self._first[index + 1]])

    def save(self, path: Any) -> None:
        """Writes a tractogram of MRtrix; the name ends in .tck."""
        check(lib.conus_streamline_list_write(self._p, path_of("path", path)))


class Selection(Bound):
    """The answer to one pose: a sequence of :class:`Hit`, best first; "unassigned" is the last.

    ``results`` is the same as an array of the library's records (angles in degrees, lengths in mm,
    positions always in RAS mm).
    """

    space: Optional[Space] = None  #: of positions in hits and tables; None = RAS mm
    _point: Optional[Array] = None  # the point of :meth:`Selector.near`
    _asked: Optional[tuple[Any, Any, float]] = None  # the pose of one cone, its target if given, and its angle

    def __init__(self, selector: Selector, pointer: Any) -> None:
        atlas = selector.atlas
        self.atlas = atlas
        self._selector = selector
        self._layers = selector._layers
        self._p = owned(pointer, lib.conus_selection_destroy, atlas._p)
        self.results: Array = array_of(
            lib.conus_selection_result(self._p, 0), lib.conus_selection_count(self._p), RESULT
        )
        step = lib.conus_selection_step(self._p)
        self._steps: Array = array_of(step, 1 if step else 0, STEP)

    @property
    def step(self) -> Optional[Step]:
        """Where a selection of a :class:`Tracker` stands in its track; None of another."""
        if not len(self._steps):
            return None
        time_s, *numbers = self._steps[0]
        return Step(float(time_s), *map(self.atlas.objects.name, numbers))

    def __len__(self) -> int:
        return len(self.results)

    @overload
    def __getitem__(self, index: int) -> Hit: ...
    @overload
    def __getitem__(self, index: slice) -> list[Hit]: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Hit, list[Hit]]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        record = self.results[index]
        objects = self.atlas.objects
        contact = self.space.from_world(record["contact"]) if self.space else record["contact"]
        number = record["object"]
        return Hit(
            objects.names[number],
            _KINDS[record["kind"]],
            int(objects.labels[number]),
            int(record["rank"]),
            float(record["score"]),
            float(record["share"]),
            int(record["pixels"]),
            float(record["distance"]),
            (float(contact[0]), float(contact[1]), float(contact[2])),
            float(record["contact_value"]),
        )

    def __iter__(self) -> Iterator[Hit]:
        return (self[i] for i in range(len(self)))

    def __repr__(self) -> str:
        hits = ", ".join(f"{hit.name} {100 * hit.share:.1f} %" for hit in self[:3])
        return f"<conus.Selection: {hits}{', ...' if len(self) > 3 else ''}>"

    def to_dataframe(self, *, order: str = "rank") -> pandas.DataFrame:
        """The rows of ``conus query`` (of a tracker ``conus track``), without the column ``query``.

        Columns and values are those of the program; what is "n/a" there is missing.

        Parameters
        ----------
        order
            "rank", or "depth": the nearest first, with all layers by ``entry_mm``, else by ``distance_mm``.
        """
        import pandas

        is_ball = lib.conus_selection_evidence(self._p).resolution == 0
        results = _ordered(self.results, np.zeros(len(self)), order, self._layers and not is_ball)
        columns = _columns(self.atlas, results, self._layers or is_ball, self.space, self._selector._weights)
        if is_ball:
            points = np.repeat([self._point], len(self), 0)
            _of_points(columns, results, points, lib.conus_selection_ball(self._p), self.space)
        if len(self._steps):
            columns.update(_step_columns(self._steps.repeat(len(self)), results))
        return pandas.DataFrame(columns)

    def endpoints(self, radius: float = 2.0) -> Table:
        """Which areas the streamlines in the cone or ball connect: ``conus query --endpoints``.

        Parameters
        ----------
        radius
            mm, up to 100: an end in no area has the nearest one within it.
        """
        return self._selector.connectivity(radius, self)

    def mask(self, of: str = "areas", name: str | None = None) -> Any:
        """The voxels in the cone as a nibabel image on the atlas's grid.

        Parameters
        ----------
        of
            "areas" and "region" (background, too): 1 within; "labels": the label of each voxel's
            area; "values": of a pathway.
        name
            Only this object and those below it in the area tree.

        Returns
        -------
        nibabel.Nifti1Image
            0 outside.
        """
        import nibabel

        options = ffi.new("conus_grid_options *")
        options.content = choice("of", of, ("areas", "region", "labels", "values"))
        options.object = self.atlas.find(name) if name is not None else 0
        out = ffi.new("conus_grid **")
        check(lib.conus_selection_grid(out, self._p, options))
        grid = owned(out[0], lib.conus_grid_destroy)
        view = lib.conus_grid_data(grid)
        data = array_of(view.data, view.count, np.dtype(("u1", "u2", "u4", "f4")[view.number]))
        affine = np.array(list(view.world_from_voxel)).reshape(4, 4, order="F")
        image = nibabel.Nifti1Image(data.reshape(list(view.dim), order="F"), affine)
        if view.space_code:
            image.set_sform(affine, view.space_code)
            image.set_qform(affine, view.space_code)
        return image

    def streamlines(self, name: str | None = None) -> Streamlines:
        """The streamlines that come into the cone or ball, whole ones.

        Parameters
        ----------
        name
            Only those of this bundle; None is all bundles.
        """
        out = ffi.new("conus_streamline_list **")
        check(lib.conus_selection_streamlines(out, self._p, self.atlas.find(name) if name is not None else 0))
        return Streamlines(out[0], self.atlas)

    def image(self, channel: str = "object") -> Array:
        """A channel of the picture that the device sees.

        Parameters
        ----------
        channel
            "id" (the atlas's own label), "object" (its number), "X", "Y", "Z" (of the hit, RAS mm) or
            "t" (its distance, mm).

        Returns
        -------
        numpy.ndarray
            (n, n), top row first. Where a ray hits nothing, 0, NaN or, of "t", infinity.

        Raises
        ------
        KeyError
            For another channel.
        """
        out = ffi.new("conus_image **")
        check(lib.conus_selection_image(out, self._p))
        image = owned(out[0], lib.conus_image_destroy)
        return image_channel(image, channel)

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{hit.rank or ''}<td>{html.escape(hit.name)}<td>{hit.index or ''}"
            f"<td>{100 * hit.share:.2f} %<td>{hit.pixels}<td>{hit.distance_mm:.2f}</tr>"
            if hit.rank
            else f"<tr><td><td>(nothing hit)<td><td>{100 * hit.share:.2f} %<td>{hit.pixels}<td></tr>"
            for hit in self
        )
        heads = "".join(f"<th>{head}" for head in ("rank", "name", "label", "share of cone", "pixels", "nearest, mm"))
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{rows}</tbody></table>"

    def to_html(self, *, height: int = 720) -> str:
        """A web page of the question with the atlas inside, as an HTML element: whoever sees it moves the cone.

        ``IPython.display.HTML(hits.to_html())`` shows it in Jupyter. A page has the options ``layers`` and
        ``resolution`` and an atlas from files as they are. Of another question, and where the page's template is
        not installed, it is the table that a notebook shows, with the reason below. Runs the program, as
        :func:`conus.page` does.
        """
        from ._program import page_of

        try:
            page = page_of(self)
        except Error as error:
            return f"{self._repr_html_()}<p>No page: {html.escape(str(error))}</p>"
        return (f'<div><iframe title="conus: which areas are in this cone?" srcdoc="{html.escape(page)}" '
                f'style="width: 100%; height: {whole("height", height)}px; border: 0"></iframe></div>')

    def _repr_png_(self) -> bytes:
        out = ffi.new("conus_image **")
        check(lib.conus_selection_image(out, self._p))
        return image_bytes(owned(out[0], lib.conus_image_destroy))

    def plot(self, axes: Any = None) -> Any:
        """Bars of the shares in the areas' colours, by matplotlib; gives the axes."""
        import matplotlib.pyplot as pyplot

        axes = axes or pyplot.gca()
        records = self.results[self.results["share"] > 0][::-1]
        objects, number = self.atlas.objects, records["object"]
        axes.barh(objects.names[number], 100 * records["share"], color=objects.colours[number] / 255)
        axes.set_xlabel("share of the cone, %")
        return axes


def image_channel(image: Any, channel: str) -> Array:
    """A copy of a channel, top row first."""
    shape = (lib.conus_image_height(image), lib.conus_image_width(image))
    for get, dtype in ((lib.conus_image_floats, "f4"), (lib.conus_image_uints, "u4")):
        pixels = get(image, utf8("channel", channel))
        if pixels:
            return array_of(pixels, shape[0] * shape[1], np.dtype(dtype)).reshape(shape)
    raise KeyError(channel)


def image_bytes(image: Any, format: str = "png") -> bytes:
    """The picture as the bytes of a file."""
    data, size = ffi.new("uint8_t **"), ffi.new("size_t *")
    check(lib.conus_image_encode(ffi.cast("const uint8_t **", data), size, image, format.encode()))
    return bytes(ffi.buffer(data[0], size[0]))


class Answers:
    """The answers to many poses.

    ``results[starts[i]:starts[i + 1]]`` are the library's records of pose ``i``, best first, with
    "unassigned" as the last. ``errors`` has the reason for each pose that has no answer, by its
    index.
    """

    space: Optional[Space] = None  #: of positions in tables; None = RAS mm

    def __init__(self, atlas: Atlas, results: Array, starts: Array, errors: dict[int, str], layers: bool,
                 names: Optional[dict[str, Array]] = None, weights: Sequence[str] = ()) -> None:
        self._points: Optional[tuple[Array, float]] = None  # of :meth:`Selector.near_many`, with the radius
        self.atlas = atlas
        self.results = results
        self.starts = starts
        self.errors = errors
        self._layers = layers
        self._weights = weights
        self._queries = queries_of(names, len(starts) - 1)

    def __len__(self) -> int:
        return len(self.starts) - 1

    def __getitem__(self, index: int) -> Array:
        index = range(len(self))[index]
        return self.results[self.starts[index] : self.starts[index + 1]]

    def __repr__(self) -> str:
        return f"<conus.Answers to {len(self)} poses: {len(self.results)} results, {len(self.errors)} errors>"

    def _rows(self, order: str) -> tuple[Array, Array]:
        """The pose of each row, and its record."""
        query = np.repeat(np.arange(len(self)), np.diff(self.starts))
        return query, _ordered(self.results, query, order, self._layers)

    def to_dataframe(self, *, order: str = "rank") -> pandas.DataFrame:
        """The rows of ``conus batch``: its columns and values, what is "n/a" there is missing.

        ``query`` is the pose's id in its file, or else its number from 1, though indices count from 0: pose ``i`` is
        query ``i + 1``. A pose without an answer has one row of kind "error", whose name is the reason.

        Parameters
        ----------
        order
            Order of the rows of each pose, as for :meth:`Selection.to_dataframe`.
        """
        import pandas

        query, results = self._rows(order)
        columns = {**of_poses(self._queries, query),
                   **_columns(self.atlas, results, self._layers, self.space, self._weights, self._points is not None)}
        if self._points:
            _of_points(columns, results, self._points[0][query], self._points[1], self.space)
        return with_errors(pandas.DataFrame(columns, copy=False), query, self._queries, self.errors)


class Track(Answers):
    """The answers to the steps of a moving device.

    ``steps[i]`` is the library's record of step ``i``: its time, and the numbers of the objects that
    are selected and confirmed (0 = none). A step without an answer is in ``errors``.
    """

    def __init__(
        self, atlas: Atlas, results: Array, starts: Array, errors: dict[int, str], layers: bool, steps: Array,
        names: Optional[dict[str, Array]] = None,
    ) -> None:
        super().__init__(atlas, results, starts, errors, layers, names)
        self.steps = steps

    def __repr__(self) -> str:
        return f"<conus.Track of {len(self)} steps: {len(self.results)} results, {len(self.errors)} errors>"

    @property
    def selected(self) -> Array:
        """The name of what is selected at each step, None where nothing is."""
        names = self.atlas.objects.names.copy()
        names[0] = None
        return np.asarray(names[self.steps["selected"]])

    def to_dataframe(self, selected: bool = False, *, order: str = "rank") -> pandas.DataFrame:
        """The rows of ``conus track``: its columns and values, as :meth:`Answers.to_dataframe`.

        Parameters
        ----------
        selected
            Only the rows of each step's selected and confirmed objects; where there is none, the row
            "unassigned".
        order
            Order of the rows of each step, as for :meth:`Selection.to_dataframe`.

        Returns
        -------
        pandas.DataFrame
            A step without an answer has no row: it is as a lost frame.
        """
        import pandas

        query, results = self._rows(order)
        steps = self.steps[query]
        columns = {**of_poses(self._queries, query), **_columns(self.atlas, results, self._layers, self.space, ())}
        frame = pandas.DataFrame({**columns, **_step_columns(steps, results)}, copy=False)
        if not selected:
            return frame
        nothing = (results["object"] == 0) & (steps["selected"] == 0) & (steps["confirmed"] == 0)
        return frame[frame["selected"] | frame["confirmed"] | nothing].reset_index(drop=True)
