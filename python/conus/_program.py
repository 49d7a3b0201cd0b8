# SPDX-License-Identifier: BSD-3-Clause
"""Functions that run the program ``conus`` and parse its answer, for what the library does not do."""
from __future__ import annotations

import itertools
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from typing import Any, Callable, NamedTuple, NoReturn, Optional, Sequence, Union

import numpy as np

from ._conus import ffi, lib
from ._library import ArgumentError, DataError, FileError, UnsupportedError, python_words, text
from ._table import ask_table

Path = Union[str, "os.PathLike[str]"]


class Difference(NamedTuple):
    """A cell, row or line in which a result and its new answer differ."""

    line: int
    where: str
    """"query 1: area 37 Hippocampus_L: share", or "" where it is no table."""
    recorded: Optional[str]
    """The content of the file; None where it has ended; "this row" or "this column" where the other one has none."""
    again: Optional[str]


class SourceFile(NamedTuple):
    """A file that a result was made from."""

    path: str
    sha256: Optional[str]
    found: Optional[str]
    state: str
    """"same", "moved", "changed", "missing", or "not compared", of a folder."""


class Verification(NamedTuple):
    """The result of ``verify``. It is true where the answer is identical."""

    verdict: str
    """"identical", "different" or "not verified"."""
    same_rows: bool
    why: list[str]
    """Differences from the record, a line each."""
    notes: list[str]
    differences: list[Difference]
    """The first ten."""
    lines_that_differ: int
    files: list[SourceFile]

    def __bool__(self) -> bool:
        return self.verdict == "identical"


def _word(name: str, value: Any) -> str:
    try:
        return os.fsdecode(value)
    except TypeError:
        raise ArgumentError(f"{name}: {value!r}, wanted is a path") from None


def _arguments(what: Path, sidecar: Optional[Path], folder: Optional[Path]) -> list[str]:
    words = [] if sidecar is None else [f"--sidecar={_word('sidecar', sidecar)}"]
    words += [] if folder is None else [f"--folder={_word('folder', folder)}"]
    return [*words, "--", _word("result", what)]


_PACKED = os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "bin", "conus.exe" if os.name == "nt" else "conus"
)  # the wheel's


def main() -> NoReturn:
    """The command ``conus`` of the wheel."""
    if os.name == "nt":  # where exec gives the prompt back before the program's end
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to the program, too, which ends as it should
        sys.exit(subprocess.call([_PACKED, *sys.argv[1:]]))
    os.execv(_PACKED, ["conus", *sys.argv[1:]])


def run_program(*words: str) -> subprocess.CompletedProcess[str]:
    """The program, done: ``$CONUS``, or that of the wheel, or ``conus`` in ``$PATH``."""
    program = os.environ.get("CONUS") or (_PACKED if os.path.exists(_PACKED) else shutil.which("conus"))
    if not program:
        raise FileError("there is no program conus in $PATH, and $CONUS names none")
    try:
        return subprocess.run([program, *words], capture_output=True, encoding="utf-8", check=False)
    except OSError as error:
        raise FileError(f"{program}: {error.strerror}") from None
    except ValueError as error:
        raise ArgumentError(f"path: {error}") from None


def refuse(ended: subprocess.CompletedProcess[str], words: Callable[[str], str] = python_words) -> NoReturn:
    """The exception for what the program said last, in ``words`` of arguments or, of a command line, as it is."""
    errors = {1: DataError, 2: ArgumentError, 3: DataError, 4: UnsupportedError}
    lines = ended.stderr.strip().splitlines() if ended.returncode in errors else []
    lines = lines or [f"conus ended with {ended.returncode}"]  # negative: the signal that ended it
    raise errors.get(ended.returncode, DataError)(words(lines[-1].removeprefix("conus: ")))


def verify(result: Path, *, sidecar: Optional[Path] = None, folder: Optional[Path] = None) -> Verification:
    """Answers a result of the program again from its sidecar and compares, as ``conus verify`` does.

    ``folder`` is where files are that moved or have another name. Runs the program: ``$CONUS``, or
    that of the wheel, or ``conus`` in ``$PATH``.
    """
    ended = run_program("verify", "--format=json", *_arguments(result, sidecar, folder))
    if not ended.stdout:
        refuse(ended)
    found = json.loads(ended.stdout)
    return Verification(
        found["verdict"], found["same_rows"],
        found["why"], found["notes"],
        [Difference(**item) for item in found["differences"]], found["lines_that_differ"],
        [SourceFile(**item) for item in found["files"]],
    )


