# SPDX-License-Identifier: BSD-3-Clause
"""Atlases and what is asked of them."""
from __future__ import annotations

import hashlib
import math
import os
import threading
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Iterable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from ._answers import Answers, Array, Objects, Selection, Track, kind_word
from ._callback import Callback, load_progress, receive
from ._candidates import candidates_of, depth_of
from ._conus import ffi, lib
from ._library import (
    RESULT,
    ArgumentError,
    DataError,
    Error,
    Guarded,
    affine_of,
    array_of,
    byte_count,
    check,
    choice,
    flag,
    items,
    message,
    optional,
    owned,
    path_of,
    python_words,
    real,
    shown,
    text,
    unmasked,
    utf8,
    vector,
    whole,
    written,
)
from ._picture import GLOwner, Picture, Renderer, rgb_of
from ._pose_file import Poses
from ._poses import Aims, PoseArray, notes_of, pose_of, rows_of, warn
from ._plan import Constraints, Plan, constraints_of, error_of, plan_of, stream_of
from ._probe import Contacts, Probe, poses_of_probe
from ._progress import LoadProgress, Progress, telling
from ._space import Place, frame_of, place_of, space_of
from ._table import Table, ask_table
from ._together import Together, together_of
from ._track import Tracker, follow
from ._tracts import SPACES, Tractogram, moves, options_of, polylines_of, tractograms_of

if TYPE_CHECKING:
    import pandas

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
Labels = Union[Mapping[int, str], "pandas.DataFrame", None]

_SCALARS = ("u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8")


# Atlases from files and arrays


def _fill_voxels(data: Any, affine: Any, name: str, space_code: int) -> tuple[Any, list[Any]]:
    """A conus_voxels, and what must live as long as it."""
    array = np.asarray(unmasked(name, data, fill="0"))
    kind = array.dtype.str[1:].replace("b1", "u1")
    if array.ndim != 3 or kind not in _SCALARS:
        raise ArgumentError(f"{name}: an array of {array.dtype}, shape {array.shape}; wanted are 3 axes of numbers")
    matrix = affine_of("affine", affine)
    voxels, words = ffi.new("conus_voxels *"), path_of("name", name)
    voxels.data = ffi.cast("void *", array.__array_interface__["data"][0])
    voxels.type = 1 + _SCALARS.index(kind)
    voxels.swapped = not array.dtype.isnative
    voxels.dim, voxels.stride = array.shape, array.strides
    voxels.world_from_voxel = matrix.T.ravel().tolist()
    voxels.space_code, voxels.name = space_code, words
    return voxels, [array, words]


def _label_rows(labels: Any) -> list[Mapping[str, Any]]:
    """Missing members are None."""
    if labels is None:
        return []
    if hasattr(labels, "columns"):
        table = labels if "index" in labels else labels.rename(columns={"label": "index"})
        for name in ("index", "name"):
            if name not in table:
                raise ArgumentError(f"labels: there is no column {name}")
        return list(table.astype(object).where(table.notna(), None).to_dict("records"))
    if hasattr(labels, "items"):
        return [{"index": number, "name": name} for number, name in labels.items()]
    raise ArgumentError(f"labels: {type(labels).__name__}, wanted is {{number: name}} or a DataFrame")


def _fill_labels(labels: Labels) -> tuple[Any, int, list[Any]]:
    """[count] conus_label, and what must live as long as they."""
    rows = _label_rows(labels)
    table, words = ffi.new("conus_label[]", max(1, len(rows))), []

    def word(row: Mapping[str, Any], name: str) -> Any:
        value = row.get(name)
        words.append(optional(written, f"labels: {name}", value))
        return words[-1]

    for entry, row in zip(table, rows):
        entry.number = whole("labels: index", row["index"])
        entry.name, entry.abbreviation = word(row, "name"), word(row, "abbreviation")
        hemisphere = str(row.get("hemisphere") or "\0").encode()
        if len(hemisphere) > 1:
            raise ArgumentError(f"labels: hemisphere: {row['hemisphere']!r}, allowed is L, R or B")
        entry.hemisphere = hemisphere
        entry.parent = whole("labels: parent", row.get("parent") or 0)
    return table, len(rows), words


class InstalledAtlas(NamedTuple):
    """An atlas that is installed on this computer."""

    name: str
    """The name that ``load`` takes, if no other atlas has it."""
    source: str
    """Whose folder it is in: "mricron", "fsl"; "own" for $CONUS_ATLAS_PATH."""
    kind: str
    """"volume", "surface", "surfaces" or "scene"."""
    voxel_mm: Optional[tuple[float, float, float]]
    """Edge lengths of a voxel, where they are known."""
    path: str
    labels: Optional[str]
    """Path of the label table that ``load`` uses; None where it finds one by itself."""


class Placement(NamedTuple):
    """Where the areas of an atlas lie. Boxes are their lowest and their highest corner."""

    atlas_from_world: Array
    """From where the atlas lies to its own space, (4, 4)."""
    growth: float
    """Volume here of 1 mm^3 in its own space, mm^3."""
    mirrors: bool
    """Left and right are exchanged."""
    own_box: Array
    """In its own space, (2, 3)."""
    box: Array
    """Here, (2, 3)."""
    centre: Array
    """The mean of the voxels' centres, or of the vertices of surfaces."""
    distance_mm: float
    """How far that is from where it is in its own space."""
    in_grid: Optional[float]
    """The part of the voxels that is in the grid of the context, 0 to 1; None without a context."""
    in_head: Optional[float]
    """The same, in the head that the context shows."""


def _catalogue() -> Any:
    out = ffi.new("conus_catalogue **")
    check(lib.conus_catalogue_create(out, ffi.NULL))
    return owned(out[0], lib.conus_catalogue_destroy)


def _path_at(pointer: Any) -> Optional[str]:
    return os.fsdecode(ffi.string(pointer)) if pointer else None


def atlases() -> list[InstalledAtlas]:
    """Lists the atlases that are installed on this computer, as ``conus atlases`` does.

    Each name, or ``source:name``, can be given to ``load``. ``pandas.DataFrame(conus.atlases())``
    is a table of them.
    """
    found = ask_table(lib.conus_list_installed, ffi.NULL, ffi.NULL)
    sizes = np.stack([found[f"spacing_{axis}"] for axis in "xyz"], axis=1)
    paths, labels = (map(_path_at, ffi.unpack(lib.conus_table_texts(found._p, name), len(found)))
                     for name in (b"path", b"labels"))
    rows = zip(found["name"], found["source"], found["kind"], sizes.tolist(), paths, labels)
    return [InstalledAtlas(name, source, kind, (x, y, z) if x > 0 else None, path, table)
            for name, source, kind, (x, y, z), path, table in rows]


def _stated(source: Any, template: Optional[str]) -> Any:
    """The path with what is stated about its brain."""
    if template is None:
        return source
    if not isinstance(source, (str, bytes, os.PathLike)):
        raise ArgumentError("template: of a path only; the space of an image or array is that of its header")
    if not isinstance(template, str):
        raise ArgumentError(f"template: {template!r}, allowed are mni152, colin27, mni305 and none")
    return os.fsdecode(source) + ",template=" + template


def _find_image(source: Any) -> Any:
    """The path of a context, which may be the name of an installed image."""
    path = path_of("context", source)
    if not isinstance(source, str) or lib.conus_context_is_surface(path) or lib.conus_atlas_is_path(path):
        return path
    found, out = _catalogue(), ffi.new("conus_installed **")
    check(lib.conus_catalogue_find_image(out, found, path))
    return path_of("context", _path_at(out[0].path))


def _from_file(
    path: Path, labels: Any, labels_anyway: bool, max_memory: int, progress: Any, probability: float,
    without_context: bool,
) -> Any:
    options, out = ffi.new("conus_load_options *"), ffi.new("conus_atlas **")
    table, file = optional(path_of, "labels", labels), path_of("source", path)
    options.probability, options.without_context = probability, without_context
    options.labels, options.labels_anyway, options.max_memory = table, flag("labels_anyway", labels_anyway), max_memory
    with telling(progress, "file", 1) as tell:
        state = Callback(tell)
        handle = state.log_notes(options)
        options.progress, options.progress_user = load_progress, handle
        status = lib.conus_atlas_load(out, file, options)
        raw = owned(out[0], lib.conus_atlas_destroy)
        state.check(status)
    return raw


def _from_array(data: Any, affine: Any, labels: Labels, labels_anyway: bool, name: str, space_code: int) -> Any:
    voxels, _alive = _fill_voxels(data, affine, name, space_code)
    table, count, _words = _fill_labels(labels)
    options, out = ffi.new("conus_create_options *"), ffi.new("conus_atlas **")
    options.labels_anyway = flag("labels_anyway", labels_anyway)
    state = Callback()
    _handle = state.log_notes(options)
    status = lib.conus_atlas_create(out, voxels, table, count, options)
    raw = owned(out[0], lib.conus_atlas_destroy)
    state.check(status)
    return raw


def _image_parts(image: Any) -> tuple[Any, Any, str, int]:
    """The voxels of a nibabel image. Stored integers without a scale stay integers."""
    header = image.header
    code = int(header["sform_code"]) or int(header["qform_code"]) if "sform_code" in header else 0
    return image.dataobj, image.affine, image.get_filename() or "nibabel image", code


