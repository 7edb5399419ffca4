"""Flocks, cameras and arguments that are wrong: one line that says what and where."""

import meshlod
import numpy as np
import pytest
from meshlod import flock
from shapes import torus

CAMERA = meshlod.Camera(eye=(0, 0, 6), look=(0, 0, 0), size=(640, 480))


@pytest.fixture(scope="module")
def table():
    return flock.LevelTable(meshlod.Mesh(*torus(20, 10)), directions=3)


def row(count):
    """Members one behind the other, away from the camera."""
    positions = np.zeros((count, 3))
    positions[:, 2] = -4 * np.arange(count)
    return flock.Flock(positions, np.tile([1.0, 0, 0], (count, 1)))


GOOD = {"positions": np.zeros((3, 3)), "headings": np.ones((3, 3))}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"positions": np.zeros((3, 2))}, r"positions must have the shape \(n, 3\), not \(3, 2\)"),
        ({"positions": np.zeros((2, 3))}, "headings has 3 rows, but there are 2 positions"),
        ({"positions": np.full((3, 3), np.nan)}, "positions: row 0 must be finite"),
        ({"positions": np.full((3, 3), 1e9)}, "within a million body lengths"),
        ({"headings": np.zeros((3, 3))}, "headings: row 0 must have a direction"),
        ({"headings": [[1, 0, 0], [np.nan, 0, 0], [1, 0, 0]]}, "headings: row 1 must have"),
        ({"headings": [["a"] * 3] * 3}, "headings must be numbers"),
        ({"speeds": np.zeros(2)}, r"speeds must have the shape \(3,\), not float64 of \(2,\)"),
        ({"speeds": [0, np.inf, 0]}, "speeds: row 1 is not finite"),
        ({"body_length": 0}, "body_length must be greater than 0, not 0"),
        ({"body_length": "long"}, "body_length must be a number, not 'long'"),
        ({"up": "x"}, "up must be y or z, not x"),
        ({"speeds": [[1], [1, 2]]}, "speeds is no array"),
        ({"speeds": np.ma.masked_greater([0.0, 1, 2], 1)}, "speeds has masked values"),
        ({"schools": [3]}, "schools must be Schools with a range of members, not 3"),
        ({"schools": 5}, "schools must be a sequence of Schools, not 5"),
        ({"schools": None}, "schools must be a sequence of Schools, not None"),
        (
            {"schools": [flock.School(range(2, 9), (0, 0, 0), (1, 0, 0), (1, 1, 1))]},
            "school 0: members 2 to 9 must come after .* among 3",
        ),
        (
            {"schools": [flock.School(range(3), (0, 0, 0), (1, 0, 0), (1, -1, 1))]},
            "school 0: leader and radii must be finite",
        ),
        (
            {"schools": [flock.School(range(0, 3, 2), (0, 0, 0), (1, 0, 0), (1, 1, 1))]},
            "a school's members must be consecutive",
        ),
    ],
)
def test_members_that_are_wrong(table, changes, message):
    members = flock.Flock(**{**GOOD, **changes})
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        flock.Selector(table).select(members, CAMERA)
    assert "\n" not in str(raised.value)
    if not changes.keys() & {"speeds", "schools"} and "million" not in message:
        with pytest.raises(meshlod.MeshlodError, match=message):
            members.transforms()


def test_members_show_how_many_they_are():
    assert repr(row(3)) == "Flock(3 members)"
    assert repr(flock.Flock(None, None)) == "Flock(positions=None)"


LEVELS = np.zeros(2, np.uint16)

#: Matrix that moves by (1, 2, 3), for columns.
MOVED = np.eye(4)
MOVED[:3, 3] = 1, 2, 3


def seen(**changes):
    return flock.FlockCamera(eye=(0, 0, 9), look=(0, 0, 0), **changes)


