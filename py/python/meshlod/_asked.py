"""What a simplification is asked for, checked and put into words of the native part."""

from __future__ import annotations

import operator
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import MeshlodError

if TYPE_CHECKING:
    from ._native import Asked


def target(
    target_reduction: float | None, target_count: int | None, max_error: float | None
) -> tuple[str, float]:
    """Returns the kind and the value of the only target that is given."""
    given = {
        "target_reduction": target_reduction,
        "target_count": target_count,
        "max_error": max_error,
    }
    names = [name for name, value in given.items() if value is not None]
    if not names:
        raise MeshlodError("give target_reduction, target_count or max_error")
    if len(names) > 1:
        what = " and ".join(names)
        raise MeshlodError(f"give one of target_reduction, target_count and max_error, not {what}")
    if target_count is not None:
        return "count", whole("target_count", target_count, 0, 2**53)
    value = number(names[0], given[names[0]])
    if target_reduction is not None:
        if not 0 <= value <= 1:
            raise MeshlodError(f"target_reduction must be between 0 and 1, not {value}")
        return "ratio", 1 - value
    if not value >= 0:
        raise MeshlodError(f"max_error must be at least 0, not {value}")
    return "error", value


def asked(
    kind: str,
    value: float,
    *,
    method: str,
    topology: str,
    lock_boundary: bool,
    locks: NDArray[Any] | None = None,
    weights: tuple[float, float, float] | None = None,
    precision: str = "auto",
    progress: Callable[[float], object] | None = None,
) -> Asked:
    """Returns the argument of the native functions."""
    locked = [] if locks is None else np.unique(locks).tolist()
    return {
        "kind": kind,
        "value": value,
        "method": word("method", method),
        "topology": word("topology", topology),
        "lock_boundary": bool(lock_boundary),
        "locks": locked,
        "weights": None if weights is None else triple("weights", weights),
        "precision": word("precision", precision),
        "progress": progress,
    }


def whole(name: str, value: Any, least: int, most: int) -> int:
    """Returns a whole number within limits."""
    try:
        found = operator.index(value)
    except TypeError:
        raise MeshlodError(f"{name} must be a whole number, not {value!r}") from None
    if isinstance(value, (bool, np.bool_)) or not least <= found <= most:
        raise MeshlodError(f"{name} must be between {least} and {most}, not {value!r}")
    return found


def number(name: str, value: Any) -> float:
    """Returns a number."""
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise MeshlodError(f"{name} must be a number, not {value!r}") from None


def triple(name: str, values: Any) -> tuple[float, float, float]:
    """Returns three numbers."""
    try:
        x, y, z = (float(value) for value in values)
    except (TypeError, ValueError, OverflowError):
        raise MeshlodError(f"{name} must be three numbers, not {values!r}") from None
    return x, y, z


def pair(name: str, values: Any) -> tuple[float, float]:
    """Returns two numbers."""
    try:
        x, y = (float(value) for value in values)
    except (TypeError, ValueError, OverflowError):
        raise MeshlodError(f"{name} must be two numbers, not {values!r}") from None
    return x, y


def size_px(values: Any) -> list[int]:
    """Returns the width and the height of a picture."""
    try:
        width, height = values
    except (TypeError, ValueError):
        raise MeshlodError(f"size must be a width and a height, not {values!r}") from None
    return [whole("size", side, 1, 2**32 - 1) for side in (width, height)]


def word(name: str, value: Any) -> str:
    """Returns a string, whose meaning the native part checks."""
    if not isinstance(value, str):
        raise MeshlodError(f"{name} must be a string, not {value!r}")
    return value


def path_name(path: Any) -> str:
    """Returns the name of a path of any kind."""
    try:
        return os.fsdecode(path)
    except TypeError:
        kind = type(path).__name__
        raise MeshlodError(f"a path must be a string or path-like, not {kind}") from None
