"""Live views of models in notebooks, and pictures of them where nothing runs scripts."""

from __future__ import annotations

import json
import os
import tempfile
from base64 import b64encode
from html import escape

from . import _native
from ._mesh import Mesh

#: Height of a view in a notebook, in pixels.
HEIGHT = 420
#: Most faces of a mesh in a view; of a finer one a level is shown.
MOST_FACES = 100_000
#: Greatest size of a file of levels in a view, in bytes: a notebook keeps what its cells show.
MOST_BYTES = 16_000_000


def frame(page: str, label: str, picture: bytes | None) -> str:
    """Returns HTML with a page in a frame, which may run its scripts and no more.

    Below the frame is a picture, which is seen where frames are left out, as on GitHub and in
    notebooks that are not trusted.
    """
    style = "position: absolute; inset: 0; width: 100%; height: 100%; border: 0"
    live = (
        f'<iframe srcdoc="{escape(page)}" sandbox="allow-scripts" title="{escape(label)}" '
        f'style="{style}"></iframe>'
    )
    still = ""
    if picture is not None:
        data = b64encode(picture).decode("ascii")
        still = (
            f'<img src="data:image/png;base64,{data}" alt="{escape(label)}" '
            f'style="max-height: 100%">'
        )
    return f'<div style="position: relative; height: {HEIGHT}px">{still}{live}</div>'


def of_file(path: str, picture: bytes | None) -> str | None:
    """Returns a view of a ``.mlod`` file, or nothing if it is too large for a notebook."""
    if os.path.getsize(path) > MOST_BYTES:
        return None
    with tempfile.TemporaryDirectory() as folder:
        page = os.path.join(folder, "view.html")
        json.loads(_native.answer(["meshlod", "page", path, page]))
        with open(page, encoding="utf-8") as file:
            return frame(file.read(), os.path.basename(path), picture)


def of_mesh(mesh: Mesh, picture: bytes | None) -> str | None:
    """Returns a view of a mesh, or of a level of one with many faces."""
    if len(mesh.faces) == 0:
        return None
    if len(mesh.faces) > MOST_FACES:
        mesh = mesh.simplify(target_count=MOST_FACES)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "mesh.mlod")
        mesh.build(path, errors="estimate")
        return of_file(path, picture)


def bundle(view: str | None, picture: bytes | None, text: str) -> dict[str, object]:
    """Returns what a notebook may choose from: a live view, a picture, or text."""
    found: dict[str, object] = {"text/plain": text}
    if picture is not None:
        found["image/png"] = picture
    if view is not None:
        found["text/html"] = view
    return found
