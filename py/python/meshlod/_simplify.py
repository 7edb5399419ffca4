"""Simplification of arrays, as other packages offer it."""

from __future__ import annotations

from collections.abc import Mapping
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _asked, _native
from ._arrays import as_attributes, as_faces, as_named, as_points, as_vertices, returned
from ._errors import MeshlodError, warn
from ._mesh import Mesh
from ._options import Length
from ._progress import ProgressLike, callback
from ._reports import Report

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import ArrayOptions

Points = NDArray[np.float64]
Faces = NDArray[np.int32]
Layers = dict[str, NDArray[Any]]


# Arrays without attributes. That some calls fit the next two as well is meant: the first counts.
@overload
def simplify(  # pyright: ignore[reportOverlappingOverload]
    points: ArrayLike,
    faces: ArrayLike,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    normals: None = None,
    uvs: None = None,
    colors: None = None,
    attributes: None = None,
    return_report: Literal[False] = False,
    **options: Unpack[ArrayOptions],
) -> tuple[Points, Faces]: ...
@overload
def simplify(  # pyright: ignore[reportOverlappingOverload]
    points: ArrayLike,
    faces: ArrayLike,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    normals: None = None,
    uvs: None = None,
    colors: None = None,
    attributes: None = None,
    return_report: Literal[True],
    **options: Unpack[ArrayOptions],
) -> tuple[Points, Faces, Report]: ...


# Arrays with attributes.
@overload
def simplify(
    points: ArrayLike,
    faces: ArrayLike,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    normals: ArrayLike = ...,
    uvs: ArrayLike = ...,
    colors: ArrayLike = ...,
    attributes: Mapping[str, ArrayLike] = ...,
    return_report: Literal[False] = False,
    **options: Unpack[ArrayOptions],
) -> tuple[Points, Faces, Layers]: ...
@overload
def simplify(
    points: ArrayLike,
    faces: ArrayLike,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    normals: ArrayLike = ...,
    uvs: ArrayLike = ...,
    colors: ArrayLike = ...,
    attributes: Mapping[str, ArrayLike] = ...,
    return_report: Literal[True],
    **options: Unpack[ArrayOptions],
) -> tuple[Points, Faces, Layers, Report]: ...


# Meshes of this package.
@overload
def simplify(
    points: Mesh,
    faces: None = None,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    return_report: Literal[False] = False,
    **options: Unpack[ArrayOptions],
) -> Mesh: ...
@overload
def simplify(
    points: Mesh,
    faces: None = None,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    return_report: Literal[True],
    **options: Unpack[ArrayOptions],
) -> tuple[Mesh, Report]: ...


