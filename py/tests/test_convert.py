"""Meshes of other packages. Each test needs the real package, and is skipped without it."""

import meshlod
import numpy as np
import pytest
from meshlod import convert
from shapes import edges, torus, unrolled


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    points, faces, uvs = unrolled()
    visual = trimesh.visual.TextureVisuals(uv=uvs)
    mesh = trimesh.Trimesh(points, faces, visual=visual, process=False, metadata={"id": 3})
    level = meshlod.simplify(mesh, target_reduction=0.8)
    assert isinstance(level, trimesh.Trimesh) and 0 < len(level.faces) <= 720
    assert level.visual.uv.shape == (len(level.vertices), 2)
    assert level.metadata["id"] == 3
    colored = trimesh.Trimesh(*torus(), process=False)
    colored.visual.vertex_colors = np.tile([200, 100, 50, 255], (len(colored.vertices), 1))
    level = meshlod.simplify(colored, target_count=360)
    assert level.is_watertight and len(level.faces) <= 360
    assert (level.visual.vertex_colors == [200, 100, 50, 255]).all()
    colored.visual.face_colors = [1, 2, 3, 255]
    with pytest.warns(meshlod.MeshlodWarning, match="colours of faces"):
        meshlod.simplify(colored, target_reduction=0.5)
    message = "from_trimesh takes a trimesh.Trimesh, not Scene: use to_mesh"
    with pytest.raises(meshlod.MeshlodError, match=message):
        meshlod.simplify(trimesh.Scene(colored), target_reduction=0.5)
    with pytest.warns(meshlod.MeshlodWarning, match="the material with its textures") as caught:
        convert.from_trimesh(mesh)
    assert caught[0].filename == __file__


def test_attributes_of_trimesh():
    trimesh = pytest.importorskip("trimesh")
    points, faces = torus()
    mesh = trimesh.Trimesh(points, faces, process=False)
    mesh.vertex_attributes["heat"] = points[:, 2]
    mesh.vertex_attributes["frames"] = np.zeros((len(points), 3, 3))
    mesh.face_attributes["class"] = np.zeros(len(faces))
    left_out = r"left out: attributes of vertices \(frames\), attributes of faces \(class\)"
    with pytest.warns(meshlod.MeshlodWarning, match=left_out) as caught:
        level = meshlod.simplify(mesh, target_reduction=0.5)
    assert caught[0].filename == __file__
    assert set(level.vertex_attributes) == {"heat"}
    heat = np.ravel(level.vertex_attributes["heat"])
    assert np.abs(heat - level.vertices[:, 2]).max() < 0.2


def everything():
    """A mesh with all kinds of attributes, and opacity."""
    points, faces, uvs = unrolled()
    colors = np.tile(np.float32([0.2, 0.4, 0.6, 0.5]), (len(points), 1))
    return meshlod.Mesh(
        points,
        faces,
        normals=np.tile([0.0, 0.0, 1.0], (len(points), 1)),
        uvs=uvs,
        colors=colors,
        attributes={"heat": points[:, 2]},
    )


@pytest.mark.parametrize("package", ["trimesh", "pyvista", "meshio"])
def test_all_attributes_go_there_and_back(package):
    pytest.importorskip(package)
    mesh = everything()
    there = getattr(convert, f"to_{package}")(mesh)
    if package == "trimesh":
        with pytest.warns(meshlod.MeshlodWarning, match="the material"):
            back = convert.from_trimesh(there)
        assert np.allclose(there.vertex_normals, [0, 0, 1])
    else:
        back = getattr(convert, f"from_{package}")(there)
    # Those of trimesh may be computed ones.
    names = ["uvs", "colors", "heat"] if package == "trimesh" else list(mesh.attributes)
    for name in names:
        assert np.array_equal(back.attributes[name], mesh.attributes[name]), name


def test_labels_of_faces_are_named(tmp_path):
    pytest.importorskip("meshio")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n")
    mesh = meshlod.load(tmp_path / "a.obj")
    with pytest.warns(meshlod.MeshlodWarning, match="left out: names of materials"):
        convert.to_meshio(mesh)


