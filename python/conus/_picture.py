# SPDX-License-Identifier: BSD-3-Clause
"""Pictures in space, which OpenGL draws, and what holds for all that uses OpenGL."""
from __future__ import annotations

import math
import os
import re
import threading
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Callable, Optional, Sequence, Union

import numpy as np

from ._answers import Array, Selection, image_bytes, image_channel
from ._conus import ffi, lib
from ._library import (
    ArgumentError,
    Bound,
    GLError,
    Guarded,
    after_fork,
    array_of,
    byte_count,
    check,
    choice,
    dtype_of,
    flag,
    numbers,
    owned,
    path_of,
    real,
    text,
    utf8,
    vector,
    whole,
)
from ._poses import pose_of
from ._table import choices

if TYPE_CHECKING:
    from ._atlas import Atlas, Path


# OpenGL


class _Process:
    """Whether OpenGL was used by this process, and by one that it was forked from."""

    used = False
    forked = False


def _note_fork() -> None:
    _Process.forked = _Process.forked or _Process.used


after_fork(_note_fork)


class GLOwner:
    """The thread that makes an object of OpenGL, or one that may be, and alone may use and end it."""

    def __init__(self, uses_gl: bool = True) -> None:
        self._thread = threading.get_ident()
        self._uses_gl = uses_gl
        self.check("")

    def check(self, name: str) -> None:
        """Comes before each use. Behind a fork the driver would wait for threads that are not there."""
        if threading.get_ident() != self._thread:
            raise ArgumentError(f"{name}: {'with OpenGL ' if self._uses_gl else ''}it belongs to the thread that made it")
        if not self._uses_gl:
            return
        if _Process.forked:
            raise GLError(
                "OpenGL was used before this process was forked, and does not cross a fork: "
                "use the method spawn of multiprocessing, or the rays engine"
            )
        _Process.used = True

    def ender(self, destroy: Callable[[Any], None]) -> Callable[[Any], None]:
        """Ends an object; elsewhere it does nothing."""
        thread = self._thread
        if not self._uses_gl:
            return destroy
        return lambda p: None if _Process.forked or threading.get_ident() != thread else destroy(p)


# Pictures

_SRGB = (np.arange(255) + 0.5) / 255
_STEPS = np.where(_SRGB <= 0.04045, _SRGB / 12.92, ((_SRGB + 0.055) / 1.055) ** 2.4).astype(np.float32)
_LEGEND_ROWS = 12  # as conus render
_POINT = dtype_of("conus_transfer_point")
_SIDES = ("cone", "left", "right", "front", "back", "top", "bottom", "beside", "across")
_STYLES = ("auto", "screen", "print")
_LEGENDS = ("auto", "right", "below", "none")
_PLANES = {"axial": ((1, 0, 0), (0, 1, 0)), "coronal": ((1, 0, 0), (0, 0, 1)), "sagittal": ((0, 1, 0), (0, 0, 1))}
_FAINT = 0.12  # opacity of what no probe passes, and of areas beside points


def _points_of(points: Any, groups: Any, radius: Any) -> Any:
    """An array of conus_drawn_point, and what it points to; None without points."""
    if not points:
        if groups is not None or radius is not None:
            raise ArgumentError("point_groups, point_radius: there are no points")
        return None
    if groups is not None and len(groups) != len(points):
        raise ArgumentError(f"point_groups: {len(groups)} for {len(points)} points")
    size = 0.0 if radius is None else real("point_radius", radius)
    names = [utf8("points", name) for name in points]
    texts = [utf8("point_groups", group) for group in groups] if groups is not None else [ffi.NULL] * len(names)
    rows = [(name, group, list(vector("points", at, 3)), [math.nan] * 3, size)
            for name, group, at in zip(names, texts, points.values())]
    return ffi.new("conus_drawn_point[]", rows), names, texts


