# SPDX-License-Identifier: BSD-3-Clause
"""The command line with what is in memory in the place of files."""
from __future__ import annotations

import functools
import importlib
import io
import json
import os
import re
import shlex
import tempfile
from typing import Any, Optional, Union

import numpy as np

from ._library import ArgumentError, shown
from ._poses import warn
from ._probe import is_probe, probe_text
from ._program import refuse, run_program


class _Out:
    """In the place of a file that conus writes."""

    def __repr__(self) -> str:
        return "conus.OUT"


OUT = _Out()  #: a value of :func:`run` for a file that the command writes


def run(line: str, /, **values: Any) -> Any:
    """Runs a command of the program with values of Python in the place of files and numbers.

    ``conus.run("query {atlas} --origin {at} --toward 0,-10,10 --angle 20", atlas=image, at=(-90, 20, 20))``
    ``conus.run("overlap aal {lesion} --mask {parts.nii.gz}", lesion=image, parts=conus.OUT)["parts"]``

    Parameters
    ----------
    line
        What stands behind ``conus`` on a command line. Words are split as by a shell before values are put in, so that
        no value is two words.
    values
        What ``{name}`` or ``{name.ending}`` stands for: a path, a number, a sequence of numbers as text; a nibabel image,
        a DataFrame, a Probe of probeinterface or an array (n, 3) of positions as a temporary file of that name;
        :data:`OUT` for a file that the command writes.

    Returns
    -------
    DataFrame, str or dict
        Rows as a DataFrame where the command writes rows, else its text. With ``OUT`` {name: content}: an image of
        nibabel, a DataFrame, or bytes. Notes of the program are PoseWarnings.

    Raises
    ------
    ArgumentError, DataError, UnsupportedError
        With the message of the program.
    """
    with tempfile.TemporaryDirectory(prefix="conus-") as folder:
        outputs: dict[str, str] = {}
        used: set[str] = set()

        def put(found: re.Match[str]) -> str:
            name, ending = found[1], found[2] or ""
            if name not in values:
                raise ArgumentError(f"run: {{{name}}}: there is no such value")
            used.add(name)
            if values[name] is OUT:
                outputs[name] = os.path.join(folder, name + (ending or ".tsv"))
                return outputs[name]
            word = _word(values[name], os.path.join(folder, name), ending)
            return os.path.join(".", word) if not found.start() and _is_option(word) else word

        words = [re.sub(r"\{(\w+)(\.[\w.]+)?\}", put, word) for word in shlex.split(line)]
        if used != set(values):
            raise ArgumentError(f"run: {sorted(set(values) - used)[0]}: the line has no {{{sorted(set(values) - used)[0]}}}")
        is_asked = any(re.match(r"-o|--output(=|$)|--format(=|$)", word) for word in words)
        has_rows = bool(words) and not outputs and not is_asked and words[0] in _commands_with_rows(os.environ.get("CONUS"))
        ended = run_program(*words[:1], *(["--format=tsv"] if has_rows else []), *words[1:])
        said = [note.replace(folder + os.sep, "").removeprefix("conus: ") for note in ended.stderr.splitlines() if note]
        if ended.returncode not in (0, 1):
            ended.stderr = "\n".join(said)
            refuse(ended, str)
        if said:
            warn(said)
        if outputs:
            return {name: _read(path) for name, path in outputs.items()}
        return _table(io.StringIO(ended.stdout), "\t") if has_rows else ended.stdout


def calibrate(trials: Any, atlas: Any = None, /, **options: Any) -> Any:
    """Finds from trials how far off a hand or tracker points, or how often posteriors are right.

    ``conus.calibrate(trials)``
    ``conus.calibrate(trials, "aal", weight="gauss=1.7")``

    Parameters
    ----------
    trials
        A DataFrame, or the path of a table: poses as :func:`read_poses` takes them, with columns aim_x, aim_y and aim_z,
        the point that was aimed at; with an atlas a column meant, the area that was meant.
    atlas
        A path, a name or an image of nibabel.
    options
        Those of the program: ``weight``, ``prior``, ``space``.

    Returns
    -------
    DataFrame
        The rows of ``conus calibrate`` (docs/formats.md).
    """
    words = "".join(f" --{name.replace('_', '-')} {{{name}}}" for name in options)
    if atlas is None:
        return run("calibrate --poses {trials}" + words, trials=trials, **options)
    return run("calibrate {atlas} --poses {trials}" + words, trials=trials, atlas=atlas, **options)


