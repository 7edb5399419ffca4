"""Levels of a model for its thousands of instances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _native
from .._arrays import ALIGNED, as_array, by_name
from .._asked import number, triple, whole, word
from .._errors import MeshlodError
from .._immutable import Immutable
from .._mesh import Mesh
from .._query import Camera
from ._camera import seen_arguments
from ._frames import model_axes
from ._members import Flock


class LevelTable(Immutable):
    """All levels of one model, in one table of vertices and one of triangles.

    A level is a range of triangles. The first ``depth`` levels are the whole model, finest first;
    then there are levels of which one side is finer, and levels without the faces that turn their
    backs to a direction, which the policies ``"ours"``, ``"direction"`` and ``"paper"`` choose.
    Vertices are in the frame of a member: left is +x, up +y, its heading +z, the longest side of
    its box is 1, and the middle of its box is the origin.

    ``forward`` and ``up`` are the directions in which the model faces and stands. Every level has
    ``step`` times the triangles of the finer one, down to ``coarsest``; coarse levels are stored
    for ``directions`` by ``directions`` views.
    """

    __slots__ = ("__weakref__", "_axes", "_center", "_native", "body_length")

    def __init__(
        self,
        mesh: Mesh,
        *,
        forward: Sequence[float] = (0.0, 0.0, 1.0),
        up: Sequence[float] = (0.0, 1.0, 0.0),
        method: str = "lindstrom-turk",
        step: float = 0.5**0.5,
        coarsest: int = 12,
        directions: int = 24,
    ) -> None:
        if not isinstance(mesh, Mesh):
            raise MeshlodError(f"a LevelTable is made of a Mesh, not {type(mesh).__name__}")
        ahead, top = triple("forward", forward), triple("up", up)
        self._native = _native.NativeLevelTable(
            mesh._native,
            list(ahead),
            list(top),
            word("method", method),
            number("step", step),
            whole("coarsest", coarsest, 1, 2**32 - 1),
            whole("directions", directions, 2, 32),
        )
        self._axes = model_axes(ahead, top)
        used = mesh.vertices[np.unique(mesh.faces)] @ self._axes.T
        low, high = used.min(axis=0), used.max(axis=0)
        #: Length of the model, in its own unit: the longest side of its box along these axes.
        self.body_length = float((high - low).max())
        self._center = (low + high) / 2 @ self._axes

    @property
    def frame(self) -> NDArray[np.float64]:
        """Matrix from the frame of a member to the space of the model, for columns.

        A member at a matrix ``m`` of :meth:`Flock.transforms` is an instance of the model at
        ``m @ numpy.linalg.inv(table.frame)``.
        """
        matrix = np.eye(4)
        matrix[:3, :3] = self._axes.T * self.body_length
        matrix[:3, 3] = self._center
        return matrix

    @property
    def vertices(self) -> NDArray[np.float32]:
        """Positions of the vertices of all levels: a read-only view of shape (n, 3)."""
        return self._native.vertices

    @property
    def attributes(self) -> dict[str, NDArray[np.float32]]:
        """Attributes of the vertices by name, of shape (n, width); there are always normals."""
        return by_name(self._native.attributes())

    @property
    def triangles(self) -> NDArray[np.uint32]:
        """Vertices of the triangles of all levels: a read-only view of shape (m, 3)."""
        return self._native.triangles

    @property
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None:
        """Names of the materials, and the material of each triangle, if there are any."""
        return self._native.materials()

    @property
    def ranges(self) -> NDArray[np.int64]:
        """First triangle of each level, and the one behind its last: a read-only view of shape
        (levels, 2).
        """
        return self._native.ranges

    @property
    def errors(self) -> NDArray[np.float32]:
        """Greatest distance of the model's vertices from each level, in body lengths: a read-only
        view.
        """
        return self._native.errors[:, 0]

    @property
    def depth(self) -> int:
        """Number of levels of the whole model."""
        return self._native.depth()

    def mesh(self, level: int) -> Mesh:
        """Returns a level as a mesh of its own, in the frame of a member."""
        return Mesh._of(self._native.mesh(whole("level", level, 0, len(self) - 1)))

    def draw(
        self,
        flock: Flock,
        levels: ArrayLike,
        camera: Camera,
        *,
        obstacles: Sequence[Mesh] = (),
    ) -> NDArray[np.uint8]:
        """Returns a picture of shape (height, width, 4), every member at its level.

        ``levels`` are those of :meth:`Selector.select`. ``obstacles`` are in body lengths, with +y
        up, as those of a :class:`Film`. Impostors have one size: members that are smaller by their
        ``scales`` are drawn at the coarsest level of the whole model in place of one.
        """
        arguments, seen, origin = seen_arguments(flock, camera)
        chosen = as_array(levels, "levels")
        count = len(arguments["positions"])
        if chosen.shape != (count,) or chosen.dtype != np.uint16:
            shape, dtype = chosen.shape, chosen.dtype
            raise MeshlodError(f"levels must be uint16 of shape ({count},), not {dtype} of {shape}")
        scales = None
        if flock.scales is not None:
            scales = np.require(flock._sizes(count), np.float32, ALIGNED)
        around = _natives_of(obstacles, flock._turn() @ origin / flock._unit())
        levels = np.require(chosen, np.uint16, ALIGNED)
        pixels = self._native.draw(arguments, levels, seen, around, scales)
        width, height = seen[3]
        return np.frombuffer(pixels, dtype=np.uint8).reshape(height, width, 4)

    def __len__(self) -> int:
        return len(self.ranges)

    def __repr__(self) -> str:
        return f"LevelTable({len(self)} levels, {len(self.vertices)} vertices)"


def _natives_of(obstacles: Any, origin: NDArray[np.float64]) -> list[_native.NativeMesh]:
    """Returns obstacles, moved so that ``origin`` is at 0."""
    if isinstance(obstacles, Mesh) or not hasattr(obstacles, "__iter__"):
        kind = type(obstacles).__name__
        raise MeshlodError(f"obstacles must be a sequence of Meshes, not {kind}")
    meshes = list(obstacles)
    for mesh in meshes:
        if not isinstance(mesh, Mesh):
            raise MeshlodError(f"obstacles must be Meshes, not {type(mesh).__name__}")
    if origin.any():
        meshes = [Mesh(mesh.vertices - origin, mesh.faces) for mesh in meshes]
    return [mesh._native for mesh in meshes]