class Picture(Guarded):
    """A picture of an atlas; a notebook shows it.

    Attributes
    ----------
    device : str
        The device that drew it, as OpenGL names it, or "rays".
    """

    def __init__(self, pointer: Any, device: str) -> None:
        self._p = owned(pointer, lib.conus_image_destroy)
        super().__init__()
        self.device = device

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        return int(lib.conus_image_width(self._p)), int(lib.conus_image_height(self._p))

    @property
    def channels(self) -> list[str]:
        """Names of the channels: R, G, B, A."""
        names: list[str] = []
        while name := lib.conus_image_channel(self._p, len(names)):
            names.append(text(name))
        return names

    def channel(self, name: str) -> Array:
        """(height, width) float32, top row first: linear light, as in an OpenEXR file."""
        return image_channel(self._p, name)

    @property
    def array(self) -> Array:
        """(height, width, 4) uint8, top row first: sRGB and opacity, the pixels of the PNG."""
        width, height = self.size
        rgba = np.zeros((height, width, 4), np.uint8)
        opacity = self.channel("A")
        shows = opacity > 0
        for i, name in enumerate("RGB"):
            rgba[shows, i] = np.searchsorted(_STEPS, self.channel(name)[shows] / opacity[shows], "right")
        rgba[..., 3] = np.rint(255 * np.minimum(opacity, 1))
        return rgba

    def save(self, path: Path) -> None:
        """Writes the picture.

        Parameters
        ----------
        path
            Ends in .png, or in .exr for linear light as float, or, of a picture with vectors=True, in .svg or .pdf.
            The file appears whole or not at all.

        Raises
        ------
        ArgumentError
            For another ending.
        FileError
            Where the system refuses.
        """
        check(lib.conus_image_write(self._p, path_of("path", path)))

    def _repr_png_(self) -> bytes:
        with self._lock:
            return image_bytes(self._p)

    def __repr__(self) -> str:
        return f"<conus.Picture of {self.size[0]} x {self.size[1]} pixels, by {self.device}>"


