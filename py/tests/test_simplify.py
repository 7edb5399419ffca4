"""Simplification of arrays."""

import os
import subprocess
import sys

import meshlod
import numpy as np
import pytest
from shapes import edges, sheet, torus, unrolled, welded


@pytest.mark.parametrize("target", [{"target_reduction": 0.9}, {"target_count": 360}], ids=str)
def test_a_closed_surface_gets_smaller_and_stays_closed(target):
    points, faces = torus()
    out, triangles = meshlod.simplify(points, faces, **target)
    assert 340 <= len(triangles) <= 360
    assert out.dtype == np.float64 and triangles.dtype == np.int32
    assert (edges(triangles) == 2).all()
    assert out.flags.writeable and triangles.flags.writeable


def test_arguments_are_those_of_fast_simplification():
    points, faces = torus()
    by_place = meshlod.simplify(points.tolist(), faces.tolist(), 0.5)
    by_name = meshlod.simplify(points=points, triangles=faces, target_reduction=0.5)
    assert len(by_place) == 2
    for a, b in zip(by_place, by_name, strict=True):
        assert np.array_equal(a, b)
    with pytest.warns(meshlod.MeshlodWarning, match="agg has no effect"):
        meshlod.simplify(points, faces, 0.5, agg=3)
    with pytest.raises(ValueError, match="return_collapses is not supported"):
        meshlod.simplify(points, faces, 0.5, return_collapses=True)


def test_an_error_is_proved():
    points, faces = torus()
    out, triangles, report = meshlod.simplify(points, faces, max_error=0.02, return_report=True)
    assert report.reached and report.error_proved <= 0.02
    assert len(triangles) == report.output_faces < len(faces)
    distance = meshlod.Mesh(points, faces).measure(meshlod.Mesh(out, triangles), samples=20_000)
    assert 0 < distance.max <= 0.02


def test_an_error_may_be_a_percentage_of_the_diagonal():
    points, faces = torus()
    mesh = meshlod.Mesh(points, faces)
    length = float(np.linalg.norm(mesh.extents)) * 0.005
    expected = meshlod.simplify(points, faces, max_error=length)
    found = *level, report = meshlod.simplify(points, faces, max_error="0.5%", return_report=True)
    assert report.error_asked == pytest.approx(length) and report.reached
    assert [len(array) for array in level] == [len(array) for array in expected]
    for of in mesh, meshlod.Scene(mesh):
        _, report = of.simplify(max_error="0.5%", return_report=True)
        assert report.error_asked == pytest.approx(length)
    assert len(meshlod.simplify(mesh, max_error="0.5%").faces) == len(found[1])


@pytest.mark.parametrize("points_dtype", [np.float64, np.float32, ">f8", np.float16, np.int32])
@pytest.mark.parametrize("faces_dtype", [np.int64, np.int32, np.uint32, np.uint64, ">i4", np.int16])
def test_all_number_types_are_read(points_dtype, faces_dtype):
    points, faces = torus()
    points = np.rint(points * 64)
    expected = meshlod.simplify(points, faces, 0.5)
    found = meshlod.simplify(points.astype(points_dtype), faces.astype(faces_dtype), 0.5)
    assert all(np.array_equal(a, b) for a, b in zip(expected, found, strict=True))


def test_layout_and_writability_do_not_matter():
    points, faces = torus()
    expected = meshlod.simplify(points, faces, 0.5)
    wide = np.zeros((len(points), 7))
    wide[:, 2:5] = points
    fixed = faces.copy()
    fixed.setflags(write=False)
    backwards = np.ascontiguousarray(faces[::-1])[::-1]
    crooked = np.frombuffer(b"\0" * 3 + points.tobytes(), points.dtype, offset=3)
    crooked = crooked.reshape(points.shape)
    assert not crooked.flags.aligned
    layouts = [(np.asfortranarray(points), faces), (wide[:, 2:5], fixed), (points, backwards)]
    for p, f in [*layouts, (crooked, faces)]:
        found = meshlod.simplify(p, f, 0.5)
        assert all(np.array_equal(a, b) for a, b in zip(expected, found, strict=True))


def test_a_seam_keeps_its_texture_and_does_not_tear():
    points, faces, uvs = unrolled()
    assert (edges(faces) == 1).any(), "the arrays are torn"
    assert (edges(welded(points, faces)) == 2).all(), "the surface is not"
    out, triangles, attributes = meshlod.simplify(points, faces, 0.8, uvs=uvs)
    assert len(triangles) <= 720
    assert (edges(welded(out, triangles)) == 2).all()
    assert attributes["uvs"].shape == (len(out), 2) and attributes["uvs"].dtype == np.float32
    # Texture coordinates still are the angle around the axis, from 0 to 1.
    angle = np.arctan2(out[:, 1], out[:, 0]) / (2 * np.pi) % 1
    apart = np.abs(attributes["uvs"][:, 0] - angle)
    assert np.minimum(apart, 1 - apart).max() < 0.01
    spans = attributes["uvs"][triangles][:, :, 0]
    assert np.ptp(spans, axis=1).max() < 0.5, "no face goes back over the whole texture"


