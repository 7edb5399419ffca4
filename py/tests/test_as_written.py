"""A proved error holds for the files that are written, as that of the command does."""

import json
import subprocess
import sys

import meshlod
import numpy as np
import pytest
from meshlod import _native
from shapes import torus

FORMS = [("ply", "f32"), ("stl", "auto"), ("glb", "auto"), ("obj", "auto")]


def certified(first, second):
    """Returns the greatest distance between two files that is certain."""
    line = ["measure", str(first), str(second), "--certified", "--samples", "10", "--json"]
    found = json.loads(answer(line))
    return found["certified"]["lower"], found["certified"]["upper"]


def answer(line):
    done = subprocess.run([sys.executable, "-m", "meshlod", *line], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(("suffix", "precision"), FORMS, ids=str)
@pytest.mark.parametrize("part", [0.003, 0.001, 0.0003])
def test_max_error_holds_as_written(tmp_path, suffix, precision, part):
    points, faces = torus(60, 40)
    meshlod.Mesh(points, faces).save(tmp_path / "in.ply", precision="f64")
    mesh = meshlod.load(tmp_path / "in.ply")
    asked = part * np.linalg.norm(mesh.bounds[1] - mesh.bounds[0])
    level, report = mesh.simplify(max_error=asked, return_report=True)
    out = tmp_path / f"out.{suffix}"
    level.save(out, precision=precision)
    least, most = certified(tmp_path / "in.ply", out)
    assert report.reached and report.precision == "f32"
    assert report.error_asked == asked and report.error_proved <= asked * (1 + 1e-9)
    assert least <= asked and most <= 1.02 * asked
    assert report.output_faces < report.input_faces


def test_a_scene_is_as_written(tmp_path):
    points, faces = torus(60, 40)
    scene = meshlod.Scene(meshlod.Mesh(points, faces))
    scene.save(tmp_path / "in.ply", precision="f64")
    level, report = scene.simplify(max_error=0.01, return_report=True)
    level.save(tmp_path / "out.glb")
    least, _ = certified(tmp_path / "in.ply", tmp_path / "out.glb")
    assert report.reached and least <= 0.01


def test_what_32_bits_would_round_away_takes_64_as_written(tmp_path):
    points, faces = torus(60, 40)
    points = points + [1e5, 0, 0]
    mesh = meshlod.Mesh(points, faces)
    mesh.save(tmp_path / "in.ply", precision="f64")
    level, report = mesh.simplify(max_error=0.005, return_report=True)
    assert report.reached and report.precision == "f64"
    level.save(tmp_path / "out.ply", precision=report.precision)
    least, _ = certified(tmp_path / "in.ply", tmp_path / "out.ply")
    assert least <= 0.005
    with pytest.warns(meshlod.MeshlodWarning, match="only .* is proved"):
        _, report = mesh.simplify(max_error=0.005, precision="f32", return_report=True)
    assert not report.reached and report.error_proved > 0.005


def test_a_precision_that_is_none_is_refused_as_written(tmp_path):
    mesh = meshlod.Mesh(*torus(6, 6))
    with pytest.raises(meshlod.MeshlodError, match="precision must be auto, f32 or f64, not f16"):
        mesh.simplify(max_error=0.1, precision="f16")
    with pytest.raises(meshlod.MeshlodError, match="precision must be auto, f32 or f64, not f16"):
        mesh.save(tmp_path / "a.ply", precision="f16")


def test_the_fields_are_those_of_the_command_as_written():
    native = meshlod.Mesh(*torus(30, 20))._native
    options = {"method": "qem", "topology": "free", "lock_boundary": False}
    _, fields = _native.simplify(native, meshlod._asked.asked(native, "error", 0.01, **options))
    assert {"error_asked", "error_proved", "error_rounds", "split_vertices"} <= set(fields)
