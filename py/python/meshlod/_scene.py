"""Scenes: all that a file holds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, overload

import numpy as np
from numpy.typing import NDArray

from . import _asked, _native
from ._errors import MeshlodError, warn
from ._immutable import Immutable
from ._mesh import Mesh, Path
from ._options import Length
from ._progress import ProgressLike, callback
from ._reports import Report

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._model import Model
    from ._options import SceneOptions


class Scene(Immutable):
    """All that a file holds: meshes, nodes, materials, textures, skins and animations.

    It never changes. Saved in the format that it was read from, it keeps everything but the
    geometry that was simplified.
    """

    __slots__ = ("_native",)

    def __init__(self, mesh: Mesh, name: str = "") -> None:
        if not isinstance(mesh, Mesh):
            raise MeshlodError(f"a Scene is made of a Mesh, not {type(mesh).__name__}")
        self._native = _native.NativeScene.of(_asked.word("name", name), mesh._native)

    @classmethod
    def _of(cls, native: _native.NativeScene) -> Scene:
        scene = cls.__new__(cls)
        scene._native = native
        return scene

    @classmethod
    def load(cls, path: Path) -> Scene:
        """Reads a file of any format."""
        name = _asked.path_name(path)
        native, notes = _native.load(name)
        for note in notes:
            warn(f"{name}: {note}")
        return cls._of(native)

    @property
    def meshes(self) -> list[tuple[str, Mesh]]:
        """Name of each mesh, and the mesh in its own space."""
        return [(name, Mesh._of(mesh)) for name, mesh in self._native.meshes()]

    @property
    def instances(self) -> list[tuple[int, NDArray[np.float64]]]:
        """Placed meshes: the index of the mesh, and the matrix from its space to the world."""
        return [(mesh, np.array(columns).T) for mesh, columns in self._native.instances()]

    @property
    def materials(self) -> list[str]:
        """Names of the materials."""
        return self._native.materials()

    @property
    def face_count(self) -> int:
        """Number of faces that are shown, counting every placed mesh."""
        return self._native.face_count()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Least and greatest coordinates of all placed meshes; NaN if there are no faces."""
        found = self._native.bounds()
        return np.full((2, 3), np.nan) if found is None else np.array(found)

    @property
    def extents(self) -> NDArray[np.float64]:
        """Size of the bounding box along each axis; NaN if there are no faces."""
        least, greatest = self.bounds
        size: NDArray[np.float64] = greatest - least
        return size

    def flatten(self) -> Mesh:
        """Merges all placed meshes into one, in world space."""
        return Mesh._of(self._native.flatten())

    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: Literal[False] = False,
        **options: Unpack[SceneOptions],
    ) -> Scene: ...
    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: Literal[True],
        **options: Unpack[SceneOptions],
    ) -> tuple[Scene, Report]: ...
    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: bool,
        **options: Unpack[SceneOptions],
    ) -> Scene | tuple[Scene, Report]: ...
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        max_error: Length | None = None,
        method: str = "lindstrom-turk",
        topology: str = "free",
        lock_boundary: bool = False,
        polish: bool = False,
        weights: tuple[float, float, float] | None = None,
        precision: str = "auto",
        progress: ProgressLike = None,
        return_report: bool = False,
    ) -> Scene | tuple[Scene, Report]:
        """Returns a coarser scene, or ``(scene, report)``; see :func:`meshlod.simplify`.

        All meshes share the target, so that detail stays where the scene shows it. A percentage of
        ``max_error`` is one of the diagonal of :attr:`bounds`.
        """
        kind, value = _asked.target(target_reduction, target_count, max_error)
        asked = _asked.asked(
            self._native,
            kind,
            value,
            method=method,
            topology=topology,
            lock_boundary=lock_boundary,
            polish=polish,
            weights=weights,
            precision=precision,
            progress=callback(progress, "simplifying"),
        )
        level, fields = _native.simplify_scene(self._native, asked)
        report = Report(**fields)
        if not report.reached:
            warn(report.why_not_reached())
        scene = Scene._of(level)
        return (scene, report) if return_report else scene

    def save(self, path: Path, *, precision: str = "auto") -> None:
        """Writes a file in the format of its suffix, whole or not at all.

        ``precision`` is that of coordinates where the format has both: ``"f32"``, ``"f64"``, or
        ``"auto"``, which is 32 bits where they keep the shape.
        """
        name, word = _asked.path_name(path), _asked.word("precision", precision)
        for note in _native.save(self._native, name, word):
            warn(f"{name}: {note}")

    def build(
        self,
        path: Path,
        *,
        lossless: bool = False,
        errors: str = "measured",
        order: str = "cost",
    ) -> Model:
        """Writes all levels to a ``.mlod`` file, with the rest of the scene, and opens it.

        ``errors`` are ``"estimate"``, ``"measured"``, or ``"bound"``, which are proved. Measured
        errors also hold in up to 64 poses of the scene's animations. ``order`` is that of
        :meth:`Mesh.build`. A :class:`MeshlodWarning` says what the file lacks.
        """
        from ._model import Model

        name = _asked.path_name(path)
        words = _asked.word("errors", errors), _asked.word("order", order)
        for note in _native.build(self._native, name, bool(lossless), *words):
            warn(f"{name}: {note}")
        return Model(name)

    def __repr__(self) -> str:
        meshes = self._native.mesh_count()
        return f"Scene({meshes} {'mesh' if meshes == 1 else 'meshes'}, {self.face_count} faces)"
