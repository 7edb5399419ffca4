"""Cameras that look at flocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .._asked import triple
from .._errors import MeshlodError
from .._query import Camera, _seen
from ._members import Flock


@dataclass(frozen=True)
class FlockCamera(Camera):
    """A camera that may move, and whose viewer may look beside the middle of the picture."""

    #: Velocity of the camera, per second, which the policy ``"speed"`` looks at.
    velocity: Sequence[float] = (0.0, 0.0, 0.0)
    #: Where the viewer looks, for the policy ``"eccentricity"``: 0 is the middle, -1 and 1 are the
    #: left and right, and the lower and upper rim of the picture.
    gaze: tuple[float, float] = (0.0, 0.0)


def camera_arguments(camera: Any, flock: Flock) -> Any:
    """Returns a camera in body lengths with y up, as the native part has it."""
    eye, look, up, fov, (width, height) = _seen(camera)
    turn, length = flock._turn(), flock._unit()
    forward, top = turn @ np.subtract(look, eye), turn @ up
    right, level = np.cross(forward, top), np.cross(forward, [0.0, 1.0, 0.0])
    if not level.any():
        # Straight up or down: the right of the picture is +x.
        level = np.array([1.0, 0.0, 0.0])
    if np.dot(right, level) < (1 - 1e-6) * np.linalg.norm(right) * np.linalg.norm(level):
        raise MeshlodError(f"the camera's up must be that of the flock, +{flock.up}, without roll")
    if width < height:
        # Flocks have it along the shorter side of the picture.
        fov = 2 * np.arctan(np.tan(fov / 2) * width / height)
    velocity, gaze = (0.0, 0.0, 0.0), (0.0, 0.0)
    if isinstance(camera, FlockCamera):
        velocity = triple("velocity", camera.velocity)
        gaze = triple("gaze", (*camera.gaze, 0.0))[:2]
    at = (turn @ eye / length).tolist()
    moved = (turn @ velocity / length).tolist()
    return at, (forward / length).tolist(), float(fov), [width, height], moved, list(gaze)