def looking(**changes):
    return meshlod.Camera(**{"eye": (0, 0, 9), "look": (0, 0, 0), **changes})


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda _: flock.LevelTable(3), "a LevelTable is made of a Mesh, not int"),
        (lambda t: flock.LevelTable(t.mesh(0), forward=(0, 1, 0)), "forward and up axes must be"),
        (lambda t: flock.LevelTable(t.mesh(0), step=2), "the step must be between 0.1 and 0.9"),
        (lambda t: flock.LevelTable(t.mesh(0), method="best"), "method must be one of .*not best"),
        (lambda t: flock.LevelTable(t.mesh(0), directions=99), "directions must be between 2 and"),
        (lambda t: t.mesh(10**6), "level must be between 0 and"),
        (lambda _: flock.Selector(3), "table must be a LevelTable, not int"),
        (lambda t: flock.Selector(t, "best"), "policy must be one of none, .*, ours, not best"),
        (lambda t: flock.Selector(t).select(3, CAMERA), "flock must be a Flock, not int"),
        (lambda t: flock.Selector(t).select(row(2), 3), "camera must be a Camera, not int"),
        (
            lambda t: flock.Selector(t).select(row(2), looking(up=(1, 1, 0))),
            r"up must be that of the flock, \+y",
        ),
        (
            lambda t: flock.Selector(t).select(row(2), looking(up=(0, 0, 1))),
            "up must not be parallel to its view$",
        ),
        (
            lambda t: flock.Selector(t).select(row(2), looking(eye=(0, 9, 0))),
            r"parallel to its view: take \(0.0, 0.0, -1.0\)",
        ),
        (lambda t: flock.Selector(t).select(row(2), looking(up=(0, 0, 0))), "have a length"),
        (lambda t: flock.Selector(t).select(row(2), looking(up=(0, np.nan, 0))), "up must be fin"),
        (
            lambda t: flock.Selector(t).select(row(2), seen(gaze=3)),
            "gaze must be two numbers, not 3",
        ),
        (
            lambda t: flock.Selector(t).select(row(2), seen(gaze=(1, 2, 3))),
            r"gaze must be two numbers, not \(1, 2, 3\)",
        ),
        (lambda t: flock.Selector(t).select(row(2), looking(fov=60)), "fov is in radians, .* 60"),
        (lambda t: flock.Selector(t).select(row(2), looking(fov=3)), "field of view must be"),
        (lambda t: flock.Selector(t).select(row(2), looking(eye=(0, 0, 0))), "is at its target"),
        (lambda t: flock.Selector(t).select(row(2), looking(eye=(0, np.nan, 9))), "must be finite"),
        (lambda t: flock.Selector(t).select(row(2), CAMERA, triangles=0.5), "a whole number"),
        (lambda t: flock.Selector(t).select(row(2), CAMERA, detail=0), "detail must be between"),
        (
            lambda t: flock.Selector(t).select(row(2), CAMERA, impostors_below=-1),
            "impostors_below must be greater than 0, not -1",
        ),
        (
            lambda t: flock.Selector(t).select(row(2), CAMERA, visible=[1, 0]),
            r"visible must be bool of shape \(2,\), not int64",
        ),
        (
            lambda t: flock.Selector(t).select(row(2), CAMERA, visible=[[1], [1, 2]]),
            "visible is no array",
        ),
        (lambda t: t.draw(3, LEVELS, CAMERA), "flock must be a Flock, not int"),
        (
            lambda t: t.draw(row(2), LEVELS, CAMERA, obstacles=t.mesh(0)),
            "obstacles must be a sequence of Meshes, not Mesh",
        ),
        (
            lambda t: t.draw(row(2), LEVELS, CAMERA, obstacles=None),
            "obstacles must be a sequence of Meshes, not NoneType",
        ),
        (lambda t: t.draw(row(2), LEVELS, CAMERA, obstacles=[3]), "obstacles must be Meshes, not"),
        (lambda t: t.draw(row(2), [0, 0], CAMERA), r"levels must be uint16 of shape \(2,\)"),
        (
            lambda t: t.draw(row(2), np.array([0, 60_000], np.uint16), CAMERA),
            "levels: row 1: there is no level 60000, only",
        ),
        (lambda _: flock.Film("pond"), "scenario must be one of ring, .* not pond"),
        (lambda _: flock.Film(members=0), "members must be between 1 and"),
        (lambda _: flock.Film(members=3, schools=5), "3 members can form 1 to 3 schools, not 5"),
        (lambda _: flock.Film(fps=0), "fps must be between 0.1 and 1000, not 0"),
        (lambda t: flock.Flock.of_instances(np.eye(4), t), r"the shape \(n, 4, 4\), not float64"),
        (
            lambda t: flock.Flock.of_instances([np.diag([1, 1, 2, 1])], t),
            "transforms: row 0 must turn an upright member",
        ),
        (
            lambda t: flock.Flock.of_instances([np.eye(4), np.diag([-1, 1, 1, 1])], t),
            "transforms: row 1 must turn",
        ),
        (
            lambda t: flock.Flock.of_instances([np.diag([-1, -1, 1, 1])], t),
            "transforms: row 0 must turn .*roll",
        ),
        (lambda t: flock.Flock.of_instances([np.eye(4)], t.mesh(0)), "must be a LevelTable, not"),
        (lambda t: flock.Flock.of_instances([[1, 2], [3]], t), "transforms is no array"),
        (
            lambda t: flock.Flock.of_instances([np.eye(4), MOVED.T], t),
            "transforms: row 1 has its translation in the last row: transpose it",
        ),
        (
            lambda t: flock.Flock.of_instances([np.diag([1, 1, 1, 2])], t),
            "transforms: row 0 must end with 0, 0, 0, 1, not",
        ),
        (
            lambda t: flock.Flock.of_instances([np.full((4, 4), np.nan)], t),
            "transforms: row 0 is not finite",
        ),
    ],
)
def test_what_is_wrong_is_told(table, wrong, message):
    with pytest.raises(meshlod.MeshlodError, match=message) as raised:
        wrong(table)
    assert "\n" not in str(raised.value)
