"""Tiles by a cluster from the command line: ``python -m meshlod.dask tiles IN OUT``."""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from dataclasses import asdict
from typing import Any

from .._errors import MeshlodError
from ._cluster import distributed_package
from ._tiles import tiles


def main(arguments: list[str] | None = None) -> int:
    """Runs the command with these arguments or those of the process; returns its exit code."""
    given = vars(_parser().parse_args(arguments))
    inputs, out = given.pop("inputs"), given.pop("out")
    scheduler, as_json = given.pop("scheduler"), given.pop("json")
    warnings.showwarning = _warn
    try:
        given["client"] = distributed_package().Client(scheduler) if scheduler else None
        report = tiles(inputs, out, progress=True, **given)
    except (MeshlodError, OSError) as error:
        print(f"meshlod: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130
    if as_json:
        print(json.dumps({"file": f"{out}/tileset.json", **asdict(report)}))
    else:
        print(f"{out}/tileset.json: {report}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m meshlod.dask")
    verbs = parser.add_subparsers(required=True, metavar="tiles")
    own = verbs.add_parser("tiles", help="Write a model of any size as 3D Tiles on a cluster")
    own.add_argument("inputs", nargs="+", metavar="IN", help="Meshes, or folders of them")
    own.add_argument("out", metavar="OUT", help="Folder to write")
    own.add_argument("--workers", type=int, metavar="N", help="Processes on this machine")
    own.add_argument("--scheduler", metavar="ADDRESS", help="A cluster that is there already")
    own.add_argument("--json", action="store_true", help="Print the report as JSON")
    # The others are those of `meshlod tiles`.
    own.add_argument("--tile-faces", type=int, default=50_000, metavar="N")
    own.add_argument("--plain", action="store_true")
    own.add_argument("--no-skirts", dest="skirts", action="store_false")
    own.add_argument("--up", default="y", metavar="AXIS")
    for name, unit in ("lat", "DEGREES"), ("lon", "DEGREES"), ("weld", "EPS"):
        own.add_argument(f"--{name}", type=float, metavar=unit)
    own.add_argument("--alt", type=float, default=0.0, metavar="METRES")
    own.add_argument("--ecef", action="store_true")
    return parser


def _warn(message: Any, *_: Any, **__: Any) -> None:
    print(f"meshlod: warning: {message}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
