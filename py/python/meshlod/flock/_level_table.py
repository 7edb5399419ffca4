"""Levels of a model for its thousands of instances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _native
from .._arrays import ALIGNED, by_name
from .._asked import number, triple, whole, word
from .._errors import MeshlodError
from .._mesh import Mesh
from .._query import Camera
from ._camera import camera_arguments
from ._members import Flock


class LevelTable:
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

    __slots__ = ("__weakref__", "_axes", "_center", "_levels", "_native", "body_length")

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
        self._axes = _axes(np.array(ahead), np.array(top))
        used = mesh.vertices[np.unique(mesh.faces)] @ self._axes.T
        low, high = used.min(axis=0), used.max(axis=0)
        #: Length of the model, in its own unit: the longest side of its box along these axes.
        self.body_length = float((high - low).max())
        self._center = (low + high) / 2 @ self._axes
        ranges, errors = self._native.levels()
        for array in (ranges, errors):
            array.setflags(write=False)
        self._levels = ranges, errors

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
    def ranges(self) -> NDArray[np.int64]:
        """First triangle of each level, and the one behind its last, of shape (levels, 2)."""
        return self._levels[0]

    @property
    def errors(self) -> NDArray[np.float32]:
        """Greatest distance of the model's vertices from each level, in body lengths."""
        return self._levels[1]

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
        up, as those of a :class:`Film`.
        """
        arguments = flock._arguments()
        chosen = np.asarray(levels)
        count = len(arguments["positions"])
        if chosen.shape != (count,) or chosen.dtype != np.uint16:
            shape, dtype = chosen.shape, chosen.dtype
            raise MeshlodError(f"levels must be uint16 of shape ({count},), not {dtype} of {shape}")
        seen = camera_arguments(camera, flock)
        around = [_native_of(mesh) for mesh in obstacles]
        pixels = self._native.draw(
            arguments, np.require(chosen, np.uint16, ALIGNED), seen, around
        )
        width, height = seen[3]
        return np.frombuffer(pixels, dtype=np.uint8).reshape(height, width, 4)

    def __len__(self) -> int:
        return len(self.ranges)

    def __repr__(self) -> str:
        return f"LevelTable({len(self)} levels, {len(self.vertices)} vertices)"


def _axes(forward: NDArray[np.float64], up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the rotation from the axes of a model to left, up and heading."""
    heading = forward / np.linalg.norm(forward)
    left = np.cross(up, heading)
    left /= np.linalg.norm(left)
    return np.stack([left, np.cross(heading, left), heading])


def _native_of(mesh: Any) -> _native.NativeMesh:
    if not isinstance(mesh, Mesh):
        raise MeshlodError(f"obstacles must be Meshes, not {type(mesh).__name__}")
    return mesh._native
