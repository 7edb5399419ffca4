"""Multiresolution files, and meshes extracted from them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

from . import _native
from ._asked import whole
from ._errors import MeshlodError
from ._mesh import Mesh, Path

#: A ball, as its center and radius, or a box, as its least and greatest corner.
Focus = tuple[Sequence[float], float | Sequence[float]]


@dataclass(frozen=True)
class Camera:
    """A perspective camera."""

    #: Position of the camera.
    eye: Sequence[float]
    #: Point that it looks at.
    look: Sequence[float]
    #: Direction that points up in the picture.
    up: Sequence[float] = (0.0, 1.0, 0.0)
    #: Vertical field of view, in radians.
    fov: float = 0.8
    #: Width and height of the picture, in pixels.
    size: tuple[int, int] = (1024, 1024)


class Model:
    """A ``.mlod`` file: all levels of a mesh. Every extraction reads what it needs."""

    __slots__ = ("_native", "path")

    def __init__(self, path: Path) -> None:
        #: Path of the file.
        self.path = os.fspath(path)
        self._native = _native.NativeModel(self.path)

    def extract(
        self,
        *,
        error: float | None = None,
        faces: int | None = None,
        camera: Camera | None = None,
        focus: Focus | None = None,
        verify: bool = True,
        crop: bool = False,
    ) -> Mesh:
        """Returns a mesh of one level of detail, without cracks.

        ``error`` is the greatest distance from the surface, 0 by default; with a ``camera`` it is
        in pixels, 1 by default, and holds in the picture. ``faces`` is the greatest number of
        faces. ``focus`` is where the error matters: a ball ``(center, radius)`` or a box
        ``(least corner, greatest corner)``; ``crop`` leaves out what is outside.

        Unless ``faces`` is given, the error is proved; without ``verify`` it goes by the errors
        stored in the file, which is faster.
        """
        if error is None:
            error = 0.0 if camera is None else 1.0
        if faces is not None:
            faces = whole("faces", faces, 0, 2**53)
        sphere, corners = None, None
        if focus is not None:
            try:
                first, second = focus
                if isinstance(second, (int, float)):
                    sphere = ([float(x) for x in first], float(second))
                else:
                    corners = [[float(x) for x in first], [float(x) for x in second]]
            except (TypeError, ValueError):
                shapes = "(center, radius) or (least corner, greatest corner)"
                raise MeshlodError(f"focus must be {shapes}, not {focus!r}") from None
        seen = None
        if camera is not None:
            eye, look, up = ([float(x) for x in at] for at in (camera.eye, camera.look, camera.up))
            seen = (eye, look, up, camera.fov, list(camera.size))
        found = self._native.extract(error, faces, seen, sphere, corners, verify, crop)
        return Mesh._of(found)

    def __repr__(self) -> str:
        return f"Model({self.path!r})"
