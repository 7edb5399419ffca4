"""Tiles: whole runs, options, runs that are ended, and workers of a cluster that are killed."""

import fcntl
import json
import os
import signal
import subprocess
import sys

import meshlod
import pytest
from meshlod import _native
from shapes import torus

FACES = 30_000


def command(*words, module="meshlod"):
    line = [sys.executable, "-m", module, *map(str, words)]
    return subprocess.run(line, check=True, timeout=120, capture_output=True, text=True).stdout


def contents(folder):
    files = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


@pytest.fixture(scope="module")
def sample(tmp_path_factory):
    """A mesh, and its tiles by the command."""
    folder = tmp_path_factory.mktemp("sample")
    command("sample", "gyroid", folder / "in.ply", "--faces", FACES)
    command("tiles", folder / "in.ply", folder / "out", "--tile-faces", 2000)
    return folder / "in.ply", contents(folder / "out")


def test_tiles_are_those_of_the_command(sample, tmp_path):
    path, expected = sample
    seen = []
    report = meshlod.tiles(path, tmp_path / "out", tile_faces=2000, progress=seen.append)
    assert contents(tmp_path / "out") == expected and report.tiles + 1 == len(expected)
    assert FACES < report.input_faces < 1.1 * FACES and report.levels[-1].faces > FACES
    errors = [level.error_proved for level in report.levels]
    assert errors == sorted(errors, reverse=True) and errors[-1] > 0
    assert seen[-1] == 1 and seen == sorted(seen)


def test_options_are_those_of_the_command(tmp_path):
    meshlod.Mesh(*torus(40, 20)).save(tmp_path / "a.ply")
    meshlod.Mesh(*torus(30, 20)).save(tmp_path / "b.ply")
    meshlod.tiles(
        [tmp_path / "a.ply", tmp_path / "b.ply"],
        tmp_path / "out",
        tile_faces=500,
        plain=True,
        skirts=False,
        up="z",
        lat=46.5,
        lon=-8.0,
        alt=2000,
        weld=0.001,
        memory=10**9,
        threads=2,
    )
    words = "--tile-faces 500 --plain --no-skirts --up z --lat 46.5 --lon -8 --alt 2000 --weld .001"
    inputs = tmp_path / "a.ply", tmp_path / "b.ply"
    command("tiles", *inputs, tmp_path / "expected", *words.split())
    assert contents(tmp_path / "out") == contents(tmp_path / "expected")