def test_pyvista():
    pyvista = pytest.importorskip("pyvista")
    sphere = pyvista.Sphere(theta_resolution=60, phi_resolution=60)
    sphere.point_data["height"] = sphere.points[:, 2].astype(np.float64)
    sphere.point_data["class"] = np.full(sphere.n_points, 5)
    level = meshlod.simplify(sphere, target_reduction=0.9)
    assert isinstance(level, pyvista.PolyData) and level.is_all_triangles
    assert 0 < level.n_cells <= sphere.n_cells // 10 and level.n_open_edges == 0
    assert np.abs(level.point_data["height"] - level.points[:, 2]).max() < 0.05
    assert (level.point_data["class"] == 5).all()
    assert level.point_data.active_normals.shape == (level.n_points, 3)
    plane = pyvista.Plane(i_resolution=30, j_resolution=30)
    level = meshlod.simplify(plane, target_reduction=0.9)
    assert np.abs(level.active_texture_coordinates - (level.points[:, :2] + 0.5)).max() < 1e-3
    sphere.cell_data["area"] = np.ones(sphere.n_cells)
    sphere.field_data["unit"] = ["m"]
    sphere.point_data["vtkMine"] = sphere.points[:, 0]
    left_out = r"left out: arrays of cells \(area\), arrays of the data set \(unit\)"
    with pytest.warns(meshlod.MeshlodWarning, match=left_out):
        own = convert.from_pyvista(sphere)
    assert np.array_equal(own.attributes["vtkMine"][:, 0], sphere.points[:, 0])
    grid = pyvista.ImageData(dimensions=(4, 4, 4))
    assert convert.from_pyvista(grid).attributes == {}, "none that extraction adds"
    lines = plane.merge(pyvista.Line()).extract_surface()
    with pytest.warns(meshlod.MeshlodWarning, match=r"lines \(1\)"):
        assert len(convert.from_pyvista(lines).faces) == 1800


def test_open3d():
    open3d = pytest.importorskip("open3d", exc_type=ImportError)
    mesh = convert.to_open3d(meshlod.Mesh(*torus()))
    mesh.compute_vertex_normals()
    level = meshlod.simplify(mesh, target_reduction=0.9)
    assert isinstance(level, open3d.geometry.TriangleMesh) and level.is_watertight()
    assert 0 < len(level.triangles) <= 360 and level.has_vertex_normals()
    points, faces, uvs = unrolled()
    textured = convert.to_open3d(meshlod.Mesh(points, faces, uvs=uvs))
    back = convert.from_open3d(textured)
    assert len(back.vertices) == len(points) and back.check().is_clean
    assert meshlod.simplify(textured, target_reduction=0.5).has_triangle_uvs()
    left_out = r"left out: attributes \(heat\), opacity of colours"
    with pytest.warns(meshlod.MeshlodWarning, match=left_out):
        convert.to_open3d(everything())
    textured.triangle_material_ids = open3d.utility.IntVector(np.zeros(len(faces), dtype=np.int32))
    with pytest.warns(meshlod.MeshlodWarning, match="left out: materials of triangles"):
        convert.from_open3d(textured)


def test_meshio(tmp_path):
    meshio = pytest.importorskip("meshio")
    points, faces = torus()
    mesh = meshio.Mesh(points, [("triangle", faces)], point_data={"heat": points[:, 2]})
    level = meshlod.simplify(mesh, target_reduction=0.9)
    assert isinstance(level, meshio.Mesh)
    triangles = level.cells_dict["triangle"]
    assert 0 < len(triangles) <= 360 and (edges(triangles) == 2).all()
    assert np.abs(level.point_data["heat"] - level.points[:, 2]).max() < 0.2
    level.write(tmp_path / "level.vtu")
    assert len(meshio.read(tmp_path / "level.vtu").cells_dict["triangle"]) == len(triangles)
    quads = meshio.Mesh([[0, 0], [1, 0], [1, 1], [0, 1.0]], [("quad", [[0, 1, 2, 3]])])
    assert len(convert.from_meshio(quads).faces) == 2
    odd = {"colors": np.zeros((4, 3), dtype=np.int64), "uvs": np.zeros(4), "names": np.full(4, "a")}
    with pytest.warns(meshlod.MeshlodWarning, match=r"data of points \(colors, uvs, names\)"):
        convert.from_meshio(meshio.Mesh(quads.points, quads.cells, point_data=odd))
    parts = {"point_sets": {"rim": [0]}, "cell_sets": {"all": [[0]]}, "field_data": {"a": [1, 2]}}
    quads = meshio.Mesh(quads.points, quads.cells, **parts)
    left_out = r"sets of points \(rim\), sets of cells \(all\), data of the mesh \(a\)"
    with pytest.warns(meshlod.MeshlodWarning, match=left_out):
        convert.from_meshio(quads)
    solid = meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])])
    with pytest.raises(meshlod.MeshlodError, match="tetra are no surface"):
        convert.from_meshio(solid)


@pytest.mark.parametrize("package", ["trimesh", "pyvista", "open3d", "meshio"])
def test_what_is_no_mesh_of_a_package(package):
    if package != "open3d":
        pytest.importorskip(package)
    with pytest.raises(meshlod.MeshlodError, match=f"from_{package} takes .*{package}.*, not int$"):
        getattr(convert, f"from_{package}")(3)
