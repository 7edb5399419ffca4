"""Matrices that place instances of a model, taken apart."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._arrays import as_array
from .._errors import MeshlodError
from ._frames import frames

#: Deviation from an upright member, as a part of its length, which is rounding.
TOLERANCE = 1e-2

#: Difference of sizes, as a part of the largest, which is rounding.
SAME_SIZE = 1e-4

#: Last row of a matrix for columns.
LAST_ROW = np.array([0.0, 0.0, 0.0, 1.0])


class Instances(NamedTuple):
    """Places, headings and sizes of instances."""

    positions: NDArray[np.float64]
    headings: NDArray[np.float64]
    #: Factor of the largest instance.
    scale: float
    #: Factors of the others in parts of that; ``None`` if all have one size.
    scales: NDArray[np.float64] | None


def taken_apart(
    transforms: ArrayLike, axes: NDArray[np.float64], center: NDArray[np.float64], up: str
) -> Instances:
    """Takes matrices apart, for a model with these axes and this middle of its box."""
    matrices = _matrices(transforms)
    linear = matrices[:, :3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        # What overflows is refused as no scale.
        scales = np.cbrt(np.linalg.det(linear))
        turned = linear @ axes.T
        upright = frames(turned[:, :, 2], up) * scales[:, None, None]
        apart = np.abs(turned - upright).max(axis=(1, 2), initial=0.0)
    wrong = ~(apart <= TOLERANCE * scales) | ~(scales > 0) | ~np.isfinite(scales)
    if wrong.any():
        must = "must turn an upright member without mirror, roll, or more than one scale"
        raise MeshlodError(f"transforms: row {int(np.argmax(wrong))} {must}")
    positions = linear @ center + matrices[:, :3, 3]
    most = float(scales.max(initial=0.0)) or 1.0
    parts = scales / most
    parts[parts > 1 - SAME_SIZE] = 1.0
    return Instances(positions, turned[:, :, 2], most, None if (parts == 1).all() else parts)


def _matrices(transforms: Any) -> NDArray[np.float64]:
    """Returns matrices for columns."""
    matrices = as_array(transforms, "transforms")
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4) or matrices.dtype.kind not in "fiu":
        shape, dtype = matrices.shape, matrices.dtype
        raise MeshlodError(f"transforms must have the shape (n, 4, 4), not {dtype} of {shape}")
    matrices = matrices.astype(np.float64)
    finite = np.isfinite(matrices).all(axis=(1, 2))
    if not finite.all():
        raise MeshlodError(f"transforms: row {int(np.argmin(finite))} is not finite")
    wrong = np.abs(matrices[:, 3] - LAST_ROW).max(axis=1, initial=0.0) > 1e-6
    if wrong.any():
        row = int(np.argmax(wrong))
        if matrices[row, 3, :3].any() and not matrices[row, :3, 3].any():
            has = "has its translation in the last row: transpose it"
            raise MeshlodError(f"transforms: row {row} {has}")
        last = matrices[row, 3].tolist()
        raise MeshlodError(f"transforms: row {row} must end with 0, 0, 0, 1, not {last}")
    return matrices