def load(
    source: Any,
    affine: Any = None,
    *,
    labels: Any = None,
    pathways: Iterable[Any] = (),
    streamlines: Iterable[Any] = (),
    context: Any = None,
    context_blocks: float = 0,
    context_opacity: float = 0,
    shell: bool = False,
    hemispheres: str = "as-is",
    only: Optional[str] = None,
    hide: Optional[str] = None,
    labels_anyway: bool = False,
    transforms: Iterable[Any] = (),
    max_memory: int = 0,
    progress: LoadProgress = None,
    probability: float = 0,
    safe_colours: bool = False,
    palette: Union[str, Sequence[str]] = (),
    template: Optional[str] = None,
    sides: str = "as-is",
) -> Atlas:
    """Loads an atlas.

    Parameters
    ----------
    source
        A path (everything that ``conus query`` takes), the name of an installed atlas (``atlases()``
        lists them; a file of that name comes first), a nibabel image, or a 3-D array of labels.
    affine
        (4, 4), of an array: maps voxel indices to RAS mm.
    labels
        For a path: the path of a label table. Else ``{number: name}`` or a DataFrame with the columns
        index, name and, if known, abbreviation, hemisphere ("L", "R", "B") and parent.
    pathways
        Paths, or nibabel images, of scalar maps; each is one pathway. ``(map, threshold)`` sets from
        which value on (default: a quarter of the map's scale). ``(map, {name: (low, high), ...})``
        makes a pathway of each band of values, from low to below high; None is no end.
    streamlines
        Tractograms; each is a bundle, or one for each group of its file. Paths, what ``nibabel.streamlines`` loads
        or makes, lists of (n, 3) arrays of RAS mm, or dictionaries with "source", one of these, and: "radius", mm
        (a ray hits what is nearer than this to a streamline; default 0.5), "name", "space", "ras" or "lps", the axes of
        a file that does not state them, and "moves": True of streamlines in the space of the atlas's files, which
        ``transforms`` move, too.
    context, context_blocks, context_opacity
        The context drawn around the areas: a path or nibabel image of a volume, the name of an installed one
        ("ch2bet"), the path of a surface, or a list of these with at most one volume. Its voxels with values from ``context_blocks`` on block
        rays (0 = none); surfaces have ``context_opacity``, above 0 to 1 (0 = 0.25), and block nothing.
        False: that of a manifest is left out, unless answers need it, which are the same; for atlases that are not
        drawn, nor asked for :meth:`Atlas.inward`, nor moved.
    shell
        Draws a glass shell around all areas of voxels and the head in the context volume. A picture with
        ``transfer="none"`` leaves out that volume, and ``opacity`` the areas.
    hemispheres
        "as-is", "split" (areas of both sides are cut at the midline) or "merged".
    only, hide
        Lists of names, separated by commas: all else, or these, are as if they had never been loaded.
    labels_anyway
        Each value is a label, even where the values look like those of an image.
    transforms
        Affines and deformation fields that bring the atlas to the poses: each moves points from where poses are
        towards the atlas, the first one first. Paths (affines of ITK, FreeSurfer, MNI, 4 x 4 numbers; fields of ITK
        and SPM), (4, 4) arrays of RAS mm, or dictionaries with "file" and: "inverse": True of an affine; for FSL's
        files "from" and "to", the paths of their images; of a field "vectors", "relative" or "absolute", "space", their
        axes, "ras" or "lps", and "grid", the path of a volume with the voxels for the labels. Pathways, context and streamlines
        without "moves" are in the space of the poses.
    max_memory
        Largest file and volume, bytes; 0 = 8 GiB.
    progress
        Called with a path, the number of files that are read, and how many there are. True shows
        tqdm's bar, if tqdm is installed.
    probability
        For an atlas of probabilities: from which one on, above 0 to 1, a voxel belongs to an area
        (default: 0.25, or as the manifest says).
    safe_colours
        Colours of areas, pathways and bundles that people with any colour vision can tell apart.
    palette
        Or these, "#rrggbb" each, in a list or one text, different ones where areas touch.
    template
        Whose brain it is, of a path, whatever its header says: "mni152", "colin27", "mni305", or "none" for one
        person's own, in the space of that person's scan. ``Atlas.brain`` says what is known.
    sides
        "exchanged" mirrors an atlas whose voxels lie the other way round than its header says (``Atlas.exchanged``).

    Returns
    -------
    Atlas
        Its ``notes`` say what was noticed.

    Raises
    ------
    FileError, DataError, UnsupportedError
        For a file that cannot be read, is damaged, or is beyond conus.
    ArgumentError
        For an argument out of its range.
    OutOfMemoryError
        For what is larger than ``max_memory``.
    """
    max_memory, probability = byte_count("max_memory", max_memory), real("probability", probability)
    source = _stated(source, template)
    if isinstance(source, (str, bytes, os.PathLike)):
        raw = _from_file(source, labels, labels_anyway, max_memory, progress, probability, context is False)
    elif probability:
        raise ArgumentError("probability: an array of labels has no areas of probabilities")
    elif hasattr(source, "dataobj"):
        data, matrix, name, code = _image_parts(source)
        raw = _from_array(data, matrix if affine is None else affine, labels, labels_anyway, name, code)
    elif affine is None:
        raise ArgumentError(f"affine: a {type(source).__name__} needs one; only paths and images of nibabel do not")
    else:
        raw = _from_array(source, affine, labels, labels_anyway, "array", 0)
    if choice("sides", sides, ("as-is", "exchanged")):
        check(lib.conus_atlas_exchange_sides(raw))
    how = choice("hemispheres", hemispheres, ("as-is", "split", "merged"))
    if how:
        check(lib.conus_atlas_set_hemispheres(raw, how))
    moving, still = _split_streamlines(streamlines)
    for tractogram in moving:
        _add_streamlines(raw, tractogram, max_memory)
    if _move(raw, transforms, max_memory) == 0 and moving:
        raise ArgumentError("streamlines: moves: there is no transform that could move them")
    for pathway in items("pathways", pathways):
        _add_pathway(raw, pathway, max_memory)
    for tractogram in still:
        _add_streamlines(raw, tractogram, max_memory)
    _set_contexts(raw, context, context_blocks, context_opacity, max_memory)
    if only is not None or hide is not None:
        check(lib.conus_atlas_show(raw, optional(utf8, "only", only), optional(utf8, "hide", hide)))
    if flag("shell", shell):
        check(lib.conus_atlas_add_shell(raw, 0))
    if flag("safe_colours", safe_colours):
        lib.conus_atlas_use_safe_colours(raw)
    palette = palette.replace(",", " ").split() if isinstance(palette, str) else palette
    if palette:
        colours = b"".join(bytes(rgb_of("palette", colour)) for colour in palette)
        check(lib.conus_atlas_use_palette(raw, colours, len(palette)))
    return Atlas(raw)


def _transform(atlas: Any, given: Any, max_memory: int) -> None:
    if isinstance(given, (str, bytes, os.PathLike, Mapping)):
        keys = dict(given) if isinstance(given, Mapping) else {"file": given}
        options = ffi.new("conus_transform_options *")
        path, inverse = path_of("transforms", keys.pop("file", None)), keys.pop("inverse", False)
        images = [optional(path_of, "transforms", keys.pop(name, None)) for name in ("from", "to", "grid")]
        vectors = choice("transforms: vectors", keys.pop("vectors", "as-stated"), ("as-stated", "relative", "absolute"))
        number = keys.pop("transform", None)
        options.space = choice("transforms: space", keys.pop("space", SPACES[0]), SPACES)
        if keys:
            raise ArgumentError(
                f"transforms: {sorted(keys)}, wanted are file, from, to, inverse, vectors, space, grid and transform"
            )
        if number is not None:
            options.transform = 1 + whole("transforms: transform", number)
        setattr(options, "from", images[0])
        options.to, options.inverse = images[1], flag("transforms: inverse", inverse)
        options.grid, options.vectors, options.max_memory = images[2], vectors, max_memory
        check(lib.conus_atlas_transform(atlas, path, options))
        return
    check(lib.conus_atlas_move(atlas, affine_of("transforms", given).T.ravel().tolist()))


def _move(atlas: Any, transforms: Any, max_memory: int) -> int:
    """Moves the atlas; gives the number of transforms."""
    for given in reversed(transforms := items("transforms", transforms)):
        _transform(atlas, given, max_memory)
    return len(transforms)


def _bands_of(options: Any, bands: Mapping[str, Any]) -> Any:
    """Sets the bands of values; gives what must live as long as the call."""
    if not bands:
        raise ArgumentError("pathways: no bands, wanted is at least one")
    entries, alive = ffi.new("conus_band[]", len(bands)), []
    for entry, (name, ends) in zip(entries, bands.items()):
        if not isinstance(ends, (tuple, list)) or len(ends) != 2:
            raise ArgumentError(f"pathways: {name}: {ends!r}, wanted are a lower and an upper end")
        low, high = ends
        alive.append(utf8("pathways", name))
        entry.low = -math.inf if low is None else real("pathways", low)
        entry.high = math.inf if high is None else real("pathways", high)
        entry.name = alive[-1]
    options.bands, options.band_count = entries, len(bands)
    return entries, alive