class Renderer(Bound):
    """An atlas made ready to be drawn again and again; :meth:`Atlas.render` draws one picture.

    It draws by OpenGL 4.5, in hardware or software, or by rays on all processors, and belongs to the thread that
    makes it.

    Parameters
    ----------
    atlas : Atlas
        The atlas that is drawn.
    transfer : str, path or array, optional
        Colours and opacities of the context by its values: a preset ("brain", "surface", ...; see
        :func:`transfer_presets`), a TF file, or (n, 5) points of value, sRGB, and opacity of 1 mm. Without
        it, what the manifest says, or "brain", and no context in space that opaque areas cover.
    max_memory : int
        Limit for textures and for a picture, bytes; 0 = 8 GiB.
    pathway_transfers : str, path or dict, optional
        Pathways are drawn as haze, by colours and opacities of their values: "own" (their colour), a preset,
        a TF file; or ``{name or number: one of these, ...}`` for some of them.
    streamline_colour : str, optional
        Streamlines are coloured by "bundle" (the default), "direction", or a number that their files have for
        points or streamlines, by its name.
    engine : str
        "gl" for OpenGL, "rays" for rays on all processors, in the same look; "auto" is OpenGL where there is a driver,
        else rays.

    Raises
    ------
    GLError
        With "gl" without an OpenGL 4.5 driver, and unless by rays in a process that was forked from one that used OpenGL.
    ArgumentError
        For a transfer function that is none, for one without a context, and for a number that no streamlines have.
    """

    def __init__(self, atlas: Atlas, *, transfer: Any = None, max_memory: int = 0,
                 pathway_transfers: Any = None, streamline_colour: str | None = None, engine: str = "auto") -> None:
        self.atlas = atlas
        self._p: Any = None
        pointer, out = atlas._p, ffi.new("conus_renderer **")
        options = ffi.new("conus_renderer_options *", {"max_memory": byte_count("max_memory", max_memory)})
        is_name = isinstance(transfer, (str, bytes, os.PathLike))
        name = path_of("transfer", transfer) if is_name else ffi.NULL
        options.transfer = name
        self._has_transfer = transfer is not None
        self._pathways = pathways, alive = _pathways_of(atlas, pathway_transfers)
        options.pathways, options.pathway_count = pathways, len(alive)
        colour = ffi.NULL if streamline_colour is None else utf8("streamline_colour", streamline_colour)
        options.streamline_colour = colour
        options.engine = choice("engine", engine, ("auto", "rays", "gl"))
        self._owner = GLOwner(engine != "rays")
        check(lib.conus_renderer_create(out, pointer, options))
        self._p = owned(out[0], self._owner.ender(lib.conus_renderer_destroy), pointer)
        if is_name:
            self._needs_context()
        elif transfer is not None:
            self.transfer = transfer

    def close(self) -> None:
        """Frees its memory. Drawing afterwards is an error."""
        if self._p is not None:
            self._owner.check("renderer")
            ffi.release(self._p)
        self._p = None

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *unused: object) -> None:
        self.close()

    def _mine(self) -> Any:
        self.atlas._p  # pylint: disable=pointless-statement  # raises if it is closed
        if self._p is None:
            raise ArgumentError("renderer: it is closed")
        self._owner.check("renderer")
        return self._p

    @property
    def device(self) -> str:
        """The device that draws, as OpenGL names it, or "rays"."""
        return text(lib.conus_renderer_device(self._mine()))

    @property
    def transfer(self) -> Array:
        """(n, 5) points of the context's transfer function: value, sRGB, opacity of 1 mm; it may be set."""
        count = ffi.new("size_t *")
        points = array_of(lib.conus_renderer_transfer(count, self._mine()), count[0], _POINT)
        return np.column_stack([points["value"], points["rgba"]])

    @transfer.setter
    def transfer(self, points: Any) -> None:
        array = np.ascontiguousarray(numbers("transfer", points))
        if array.ndim != 2 or array.shape[1] != 5:
            raise ArgumentError(f"transfer: an array of shape {array.shape}, wanted is (n, 5)")
        self._needs_context()
        values = ffi.cast("conus_transfer_point *", array.ctypes.data)
        check(lib.conus_renderer_set_transfer(self._mine(), values, len(array)))
        self._has_transfer = True

    def _needs_context(self) -> None:
        if not len(self.transfer):
            raise ArgumentError("transfer: the atlas has no context volume")

    def render(
        self,
        selection: Optional[Selection] = None,
        *,
        size: Optional[tuple[int, int]] = None,
        camera: Any = None,
        camera_origin: Any = None,
        camera_toward: Any = None,
        camera_up: Any = None,
        field_of_view: Optional[float] = None,
        frustum: Optional[Sequence[float]] = None,
        slices: Optional[int] = None,
        chosen: Union[str, int, None] = None,
        fade: float = 0,
        legend: Union[bool, str] = True,
        draft: bool = False,
        style: str = "auto",
        view: Optional[str] = None,
        background: Optional[str] = None,
        width_mm: Optional[float] = None,
        height_mm: Optional[float] = None,
        dpi: Optional[float] = None,
        opacity: Union[float, Mapping[Union[str, int], float], None] = None,
        unselected: Optional[str] = None,
        own_colours: bool = False,
        legend_rows: Optional[int] = None,
        legend_areas: Sequence[Union[str, int]] = (),
        measured: Any = None,
        vectors: bool = False,
        probes: Optional[Mapping[str, Any]] = None,
        probe_range: Optional[Sequence[float]] = None,
        points: Optional[Mapping[str, Sequence[float]]] = None,
        point_groups: Optional[Sequence[str]] = None,
        point_radius: Optional[float] = None,
        title: Optional[str] = None,
        cuts: Sequence[str] = (),
        at: Any = None,
        fill: Optional[float] = None,
        radiological: bool = False,
    ) -> Picture:
        """Draws the atlas as ``conus render`` does.

        Parameters
        ----------
        selection : Selection, optional
            A selection of this atlas: its cone, axis and contacts are drawn, with a legend. With layers="all", areas
            that are in the cone but occluded are striped.
        size : (int, int)
            Width and height, pixels, each 1 to 16384; (1400, 1050) if not given.
        camera
            (4, 4) matrix from the camera to the world; the camera points along its -z. Without a
            camera, the picture shows the whole atlas from the cone's side.
        camera_origin, camera_toward, camera_up
            Or where the camera is, the point in the middle of its picture, and its up direction; RAS mm.
        field_of_view : float
            From the lower to the upper edge, degrees; 30 if not given.
        frustum : (left, right, bottom, top)
            Or the edges of a camera's picture at depth 1.
        slices : int
            Planes across the view at which volumes are sampled; sqrt(2) times the longest edge if not
            given.
        chosen : str or int
            An object that is never pale, with those below it in the area tree.
        fade : float
            How much the context is thinned: 0 not at all, 1 it is gone.
        legend : bool or str
            False leaves out all text. "right" has the legend beside the drawing, "below" under it, where
            the picture becomes higher, "none" nowhere; True or "auto" on the right of a picture that is
            wide enough, else below.
        draft : bool
            Leave edges rough, and many streamlines out where there are many: quicker.
        style : str
            "print" for paper: white, seen from beside the cone, with thin lines around what is drawn and letters of
            panels, 180 mm wide unless there is a size; what the others say counts. "screen" else; "auto" is print
            with width_mm.
        view : str
            Without a camera, the side from which the atlas is seen: "cone", "left", "right", "front",
            "back", "top", "bottom", "beside": 60 degrees off the cone's axis, with all of it, or "across": at right
            angles to it, from above. If not given "cone", in print "beside".
        background : str
            "light", "white", "black", "transparent" or "#rrggbb"; "light" if not given, in print "white".
        width_mm, height_mm, dpi : float
            In place of size: the width and height on paper, mm (the height is three quarters of the
            width if not given), and pixels per inch (300 if not given). With dpi letters have 7
            points, and files say how large they are.
        opacity : float or dict
            Opacity of surfaces, 0 to 1: of all that the selection does not hit, or ``{name or number: opacity, ...}``
            of these with those below them in the area tree; the key None is of all that is not hit.
        unselected : str
            "white", "black" or "#rrggbb": one tone of areas and pathways that are not hit; without it a grey, or with
            own_colours their colours, paler.
        own_colours : bool
            Areas and pathways have their own colours with a selection, too. Without it, and without a palette of the
            atlas, what is hit has a colour by its place in the answer.
        legend_rows : int
            Of the objects in the legend only so many, and a row that counts the others; 12 if not given.
        legend_areas : sequence of str or int
            Areas, with all below them in the area tree, pathways or bundles that have a row in the legend beside what
            is hit.
        measured : (2, 3) array
            Two places, RAS mm: the line between them, with its length.
        vectors : bool
            Keep text and lines out of the pixels, as a picture that is saved as .svg or .pdf needs it.
        probes : dict
            ``{name: (origin, toward), ...}`` or ``{name: pose, ...}``, poses as (4, 4) matrices, RAS mm: a line for
            each, and beside the drawing a strip of what it passes, without a selection. Other areas are faint unless
            there is an opacity.
        probe_range : (near, far)
            The stretch of the probes, mm from their origins; else to the last area.
        points : dict
            ``{name: (x, y, z), ...}``, RAS mm: a ball for each, with its name, without a selection and probes, in space
            and in cuts that go through it or near it. Areas are faint unless there is an opacity.
        point_groups : sequence of str
            For each point its group: the first six groups have a colour each, and all a row in the legend.
        point_radius : float
            Of their balls, mm; 1 if not given.
        title : str
            What the selection is of, at the head of its legend; conus render writes the name of the pose.
        cuts : sequence of str
            Flat cuts on one sheet: "axial", "coronal" and "sagittal", through ``at`` or, as "axial:-10", at a place;
            "mosaic:N" is N axial ones, 12 if not given, evenly over the atlas; "3d" adds the view in space.
        at : (3,) array
            The point through which cuts go, RAS mm; needed for those without a place.
        fill : float
            Opacity of areas in cuts, 0 (outlines only) to 1; 0.6 if not given.
        radiological : bool
            Show the head's left on the right of axial and coronal cuts.

        Returns
        -------
        Picture
            Opaque, unless its background is transparent.

        Raises
        ------
        ArgumentError
            For a number out of its range, and for a selection of another atlas.
        GLError
            Where the driver fails.
        """
        pointer, options, out = self._mine(), ffi.new("conus_view *"), ffi.new("conus_image **")
        _check_cuts(cuts, {"at": at, "fill": fill, "radiological": radiological or None},
                    {"camera": camera, "camera_origin": camera_origin, "field_of_view": field_of_view,
                     "frustum": frustum, "opacity": opacity, "unselected": unselected,
                     "view": view,
                     "fade": fade or None, "draft": draft or None}, probes)
        if probes and (legend_rows is not None or legend_areas):
            raise ArgumentError("legend_rows, legend_areas: have no effect with probes, which have no legend")
        options.print = [width_mm is not None, False, True][choice("style", style, _STYLES)]
        if options.print and width_mm is None and size is None:
            width_mm = 180
        _set_size(options, size, width_mm, height_mm, dpi)
        alive = _camera_of(camera, camera_origin, camera_toward, camera_up)
        options.camera = alive or ffi.NULL
        _set_lens(options, field_of_view, frustum)
        if slices is not None:
            options.slices = whole("slices", slices, 1)
        if selection is not None:
            if selection.atlas is not self.atlas:
                raise ArgumentError("selection: it is of another atlas")
            options.selection = selection._p
            options.frame = selection.space._frame if selection.space else ffi.NULL
        options.chosen = 0 if chosen is None else self.atlas.find(chosen)
        options.fade, options.draft = real("fade", fade), flag("draft", draft)
        beside = options.print and selection is not None and not alive
        options.side = choice("view", ("beside" if beside else "cone") if view is None else view, _SIDES)
        options.no_legend = legend is False
        options.legend = choice("legend", legend, _LEGENDS) if isinstance(legend, str) else 0
        _set_background(options, ("white" if options.print else "light") if background is None else background)
        if unselected is not None:
            options.has_unselected, options.unselected_rgb = True, rgb_of("unselected", unselected)
        options.own_colours = flag("own_colours", own_colours)
        has_rows = not (probes or legend is False or legend == "none")
        options.legend_rows = has_rows * _LEGEND_ROWS if legend_rows is None else whole("legend_rows", legend_rows, 1)
        options.no_covered_context = not self._has_transfer
        options.shapes = flag("vectors", vectors)
        drawn = self._probes_of(probes, probe_range)
        options.probes, options.probe_count = (drawn[0], len(drawn[0])) if drawn else (ffi.NULL, 0)
        balls = _points_of(points, point_groups, point_radius)
        options.points, options.point_count = (balls[0], len(balls[0])) if balls else (ffi.NULL, 0)
        name = ffi.NULL if title is None else utf8("title", title)
        options.title = name
        opacities = self._opacities(options, _FAINT if (drawn or balls) and opacity is None else opacity)
        listed = self._listed(legend_areas)
        line = ffi.NULL if measured is None else ffi.new("double[6]", _ends_of(measured))
        options.opacity, options.listed, options.measured = opacities, listed, line
        if not cuts:
            check(lib.conus_render(out, pointer, options))
            return Picture(out[0], self.device)
        planes, look = _planes_of(self.atlas, cuts, at, flag("radiological", radiological)), ffi.new("conus_cut_view *")
        look.fill = 0.6 if fill is None else real("fill", fill)
        look.pathways, look.pathway_count = self._pathways[0], len(self._pathways[1])
        check(lib.conus_render_cuts(out, self.atlas._p, planes, len(planes), look,
                                   pointer if "3d" in cuts else ffi.NULL, options))
        return Picture(out[0], self.device)

    def _probes_of(self, probes: Optional[Mapping[str, Any]], span: Optional[Sequence[float]]) -> Any:
        """An array of conus_drawn_probe, and what it points to; None without probes."""
        if not probes:
            if span is not None:
                raise ArgumentError("probe_range: there are no probes")
            return None
        selector = self.atlas._selector({})._p
        alive: list[Any] = []
        try:
            check(lib.conus_selector_set_range(selector, vector("probe_range", span, 2) if span is not None else ffi.NULL))
            for name, given in probes.items():
                is_pair = isinstance(given, (tuple, list)) and len(given) == 2
                pose = pose_of(given[0], given[1], None, None, None) if is_pair else pose_of(None, None, None, None, given)
                out = ffi.new("conus_table **")
                check(lib.conus_segments(out, selector, pose))
                alive.append((utf8("probes", name), owned(out[0], lib.conus_table_destroy)))
        finally:
            lib.conus_selector_set_range(selector, ffi.NULL)
        return ffi.new("conus_drawn_probe[]", alive), alive

    def _listed(self, names: Sequence[Union[str, int]]) -> Any:
        """Whether each object is one of these or below one in the area tree, by number."""
        if isinstance(names, str) or not names:
            if isinstance(names, str):
                raise ArgumentError(f"legend_areas: {names!r}, wanted is a list of names or numbers")
            return ffi.NULL
        found, out = {self.atlas.find(name) for name in names}, ffi.new("bool[]", len(self.atlas) + 1)
        for number in range(1, len(self.atlas) + 1):
            ancestor = number
            while ancestor and ancestor not in found:
                ancestor = lib.conus_atlas_object(self.atlas._p, ancestor).parent
            out[number] = bool(ancestor)
        return out

    def _opacities(self, view: Any, opacity: Any) -> Any:
        """The numbers by object, which must live while it is drawn; sets that of what is not hit."""
        given = dict(opacity) if isinstance(opacity, Mapping) else {None: opacity}
        pale = given.pop(None, None)
        if pale is not None:
            view.pale = real("opacity", pale)
            view.no_pale = view.pale == 0  # which is the library's word for its default
        if not given:
            return ffi.NULL
        numbers_ = ffi.new("double[]", [math.nan] * (len(self.atlas) + 1))
        count = len(self.atlas)
        parents = {number: lib.conus_atlas_object(self.atlas._p, number).parent for number in range(1, count + 1)}
        for name, value in given.items():
            found, wanted = self.atlas.find(name), real("opacity", value)
            if math.isnan(wanted):
                raise ArgumentError("opacity: nan, allowed is 0 to 1")
            for number in parents:
                ancestor: Optional[int] = number
                while ancestor and ancestor != found:
                    ancestor = parents[ancestor]
                if ancestor == found:
                    numbers_[number] = wanted
        return numbers_

    def __repr__(self) -> str:
        return f"<conus.Renderer of {self.atlas!r}>"


