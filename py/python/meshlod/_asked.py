"""What a simplification is asked for, checked and put into words of the native part."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ._arrays import as_array
from ._errors import MeshlodError
from ._options import Length

if TYPE_CHECKING:
    from ._native import Asked


class Bounded(Protocol):
    """A native mesh or scene."""

    def bounds(self) -> list[list[float]] | None: ...


def target(
    target_reduction: float | None, target_count: int | None, max_error: Length | None
) -> tuple[str, float]:
    """Returns the kind and the value of the only target that is given.

    An error is of the kind ``"part"`` where it is a part of the diagonal.
    """
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
    if max_error is not None:
        value, is_part = error("max_error", max_error)
        return "part" if is_part else "error", value
    value = number("target_reduction", target_reduction)
    if not 0 <= value <= 1:
        raise MeshlodError(f"target_reduction must be between 0 and 1, not {value}")
    return "ratio", 1 - value


def asked(
    of: Bounded,
    kind: str,
    value: float,
    *,
    method: str,
    topology: str,
    lock_boundary: bool,
    polish: bool = False,
    locks: NDArray[Any] | None = None,
    weights: tuple[float, float, float] | None = None,
    precision: str = "auto",
    progress: Callable[[float], object] | None = None,
) -> Asked:
    """Returns the argument of the native functions, for a mesh or a scene."""
    if kind == "part":
        kind, value = "error", value * diagonal(of)
    locked = [] if locks is None else np.unique(locks).tolist()
    return {
        "kind": kind,
        "value": value,
        "method": word("method", method),
        "topology": word("topology", topology),
        "lock_boundary": bool(lock_boundary),
        "polish": bool(polish),
        "locks": locked,
        "weights": None if weights is None else triple("weights", weights),
        "precision": word("precision", precision),
        "progress": progress,
    }


def error(name: str, value: Any) -> tuple[float, bool]:
    """Returns an error, and whether it is a part of the diagonal, as ``"0.1%"`` is."""
    is_part = isinstance(value, str) and value.endswith("%")
    try:
        if isinstance(value, str) and not is_part:
            raise ValueError(value)
        found = float(value[:-1]) / 100 if is_part else float(value)
    except (TypeError, ValueError, OverflowError):
        what = 'a number, or a percentage of the diagonal such as "0.1%"'
        raise MeshlodError(f"{name} must be {what}, not {value!r}") from None
    if not found >= 0:
        raise MeshlodError(f"{name} must be at least 0, not {value}")
    return found, is_part


def length(name: str, value: Any, of: Bounded) -> float:
    """Returns an error of a mesh or a scene as a length."""
    found, is_part = error(name, value)
    return found * diagonal(of) if is_part else found


def diagonal(of: Bounded) -> float:
    """Returns the diagonal of the bounding box; 0 without faces."""
    bounds = of.bounds()
    return 0.0 if bounds is None else math.dist(*bounds)


def affine(name: str, values: Any) -> list[list[float]]:
    """Returns the columns of a matrix of four rows, the last of which is 0, 0, 0, 1."""
    matrix = as_array(values, name)
    if matrix.shape != (4, 4) or matrix.dtype.kind not in "fiu":
        shape, dtype = matrix.shape, matrix.dtype
        raise MeshlodError(f"{name} must have the shape (4, 4), not {dtype} of {shape}")
    matrix = matrix.astype(np.float64)
    if not np.isfinite(matrix).all():
        raise MeshlodError(f"{name} is not finite")
    if not np.allclose(matrix[3], [0, 0, 0, 1], rtol=0, atol=1e-12):
        last = matrix[3].tolist()
        raise MeshlodError(f"{name} must be affine: its last row must be [0, 0, 0, 1], not {last}")
    matrix[3] = [0, 0, 0, 1]
    columns: list[list[float]] = matrix.T.tolist()
    return columns


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
