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
    with pytest.raises(meshlod.MeshlodError, match="a Scene is no single mesh"):
        meshlod.simplify(trimesh.Scene(colored), target_reduction=0.5)


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
    with pytest.warns(meshlod.MeshlodWarning, match=r"arrays of cells \(area\)"):
        convert.from_pyvista(sphere)


def test_open3d():
    open3d = pytest.importorskip("open3d")
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
    solid = meshio.Mesh(np.eye(4, 3), [("tetra", [[0, 1, 2, 3]])])
    with pytest.raises(meshlod.MeshlodError, match="tetra are no surface"):
        convert.from_meshio(solid)
