"""Flocks of members of different sizes, and of models with several materials."""

import meshlod
import numpy as np
import pytest
from meshlod import flock
from shapes import torus

CAMERA = meshlod.Camera(eye=(0, 0, 6), look=(0, 0, 0), size=(160, 120))


@pytest.fixture(scope="module")
def table():
    points, faces = torus(40, 20)
    return flock.LevelTable(meshlod.Mesh(points * [1, 1, 2] + [5, 0, 0], faces), directions=4)


def apart(a, b):
    return np.abs(a.astype(int) - b.astype(int)).mean()


def placed(scales):
    matrices = np.tile(np.eye(4), (len(scales), 1, 1))
    matrices[:, :3, :3] *= np.reshape(scales, (-1, 1, 1))
    matrices[:, 0, 3] = 2 * np.arange(len(scales))
    return matrices


def test_instances_keep_their_sizes(table):
    members = flock.Flock.of_instances(placed([2, 1, 0.2]), table)
    assert np.isclose(members.body_length, 2 * table.body_length)
    assert np.allclose(members.scales, [1, 0.5, 0.1])
    # A member's matrix leads from the table, an instance's from the model.
    expected = placed([2, 1, 0.2]) @ table.frame
    assert np.allclose(members.transforms(), expected, atol=1e-5)
    assert members.transforms().flags.c_contiguous
    assert flock.Flock.of_instances(placed([3, 3, 3.0001]), table).scales is None
    assert flock.Flock.of_instances(placed([]), table).transforms().shape == (0, 4, 4)


def test_the_frame_of_a_table_is_that_of_its_model(table):
    finest = table.mesh(0).vertices
    assert len(finest) < len(table.vertices)
    placed = finest @ table.frame[:3, :3].T + table.frame[:3, 3]
    points = torus(40, 20)[0] * [1, 1, 2] + [5, 0, 0]
    assert np.allclose(np.sort(placed, axis=0), np.sort(points, axis=0), atol=1e-5)


@pytest.mark.parametrize("level", [0, flock.IMPOSTOR])
def test_pictures_show_sizes(table, level):
    places = {"positions": [[0, 0, 0], [0, 0.5, 1]], "headings": [[1, 0, 0], [1, 0, 1]]}
    levels = np.array([flock.HIDDEN, level], np.uint16)
    small = flock.Flock(**places, scales=[1, 0.25])
    picture = table.draw(small, levels, CAMERA)
    # There are impostors of one size alone: others are drawn at the coarsest level.
    same = np.where(levels == flock.IMPOSTOR, table.depth - 1, levels).astype(np.uint16)
    alone = table.draw(flock.Flock(**places, body_length=0.25), same, CAMERA)
    nothing = table.draw(small, np.full(2, flock.HIDDEN, np.uint16), CAMERA)
    large = table.draw(flock.Flock(**places), levels, CAMERA)
    assert apart(picture, alone) < 0.02 * apart(alone, nothing)
    assert apart(picture, nothing) < 0.2 * apart(large, nothing)


@pytest.mark.parametrize("scales", [[1, 0], [1, 2], [1, np.nan], [1], ["a", "b"]])
def test_sizes_that_are_wrong(table, scales):
    members = flock.Flock(np.zeros((2, 3)), np.ones((2, 3)), scales=scales)
    with pytest.raises(meshlod.MeshlodError, match="^scales"):
        members.transforms()


def test_models_of_several_materials(tmp_path):
    points, faces = torus(20, 12)
    lines = [f"v {x} {y} {z}" for x, y, z in points]
    for name, part in (("skin", faces[::2]), ("eye", faces[1::2])):
        lines += [f"usemtl {name}", *(f"f {a} {b} {c}" for a, b, c in part + 1)]
    (tmp_path / "two.obj").write_text("\n".join(lines) + "\n")
    mesh = meshlod.load(tmp_path / "two.obj")
    table = flock.LevelTable(mesh, directions=4)
    names, of_triangle = table.materials
    assert names == ["skin", "eye"] and len(of_triangle) == len(table.triangles)
    members = flock.Flock([[0, 0, 0]], [[1, 0, 0]])
    full, impostor, hidden = (
        table.draw(members, np.array([level], np.uint16), CAMERA)
        for level in (0, flock.IMPOSTOR, flock.HIDDEN)
    )
    assert apart(impostor, full) < 0.5 * apart(hidden, full)


@pytest.mark.parametrize("policy", ["ours", "budget", "screen-error", "distance"])
def test_coordinates_of_a_map(table, policy):
    """Far from the origin, levels and pictures are those of places beside it."""
    rng = np.random.default_rng(4)
    positions, headings = rng.uniform(-8, 8, (40, 3)), rng.normal(size=(40, 3))
    far = np.array([500_000.0, 0.0, 4_649_776.0])
    seen, levels, pictures = [], [], []
    for origin in (np.zeros(3), far):
        camera = meshlod.Camera(eye=origin + [0, 0, 20], look=origin, size=(160, 120))
        members = flock.Flock(positions + origin, headings, body_length=0.5)
        levels.append(flock.Selector(table, policy).select(members, camera, triangles=9000))
        pictures.append(table.draw(members, levels[-1], camera))
        seen.append(members)
    # Rounding may move a member across a switch.
    assert (levels[0] != levels[1]).sum() <= 2
    hidden = np.full(40, flock.HIDDEN, np.uint16)
    assert apart(*pictures) < 0.05 * apart(pictures[0], table.draw(seen[0], hidden, CAMERA))
