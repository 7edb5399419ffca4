"""Triangle meshes, with what can be done to them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _asked, _native
from ._arrays import as_attributes, as_faces, as_points, as_vertices, by_name
from ._errors import MeshlodError, warn
from ._immutable import Immutable
from ._options import Length
from ._progress import ProgressLike, callback
from ._reports import CheckReport, Distance, OneSidedDistance, Report

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._model import Model
    from ._options import MeshOptions, RepairOptions

Path = str | os.PathLike[str]

#: Size of pictures in notebooks, in pixels.
PICTURE = (512, 512)


class Mesh(Immutable):
    """A triangle mesh that never changes: all methods return new ones.

    Names are those of trimesh where both have the thing.

    ``vertices``, ``faces`` and the attributes are read-only views of its memory. They have one row
    for each set of attributes: vertices at a seam of the texture come several times, and are one
    vertex to the methods all the same.

    ``vertices`` are rows of three coordinates, ``faces`` rows of three indices of them,
    counter-clockwise seen from outside. ``normals``, ``uvs``, ``colors`` (0 to 1, or ``uint8``) and
    further ``attributes`` have a row for each vertex.
    """

    __slots__ = ("__weakref__", "_native")

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        attributes: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        points = as_points(vertices, "vertices")
        layers = as_attributes(len(points), normals, uvs, colors, attributes)
        self._native, _ = _native.from_arrays(points, as_faces(faces), layers, False)

    @classmethod
    def _of(cls, native: _native.NativeMesh) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._native = native
        return mesh

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Position of each vertex: a read-only view of shape (n, 3)."""
        return self._native.vertices

    @property
    def faces(self) -> NDArray[np.int32]:
        """Vertices of each face: a read-only view of shape (m, 3)."""
        return self._native.faces

    @property
    def attributes(self) -> dict[str, NDArray[np.float32]]:
        """Attributes of the vertices by name, as read-only views."""
        return by_name(self._native.attributes())

    @property
    def normals(self) -> NDArray[np.float32] | None:
        """Normals of the vertices, if there are any."""
        return self.attributes.get("normals")

    @property
    def uvs(self) -> NDArray[np.float32] | None:
        """First texture coordinates of the vertices, if there are any."""
        return self.attributes.get("uvs")

    @property
    def colors(self) -> NDArray[np.float32] | None:
        """First colours of the vertices, from 0 to 1, if there are any."""
        return self.attributes.get("colors")

    @property
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None:
        """Names of the materials, and the material of each face, if there are any."""
        return self._native.materials()

    @property
    def objects(self) -> tuple[list[str], NDArray[np.uint32]] | None:
        """Names of the objects, and the object of each face, if there are any."""
        return self._native.objects()

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Least and greatest coordinates of what faces use; NaN if there are no faces."""
        found = self._native.bounds()
        return np.full((2, 3), np.nan) if found is None else np.array(found)

    @property
    def extents(self) -> NDArray[np.float64]:
        """Size of the bounding box along each axis; NaN if there are no faces."""
        least, greatest = self.bounds
        size: NDArray[np.float64] = greatest - least
        return size

    @property
    def area(self) -> float:
        """Area of the surface."""
        return _native.sizes(self._native)[0]

    @property
    def volume(self) -> float:
        """Volume that the surface encloses, with a sign; it means little if it is not closed."""
        return _native.sizes(self._native)[1]

    @property
    def is_watertight(self) -> bool:
        """True if each edge has exactly two faces; seams of attributes do not count as open."""
        faces_of_edges = self._edges()[1]
        return len(faces_of_edges) > 0 and bool((faces_of_edges == 2).all())

    @property
    def euler_number(self) -> int:
        """Vertices minus edges plus faces: 2 for a sphere, 0 for a torus.

        A seam of attributes is no edge of the surface, and vertices without faces do not count.
        """
        vertices, faces_of_edges = self._edges()
        return vertices - len(faces_of_edges) + len(self.faces)

    def apply_transform(self, matrix: ArrayLike) -> Mesh:
        """Returns the mesh moved by a matrix of shape (4, 4); this one stays as it is.

        In trimesh it is changed in place: ``mesh = mesh.apply_transform(matrix)`` is right for
        both. Normals turn with it, and a matrix that mirrors flips the faces, so that they still
        are counter-clockwise seen from outside. The last row must be 0, 0, 0, 1.
        """
        return Mesh._of(self._native.transformed(_asked.affine("matrix", matrix)))

    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: Literal[False] = False,
        **options: Unpack[MeshOptions],
    ) -> Mesh: ...
    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: Literal[True],
        **options: Unpack[MeshOptions],
    ) -> tuple[Mesh, Report]: ...
    @overload
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        return_report: bool,
        **options: Unpack[MeshOptions],
    ) -> Mesh | tuple[Mesh, Report]: ...
    def simplify(
        self,
        target_reduction: float | None = None,
        target_count: int | None = None,
        *,
        max_error: Length | None = None,
        method: str = "lindstrom-turk",
        topology: str = "free",
        locks: ArrayLike | None = None,
        lock_boundary: bool = False,
        polish: bool = False,
        weights: tuple[float, float, float] | None = None,
        precision: str = "auto",
        progress: ProgressLike = None,
        return_report: bool = False,
    ) -> Mesh | tuple[Mesh, Report]:
        """Returns a coarser mesh, or ``(mesh, report)``; see :func:`meshlod.simplify`."""
        kind, value = _asked.target(target_reduction, target_count, max_error)
        options: dict[str, Any] = {
            "method": method,
            "topology": topology,
            "lock_boundary": lock_boundary,
            "polish": polish,
            "weights": weights,
            "precision": precision,
            "progress": callback(progress, "simplifying"),
        }
        level, report = self._simplified(kind, value, locks, options)
        if not report.reached:
            warn(report.why_not_reached())
        return (level, report) if return_report else level

    def lods(
        self,
        ratios: Sequence[float] = (0.5, 0.25, 0.125),
        *,
        method: str = "lindstrom-turk",
        topology: str = "free",
        lock_boundary: bool = False,
        polish: bool = False,
        progress: ProgressLike = None,
    ) -> list[Mesh]:
        """Returns coarser and coarser meshes, with these ratios of the faces, from one run."""
        if isinstance(ratios, str) or not hasattr(ratios, "__iter__"):
            raise MeshlodError(f"ratios must be numbers in a row, not {ratios!r}")
        ratios = [_asked.number("ratios", ratio) for ratio in ratios]
        if any(not 0 <= ratio <= 1 for ratio in ratios) or ratios != sorted(ratios, reverse=True):
            raise MeshlodError(f"ratios must fall, and be between 0 and 1, not {ratios}")
        if not ratios:
            return []
        bar = callback(progress, "simplifying")
        options: dict[str, Any] = {
            "method": method,
            "topology": topology,
            "lock_boundary": lock_boundary,
            "polish": polish,
        }
        asked = _asked.asked(self._native, "ratio", ratios[-1], progress=bar, **options)
        done = _native.levels(self._native, ratios, asked)
        reports = [Report(**fields) for _, fields in done]
        missed = [report for report in reports if not report.reached]
        if missed:
            warn(missed[0].why_not_reached())
        return [Mesh._of(level) for level, _ in done]

    def measure(self, other: Mesh, *, samples: int = 500_000, seed: int = 0) -> Distance:
        """Measures the distance from another mesh, in both directions."""
        if not isinstance(other, Mesh):
            raise MeshlodError(f"other must be a Mesh, not {type(other).__name__}")
        samples = _asked.whole("samples", samples, 1, 2**32)
        seed = _asked.whole("seed", seed, 0, 2**64 - 1)
        found: Any = _native.measure(self._native, other._native, samples, seed)
        for side in ("forward", "backward"):
            fields = found[side]
            for place in ("max_from", "max_to"):
                fields[place] = tuple(fields[place])
            found[side] = OneSidedDistance(**fields)
        return Distance(**found)

    def check(self) -> CheckReport:
        """Counts what is wrong with the mesh, by kind."""
        found = _native.check(self._native)
        errors = {kind: count for kind, count, is_error in found if is_error}
        warnings = {kind: count for kind, count, is_error in found if not is_error}
        return CheckReport(errors=errors, warnings=warnings)

    @overload
    def repair(
        self, *, return_report: Literal[False] = False, **options: Unpack[RepairOptions]
    ) -> Mesh: ...
    @overload
    def repair(
        self, *, return_report: Literal[True], **options: Unpack[RepairOptions]
    ) -> tuple[Mesh, dict[str, int]]: ...
    @overload
    def repair(
        self, *, return_report: bool, **options: Unpack[RepairOptions]
    ) -> Mesh | tuple[Mesh, dict[str, int]]: ...
    def repair(
        self,
        *,
        weld: float | None = None,
        stitch: float | None = 0.0,
        fill_holes: int | None = None,
        return_report: bool = False,
    ) -> Mesh | tuple[Mesh, dict[str, int]]:
        """Returns a mesh without errors, or ``(mesh, counts)`` with the changes by kind.

        ``weld`` and ``stitch`` are distances within which vertices are merged, and boundary edges
        sewn together. ``fill_holes`` is the greatest number of edges of holes to fill.
        """
        if fill_holes is not None:
            fill_holes = _asked.whole("fill_holes", fill_holes, 0, 2**53)
        weld = None if weld is None else _asked.number("weld", weld)
        stitch = None if stitch is None else _asked.number("stitch", stitch)
        repaired, counts = _native.repair(self._native, weld, stitch, fill_holes)
        mesh = Mesh._of(repaired)
        return (mesh, dict(counts)) if return_report else mesh

    def strip(self, *, quality: str = "quick") -> NDArray[np.uint32]:
        """Returns triangle strips of the faces: rows of vertices, with 2**32 - 1 between strips."""
        return _native.strip(self._native, _asked.word("quality", quality))

    def compress(self, path: Path, *, bits: int = 11, max_error: Length | None = None) -> int:
        """Writes a compressed file, ``.mlz`` or ``.mlq``, and returns its size in bytes.

        ``bits`` are those of a coordinate; ``max_error`` is a mean distance in their place, also as
        a percentage of the diagonal of :attr:`bounds`, ``"0.01%"``.
        """
        bits = _asked.whole("bits", bits, 2, 24)
        name, error = _asked.path_name(path), None
        if max_error is not None:
            error = _asked.length("max_error", max_error, self._native)
        size, reached = _native.compress(self._native, name, bits, error)
        if not reached:
            warn(f"{name}: the target was not met")
        return size

    def build(
        self,
        path: Path,
        *,
        lossless: bool = False,
        errors: str = "measured",
        order: str = "cost",
    ) -> Model:
        """Writes all levels to a ``.mlod`` file, and opens it.

        ``errors`` are ``"estimate"``, ``"measured"``, or ``"bound"``, which are proved. ``order`` is
        that of the contractions: ``"cost"``, or ``"error"``, by which levels within an error have a
        fifth to a third fewer faces, and building takes about ten times as long. Ctrl-C leaves a file
        that was there as it was.
        """
        from ._model import Model

        name = _asked.path_name(path)
        scene = _native.NativeScene.of("", self._native)
        words = _asked.word("errors", errors), _asked.word("order", order)
        _native.build(scene, name, bool(lossless), *words)
        return Model(name)

    def render(
        self,
        size: tuple[int, int] = PICTURE,
        *,
        wireframe: bool = False,
        up: str = "y",
        direction: tuple[float, float, float] | None = None,
    ) -> NDArray[np.uint8]:
        """Returns a picture of shape (height, width, 4), the same on every machine.

        ``direction`` is that in which the camera looks.
        """
        width, height = _asked.size_px(size)
        toward = None if direction is None else _asked.triple("direction", direction)
        axis, lines = _asked.word("up", up), bool(wireframe)
        pixels = _native.render(self._native, [width, height], lines, axis, toward, False)
        return np.frombuffer(pixels, dtype=np.uint8).reshape(height, width, 4)

    def save(self, path: Path, *, precision: str = "auto") -> None:
        """Writes a file in the format of its suffix, whole or not at all.

        ``precision`` is that of coordinates where the format has both: ``"f32"``, ``"f64"``, or
        ``"auto"``, which is 32 bits where they keep the shape.
        """
        name, word = _asked.path_name(path), _asked.word("precision", precision)
        scene = _native.NativeScene.of("", self._native)
        for note in _native.save(scene, name, word):
            warn(f"{name}: {note}")

    def to_arrays(self) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Returns vertices and faces as arrays of their own, which may be changed."""
        points, faces, _ = self._native.to_arrays()
        return points, faces

    def _edges(self) -> tuple[int, NDArray[np.int64]]:
        """Returns the number of vertices with faces, and that of the faces of each edge."""
        vertex_of_points = self._native.vertex_of_points().astype(np.int64)
        faces = vertex_of_points[self.faces]
        sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
        keys = sides.min(axis=1) * len(vertex_of_points) + sides.max(axis=1)
        faces_of_edges = np.unique(keys, return_counts=True)[1]
        return len(np.unique(faces)), faces_of_edges.astype(np.int64)

    def _simplified(
        self, kind: str, value: float, locks: ArrayLike | None, options: dict[str, Any]
    ) -> tuple[Mesh, Report]:
        locked = None
        if locks is not None:
            vertices = self._native.vertex_of_points()
            locked = vertices[as_vertices(locks, len(vertices))]
        asked = _asked.asked(self._native, kind, value, locks=locked, **options)
        level, fields = _native.simplify(self._native, asked)
        return Mesh._of(level), Report(**fields)

    def _repr_png_(self) -> bytes | None:
        if len(self.faces) == 0:
            return None
        return _native.render(self._native, list(PICTURE), False, "y", None, True)

    def _repr_mimebundle_(
        self, include: object = None, exclude: object = None
    ) -> dict[str, object]:
        from . import _view

        picture = self._repr_png_()
        return _view.bundle(_view.of_mesh(self, picture), picture, repr(self))

    def __repr__(self) -> str:
        parts = [f"{len(self.vertices)} vertices", f"{len(self.faces)} faces", *self.attributes]
        return f"Mesh({', '.join(parts)})"
