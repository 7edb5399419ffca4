"""Work on other threads: progress, Ctrl-C, fork, and arrays that go away meanwhile."""

import gc
import os
import signal
import subprocess
import sys
import threading

import meshlod
import numpy as np
import pytest
from shapes import torus, write_gltf


def check_rise(seen):
    """Progress was told several times, rises all the way, and is 1 once."""
    assert seen[-1] == 1.0 and seen == sorted(seen) and 1.0 not in seen[:-1]
    assert len(set(seen)) > 3 and 0 <= seen[0] < 0.5 < seen[-2]


def test_progress_rises_to_one():
    seen = []
    # Slow enough to be looked at several times.
    meshlod.simplify(*torus(300, 100), 0.95, method="pm", progress=seen.append)
    check_rise(seen)


def test_progress_of_a_scene_counts_every_mesh_once(tmp_path):
    path = write_gltf(tmp_path, torus(300, 100), places=4)
    scene = meshlod.Scene.load(path)
    assert scene.face_count == 4 * 60_000
    seen = []
    level = scene.simplify(0.95, method="pm", progress=seen.append)
    assert level.face_count <= 12_000
    check_rise(seen)


def test_with_an_error_the_end_is_all_that_is_told():
    seen = []
    meshlod.simplify(*torus(60, 30), max_error=0.02, progress=seen.append)
    assert seen == [1.0]


def test_an_exception_of_the_callback_ends_the_work():
    class Enough(Exception):
        pass

    def stop(done):
        raise Enough(f"at {done}")

    with pytest.raises(Enough):
        # Slow enough to be looked at.
        meshlod.simplify(*torus(300, 100), 0.99, method="pm", progress=stop)
    assert len(meshlod.simplify(*torus(12, 8), 0.5)[1]) > 0, "and the next one works"


def test_ctrl_c_ends_the_work():
    points, faces = torus(1000, 300)

    def handler(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, handler)
    timer = threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT])
    try:
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            meshlod.simplify(points, faces, 0.999, method="pm")
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)


def test_arrays_may_change_and_go_while_they_are_used():
    points, faces = torus(100, 40)
    expected = meshlod.simplify(points, faces, 0.9, method="pm")
    seen = []

    def spoil(done):
        nonlocal points, faces
        seen.append(done)
        if points is not None:
            points[:] = np.nan
            faces[:] = -1
        points = faces = None
        gc.collect()

    found = meshlod.simplify(points, faces, 0.9, method="pm", progress=spoil)
    assert seen[0] < 1, "they went while the work ran"
    assert all(np.array_equal(a, b) for a, b in zip(expected, found, strict=True))


def test_views_outlive_their_mesh():
    mesh = meshlod.Mesh(*torus())
    expected = mesh.vertices.copy()
    view, faces = mesh.vertices, mesh.faces
    del mesh
    gc.collect()
    meshlod.Mesh(*torus(50, 40))
    assert np.array_equal(view, expected) and faces.max() == len(view) - 1
    for array in view, faces:
        with pytest.raises(ValueError, match="read-only"):
            array[0, 0] = 1
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            array.setflags(write=True)


def test_many_threads_get_what_one_gets():
    points, faces = torus(100, 40)
    expected = meshlod.simplify(points, faces, 0.9)
    found = [None] * 8

    def work(i):
        found[i] = meshlod.simplify(points, faces, 0.9)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(len(found))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in found:
        assert all(np.array_equal(a, b) for a, b in zip(expected, result, strict=True))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
def test_a_child_made_by_fork_works():
    code = (
        "import os, sys; sys.path.insert(0, 'tests'); import meshlod, shapes;"
        "a = meshlod.simplify(*shapes.torus(200, 60), 0.9);"
        "child = os.fork();"
        "b = meshlod.simplify(*shapes.torus(200, 60), 0.9);"
        "same = all((x == y).all() for x, y in zip(a, b));"
        "child or os._exit(0 if same else 1);"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) or not same)"
    )
    root = os.path.dirname(os.path.dirname(__file__))
    # A child without threads would wait for ever.
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr
