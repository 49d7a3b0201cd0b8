# SPDX-License-Identifier: BSD-3-Clause
"""The border to C: errors, texts, and the library's structs as numpy sees them."""
from __future__ import annotations

import functools
import inspect
import operator
import os
import re
import sys
import threading
import weakref
from collections.abc import Mapping
from typing import Any, Optional, Sequence

import numpy as np

from ._conus import ffi, lib


class Error(Exception):
    """A call that failed; its text is the library's one line. The subclasses say why."""


class ArgumentError(Error, ValueError):
    """An argument breaks its documented range."""


class OutOfMemoryError(Error, MemoryError):
    """There is no memory, or a file asks for more than max_memory."""


class FileError(Error, OSError):
    """The system refused to read or write."""


class DataError(Error, ValueError):
    """A file or an array is damaged, contradicts itself or is not what it should be."""


class UnsupportedError(Error):
    """Valid, but beyond conus."""


class GLError(Error, RuntimeError):
    """There is no usable OpenGL driver, or it was used before the process was forked."""


class CancelledError(Error):
    """A callback ended the call."""


class PoseWarning(UserWarning):
    """Poses that look as if they came from another space or unit, and steps of a track that are left out."""


_ERRORS = {
    lib.CONUS_ERROR_ARGUMENT: ArgumentError,
    lib.CONUS_ERROR_MEMORY: OutOfMemoryError,
    lib.CONUS_ERROR_IO: FileError,
    lib.CONUS_ERROR_DATA: DataError,
    lib.CONUS_ERROR_UNSUPPORTED: UnsupportedError,
    lib.CONUS_ERROR_GL: GLError,
    lib.CONUS_ERROR_CANCELLED: CancelledError,
}


# Options of the programs in messages of the library that are arguments of another name, and other words.
_RENAMED = {
    "--atlas-transform": "transforms", "--hemispheres split": 'hemispheres="split"', "--mask-object": "name",
    "--pathway": "pathways", "--pathway FILE,name=NAME": "pathways=[(map, {name: (low, high)})]",
    "--poses-format table": 'format="table"', "--poses-format": "format", "--probe-tip": "tip", "--scalp": "scalp",
    "--sides exchanged": 'sides="exchanged"', "'conus overlap ATLAS MAP'": "atlas.overlap(map)", "as ATLAS": "as source", "is ATLAS": "is source",
    "conus sweep --jitter and conus plan --jitter": "jitter(error=) and plan(jitter=)",
}  # fmt: skip
_OPTION = re.compile(rf"(?<![\w/.-])({'|'.join(sorted(_RENAMED, key=len, reverse=True))}|--[a-z][a-z-]*)(?![\w/-])(:?)")


@functools.cache
def _arguments() -> frozenset[str]:
    """All that the package's functions, classes and their methods take by name."""
    public = [thing for name, thing in vars(sys.modules[__package__]).items() if name[:1] != "_"]
    methods = [method for thing in public if isinstance(thing, type) for _, method in inspect.getmembers(thing, inspect.isroutine)]
    codes = [getattr(thing, "__code__", None) for thing in [*public, *methods]]
    return frozenset(name for code in codes if code for name in code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])


def python_words(line: str) -> str:
    """A message or note of the library, with the names of arguments in place of options."""

    def name(found: re.Match[str]) -> str:
        same = found[1].removeprefix("--").replace("-", "_")
        word = _RENAMED.get(found[1], same if same in _arguments() else None)
        return found[0] if word is None else word + (found[2] or ("=" if found[1].startswith("--") and "=" not in word else ""))

    return _OPTION.sub(name, line)


def message() -> str:
    """Why the last call of this thread failed."""
    return python_words(text(lib.conus_message()))


def check(status: int) -> None:
    """Raises the error that a status means."""
    if status:
        raise _ERRORS.get(status, Error)(message())


def text(pointer: Any) -> str:
    """UTF-8 of the library; None is ""."""
    return str(ffi.string(pointer).decode("utf-8", "replace")) if pointer else ""


