"""Cuts that follow a camera."""

import threading

import numpy as np
import pytest
from shapes import edges, torus, unrolled, welded

import meshlod


@pytest.fixture(params=["bare", "textured"])
def model(request, tmp_path):
    if request.param == "bare":
        return meshlod.Mesh(*torus(120, 60)).build(tmp_path / "torus.mlod", lossless=True)
    points, faces, uvs = unrolled()
    mesh = meshlod.Mesh(points, faces, uvs=uvs)
    return mesh.build(tmp_path / "unrolled.mlod", lossless=True)


def views(count=12):
    for turn in np.linspace(0, 3, count):
        eye = (9 * np.cos(turn), 9 * np.sin(turn), 2)
        yield meshlod.Camera(eye=eye, look=(2, 0, 0), up=(0, 0, 1))


def shown(triangles):
    """The triangles of a list, without empty slots, in an order of their own."""
    full = triangles[triangles[:, 0] >= 0]
    turns = np.argmin(full, axis=1)[:, None] + np.arange(3)
    turned = np.take_along_axis(full, turns % 3, axis=1)
    return turned[np.lexsort(turned.T)]


def patched(triangles, change):
    """A list of triangles after a change, which may add slots."""
    more = int(change.slots[-1]) + 1 - len(triangles) if len(change.slots) else 0
    if more > 0:
        triangles = np.vstack([triangles, np.full((more, 3), -1, np.int32)])
    triangles[change.slots] = change.triangles
    return triangles


def test_patches_make_the_level(model):
    cut = model.cut()
    mine = cut.triangles.copy()
    coarsest = cut.face_count
    assert len(shown(mine)) == coarsest
    finer = 0
    for camera in views():
        change = cut.update(camera=camera)
        assert change.done and change.slots.dtype == np.uint32
        assert (np.diff(change.slots.astype(int)) > 0).all()
        mine = patched(mine, change)
        assert (shown(mine) == shown(cut.triangles)).all()
        assert (edges(welded(cut.vertices, shown(mine))) == 2).all()
        finer = max(finer, cut.face_count)
    assert finer > 2 * coarsest
    still = cut.update(camera=camera)
    assert still.done and len(still.slots) == still.splits == still.merges == 0
    assert still.triangles.shape == (0, 3)


def test_the_smallest_cut_does_not_depend_on_the_way(model):
    followed, cameras = model.cut(), list(views())
    for camera in cameras:
        followed.update(camera=camera)
    fresh = model.cut()
    fresh.update(camera=cameras[-1])
    assert (shown(followed.triangles) == shown(fresh.triangles)).all()
    extracted = model.extract(camera=cameras[-1], verify=False)
    assert len(extracted.faces) == fresh.face_count


def test_tables_have_positions_and_attributes(model):
    cut = model.cut()
    cut.update(error=0.0)
    level, points = cut.mesh(), cut.vertices
    assert cut.face_count == len(level.faces) == len(model.extract().faces)
    assert cut.triangles.max() < len(points) and not points.flags.writeable
    assert cut.vertices is points
    assert set(cut.attributes) == set(level.attributes)
    rows = shown(cut.triangles).reshape(-1)
    for name, values in cut.attributes.items():
        assert len(values) == len(points)
        corners = np.hstack([points[rows], values[rows]]).astype(np.float32)
        theirs = level.faces.reshape(-1)
        also = np.hstack([level.vertices[theirs], level.attributes[name][theirs]])
        found = np.unique(corners, axis=0)
        assert np.allclose(found, np.unique(also.astype(np.float32), axis=0))
    assert cut.materials is None


def test_materials_are_those_of_the_faces(tmp_path):
    from shapes import write_gltf

    mesh = meshlod.Scene.load(write_gltf(tmp_path, torus(), 1)).meshes[0][1]
    cut = mesh.build(tmp_path / "red.mlod").cut()
    names, of_vertices = cut.materials
    assert names == mesh.materials[0] and len(of_vertices) == len(cut.vertices)
    assert not of_vertices.any()


def test_limits_stop_an_update(model):
    cut = model.cut()
    mine = cut.triangles.copy()
    steps = 0
    while True:
        change = cut.update(error=0.0, changes=50)
        mine = patched(mine, change)
        assert change.splits + change.merges <= 50
        assert (shown(mine) == shown(cut.triangles)).all()
        assert (edges(welded(cut.vertices, shown(mine))) == 2).all()
        steps += 1
        if change.done:
            break
    assert steps > 5
    assert not model.cut().update(error=0.0, seconds=0).done
    assert model.cut().update(error=0.0, seconds=1e300).done


def test_an_error_has_two_names_and_may_be_a_percentage(model):
    by_length, by_part = model.cut(), model.cut()
    by_length.update(error=0.01 * np.linalg.norm(model.extract().extents))
    by_part.update(max_error="1%")
    assert by_part.face_count == by_length.face_count
    by_part.update(max_error=0.0)
    assert by_part.face_count > by_length.face_count


def test_threads_share_a_cut(model):
    cut, cameras = model.cut(), list(views(40))
    failed = []

    def work(mine):
        try:
            for camera in mine:
                cut.update(camera=camera)
                assert cut.face_count > 0 and len(cut.vertices) > 0
        except BaseException as error:
            failed.append(error)

    threads = [threading.Thread(target=work, args=(cameras[k::4],)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
        assert not thread.is_alive()
    assert not failed


def test_what_is_wrong_is_told(model, tmp_path):
    cut = model.cut()
    for arguments, text in [
        ({"error": -1.0}, "at least 0"),
        ({"error": "fine"}, "error must be a number"),
        ({"max_error": "1%", "camera": next(views())}, "max_error is in pixels where there is a"),
        ({"max_error": 1.0, "error": 1.0}, "error is another name of max_error"),
        ({"camera": 3}, "camera must be a Camera"),
        ({"focus": 3}, "focus must be"),
        ({"changes": -1}, "changes must be between 0"),
        ({"seconds": -1.0}, "seconds must be at least 0"),
        ({"seconds": float("nan")}, "seconds must be at least 0"),
    ]:
        with pytest.raises(meshlod.MeshlodError, match=text):
            cut.update(**arguments)
    with pytest.raises(meshlod.MeshlodError, match="Model.cut"):
        meshlod.Cut()
    half = tmp_path / "half.mlod"
    data = open(model.path, "rb").read()
    half.write_bytes(data[: len(data) * 2 // 3])
    with pytest.warns(meshlod.MeshlodWarning, match="truncated"):
        coarse = meshlod.Model(half).cut()
    assert coarse.update(error=0.0).done
    cut.update(error=0.0)
    assert 0 < coarse.face_count <= cut.face_count
