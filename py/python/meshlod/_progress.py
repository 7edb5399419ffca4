"""Progress of long work: a callback, or a bar on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable

from ._errors import MeshlodError

#: ``True`` for a bar, or a function of the part that is done, from 0 to 1.
ProgressLike = bool | Callable[[float], object] | None

WIDTH = 40


def callback(progress: ProgressLike, what: str) -> Callable[[float], object] | None:
    """Returns the function to call with the part that is done."""
    if progress is None or progress is False:
        return None
    if progress is True:
        # A file is no place for a bar.
        return _bar(what) if sys.stderr is not None and sys.stderr.isatty() else None
    if not callable(progress):
        raise MeshlodError(f"progress must be a function or True, not {progress!r}")
    return progress


def _bar(what: str) -> Callable[[float], object]:
    def show(done: float) -> None:
        filled = round(WIDTH * done)
        end = "\n" if done >= 1 else ""
        bar = "█" * filled + " " * (WIDTH - filled)
        sys.stderr.write(f"\r{what}: {100 * done:3.0f}%|{bar}|{end}")
        sys.stderr.flush()

    return show