check(lib.conus_inputs_keep())  # what saves a file replaces none that was read


def owned(pointer: Any, destroy: Any, *needed: Any) -> Any:
    """An object that ends itself, before any of those that it needs."""
    return ffi.gc(pointer, lambda p, keep=needed: destroy(p))


class Bound:
    """What holds the library's memory, and lives in the process that made it."""

    def __reduce_ex__(self, protocol: Any) -> Any:
        name = type(self).__name__
        raise UnsupportedError(f"{name}: cannot be pickled, its atlas and numpy arrays can")

    def __copy__(self) -> Any:
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__)
        return other


class Guarded(Bound):
    """What one thread at a time may ask."""

    _all: weakref.WeakSet[Guarded] = weakref.WeakSet()

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._all.add(self)

    def _leave(self) -> None:
        """Another thread was asking it when the process was forked, and is not in this one."""

    @classmethod
    def free_locks(cls) -> None:
        for one in list(cls._all):
            if one._lock.acquire(blocking=False):  # also where this very thread holds it
                one._lock.release()
            else:
                one._lock = threading.RLock()
                one._leave()


def after_fork(call: Any) -> None:
    """Calls it in each process that is forked from this one; Windows forks none."""
    if hasattr(os, "register_at_fork"):
        os.register_at_fork(after_in_child=call)


after_fork(Guarded.free_locks)


def shown(value: Any, most: Optional[int] = 60) -> str:
    """A value in a message, which has one line."""
    try:
        return " ".join(repr(value).split())[:most]
    except ValueError:  # Python writes no number of more than some thousand digits
        return f"a number of {value.bit_length()} bits" if isinstance(value, int) else type(value).__name__


def choice(option: str, value: str, values: Sequence[str]) -> int:
    """The number of a named value of an option."""
    if not isinstance(value, str) or value not in values:
        raise ArgumentError(f"{option}: {shown(value)}, allowed is {', '.join(values)}")
    return list(values).index(value)


def _is_masked(values: Any) -> bool:
    """Whether an array, or one in a list, hides elements behind a mask."""
    if isinstance(values, (list, tuple)):
        return any(map(_is_masked, values))
    mask = getattr(values, "_mask", None)
    return mask is not None and bool(np.any(mask))


def unmasked(name: str, values: Any, fill: str = "numpy.nan") -> Any:
    """A caller's numbers, as given. Masked ones are an error: numpy would drop the mask when it makes an array."""
    if _is_masked(values):
        raise ArgumentError(f"{name}: masked elements have no value; array.filled({fill}) gives them one")
    return values


def whole(name: str, value: Any, low: int = 0, high: int = 2**32 - 1) -> int:
    """A whole number that C's types hold; the library checks further."""
    unmasked(name, value)
    try:
        number = int(value) if isinstance(value, float) and value.is_integer() else operator.index(value)
    except TypeError:
        raise ArgumentError(f"{name}: {shown(value)}, wanted is a whole number") from None
    if not low <= number <= high:
        raise ArgumentError(f"{name}: {shown(number)}, allowed is {low} to {high}")
    return number


def byte_count(name: str, value: Any) -> int:
    """So many bytes."""
    return whole(name, value, high=2**64 - 1)


def numbers(name: str, values: Any) -> np.ndarray[Any, Any]:
    """An array of double."""
    unmasked(name, values)
    try:
        if not np.iscomplexobj(values):
            return np.asarray(values, float)
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"{name}: {error}") from None
    raise ArgumentError(f"{name}: complex numbers, wanted are real ones")


def affine_of(name: str, values: Any) -> np.ndarray[Any, Any]:
    """A copy of a matrix that moves points: the last row is 0 0 0 1, but for the rounding of a float, as in files."""
    matrix = numbers(name, values).copy()
    if matrix.shape != (4, 4):
        raise ArgumentError(f"{name}: an array of shape {matrix.shape}, wanted is (4, 4)")
    if not np.allclose(matrix[3], (0, 0, 0, 1), rtol=0, atol=1e-6):
        row = " ".join(f"{number:.9g}" for number in matrix[3])
        raise ArgumentError(f"{name}: the last row is {row}, wanted is 0 0 0 1")
    matrix[3] = 0, 0, 0, 1
    return matrix


