"""Types of calls, for mypy: nothing here runs."""

from typing import Any

import meshlod
import numpy as np
from meshlod import Mesh, Report, Scene
from numpy.typing import NDArray
from typing_extensions import assert_type

Points = NDArray[np.float64]
Faces = NDArray[np.int32]
Layers = dict[str, NDArray[Any]]


def meshes(mesh: Mesh, told: bool) -> None:
    assert_type(mesh.simplify(0.5), Mesh)
    assert_type(mesh.simplify(max_error="0.1%", method="qem", return_report=False), Mesh)
    assert_type(mesh.simplify(0.5, return_report=True), tuple[Mesh, Report])
    assert_type(mesh.simplify(0.5, return_report=told), Mesh | tuple[Mesh, Report])
    assert_type(mesh.repair(weld=0.1), Mesh)
    assert_type(mesh.repair(return_report=True), tuple[Mesh, dict[str, int]])
    assert_type(mesh.copy(), Mesh)
    assert_type(mesh.apply_transform(np.eye(4)), Mesh)
    assert_type(mesh.euler_number, int)


def scenes(scene: Scene) -> None:
    assert_type(scene.simplify(max_error=0.1), Scene)
    assert_type(scene.simplify(0.5, return_report=True), tuple[Scene, Report])


def arrays(points: Points, faces: Faces, uvs: NDArray[np.float32], mesh: Mesh) -> None:
    assert_type(meshlod.simplify(points, faces, 0.9), tuple[Points, Faces])
    assert_type(meshlod.simplify(points, faces, 0.9, uvs=None), tuple[Points, Faces])
    assert_type(meshlod.simplify(points, faces, 0.9, uvs=uvs), tuple[Points, Faces, Layers])
    with_report = meshlod.simplify(points, faces, max_error="1%", return_report=True)
    assert_type(with_report, tuple[Points, Faces, Report])
    with_all = meshlod.simplify(points, faces, 0.9, colors=uvs, return_report=True)
    assert_type(with_all, tuple[Points, Faces, Layers, Report])
    assert_type(meshlod.simplify(mesh, target_count=9), Mesh)
    assert_type(meshlod.simplify(mesh, target_count=9, return_report=True), tuple[Mesh, Report])


def mistakes(mesh: Mesh, scene: Scene) -> None:
    mesh.simplify(max_eror=0.1)  # type: ignore[call-overload]
    scene.simplify(0.5, locks=[0])  # type: ignore[call-overload]


def tiles() -> None:
    report = meshlod.tiles(["a.ply", "b.ply"], "out", tile_faces=20_000, lat=46.5, lon=8.0)
    assert_type(report, meshlod.TilesReport)
    assert_type(report.levels[0].error_proved, float)
    meshlod.tiles("a.ply", "out", tile_face=1)  # type: ignore[call-arg]
