"""Queries of levels: an error, and where it matters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import pi
from numbers import Real
from typing import Any, NamedTuple

from ._asked import error as checked_error
from ._asked import number, size_px, triple
from ._errors import MeshlodError
from ._options import Length

#: A ball, as its center and radius, or a box, as its least and greatest corner.
Focus = tuple[Sequence[float], float | Sequence[float]]


@dataclass(frozen=True)
class Camera:
    """A perspective camera."""

    #: Position of the camera.
    eye: Sequence[float]
    #: Point that it looks at.
    look: Sequence[float]
    #: Direction that points up in the picture.
    up: Sequence[float] = (0.0, 1.0, 0.0)
    #: Vertical field of view, in radians.
    fov: float = 0.8
    #: Width and height of the picture, in pixels.
    size: tuple[int, int] = (1024, 1024)


class Query(NamedTuple):
    """A query in the arguments of the native functions."""

    error: float
    camera: tuple[list[float], list[float], list[float], float, list[int]] | None
    sphere: tuple[list[float], float] | None
    corners: list[list[float]] | None


def query(
    max_error: Length | None,
    error: Length | None,
    camera: Camera | None,
    focus: Focus | None,
    diagonal: Callable[[], float],
) -> Query:
    """Returns a query; the error is 0 by default, or a pixel with a camera.

    ``error`` is another name of ``max_error``.
    """
    sphere, corners = (None, None) if focus is None else _focus(focus)
    if max_error is not None and error is not None:
        raise MeshlodError("error is another name of max_error: give one of them")
    least = 0.0 if camera is None else 1.0
    if max_error is not None:
        least = _length("max_error", max_error, camera, diagonal)
    elif error is not None:
        least = _length("error", error, camera, diagonal)
    return Query(least, None if camera is None else _seen(camera), sphere, corners)


def _length(
    name: str, value: Length, camera: Camera | None, diagonal: Callable[[], float]
) -> float:
    """Returns an error in model units, or in pixels with a camera."""
    found, is_part = checked_error(name, value)
    if not is_part:
        return found
    if camera is not None:
        raise MeshlodError(f"{name} is in pixels where there is a camera: write 1, not {value!r}")
    return found * diagonal()


def _focus(focus: Any) -> tuple[tuple[list[float], float] | None, list[list[float]] | None]:
    """Returns a ball or the corners of a box."""
    try:
        first, second = focus
        if isinstance(second, Real):
            return (list(triple("focus", first)), float(second)), None
        return None, [list(triple("focus", first)), list(triple("focus", second))]
    except (TypeError, ValueError):
        shapes = "(center, radius) or (least corner, greatest corner)"
        raise MeshlodError(f"focus must be {shapes}, not {focus!r}") from None


def _seen(camera: Any) -> tuple[list[float], list[float], list[float], float, list[int]]:
    """Returns a camera in numbers."""
    if not isinstance(camera, Camera):
        raise MeshlodError(f"camera must be a Camera, not {type(camera).__name__}")
    at = {name: list(triple(name, getattr(camera, name))) for name in ("eye", "look", "up")}
    fov = number("fov", camera.fov)
    if fov > pi:
        raise MeshlodError(f"fov is in radians, and must be less than pi, not {camera.fov!r}")
    return at["eye"], at["look"], at["up"], fov, size_px(camera.size)
