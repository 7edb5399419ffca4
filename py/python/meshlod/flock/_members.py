"""Members of a flock at one moment, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import ALIGNED, as_rows
from .._asked import number, triple, word
from .._errors import MeshlodError

if TYPE_CHECKING:
    from .._native import FlockArguments
    from ._level_table import LevelTable

#: Rotations from worlds with y or z up to one with y up, for columns.
TO_Y_UP = {"y": np.eye(3), "z": np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])}

#: Deviation from an upright member of one size, as a part of its length, which is rounding.
TOLERANCE = 1e-2


@dataclass(frozen=True)
class School:
    """Members that follow one leader within an ellipsoid."""

    #: Members of the school, consecutive rows.
    members: range
    #: Position of the leader, who is not a member: the centre of the ellipsoid.
    leader: Sequence[float]
    #: Direction in which the leader swims, of any length.
    heading: Sequence[float]
    #: Half axes of the ellipsoid along the leader's left, up and heading.
    radii: Sequence[float]


@dataclass(frozen=True, eq=False)
class Flock:
    """Members of one model at one moment, with a row for each.

    Lengths, those of cameras too, are in any unit in which a member is ``body_length`` long.
    Members stand upright: they turn and pitch, but do not roll.
    """

    #: Middle of each member's box, of shape (n, 3).
    positions: ArrayLike
    #: Direction in which each member swims or walks, of any length, of shape (n, 3).
    headings: ArrayLike
    #: Speed of each member along its heading, per second, of shape (n,); at rest by default.
    speeds: ArrayLike | None = None
    #: Schools, in the order of their members; the policies of the paper look at them.
    schools: Sequence[School] = ()
    #: Longest side of a member's box.
    body_length: float = 1.0
    #: Axis that is up, ``"y"`` or ``"z"``.
    up: str = "y"

    @classmethod
    def of_instances(
        cls,
        transforms: ArrayLike,
        table: LevelTable,
        *,
        speeds: ArrayLike | None = None,
        up: str = "y",
    ) -> Flock:
        """Makes a flock of the matrices that place instances of the model of a table in the world.

        ``transforms`` has the shape (n, 4, 4), for columns: rotation, one scale, and the
        translation in the last column. The largest member is ``body_length`` long; smaller ones
        get the levels of a member of that size.
        """
        matrices = np.asarray(transforms)
        if matrices.ndim != 3 or matrices.shape[1:] != (4, 4) or matrices.dtype.kind not in "fiu":
            shape, dtype = matrices.shape, matrices.dtype
            raise MeshlodError(f"transforms must have the shape (n, 4, 4), not {dtype} of {shape}")
        linear = matrices[:, :3, :3].astype(np.float64)
        if not np.isfinite(matrices).all():
            row = int(np.argmin(np.isfinite(matrices).all(axis=(1, 2))))
            raise MeshlodError(f"transforms: row {row} is not finite")
        scales = np.cbrt(np.linalg.det(linear))
        frames = linear @ table._axes.T
        scaled = scales[:, None, None]
        upright = _frames(frames[:, :, 2], up) * scaled
        wrong = np.abs(frames - upright).max(axis=(1, 2)) > TOLERANCE * scales
        if wrong.any() or (scales <= 0).any():
            row = int(np.argmax(wrong | (scales <= 0)))
            must = "must turn an upright member without mirror, roll, or more than one scale"
            raise MeshlodError(f"transforms: row {row} {must}")
        positions = linear @ table._center + matrices[:, :3, 3]
        length = table.body_length * float(scales.max(initial=0.0)) or 1.0
        return cls(positions, frames[:, :, 2], speeds, body_length=length, up=up)

    def transforms(self) -> NDArray[np.float32]:
        """Matrices that place the vertices of a table in the world, of shape (n, 4, 4)."""
        positions = as_rows(self.positions, "positions", np.float64)
        matrices = np.zeros((len(positions), 4, 4), np.float32)
        headings = as_rows(self.headings, "headings", np.float64, len(positions))
        matrices[:, :3, :3] = _frames(headings, self.up) * number("body_length", self.body_length)
        matrices[:, :3, 3] = positions
        matrices[:, 3, 3] = 1
        return matrices

    def _arguments(self) -> FlockArguments:
        """Returns the flock in body lengths, with y up."""
        length, turn = self._unit(), self._turn()
        positions = as_rows(self.positions, "positions", np.float64)
        headings = as_rows(self.headings, "headings", np.float64, len(positions))
        speeds = np.zeros(len(positions)) if self.speeds is None else np.asarray(self.speeds)
        if speeds.shape != (len(positions),) or speeds.dtype.kind not in "fiu":
            shape, dtype = speeds.shape, speeds.dtype
            must = f"speeds must have the shape ({len(positions)},)"
            raise MeshlodError(f"{must}, not {dtype} of {shape}")
        with np.errstate(over="ignore"):
            # What overflows is infinite, which is refused with its row.
            return {
                "positions": np.require(positions @ turn.T / length, np.float32, ALIGNED),
                "headings": np.require(headings @ turn.T, np.float32, ALIGNED),
                "speeds": np.require(speeds / length, np.float32, ALIGNED),
                "schools": [_school(school, turn, length) for school in self.schools],
            }

    def _unit(self) -> float:
        length = number("body_length", self.body_length)
        if not 0 < length < np.inf:
            raise MeshlodError(f"body_length must be greater than 0, not {self.body_length!r}")
        return length

    def _turn(self) -> NDArray[np.float64]:
        return _turn(self.up)

    def __repr__(self) -> str:
        return f"Flock({len(np.asarray(self.positions))} members)"


def _turn(up: Any) -> NDArray[np.float64]:
    """Returns the rotation to a world with y up."""
    if word("up", up) not in TO_Y_UP:
        raise MeshlodError(f"up must be y or z, not {up}")
    return TO_Y_UP[up]


def _frames(headings: NDArray[np.float64], up: str) -> NDArray[np.float64]:
    """Returns frames of members, whose columns are left, up and heading, unit vectors."""
    turn = _turn(up)
    with np.errstate(invalid="ignore", divide="ignore"):
        z = headings @ turn.T
        z = z / np.linalg.norm(z, axis=1, keepdims=True)
        x = np.stack([z[:, 2], np.zeros(len(z)), -z[:, 0]], axis=1)
        length = np.linalg.norm(x, axis=1, keepdims=True)
        x = np.where(length > 1e-6, x / length, [1.0, 0.0, 0.0])
    return turn.T @ np.stack([x, np.cross(z, x), z], axis=2)


def _school(school: Any, turn: NDArray[np.float64], length: float) -> Any:
    """Returns a school in numbers."""
    if not isinstance(school, School) or not isinstance(school.members, range):
        raise MeshlodError(f"schools must be Schools with a range of members, not {school!r}")
    if school.members.step != 1 or school.members.start < 0:
        raise MeshlodError(f"a school's members must be consecutive rows, not {school.members}")
    leader = (turn @ triple("leader", school.leader) / length).tolist()
    heading = (turn @ triple("heading", school.heading)).tolist()
    radii = [radius / length for radius in triple("radii", school.radii)]
    members = [school.members.start, max(school.members.start, school.members.stop)]
    return members, leader, heading, radii
