"""Tiles of a large model on the workers of a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from .. import _asked, _native
from .._errors import MeshlodError, warn
from .._mesh import Path
from .._options import TilesOptions
from .._progress import ProgressLike, callback
from .._reports import TilesReport
from .._tiles import input_names, tiles_asked
from ._cluster import client_or_local, distributed_package
from ._units import Units

if TYPE_CHECKING:
    from distributed import Client, Future
    from typing_extensions import Unpack

    from .._native import NativeTilePlan, TilesAsked

#: Greatest number of workers.
MOST_WORKERS = 2**16

#: Number of times that a task is handed out again after all workers that had it died.
TRIES = 3


def tiles(
    inputs: Path | Iterable[Path],
    out: Path,
    *,
    client: Client | None = None,
    workers: int | None = None,
    progress: ProgressLike = None,
    **options: Unpack[TilesOptions],
) -> TilesReport:
    """Writes a model of any size as 3D Tiles, on the workers of ``client``.

    Options and results are those of :func:`meshlod.tiles`, without ``memory`` and ``threads``, and
    so are the bytes, whatever the number of workers. Without a client, a ``LocalCluster`` of
    ``workers`` processes, by default one for each core, is started and closed again; as with all of
    ``multiprocessing``, the calling script must then be importable (``if __name__ ==
    "__main__"``). Workers of other machines must see the files under the same paths, and so must
    the caller.

    One task plans, on all cores of its machine; then each tile needs those that it is made of, and
    takes one thread. What is done is not done again: not after a worker has died, and not by
    another call after this one was ended.
    """
    distributed = distributed_package()
    if unknown := sorted(options.keys() - TilesOptions.__annotations__.keys()):
        raise TypeError(f"meshlod.dask.tiles has no option {', '.join(unknown)}")
    show = callback(progress, "tiles") or (lambda done: None)
    asked = tiles_asked(**options)
    # Workers may have been started in another folder.
    names = [os.path.abspath(name) for name in input_names(inputs)]
    out = os.path.abspath(_asked.path_name(out))
    if workers is not None:
        workers = _asked.whole("workers", workers, 1, MOST_WORKERS)
        if client is not None:
            raise MeshlodError("a client has its workers: give client or workers, not both")
    folder = _native.tile_plan_folder(out)
    with client_or_local(client, workers) as own:
        return _Run(own, distributed, folder, out).tiles(names, asked, show)


class _Run:
    """Tiles in the making. Tasks are functions of file names."""

    def __init__(self, client: Client, distributed: Any, folder: str, out: str) -> None:
        self.client, self.distributed = client, distributed
        self.folder, self.out = folder, out

    def tiles(
        self, names: list[str], asked: TilesAsked, show: Callable[[float], object]
    ) -> TilesReport:
        # Held between the tasks, too, so that no other run plans there meanwhile.
        run = _native.NativeTileRun(self.folder)
        is_made = False
        try:
            planned = self._result(_plan, names, self.folder, asked, run.key())
            notes, parts, done, faces = planned
            for note in notes:
                warn(note)
            self._make(Units(parts, done, faces), show)
            fields, notes = self._result(_assemble, self.folder, self.out, run.key())
            is_made = True
        finally:
            run.end(is_made)
            with suppress(OSError):
                os.rmdir(self.out)
        for note in notes:
            warn(note)
        show(1.0)
        return TilesReport._of(fields)

    def _make(self, units: Units, show: Callable[[float], object]) -> None:
        """Has workers make all tiles that are not there.

        The caller hands out what is ready, and not a graph of all: results of a worker that dies
        would be asked for again, down to the leaves, although their files are there.
        """
        running: dict[Future, int] = {}
        tries: dict[int, int] = {}

        def hand_out(unit: int) -> Future:
            arguments = self.folder, units.tasks[unit]
            priority = -units.place[unit]
            future = self.client.submit(_do, *arguments, pure=False, priority=priority)
            running[future] = unit
            return future

        whole = max(len(units.tasks), 1)
        ready = [hand_out(unit) for unit in units.ready()]
        results = self.distributed.as_completed(ready, with_results=True, raise_errors=False)
        del ready
        try:
            for future, result in results:
                unit = running.pop(future)
                if self._is_done(result, tries.get(unit, 0)):
                    next_ones = units.finish(unit)
                    show(min(0.999, 1 - len(units.left) / whole))
                else:
                    next_ones = [unit]
                    tries[unit] = tries.get(unit, 0) + 1
                for next_one in next_ones:
                    results.add(hand_out(next_one))
        finally:
            self.client.cancel(list(running))

    def _is_done(self, result: Any, tries: int) -> bool:
        """Returns false for a task to be handed out again, since its workers have died.

        The status of its future may tell of a worker that has died since.
        """
        if result is None:
            return True
        if not isinstance(result, tuple):
            raise MeshlodError(f"a task was not done: {result!r}")
        _, error, trace = result
        if isinstance(error, self.distributed.scheduler.KilledWorker):
            if tries < TRIES:
                return False
            raise _killed() from error
        raise error.with_traceback(trace)

    def _result(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Returns what one task returns."""
        for left in reversed(range(TRIES + 1)):
            future = self.client.submit(function, *arguments, pure=False)
            try:
                return future.result()
            except self.distributed.scheduler.KilledWorker as error:
                if left == 0:
                    raise _killed() from error
            finally:
                if not future.done():
                    future.cancel()


def _killed() -> MeshlodError:
    return MeshlodError("workers died at the same task; it may need more memory than they have")


def _plan(
    names: list[str], folder: str, asked: TilesAsked, key: str
) -> tuple[list[str], Any, Any, int]:
    """Plans, on a worker; returns notes, and what tasks there are."""
    notes = _native.plan_tiles(names, folder, asked, key)
    plan = _opened(folder)
    return notes, plan.parts(), plan.done(), plan.tile_faces()


def _do(folder: str, tasks: list[int]) -> None:
    """Makes tiles, on a worker."""
    _opened(folder).run(tasks)


def _assemble(folder: str, out: str, key: str) -> tuple[dict[str, Any], list[str]]:
    """Makes the tileset, on a worker; returns its report, and notes."""
    return _native.assemble_tiles(folder, out, key)


#: The plan that this worker opened last, by its folder.
_kept: dict[str, NativeTilePlan] = {}


def _opened(folder: str) -> NativeTilePlan:
    """Returns a plan, which is read anew only if it has changed."""
    plan = _kept.get(folder)
    if plan is None or not plan.is_current():
        _kept.clear()
        plan = _kept[folder] = _native.NativeTilePlan(folder)
    return plan
