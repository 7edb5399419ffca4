"""Measures what Python adds to a simplification to 10 %: time, and peak memory.

    RAYON_NUM_THREADS=1 python bench_overhead.py --rounds 9 MESH

The command runs in this process, by the same native part and with one thread, in turns with
meshlod.simplify on arrays. Its time is what it reports as simplify_seconds, without reading and
writing; Python's is the whole call. Memory is the peak of processes: one that loads arrays, one
that simplifies them after that, and the whole command.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import meshlod
import numpy as np
from meshlod import _native

OPTIONS = ["--ratio", "10%", "--force"]

SAVE = """import meshlod, numpy, sys
mesh = meshlod.load(sys.argv[1])
numpy.savez(sys.argv[2], points=mesh.vertices, faces=mesh.faces)"""

LOAD = """import meshlod, numpy, sys
arrays = numpy.load(sys.argv[1])
points, faces = arrays["points"], arrays["faces"]"""


def engine_seconds(mesh, out):
    command = ["meshlod", "simplify", mesh, out, *OPTIONS, "--threads", "1", "--json"]
    return json.loads(_native.answer(command))["simplify_seconds"]


def call_seconds(points, faces):
    start = time.perf_counter()
    meshlod.simplify(points, faces, 0.9)
    return time.perf_counter() - start


def peak_mb(*arguments):
    """Returns the peak memory of a process of Python; this one must be smaller."""
    process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.DEVNULL)
    return os.wait4(process.pid, 0)[2].ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", metavar="MESH")
    parser.add_argument("--rounds", type=int, default=9)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out, arrays = (str(pathlib.Path(folder) / name) for name in ("out.ply", "arrays.npz"))
        peak_mb("-c", SAVE, options.mesh, arrays)
        loaded = peak_mb("-c", LOAD, arrays)
        simplified = peak_mb("-c", f"{LOAD}\nmeshlod.simplify(points, faces, 0.9)", arrays)
        command = peak_mb("-m", "meshlod", "simplify", options.mesh, out, *OPTIONS)
        mesh = meshlod.load(options.mesh)
        points, faces = np.array(mesh.vertices), np.array(mesh.faces)
        pairs = [
            (engine_seconds(options.mesh, out), call_seconds(points, faces))
            for _ in range(options.rounds)
        ]
    engine, call = (statistics.median(times) for times in zip(*pairs, strict=True))
    ratio = statistics.median(call / engine for engine, call in pairs)
    print(f"engine {1e3 * engine:.0f} ms, call {1e3 * call:.0f} ms, ratio of pairs {ratio:.3f}")
    print(f"arrays loaded {loaded:.0f} MB, simplified {simplified:.0f}, command {command:.0f}")


if __name__ == "__main__":
    main()
