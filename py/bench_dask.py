"""Times meshlod.dask.map, with a worker killed every 10 s, against `meshlod batch --jobs 2`.

1,000 small files are made by `meshlod sample`; both make the same bytes, or this fails.

    python bench_dask.py [FILES]
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import distributed
import meshlod.dask

SAMPLES = ["sphere", "torus", "knot", "gyroid", "terrain", "fish"]
RECIPE = {"ratio": "10%"}
SECONDS = 10


def make_inputs(folder, count):
    """Writes files of several shapes, formats and sizes."""
    chance = random.Random(1)
    for i in range(count):
        suffix = chance.choice(["ply", "obj", "glb"])
        faces = round(1000 * 40 ** chance.random())
        path = folder / str(i % 10) / f"{i}.{suffix}"
        path.parent.mkdir(parents=True, exist_ok=True)
        meshlod_command("sample", SAMPLES[i % len(SAMPLES)], path, "--faces", faces)


def meshlod_command(*words):
    command = [sys.executable, "-m", "meshlod", *map(str, words)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def on_dask(inputs, out, kills):
    """Runs on two workers, of which one is killed every 10 s; returns how often."""
    killed, over = 0, threading.Event()
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**options, silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill():
            nonlocal killed
            while kills and not over.wait(SECONDS):
                process = list(cluster.workers.values())[killed % 2].pid
                if process is not None:
                    os.kill(process, signal.SIGKILL)
                    killed += 1

        thread = threading.Thread(target=kill)
        thread.start()
        reports = meshlod.dask.map(inputs, out, RECIPE, client=client)
        over.set()
        thread.join()
    assert all(report.status == "done" for report in reports)
    return killed


def contents(folder):
    files = [path for path in folder.rglob("*") if path.is_file() and path.name[0] != "."]
    return {path.relative_to(folder): path.read_bytes() for path in files}


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make_inputs(folder / "in", count)
        times, outs = {}, {}
        for label in "batch", "dask", "dask, killed", "batch again":
            out = outs[label] = folder / label
            start, note = time.perf_counter(), ""
            if label.startswith("batch"):
                meshlod_command("batch", folder / "in", out, "--ratio", "10%", "--jobs", 2)
            else:
                note = f", {on_dask(folder / 'in', out, 'killed' in label)} workers killed"
            times[label] = time.perf_counter() - start
            print(f"{label}: {times[label]:.1f} s{note}", flush=True)
        expected = contents(outs["batch"])
        assert len(expected) >= count
        assert all(contents(out) == expected for out in outs.values())
        batch = (times["batch"] + times["batch again"]) / 2
        print(f"same bytes; dask / batch: {times['dask'] / batch:.2f}, "
              f"with workers killed: {times['dask, killed'] / batch:.2f}")


if __name__ == "__main__":
    main()
