"""Clusters: that of the caller, or one on this machine."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .._errors import MeshlodError

if TYPE_CHECKING:
    from distributed import Client


def distributed_package() -> Any:
    """Returns the package ``distributed``."""
    try:
        import distributed
    except ImportError:
        message = "meshlod.dask needs dask[distributed]: pip install 'dask[distributed]'"
        raise MeshlodError(message) from None
    return distributed


@contextmanager
def client_or_local(client: Client | None, workers: int | None = None) -> Iterator[Client]:
    """Gives the client, or one of a ``LocalCluster`` that ends with the block.

    It has ``workers`` processes of one thread each, by default one for each core.
    """
    if client is not None:
        yield client
        return
    distributed = distributed_package()
    local = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": "ERROR"}
    local["n_workers"] = workers or os.cpu_count() or 1
    with distributed.LocalCluster(**local) as cluster, distributed.Client(cluster) as own:
        yield own
