"""Times meshlod.dask.tiles on 1, 2 and 5 workers, and with workers killed, against `meshlod tiles`.

A terrain is made by `meshlod sample`. All runs must make the same bytes, or this fails. Of the run
with killed workers the first one killed is the planner, a second after the start, and then a worker
by chance every 10 s.

    python bench_dask_tiles.py [FACES] [SECONDS BETWEEN KILLS] [RUN ...]
"""

import hashlib
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


def meshlod_command(*words):
    command = [sys.executable, "-m", "meshlod", *map(str, words)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Killer:
    """Kills workers of a cluster until it is told to stop."""

    def __init__(self, cluster, client, seconds):
        self.cluster, self.client, self.seconds = cluster, client, seconds
        self.killed, self.over = 0, threading.Event()
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def run(self):
        chance, wait = random.Random(1), 1
        while not self.over.wait(wait):
            tasks = self.client.processing()
            plans = {at for at, own in tasks.items() if any("_plan" in str(key) for key in own)}
            # The planner is the first one, and is left alone from then on.
            alive = [
                one
                for one in self.cluster.workers.values()
                if one.pid is not None and (one.worker_address in plans) != bool(self.killed)
            ]
            if alive:
                os.kill(chance.choice(alive).pid, signal.SIGKILL)
                self.killed += 1
                wait = self.seconds

    def stop(self):
        self.over.set()
        self.thread.join()


def on_dask(source, out, workers, seconds):
    """Runs on a number of workers, some of them killed; returns how many, and the time without
    the start and the end of the cluster."""
    options = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**options, silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
    ):
        killer = Killer(cluster, client, seconds) if seconds else None
        start = time.perf_counter()
        try:
            meshlod.dask.tiles(source, out, client=client)
        finally:
            taken = time.perf_counter() - start
            if killer:
                killer.stop()
    return killer.killed if killer else 0, taken


def contents(folder):
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {path.relative_to(folder): hashlib.sha256(path.read_bytes()).digest() for path in files}


def main():
    faces = sys.argv[1] if len(sys.argv) > 1 else "3000000"
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 10.0
    runs = sys.argv[3:] or ["command", "2", "2 killed", "2", "2 killed", "1", "5"]
    with tempfile.TemporaryDirectory(dir=os.environ.get("BENCH_FOLDER")) as name:
        source, out = Path(name) / "in.ply", Path(name) / "out"
        meshlod_command("sample", "terrain", source, "--faces", faces, "--colors")
        expected = None
        for run in runs:
            start, killed = time.perf_counter(), 0
            if run == "command":
                meshlod_command("tiles", source, out, "--threads", 2)
                taken = time.perf_counter() - start
            else:
                workers = int(run.split()[0])
                killed, taken = on_dask(source, out, workers, seconds if "killed" in run else 0)
            found = contents(out)
            expected = expected or found
            assert found == expected, f"{run}: other bytes"
            for path in sorted(out.rglob("*"), reverse=True):
                path.rmdir() if path.is_dir() else path.unlink()
            print(f"{run}: {taken:.1f} s, {killed} killed, {len(found)} files", flush=True)
        print("the same bytes in all runs")


if __name__ == "__main__":
    main()