def cite(
    what: Path, *, format: str = "text", sidecar: Optional[Path] = None, folder: Optional[Path] = None
) -> str:
    """The methods paragraph of a result with its references, or how to cite an atlas, as ``conus cite`` writes it.

    ``format`` is "text" or "bibtex". Runs the program: ``$CONUS``, or that of the wheel, or
    ``conus`` in ``$PATH``.
    """
    ended = run_program("cite", f"--format={format}", *_arguments(what, sidecar, folder))
    if ended.returncode:
        refuse(ended)
    return ended.stdout


def page(
    atlas: Path,
    output: Path,
    *,
    origin: Optional[Sequence[float]] = None,
    toward: Optional[Sequence[float]] = None,
    angle: float = 20.0,
    layers: str = "visible",
    resolution: int = 0,
    context: Optional[Path] = None,
    template: Optional[Path] = None,
) -> str:
    """Writes an HTML file with the atlas, and the answer for a cone inside, as ``conus page`` does; gives its path.

    Whoever has the file moves the cone in any browser, without a network. ``origin`` and ``toward`` are RAS mm,
    ``angle`` degrees; ``atlas`` is a path or the name of an installed atlas. A file that is there is replaced.
    Jupyter shows it by ``IPython.display.IFrame(path, 1280, 800)``. Runs the program: ``$CONUS``, or ``conus`` in
    ``$PATH``.
    """
    words = [f"--output={_word('output', output)}", "--force", "--quiet"]
    if origin is not None and toward is not None:
        points = {"origin": origin, "toward": toward}
        words += [f"--{name}={','.join(repr(float(x)) for x in point)}" for name, point in points.items()]
        words += [f"--angle={float(angle)!r}", f"--layers={layers}"] + ([f"--resolution={int(resolution)}"] if resolution else [])
    elif origin is not None or toward is not None:
        raise ArgumentError("origin and toward: both are needed, or none")
    words += [f"--{name}={_word(name, path)}" for name, path in (("context", context), ("template", template)) if path]
    ended = run_program("page", *words, "--", _word("atlas", atlas))
    if ended.returncode:
        refuse(ended)
    return os.fsdecode(output)


def page_of(hits: Any) -> str:
    """The text of a page with the question of a selection, whose rows must be those of the selection."""
    atlas = hits.atlas._p
    if hits._asked is None:
        raise UnsupportedError("a page has the question of one cone")
    pose, toward, opening = hits._asked
    matrix = np.array(list(pose.world_from_device)).reshape(4, 4)  # rows are its axes; a device points along -z
    toward = (matrix[3, :3] - 100 * matrix[2, :3]).tolist() if toward is None else toward
    others = ask_table(lib.conus_atlas_list, atlas, b"files")
    files = ffi.unpack(lib.conus_table_texts(others._p, b"path"), len(others))
    volumes = itertools.takewhile(bool, (lib.conus_atlas_volume(atlas, i) for i in itertools.count()))
    parts = [volume.path for volume in volumes if volume.role != lib.CONUS_ROLE_CONTEXT] + files
    path = text(files[0] if files and text(files[0]).endswith(".json") else parts[0])
    layers = "all" if hits._layers else "visible"
    resolution = lib.conus_selection_evidence(hits._p).resolution
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "page.html")
        page(path, output, origin=[float(x) for x in matrix[3, :3]], toward=toward, angle=opening,
             layers=layers, resolution=resolution)
        with open(output, encoding="utf-8") as file:
            written = file.read()
    question = re.search(r'id="question">(.*)</script>', written)
    rows = [json.loads(row) for row in json.loads(question[1])["rows"].splitlines()] if question else []
    if [(row["name"], row["pixels"]) for row in rows if row["kind"] != "unassigned"] != [
        (hit.name, hit.pixels) for hit in hits if hit.rank
    ]:
        raise UnsupportedError("its answer would be another: the atlas or the question has options that it has not")
    return written
