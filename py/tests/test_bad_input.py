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
        ({}, "give one of target_reduction, target_count and max_error, not none"),
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
        ({"target_count": 9, "progress": 3}, "progress must be a function or True, not 3"),
        ({"target_count": 9, "lossless": True}, "lossless is not supported: use max_error=0"),
    ],
)
def test_options(options, message):
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        meshlod.simplify(POINTS, FACES, **options)
    assert "\n" not in str(raised.value)


def test_an_object_that_is_no_mesh():
    with pytest.raises(meshlod.MeshlodError, match="not ndarray alone"):
        meshlod.simplify(POINTS, target_count=9)
    with pytest.raises(meshlod.MeshlodError, match="other must be a Mesh, not int"):
        meshlod.Mesh(POINTS, FACES).measure(3)
    with pytest.raises(meshlod.MeshlodError, match="not int"):
        meshlod.save("a.ply", 3)