def test_what_cannot_be_tiled_is_told(tmp_path):
    path, out = tmp_path / "in.ply", tmp_path / "out"
    meshlod.Mesh(*torus()).save(path)
    for options, told in [
        ({"tile_faces": 5}, "tile_faces must be between 100"),
        ({"up": "x"}, "up must be y or z, not x"),
        ({"lat": 46.0}, "give lat and lon, or neither"),
        ({"lat": 91, "lon": 0}, "lat must be between -90 and 90, not 91"),
        ({"lat": 1, "lon": float("nan")}, "lon must be between"),
        ({"alt": 1}, "give lat and lon with it"),
        ({"weld": -1}, "weld must be at least 0, not -1"),
        ({"threads": 0}, "threads must be between 1"),
        ({"memory": "lots"}, "memory must be a whole number"),
    ]:
        with pytest.raises(meshlod.MeshlodError, match=told):
            meshlod.tiles(path, out, **options)
    for inputs, target, told in [
        ([], out, "at least one input"),
        (path, path, "in.ply: is a file; name a folder"),
        (path, tmp_path, "holds other files"),
        (tmp_path / "empty", out, "empty: no file of a format that is read"),
        (tmp_path / "points.ply", out, "points.ply: header: no faces: the file is a cloud"),
    ]:
        (tmp_path / "empty").mkdir(exist_ok=True)
        (tmp_path / "points.ply").write_text(POINTS)
        with pytest.raises(meshlod.MeshlodError, match=told):
            meshlod.tiles(inputs, target)
    with pytest.raises(FileNotFoundError, match=r"none\.ply"):
        meshlod.tiles(tmp_path / "none.ply", out)
    assert not out.exists()
    (out / ".plan").mkdir(parents=True)
    with open(out / ".plan" / "lock", "w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(OSError, match="another process is making tiles here"):
            meshlod.tiles(path, out)
    (tmp_path / "named.obj").write_text("o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    with pytest.warns(meshlod.MeshlodWarning, match=r"named\.obj: left out: 1 name of an obj"):
        assert meshlod.tiles(tmp_path / "named.obj", out).tiles == 1


POINTS = """ply
format ascii 1.0
element vertex 1
property float x
property float y
property float z
end_header
0 0 0
"""


def test_a_run_that_was_interrupted_goes_on(sample, tmp_path):
    path, expected = sample

    def stop(done):
        if done > 0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        meshlod.tiles(path, tmp_path / "out", tile_faces=2000, progress=stop)
    left = contents(tmp_path / "out" / ".plan")
    assert "plan.json" in left and not (tmp_path / "out" / "tileset.json").exists()
    # Nothing is written any more, and nobody has the folder.
    assert contents(tmp_path / "out" / ".plan") == left
    meshlod.tiles(path, tmp_path / "out", tile_faces=2000)
    assert contents(tmp_path / "out") == expected


def test_a_run_has_its_folder_between_its_tasks(sample, tmp_path):
    path, expected = sample
    out = tmp_path / "out"
    run = _native.NativeTileRun(_native.tile_plan_folder(str(out)))
    for _ in range(2):
        with pytest.raises(OSError, match="another process is making tiles here"):
            meshlod.tiles(path, out, tile_faces=2000)
    run.end(False)
    meshlod.tiles(path, out, tile_faces=2000)
    assert contents(out) == expected


def test_portions_hold_each_task_once_and_in_order():
    pytest.importorskip("distributed")
    from meshlod.dask._units import Units

    # Leaves 0 to 5; 6 of 0 to 2, 7 of 3; 8 of 6, 7, 4 and 5.
    parts = [[]] * 6 + [[0, 1, 2], [3], [6, 7, 4, 5]]
    units = Units(parts, [False] * 9, 20_000)
    assert units.tasks == {6: [0, 1, 2, 6], 8: [3, 4, 5, 7, 8]}
    assert units.ready() == [6] and units.finish(6) == [8] and units.finish(8) == []
    assert not units.left
    alone = Units(parts, [True] * 4 + [False] * 5, 50_000)
    # Each is as near as can be to those that are needed with it.
    assert alone.ready() == [6, 7, 4, 5]
    assert sorted(alone.tasks) == [4, 5, 6, 7, 8]
    assert [alone.finish(unit) for unit in (4, 6, 5, 7)] == [[], [], [], [8]]
    assert Units([[]], [True], 100).ready() == []


def test_workers_that_are_killed_change_no_byte(sample, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    import meshlod.dask
    from meshlod.dask import _units

    monkeypatch.setattr(_units, "SMALL", 4000)
    path, expected = sample
    killed = []
    local = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**local, silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill(done):
            if not killed and done > 0.3:
                killed.append(list(cluster.workers.values())[0].pid)
                os.kill(killed[0], signal.SIGKILL)

        out = tmp_path / "out"
        report = meshlod.dask.tiles(path, out, client=client, tile_faces=2000, progress=kill)
        assert killed and report.tiles + 1 == len(expected)
        with pytest.raises(meshlod.MeshlodError, match="give client or workers, not both"):
            meshlod.dask.tiles(path, out, client=client, workers=2)
        with pytest.raises(TypeError, match="no option memory"):
            meshlod.dask.tiles(path, out, client=client, memory=10**9)
        with pytest.raises(FileNotFoundError):
            meshlod.dask.tiles(tmp_path / "none.ply", tmp_path / "none", client=client)
        assert not (tmp_path / "none").exists()
    assert contents(out) == expected


def test_the_command_of_clusters_makes_the_same_bytes(sample, tmp_path):
    pytest.importorskip("distributed")
    path, expected = sample
    words = "--tile-faces", 2000, "--workers", 2, "--json"
    told = command("tiles", path, tmp_path / "out", *words, module="meshlod.dask")
    assert json.loads(told)["tiles"] + 1 == len(expected)
    assert contents(tmp_path / "out") == expected
