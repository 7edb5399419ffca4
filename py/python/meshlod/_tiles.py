"""Models of any size as 3D Tiles."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from . import _asked, _native
from ._errors import MeshlodError, warn
from ._mesh import Path
from ._progress import ProgressLike, callback
from ._reports import TilesReport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._native import TilesAsked
    from ._options import TilesOptions

#: Greatest number of threads.
MOST_THREADS = 2**16


def tiles(
    inputs: Path | Iterable[Path],
    out: Path,
    *,
    tile_faces: int = 50_000,
    plain: bool = False,
    skirts: bool = True,
    up: str = "y",
    lat: float | None = None,
    lon: float | None = None,
    alt: float = 0.0,
    ecef: bool = False,
    weld: float | None = None,
    memory: int | None = None,
    threads: int | None = None,
    progress: ProgressLike = None,
) -> TilesReport:
    """Writes a model of any size as 3D Tiles: a tree of tiles, each within a proved error.

    ``inputs`` are files, and folders of them, that are read as one model; ``out`` is a folder, in
    which ``tileset.json`` names the tiles, or an archive of these files if it ends in ``.3tz``.
    Binary PLY, binary STL, OBJ and glTF files from 64 MB on are read in passing, with little memory;
    OBJ and compressed glTF take their room on the disk of ``out`` meanwhile. The bytes are those of ``meshlod tiles``
    with the same options, and a call that was ended goes on where it stopped.

    A part of the model with more than ``tile_faces`` faces is divided. Contents are compressed by
    meshopt unless ``plain``, and ``skirts`` hide gaps between tiles of different levels. ``up`` is
    the axis of the model that points up, ``"y"`` or ``"z"``; ``lat`` and ``lon``, in degrees, and
    ``alt``, in metres above the ellipsoid, are the place of its origin on the globe; with
    ``ecef``, its coordinates are about the middle of the earth (EPSG:4978). ``weld`` joins
    vertices within a distance in model units when files are read, which is then done as a whole.

    ``threads`` work at a time, by default one for each core; with ``memory``, in bytes, as many as
    that is enough for. ``progress`` is told the part of the tiles that are made, once they are
    planned. Ctrl-C ends at the next tile.

    :raises MeshlodError: inputs or options that are not what they should be, a folder that holds
        other files, or that another process is making tiles in.
    """
    options: TilesOptions = {"tile_faces": tile_faces, "plain": plain, "skirts": skirts, "up": up}
    options |= {"lat": lat, "lon": lon, "alt": alt, "ecef": ecef, "weld": weld}
    bar = callback(progress, "tiles")
    asked = tiles_asked(memory=memory, threads=threads, progress=bar, **options)
    names = input_names(inputs)
    fields, notes = _native.tiles(names, _asked.path_name(out), asked)
    for note in notes:
        warn(note)
    return TilesReport._of(fields)


def tiles_asked(
    memory: int | None = None,
    threads: int | None = None,
    progress: Any = None,
    **options: Unpack[TilesOptions],
) -> TilesAsked:
    """Returns the argument of the native functions."""
    weld = options.get("weld")
    if weld is not None:
        weld = _asked.number("weld", weld)
        if not 0 <= weld < float("inf"):
            raise MeshlodError(f"weld must be at least 0, not {weld}")
    if threads is not None:
        threads = _asked.whole("threads", threads, 1, MOST_THREADS)
    request = {
        "tile_faces": _asked.whole("tile_faces", options.get("tile_faces", 50_000), 100, 2**53),
        "plain": bool(options.get("plain", False)),
        "skirts": bool(options.get("skirts", True)),
        "up": up_axis(options.get("up", "y")),
        "globe": globe(options.get("lat"), options.get("lon"), options.get("alt", 0.0)),
        "ecef": bool(options.get("ecef", False)),
        "memory": None if memory is None else _asked.whole("memory", memory, 1, 2**63 - 1),
    }
    text = json.dumps(request, allow_nan=False)
    return {"request": text, "weld": weld, "threads": threads, "progress": progress}


def up_axis(up: Any) -> str:
    """Returns the axis that points up."""
    if up not in ("y", "z"):
        raise MeshlodError(f"up must be y or z, not {up}")
    return str(up)


def globe(lat: Any, lon: Any, alt: Any) -> dict[str, float] | None:
    """Returns the place of the origin on the globe, if there is one."""
    if lat is None and lon is None:
        if _asked.number("alt", alt) != 0:
            raise MeshlodError("alt is a height above the ellipsoid: give lat and lon with it")
        return None
    if lat is None or lon is None:
        raise MeshlodError("give lat and lon, or neither")
    place = {}
    for name, value, most in ("lat", lat, 90), ("lon", lon, 360), ("alt", alt, 1e12):
        place[name] = _asked.number(name, value)
        if not abs(place[name]) <= most:
            raise MeshlodError(f"{name} must be between -{most:g} and {most:g}, not {value}")
    return {"latitude": place["lat"], "longitude": place["lon"], "altitude": place["alt"]}


def input_names(inputs: Path | Iterable[Path]) -> list[str]:
    """Returns the names of files and folders."""
    if isinstance(inputs, (str, bytes, os.PathLike)):
        inputs = [inputs]
    names = [_asked.path_name(path) for path in inputs]
    if not names:
        raise MeshlodError("tiles take at least one input")
    return names


__all__ = ["tiles"]
