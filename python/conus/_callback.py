# SPDX-License-Identifier: BSD-3-Clause
"""Functions that C calls back, and the logger."""
from __future__ import annotations

import logging
import os
from typing import Any, Optional

from ._conus import ffi, lib
from ._library import check, python_words, text

_LOGGER = logging.getLogger("conus")


class Callback:
    """A function that C calls back; an exception in it, Ctrl-C too, ends the call and is raised behind it."""

    def __init__(self, function: Any = None) -> None:
        self.function = function
        self.error: Optional[BaseException] = None

    def call(self, *arguments: Any) -> bool:
        return self.error is None if self.function is None else self.run(self.function, *arguments)

    def run(self, function: Any, *arguments: Any) -> bool:
        try:
            function(*arguments)
        except BaseException as error:  # pylint: disable=broad-except
            self.error = self.error or error
        return self.error is None

    def log_notes(self, options: Any) -> Any:
        """Lets the notes of the call go to the logger; gives the handle, which must live as long as the call."""
        handle = ffi.new_handle(self)
        options.log, options.log_user = log, handle
        return handle

    def check(self, status: int) -> None:
        if self.error is not None:
            raise self.error
        check(status)


def _log_note(note: Any) -> None:
    path = os.fsdecode(ffi.string(note.path)) if note.path else ""
    line = python_words(text(note.line))
    level = logging.WARNING if note.severity == lib.CONUS_SEVERITY_WARNING else logging.INFO
    _LOGGER.log(level, "%s", line if line.startswith(path) else f"{path}: {line}")


@ffi.callback("void(void *, const conus_note *)")  # type: ignore[misc]
def log(user: Any, note: Any) -> None:
    callback: Callback = ffi.from_handle(user)
    callback.run(_log_note, note)


@ffi.callback("bool(void *, const char *, size_t, size_t)")  # type: ignore[misc]
def load_progress(user: Any, path: Any, done: int, total: int) -> bool:
    callback: Callback = ffi.from_handle(user)
    return callback.call(os.fsdecode(ffi.string(path)), done, total)


@ffi.callback("bool(void *, const conus_answers *)")  # type: ignore[misc]
def receive(user: Any, answers: Any) -> bool:
    callback: Callback = ffi.from_handle(user)
    return callback.call(answers)