def _pathways_of(atlas: Atlas, transfers: Any) -> tuple[Any, list[Any]]:
    """An array of conus_pathway_transfer, and what it points to."""
    if transfers is None:
        return ffi.NULL, []
    entries = dict(transfers) if isinstance(transfers, Mapping) else {None: transfers}
    paths = [path_of("pathway_transfers", path) for path in entries.values()]
    numbers_ = [0 if name is None else atlas.find(name) for name in entries]
    out = ffi.new("conus_pathway_transfer[]", len(paths))
    for entry, number, path in zip(out, numbers_, paths):
        entry.pathway, entry.transfer = number, path
    return out, paths


def _camera_of(camera: Any, origin: Any, toward: Any, up: Any) -> Any:
    """A conus_pose, or None."""
    if camera is None and origin is None and toward is None and up is None:
        return None
    try:
        return pose_of(origin, toward, None, up, camera)
    except ArgumentError as error:
        raise ArgumentError(f"camera: {error}") from None


def _pixels(name: str, mm: float, dpi: float) -> int:
    pixels = real(name, mm) / 25.4 * dpi
    if not 0.5 < pixels < 16384.5:
        raise ArgumentError(f"{name}: {mm} mm at {dpi} dpi, allowed is what makes 1 to 16384 pixels")
    return round(pixels)