def test_attributes_come_back_as_they_were_given():
    points, faces = torus()
    given = {
        "colors": np.full((len(points), 4), [10, 20, 30, 255], dtype=np.uint8),
        "normals": np.tile([0.0, 0.0, 2.0], (len(points), 1)),
        "attributes": {"class": np.full(len(points), 7), "heat": points[:, 2]},
    }
    out, _, attributes = meshlod.simplify(points, faces, 0.5, **given)
    assert set(attributes) == {"colors", "normals", "class", "heat"}
    assert attributes["colors"].dtype == np.uint8
    assert (attributes["colors"] == [10, 20, 30, 255]).all()
    assert np.allclose(attributes["normals"], [0, 0, 1])
    assert attributes["class"].shape == (len(out),) and (attributes["class"] == 7).all()
    assert np.abs(attributes["heat"] - out[:, 2]).max() < 0.1


@pytest.mark.parametrize("uvs", [False, True])
def test_locked_points_stay(uvs):
    points, faces, own = sheet()
    rows = np.array([0, 19, 210, 380, 399])
    mask = np.zeros(len(points), dtype=bool)
    mask[rows] = True
    options = {"uvs": own} if uvs else {}
    kept = []
    for locks in [rows, mask]:
        out = meshlod.simplify(points, faces, 0.95, locks=locks, **options)[0]
        for row in rows:
            assert (out == points[row]).all(axis=1).any(), row
        kept.append(out)
    assert np.array_equal(*kept)
    free = meshlod.simplify(points, faces, 0.95, **options)[0]
    assert not (free == points[210]).all(axis=1).any(), "without a lock it goes"


def test_locks_count_points_at_a_seam():
    points, faces, uvs = unrolled()
    row = len(points) - 5
    out = meshlod.simplify(points, faces, 0.95, uvs=uvs, locks=[row])[0]
    assert (out == points[row]).all(axis=1).any()
    mesh = meshlod.Mesh(points, faces, uvs=uvs)
    level = mesh.simplify(0.95, locks=[len(mesh.vertices) - 5])
    assert (level.vertices == mesh.vertices[-5]).all(axis=1).any()


def test_a_target_out_of_reach_warns():
    points, faces = torus(12, 8)
    with pytest.warns(meshlod.MeshlodWarning, match="target not reached") as caught:
        _, triangles, report = meshlod.simplify(
            points, faces, target_count=1, topology="keep", return_report=True
        )
    assert caught[0].filename == __file__
    assert not report.reached and len(triangles) == report.output_faces > 1
    assert sum(report.refusals.values()) > 0
    with pytest.warns(meshlod.MeshlodWarning, match="target not reached"):
        meshlod.simplify(meshlod.Mesh(points, faces), target_count=1, topology="keep")


def test_normals_of_whole_numbers_come_back_with_fractions():
    points, faces = torus()
    normals = np.rint(points * 9).astype(np.int32)
    found = meshlod.simplify(points, faces, 0.9, normals=normals)[2]["normals"]
    assert found.dtype == np.float32
    assert np.allclose(np.linalg.norm(found, axis=1), 1, atol=1e-3)


def test_attributes_are_single_precision_on_the_way():
    points, faces = torus()
    third = np.full(len(points), 1 / 3)
    found = meshlod.simplify(points, faces, 0.5, attributes={"third": third})[2]["third"]
    assert found.dtype == np.float64 and (found == np.float32(1 / 3)).all()


@pytest.mark.parametrize("method", ["qem", "spr", "pm"])
def test_other_methods_run(method):
    _, faces, report = meshlod.simplify(*torus(24, 12), 0.5, method=method, return_report=True)
    assert report.method == method and len(faces) <= 288


def test_the_number_of_threads_does_not_matter():
    code = (
        "import sys; sys.path.insert(0, 'tests'); import hashlib, meshlod, shapes;"
        "a, b = meshlod.simplify(*shapes.torus(400, 120), 0.9);"
        "print(hashlib.sha256(a.tobytes() + b.tobytes()).hexdigest())"
    )
    root = os.path.dirname(os.path.dirname(__file__))
    digests = set()
    for threads in "1", "3":
        env = {**os.environ, "RAYON_NUM_THREADS": threads}
        done = subprocess.run([sys.executable, "-c", code], env=env, cwd=root, capture_output=True)
        assert done.returncode == 0, done.stderr
        digests.add(done.stdout)
    assert len(digests) == 1
