"""Types of arguments that several functions take."""

from __future__ import annotations

from typing import TypedDict

from numpy.typing import ArrayLike

from ._progress import ProgressLike

#: A length in the unit of the points, or a percentage of the diagonal of their bounding box, as in
#: ``"0.1%"``.
Length = float | str


class SceneOptions(TypedDict, total=False):
    """Keywords of :meth:`Scene.simplify`, for type checkers."""

    max_error: Length | None
    method: str
    topology: str
    lock_boundary: bool
    polish: bool
    weights: tuple[float, float, float] | None
    precision: str
    progress: ProgressLike


class MeshOptions(SceneOptions, total=False):
    """Keywords of :meth:`Mesh.simplify`, for type checkers."""

    locks: ArrayLike | None


class ArrayOptions(MeshOptions, total=False):
    """Keywords of :func:`meshlod.simplify`, for type checkers."""

    preserve_border: bool | None
    agg: float | None
    verbose: bool
    return_collapses: bool
    lossless: bool


class RepairOptions(TypedDict, total=False):
    """Keywords of :meth:`Mesh.repair`, for type checkers."""

    weld: float | None
    stitch: float | None
    fill_holes: int | None


class TilesOptions(TypedDict, total=False):
    """Keywords of :func:`meshlod.dask.tiles`, for type checkers: see :func:`meshlod.tiles`."""

    tile_faces: int
    plain: bool
    skirts: bool
    up: str
    lat: float | None
    lon: float | None
    alt: float
    ecef: bool
    weld: float | None
