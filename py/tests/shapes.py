"""Meshes for tests, as arrays and as a scene."""

import json

import numpy as np


def torus(around=60, across=30):
    """A closed torus: points and faces."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    ring = 2 + 0.7 * np.cos(b)
    points = np.stack([ring * np.cos(a), ring * np.sin(a), 0.7 * np.sin(b)], axis=-1)
    here = u * across + v
    right = (u + 1) % around * across + v
    up = u * across + (v + 1) % across
    both = (u + 1) % around * across + (v + 1) % across
    faces = np.stack([here, right, both, here, both, up], axis=-1).reshape(-1, 3)
    return points.reshape(-1, 3), faces


def sheet(n=20):
    """A square with a boundary: points, faces and texture coordinates."""
    x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    points = np.stack([x, y, 0.05 * np.sin(9 * x) * np.cos(7 * y)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij")
    here = i * n + j
    faces = np.stack([here, here + n, here + n + 1, here, here + n + 1, here + 1], axis=-1)
    return points, faces.reshape(-1, 3), points[:, :2].astype(np.float32)


def unrolled():
    """The torus with a texture seam: its first ring of points twice, with other coordinates."""
    points, faces = torus()
    across = 30
    ring = np.arange(across)
    uvs = np.stack([np.repeat(np.arange(60) / 60, across), np.tile(ring / across, 60)], axis=-1)
    copies = len(points) + ring
    points = np.vstack([points, points[ring]])
    uvs = np.vstack([uvs, np.stack([np.ones(across), ring / across], axis=-1)])
    last = faces >= 59 * across
    turns = last.any(axis=1)[:, None] & (faces < across)
    faces = np.where(turns, copies[np.minimum(faces, across - 1)], faces)
    return points, faces, uvs.astype(np.float32)


def edges(faces):
    """Number of faces at each edge."""
    sides = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(sides, axis=0, return_counts=True)[1]


def welded(points, faces):
    """Faces over distinct positions."""
    _, first = np.unique(points, axis=0, return_inverse=True)
    return first.reshape(-1)[faces]


def write_gltf(folder, mesh, places):
    """Writes a glTF file with one mesh of a red material, which nodes show at several places."""
    points, faces = mesh[0].astype("<f4"), mesh[1].astype("<u4")
    low, high = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    views = [
        {"buffer": 0, "byteLength": points.nbytes},
        {"buffer": 0, "byteOffset": points.nbytes, "byteLength": faces.nbytes},
    ]
    positions = {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"}
    indices = {"bufferView": 1, "componentType": 5125, "count": faces.size, "type": "SCALAR"}
    part = {"attributes": {"POSITION": 0}, "indices": 1, "material": 0}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(places))}],
        "nodes": [{"mesh": 0, "translation": [5 * i, 0, 0]} for i in range(places)],
        "materials": [{"name": "red"}],
        "meshes": [{"name": "torus", "primitives": [part]}],
        "buffers": [{"uri": "torus.bin", "byteLength": points.nbytes + faces.nbytes}],
        "bufferViews": views,
        "accessors": [{**positions, "min": low, "max": high}, indices],
    }
    (folder / "torus.bin").write_bytes(points.tobytes() + faces.tobytes())
    (folder / "torus.gltf").write_text(json.dumps(document))
    return folder / "torus.gltf"