def _add_pathway(atlas: Any, pathway: Any, max_memory: int) -> None:
    source, values = pathway if isinstance(pathway, tuple) else (pathway, 0)
    options = ffi.new("conus_pathway_options *")
    options.max_memory = max_memory
    if isinstance(values, Mapping):
        _bands = _bands_of(options, values)
    else:
        options.threshold = real("pathways", values)
    state = Callback()
    _handle = state.log_notes(options)
    if hasattr(source, "dataobj"):
        voxels, _alive = _fill_voxels(*_image_parts(source))
        state.check(lib.conus_atlas_add_pathway_voxels(atlas, voxels, options))
    else:
        state.check(lib.conus_atlas_add_pathway(atlas, path_of("pathways", source), options))


def _split_streamlines(streamlines: Any) -> tuple[list[Any], list[Any]]:
    """Those that move with the atlas, and those that do not."""
    given = items("streamlines", streamlines)
    return [entry for entry in given if moves(entry)], [entry for entry in given if not moves(entry)]


def _add_streamlines(atlas: Any, given: Any, max_memory: int) -> None:
    source, options, _name = options_of(given, max_memory)
    state = Callback()
    _handle = state.log_notes(options)
    if isinstance(source, (str, bytes, os.PathLike)):
        state.check(lib.conus_atlas_add_streamlines(atlas, path_of("streamlines", source), options))
    else:
        polylines, _alive = polylines_of(source)
        state.check(lib.conus_atlas_add_polylines(atlas, polylines, options))


def _set_context(atlas: Any, source: Any, blocks: float, opacity: float, max_memory: int) -> None:
    options = ffi.new("conus_context_options *")
    options.block_threshold, options.opacity, options.max_memory = blocks, opacity, max_memory
    state = Callback()
    _handle = state.log_notes(options)
    if hasattr(source, "dataobj"):
        voxels, _alive = _fill_voxels(*_image_parts(source))
        state.check(lib.conus_atlas_set_context_voxels(atlas, voxels, options))
    else:
        state.check(lib.conus_atlas_set_context(atlas, _find_image(source), options))


def _is_surface(source: Any) -> bool:
    return not hasattr(source, "dataobj") and bool(lib.conus_context_is_surface(path_of("context", source)))


def _set_contexts(atlas: Any, context: Any, blocks: float, opacity: float, max_memory: int) -> None:
    sources = list(context) if isinstance(context, (list, tuple)) else [context] if context not in (None, False) else []
    surfaces = [_is_surface(source) for source in sources]
    blocks, opacity = real("context_blocks", blocks), real("context_opacity", opacity)
    if blocks and surfaces.count(False) == 0:
        raise ArgumentError("context_blocks: there is no context volume")
    if opacity and surfaces.count(True) == 0:
        raise ArgumentError("context_opacity: there is no surface")
    if surfaces.count(False) > 1:
        raise ArgumentError("context: several volumes, wanted is at most one")
    for source, surface in zip(sources, surfaces):
        _set_context(atlas, source, 0 if surface else blocks, opacity if surface else 0, max_memory)


def _distance(name: str, value: Any) -> float:
    """So many mm."""
    distance = real(name, value)
    if not distance >= 0:
        raise ArgumentError(f"{name}: {distance:g} mm, allowed are 0 and more")
    return distance


def _region(source: Any, threshold: float, max_memory: int) -> Any:
    options, out = ffi.new("conus_roi_options *"), ffi.new("conus_roi **")
    options.threshold, options.max_memory = real("threshold", threshold), max_memory
    state = Callback()
    _handle = state.log_notes(options)
    if hasattr(source, "dataobj") or isinstance(source, tuple):
        parts = (*source, "roi", 0) if isinstance(source, tuple) else _image_parts(source)
        if len(parts) != 4:
            raise ArgumentError(f"roi: a tuple of {len(source)}, wanted are an array and its affine")
        voxels, _alive = _fill_voxels(*parts)
        status = lib.conus_roi_create(out, voxels, options)
    else:
        status = lib.conus_roi_load(out, path_of("roi", source), options)
    region = owned(out[0], lib.conus_roi_destroy)
    state.check(status)
    return region


# Asking