def flag(name: str, value: Any) -> bool:
    """True or False, or a number that is 1 or 0."""
    if np.ndim(unmasked(name, value)) == 0 and value in (0, 1):
        return bool(value)
    raise ArgumentError(f"{name}: {shown(value)}, wanted is True or False")


def real(name: str, value: Any) -> float:
    """One number, which the library checks further."""
    array = numbers(name, value)
    if array.ndim:
        raise ArgumentError(f"{name}: an array of shape {array.shape}, wanted is a number")
    return float(array)


def vector(name: str, values: Any, size: int = 3) -> list[float]:
    """So many numbers, which the library checks further."""
    array = numbers(name, values)
    if array.shape != (size,):
        raise ArgumentError(f"{name}: an array of shape {array.shape}, wanted is ({size},)")
    return [float(value) for value in array]


def items(name: str, given: Any) -> list[Any]:
    """The items of a list, or of something like it; a single value is no list."""
    try:
        if not isinstance(given, (str, bytes, os.PathLike, Mapping, np.ndarray)) and not hasattr(given, "streamlines"):
            return list(given)
    except TypeError:
        pass
    raise ArgumentError(f"{name}: one {type(given).__name__}, wanted is a list")


def optional(convert: Any, name: str, value: Any) -> Any:
    """utf8() or path_of() of what is given; None is NULL."""
    return ffi.NULL if value is None else convert(name, value)


def utf8(name: str, value: Any) -> Any:
    """A text for C."""
    if not isinstance(value, str):
        raise ArgumentError(f"{name}: {shown(value)}, wanted is a text")
    try:
        return _chars(name, value, value.encode())
    except UnicodeEncodeError:
        raise ArgumentError(f"{name}: {shown(value)} is not Unicode") from None


def written(name: str, value: Any) -> Any:
    """A text, or a whole number in digits, for C."""
    try:
        return utf8(name, value if isinstance(value, str) else str(value))
    except ValueError as error:
        raise error if isinstance(error, Error) else ArgumentError(f"{name}: {shown(value)}") from None


def path_of(name: str, value: Any) -> Any:
    """A path for C."""
    try:
        return _chars(name, value, os.fsencode(value))
    except (TypeError, UnicodeEncodeError):
        raise ArgumentError(f"{name}: {shown(value)}, wanted is a path") from None


def _chars(name: str, value: Any, data: bytes) -> Any:
    if b"\0" in data:
        raise ArgumentError(f"{name}: {shown(value)} has a zero byte")
    return ffi.new("char[]", data)


_FORMATS = {"uint32_t": "u4", "uint64_t": "u8", "double": "f8", "uint8_t": "u1", "_Bool": "?"}


def dtype_of(name: str) -> np.dtype[Any]:
    """A struct of the headers; offsets and size are the compiler's."""
    fields: list[tuple[str, Any, int]] = []
    for field, info in ffi.typeof(name).fields:
        kind = info.type
        if kind.kind == "array":
            fields.append((field, (_FORMATS[kind.item.cname], kind.length), info.offset))
        else:
            fields.append((field, "u4" if kind.kind == "enum" else _FORMATS[kind.cname], info.offset))
    names, formats, offsets = (list(column) for column in zip(*fields))
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(name)})


def array_of(pointer: Any, count: int, dtype: np.dtype[Any]) -> np.ndarray[Any, Any]:
    """A copy of an array of the library."""
    if not count:
        return np.empty(0, dtype)
    return np.frombuffer(ffi.buffer(ffi.cast("char *", pointer), count * dtype.itemsize), dtype, count).copy()


RESULT = dtype_of("conus_result")
STEP = dtype_of("conus_step")
