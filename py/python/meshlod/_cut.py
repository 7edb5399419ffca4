"""Levels in memory that follow a camera or another query."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._arrays import by_name
from ._asked import number, whole
from ._errors import MeshlodError
from ._mesh import Mesh
from ._options import Length
from ._query import Camera, Focus, query

if TYPE_CHECKING:
    from ._native import NativeCut

#: Seconds from which on a limit is none.
LONGEST = 1e9


@dataclass(frozen=True)
class CutChange:
    """Triangles that an update of a :class:`Cut` has changed."""

    #: Slots that were written, in ascending order.
    slots: NDArray[np.uint32]
    #: Vertices of the triangle in each of them now, of shape (n, 3); -1 if the slot is empty.
    triangles: NDArray[np.int32]
    #: Number of vertices that were split.
    splits: int
    #: Number of pairs of vertices that were merged.
    merges: int
    #: True if the cut satisfies the query; False if a limit was reached first.
    done: bool


class Cut:
    """One level of a model, refined and coarsened where queries ask for it.

    Its triangles are in slots that keep their places, and refer to one table of the vertices of
    all levels, so that a buffer on the GPU changes only where the level does::

        cut = meshlod.Model("scan.mlod").cut()
        upload(cut.vertices, cut.triangles)
        while camera := next_camera():
            change = cut.update(camera=camera, seconds=0.004)
            patch(change.slots, change.triangles)  # after growing to change.slots[-1] + 1 rows

    The level has no cracks at any time, also if a limit has stopped an update.
    """

    __slots__ = ("__weakref__", "_diagonal", "_native", "_table")

    _native: NativeCut
    _diagonal: float
    _table: tuple[NDArray[np.float64], dict[str, NDArray[np.float32]]] | None

    def __init__(self) -> None:
        raise MeshlodError("make a Cut by Model.cut")

    @classmethod
    def _of(cls, native: NativeCut, diagonal: float) -> Cut:
        cut = cls.__new__(cls)
        cut._native = native
        cut._diagonal = diagonal
        cut._table = None
        return cut

    def update(
        self,
        *,
        max_error: Length | None = None,
        camera: Camera | None = None,
        focus: Focus | None = None,
        changes: int | None = None,
        seconds: float | None = None,
        error: Length | None = None,
    ) -> CutChange:
        """Refines and coarsens until the cut is the smallest that satisfies a query.

        ``max_error``, ``camera`` and ``focus`` are those of :meth:`Model.extract`, by the errors
        that the file stores; ``error`` is another name of ``max_error``. After ``changes`` splits
        and merges, or after ``seconds``, the update stops; the next one with this query goes on
        from there. Slots that an interrupted update has written are in the next :class:`CutChange`.
        """
        asked = query(max_error, error, camera, focus, lambda: self._diagonal)
        most = None if changes is None else whole("changes", changes, 0, 2**53)
        time = None if seconds is None else number("seconds", seconds)
        if time is not None and not time >= 0:
            raise MeshlodError(f"seconds must be at least 0, not {seconds!r}")
        if time is not None and time > LONGEST:
            time = None
        return CutChange(*self._native.update(*asked, most, time))

    @property
    def triangles(self) -> NDArray[np.int32]:
        """Vertices of the triangle in each slot, of shape (slots, 3); -1 if a slot is empty.

        Later updates may add slots behind the last.
        """
        return self._native.triangles()

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Positions of the vertices of all levels, of shape (n, 3).

        Those at a seam come several times, once for each set of attributes.
        """
        return self._vertex_table()[0]

    @property
    def attributes(self) -> dict[str, NDArray[np.float32]]:
        """Attributes of the vertices of all levels by name, each of shape (n, width)."""
        return dict(self._vertex_table()[1])

    @property
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None:
        """Names of the materials, and the material of the faces at each vertex, if there are any."""
        return self._native.materials()

    @property
    def face_count(self) -> int:
        """Number of triangles, without empty slots."""
        return self._native.face_count()

    def mesh(self) -> Mesh:
        """Returns a copy of the current level."""
        return Mesh._of(self._native.mesh())

    def _vertex_table(self) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float32]]]:
        if self._table is None:
            positions, layers = self._native.vertices()
            positions.setflags(write=False)
            for _, values in layers:
                values.setflags(write=False)
            self._table = positions, by_name(layers)
        return self._table

    def __repr__(self) -> str:
        return f"Cut({self.face_count} faces)"
