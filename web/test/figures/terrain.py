"""Textures a terrain: terrain.py IN.ply OUT.glb, where IN is a square grid of `meshlod sample`.

The photo is the terrain's own height in colours, shaded, with noise down to a pixel.
"""

import io
import json
import struct
import sys

import numpy as np
from PIL import Image

SIDE = 2048


def read(path):
    """Returns positions and faces of a binary PLY file of triangles."""
    data = open(path, "rb").read()
    head, body = data.split(b"end_header\n", 1)
    counts = [int(line.split()[2]) for line in head.split(b"\n") if line.startswith(b"element")]
    points = np.frombuffer(body, "<f4", 3 * counts[0]).reshape(-1, 3)
    face = np.dtype([("n", "u1"), ("of", "<u4", 3)])
    return points, np.frombuffer(body, face, counts[1], points.nbytes)["of"]


def photo(height):
    """Returns a JPEG of a height field."""
    small = Image.fromarray(height.astype(np.float32))
    field = np.asarray(small.resize((SIDE, SIDE), Image.BICUBIC))
    down, along = np.gradient(field * 2 * SIDE)
    shade = np.clip(0.7 + 0.1 * (down - along) / (1 + np.abs(down) + np.abs(along)), 0.3, 1)
    random = np.random.default_rng(1)
    for octave in range(3, 11):
        noise = Image.fromarray(random.normal(size=(1 << octave,) * 2).astype(np.float32))
        shade = shade + 0.02 * np.asarray(noise.resize((SIDE, SIDE), Image.BICUBIC))
    at = (field - field.min()) / np.ptp(field)
    colors = np.array([[60, 90, 40], [120, 110, 60], [130, 120, 110], [250, 250, 250]])
    stops = [0, 0.4, 0.7, 1]
    rgb = np.stack([np.interp(at, stops, colors[:, k]) for k in range(3)], -1)
    picture = Image.fromarray(np.clip(rgb * shade[..., None], 0, 255).astype(np.uint8))
    out = io.BytesIO()
    picture.save(out, "JPEG", quality=85)
    return out.getvalue()


def main(source, target):
    """Writes the textured terrain."""
    points, faces = read(source)
    up = int(np.argmin(np.ptp(points, axis=0)))
    flat = [k for k in range(3) if k != up]
    low = points.min(axis=0)
    uv = ((points[:, flat] - low[flat]) / np.ptp(points, axis=0)[flat]).astype("<f4")
    side = int(round(len(points) ** 0.5))
    order = np.lexsort((uv[:, 0], uv[:, 1]))
    image = photo(points[order, up].reshape(side, side))
    parts = [points.astype("<f4").tobytes(), uv.tobytes(), faces.astype("<u4").tobytes(), image]
    views, blob = [], b""
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(part)})
        blob += part + b"\0" * (-len(part) % 4)
    bounds = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", **bounds},
            {"bufferView": 1, "componentType": 5126, "count": len(points), "type": "VEC2"},
            {"bufferView": 2, "componentType": 5125, "count": 3 * len(faces), "type": "SCALAR"},
        ],
        "materials": [{"pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
        "textures": [{"source": 0}],
        "images": [{"bufferView": 3, "mimeType": "image/jpeg"}],
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    with open(target, "wb") as out:
        out.write(struct.pack("<5I", 0x46546C67, 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A))
        out.write(text + struct.pack("<2I", len(blob), 0x004E4942) + blob)


main(*sys.argv[1:])
