"""Many files: on this machine, and on the workers of a Dask cluster that are killed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import meshlod
import pytest
from shapes import torus

JOURNAL = ".meshlod-batch.jsonl"
TEN = {"ratio": "10%"}


def make_inputs(folder, count):
    folder.mkdir()
    (folder / "sub").mkdir()
    for i in range(count):
        name = f"{i}.ply" if i % 3 else f"sub/{i}.glb"
        meshlod.Mesh(*torus(40 + 4 * i, 20)).save(folder / name)


def contents(folder):
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != JOURNAL]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def by_command(inputs, out):
    command = [sys.executable, "-m", "meshlod", "batch", inputs, out, "--ratio", "10%"]
    subprocess.run(command, check=True, timeout=120)
    return contents(out)


def test_a_batch_is_that_of_the_command(tmp_path):
    make_inputs(tmp_path / "in", 7)
    seen = []
    reports = meshlod.batch(tmp_path / "in", tmp_path / "out", TEN, jobs=2, progress=seen.append)
    assert contents(tmp_path / "out") == by_command(tmp_path / "in", tmp_path / "expected")
    assert [report.status for report in reports] == ["done"] * 7
    for report in reports:
        assert report.result["output_faces"] * 10 <= report.result["input_faces"]
    assert seen[-1] == 1 and seen == sorted(seen)
    pattern = str(tmp_path / "in/**/*")
    again = meshlod.batch([pattern], tmp_path / "out", {"verb": "simplify", **TEN})
    assert [report.status for report in again] == ["skipped"] * 7
    assert [report.result for report in again] == [report.result for report in reports]


def test_recipes_are_files_or_dictionaries(tmp_path):
    make_inputs(tmp_path / "in", 2)
    (tmp_path / "r.toml").write_text("verb = 'convert'\n")
    reports = meshlod.batch(tmp_path / "in", tmp_path / "out", tmp_path / "r.toml", format="off")
    assert sorted(contents(tmp_path / "out")) == ["1.off", "sub/0.off"] and len(reports) == 2
    with pytest.raises(meshlod.MeshlodError, match='simplify has no option "rato"'):
        meshlod.batch(tmp_path / "in", tmp_path / "out", {"rato": "10%"})
    with pytest.raises(meshlod.MeshlodError, match="recipe: "):
        meshlod.batch(tmp_path / "in", tmp_path / "out", {"ratio": object()})
    with pytest.raises(meshlod.MeshlodError, match="there is no such file or folder"):
        meshlod.batch(tmp_path / "none", tmp_path / "out", TEN)
    with pytest.raises(meshlod.MeshlodError, match="at least one path"):
        meshlod.batch([], tmp_path / "out", TEN)
    with pytest.raises(meshlod.MeshlodError, match="jobs must be between 1 and 65536, not 0"):
        meshlod.batch(tmp_path / "in", tmp_path / "out", TEN, jobs=0)


def test_a_file_that_fails_is_a_warning(tmp_path):
    make_inputs(tmp_path / "in", 3)
    (tmp_path / "in" / "bad.ply").write_text("ply\n")
    with pytest.warns(meshlod.MeshlodWarning, match="bad.ply: line 1"):
        reports = meshlod.batch(tmp_path / "in", tmp_path / "out", TEN)
    assert sorted(report.status for report in reports) == ["done", "done", "done", "failed"]


def test_dask_is_asked_for_where_it_is_missing(monkeypatch, tmp_path):
    import meshlod.dask

    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(meshlod.MeshlodError, match=r"pip install 'dask\[distributed\]'"):
        meshlod.dask.map(tmp_path, tmp_path / "out", TEN)


def test_workers_that_are_killed_change_no_byte(tmp_path):
    distributed = pytest.importorskip("distributed")
    import meshlod.dask

    make_inputs(tmp_path / "in", 60)
    (tmp_path / "in" / "bad.ply").write_text("ply\n")
    killed = []
    local = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with (
        distributed.LocalCluster(**local, silence_logs="CRITICAL") as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill(done):
            """Kills a worker after the first files, and twice more later."""
            if done > 0.1 + 0.25 * len(killed) and len(killed) < 3:
                processes = {nanny.pid for nanny in cluster.workers.values()}
                # One that is being replaced may still be listed.
                for process in list(processes - {None, *killed})[:1]:
                    killed.append(process)
                    os.kill(process, signal.SIGKILL)

        with pytest.warns(meshlod.MeshlodWarning, match="bad.ply: line 1"):
            reports = meshlod.dask.map(
                tmp_path / "in", tmp_path / "out", TEN, client=client, progress=kill
            )
        assert len(killed) >= 2
        assert [report.status for report in reports].count("done") == 60
        (tmp_path / "in" / "bad.ply").unlink()
        again = meshlod.dask.map(tmp_path / "in", tmp_path / "out", TEN, client=client)
    # What a worker had made and not yet told when it was killed may have been made twice.
    statuses = [report.status for report in again]
    assert set(statuses) <= {"skipped", "done"} and statuses.count("done") <= 2 * len(killed)
    assert contents(tmp_path / "out") == by_command(tmp_path / "in", tmp_path / "expected")
    # The command knows what the workers have made.
    known = meshlod.batch(tmp_path / "in", tmp_path / "out", TEN)
    assert {report.status for report in known} == {"skipped"}
    assert Path(tmp_path / "out" / JOURNAL).exists()
