"""What may differ between a file and its copy in the same format, and why."""

from collections import Counter

# File names or endings of these, facts that may differ, and the reason.
MAY_DIFFER = [
    (
        ["big-a.obj", "big-b.obj", "medium-a.obj", "small-a.obj", "bream.obj", "clown.obj"],
        ["attributes in MeshLab"],
        "MeshLab has texture coordinates at vertices where v and vt have equal numbers; equal vt are "
        "written once",
    ),
    (
        ["fish-bream.obj", "fish-clown.obj", "pirate.obj", "skyscraper.obj", "sponza.obj"],
        ["library"],
        "the library that the file names is not there; the copy has one with the names of materials",
    ),
]

# Facts of which a tenth may have a part only, and the reason.
MAY_VANISH = [
    (
        ["pirate.obj", "skyscraper.obj", "sponza.obj"],
        ["objects", "materials", "smoothing groups"],
        "small parts vanish, with their objects and materials (--topology free)",
    ),
    (
        ["strip-mode5.gltf"],
        [
            "attributes",
            "materials of primitives",
            "morph targets",
            "meshes in trimesh",
            "materials in trimesh",
            "pictures in trimesh",
        ],
        "of its hundreds of small meshes some vanish whole: they stay, without primitives",
    ),
]


def is_allowed(name, part, fact, value, found):
    """Reports whether a fact of a copy is that of the file, or listed as what may differ."""
    if found == value or is_listed(MAY_DIFFER, name, fact):
        return True
    if part != "10 %" or not found or not is_listed(MAY_VANISH, name, fact):
        return False
    return not Counter(map(str, found)) - Counter(map(str, value))


def is_listed(entries, name, fact):
    return any(
        fact in facts and any(name.endswith(end) for end in names) for names, facts, _ in entries
    )
