"""Choice of a level for every member."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _native
from .._arrays import ALIGNED, as_array
from .._asked import number, whole, word
from .._errors import MeshlodError
from .._query import Camera
from ._camera import seen_arguments
from ._level_table import LevelTable
from ._members import Flock

#: Level of a member that is not drawn.
HIDDEN = 65535

#: Level of a member that is drawn as a quad of two triangles with a picture of the model.
IMPOSTOR = 65534


class Selector:
    """A policy that chooses a level for every member, and remembers those of the frame before.

    Row i must be the same member in every frame. So cull by ``visible``, not by leaving rows out;
    use one selector for each camera, and a new one after a cut. Threads take turns at a selector.

    ``policy`` is one of:

    - ``"ours"``: spends the budget where a triangle adds most to the picture. It knows which side
      of a member is seen, and leaves out faces that turn their backs.
    - ``"budget"``: shares the budget by the size on the screen, as engines do; a member keeps its
      level until its size has passed the switch by a tenth.
    - ``"screen-error"``: the coarsest level whose error spans at most one pixel.
    - ``"distance"``: triangles in proportion to one by the distance from the camera.
    - ``"speed"``: by distance, and fewer the faster a member crosses the screen.
    - ``"eccentricity"``: by distance, and fewer the farther a member is from where the viewer
      looks.
    - ``"relative-distance"``, ``"direction"``, ``"layer"``: by the paper's factors, which are the
      distance of the leader and the place in the school, the side of the school that is seen, and
      the depth in the school. ``"paper"`` is all three. Members need ``schools`` for them.
    - ``"none"``: every member in view at full detail.
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
        twice the distance. A member is an impostor if ``flock.body_length`` spans fewer pixels than
        ``impostors_below`` at its place. ``visible`` is a mask of members; the others are hidden.
        Members farther than a million body lengths from the camera are refused.
        """
        arguments, seen, _ = seen_arguments(flock, camera)
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
            seen,
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
    mask = as_array(visible, "visible")
    if mask.dtype != np.bool_ or mask.shape != (count,):
        shape, dtype = mask.shape, mask.dtype
        raise MeshlodError(f"visible must be bool of shape ({count},), not {dtype} of {shape}")
    return np.require(mask, np.bool_, ALIGNED)
