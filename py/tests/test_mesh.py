"""Meshes: views, measures, and what is done to them."""

import meshlod
import numpy as np
import pytest
from shapes import edges, sheet, torus, unrolled, welded


def test_arrays_come_back():
    points, faces = torus()
    mesh = meshlod.Mesh(points.astype(np.float32), faces.tolist())
    assert np.array_equal(mesh.vertices, points.astype(np.float32))
    assert np.array_equal(mesh.faces, faces)
    assert mesh.vertices.base is not None, "a view"
    own, _ = mesh.to_arrays()
    own[:] = 0
    assert np.array_equal(mesh.vertices, points.astype(np.float32))
    assert mesh.attributes == {} and mesh.uvs is None and mesh.materials is None
    assert repr(mesh) == "Mesh(1800 vertices, 3600 faces)"


def test_a_seam_comes_back_as_points():
    points, faces, uvs = unrolled()
    mesh = meshlod.Mesh(points, faces, uvs=uvs)
    assert np.array_equal(mesh.vertices, points) and np.array_equal(mesh.faces, faces)
    assert np.array_equal(mesh.uvs, uvs)
    assert mesh.check().is_clean, "no boundary: the surface is not torn"
    assert "boundary-loop" in str(meshlod.Mesh(points, faces).check())
    with pytest.raises(ValueError, match="read-only"):
        mesh.uvs[0] = 0


def test_sizes_are_those_of_the_torus():
    mesh = meshlod.Mesh(*torus(200, 100))
    assert mesh.area == pytest.approx(4 * np.pi**2 * 2 * 0.7, rel=0.01)
    assert mesh.volume == pytest.approx(2 * np.pi**2 * 2 * 0.7**2, rel=0.01)
    assert np.allclose(mesh.bounds, [[-2.7, -2.7, -0.7], [2.7, 2.7, 0.7]])
    assert np.isnan(meshlod.Mesh([], []).bounds).all()


def test_levels_are_nested_and_fall():
    levels = meshlod.Mesh(*torus()).lods([0.5, 0.1])
    assert [len(level.faces) for level in levels] == [1800, 360]
    assert meshlod.Mesh(*torus()).lods([]) == []
    with pytest.raises(meshlod.MeshlodError, match="ratios must fall"):
        meshlod.Mesh(*torus()).lods([0.1, 0.5])


def test_the_distance_is_symmetric_and_has_its_places():
    points, faces = torus()
    a, b = meshlod.Mesh(points, faces), meshlod.Mesh(points + [0, 0, 0.1], faces)
    distance = a.measure(b, samples=10_000)
    assert 0 < distance.mean < distance.rms < distance.max <= 0.1 + 1e-12
    assert distance.diagonal == pytest.approx(np.linalg.norm(np.diff(a.bounds, axis=0)))
    apart = np.subtract(distance.forward.max_from, distance.forward.max_to)
    assert np.linalg.norm(apart) == pytest.approx(distance.forward.max)
    with pytest.raises(meshlod.MeshlodError, match="samples"):
        a.measure(b, samples=0)
    with pytest.raises(meshlod.MeshlodError, match="the second mesh: the mesh has no faces"):
        a.measure(meshlod.Mesh([], []))


def test_errors_are_found_and_repaired():
    points, faces = torus()
    broken = meshlod.Mesh(points, np.vstack([faces[::-1], faces[:2], [[0, 0, 5]]]))
    report = broken.check()
    assert report.errors and not report.is_clean
    assert str(report).startswith(next(iter([*report.errors, *report.warnings])))
    mesh, counts = broken.repair(return_report=True)
    assert mesh.check().is_clean and len(mesh.faces) == len(faces)
    assert counts and all(count > 0 for count in counts.values())
    with pytest.raises(meshlod.MeshlodError, match="weld must be at least 0"):
        broken.repair(weld=-1.0)


def test_holes_are_filled():
    points, faces = torus()
    mesh = meshlod.Mesh(points, faces[6:]).repair(fill_holes=64)
    assert (edges(mesh.faces) == 2).all()


@pytest.mark.parametrize("with_seam", [False, True])
def test_strips_draw_the_faces(with_seam):
    points, faces, uvs = unrolled()
    mesh = meshlod.Mesh(points, faces, uvs=uvs) if with_seam else meshlod.Mesh(*torus())
    indices = mesh.strip()
    drawn = []
    for strip in np.split(indices, np.flatnonzero(indices == 2**32 - 1)):
        strip = strip[strip != 2**32 - 1].tolist()
        for i in range(len(strip) - 2):
            a, b, c = strip[i : i + 3]
            if len({a, b, c}) == 3:
                drawn.append(sorted([a, b, c]))
    assert sorted(drawn) == sorted(np.sort(mesh.faces, axis=1).tolist())
    assert len(indices) < 1.5 * len(mesh.faces)


def test_pictures_show_the_mesh():
    mesh = meshlod.Mesh(*torus())
    picture = mesh.render((80, 60))
    assert picture.shape == (60, 80, 4) and picture.dtype == np.uint8
    assert len(np.unique(picture.reshape(-1, 4), axis=0)) > 50
    assert not np.array_equal(picture, mesh.render((80, 60), wireframe=True))
    assert mesh._repr_png_().startswith(b"\x89PNG")
    assert meshlod.Mesh([], [])._repr_png_() is None
    for size in (0, 10), (10**6, 10**6), (-1, 5):
        with pytest.raises(meshlod.MeshlodError):
            mesh.render(size)
    with pytest.raises(meshlod.MeshlodError, match="no faces"):
        meshlod.Mesh([], []).render()


def test_the_boundary_can_be_locked():
    points, faces, uvs = sheet()
    on = (points[:, :2] == 0).any(axis=1) | (points[:, :2] == 1).any(axis=1)
    level = meshlod.Mesh(points, faces, uvs=uvs).simplify(0.7, lock_boundary=True)
    assert set(map(tuple, points[on])) <= set(map(tuple, level.vertices))
    assert (edges(welded(level.vertices, level.faces)) == 1).sum() == on.sum()
