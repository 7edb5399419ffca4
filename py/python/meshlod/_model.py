"""Multiresolution files, and meshes extracted from them."""

from __future__ import annotations

import warnings
from typing import Any

from . import _native
from ._asked import path_name, whole
from ._cut import Cut
from ._errors import warn
from ._mesh import Mesh, Path
from ._options import Length
from ._query import Camera, Focus, Query, query


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
        max_error: Length | None = None,
        faces: int | None = None,
        camera: Camera | None = None,
        focus: Focus | None = None,
        verify: bool = True,
        crop: bool = False,
        error: Length | None = None,
    ) -> Mesh:
        """Returns a mesh of one level of detail, without cracks.

        ``max_error`` is the greatest distance from the surface, 0 by default, or a percentage of
        the diagonal, ``"0.1%"``; with a ``camera`` it is in pixels, 1 by default, and holds in the
        picture. ``error`` is another name of it. ``faces`` is the greatest number of faces.
        ``focus`` is where the error matters: a ball ``(center, radius)`` or a box
        ``(least corner, greatest corner)``; ``crop`` leaves out what is outside.

        Unless ``faces`` is given, the error is proved; without ``verify`` it goes by the errors
        stored in the file, which is faster. A :class:`MeshlodWarning` says what cannot be met:
        an error below the rounding of a file that is not lossless, fewer faces than its coarsest
        level has, a focus that no face intersects, and a file that was cut off. An error of 0 asks
        for the finest level in the file, whose vertices that rounding has moved.
        """
        asked = query(max_error, error, camera, focus, self._native.diagonal)
        most = None if faces is None else whole("faces", faces, 0, 2**53)
        found, report = self._native.extract(
            asked.error, most, *asked[1:], bool(verify), bool(crop)
        )
        for text in _missed(report, asked, most):
            warn(f"{self.path}: {text}")
        if not report["meets_focus"] and (focus is not None or crop):
            rest = "" if crop else ", so all are as coarse as the file has them"
            warn(f"{self.path}: no face intersects the focus{rest}")
        return Mesh._of(found)

    def cut(self) -> Cut:
        """Reads all levels into memory and returns a :class:`Cut` of them, the coarsest one.

        Of a truncated file these are the coarser levels, and a :class:`MeshlodWarning` says so.
        """
        native, pieces, word = self._native.cut()
        if text := _truncated(pieces, word):
            warn(f"{self.path}: {text}")
        return Cut._of(native, self._native.diagonal())

    def _repr_png_(self) -> bytes | None:
        from . import _view

        # Nobody has asked for a level, so nothing can be missed.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return self.extract(faces=_view.MOST_FACES, verify=False)._repr_png_()

    def _repr_mimebundle_(
        self, include: object = None, exclude: object = None
    ) -> dict[str, object]:
        from . import _view

        picture = self._repr_png_()
        return _view.bundle(_view.of_file(self.path, picture), picture, repr(self))

    def __repr__(self) -> str:
        return f"Model({self.path!r})"


def _truncated(pieces: tuple[int, int], word: str) -> str:
    """Says what a truncated file lacks; empty if it is whole."""
    there, whole_file = pieces
    if there == whole_file:
        return ""
    return (
        f"the file is truncated, and {there} of its {whole_file} {word}s are present: finer "
        "levels are missing, and errors refer to what is there"
    )


def _missed(report: dict[str, Any], asked: Query, faces: int | None) -> list[str]:
    """Says what a mesh lacks of what was asked for."""
    texts = []
    if truncated := _truncated(report["pieces"], report["piece_name"]):
        texts.append(truncated)
    if faces is not None and report["level_faces"] > faces:
        has = f"the coarsest level has {report['level_faces']}"
        texts.append(f"faces={faces} is out of reach: {has}")
    if report["holds"] is False and asked.error > 0:
        unit, part = ("", "it") if asked.camera is None else (" pixels", "parts of it")
        texts.append(
            f"an error of {asked.error:g}{unit} is below the rounding of the file, "
            f"{report['rounding']:.3g}: "
            f"{part} cannot be that close to the mesh; build it with lossless=True"
        )
    return texts
