"""Meshes: views, measures, and what is done to them."""

from base64 import b64encode

import meshlod
import numpy as np
import pytest
from shapes import edges, sheet, torus, unrolled, welded, write_gltf

TETRA = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


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
    assert np.array_equal(mesh.extents, mesh.bounds[1] - mesh.bounds[0])
    empty = meshlod.Mesh([], [])
    assert np.isnan(empty.bounds).all() and np.isnan(empty.extents).all()


def test_closed_and_open_surfaces_are_told_apart():
    points, faces = torus()
    whole, holed = meshlod.Mesh(points, faces), meshlod.Mesh(points, faces[1:])
    assert whole.is_watertight and whole.euler_number == 0
    assert not holed.is_watertight and holed.euler_number == -1
    two = meshlod.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] * 2, [*TETRA, *(TETRA + 4)])
    assert two.is_watertight and two.euler_number == 4
    fins = meshlod.Mesh([*np.eye(3), [1, 1, 1], [2, 2, 2]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert not fins.is_watertight and fins.euler_number == 5 - 7 + 3
    spare = meshlod.Mesh([*points, [9, 9, 9]], faces)
    assert spare.euler_number == 0, "vertices without faces do not count"
    empty = meshlod.Mesh([], [])
    assert not empty.is_watertight and empty.euler_number == 0


def test_a_seam_is_not_open():
    points, faces, uvs = unrolled()
    mesh = meshlod.Mesh(points, faces, uvs=uvs)
    assert mesh.is_watertight and mesh.euler_number == 0
    assert not meshlod.Mesh(points, faces).is_watertight


@pytest.mark.parametrize("closed", [True, False])
def test_names_mean_what_they_do_in_trimesh(closed):
    trimesh = pytest.importorskip("trimesh")
    points, faces = torus(24, 12)
    mesh = meshlod.Mesh(points, faces if closed else faces[7:])
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    # The volume of an open surface is a matter of taste.
    for name in ("vertices", "faces", "bounds", "extents", "area", *["volume"] * closed):
        assert np.allclose(getattr(mesh, name), getattr(theirs, name)), name
    for name in ("is_watertight", "euler_number"):
        assert getattr(mesh, name) == getattr(theirs, name), name
    matrix = trimesh.transformations.random_rotation_matrix() @ np.diag([2, -3, 0.5, 1])
    moved = mesh.apply_transform(matrix)
    theirs.apply_transform(matrix)
    assert np.allclose(moved.vertices, theirs.vertices)
    if closed:
        assert moved.volume == pytest.approx(theirs.volume) and moved.volume > 0


def test_a_copy_is_the_mesh_itself():
    mesh = meshlod.Mesh(*torus())
    assert mesh.copy() is mesh
    assert meshlod.Scene(mesh).copy().face_count == len(mesh.faces)


def test_a_transform_moves_positions_and_turns_normals():
    points, faces, uvs = sheet()
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    mesh = meshlod.Mesh(points, faces, normals=normals, uvs=uvs)
    # A quarter turn around x, stretched along x, and moved.
    matrix = [[2, 0, 0, 5], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
    moved = mesh.apply_transform(matrix)
    x, y, z = points.T
    assert np.allclose(moved.vertices, np.stack([2 * x + 5, -z, y], axis=1))
    assert np.allclose(moved.normals, [0, -1, 0], atol=1e-6) and np.array_equal(moved.uvs, uvs)
    assert np.array_equal(moved.faces, faces)
    assert np.array_equal(mesh.vertices, points), "the mesh itself stays"
    assert np.array_equal(mesh.apply_transform(np.eye(4)).vertices, points)


def test_a_mirror_flips_the_faces_and_keeps_labels(tmp_path):
    mesh = meshlod.Scene.load(write_gltf(tmp_path, torus(), 1)).meshes[0][1]
    mirrored = mesh.apply_transform(np.diag([-1, 1, 1, 1]))
    assert mirrored.volume == pytest.approx(mesh.volume) and mirrored.is_watertight
    assert mirrored.materials[0] == mesh.materials[0]
    assert np.array_equal(mirrored.materials[1], mesh.materials[1])


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (np.eye(3), r"matrix must have the shape \(4, 4\), not float64 of \(3, 3\)"),
        (np.eye(4) * np.nan, "matrix is not finite"),
        (np.eye(4)[[0, 1, 3, 2]], r"its last row must be \[0, 0, 0, 1\], not \[0.0, 0.0, 1.0, 0"),
        (np.eye(4).astype(str), "matrix must have the shape"),
        (np.diag([1e308, 1e308, 1e308, 1]), "not finite"),
    ],
)
def test_matrices_that_are_none(matrix, message):
    with pytest.raises(meshlod.MeshlodError, match=message):
        meshlod.Mesh(*torus()).apply_transform(matrix)


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


def test_levels_are_polished_on_request():
    mesh = meshlod.Mesh(*torus())
    for levels in (
        lambda **options: [mesh.simplify(0.8, **options)],
        lambda **options: mesh.lods([0.5, 0.2], **options),
    ):
        for plain, fitted in zip(levels(), levels(polish=True), strict=True):
            assert (plain.faces == fitted.faces).all()
            assert (plain.vertices != fitted.vertices).any()
            assert fitted.volume == pytest.approx(plain.volume, rel=1e-9)


def test_notebooks_get_a_live_view_a_picture_and_text(tmp_path, monkeypatch):
    mesh = meshlod.Mesh(*torus())
    bundle = mesh._repr_mimebundle_()
    assert set(bundle) == {"text/plain", "image/png", "text/html"}
    assert bundle["text/plain"] == repr(mesh) and bundle["image/png"] == mesh._repr_png_()
    view = bundle["text/html"]
    assert view.startswith("<div") and view.count("<") == 5
    picture = b64encode(bundle["image/png"]).decode()
    assert 0 < view.index(f'<img src="data:image/png;base64,{picture}"') < view.index("<iframe")
    assert 'sandbox="allow-scripts"' in view
    assert "data-name=&quot;mesh.mlod&quot;" in view
    assert set(meshlod.Mesh([], [])._repr_mimebundle_()) == {"text/plain"}
    model = mesh.build(tmp_path / "torus.mlod")
    bundle = model._repr_mimebundle_()
    assert "torus.mlod – meshlod" in bundle["text/html"]
    assert bundle["image/png"].startswith(b"\x89PNG")
    monkeypatch.setattr("meshlod._view.MOST_BYTES", 10)
    assert set(model._repr_mimebundle_()) == {"text/plain", "image/png"}
    assert set(mesh._repr_mimebundle_()) == {"text/plain", "image/png"}


def test_a_view_of_many_faces_is_a_level(monkeypatch):
    mesh = meshlod.Mesh(*torus())
    whole = len(mesh._repr_mimebundle_()["text/html"])
    monkeypatch.setattr("meshlod._view.MOST_FACES", len(mesh.faces) // 4)
    assert len(mesh._repr_mimebundle_()["text/html"]) < whole
