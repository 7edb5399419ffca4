"""Flocks: many members of one model, each only as fine as the picture needs it.

>>> import numpy as np
>>> from meshlod import Mesh, flock
>>> turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
>>> ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
>>> points = np.vstack([[[0, 0, 2]], ring, [[0, 0, -1]]])
>>> sides = [[0, 1 + i, 1 + (i + 1) % 40] for i in range(40)]
>>> mesh = Mesh(points, sides + [[41, b, a] for _, a, b in sides])
>>> table = flock.LevelTable(mesh)
>>> film = flock.Film("ring", members=100)
>>> members, camera = film.next_frame()
>>> selector = flock.Selector(table, "ours")
>>> levels = selector.select(members, camera, triangles=3000)
>>> len(levels), selector.triangles <= 3000
(100, True)
"""

from ._camera import FlockCamera
from ._film import Film
from ._level_table import LevelTable
from ._members import Flock, School
from ._selector import HIDDEN, IMPOSTOR, Selector

__all__ = [
    "HIDDEN",
    "IMPOSTOR",
    "Film",
    "Flock",
    "FlockCamera",
    "LevelTable",
    "School",
    "Selector",
]
