"""Many files on the workers of a Dask cluster."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from .. import _batch, _native
from .._batch import FileReport, RecipeLike
from .._errors import MeshlodError
from .._mesh import Path
from .._progress import ProgressLike, callback
from ._cluster import client_or_local, distributed_package

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["map"]


def map(
    paths: Path | Iterable[Path],
    out: Path,
    recipe: RecipeLike,
    *,
    client: Client | None = None,
    format: str | None = None,
    force: bool = False,
    progress: ProgressLike = None,
) -> list[FileReport]:
    """Does with many files what a recipe says, on the workers of ``client``.

    Arguments and results are those of :func:`meshlod.batch`. Without a client, a ``LocalCluster``
    with one worker for each core is started and closed again; as with all of ``multiprocessing``,
    the calling script must then be importable (``if __name__ == "__main__"``). Workers of other
    machines must see the files under the same paths.

    Each file gets one thread, unless its recipe has ``threads``. A file whose worker dies again
    and again, as for lack of memory, is reported as failed.
    """
    distributed = distributed_package()
    arguments = [*_batch.command(paths, out, recipe, format, force), "--dry-run"]
    plan = json.loads(_native.answer(arguments))
    show = callback(progress, "files") or (lambda done: None)
    if all(row["status"] != "planned" for row in plan["reports"]):
        show(1.0)
    else:
        with client_or_local(client) as own:
            _run(plan, own, distributed, show)
    return _batch.reported(plan["reports"])


def _run(
    plan: dict[str, Any], client: Client, distributed: Any, show: Callable[[float], object]
) -> None:
    """Has workers do the files of a plan that are to do, and replaces their rows."""
    rows, folder = plan["reports"], plan["file"]
    todo = [at for at, row in enumerate(rows) if row["status"] == "planned"]
    os.makedirs(folder, exist_ok=True)
    _tidy(rows, todo)
    tasks = [_task(plan["arguments"], rows[at]) for at in todo]
    futures = client.map(_one, tasks, pure=False)
    place = dict(zip(futures, todo, strict=True))
    done = len(rows) - len(todo)
    try:
        # Results come along: to ask for each would take longer than to make a small file.
        for future, result in distributed.as_completed(
            futures, with_results=True, raise_errors=False
        ):
            row = rows[place[future]]
            told = _row(future.status, result, distributed)
            row |= told | {key: row[key] for key in ("input", "output")}
            _native.record_file_of_batch(folder, plan["recipe"], json.dumps(row))
            done += 1
            show(done / len(rows))
            future.release()
    finally:
        client.cancel([future for future in futures if not future.done()])
        _tidy(rows, todo)


def _task(arguments: list[str], row: dict[str, Any]) -> tuple[list[str], str, str]:
    # Workers may have been started in another folder.
    return arguments, os.path.abspath(row["input"]), os.path.abspath(row["output"])


def _one(task: tuple[list[str], str, str]) -> str:
    """Does one file, on a worker."""
    arguments, source, target = task
    return _native.run_file_of_batch(arguments, source, target)


def _row(status: str, result: Any, distributed: Any) -> dict[str, Any]:
    """Returns the report of a task, or that of a file whose workers died."""
    # A worker that died since may have changed the status.
    if isinstance(result, str):
        row: dict[str, Any] = json.loads(result)
        return row
    if status != "error":
        raise MeshlodError(f"a task was {status}: {result}")
    _, error, trace = result
    if isinstance(error, distributed.scheduler.KilledWorker):
        reason = "its workers died; it may need more memory than they have"
        return {"status": "failed", "error": reason}
    raise error.with_traceback(trace)


def _tidy(rows: list[dict[str, Any]], todo: list[int]) -> None:
    """Removes what workers that were killed have left beside their outputs."""
    _native.remove_abandoned([rows[at]["output"] for at in todo])