class _Collector:
    """Keeps answers in one array that grows by an eighth, so that they are in memory once."""

    def __init__(self, poses: int, progress: Any) -> None:
        self.progress = progress
        self.done = 0
        self.starts = np.zeros(poses + 1, np.int64)
        self.status = np.zeros(poses, np.uint8)
        self.results = np.empty(0, RESULT)

    def take(self, answers: Any) -> None:
        count, poses = answers.starts[answers.poses], answers.poses
        start, end = self.done, self.done + poses
        before = int(self.starts[start])
        starts = np.frombuffer(ffi.buffer(answers.starts, (poses + 1) * ffi.sizeof("size_t")), np.uintp)
        self.starts[start : end + 1] = before + starts.astype(np.int64)
        self.status[start:end] = np.frombuffer(ffi.buffer(answers.status, poses * 4), np.uint32)
        if before + count > len(self.results):
            self.results.resize(before + count + (before + count) // 8, refcheck=False)
        if count:
            new = self.results[before : before + count]
            ffi.memmove(ffi.from_buffer(new.view(np.uint8)), answers.results, new.nbytes)
            del new
        self.done = end
        if self.progress is not None:
            self.progress(end, len(self.status))

    def finish(self) -> None:
        self.results.resize(int(self.starts[-1]), refcheck=False)


def _weight_of(text: Optional[str]) -> Any:
    """A conus_weight; NULL of None."""
    if text is None:
        return ffi.NULL
    out = ffi.new("conus_weight **")
    check(lib.conus_weight_create(out, utf8("weight", text)))
    return owned(out[0], lib.conus_weight_destroy)


def _state_of_file(argument: str, given: Any) -> Any:
    """What changes with the file that a weight or prior names; None where it names none."""
    if not isinstance(given, str):
        return None  # the selector refuses it
    text = utf8(argument, given)
    length = lib.conus_weight_path_length(text)
    try:
        found = os.stat(ffi.buffer(text)[:length]) if length else None
    except OSError:
        return None  # the library says so
    return found and (found.st_mtime_ns, found.st_size, found.st_ino)


def _weight_columns(weight: Optional[str], score: Optional[str], prior: Optional[str]) -> list[str]:
    """The columns that a weight brings to what is seen."""
    has_posterior = prior is not None or "posterior" in (score or "")
    return [] if weight is None else ["weight", "weight_error"] + ["posterior"] * has_posterior


#: The numbers of its options.
_NUMBERS: dict[str, Any] = {
    name: real if field.type.cname == "double" else whole
    for name, field in ffi.typeof("conus_selector_options").fields
    if field.type.cname in ("double", "uint32_t")
}


class Selector(Guarded):
    """An atlas made ready to answer, with options that hold for all its answers.

    Any thread may use it, with engine="gl" only the one that made it; one at a time is answered.
    ``select_many`` uses threads of its own.

    Parameters
    ----------
    atlas
        The atlas that is asked.
    layers
        "visible", what rays hit first, or "all" that they pass, with volumes and path lengths. None is
        "visible", but "all" with a weight that depends on the depth.
    resolution
        n of the n x n rays, 1 to 1024; 0 = the default, 64.
    range
        (nearest, farthest) depth along the axis, mm.
    radius
        mm: a cylinder instead of a cone.
    level, score, aperture, sampling, engine
        As the options of ``conus query``, as are further ``numbers``: slices, slice_fraction.
    space
        "ras" or "lps" mm; "ccf", AP, DV, ML in micrometres of the Allen CCF; "bregma", AP, ML, DV in mm
        from bregma: of positions and directions, given and in hits and tables.
    bregma
        With space="bregma": where bregma lies in CCF, (AP, DV, ML) in micrometres.
    weight
        As ``--weight`` of ``conus query``: "gauss=2", "gauss=2,bias=1:0", "coil=20:18", or the path of a
        table. The angle of :meth:`select`, and radius and range, are its own unless given.
    prior
        As ``--prior``: "equal", "size" or the path of a table, and perhaps ",power=2".
    """

    def __init__(
        self,
        atlas: Atlas,
        *,
        layers: Optional[str] = None,
        resolution: int = 0,
        range: tuple[float, float] = (0, 0),
        radius: float = 0,
        level: Union[int, str, None] = None,
        score: Optional[str] = None,
        aperture: str = "circle",
        sampling: str = "exact",
        engine: str = "auto",
        space: str = "ras",
        bregma: Any = None,
        weight: Optional[str] = None,
        prior: Optional[str] = None,
        **numbers: float,
    ) -> None:
        options = ffi.new("conus_selector_options *")
        for name, value in {**numbers, "resolution": resolution, "radius": radius}.items():
            if name not in _NUMBERS:
                raise TypeError(f"{name} is no keyword of a selector")
            setattr(options, name, _NUMBERS[name](name, value))
        words = [optional(written, "level", level), optional(utf8, "score", score), optional(utf8, "prior", prior)]
        options.weight = self._weight = _weight_of(weight)
        by_depth = weight is not None and bool(lib.conus_weight_needs_layers(self._weight))
        layers = ("all" if by_depth else "visible") if layers is None else layers
        options.layers = choice("layers", layers, ("visible", "all"))
        if by_depth and layers == "visible":
            raise ArgumentError("weight: it depends on the depth, which needs layers=\"all\"")
        options.aperture = choice("aperture", aperture, ("circle", "square"))
        options.sampling = choice("sampling", sampling, ("exact", "slices"))
        options.engine = choice("engine", engine, ("auto", "rays", "gl"))
        options.range = vector("range", range, 2)
        if weight is not None and options.radius == 0:
            own = lib.conus_weight_radius(self._weight)
            options.radius = 0 if math.isnan(own) else own
        if weight is not None and tuple(options.range) == (0, 0):
            lib.conus_weight_range(options.range, self._weight)
        options.level, options.score, options.prior = words
        self._weights = _weight_columns(weight, score, prior)
        self.space = space_of(atlas._p, space, bregma)
        options.frame = self.space._frame if self.space else ffi.NULL
        self._owner = GLOwner() if engine == "gl" else None
        self.atlas = atlas
        self._layers = layers == "all"
        self._is_cylinder = options.radius > 0
        self._options = options, words
        self._begin()
        super().__init__()

    def _begin(self) -> None:
        out = ffi.new("conus_selector **")
        check(lib.conus_selector_create(out, self.atlas._p, self._options[0]))
        destroy = lib.conus_selector_destroy
        self._p = owned(out[0], self._owner.ender(destroy) if self._owner else destroy, self.atlas._p, self._weight)
        self._is_asked = False
        self._aims: Optional[Aims] = None

    def _leave(self) -> None:
        """What was being asked stays half done: nothing frees it, and a new one answers."""
        for left in [self] + ([self._aims] if self._aims else []):
            ffi.gc(left._p, None)
        if not self._owner:  # OpenGL does not cross a fork
            self._begin()

    def _check_made(self, selector: Any) -> None:
        """What was made of the pointer that a fork left behind is half done, too."""
        if selector is not self._p:
            raise Error("the process was forked while another thread asked the selector of this: make it anew")

    def _point(self, name: str, point: Any, other: Any = None, has_axis: bool = False) -> Any:
        """World mm of a point in the selector's space, or of a place in words."""
        if isinstance(point, str):
            frame = self.space._frame if self.space else ffi.NULL
            return place_of(self.atlas._p, name, point, frame, other, has_axis).point
        return self.space.to_world(name, point) if self.space else point

    def _ends(self, origin: Any, toward: Any) -> tuple[Any, Any]:
        """Both ends of an axis; that which is near:AREA comes last, since it needs the other."""
        if isinstance(origin, str) and lib.conus_place_is_near(utf8("origin", origin)):
            if isinstance(toward, str) and lib.conus_place_is_near(utf8("toward", toward)):
                raise ArgumentError("origin and toward: near: is nearest to the other end, which is no near: then")
            toward = self._point("toward", toward, None, True)
            return self._point("origin", origin, toward, True), toward
        origin = self._point("origin", origin, None, toward is not None)
        return origin, self._point("toward", toward, origin, True)

    def _pose(self, origin: Any, toward: Any, direction: Any, up: Any, pose: Any) -> Any:
        """A conus_pose of what is given in the selector's space."""
        origin, toward = self._ends(origin, toward)
        if self.space:
            direction = self.space.directions_to_world("direction", direction)
            up, pose = self.space.directions_to_world("up", up), self.space.matrices_to_world("pose", pose)
        return pose_of(origin, toward, direction, up, pose, frame_of(self.space, self.atlas._p, pose))

    def _poses(
        self, origins: Any, directions: Any, poses: Any, up: Any, angle: Any, near: Any = None, far: Any = None,
    ) -> PoseArray:
        """The same of many. Those of a file are of the world already."""
        if isinstance(poses, Poses):
            poses.match(self.atlas)
        elif self.space:
            origins = self.space.to_world("origins", origins)
            directions = self.space.directions_to_world("directions", directions)
            up, poses = self.space.directions_to_world("up", up), self.space.matrices_to_world("poses", poses)
        matrices = poses.matrices if isinstance(poses, Poses) else poses
        frame = frame_of(None if isinstance(poses, Poses) else self.space, self.atlas._p, matrices)
        return PoseArray(origins, directions, poses, up, angle, near, far, frame)

    def _place(self, answer: Any) -> Any:
        """Says to an answer in which space its positions are shown."""
        answer.space = self.space
        return answer

    def _table(self, ask: Any, *question: Any) -> Table:
        """The answer of a function of the library."""
        out = ffi.new("conus_table **")
        self._call(ask, out, self._p, *question)
        return Table(out[0])

    def _angle(self, angle: Optional[float]) -> float:
        if angle is None:
            own = float(lib.conus_weight_angle(self._weight)) if self._weight else math.nan
            return 0.0 if self._is_cylinder else (10.0 if math.isnan(own) else own)
        angle = real("angle", angle)
        if not (angle == 0 if self._is_cylinder else 0 < angle < 180):
            allowed = "0 of a cylinder" if self._is_cylinder else "more than 0 and less than 180"
            raise ArgumentError(f"angle: {angle:g} degrees, allowed is {allowed}")
        return angle

    def select(
        self,
        origin: Any = None,
        *,
        toward: Any = None,
        direction: Any = None,
        up: Any = None,
        pose: Any = None,
        angle: Optional[float] = None,
    ) -> Selection:
        """Answers what is in one cone of ``angle`` degrees (10): see :meth:`Atlas.select`."""
        aim, out = self._pose(origin, toward, direction, up, pose), ffi.new("conus_selection **")
        opening = self._angle(angle)
        self._call(lib.conus_select, out, self._p, aim, opening)
        selection: Selection = self._place(Selection(self, out[0]))
        selection._asked = aim, None if toward is None else self._ends(origin, toward)[1], opening
        self._warn_of(aim, opening)
        return selection

    def near(self, point: Any, radius: float = 0) -> Selection:
        """Answers what is at a point, or near it: ``conus query --point``.

        Parameters
        ----------
        point
            (3,) RAS mm, or a place in words, "left hippocampus" (:meth:`Atlas.place`).
        radius
            mm; 0 is what is at the point or, where nothing is, what is nearest to it.

        Returns
        -------
        Selection
            It has no pixels, hence no picture.
        """
        out = ffi.new("conus_selection **")
        at = vector("point", self._point("point", point))
        self._call(lib.conus_select_ball, out, self._p, at, real("radius", radius))
        near: Selection = self._place(Selection(self, out[0]))
        near._point = np.array(list(at), np.float64)
        return near

    def near_many(self, points: Any, radius: float = 0, *, threads: Optional[int] = None,
                  progress: Progress = None) -> Answers:
        """Answers what is at each of many points, or near it: ``conus batch`` of a file of points.

        Parameters
        ----------
        points
            (n, 3) RAS mm, or what :func:`read_poses` gives of a file of points.
        radius
            mm, as for :meth:`near`.
        threads, progress
            As for :meth:`select_many`.

        Returns
        -------
        Answers
            Those of :meth:`near`, by point. A point that is not finite is in ``errors``.

        Raises
        ------
        ArgumentError
            Where the selector has a range: a point has no axis, along which it could be.
        """
        if self._options[0].range[1] > 0:
            raise ArgumentError("range: a point has no axis, along which a range of depths could be")
        names = points._marks() if isinstance(points, Poses) else None
        at = points.origins if isinstance(points, Poses) else points
        at = rows_of("points", self.space.to_world("points", at) if self.space and names is None else at, (3,))
        array = ffi.new("conus_pose_array *", {"count": len(at), "origin": ffi.cast("double *", at.ctypes.data)})
        options, findings = ffi.new("conus_many_options *"), ffi.new("conus_pose_findings *")
        options.threads = 0 if threads is None else whole("threads", threads)
        options.radius = real("radius", radius)
        if options.radius == 0 and self._weight and ffi.string(lib.conus_weight_region(self._weight)) == b"ball":
            options.radius = lib.conus_weight_radius(self._weight)
        with telling(progress, "point", len(at)) as tell:
            collector = _Collector(len(at), tell)
            state = Callback(collector.take)
            handle, select = ffi.new_handle(state), lib.conus_select_many
            self._call(select, findings, self._p, array, options, receive, handle, state=state)
        collector.finish()
        errors = {int(i): "position: finite numbers are needed" for i in np.flatnonzero(collector.status)}
        answers: Answers = self._place(
            Answers(self.atlas, collector.results, collector.starts, errors, self._layers, names, self._weights))
        answers._points = at, options.radius
        return answers

    def contacts(
        self, probe: Probe, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None,
        pose: Any = None, poses: Any = None, roll: float = 0, radius: float = 0,
    ) -> Contacts:
        """Answers what is at each contact of a probe: ``conus query --probe``.

        Parameters
        ----------
        probe
            What :func:`read_probe` gives.
        origin, toward, direction, up, pose
            As of :meth:`Atlas.select`: the tip of the probe, and its direction from base to tip.
        poses
            Instead of these: a pose for each probe of the file, as for :meth:`select_many`. Where poses of a file have
            a far end, the tip is there.
        roll
            Turns the probe about its shank, +y of the device towards its +x, degrees. At 0 the probe's x axis points
            along the device's +x.
        radius
            mm around a contact; 0 = what holds the contact.

        Returns
        -------
        Contacts
            The answers in the order of the file.
        """
        if not isinstance(probe, Probe):
            raise ArgumentError(f"probe: {shown(probe)}, wanted is what conus.read_probe() gives")
        if poses is None:
            if len(probe.tips) > 1:
                raise ArgumentError(f"poses: a pose for each of the {len(probe.tips)} probes is needed")
            placed = self._pose(origin, toward, direction, up, pose)
        else:
            if any(other is not None for other in (origin, toward, direction, up, pose)):
                raise ArgumentError("poses: without origin, toward, direction, up and pose")
            placed = poses_of_probe(self._poses(None, None, poses, None, None), probe)
        points = probe._place(placed, len(probe.tips), roll)
        ball, out = real("radius", radius) or 1e-6, ffi.new("conus_selection **")
        found: list[Array] = []
        for point in points:
            self._call(lib.conus_select_ball, out, self._p, point.tolist(), ball)
            selection = owned(out[0], lib.conus_selection_destroy)
            first = lib.conus_selection_result(selection, 0)
            found.append(array_of(first, lib.conus_selection_count(selection), RESULT))
        starts = np.cumsum([0] + [len(results) for results in found])
        contacts: Contacts = self._place(Contacts(probe, points, self.atlas, np.concatenate(found), starts))
        return contacts

    def segments(
        self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
    ) -> Table:
        """Lists what the axis of a device passes, in order of depth: ``conus query --segments``.

        Parameters
        ----------
        origin, toward, direction, up, pose
            As of :meth:`Atlas.select`.

        Returns
        -------
        Table
            A row for each stretch inside an object, occluded or not, and between objects. The selector's range and
            level hold; its radius, engine and sampling do not matter.
        """
        aim = self._pose(origin, toward, direction, up, pose)
        segments = self._table(lib.conus_segments, aim)
        self._warn_of(aim, self._angle(None), may_be_inside=True)
        return segments

    def segments_many(
        self, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None, near: Any = None,
        far: Any = None,
    ) -> Table:
        """Lists what the axes of many devices pass: ``conus batch --segments``.

        Parameters
        ----------
        origins, directions, poses, up, near, far
            As for :meth:`select_many`.

        Returns
        -------
        Table
            The rows of all poses. A pose that has no axis is in ``errors``.
        """
        array = self._poses(origins, directions, poses, up, None, near, far)
        with self._lock:  # the range is that of one pose after the other
            return Table.of_poses(array, self._p, lambda pose: self._table(lib.conus_segments, pose))

    def clearance(
        self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
        within: float = 10,
    ) -> Table:
        """How far a needle stays from each object, the nearest first: ``conus query --clearance``.

        Parameters
        ----------
        origin, toward, direction, up, pose
            As of :meth:`Atlas.select`.
        within
            mm; objects with a larger clearance are left out. ``math.inf`` leaves none out.

        Returns
        -------
        Table
            A row for each object, occluded or not. The selector's range is that of the needle, its radius the
            needle's, and its level holds.
        """
        aim = self._pose(origin, toward, direction, up, pose)
        clearances = self._table(lib.conus_clearance, aim, _distance("within", within))
        self._warn_of(aim, self._angle(None), may_be_inside=True)
        return clearances

    def clearance_many(
        self, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None, near: Any = None,
        far: Any = None, within: float = 10,
    ) -> Table:
        """How far many needles stay from each object: ``conus batch --clearance``.

        Parameters
        ----------
        origins, directions, poses, up, near, far
            As for :meth:`select_many`.
        within
            As of :meth:`clearance`.

        Returns
        -------
        Table
            The rows of all poses. A pose that has no axis is in ``errors``.
        """
        array = self._poses(origins, directions, poses, up, None, near, far)
        within = _distance("within", within)
        with self._lock:
            return Table.of_poses(array, self._p, lambda pose: self._table(lib.conus_clearance, pose, within))

    def plan(
        self,
        reach: Any = (),
        avoid: Any = (),
        *,
        poses: Any = None,
        origins: Any = None,
        directions: Any = None,
        entries: Any = None,
        targets: Any = None,
        tilt: Any = None,
        roll: Optional[float] = None,
        shanks: Any = None,
        near: Any = None,
        depth: Any = None,
        length: Any = None,
        lean: Any = (),
        apart: Any = (),
        first: Any = (),
        entry_angle: Optional[float] = None,
        arc_window: Any = None,
        angle: Optional[float] = None,
        top: Optional[int] = 20,
        rank: Optional[str] = None,
        score: Optional[str] = None,
        infeasible: bool = False,
        jitter: Any = None,
        samples: int = 0,
        contacts: Any = None,
        maps: bool = False,
        threads: Optional[int] = None,
    ) -> Plan:
        """Lists the poses of needles that reach some structures and stay clear of others: ``conus plan``.

        The selector's radius is that of the needle. All constraints must hold. A plan is a list to be checked.

        Parameters
        ----------
        reach
            Names and mm: {"Hippocampus_L": 5}; names between commas, or a tuple of them, are one structure. None in
            place of the number: any length at all; "tip" or "crossed"; or a mapping: {"length": 5, "part": (0, 2)}.
            A list of names asks for any length. {"contacts": 3} or {"probability": 0.5} are of contacts; the latter, of
            maps of probabilities, without contacts the mean along the axis. Of the cone or cylinder, at least:
            {"share": 0.3}, or, of a selector with layers="all", "pierced", "volume" (mm^3), "fraction" or
            "streamlines".
        avoid
            Names and the margin, mm: {"Insula_L": 2}. A list has the margin 0. {"share": 0.1} or {"pierced": 0.1} in
            place of the margin: at most so much of the cone or cylinder.
        poses, origins, directions
            The candidates, as for :meth:`select_many`.
        entries, targets
            Or the candidates are needles from every entry to every target. Entries: a surface's file, a mask's, an
            (n, 3) array, or the :class:`Poses` of a file of points; with keys as a tuple, ("scalp.surf.gii",
            {"spacing": 3, "within": WHAT, "without": WHAT, "flip": True}), where WHAT is a file of labels, a mask or
            names. Targets: "centroid", "deepest" or "voxels" of the first reach, or of ("voxels", {"of": names,
            "spacing": 2}); "normal", against the entries' normals; an array or Poses.
        tilt
            (MAX, STEP) degrees: and rings of directions around each.
        roll
            Degrees: each is also turned about its axis in such steps.
        shanks
            (n, 2) mm along the device's x and y: where its parallel needles are beside its axis. The key "shank" of a
            reach or avoid, {"length": 5, "shank": "all"}, is "any" (default of a reach), "all" (else) or a number from 1.
        near, depth
            Both ends of the needles, mm from the apex, one number or (n,); not given, those of the file, or of the
            selector's range. With entries, depth is one number, or "target+3".
        length
            (MIN, MAX) mm from end to end.
        lean
            [(direction, degrees)]: the axis and the world's direction enclose at most so much.
        apart
            [(ends, mm)]: the axis is farther than that from other needles, whose ends are (n, 2, 3) RAS mm.
        first
            Names of structures that the axis passes first.
        entry_angle
            The axis and the inward normal at the entry enclose at most so many degrees.
        arc_window
            ((A0, A1), (M0, M1)) degrees: the arc and the slider angle of a rig are between these.
        angle
            Opening of the cone, degrees, of poses that have none of their own; 10 unless there is a radius.
        top
            Poses to list; None = all.
        rank, score
            As of the program: "leeway,-depth" by default.
        infeasible
            Lists the others, too, behind those.
        jitter, samples
            Normal errors, for the columns p_ok and p_reach1 …: standard deviations (degrees, mm) of the tilt and the
            position, or {"entry": mm, "target": mm, "depth": mm}; of how many poses, a power of two, 0 = 1024.
        contacts
            (count, columns, pitch, tip): so many on the axis, in rows of so many, mm from row to row, and from the far
            end to the first.
        maps
            Keeps the best pose of each entry and target, for :meth:`Plan.map`, which takes longer.
        threads
            None = as many as processors.

        Raises
        ------
        ArgumentError
            For names that are unknown, numbers out of their ranges, and no candidate at all.
        """
        sources: Optional[dict[str, Array]] = {} if flag("maps", maps) else None
        constraints = constraints_of(reach, avoid, length, lean, apart, first, entry_angle, arc_window, contacts)
        stream, far, errors = self._candidates(constraints, sources, poses, origins, directions, entries, targets, tilt,
                                               roll, near, depth)
        return plan_of(self, constraints, stream, errors, far, infeasible, top, threads, angle, shanks,
                       (rank, score), jitter, samples, sources)

    def _candidates(
        self, constraints: Constraints, sources: Optional[dict[str, Array]], poses: Any = None, origins: Any = None,
        directions: Any = None, entries: Any = None, targets: Any = None, tilt: Any = None, roll: Any = None,
        near: Any = None, depth: Any = None,
    ) -> tuple[Callable[[], ContextManager[Any]], Optional[float], Mapping[int, str]]:
        """What opens the candidates of :meth:`plan`, the far end of all of them, and why some are none."""
        if entries is None:
            if targets is not None or tilt is not None or roll is not None or sources is not None:
                raise ArgumentError("targets, tilt, roll and maps have no effect without entries")
            array = self._poses(origins, directions, poses, None, None)
            return lambda: stream_of(array, poses, near, depth), None, array.reasons
        if targets is None or not all(given is None for given in (poses, origins, directions, near)):
            raise ArgumentError("entries: targets go with them, and no poses, origins, directions or near")
        far, beyond = depth_of(depth)
        return candidates_of(self, entries, targets, tilt, roll, beyond, constraints.reached(), sources), far, {}

    def tolerance(self, reach: Any = (), avoid: Any = (), *, pivot: Any = "entry", **options: Any) -> pandas.DataFrame:
        """By how much needles may be off before a constraint breaks: :meth:`Plan.tolerance` of all given poses.

        ``options`` are those of :meth:`plan`. Of a pose that breaks a constraint as it is all are 0.
        """
        given: dict[str, Any] = {"infeasible": True, "top": None, **options}
        return self.plan(reach, avoid, **given).tolerance(pivot)

    def sweep(
        self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
        angle: float = 60,
    ) -> Table:
        """At which opening a growing cone admits each object: ``conus sweep``.

        Parameters
        ----------
        origin, toward, direction, up, pose
            As of :meth:`Atlas.select`.
        angle
            Full opening to which it grows, degrees.

        Returns
        -------
        Table
            The narrowest first.
        """
        aim, opening = self._pose(origin, toward, direction, up, pose), real("angle", angle)
        sweep = self._table(lib.conus_sweep, aim, opening)
        self._warn_of(aim, opening)
        return sweep

    def jitter(
        self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
        angle: Optional[float] = None, degrees: float = 0, mm: float = 0, samples: int = 0,
        error: Optional[str] = None,
    ) -> Table:
        """The chances of each object under errors of the pose: ``conus sweep --jitter``.

        Parameters
        ----------
        origin, toward, direction, up, pose, angle
            As of :meth:`Atlas.select`.
        degrees
            Standard deviation of the axis's tilt about each of two axes, 0 to 90.
        mm
            Standard deviation of the position along each of three.
        samples
            Poses to trace from, a power of two from 16 to 1048576; 0 = 1024. They are always the same.
        error
            In place of degrees and mm, the name of a published error: see :func:`conus.errors`.

        Returns
        -------
        Table
            The most probable first.
        """
        aim = self._pose(origin, toward, direction, up, pose)
        options, opening = ffi.new("conus_jitter_options *"), self._angle(angle)
        options.tilt, options.shift = real("degrees", degrees), real("mm", mm)
        options.samples = whole("samples", samples)
        if error is not None:
            if degrees or mm:
                raise ArgumentError("error: it has degrees and mm of its own")
            law = error_of("error", error)
            if law.entry > 0:
                raise ArgumentError(f"error: {error} is an error of needles, which plan(jitter=...) knows")
            options.tilt, options.shift = law.tilt_deg, law.shift
        jitter = self._table(lib.conus_jitter, aim, opening, options)
        self._warn_of(aim, opening)
        return jitter

    def connectivity(self, radius: float = 2.0, selection: Optional[Selection] = None) -> Table:
        """Which areas the bundles connect: ``conus connect``.

        Parameters
        ----------
        radius
            mm, up to 100: an end of a streamline that is in no area has the nearest one within it.
        selection
            Only streamlines that come into its cone or ball; None = all.

        Returns
        -------
        Table
            By bundle, the most streamlines first; :meth:`Table.matrix` is areas by areas. ``part("pairs")`` has the
            streamlines of all bundles together, each once, and ``part("areas")`` those that a matrix has: all with
            voxels or triangles, or, of an atlas loaded with ``only``, its areas in that order, so that tables of
            several subjects have one size; the last row is that of ends in no area. ``area_a`` and ``area_b`` of pairs
            are rows of areas.

        Raises
        ------
        ArgumentError
            For an atlas without streamlines.
        """
        atlas = self.atlas._p
        count = lib.conus_atlas_object_count(atlas)
        bundles = [i for i in range(1, count + 1) if lib.conus_atlas_object(atlas, i).kind == lib.CONUS_KIND_BUNDLE]
        if not bundles:
            raise ArgumentError("there are no streamlines, load(..., streamlines=[FILE]) adds some")
        if all(lib.conus_atlas_is_hidden(atlas, i) for i in bundles):
            raise ArgumentError("all streamlines are hidden: only names the bundles to keep beside areas")
        radius = real("radius", radius)
        if not 0 <= radius <= 100:
            raise ArgumentError(f"radius: {radius:g} mm round an end, allowed are 0 to 100")
        chosen = ffi.NULL if selection is None else selection._p
        return self._table(lib.conus_connectivity, chosen, radius or -1, True)  # 0 is the library's default

    def overlap(self, roi: Any, threshold: float = 0, *, max_memory: int = 0) -> Table:
        """Which objects a region of interest covers: ``conus overlap``.

        Parameters
        ----------
        roi
            A path, a nibabel image, or (array, affine), in the atlas's space. A path may be that of a field of SimNIBS
            in HDF5, ``"FILE.hdf5,tissue=2"``: its tetrahedra are the region.
        threshold
            From which value on a voxel or tetrahedron belongs to the region; of a negative one, down from it. 0 = all
            but 0, of masks only.
        max_memory
            Largest file and volume in bytes; 0 = 8 GiB.

        Returns
        -------
        Table
            The largest volume first; last what is in no object. Unlike the program's, it always has
            ``volume_error_mm3``, 0 where a volume is exact.
        """
        region = _region(roi, threshold, byte_count("max_memory", max_memory))
        return self._table(lib.conus_overlap, region)

    def clusters(self, roi: Any, threshold: float = 0, *, max_memory: int = 0) -> Table:
        """The clusters of a region of interest, what each covers, and its local maxima: ``conus overlap --clusters``.

        Voxels with a face, an edge or a corner in common are one cluster. Parameters are those of :meth:`overlap`; a
        region of tetrahedra has no clusters.
        """
        region = _region(roi, threshold, byte_count("max_memory", max_memory))
        return self._table(lib.conus_clusters, region)

    def select_many(
        self,
        origins: Any = None,
        directions: Any = None,
        *,
        poses: Any = None,
        up: Any = None,
        angle: Any = None,
        near: Any = None,
        far: Any = None,
        threads: Optional[int] = None,
        progress: Progress = None,
    ) -> Answers:
        """Answers what is in each of many cones.

        Parameters
        ----------
        origins, directions, up
            (n, 3) RAS mm.
        poses
            Instead of these: what :func:`read_poses` gives, or (n, 4, 4) matrices from device to world; a device
            points along its -z.
        angle
            Degrees, one number or (n,); 10 if not given. One number is of poses whose file has none of their own.
        near, far
            (n,) mm: each pose's own range, in place of that of a file; NaN and None = that of the selector.
        threads
            None = as many as processors.
        progress
            True shows tqdm's bar, if tqdm is installed; a function is called with (done, all).

        Returns
        -------
        Answers
            The same, to the bit, for any number of threads. A pose that has no answer is in ``errors``.

        Raises
        ------
        ArgumentError
            For arrays that do not fit together, and for one angle out of its range.
        """
        array = self._poses(origins, directions, poses, up, angle, near, far)
        options, findings = ffi.new("conus_many_options *"), ffi.new("conus_pose_findings *")
        options.threads = 0 if threads is None else whole("threads", threads)
        options.angle = self._angle(None if np.ndim(angle) else angle)
        with telling(progress, "pose", len(array)) as tell:
            collector = _Collector(len(array), tell)
            state = Callback(collector.take)
            handle, select = ffi.new_handle(state), lib.conus_select_many
            self._call(select, findings, self._p, array.struct, options, receive, handle, state=state)
        collector.finish()
        errors = {i: self._reason(array, i, options.angle) for i in map(int, np.flatnonzero(collector.status))}
        self._warn(findings, many=True)
        answers: Answers = self._place(
            Answers(self.atlas, collector.results, collector.starts, errors, self._layers, array.names, self._weights))
        return answers

    def tracker(self, **constants: Any) -> Tracker:
        """Creates a tracker, which follows a device from step to step: see :class:`Tracker` for its constants."""
        return Tracker(self, **constants)

    def track(
        self,
        times_s: Any,
        origins: Any = None,
        directions: Any = None,
        *,
        poses: Any = None,
        up: Any = None,
        angle: Any = None,
        trigger: Any = None,
        progress: Progress = None,
        **constants: Any,
    ) -> Track:
        """Answers what a moving device selects, step by step, as ``conus track`` does for a file.

        Parameters
        ----------
        times_s
            (n,) seconds of any clock.
        origins, directions, poses, up, angle, progress
            As for :meth:`select_many`.
        trigger
            (n,) whether it is held down.
        **constants
            Those of :class:`Tracker`.

        Returns
        -------
        Track
            A step that has no answer (a number that is not finite, a time before the last step) is
            left out with a :class:`PoseWarning`, as a lost frame is.
        """
        tracker, array = Tracker(self, **constants), self._poses(origins, directions, poses, up, angle)
        default = self._angle(None if np.ndim(angle) else angle)
        with telling(progress, "step", len(array)) as tell:
            followed: Track = self._place(follow(tracker, times_s, array, default, trigger, tell))
            return followed

    def _call(self, function: Any, *arguments: Any, state: Optional[Callback] = None) -> None:
        """Asks the library; one thread at a time does."""
        self.atlas._p  # pylint: disable=pointless-statement  # raises if it is closed
        if self._owner:
            self._owner.check("selector")
        with self._lock:
            if self._is_asked:
                raise ArgumentError("selector: a callback may not ask the selector that calls it, but another")
            self._is_asked = True
            try:
                status = function(*arguments)
            finally:
                self._is_asked = False
        (state.check if state else check)(status)

    def _warn_of(self, pose: Any, angle: float, may_be_inside: bool = False) -> None:
        """Warns where one pose looks wrong."""
        with self._lock:
            self._aims = self._aims or Aims(self._p)
            found = self._aims.of(pose, angle)
        if may_be_inside:
            found.inside.count = 0
        self._warn(found)

    def _warn(self, found: Any, many: bool = False) -> None:
        if found.inside.count or found.away.count or found.tiny.count:
            with self._lock:
                notes = notes_of(found, self._p, self.atlas._p, many)
            warn(notes)

    def _reason(self, array: PoseArray, index: int, angle: float) -> str:
        """Why a pose has no answer: asks for it alone, where its file does not say it."""
        if index in array.reasons:
            return array.reasons[index]
        pose, out = ffi.new("conus_pose *"), ffi.new("conus_selection **")
        with self._lock:
            status = array.fill(pose, index) or lib.conus_selector_set_range(self._p, array.range(index))
            status = status or lib.conus_select(out, self._p, pose, array.angle(index, angle))
            reason = message() if status else ""
            lib.conus_selector_set_range(self._p, ffi.NULL)
        if not status:
            lib.conus_selection_destroy(out[0])
        return reason

    def __repr__(self) -> str:
        return f"<conus.Selector of {self.atlas!r}, engine {text(lib.conus_selector_engine(self._p))}>"


class Atlas:
    """Areas, pathways and bundles of one brain; :func:`load` makes one. It does not change."""

    def __init__(self, pointer: Any) -> None:
        self._pointer = pointer
        self._selectors: dict[Any, Selector] = {}
        self.objects = Objects(pointer)

    @property
    def _p(self) -> Any:
        if self._pointer is None:
            raise ArgumentError("atlas: it is closed")
        return self._pointer

    def close(self) -> None:
        """Frees the memory, once no answer of it is left. Asking it afterwards is an error."""
        self._pointer = None
        self._selectors.clear()

    def __enter__(self) -> Atlas:
        return self

    def __exit__(self, *unused: object) -> None:
        self.close()

    def __len__(self) -> int:
        return len(self.objects.names) - 1

    def __repr__(self) -> str:
        return f"<conus.Atlas of {len(self)} objects>"

    def save(self, path: Path) -> None:
        """Writes the atlas as it is to a pack, a file that ends in .conus and that :func:`load` opens at once."""
        check(lib.conus_atlas_save(path_of("path", path), self._p, ffi.NULL))

    def __reduce__(self) -> Any:
        size = lib.conus_atlas_packed_size(self._p)
        memory = _aligned(size)
        check(lib.conus_atlas_pack(ffi.cast("void *", memory.ctypes.data), size, self._p))
        return _unpack, (memory.tobytes(), _sum_of(memory))

    def table(self, what: str) -> Table:
        """What the atlas has, as a table: its "objects", "surfaces", "tractograms", "files" or "notes"."""
        return ask_table(lib.conus_atlas_list, self._p, utf8("what", what))

    def find(self, name: Union[str, int]) -> int:
        """The number of an object, by its name, abbreviation or label; an ArgumentError if there is none."""
        out = ffi.new("uint32_t *")
        check(lib.conus_atlas_find(out, self._p, (written if isinstance(name, int) else utf8)("name", name)))
        return int(out[0])

    def place(self, words: str) -> Place:
        """The point that words mean, as for ``--point``: ``origin``, ``toward`` and ``point`` take them, too.

        Parameters
        ----------
        words
            An area ("left hippocampus": its inner point), "centroid:AREA", a position of a cap ("C3", "1020:C3"), or
            three numbers as people paste them, RAS mm.

        Raises
        ------
        ArgumentError
            For words that mean nothing, or several things.
        """
        return place_of(self._p, "place", words, ffi.NULL)

    def inward(self, point: Any) -> Any:
        """The direction straight into the head at a point on it, as of ``--inward``.

        Parameters
        ----------
        point
            (3,) RAS mm, or a place in words.

        Returns
        -------
        array
            (3,) of length 1: of a position ("C3") against the scalp's normal in the published table, where it has
            one; else against that of the context's head within 5 mm, or the way to the atlas's convex hull.

        Raises
        ------
        ArgumentError
            For a point inside of the hull.
        """
        place = self.place(point) if isinstance(point, str) else None
        if place is not None and place.outward.any():
            return -place.outward / np.linalg.norm(place.outward)
        out = ffi.new("double[3]")
        check(lib.conus_atlas_inward(out, ffi.NULL, self._p, vector("point", point if place is None else place.point)))
        return np.array(list(out))

    @property
    def notes(self) -> list[str]:
        """Notes from loading the atlas."""
        return [python_words(note) for note in self.table("notes")["text"][1:]]  # the first is about labels

    @property
    def warnings(self) -> list[str]:
        """Those of the notes that warn: an answer may name another place or another area than the data mean."""
        notes = self.table("notes")
        return [python_words(note) for kind, note in zip(notes["kind"], notes["text"]) if kind in ("warning", "exchanged")]

    @property
    def brain(self) -> str:
        """Whose brain it is, as far as that is known: "Colin 27", "MNI 152, NLin2009", "one person's own", "unknown"."""
        return text(lib.conus_atlas_brain(self._p).words)

    @property
    def exchanged(self) -> Optional[str]:
        """The note that left and right are exchanged, of the names or of the places; None where they are not."""
        notes = self.table("notes")
        return next((python_words(note) for kind, note in zip(notes["kind"], notes["text"]) if kind == "exchanged"), None)

    @property
    def tractograms(self) -> list[Tractogram]:
        """The tractograms whose streamlines are bundles of the atlas, as they were added."""
        return tractograms_of(self._p)

    @property
    def sides(self) -> Array:
        """(n + 1,) "L", "R" or "" by number: of areas by the label table, their names or the tree; "" of others."""
        letters = {"left": "L", "right": "R"}
        return np.array(["", *(letters.get(side, "") for side in self.table("objects")["side"])], object)

    def placement(self) -> Placement:
        """Where the areas lie, also in the atlas's own space, and what of them is in the head of the context."""
        place = ffi.new("conus_placement *")
        place.struct_size = ffi.sizeof("conus_placement")
        check(lib.conus_atlas_placement(place, self._p))
        low, high, own_low, own_high = ([*corner] for corner in (place.low, place.high, place.own_low, place.own_high))
        shares = (place.in_grid, place.in_head) if place.has_context else (None, None)
        return Placement(
            np.array([*place.atlas_from_world]).reshape(4, 4).T, place.growth, bool(place.mirrors),
            np.array([own_low, own_high]), np.array([low, high]), np.array([*place.centre]), place.distance_mm, *shares)

    def info(self) -> pandas.DataFrame:
        """One row for each area, pathway and bundle."""
        import pandas

        entries = [lib.conus_atlas_object(self._p, i) for i in range(1, len(self) + 1)]
        return pandas.DataFrame(
            {
                "kind": [kind_word(e.kind) for e in entries],
                "index": [e.label for e in entries],
                "name": [text(e.name) for e in entries],
                "abbreviation": [text(e.abbreviation) for e in entries],
                "hemisphere": [e.hemisphere.decode().strip("\0") for e in entries],
                "parent": [e.parent for e in entries],
                "voxels": [e.voxels for e in entries],
                "volume_mm3": [e.volume_mm3 for e in entries],
                "triangles": [e.triangles for e in entries],
                "streamlines": [e.streamlines for e in entries],
                "length_mm": [e.length_mm for e in entries],
            },
            index=pandas.RangeIndex(1, len(self) + 1, name="object"),
        )

    def selector(self, **options: Any) -> Selector:
        """An atlas made ready to answer: see :class:`Selector`."""
        return Selector(self, **options)

    def _selector(self, options: dict[str, Any]) -> Selector:
        self._p  # pylint: disable=pointless-statement  # raises if it is closed
        thread = threading.get_ident() if options.get("engine") == "gl" else 0
        plain = {name: v.tolist() if isinstance(v, np.ndarray) else v for name, v in options.items()}
        files = [_state_of_file(name, options.get(name)) for name in ("weight", "prior")]
        key = thread, shown(sorted(plain.items()), None), *files
        if key not in self._selectors:
            self._selectors[key] = Selector(self, **options)
        return self._selectors[key]

    def select(
        self,
        origin: Any = None,
        *,
        toward: Any = None,
        direction: Any = None,
        up: Any = None,
        pose: Any = None,
        angle: Optional[float] = None,
        **options: Any,
    ) -> Selection:
        """Answers what is in one cone.

        Parameters
        ----------
        origin
            The cone's apex, RAS mm, or as the option ``space`` says; or a place in words, "C3" (:meth:`place`).
        toward, direction
            A point that the cone points at, "left hippocampus" for example, or its direction, of any length but 0.
        up
            Up direction of the device; it turns the buffer of rays.
        pose
            Instead of these: a (4, 4) matrix from device to world; the device points along its -z.
        angle
            Full opening, degrees; 10 if not given.
        **options
            Those of :class:`Selector`: layers="all", resolution=64, ...

        Returns
        -------
        Selection
            The hits, best first.

        Raises
        ------
        ArgumentError
            For a pose or an option that is none.

        Warns
        -----
        PoseWarning
            Where the pose looks as if it came from another space or unit.
        """
        return self._selector(options).select(
            origin, toward=toward, direction=direction, up=up, pose=pose, angle=angle
        )

    def renderer(self, *, transfer: Any = None, max_memory: int = 0, pathway_transfers: Any = None,
                 streamline_colour: Optional[str] = None, engine: str = "auto") -> Renderer:
        """The atlas made ready to be drawn again and again: see :class:`Renderer`."""
        return Renderer(self, transfer=transfer, max_memory=max_memory, pathway_transfers=pathway_transfers,
                        streamline_colour=streamline_colour, engine=engine)

    def render(self, selection: Optional[Selection] = None, *, transfer: Any = None, max_memory: int = 0,
               pathway_transfers: Any = None, streamline_colour: Optional[str] = None, engine: str = "auto",
               **view: Any) -> Picture:
        """Draws one picture in space, as ``conus render`` does.

        Parameters
        ----------
        selection
            Its cone is drawn, with a legend.
        transfer, max_memory, pathway_transfers, streamline_colour, engine
            As of :class:`Renderer`.
        **view
            Those of :meth:`Renderer.render`: size=(700, 525), camera_origin=(0, 0, 500), ...

        Returns
        -------
        Picture
            A notebook shows it; ``save("picture.png")`` writes it.

        Raises
        ------
        GLError
            With engine="gl" without an OpenGL 4.5 driver. Debian's libgl1-mesa-dri has one in software.
        """
        with self.renderer(
            transfer=transfer, max_memory=max_memory, pathway_transfers=pathway_transfers,
            streamline_colour=streamline_colour, engine=engine
        ) as renderer:
            return renderer.render(selection, **view)

    def near(self, point: Any, radius: float = 0, **options: Any) -> Selection:
        """Answers what is at a point, or within ``radius`` mm of it: see :meth:`Selector.near`."""
        return self._selector(options).near(point, radius)

    def near_many(self, points: Any, radius: float = 0, *, threads: Optional[int] = None, progress: Progress = None,
                  **options: Any) -> Answers:
        """Answers what is at each of many points, or near it: see :meth:`Selector.near_many`."""
        return self._selector(options).near_many(points, radius, threads=threads, progress=progress)

    def contacts(self, probe: Probe, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None,
                 pose: Any = None, poses: Any = None, roll: float = 0, radius: float = 0, **options: Any) -> Contacts:
        """Answers what is at each contact of a probe: see :meth:`Selector.contacts`."""
        return self._selector(options).contacts(
            probe, origin, toward=toward, direction=direction, up=up, pose=pose, poses=poses, roll=roll, radius=radius
        )

    def select_many(self, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None,
                    angle: Any = None, near: Any = None, far: Any = None, threads: Optional[int] = None,
                    progress: Progress = None, **options: Any) -> Answers:
        """Answers what is in each of many cones: see :meth:`Selector.select_many`."""
        return self._selector(options).select_many(
            origins, directions, poses=poses, up=up, angle=angle, near=near, far=far, threads=threads, progress=progress
        )

    def track(self, times_s: Any, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None,
              angle: Any = None, trigger: Any = None, progress: Progress = None, **options: Any) -> Track:
        """Answers what a moving device selects: see :meth:`Selector.track`.

        ``options`` are those of :class:`Tracker` and of :class:`Selector`: score="intenselect",
        delay=0.2, ...
        """
        constants = {name: options.pop(name) for name in Tracker.CONSTANTS if name in options}
        return self._selector(options).track(
            times_s, origins, directions, poses=poses, up=up, angle=angle, trigger=trigger, progress=progress,
            **constants,
        )

    def segments(self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None,
                 pose: Any = None, **options: Any) -> Table:
        """Lists what the axis of a device passes, in order of depth: see :meth:`Selector.segments`."""
        return self._selector(options).segments(origin, toward=toward, direction=direction, up=up, pose=pose)

    def segments_many(self, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None,
                      near: Any = None, far: Any = None, **options: Any) -> Table:
        """Lists what the axes of many devices pass: see :meth:`Selector.segments_many`."""
        return self._selector(options).segments_many(origins, directions, poses=poses, up=up, near=near, far=far)

    def clearance(self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None,
                  pose: Any = None, within: float = 10, **options: Any) -> Table:
        """How far a needle stays from each object, the nearest first: see :meth:`Selector.clearance`."""
        return self._selector(options).clearance(
            origin, toward=toward, direction=direction, up=up, pose=pose, within=within
        )

    def clearance_many(self, origins: Any = None, directions: Any = None, *, poses: Any = None, up: Any = None,
                       near: Any = None, far: Any = None, within: float = 10, **options: Any) -> Table:
        """How far many needles stay from each object: see :meth:`Selector.clearance_many`."""
        return self._selector(options).clearance_many(
            origins, directions, poses=poses, up=up, near=near, far=far, within=within
        )

    def plan(self, reach: Any = (), avoid: Any = (), *, radius: float = 0, range: Any = (0, 0), space: str = "ras",
             bregma: Any = None, layers: str = "visible", resolution: int = 0, **options: Any) -> Plan:
        """Lists the poses that reach some structures and stay clear of others: see :meth:`Selector.plan`."""
        selector = self._selector({"radius": radius, "range": range, "space": space, "bregma": bregma, "layers": layers,
                                   "resolution": resolution})
        return selector.plan(reach, avoid, **options)

    def plan_together(
        self, needles: Mapping[str, Any], *, between: Any = 0, entry_distance: float = 0, arcs: Any = None, cover: Any = (),
        given: Optional[Poses] = None, top: int = 1, diverse: Any = None, effort: Optional[float] = None,
        threads: Optional[int] = None, **of_all: Any,
    ) -> Together:
        """Plans 1 to 16 needles jointly, and proves that no combination is better: ``conus plan --needles``.

        Parameters
        ----------
        needles
            What each is asked: {"A": {"reach": {"Amygdala_L": 6}}, "B": ...}, with the arguments of :meth:`plan` that
            are about one needle. A list of such mappings are alternatives; "P1,P2" are needles that may each answer.
            Further keys: once (only one needle answers), arc (needles with equal text share an arc, with other text do
            not), parts ([(radius, low, high[, x, y][, "tip"])], mm).
        between
            Surfaces of any two needles are farther apart, mm; or (of shafts, of parts).
        entry_distance
            Positions of any two devices are so far apart at least, mm.
        arcs
            Degrees between the arcs of a rig; or {"spacing": 16, "slider": 10, "same": 0.5, "most": 3, "each": 4,
            "pitch": 14}; the pitch is what arc_window counts from.
        cover
            Names, and how many contacts of all needles are in them at least: {"Hippocampus_L": 10}; None counts only.
        given
            Poses of a file that are called like needles, which stay there.
        top, diverse
            Combinations to list, and by how many mm each differs from those before it; or (mm, needles).
        effort
            The search ends after so many million steps; None = 100.
        threads
            None = as many as processors.
        of_all
            Arguments of all needles, where they have none of their own.

        Raises
        ------
        ArgumentError
            For names that are unknown, numbers out of their ranges, and a needle without any candidate.
        """
        return together_of(self, needles, between, entry_distance, arcs, cover, given, top, diverse, effort, threads, of_all)

    def tolerance(self, reach: Any = (), avoid: Any = (), *, pivot: Any = "entry", **options: Any) -> pandas.DataFrame:
        """By how much needles may be off before a constraint breaks: see :meth:`Selector.tolerance`."""
        given: dict[str, Any] = {"infeasible": True, "top": None, **options}
        return self.plan(reach, avoid, **given).tolerance(pivot)

    def sweep(self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
              angle: float = 60, **options: Any) -> Table:
        """At which opening a growing cone admits each object: see :meth:`Selector.sweep`."""
        return self._selector(options).sweep(
            origin, toward=toward, direction=direction, up=up, pose=pose, angle=angle
        )

    def jitter(self, origin: Any = None, *, toward: Any = None, direction: Any = None, up: Any = None, pose: Any = None,
               angle: Optional[float] = None, degrees: float = 0, mm: float = 0, samples: int = 0,
               error: Optional[str] = None, **options: Any) -> Table:
        """The chances of each object under errors of the pose: see :meth:`Selector.jitter`."""
        return self._selector(options).jitter(
            origin, toward=toward, direction=direction, up=up, pose=pose, angle=angle, degrees=degrees, mm=mm,
            samples=samples, error=error,
        )

    def connectivity(self, radius: float = 2.0, **options: Any) -> Table:
        """Which areas the bundles connect: see :meth:`Selector.connectivity`."""
        return self._selector(options).connectivity(radius)

    def overlap(self, roi: Any, threshold: float = 0, *, max_memory: int = 0,
                **options: Any) -> Table:
        """Which objects a region of interest covers: see :meth:`Selector.overlap`."""
        return self._selector(options).overlap(roi, threshold, max_memory=max_memory)

    def clusters(self, roi: Any, threshold: float = 0, *, max_memory: int = 0,
                 **options: Any) -> Table:
        """The clusters of a region of interest, with areas and maxima: see :meth:`Selector.clusters`."""
        return self._selector(options).clusters(roi, threshold, max_memory=max_memory)


# Pickling


def _aligned(size: int) -> Array:
    """Bytes at a multiple of 64."""
    memory = np.empty(size + 63, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start : start + size]


def _sum_of(packed: Any) -> bytes:
    return hashlib.blake2b(packed, digest_size=16).digest()


def _unpack(packed: bytes, checksum: bytes = b"") -> Atlas:
    if not isinstance(packed, bytes) or _sum_of(packed) != checksum:
        raise DataError("pickled atlas: its bytes are not those that were packed: damaged, or of another version")
    memory = _aligned(len(packed))
    memory[:] = np.frombuffer(packed, np.uint8)
    out = ffi.new("conus_atlas **")
    check(lib.conus_atlas_attach(out, ffi.cast("void *", memory.ctypes.data), len(packed)))
    return Atlas(owned(out[0], lib.conus_atlas_destroy, memory))