def _set_size(view: Any, size: Optional[tuple[int, int]], width_mm: Optional[float], height_mm: Optional[float],
              dpi: Optional[float]) -> None:
    if width_mm is None and height_mm is not None:
        raise ArgumentError("height_mm: there is no width_mm")
    if width_mm is not None and size is not None:
        raise ArgumentError("size: there is a width_mm")
    if dpi == 0:  # which is the library's word for none
        raise ArgumentError("dpi: 0, allowed is more than 0")
    view.dpi = real("dpi", dpi) if dpi is not None else 0 if width_mm is None else 300
    if width_mm is not None:
        height = 0.75 * width_mm if height_mm is None else height_mm
        view.width, view.height = _pixels("width_mm", width_mm, view.dpi), _pixels("height_mm", height, view.dpi)
    else:
        view.width, view.height = (whole("size", side, 1) for side in size or (1400, 1050))


def rgb_of(name: str, colour: Any, *more: str) -> list[int]:
    """sRGB of "white", "black" or "#rrggbb"; ``more`` is what else is allowed."""
    named = {"white": [255] * 3, "black": [0] * 3}
    if isinstance(colour, str) and re.fullmatch("#[0-9a-fA-F]{6}", colour):
        return list(bytes.fromhex(colour[1:]))
    if isinstance(colour, str) and colour in named:
        return named[colour]
    raise ArgumentError(f"{name}: {colour!r}, allowed is {', '.join([*more[:1], *named, *more[1:]])}, #rrggbb")


