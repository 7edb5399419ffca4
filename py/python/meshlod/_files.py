"""Files by their paths."""

from __future__ import annotations

from . import _asked, _native
from ._errors import MeshlodError, warn
from ._mesh import Mesh, Path
from ._scene import Scene


def load(path: Path) -> Mesh:
    """Reads a file as one mesh, in world space.

    PLY, OBJ, STL, OFF, SMF, glTF and GLB, and the compressed ``.mlz`` and ``.mlq``. A warning says
    what the mesh lacks of a scene; :meth:`Scene.load` keeps it. Comments are not counted. Of a
    ``.mlod`` file, :class:`Model` extracts meshes.
    """
    name = _asked.path_name(path)
    if name.lower().endswith(".mlod"):
        raise MeshlodError(f"{name}: holds all levels: open it with meshlod.Model")
    native, notes = _native.load(name)
    for note in notes:
        warn(f"{name}: {note}")
    beyond = native.beyond_mesh()
    if beyond:
        warn(f"{name}: {'; '.join(beyond)}; meshlod.Scene.load keeps the whole scene")
    return Mesh._of(native.flatten())


def save(path: Path, mesh: Mesh | Scene) -> None:
    """Writes a mesh or a scene in the format of the suffix, whole or not at all."""
    if not isinstance(mesh, (Mesh, Scene)):
        kind = type(mesh).__name__
        raise MeshlodError(f"save takes a path and a Mesh or a Scene, not {kind}")
    mesh.save(path)


__all__ = ["load", "save"]