# Meshes of other packages, and what is known only when it runs.
@overload
def simplify(
    points: Any,
    faces: ArrayLike | None = None,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    normals: ArrayLike | None = None,
    uvs: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    attributes: Mapping[str, ArrayLike] | None = None,
    return_report: bool = False,
    triangles: ArrayLike | None = None,
    **options: Unpack[ArrayOptions],
) -> Any: ...
def simplify(
    points: Any,
    faces: ArrayLike | None = None,
    target_reduction: float | None = None,
    target_count: int | None = None,
    *,
    max_error: Length | None = None,
    normals: ArrayLike | None = None,
    uvs: ArrayLike | None = None,
    colors: ArrayLike | None = None,
    attributes: Mapping[str, ArrayLike] | None = None,
    method: str = "lindstrom-turk",
    topology: str = "free",
    locks: ArrayLike | None = None,
    lock_boundary: bool = False,
    polish: bool = False,
    weights: tuple[float, float, float] | None = None,
    precision: str = "auto",
    progress: ProgressLike = None,
    return_report: bool = False,
    triangles: ArrayLike | None = None,
    preserve_border: bool | None = None,
    agg: float | None = None,
    verbose: bool = False,
    return_collapses: bool = False,
    lossless: bool = False,
) -> Any:
    """Returns a coarser mesh: ``(points, faces)``.

    Exactly one of ``target_reduction`` (part of the faces to remove, 0 to 1), ``target_count``
    (number of faces to keep) and ``max_error`` (distance in the unit of the points, or a percentage
    of the diagonal of their bounding box, ``"0.1%"``, which is then proved for every point of both
    surfaces) says how coarse. If the target is out of reach, a :class:`MeshlodWarning` says so.

    ``points`` are rows of three coordinates, ``faces`` rows of three indices of them. The points
    that come back are double precision, the faces 32-bit integers, both new arrays.

    ``normals``, ``uvs``, ``colors`` (0 to 1, or ``uint8``) and further ``attributes`` have a row
    for each point. They are kept, and come third, as a dictionary with the same names. Whole
    numbers in ``attributes`` are labels, taken from a neighbour; all others are interpolated.
    Values pass through single precision, also where double precision is given and comes back.
    Normals and texture coordinates given as whole numbers come back as floats. Points at equal
    positions may differ in attributes; such a seam does not tear the surface.

    ``locks`` is a mask, or rows, of points that stay where they are; ``lock_boundary`` locks those
    on the boundary. ``topology="keep"`` keeps closed surfaces closed and every component.
    ``polish`` fits the points that are left to the original once more: distances are some 7 % less,
    for up to half as long again; with ``max_error`` it does nothing.
    ``weights`` are those of normals, uvs and colours against distances. ``precision`` is that of
    the coordinates for which ``max_error`` is proved: ``"f32"``, as most files have them,
    ``"f64"``, or ``"auto"``, which is 32 bits unless they take more than half of the error;
    :attr:`Report.precision` says which, and ``save`` takes it. With ``return_report`` a
    :class:`Report` comes last.

    ``progress`` is a function of the part that is done, or ``True`` for a bar on a terminal. It is
    called with 1 at the end. Before that, how far a run with ``max_error`` goes is not known, so
    1 is all that it hears.

    In place of arrays ``points`` may be a mesh of this package, trimesh, pyvista, open3d or meshio:
    then a mesh of that package comes back.

    ``triangles``, ``preserve_border``, ``agg``, ``verbose``, ``return_collapses`` and ``lossless``
    are those of ``fast_simplification.simplify``, so that changing the import is enough. ``agg``
    has no effect; collapses are not recorded.

    :raises MeshlodError: an array, a target or an option that is not what it should be.
    """
    if return_collapses or lossless:
        name = "return_collapses" if return_collapses else "lossless"
        advice = "leave it out" if return_collapses else "use max_error=0"
        raise MeshlodError(f"{name} is not supported: {advice}")
    if agg is not None:
        warn("agg has no effect: there is one quality")
    if triangles is not None:
        if faces is not None:
            raise MeshlodError("give faces or triangles, not both")
        faces = triangles
    if isinstance(faces, Real):
        # A mesh brings its faces along: this is meant to be a target.
        name = "target_reduction" if faces <= 1 else "target_count"
        raise MeshlodError(f"faces must be an array, not {faces}: write {name}={faces}")
    lock_boundary = lock_boundary or bool(preserve_border)
    kind, value = _asked.target(target_reduction, target_count, max_error)
    given = {"normals": normals, "uvs": uvs, "colors": colors, **as_named(attributes)}
    bar = callback(progress, "simplifying")
    options: dict[str, Any] = {
        "method": method,
        "topology": topology,
        "lock_boundary": lock_boundary,
        "polish": polish,
        "weights": weights,
        "precision": precision,
        "progress": bar,
    }
    if faces is None:
        if any(values is not None for values in given.values()):
            raise MeshlodError("a mesh brings its attributes along: give points and faces instead")
        return _of_mesh(points, kind, value, locks, options, return_report)
    rows = as_points(points)
    layers = as_attributes(len(rows), normals, uvs, colors, attributes)
    mesh, vertices = _native.from_arrays(rows, as_faces(faces), layers, locks is not None)
    locked: Any = None if locks is None else as_vertices(locks, len(rows))
    if locked is not None and vertices is not None:
        locked = vertices[locked]
    asked = _asked.asked(mesh, kind, value, locks=locked, **options)
    level, fields = _native.simplify(mesh, asked)
    out: tuple[Any, ...] = level.to_arrays()
    out = (*out[:2], returned(out[2], given)) if layers else out[:2]
    report = Report(**fields)
    if not report.reached:
        warn(report.why_not_reached())
    return (*out, report) if return_report else out


def _of_mesh(
    mesh: Any,
    kind: str,
    value: float,
    locks: ArrayLike | None,
    options: dict[str, Any],
    return_report: bool,
) -> Any:
    from . import convert

    own, back = (mesh, None) if isinstance(mesh, Mesh) else convert.adopted(mesh)
    level, report = own._simplified(kind, value, locks, options)
    if not report.reached:
        warn(report.why_not_reached())
    out = level if back is None else back(level)
    return (out, report) if return_report else out