def _set_background(view: Any, background: str) -> None:
    named = {"light": 0, "transparent": 2}
    if isinstance(background, str) and background in named:
        view.background = named[background]
    else:
        view.background, view.background_rgb = 1, rgb_of("background", background, "light", "transparent")


def _check_cuts(cuts: Sequence[str], of_cuts: Mapping[str, Any], of_space: Mapping[str, Any], probes: Any) -> None:
    """Refuses what would have no effect: what is None is not given."""
    if isinstance(cuts, str):
        raise ArgumentError(f"cuts: {cuts!r}, wanted is a list of cuts")
    if cuts and probes:
        raise ArgumentError("probes and cuts exclude each other")
    if cuts and all(cut == "3d" for cut in cuts):
        raise ArgumentError("cuts: 3d alone is the picture without cuts")
    for name in (name for name, value in of_cuts.items() if value is not None and not cuts):
        raise ArgumentError(f"{name}: has no effect without cuts")
    for name in (name for name, value in of_space.items() if value is not None and cuts and "3d" not in cuts):
        raise ArgumentError(f"{name}: has no effect on cuts; \"3d\" among them adds the view in space")


def _ends_of(measured: Any) -> list[float]:
    array = numbers("measured", measured)
    if array.shape != (2, 3):
        raise ArgumentError(f"measured: an array of shape {array.shape}, wanted is (2, 3)")
    return [float(value) for value in array.ravel()]


