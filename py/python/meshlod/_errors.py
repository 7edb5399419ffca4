"""The exception and the warning of the package."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable

from ._native import MeshlodError

__all__ = ["MeshlodError", "MeshlodWarning", "warn", "warn_left_out"]


class MeshlodWarning(UserWarning):
    """Something was left out or changed on the way, or a target was missed."""


def warn(text: str) -> None:
    """Warns at the line outside the package that called it, through any number of functions."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and _is_own(frame.f_globals.get("__name__")):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, MeshlodWarning, stacklevel=level)


def warn_left_out(names: Iterable[str]) -> None:
    """Warns of the things that are left out, if there are any."""
    names = list(names)
    if names:
        warn(f"left out: {', '.join(names)}")


def _is_own(module: object) -> bool:
    return isinstance(module, str) and module.partition(".")[0] == __package__
