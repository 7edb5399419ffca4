"""Many files on this machine, as ``meshlod batch`` does them."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from . import _asked, _native
from ._errors import MeshlodError, warn
from ._mesh import Path
from ._progress import ProgressLike, callback

#: A ``.toml`` or ``.json`` file, or a dictionary of what it says.
RecipeLike = Path | Mapping[str, Any]


#: Greatest number of files that are done at a time.
MOST_JOBS = 2**16


@dataclass(frozen=True)
class FileReport:
    """How one file of a batch went."""

    input: str
    output: str
    #: ``"done"``, ``"skipped"`` (it was there), ``"missed"`` (its target, with strict), ``"failed"``.
    status: str
    error: str | None
    warnings: list[str]
    seconds: float
    #: Size of the output.
    bytes: int | None
    #: What the verb tells with ``--json``: faces, errors and more.
    result: dict[str, Any] | None = field(repr=False)


def batch(
    paths: Path | Iterable[Path],
    out: Path,
    recipe: RecipeLike,
    *,
    jobs: int | None = None,
    format: str | None = None,
    force: bool = False,
    progress: ProgressLike = None,
) -> list[FileReport]:
    """Does with many files what a recipe says, and returns how each went.

    ``paths`` are files, folders and patterns such as ``"in/**/*.glb"``; below the fixed part of a
    pattern, ``out`` gets the same folders. A recipe names a verb and its options as the command
    line has them: ``{"verb": "simplify", "ratio": "10%"}``; the verb may be left out for
    ``simplify``. ``jobs`` files are done at a time, one for each core by default. ``format`` is
    the suffix of the outputs. Files that were made before by the same recipe are skipped, unless
    ``force`` is true.

    A file that fails does not stop the others: it has an ``error``, and a warning says so.
    """
    arguments = command(paths, out, recipe, format, force)
    if jobs is not None:
        arguments += ["--jobs", str(_asked.whole("jobs", jobs, 1, MOST_JOBS))]
    answer = json.loads(_native.answer(arguments, callback(progress, "files")))
    return reported(answer["reports"])


def command(
    paths: Path | Iterable[Path], out: Path, recipe: RecipeLike, format: str | None, force: bool
) -> list[str]:
    """Returns the arguments of the command that does a batch."""
    if isinstance(paths, (str, bytes, os.PathLike)):
        paths = [paths]
    names = [_asked.path_name(path) for path in paths]
    if not names:
        raise MeshlodError("a batch takes at least one path")
    arguments = ["meshlod", "batch", "--json", f"--recipe={recipe_text(recipe)}"]
    if format is not None:
        arguments.append(f"--format={format}")
    if force:
        arguments.append("--force")
    # Options may follow.
    return [*arguments, *map(_unlike_option, names), _unlike_option(_asked.path_name(out))]


def recipe_text(recipe: RecipeLike) -> str:
    """Returns a recipe as the command takes it: a path, or JSON."""
    if not isinstance(recipe, Mapping):
        return _asked.path_name(recipe)
    try:
        return json.dumps({"verb": "simplify", **recipe})
    except TypeError as error:
        raise MeshlodError(f"recipe: {error}") from None


def reported(rows: list[dict[str, Any]]) -> list[FileReport]:
    """Makes reports of the rows of the command, and warns of what they say."""
    names = FileReport.__dataclass_fields__
    reports = [FileReport(**{name: row[name] for name in names}) for row in rows]
    for report in reports:
        if report.status == "skipped":
            continue
        for line in [*report.warnings, *([report.error] if report.error else [])]:
            named = report.input in line or report.output in line
            warn(line if named else f"{report.input}: {line}")
    return reports


def _unlike_option(name: str) -> str:
    return f"./{name}" if name.startswith("-") else name


__all__ = ["FileReport", "batch"]
