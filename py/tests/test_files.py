"""Files, scenes, models and the command line."""

import json
import os
import subprocess
import sys

import meshlod
import numpy as np
import pytest
from shapes import torus, unrolled, write_gltf

@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "off", "smf", "gltf", "glb"])
def test_every_format_is_written_and_read(tmp_path, suffix):
    points, faces = torus()
    points = points.astype(np.float32)
    path = tmp_path / f"torus.{suffix}"
    meshlod.save(path, meshlod.Mesh(points, faces))
    mesh = meshlod.load(path)
    assert len(mesh.faces) == len(faces) and len(mesh.vertices) == len(points)
    order = [np.lexsort(at.T) for at in (points, mesh.vertices)]
    assert np.allclose(points[order[0]], mesh.vertices[order[1]], atol=1e-6)


def test_textures_stay_and_what_does_not_is_said(tmp_path):
    points, faces, uvs = unrolled()
    mesh = meshlod.Mesh(points, faces, uvs=uvs)
    mesh.save(tmp_path / "a.obj")
    assert len(np.unique(meshlod.load(tmp_path / "a.obj").uvs, axis=0)) == len(uvs)
    with pytest.warns(meshlod.MeshlodWarning, match="left out: .*texture coordinates"):
        mesh.save(tmp_path / "a.stl")


def test_bad_files_raise(tmp_path):
    missing = tmp_path / "missing.ply"
    with pytest.raises(FileNotFoundError) as raised:
        meshlod.load(missing)
    assert raised.value.filename == str(missing)
    broken = tmp_path / "broken.ply"
    broken.write_bytes(b"ply\nformat ascii 1.0\nelement vertex 3\n")
    with pytest.raises(meshlod.MeshlodError, match="broken.ply"):
        meshlod.load(broken)
    known = r"unknown suffix; .*ply.* \.?mlz \.?mlq, and \.?mlod by"
    with pytest.raises(meshlod.MeshlodError, match=known):
        meshlod.load(os.fsencode(tmp_path / "a.txt"))
    for wrong in 3, None, [missing]:
        with pytest.raises(meshlod.MeshlodError, match="a path must be a string or path-like"):
            meshlod.load(wrong)
        with pytest.raises(meshlod.MeshlodError, match="a path must be a string or path-like"):
            meshlod.Mesh(*torus()).save(wrong)
    with pytest.raises(meshlod.MeshlodError, match="open it with meshlod.Model"):
        meshlod.load(tmp_path / "a.mlod")
    with pytest.raises(meshlod.MeshlodError, match="broken.ply"):
        meshlod.Model(broken)
    for suffix in "mlz", "mlq":
        path = tmp_path / f"broken.{suffix}"
        path.write_bytes(broken.read_bytes())
        with pytest.raises(meshlod.MeshlodError, match=path.name):
            meshlod.load(path)
    with pytest.raises(OSError):
        meshlod.Mesh(*torus()).save(broken / "a.ply")


@pytest.mark.parametrize("suffix", ["mlz", "mlq"])
def test_compressed_files(tmp_path, suffix):
    mesh = meshlod.Mesh(*torus())
    path = tmp_path / f"torus.{suffix}"
    size = mesh.compress(path, bits=12)
    assert size == os.path.getsize(path) < 8 * len(mesh.faces)
    found = meshlod.load(path)
    assert len(found.faces) == len(mesh.faces)
    assert found.measure(mesh, samples=10_000).max < 0.005
    # A mean distance, as a length and as a percentage of the diagonal.
    by_length = mesh.compress(path, max_error=0.001 * np.linalg.norm(mesh.extents))
    assert mesh.compress(path, max_error="0.1%") == by_length < size


def test_scenes_keep_their_nodes_and_materials(tmp_path):
    path = write_gltf(tmp_path, torus(24, 12), places=2)
    lacks = "2 instances of meshes merged into one mesh; left out: 1 material's look"
    with pytest.warns(meshlod.MeshlodWarning, match=lacks) as caught:
        flat = meshlod.load(path)
    assert caught[0].filename == __file__
    assert len(flat.faces) == 2 * 576 and flat.bounds[1, 0] > 7
    assert flat.materials[0][0] == "red"
    scene = meshlod.Scene.load(path)
    assert scene.face_count == 2 * 576 and repr(scene) == "Scene(1 mesh, 1152 faces)"
    assert scene.instances[1][1][:3, 3].tolist() == [5, 0, 0]
    assert np.allclose(scene.bounds, [[-2.7, -2.7, -0.7], [7.7, 2.7, 0.7]], atol=0.1)
    assert np.array_equal(scene.extents, scene.bounds[1] - scene.bounds[0])
    _, report = scene.simplify(max_error="1%", return_report=True)
    assert report.error_asked == pytest.approx(0.01 * np.linalg.norm(scene.extents))
    level, report = scene.simplify(0.5, return_report=True)
    assert report.reached and level.face_count <= 576 < scene.face_count
    level.save(tmp_path / "level.glb")
    again = meshlod.Scene.load(tmp_path / "level.glb")
    assert again.materials == ["red"] and len(again.instances) == 2
    assert [name for name, _ in again.meshes] == ["torus"]
    assert len(again.meshes[0][1].faces) == len(level.meshes[0][1].faces)


