"""Multiresolution files, and meshes extracted from them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

from . import _native
from ._asked import number, path_name, size_px, triple, whole
from ._errors import MeshlodError, warn
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
        self.path = path_name(path)
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
        stored in the file, which is faster. A :class:`MeshlodWarning` says what cannot be met:
        an error below the rounding of a file that is not lossless, fewer faces than its coarsest
        level has, a focus that no face intersects, and a file that was cut off. An error of 0 asks
        for the finest level in the file, whose vertices that rounding has moved.
        """
        sphere, corners = (None, None) if focus is None else _focus(focus)
        most = None if faces is None else whole("faces", faces, 0, 2**53)
        least = (0.0 if camera is None else 1.0) if error is None else number("error", error)
        seen = None if camera is None else _seen(camera)
        found, report = self._native.extract(
            least, most, seen, sphere, corners, bool(verify), bool(crop)
        )
        for text in _missed(report, least, most, camera is not None):
            warn(f"{self.path}: {text}")
        if not report["meets_focus"] and (focus is not None or crop):
            rest = "" if crop else ", so all are as coarse as the file has them"
            warn(f"{self.path}: no face intersects the focus{rest}")
        return Mesh._of(found)

    def __repr__(self) -> str:
        return f"Model({self.path!r})"


def _focus(focus: Any) -> tuple[tuple[list[float], float] | None, list[list[float]] | None]:
    """Returns a ball or the corners of a box."""
    try:
        first, second = focus
        if isinstance(second, Real):
            return (list(triple("focus", first)), float(second)), None
        return None, [list(triple("focus", first)), list(triple("focus", second))]
    except (TypeError, ValueError):
        shapes = "(center, radius) or (least corner, greatest corner)"
        raise MeshlodError(f"focus must be {shapes}, not {focus!r}") from None


def _seen(camera: Any) -> tuple[list[float], list[float], list[float], float, list[int]]:
    """Returns a camera in numbers."""
    if not isinstance(camera, Camera):
        raise MeshlodError(f"camera must be a Camera, not {type(camera).__name__}")
    at = {name: list(triple(name, getattr(camera, name))) for name in ("eye", "look", "up")}
    return at["eye"], at["look"], at["up"], number("fov", camera.fov), size_px(camera.size)


def _missed(
    report: dict[str, Any], error: float, faces: int | None, is_pixels: bool
) -> list[str]:
    """Says what a mesh lacks of what was asked for."""
    texts = []
    (there, whole_file), piece = report["pieces"], report["piece_name"]
    if there < whole_file:
        texts.append(
            f"the file is truncated, and {there} of its {whole_file} {piece}s are present: finer "
            "levels are missing, and errors refer to what is there"
        )
    if faces is not None and report["level_faces"] > faces:
        has = f"the coarsest level has {report['level_faces']}"
        texts.append(f"faces={faces} is out of reach: {has}")
    if report["holds"] is False and error > 0:
        asked, part = (f"{error:g} pixels", "parts of it") if is_pixels else (f"{error:g}", "it")
        texts.append(
            f"an error of {asked} is below the rounding of the file, {report['rounding']:.3g}: "
            f"{part} cannot be that close to the mesh; build it with lossless=True"
        )
    return texts
