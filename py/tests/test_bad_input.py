"""Arrays and options that are wrong: an exception with one line that says what and where."""

import meshlod
import numpy as np
import pytest
from shapes import torus

POINTS, FACES = torus(12, 8)


def changed(array, row, column, value):
    array = array.copy()
    array[row, column] = value
    return array


@pytest.mark.parametrize(
    ("points", "faces", "message"),
    [
        (POINTS[:, :2], FACES, r"points must have the shape \(n, 3\), not \(96, 2\)"),
        (POINTS.ravel(), FACES, r"points must have the shape \(n, 3\), not \(288,\)"),
        (POINTS, FACES[:, :2], r"faces must have the shape \(n, 3\).*triangulate"),
        (POINTS, np.tile(FACES, 2), r"faces must have the shape \(n, 3\), not \(192, 6\)"),
        (POINTS.astype(complex), FACES, "points must be numbers, not complex128"),
        (POINTS.astype(str), FACES, "points must be numbers, not <U"),
        (POINTS.astype(object), FACES, "points must be numbers, not object"),
        (POINTS > 0, FACES, "points must be numbers, not bool"),
        (POINTS, FACES.astype(float), "faces must be integers, not float64"),
        (POINTS, changed(FACES, 5, 1, -1), "faces: row 5 has an index below 0"),
        (POINTS, changed(FACES, 6, 2, 96), "faces: row 6 refers to point 96, but there are only"),
        (POINTS, changed(FACES, 7, 2, 2**40), "faces: row 7 has an index .* above the last of 96"),
        (
            POINTS,
            changed(FACES.astype(np.uint64), 8, 0, 2**63 + 1),
            "faces: row 8 has an index that is no index",
        ),
        (changed(POINTS, 9, 1, np.nan), FACES, "points: row 9 is not finite"),
        (changed(POINTS, 4, 2, -np.inf), FACES, "points: row 4 is not finite"),
        (POINTS * 1e200, FACES, "scale the mesh"),
        (POINTS, [], "the mesh has no faces"),
        ([], [], "the mesh has no faces"),
        ([], FACES, "faces: row 0 refers to point 0, but there are only 0"),
        (POINTS, np.zeros((4, 3), dtype=int), "none of the 4 faces has three different"),
        ([[0, 0, 0], [1, 2]], FACES, "points is no array"),
        (np.ma.masked_less(POINTS, 0), FACES, "points has masked values"),
        (None, FACES, "points must have the shape"),
        ("points", FACES, "points must have the shape"),
    ],
)
def test_arrays(points, faces, message):
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        meshlod.simplify(points, faces, 0.5)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "^give target_reduction, target_count or max_error$"),
        ({"target_reduction": 0.5, "target_count": 9}, "target_reduction and target_count"),
        ({"target_reduction": 1.5}, "must be between 0 and 1, not 1.5"),
        ({"target_reduction": float("nan")}, "must be between 0 and 1, not nan"),
        ({"target_reduction": "half"}, "must be a number, not 'half'"),
        ({"target_count": -1}, "target_count must be between 0 and .*, not -1"),
        ({"target_count": 1.5}, "must be a whole number, not 1.5"),
        ({"target_count": True}, "must be between 0 and .*, not True"),
        ({"target_count": 2**70}, "target_count must be between"),
        ({"max_error": -0.1}, "must be at least 0, not -0.1"),
        ({"max_error": float("nan")}, "must be at least 0, not nan"),
        ({"max_error": "-1%"}, "max_error must be at least 0, not -1%"),
        ({"max_error": "small"}, 'a percentage of the diagonal such as "0.1%", not \'small\''),
        ({"max_error": "%"}, "max_error must be a number, or a percentage .* not '%'"),
        ({"target_count": 9, "method": "best"}, "method must be one of qem, .* not best"),
        ({"target_count": 9, "topology": "any"}, "topology must be free or keep, not any"),
        ({"target_count": 9, "uvs": POINTS}, r"uvs must have the shape \(n, 2\), not \(96, 3\)"),
        ({"target_count": 9, "uvs": POINTS[:5, :2]}, "uvs has 5 rows, but there are 96 points"),
        ({"target_count": 9, "uvs": POINTS[:, :2] * np.nan}, "uvs: row 0 is not finite"),
        ({"target_count": 9, "normals": POINTS * 1e60}, "normals: row 0 is not finite"),
        ({"target_count": 9, "colors": FACES[:96]}, "colors must be floats from 0 to 1, or uint8"),
        ({"target_count": 9, "attributes": {"uvs": POINTS}}, "uvs has a parameter of its own"),
        ({"target_count": 9, "attributes": {"id": np.full(96, 2**30)}}, "id: whole numbers must"),
        ({"target_count": 9, "attributes": {"t": np.zeros((96, 0))}}, "t: 0 values, but each"),
        ({"target_count": 9, "locks": [96]}, "locks: there is no point 96, only 96"),
        ({"target_count": 9, "locks": [-1]}, "locks: there is no point -1, only 96"),
        ({"target_count": 9, "locks": [True]}, "locks: a mask of 1 rows, but there are 96 points"),
        ({"target_count": 9, "locks": [0.5]}, "locks must be a mask or rows of points"),
        ({"target_count": 9, "weights": (-1, 0, 0)}, "the weight must be a number of at least 0"),
        ({"target_count": 9, "weights": (1, 2)}, r"weights must be three numbers, not \(1, 2\)"),
        ({"target_count": 9, "weights": "abc"}, "weights must be three numbers, not 'abc'"),
        ({"target_count": 9, "method": 3}, "method must be a string, not 3"),
        ({"target_count": 9, "topology": None}, "topology must be a string, not None"),
        ({"target_count": 9, "attributes": [POINTS]}, "attributes must be a dictionary"),
        ({"target_count": 9, "attributes": {"": POINTS}}, "a name must be a string that is not"),
        ({"target_count": 9, "attributes": {3: POINTS}}, "a name must be a string .* not 3"),
        ({"max_error": 10**400}, "max_error must be a number, .*, not 1000"),
        ({"target_count": 9, "progress": 3}, "progress must be a function or True, not 3"),
        ({"target_count": 9, "lossless": True}, "lossless is not supported: use max_error=0"),
    ],
)
def test_options(options, message):
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        meshlod.simplify(POINTS, FACES, **options)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda mesh, _: mesh.render(size=(1, 2, 3)), "size must be a width and a height"),
        (lambda mesh, _: mesh.render(size=5), "size must be a width and a height, not 5"),
        (lambda mesh, _: mesh.render(size=(640.0, 480)), "size must be a whole number, not 640.0"),
        (lambda mesh, _: mesh.render(direction=(0, 0, 0)), "direction must have a length"),
        (lambda mesh, _: mesh.render(direction=(0, np.nan, 0)), "direction must have a length"),
        (lambda mesh, _: mesh.render(direction=(1, 0)), "direction must be three numbers"),
        (lambda mesh, _: mesh.render(up="x"), "up must be y or z, not x"),
        (lambda mesh, _: mesh.render(up=3), "up must be a string, not 3"),
        (lambda mesh, to: mesh.compress(to / "a.mlz", max_error="a"), "max_error must be a number"),
        (lambda mesh, to: mesh.compress(to / "a.mlz", bits=1), "bits must be between 2 and 24"),
        (lambda mesh, to: mesh.build(to / "a.mlod", errors=3), "errors must be a string, not 3"),
        (lambda mesh, _: mesh.strip(quality=None), "quality must be a string, not None"),
        (lambda mesh, _: mesh.lods(0.5), "ratios must be numbers in a row, not 0.5"),
        (lambda mesh, _: mesh.lods(["a"]), "ratios must be a number, not 'a'"),
        (lambda mesh, _: mesh.repair(weld="a"), "weld must be a number, not 'a'"),
        (lambda _, __: meshlod.Scene(3), "a Scene is made of a Mesh, not int"),
    ],
)
def test_what_is_done_to_meshes(tmp_path, wrong, message):
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        wrong(meshlod.Mesh(POINTS, FACES), tmp_path)
    assert "\n" not in str(raised.value) and list(tmp_path.iterdir()) == []


