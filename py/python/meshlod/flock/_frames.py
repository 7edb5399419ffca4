"""Frames of members that stand upright, in worlds with y or z up."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._asked import word
from .._errors import MeshlodError

#: Rotations from worlds with y or z up to one with y up, for columns.
TO_Y_UP = {"y": np.eye(3), "z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])}


def turn_to_y_up(up: Any) -> NDArray[np.float64]:
    """Returns the rotation to a world with y up."""
    if word("up", up) not in TO_Y_UP:
        raise MeshlodError(f"up must be y or z, not {up}")
    return TO_Y_UP[up]


def frames(headings: NDArray[np.float64], up: str) -> NDArray[np.float64]:
    """Returns frames of members, whose columns are left, up and heading, unit vectors."""
    turn = turn_to_y_up(up)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = headings @ turn.T
        z = z / np.linalg.norm(z, axis=1, keepdims=True)
        x = np.stack([z[:, 2], np.zeros(len(z)), -z[:, 0]], axis=1)
        length = np.linalg.norm(x, axis=1, keepdims=True)
        x = np.where(length > 1e-6, x / length, [1.0, 0.0, 0.0])
    axes: NDArray[np.float64] = turn.T @ np.stack([x, np.cross(z, x), z], axis=2)
    return axes


def model_axes(forward: Any, up: Any) -> NDArray[np.float64]:
    """Returns the rotation from the axes of a model to left, up and heading."""
    heading = np.asarray(forward) / np.linalg.norm(forward)
    left = np.cross(up, heading)
    left /= np.linalg.norm(left)
    return np.stack([left, np.cross(heading, left), heading])
