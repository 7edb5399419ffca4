"""Many files, and tiles of a large model, on the workers of a Dask cluster.

A task is names of files and options, and writes its files whole or not at all, so a worker may be
killed at any time: its files are made again elsewhere, with the same bytes as by the command.
Needs ``dask[distributed]``: ``pip install meshlod[dask]``.
"""

from ._map import map
from ._tiles import tiles

__all__ = ["map", "tiles"]
