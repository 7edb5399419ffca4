"""Meshes of other packages: trimesh, pyvista, open3d and meshio, which are imported when needed.

What has no place on the other side is named in a :class:`MeshlodWarning`: attributes of faces,
textures, sets. Not counted are metadata, and what follows from the geometry, such as normals of
faces.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np

from ._errors import MeshlodError, warn_left_out
from ._mesh import Mesh


def adopted(mesh: Any) -> tuple[Mesh, Callable[[Mesh], Any]]:
    """Returns a mesh of another package as one of this package, and the way back."""
    for base in type(mesh).__mro__:
        package = base.__module__.split(".")[0]
        if package == "trimesh":
            own, left_out = _of_trimesh(mesh)
            warn_left_out(left_out)
            return own, lambda level: to_trimesh(level, like=mesh)
        if package == "pyvista":
            return from_pyvista(mesh), to_pyvista
        if package == "open3d":
            return from_open3d(mesh), to_open3d
        if package == "meshio":
            return from_meshio(mesh), to_meshio
    kind = type(mesh).__name__
    raise MeshlodError(f"give points and faces, or a mesh of a known package, not {kind} alone")


def from_trimesh(mesh: Any) -> Mesh:
    """Makes a mesh of a ``trimesh.Trimesh``, with texture coordinates or colours of vertices, and
    with attributes of vertices. Its material stays behind; :func:`meshlod.simplify` keeps it.
    """
    own, left_out = _of_trimesh(mesh)
    if own.uvs is not None and getattr(mesh.visual, "material", None) is not None:
        left_out.append("the material with its textures")
    warn_left_out(left_out)
    return own


def _of_trimesh(mesh: Any) -> tuple[Mesh, list[str]]:
    """Returns a mesh, and names of what it leaves out beside the material."""
    if not hasattr(mesh, "faces"):
        kind = type(mesh).__name__
        advice = ": use to_mesh() first" if hasattr(mesh, "to_mesh") else ""
        raise MeshlodError(f"from_trimesh takes a trimesh.Trimesh, not {kind}{advice}")
    known: dict[str, Any] = {}
    left_out: list[str] = []
    visual = mesh.visual
    look = getattr(visual, "kind", None)
    if look == "texture" and visual.uv is not None:
        known["uvs"] = visual.uv
    elif look == "vertex":
        known["colors"] = np.asarray(visual.vertex_colors)
    elif look == "face":
        left_out.append("colours of faces")
    arrays, unheld = _held_of(mesh.vertex_attributes, known)
    left_out += _listed("attributes of vertices", unheld)
    left_out += _listed("attributes of faces", mesh.face_attributes)
    return Mesh(mesh.vertices, mesh.faces, **arrays), left_out


def to_trimesh(mesh: Mesh, *, like: Any = None) -> Any:
    """Makes a ``trimesh.Trimesh``, with the material and metadata of ``like``.

    Attributes become ``vertex_attributes``, and so do colours beside texture coordinates.
    """
    import trimesh

    points, faces = mesh.to_arrays()
    named = _held(mesh)
    normals, uvs, colors = (named.pop(name, None) for name in ("normals", "uvs", "colors"))
    visual: Any = None
    if uvs is not None:
        material = getattr(getattr(like, "visual", None), "material", None)
        visual = trimesh.visual.TextureVisuals(uv=uvs, material=material)
        if colors is not None:
            named["colors"] = colors
    elif colors is not None:
        bytes_of = np.rint(np.clip(colors, 0, 1) * 255).astype(np.uint8)
        visual = trimesh.visual.ColorVisuals(vertex_colors=bytes_of)
    warn_left_out(_labels(mesh))
    return trimesh.Trimesh(
        points,
        faces,
        vertex_normals=normals,
        visual=visual,
        vertex_attributes=named,
        metadata=None if like is None else dict(like.metadata),
        process=False,
    )


#: Names of normals and texture coordinates in pyvista, unless others are active.
NORMALS, UVS = "Normals", "Texture Coordinates"


def from_pyvista(mesh: Any) -> Mesh:
    """Makes a mesh of the surface of a ``pyvista`` data set, with the arrays of its points."""
    import pyvista

    if not isinstance(mesh, pyvista.DataSet):
        kind = type(mesh).__name__
        advice = ": use combine() first" if hasattr(mesh, "combine") else ""
        raise MeshlodError(f"from_pyvista takes a pyvista data set, not {kind}{advice}")
    surface = mesh
    if not isinstance(mesh, pyvista.PolyData):
        surface = mesh.extract_surface(pass_pointid=False, pass_cellid=False)
    left_out = [f"lines ({surface.n_lines})"] if surface.n_lines else []
    left_out += [f"vertices of their own ({surface.n_verts})"] if surface.n_verts else []
    left_out += _listed("arrays of cells", surface.cell_data.keys())
    left_out += _listed("arrays of the data set", surface.field_data.keys())
    if not surface.is_all_triangles:
        surface = surface.triangulate()
    named = dict(surface.point_data.items())
    normals_name = surface.point_data.active_normals_name or NORMALS
    uvs_name = surface.point_data.active_texture_coordinates_name or UVS
    known = {"normals": named.pop(normals_name, None), "uvs": named.pop(uvs_name, None)}
    faces = surface.regular_faces if surface.faces.size else np.zeros((0, 3), dtype=np.int64)
    arrays, unheld = _held_of(named, known)
    warn_left_out(left_out + _listed("arrays of points", unheld))
    return Mesh(surface.points, faces, **arrays)


def to_pyvista(mesh: Mesh) -> Any:
    """Makes a ``pyvista.PolyData``, with the attributes as arrays of its points."""
    import pyvista

    points, faces = mesh.to_arrays()
    surface = pyvista.PolyData.from_regular_faces(points, faces)
    warn_left_out(_labels(mesh))
    for name, own in _held(mesh).items():
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
        advice = ": use to_legacy() first" if hasattr(mesh, "to_legacy") else ""
        raise MeshlodError(f"from_open3d takes an open3d TriangleMesh, not {kind}{advice}")
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    colors = np.asarray(mesh.vertex_colors) if mesh.has_vertex_colors() else None
    left_out = ["textures"] if mesh.has_textures() else []
    left_out += ["materials of triangles"] if mesh.has_triangle_material_ids() else []
    warn_left_out(left_out)
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
    """Makes an ``open3d.geometry.TriangleMesh``, whose colours have no opacity."""
    import open3d

    points, faces = mesh.to_arrays()
    others = [name for name in mesh.attributes if name not in ("normals", "uvs", "colors")]
    left_out = _listed("attributes", others)
    if mesh.colors is not None and mesh.colors.shape[1] == 4 and (mesh.colors[:, 3] != 1).any():
        left_out.append("opacity of colours")
    warn_left_out(left_out + _labels(mesh))
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
    if not hasattr(mesh, "cells") or not hasattr(mesh, "point_data"):
        raise MeshlodError(f"from_meshio takes a meshio.Mesh, not {type(mesh).__name__}")
    faces = [block.data for block in mesh.cells if block.type == "triangle"]
    left_out = []
    for block in mesh.cells:
        if block.type == "quad":
            faces += [block.data[:, [0, 1, 2]], block.data[:, [0, 2, 3]]]
        elif block.type in ("vertex", "line"):
            left_out.append(f"{len(block.data)} cells of type {block.type}")
        elif block.type != "triangle":
            raise MeshlodError(f"cells of type {block.type} are no surface: extract it first")
    left_out += _listed("data of cells", mesh.cell_data)
    left_out += _listed("sets of points", mesh.point_sets or ())
    left_out += _listed("sets of cells", mesh.cell_sets or ())
    left_out += _listed("data of the mesh", mesh.field_data or ())
    points = mesh.points
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    all_faces = np.vstack(faces) if faces else np.zeros((0, 3), dtype=np.int64)
    arrays, unheld = _held_of(mesh.point_data, {})
    warn_left_out(left_out + _listed("data of points", unheld))
    return Mesh(points, all_faces, **arrays)


def to_meshio(mesh: Mesh) -> Any:
    """Makes a ``meshio.Mesh`` of triangles, with the attributes as data of its points."""
    import meshio

    points, faces = mesh.to_arrays()
    warn_left_out(_labels(mesh))
    data = _held(mesh)
    flat = {name: own[:, 0] if own.shape[1] == 1 else own for name, own in data.items()}
    return meshio.Mesh(points, [("triangle", faces)], point_data=flat)


#: Numbers of columns of the attributes that meshes know.
WIDTHS = {"normals": (3,), "uvs": (2,), "colors": (3, 4)}


def _held_of(
    named: Mapping[str, Any], known: Mapping[str, Any]
) -> tuple[dict[str, Any], list[str]]:
    """Returns attributes as a mesh takes them, and the names of arrays that it cannot hold.

    ``known`` are those whose meaning the package knows; others are recognized by their names.
    """
    taken = {name: values for name, values in known.items() if values is not None}
    others: dict[str, Any] = {}
    unheld = []
    for name, values in named.items():
        array = np.asarray(values)
        is_numbers = array.dtype.kind in "fiub" and array.ndim in (1, 2) and bool(name)
        if is_numbers and name not in WIDTHS:
            others[name] = array
        elif is_numbers and name not in taken and _fits(name, array):
            taken[name] = array
        else:
            unheld.append(name)
    return {**taken, "attributes": others}, unheld


def _fits(name: str, array: Any) -> bool:
    is_color = array.dtype.kind == "f" or array.dtype == np.uint8
    return array.ndim == 2 and array.shape[1] in WIDTHS[name] and (name != "colors" or is_color)


def _held(mesh: Mesh) -> dict[str, Any]:
    """Returns copies of the attributes of a mesh."""
    return {name: np.array(values) for name, values in mesh.attributes.items()}


def _listed(what: str, names: Collection[str]) -> list[str]:
    """Returns a list of names in words, if there are any."""
    return [f"{what} ({', '.join(names)})"] if len(names) else []


def _labels(mesh: Mesh) -> list[str]:
    """Names the labels of faces, which go into none of the packages."""
    named = {"names of materials": mesh.materials, "names of objects": mesh.objects}
    return [what for what, labels in named.items() if labels is not None]