def _mosaic_of(atlas: Atlas, cut: str) -> list[str]:
    """Cuts in the middles of as many layers, at whole numbers where they are two or more apart."""
    found = re.fullmatch("mosaic(?::([0-9]{1,3}))?", cut)
    count = int(found[1] or 12) if found else 0
    if not 1 <= count <= 400:
        raise ArgumentError(f"cuts: {cut!r}, wanted is mosaic or mosaic:N, N from 1 to 400")
    low, high = ffi.new("double[3]"), ffi.new("double[3]")
    check(lib.conus_atlas_bounds(low, high, atlas._p))
    step = (high[2] - low[2]) / count
    places = [low[2] + (i + 0.5) * step for i in range(count)]
    return [f"axial:{round(place) if step >= 2 else place}" for place in places]


def _planes_of(atlas: Atlas, cuts: Sequence[str], at: Any, radiological: bool) -> Any:
    """An array of conus_cut_plane."""
    through = None if at is None else vector("at", at)
    planes = []
    for cut in (each for cut in cuts for each in (_mosaic_of(atlas, cut) if cut.startswith("mosaic") else [cut])):
        name, _, place = cut.partition(":")
        if cut == "3d":
            continue
        right, up = _PLANES[tuple(_PLANES)[choice("cuts", name, (*_PLANES,))]]
        if through is None and not place:
            raise ArgumentError(f"at: {cut!r} needs a point that it goes through")
        point = [0.0] * 3 if through is None else [*through]
        try:
            point[2 - tuple(_PLANES).index(name)] = float(place) if place else point[2 - tuple(_PLANES).index(name)]
        except ValueError:
            raise ArgumentError(f"cuts: {cut!r}, wanted is {name} or {name}:NUMBER") from None
        planes.append((point, [-x if radiological and name != "sagittal" else x for x in right], list(up)))
    return ffi.new("conus_cut_plane[]", planes)


def _set_lens(view: Any, field_of_view: Optional[float], frustum: Optional[Sequence[float]]) -> None:
    if field_of_view is not None:
        if field_of_view == 0:  # which is the library's word for its default
            raise ArgumentError("field of view of 0 degrees; allowed is more than 0 and less than 180")
        view.field_of_view = real("field_of_view", field_of_view)
    if frustum is not None:
        view.frustum = vector("frustum", frustum, 4)
        if not any(view.frustum):
            raise ArgumentError("frustum: wanted are left < right, bottom < top")


def transfer_presets() -> list[str]:
    """Names of the transfer functions that :class:`Renderer` knows."""
    return choices(b"transfers")
