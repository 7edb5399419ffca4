"""Level of detail for triangle meshes: read, simplify, measure, draw and write them.

>>> import meshlod, numpy as np
>>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
>>> mesh = meshlod.Mesh(points, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
>>> mesh
Mesh(4 vertices, 4 faces)
>>> round(mesh.volume, 6)
0.166667
"""

from . import convert, flock
from ._batch import FileReport, batch
from ._cut import Cut, CutChange
from ._errors import MeshlodError, MeshlodWarning
from ._files import load, save
from ._mesh import Mesh
from ._model import Model
from ._query import Camera
from ._reports import (
    CheckReport,
    Distance,
    OneSidedDistance,
    Report,
    TileLevel,
    TilesReport,
)
from ._scene import Scene
from ._simplify import simplify
from ._tiles import tiles

__all__ = [
    "Camera",
    "CheckReport",
    "Cut",
    "CutChange",
    "Distance",
    "FileReport",
    "Mesh",
    "MeshlodError",
    "MeshlodWarning",
    "Model",
    "OneSidedDistance",
    "Report",
    "Scene",
    "TileLevel",
    "TilesReport",
    "batch",
    "load",
    "save",
    "convert",
    "flock",
    "simplify",
    "tiles",
]
__version__ = "0.1.0"
