"""Meshes of other packages: trimesh, pyvista, open3d and meshio, which are imported when needed.

What a package has and a :class:`meshlod.Mesh` does not is named in a :class:`MeshlodWarning`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ._errors import MeshlodError, warn
from ._mesh import Mesh


def adopted(mesh: Any) -> tuple[Mesh, Callable[[Mesh], Any]]:
    """Returns a mesh of another package as one of this package, and the way back."""
    for base in type(mesh).__mro__:
        package = base.__module__.split(".")[0]
        if package == "trimesh":
            return from_trimesh(mesh), lambda level: to_trimesh(level, like=mesh)
        if package == "pyvista":
            return from_pyvista(mesh), to_pyvista
        if package == "open3d":
            return from_open3d(mesh), to_open3d
        if package == "meshio":
            return from_meshio(mesh), to_meshio
    kind = type(mesh).__name__
    raise MeshlodError(f"give points and faces, or a mesh of a known package, not {kind} alone")


def from_trimesh(mesh: Any) -> Mesh:
    """Makes a mesh of a ``trimesh.Trimesh``, with its texture coordinates or vertex colours."""
    if not hasattr(mesh, "faces"):
        kind = type(mesh).__name__
        raise MeshlodError(f"a {kind} is no single mesh: use to_mesh() or concatenate first")
    uvs, colors = None, None
    visual = mesh.visual
    if getattr(visual, "kind", None) == "texture" and visual.uv is not None:
        uvs = visual.uv
    elif getattr(visual, "kind", None) == "vertex":
        colors = np.asarray(visual.vertex_colors)
    elif getattr(visual, "kind", None) == "face":
        warn("left out: colours of faces")
    return Mesh(mesh.vertices, mesh.faces, uvs=uvs, colors=colors)


def to_trimesh(mesh: Mesh, *, like: Any = None) -> Any:
    """Makes a ``trimesh.Trimesh``, with the material and metadata of ``like``."""
    import trimesh

    points, faces = mesh.to_arrays()
    visual: Any = None
    if mesh.uvs is not None:
        material = getattr(getattr(like, "visual", None), "material", None)
        visual = trimesh.visual.TextureVisuals(uv=np.array(mesh.uvs), material=material)
    elif mesh.colors is not None:
        colors = np.rint(np.clip(mesh.colors, 0, 1) * 255).astype(np.uint8)
        visual = trimesh.visual.ColorVisuals(vertex_colors=colors)
    metadata = None if like is None else dict(like.metadata)
    return trimesh.Trimesh(points, faces, visual=visual, metadata=metadata, process=False)


#: Names of normals and texture coordinates in pyvista, unless others are active.
NORMALS, UVS = "Normals", "Texture Coordinates"


def from_pyvista(mesh: Any) -> Mesh:
    """Makes a mesh of the surface of a ``pyvista`` data set, with the arrays of its points."""
    import pyvista

    surface = mesh if isinstance(mesh, pyvista.PolyData) else mesh.extract_surface()
    if not surface.is_all_triangles:
        surface = surface.triangulate()
    if len(surface.cell_data) > 0:
        warn(f"left out: arrays of cells ({', '.join(surface.cell_data.keys())})")
    named = dict(surface.point_data.items())
    normals_name = surface.point_data.active_normals_name or NORMALS
    uvs_name = surface.point_data.active_texture_coordinates_name or UVS
    normals, uvs = named.pop(normals_name, None), named.pop(uvs_name, None)
    faces = surface.regular_faces if surface.n_cells else np.zeros((0, 3), dtype=np.int64)
    # Those are numbers of VTK's own filters.
    others = {name: values for name, values in named.items() if not name.startswith("vtk")}
    return Mesh(surface.points, faces, normals=normals, uvs=uvs, attributes=others)


def to_pyvista(mesh: Mesh) -> Any:
    """Makes a ``pyvista.PolyData``, with the attributes as arrays of its points."""
    import pyvista

    points, faces = mesh.to_arrays()
    surface = pyvista.PolyData.from_regular_faces(points, faces)
    for name, values in mesh.attributes.items():
        own = np.array(values)
        if name == "normals":
            surface.point_data.active_normals = own
        elif name == "uvs":
            surface.active_texture_coordinates = own
        else:
            surface.point_data[name] = own[:, 0] if own.shape[1] == 1 else own
    return surface


def from_open3d(mesh: Any) -> Mesh:
    """Makes a mesh of an ``open3d.geometry.TriangleMesh``."""
    if not hasattr(mesh, "triangles") or not hasattr(mesh, "has_triangle_uvs"):
        kind = type(mesh).__name__
        raise MeshlodError(f"a {kind} is no open3d.geometry.TriangleMesh: use to_legacy() first")
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    colors = np.asarray(mesh.vertex_colors) if mesh.has_vertex_colors() else None
    if not mesh.has_triangle_uvs():
        return Mesh(points, faces, normals=normals, colors=colors)
    # Texture coordinates are those of corners: a point for each, at equal positions.
    corners = faces.reshape(-1)
    normals = None if normals is None else normals[corners]
    colors = None if colors is None else colors[corners]
    uvs = np.asarray(mesh.triangle_uvs)
    own = np.arange(len(corners)).reshape(-1, 3)
    return Mesh(points[corners], own, normals=normals, uvs=uvs, colors=colors)


def to_open3d(mesh: Mesh) -> Any:
    """Makes an ``open3d.geometry.TriangleMesh``."""
    import open3d

    points, faces = mesh.to_arrays()
    vectors = open3d.utility.Vector3dVector
    made = open3d.geometry.TriangleMesh(vectors(points), open3d.utility.Vector3iVector(faces))
    if mesh.normals is not None:
        made.vertex_normals = vectors(mesh.normals.astype(np.float64))
    if mesh.colors is not None:
        made.vertex_colors = vectors(mesh.colors[:, :3].astype(np.float64))
    if mesh.uvs is not None:
        uvs = mesh.uvs[faces.reshape(-1)].astype(np.float64)
        made.triangle_uvs = open3d.utility.Vector2dVector(uvs)
    return made


def from_meshio(mesh: Any) -> Mesh:
    """Makes a mesh of the triangles and quadrilaterals of a ``meshio.Mesh``."""
    faces = [block.data for block in mesh.cells if block.type == "triangle"]
    for block in mesh.cells:
        if block.type == "quad":
            faces += [block.data[:, [0, 1, 2]], block.data[:, [0, 2, 3]]]
        elif block.type in ("vertex", "line"):
            warn(f"left out: {len(block.data)} cells of type {block.type}")
        elif block.type != "triangle":
            raise MeshlodError(f"cells of type {block.type} are no surface: extract it first")
    if mesh.cell_data:
        warn(f"left out: data of cells ({', '.join(mesh.cell_data)})")
    points = mesh.points
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    all_faces = np.vstack(faces) if faces else np.zeros((0, 3), dtype=np.int64)
    named = dict(mesh.point_data)
    known = {name: named.pop(name, None) for name in ("normals", "uvs", "colors")}
    return Mesh(points, all_faces, **known, attributes=named)


def to_meshio(mesh: Mesh) -> Any:
    """Makes a ``meshio.Mesh`` of triangles, with the attributes as data of its points."""
    import meshio

    points, faces = mesh.to_arrays()
    data = {name: np.array(values) for name, values in mesh.attributes.items()}
    flat = {name: own[:, 0] if own.shape[1] == 1 else own for name, own in data.items()}
    return meshio.Mesh(points, [("triangle", faces)], point_data=flat)