def test_models_have_all_levels(tmp_path):
    mesh = meshlod.Mesh(*torus())
    model = mesh.build(tmp_path / "torus.mlod", lossless=True)
    assert len(model.extract().faces) == len(mesh.faces)
    assert len(model.extract(faces=300).faces) <= 300
    within = model.extract(max_error=0.02)
    assert len(within.faces) < len(mesh.faces)
    assert within.measure(mesh, samples=10_000).max <= 0.02
    assert len(model.extract(error=0.02).faces) == len(within.faces), "its old name"
    part = f"{2 / np.linalg.norm(mesh.extents)}%"
    assert len(model.extract(max_error=part).faces) == len(within.faces)
    camera = meshlod.Camera(eye=(0, 0, 40), look=(0, 0, 0))
    assert len(model.extract(camera=camera).faces) < len(mesh.faces)
    ball = model.extract(error=0.0, focus=((2.7, 0, 0), 0.3), verify=False)
    assert len(ball.faces) < len(mesh.faces) / 2
    corners = ((2, -1, -1), (3, 1, 1))
    cropped = model.extract(focus=corners, crop=True, verify=False)
    assert 0 < len(cropped.faces) < len(mesh.faces) / 2
    for wrong in 3, (1, 2), ((1, 2), 3):
        with pytest.raises(meshlod.MeshlodError, match="focus must be"):
            model.extract(focus=wrong)
    with pytest.raises(meshlod.MeshlodError, match="faces must be between 0"):
        model.extract(faces=-1)
    with pytest.raises(meshlod.MeshlodError, match="at least 0"):
        model.extract(error=-1)
    with pytest.raises(meshlod.MeshlodError, match="errors must be"):
        mesh.build(tmp_path / "other.mlod", errors="none")
    assert not (tmp_path / "other.mlod").exists()


def test_scenes_are_built_with_all_they_hold(tmp_path):
    scene = meshlod.Scene(meshlod.Mesh(*torus()), "torus")
    model = scene.build(tmp_path / "scene.mlod", errors="estimate")
    assert len(model.extract().faces) == scene.face_count


def test_models_say_what_cannot_be_met(tmp_path):
    mesh = meshlod.Mesh(*torus(120, 60))
    path = tmp_path / "torus.mlod"
    model = mesh.build(path)
    # The finest level and errors above the rounding are there.
    whole = model.extract()
    model.extract(error=0.02)
    with pytest.warns(meshlod.MeshlodWarning, match="an error of 1e-12 is below the rounding"):
        found = model.extract(error=1e-12)
    assert found.measure(mesh, samples=10_000).max > 1e-12
    with pytest.warns(meshlod.MeshlodWarning, match="faces=1 is out of reach: the coarsest") as to:
        assert len(model.extract(faces=1).faces) > 1
    assert to[0].filename == __file__
    with pytest.warns(meshlod.MeshlodWarning, match="no face intersects the focus, so all"):
        assert len(model.extract(focus=((9, 9, 9), 0.1)).faces) > 0
    with pytest.warns(meshlod.MeshlodWarning, match="no face intersects the focus$"):
        assert len(model.extract(focus=((9, 9, 9), 0.1), crop=True).faces) == 0
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.warns(meshlod.MeshlodWarning, match="truncated, and .* of its .* chunks are"):
        assert len(model.extract().faces) < len(whole.faces)


def command(*arguments):
    line = [sys.executable, "-m", "meshlod", *map(str, arguments)]
    return subprocess.run(line, capture_output=True, text=True)


def test_the_command_line_is_there(tmp_path):
    path = tmp_path / "torus.ply"
    meshlod.Mesh(*torus()).save(path)
    done = command("--json", "simplify", path, tmp_path / "out.ply", "--faces", "300")
    assert done.returncode == 0 and json.loads(done.stdout)["output_faces"] <= 300
    assert len(meshlod.load(tmp_path / "out.ply").faces) <= 300
    assert command("--version").stdout.startswith("meshlod ")
    missing = command("info", tmp_path / "missing.ply")
    assert missing.returncode == 1 and missing.stderr.count("\n") == 1
    assert command("simplify").returncode == 2