def test_cameras(tmp_path):
    model = meshlod.Mesh(POINTS, FACES).build(tmp_path / "a.mlod")
    at = {"eye": (0, 0, 9), "look": (0, 0, 0)}
    for camera, message in [
        (meshlod.Camera(**at, size=(640.0, 480)), "size must be a whole number, not 640.0"),
        (meshlod.Camera(**at, size=(0, 480)), "size must be between 1"),
        (meshlod.Camera(**at, fov="wide"), "fov must be a number, not 'wide'"),
        (meshlod.Camera(**at, fov=60), "fov is in radians, and must be less than pi, not 60"),
        (meshlod.Camera(eye=(1, 2), look=(0, 0, 0)), "eye must be three numbers"),
        (at, "camera must be a Camera, not dict"),
    ]:
        with pytest.raises(meshlod.MeshlodError, match=message):
            model.extract(camera=camera)


def test_an_object_that_is_no_mesh():
    with pytest.raises(meshlod.MeshlodError, match="not ndarray alone"):
        meshlod.simplify(POINTS, target_count=9)
    with pytest.raises(meshlod.MeshlodError, match="other must be a Mesh, not int"):
        meshlod.Mesh(POINTS, FACES).measure(3)
    with pytest.raises(meshlod.MeshlodError, match="not int"):
        meshlod.save("a.ply", 3)


@pytest.mark.parametrize(
    ("second", "message"),
    [(0.9, "write target_reduction=0.9$"), (100, "write target_count=100$")],
)
def test_a_target_in_place_of_faces(second, message):
    with pytest.raises(meshlod.MeshlodError, match=message):
        meshlod.simplify(meshlod.Mesh(POINTS, FACES), second)
