"""Members of a flock at one moment, as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import ALIGNED, as_column, as_rows
from .._asked import number, triple
from .._errors import MeshlodError
from ._frames import frames, turn_to_y_up
from ._instances import taken_apart

if TYPE_CHECKING:
    from .._native import FlockArguments
    from ._level_table import LevelTable


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
    #: Longest side of a member's box; with ``scales``, of the largest member.
    body_length: float = 1.0
    #: Axis that is up, ``"y"`` or ``"z"``.
    up: str = "y"
    #: Size of each member in parts of ``body_length``, of shape (n,), above 0 and at most 1; all
    #: are 1 by default. Levels are chosen as if all were 1.
    scales: ArrayLike | None = None

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
        have ``scales``, and get the levels that members of the largest size would get.
        """
        from ._level_table import LevelTable

        if not isinstance(table, LevelTable):
            raise MeshlodError(f"table must be a LevelTable, not {type(table).__name__}")
        found = taken_apart(transforms, table._axes, table._center, up)
        length = table.body_length * found.scale
        places = found.positions, found.headings
        return cls(*places, speeds, body_length=length, up=up, scales=found.scales)

    def transforms(self) -> NDArray[np.float32]:
        """Matrices that place the vertices of a table in the world, of shape (n, 4, 4).

        They are for columns, with the translation in the last one, and C-contiguous, row after row.
        """
        positions, headings = self._places()
        lengths = self._unit() * self._sizes(len(positions))
        matrices = np.zeros((len(positions), 4, 4), np.float32)
        matrices[:, :3, :3] = frames(headings, self.up) * lengths[:, None, None]
        matrices[:, :3, 3] = positions
        matrices[:, 3, 3] = 1
        return matrices

    def _arguments(self, origin: NDArray[np.float64]) -> FlockArguments:
        """Returns the flock in body lengths from ``origin``, with y up."""
        length, turn = self._unit(), self._turn()
        positions, headings = self._places()
        with np.errstate(over="ignore"):
            # What overflows is infinite, which is refused with its row.
            places = (positions - origin) @ turn.T / length
            return {
                "positions": np.require(places, np.float32, ALIGNED),
                "headings": np.require(headings @ turn.T, np.float32, ALIGNED),
                "speeds": np.require(self._speeds(len(positions)) / length, np.float32, ALIGNED),
                "schools": self._schools(origin),
            }

    def _places(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns positions and headings that are finite, and headings that have a direction."""
        positions = as_rows(self.positions, "positions", np.float64)
        headings = as_rows(self.headings, "headings", np.float64, len(positions))
        finite = np.isfinite(positions)
        if not finite.all():
            row = int(np.argmin(finite.all(axis=1)))
            given = positions[row].tolist()
            raise MeshlodError(f"positions: row {row} must be finite, not {given}")
        with np.errstate(over="ignore", invalid="ignore"):
            squared = np.einsum("ij,ij->i", headings, headings)
        known = (squared > 0) & np.isfinite(squared)
        if not known.all():
            row = int(np.argmin(known))
            must = f"must have a direction, not {headings[row].tolist()}"
            raise MeshlodError(f"headings: row {row} {must}")
        return positions, headings

    def _speeds(self, count: int) -> NDArray[Any]:
        return np.zeros(count) if self.speeds is None else as_column(self.speeds, "speeds", count)

    def _sizes(self, count: int) -> NDArray[Any]:
        """Returns the size of each member in parts of the body length."""
        if self.scales is None:
            return np.ones(count)
        scales = as_column(self.scales, "scales", count)
        wrong = ~((scales > 0) & (scales <= 1))
        if wrong.any():
            row = int(np.argmax(wrong))
            must = "must be greater than 0 and at most 1: body_length is that of the largest member"
            raise MeshlodError(f"scales: row {row} {must}")
        return scales

    def _schools(self, origin: NDArray[np.float64]) -> list[Any]:
        """Returns schools in numbers."""
        try:
            schools = list(self.schools)
        except TypeError:
            must = "schools must be a sequence of Schools"
            raise MeshlodError(f"{must}, not {self.schools!r}") from None
        return [_school(school, origin, self._turn(), self._unit()) for school in schools]

    def _unit(self) -> float:
        length = number("body_length", self.body_length)
        if not 0 < length < np.inf:
            raise MeshlodError(f"body_length must be greater than 0, not {self.body_length!r}")
        return length

    def _turn(self) -> NDArray[np.float64]:
        return turn_to_y_up(self.up)

    def __repr__(self) -> str:
        try:
            return f"Flock({len(self.positions)} members)"  # type: ignore[arg-type]
        except TypeError:
            return f"Flock(positions={self.positions!r})"


def _school(
    school: Any, origin: NDArray[np.float64], turn: NDArray[np.float64], length: float
) -> Any:
    """Returns a school in numbers."""
    if not isinstance(school, School) or not isinstance(school.members, range):
        raise MeshlodError(f"schools must be Schools with a range of members, not {school!r}")
    if school.members.step != 1 or school.members.start < 0:
        raise MeshlodError(f"a school's members must be consecutive rows, not {school.members}")
    leader = (turn @ (np.array(triple("leader", school.leader)) - origin) / length).tolist()
    heading = (turn @ triple("heading", school.heading)).tolist()
    radii = [radius / length for radius in triple("radii", school.radii)]
    members = [school.members.start, max(school.members.start, school.members.stop)]
    return members, leader, heading, radii
