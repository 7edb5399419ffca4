"""Measures what Python adds to a simplification to 10 %: time, and peak memory.

    RAYON_NUM_THREADS=1 python bench_overhead.py --rounds 9 MESH

Times are CPU seconds of the process, so that other load counts little: of the engine on a mesh that
is there, in turns with meshlod.simplify on arrays, and of the command, which runs in this process,
too, and reads and writes files. Memory is the peak of processes: one that loads arrays, one that
simplifies them after that, and the whole command.
"""

import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import meshlod
import numpy as np
from meshlod import _asked, _native

OPTIONS = ["--ratio", "10%"]

SAVE = """import meshlod, numpy, sys
mesh = meshlod.load(sys.argv[1])
numpy.savez(sys.argv[2], points=mesh.vertices, faces=mesh.faces)"""

LOAD = """import meshlod, numpy, sys
arrays = numpy.load(sys.argv[1])
points, faces = arrays["points"], arrays["faces"]"""


def cpu_seconds(work, *arguments):
    start = time.process_time()
    work(*arguments)
    return time.process_time() - start


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
        plain = {"method": "lindstrom-turk", "topology": "free", "lock_boundary": False}
        asked = _asked.asked("ratio", 0.1, **plain)
        verb = ["meshlod", "simplify", options.mesh, out, *OPTIONS, "--threads", "1", "--json"]
        runs = {
            "engine": (_native.simplify, mesh._native, asked),
            "call": (meshlod.simplify, points, faces, 0.9),
            "command": (_native.answer, verb),
        }
        rounds = [
            {name: cpu_seconds(*run) for name, run in runs.items()} for _ in range(options.rounds)
        ]
    for name in runs:
        median = statistics.median(times[name] for times in rounds)
        ratio = statistics.median(times[name] / times["engine"] for times in rounds)
        print(f"{name} {1e3 * median:.0f} ms, {ratio:.3f} of the engine")
    print(f"arrays loaded {loaded:.0f} MB, simplified {simplified:.0f}, command {command:.0f}")


if __name__ == "__main__":
    main()
