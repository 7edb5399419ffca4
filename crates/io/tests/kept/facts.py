"""Facts of mesh files beside their geometry, as other programs and the text of the files have them."""

import json
import struct
from pathlib import Path

import numpy
import pymeshlab
import trimesh

ARRAYS = ["nodes", "meshes", "materials", "textures", "images", "skins", "animations", "cameras"]


def facts_of(path):
    """Returns the facts that stay in any level of a file, and the sizes that only a copy keeps."""
    kind = path.suffix
    if kind in (".gltf", ".glb"):
        return facts_of_gltf(path)
    if kind == ".smf":
        return facts_of_smf(path)
    facts = facts_of_obj(path) if kind == ".obj" else {}
    if kind == ".ply":
        facts = facts_of_ply(path)
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(str(path))
    mesh = meshes.current_mesh()
    facts["attributes in MeshLab"] = [
        name
        for name, is_there in [
            ("vertex colours", mesh.has_vertex_color()),
            ("face colours", mesh.has_face_color()),
            ("vertex scalars", mesh.has_vertex_scalar()),
            ("texture coordinates at corners", mesh.has_wedge_tex_coord()),
            ("texture coordinates at vertices", mesh.has_vertex_tex_coord()),
        ]
        if is_there
    ]
    facts["textures in MeshLab"] = sorted(Path(name).name for name in mesh.textures())
    return facts, sizes(mesh.vertex_matrix(), mesh.face_matrix())


def sizes(vertices, faces):
    """Vertices that no face uses count, too; bounds are rounded as 32-bit coordinates are."""
    bounds = numpy.array([vertices.min(axis=0), vertices.max(axis=0)], dtype=numpy.float32)
    return {"vertices": len(vertices), "faces": len(faces), "bounds": bounds.tolist()}


def facts_of_gltf(path):
    document = json_of(path)
    facts = {key: [named.get("name", "") for named in document.get(key, [])] for key in ARRAYS}
    facts["joints"] = [len(skin["joints"]) for skin in document.get("skins", [])]
    facts["channels"] = [len(own["channels"]) for own in document.get("animations", [])]
    facts["extensions"] = sorted(document.get("extensionsUsed", []))
    primitives = [p for mesh in document.get("meshes", []) for p in mesh["primitives"]]
    facts["attributes"] = [sorted(p["attributes"]) for p in primitives]
    facts["materials of primitives"] = [p.get("material") for p in primitives]
    facts["morph targets"] = [len(p.get("targets", [])) for p in primitives]
    scene = trimesh.load_scene(path, process=False, skip_materials=False)
    facts["meshes in trimesh"] = sorted(scene.geometry)
    materials = [getattr(mesh.visual, "material", None) for mesh in scene.geometry.values()]
    facts["materials in trimesh"] = sorted(str(getattr(own, "name", None)) for own in materials)
    facts["pictures in trimesh"] = sorted(str(picture_size(own)) for own in materials)
    faces = sum(len(mesh.faces) for mesh in scene.geometry.values())
    bounds = scene.bounds.astype(numpy.float32).tolist() if faces else []
    return facts, {"faces": faces, "bounds": bounds}


def picture_size(material):
    picture = getattr(material, "baseColorTexture", None)
    return picture and picture.size


def json_of(path):
    data = path.read_bytes()
    if data[:4] == b"glTF":
        (length,) = struct.unpack_from("<I", data, 12)
        data = data[20 : 20 + length]
    return json.loads(data)


def facts_of_obj(path):
    lines = path.read_text(errors="replace").splitlines()
    words = [line.split(None, 1) for line in lines]
    words = [(line[0], line[1].strip()) for line in words if len(line) == 2]

    def named(*keys):
        return sorted({rest for word, rest in words if word in keys})

    has_objects = bool(named("o"))
    facts = {
        "objects": named("o") if has_objects else named("g"),
        "materials": named("usemtl"),
        "smoothing groups": [group for group in named("s") if group not in ("off", "0")],
        "has normals": bool(named("vn")),
        "has texture coordinates": bool(named("vt")),
    }
    library = []
    for name in named("mtllib"):
        if (path.parent / name).is_file():
            library += (path.parent / name).read_text(errors="replace").splitlines()
    library = [" ".join(line.split()) for line in library]
    facts["library"] = sorted(line for line in library if line and not line.startswith("#"))
    return facts


def facts_of_ply(path):
    header = path.read_bytes().split(b"end_header")[0].decode("ascii", "replace").splitlines()
    words = [line.split() for line in header]
    element, properties = None, []
    for line in words:
        if line[:1] == ["element"]:
            element = line[1]
        elif line[:1] == ["property"] and line[-1] not in ("vertex_indices", "vertex_index"):
            properties.append((element, line[-1], line[1].replace("float32", "float")))
    remarks = [" ".join(line) for line in words if line[:1] in (["comment"], ["obj_info"])]
    return {"properties": sorted(properties), "comments": remarks}


def facts_of_smf(path):
    """No other program at hand reads SMF: its statements are counted as they are."""
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices = numpy.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
    faces = [line for line in lines if line[:1] in (["f"], ["t"])]
    binds = sorted({" ".join(line) for line in lines if line[:1] == ["bind"]})
    return {"bindings": binds}, sizes(vertices, faces)
