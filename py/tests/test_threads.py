"""Objects that change, used by several threads, and work that was interrupted."""

import os
import random
import signal
import threading
import time

import meshlod
import numpy as np
import pytest
from meshlod import flock
from shapes import torus


def run_together(*works):
    """Runs functions in threads of their own, and tells those that do not end."""
    threads = [threading.Thread(target=work, daemon=True) for work in works]
    for thread in threads:
        thread.start()
    until = time.monotonic() + 100
    for thread in threads:
        thread.join(until - time.monotonic())
    assert not any(thread.is_alive() for thread in threads), "they wait for each other"


def test_threads_share_a_selector():
    table = flock.LevelTable(meshlod.Mesh(*torus(20, 10)), directions=3)
    rng = np.random.default_rng(0)
    count = 50_000
    members = flock.Flock(rng.uniform(-100, 100, (count, 3)), rng.normal(size=(count, 3)))
    camera = meshlod.Camera(eye=(0, 0, 200), look=(0, 0, 0), size=(1920, 1080))
    selector, chosen = flock.Selector(table), []

    def work(seed):
        pauses = random.Random(seed)
        for _ in range(150):
            chosen.append(selector.select(members, camera, triangles=count * 12))
            # So that one asks while the other is anywhere in its work.
            time.sleep(0.02 * pauses.random())

    run_together(lambda: work(1), lambda: work(2))
    assert len(chosen) == 300 and all(levels.shape == (count,) for levels in chosen)


def test_threads_share_a_film():
    film, frames = flock.Film(members=20_000), []

    def work():
        for _ in range(12):
            frames.append(film.next_frame()[0].positions)

    run_together(work, work, work)
    assert len(frames) == 36
    assert len({float(positions[0, 0]) for positions in frames}) == 36, "each frame is told once"


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers here")
def test_an_interrupted_build_writes_nothing_later(tmp_path):
    large, small = meshlod.Mesh(*torus(300, 100)), meshlod.Mesh(*torus(20, 10))
    path = tmp_path / "a.mlod"

    def handler(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, handler)
    try:
        threading.Timer(0.1, os.kill, [os.getpid(), signal.SIGINT]).start()
        with pytest.raises(KeyboardInterrupt):
            large.build(path, errors="bound")
    finally:
        signal.signal(signal.SIGINT, before)
    assert not path.exists()
    small.build(path)
    held = path.read_bytes()
    # This one takes as long as what may still run.
    large.build(tmp_path / "b.mlod", errors="bound")
    until = time.monotonic() + 60
    while len(list(tmp_path.iterdir())) > 2 and time.monotonic() < until:
        time.sleep(0.05)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.mlod", "b.mlod"]
    assert path.read_bytes() == held


def test_new_files_keep_links_and_permissions(tmp_path):
    mesh = meshlod.Mesh(*torus(20, 10))
    target, link = tmp_path / "target.mlod", tmp_path / "link.mlod"
    target.write_bytes(b"old")
    target.chmod(0o600)
    link.symlink_to(target)
    mesh.build(link)
    assert link.is_symlink() and target.read_bytes() != b"old"
    assert target.stat().st_mode & 0o777 == 0o600
    mesh.build(tmp_path / "folder" / "made" / "a.mlod")
    assert [file.name for file in (tmp_path / "folder" / "made").iterdir()] == ["a.mlod"]
    with pytest.raises(meshlod.MeshlodError, match=r"a\.mlx: a compressed file must end in"):
        mesh.compress(tmp_path / "a.mlx")
    assert len(list(tmp_path.iterdir())) == 3
