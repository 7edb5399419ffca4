"""Choice of a level for every member."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _native
from .._arrays import ALIGNED
from .._asked import number, whole, word
from .._errors import MeshlodError
from .._query import Camera
from ._camera import camera_arguments
from ._level_table import LevelTable
from ._members import Flock

#: Level of a member that is not drawn.
HIDDEN = 65535

#: Level of a member that is drawn as a quad of two triangles with a picture of the model.
IMPOSTOR = 65534


class Selector:
    """A policy that chooses a level for every member, and remembers those of the frame before.

    ``policy`` is ``"ours"``, by what each triangle adds to the picture; ``"budget"``, by the size
    on the screen; ``"screen-error"``, ``"distance"``, ``"speed"``, ``"eccentricity"``; those of the
    paper, ``"relative-distance"``, ``"direction"``, ``"layer"`` and ``"paper"``; or ``"none"``.
    """

    __slots__ = ("_native", "_table", "_triangles")

    def __init__(self, table: LevelTable, policy: str = "ours") -> None:
        if not isinstance(table, LevelTable):
            raise MeshlodError(f"table must be a LevelTable, not {type(table).__name__}")
        self._native = _native.NativeSelector(table._native, word("policy", policy))
        self._table = table
        self._triangles = 0

    def select(
        self,
        flock: Flock,
        camera: Camera,
        *,
        triangles: int | None = None,
        detail: float = 1.0,
        impostors_below: float | None = None,
        visible: ArrayLike | None = None,
    ) -> NDArray[np.uint16]:
        """Returns the level of each member: a row of ``table.ranges``, ``HIDDEN`` or ``IMPOSTOR``.

        ``triangles`` is the budget of the policies ``"ours"`` and ``"budget"``, by default a tenth
        of those of all members at full detail; they keep to it where the coarsest levels of all
        members in view allow. ``detail`` is the fineness of the other policies: 2 keeps detail to
        twice the distance. A member whose body length spans fewer pixels than ``impostors_below``
        is an impostor. ``visible`` is a mask of members; the others are hidden.
        """
        if not isinstance(flock, Flock):
            raise MeshlodError(f"flock must be a Flock, not {type(flock).__name__}")
        arguments = flock._arguments()
        count = len(arguments["positions"])
        if triangles is None:
            triangles = max(1, count * int(self._table.ranges[0, 1]) // 10)
        fine = number("detail", detail)
        if not 1e-6 <= fine <= 1e6:
            raise MeshlodError(f"detail must be between 1e-06 and 1e+06, not {detail!r}")
        below = None if impostors_below is None else number("impostors_below", impostors_below)
        if below is not None and not 0 < below < np.inf:
            raise MeshlodError(f"impostors_below must be greater than 0, not {impostors_below!r}")
        levels, self._triangles = self._native.select(
            arguments,
            camera_arguments(camera, flock),
            whole("triangles", triangles, 0, 2**53),
            fine,
            below,
            _mask(visible, count),
        )
        return levels

    @property
    def triangles(self) -> int:
        """Number of triangles that the last choice draws."""
        return self._triangles


def _mask(visible: Any, count: int) -> NDArray[np.bool_] | None:
    """Returns a mask of ``count`` members."""
    if visible is None:
        return None
    mask = np.asarray(visible)
    if mask.dtype != np.bool_ or mask.shape != (count,):
        shape, dtype = mask.shape, mask.dtype
        raise MeshlodError(f"visible must be bool of shape ({count},), not {dtype} of {shape}")
    return np.require(mask, np.bool_, ALIGNED)