def positions(*names: str, **options: Any) -> Any:
    """Lists positions of the 10-10 system on the head of MNI 152, as poses straight into the head.

    ``conus.positions("C3", "F3", handle=45)``

    Parameters
    ----------
    names
        Their names; none for all.
    options
        Those of the program: ``out``, ``handle``, ``scalp``.

    Returns
    -------
    DataFrame
        The rows of ``conus positions``, which :func:`read_poses` takes as a file.
    """
    words = "".join(f" --{name} {{{name}}}" for name in options)
    return run("positions" + words + " -- " + shlex.join(names), **options)


@functools.lru_cache(maxsize=None)
def _commands_with_rows(_program: Optional[str]) -> frozenset[str]:
    """Those that have the format tsv, as the program says of itself."""
    commands = json.loads(run_program("help", "--json").stdout)["commands"]
    return frozenset(command["name"] for command in commands
                     if any(option["name"] == "format" and "tsv" in option["choices"] for option in command["options"]))


def _is_option(word: str) -> bool:
    """A path that would be taken for an option; numbers are none."""
    return re.match(r"-[^\d.]", word) is not None


def _word(value: Any, path: str, ending: str) -> str:
    """The word for a value; of what is in memory that of a file that it is written to."""
    if hasattr(value, "to_filename"):  # an image of nibabel
        kinds = {"MGHImage": ".mgz", "GiftiImage": ".gii"}
        file = path + (ending or kinds.get(type(value).__name__, ".nii"))
        value.to_filename(file)
        return file
    if hasattr(value, "to_csv"):
        value.to_csv(path + (ending or ".tsv"), sep="," if ending == ".csv" else "\t", index=False, na_rep="n/a")
        return path + (ending or ".tsv")
    if is_probe(value):
        with open(path + ".json", "w", encoding="utf-8") as written:
            written.write(probe_text(value))
        return path + ".json"
    if isinstance(value, (str, bytes, os.PathLike)):
        return os.fsdecode(value)
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "iuf" or numbers.ndim > 2 or (numbers.ndim == 2 and numbers.shape[1] != 3):
        raise ArgumentError(f"run: {os.path.basename(path)}: {shown(value)}, wanted is a path, numbers, (n, 3) positions, an "
                            "image, a DataFrame or what read_probe() takes")
    if numbers.ndim < 2:
        return ",".join(json.dumps(number) for number in numbers.reshape(-1).tolist())
    np.savetxt(path + ".tsv", numbers, fmt="%.17g", delimiter="\t", header="x\ty\tz", comments="")
    return path + ".tsv"


#: Columns whose cells are texts, also where all of them look like numbers: "007" is another id than "7".
_TEXTS = {name: str for name in ("query", "name", "abbreviation", "kind", "probe", "shank_id", "needle")}


def _table(source: Any, separator: str) -> Any:
    return importlib.import_module("pandas").read_csv(source, sep=separator, na_values="n/a", keep_default_na=False, dtype=_TEXTS)


def _read(path: str) -> Optional[Union[bytes, Any]]:
    """What the command wrote; None where it wrote nothing."""
    if not os.path.exists(path):
        return None
    if path.endswith((".nii", ".nii.gz")):
        image = importlib.import_module("nibabel").load(path)
        return type(image)(np.asanyarray(image.dataobj), image.affine, image.header)
    if path.endswith((".tsv", ".csv")):
        return _table(path, "\t" if path.endswith(".tsv") else ",")
    with open(path, "rb") as file:
        return file.read()
