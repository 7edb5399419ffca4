"""Cameras that look at flocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._arrays import as_rows
from .._asked import pair, triple
from .._errors import MeshlodError
from .._query import Camera, _seen
from ._members import Flock

if TYPE_CHECKING:
    from .._native import FlockArguments, FlockCameraArguments

#: Distance from the origin in body lengths from which on places are told from the camera: single
#: precision resolves a thousandth of a body length there.
FAR = 1e4


@dataclass(frozen=True)
class FlockCamera(Camera):
    """A camera that may move, and whose viewer may look beside the middle of the picture."""

    #: Velocity of the camera, per second, which the policy ``"speed"`` looks at.
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    #: Where the viewer looks, for the policy ``"eccentricity"``: 0 is the middle, -1 and 1 are the
    #: left and right, and the lower and upper rim of the picture.
    gaze: tuple[float, float] = (0.0, 0.0)


def seen_arguments(
    flock: Any, camera: Any
) -> tuple[FlockArguments, FlockCameraArguments, NDArray[np.float64]]:
    """Returns a flock and a camera as the native part has them, in body lengths with y up, and the
    origin of these places in the unit of the flock.

    The origin is that of the flock, or the eye where members are far from that, as in coordinates
    of a map: single precision then is that of places beside the camera.
    """
    if not isinstance(flock, Flock):
        raise MeshlodError(f"flock must be a Flock, not {type(flock).__name__}")
    eye, *_ = _seen(camera)
    origin = np.zeros(3)
    positions = as_rows(flock.positions, "positions", np.float64)
    if np.isfinite(eye).all() and np.abs(positions).max(initial=0.0) > FAR * flock._unit():
        origin = np.array(eye)
    return flock._arguments(origin), _camera_arguments(camera, flock, origin), origin


def _camera_arguments(
    camera: Any, flock: Flock, origin: NDArray[np.float64]
) -> FlockCameraArguments:
    eye, look, up, fov, (width, height) = _seen(camera)
    turn, length = flock._turn(), flock._unit()
    forward = turn @ np.subtract(look, eye)
    _check_up(forward, turn @ up, flock)
    if width < height:
        # Flocks have it along the shorter side of the picture.
        fov = fov_along(width, fov, height)
    velocity, gaze = (0.0, 0.0, 0.0), (0.0, 0.0)
    if isinstance(camera, FlockCamera):
        velocity, gaze = triple("velocity", camera.velocity), pair("gaze", camera.gaze)
    at = (turn @ np.subtract(eye, origin) / length).tolist()
    moved = (turn @ velocity / length).tolist()
    return at, (forward / length).tolist(), fov, [width, height], moved, list(gaze)


def fov_along(side: int, fov: float, other: int) -> float:
    """Returns the field of view along one side of a picture, from that along the other."""
    return float(2 * np.arctan(np.tan(fov / 2) * side / other))


def _check_up(forward: NDArray[np.float64], top: NDArray[np.float64], flock: Flock) -> None:
    """Refuses an up that is none in the picture, or that rolls the camera."""
    turn = flock._turn()
    if not np.isfinite(top).all() or not top.any():
        given = (turn.T @ top).tolist()
        raise MeshlodError(f"the camera's up must be finite and have a length, not {given}")
    if not np.isfinite(forward).all() or not forward.any():
        # The native part refuses these.
        return
    forward, top = forward / np.linalg.norm(forward), top / np.linalg.norm(top)
    right, level = np.cross(forward, top), np.cross(forward, [0.0, 1.0, 0.0])
    if not level.any():
        # Straight up or down: the right of the picture is +x.
        level = np.array([1.0, 0.0, 0.0])
    if np.linalg.norm(right) < 1e-9:
        instead = (turn.T @ np.cross([1.0, 0.0, 0.0], forward)).round(3) + 0.0
        advice = f": take {tuple(instead.tolist())}" if abs(forward[1]) > 1 - 1e-9 else ""
        raise MeshlodError(f"the camera's up must not be parallel to its view{advice}")
    if np.dot(right, level) < (1 - 1e-6) * np.linalg.norm(right) * np.linalg.norm(level):
        raise MeshlodError(f"the camera's up must be that of the flock, +{flock.up}, without roll")
