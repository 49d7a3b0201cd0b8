# SPDX-License-Identifier: BSD-3-Clause
"""How far a call is: told to a function, or shown by tqdm."""
from __future__ import annotations

import contextlib
from typing import Any, Callable, Iterator, Optional, Union

Progress = Union[bool, Callable[[int, int], object], None]
LoadProgress = Union[bool, Callable[[str, int, int], object], None]


@contextlib.contextmanager
def telling(progress: Any, unit: str, total: int) -> Iterator[Optional[Callable[..., object]]]:
    """A callback for progress: how much is done, and of how much, are its last two arguments; None = no progress.

    True is tqdm's bar where tqdm is installed, and else nothing.
    """
    if progress is not True:
        yield progress or None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        yield None
        return
    with tqdm(total=total, unit=unit) as bar:

        def tell(*what: Any) -> None:
            done, bar.total = what[-2:]
            bar.update(done - bar.n)

        yield tell
        bar.update(bar.total - bar.n)
