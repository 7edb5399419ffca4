"""Flocks: levels of members, films, and members of a simulation of one's own."""

import copy
import json
import pathlib
import pickle
import re

import meshlod
import numpy as np
import pytest
from meshlod import _native, flock
from shapes import torus

CAMERA = meshlod.Camera(eye=(0, 0, 6), look=(0, 0, 0), size=(640, 480))


@pytest.fixture(scope="module")
def mesh():
    points, faces = torus(40, 20)
    return meshlod.Mesh(points * [1, 1, 2] + [5, 0, 0], faces)


@pytest.fixture(scope="module")
def table(mesh):
    return flock.LevelTable(mesh, directions=6)


def row(count, spacing=4.0, **options):
    """Members one behind the other, away from the camera, which swim to the left."""
    positions = np.zeros((count, 3))
    positions[:, 2] = -spacing * np.arange(count)
    return flock.Flock(positions, np.tile([1.0, 0, 0], (count, 1)), **options)


def triangles(table, levels):
    drawn = levels < flock.IMPOSTOR
    first, behind = table.ranges[np.where(drawn, levels, 0)].T
    return np.where(drawn, behind - first, 0)


def test_a_table_has_all_levels_in_one(mesh, table):
    sizes = np.diff(table.ranges).ravel()
    whole = sizes[: table.depth]
    assert whole[0] == len(mesh.faces) and (np.diff(whole) < 0).all() and whole[-1] < 100
    assert table.ranges[-1, 1] == len(table.triangles) == sizes.sum()
    assert table.triangles.max() < len(table.vertices) == len(table.attributes["normals"])
    assert len(table.errors) == len(table) and table.errors[0] == 0 < table.errors[table.depth - 1]
    for array in (table.vertices, table.triangles, table.ranges, table.errors):
        with pytest.raises(ValueError, match="cannot set WRITEABLE"):
            array.setflags(write=True)
    assert copy.deepcopy(table) is table
    with pytest.raises(meshlod.MeshlodError, match="a LevelTable cannot be pickled"):
        pickle.dumps(table)
    assert len(table.mesh(2).faces) == sizes[2]
    assert np.isclose(np.ptp(table.mesh(0).bounds, axis=0).max(), 1)
    assert np.isclose(table.body_length, np.ptp(mesh.vertices, axis=0).max())


@pytest.mark.parametrize("policy", ["distance", "screen-error", "budget", "ours"])
def test_levels_fall_with_distance(table, policy):
    selector = flock.Selector(table, policy)
    levels = selector.select(row(30), CAMERA, triangles=8000)
    drawn = triangles(table, levels)
    assert levels.dtype == np.uint16 and levels.shape == (30,)
    assert selector.triangles == drawn.sum()
    assert drawn[0] > 4 * drawn[-1] > 0
    if policy != "ours":
        assert (np.diff(drawn) <= 0).all()


@pytest.mark.parametrize("policy", ["budget", "ours"])
def test_budgets_are_kept(table, policy):
    selector, seen = flock.Selector(table, policy), []
    for most in (3000, 12_000, 30_000):
        selector.select(row(30), CAMERA, triangles=most)
        seen.append(selector.triangles)
        assert seen[-1] <= most
    assert seen[0] < seen[1] < seen[2]
    flock.Selector(table, policy).select(row(30), CAMERA)
    assert selector.select(row(0), CAMERA).shape == (0,) and selector.triangles == 0


def test_members_may_be_hidden_or_impostors(table):
    selector = flock.Selector(table, "screen-error")
    behind = flock.Flock([[0, 0, 20.0]], [[1, 0, 0]])
    assert selector.select(behind, CAMERA).tolist() == [flock.HIDDEN]
    visible = np.arange(9) % 2 == 0
    levels = selector.select(row(9), CAMERA, visible=visible)
    assert ((levels == flock.HIDDEN) == ~visible).all()
    levels = selector.select(row(9), CAMERA, impostors_below=40.0)
    far = levels == flock.IMPOSTOR
    assert far.any() and not far[0] and (np.diff(far.astype(int)) >= 0).all()
    assert selector.triangles == triangles(table, levels).sum() + 2 * far.sum()


def test_films_are_those_of_the_command(tmp_path):
    path = tmp_path / "torus.ply"
    meshlod.Mesh(*torus(40, 20)).save(path)
    tape = tmp_path / "tape"
    options = ["--members", "60", "--schools", "2", "--seed", "7", "--frames", "3"]
    place = [f"--model={path}", "--forward=+z", f"--record={tape}", f"--out={tmp_path / 'out'}"]
    told = _native.answer(
        ["meshlod", "flock", "--json", "--no-pictures", "--triangles=9000", *options, *place]
    )
    film = flock.Film("ring", members=60, schools=2, seed=7)
    selector = flock.Selector(flock.LevelTable(meshlod.load(path)), "ours")
    total = 0
    for frame in range(3):
        members, camera = film.next_frame()
        levels = selector.select(members, camera, triangles=9000)
        total += selector.triangles
        for name, mine in [
            ("positions", members.positions),
            ("headings", members.headings),
            ("speeds", members.speeds),
            ("selection", levels),
        ]:
            assert (np.load(tape / f"{name}.npy")[frame] == mine).all(), name
    assert json.loads(told)["total"]["triangles"] == total
    assert [school.members for school in members.schools] == [range(30), range(30, 60)]


@pytest.mark.parametrize("scenario", ["ring", "inside", "far", "obstacles", "terrain"])
def test_films_are_the_same_again(scenario):
    frames = []
    for _ in range(2):
        film = flock.Film(scenario, members=20, size=(300, 400), fps=10)
        film.next_frame()
        frames.append(film.next_frame())
    (one, camera), (other, again) = frames
    assert (one.positions == other.positions).all() and camera == again
    assert camera.size == (300, 400) and np.linalg.norm(camera.velocity) > 0
    assert bool(film.obstacles) == (scenario in ("obstacles", "terrain"))


def test_any_unit_and_z_up(table):
    members, camera = flock.Film(members=80, size=(480, 640)).next_frame()
    chosen = flock.Selector(table).select(members, camera)

    def as_z_up(rows):
        rows = np.asarray(rows, float)
        return np.stack([rows[..., 0], -rows[..., 2], rows[..., 1]], axis=-1)

    lies = flock.Flock(
        4 * as_z_up(members.positions),
        8 * as_z_up(members.headings),
        4 * members.speeds,
        body_length=4,
        up="z",
    )
    seen = flock.FlockCamera(
        eye=4 * as_z_up(camera.eye),
        look=4 * as_z_up(camera.look),
        up=(0, 0, 1),
        fov=camera.fov,
        size=camera.size,
    )
    assert (flock.Selector(table).select(lies, seen) == chosen).all()


@pytest.mark.parametrize("up", ["y", "z"])
def test_instances_of_a_scene_are_a_flock(mesh, up):
    axes = {"forward": (1, 0, 0), "up": (0, 1, 0) if up == "y" else (0, 0, 1)}
    table = flock.LevelTable(mesh, directions=4, **axes)
    turn = np.linspace(0.1, 6, 12)
    matrices = np.tile(np.eye(4), (12, 1, 1))
    a, b = (0, 2) if up == "y" else (1, 0)
    matrices[:, a, a] = matrices[:, b, b] = np.cos(turn)
    matrices[:, a, b], matrices[:, b, a] = np.sin(turn), -np.sin(turn)
    matrices[:, :3, :3] *= 3
    matrices[:, :3, 3] = np.random.default_rng(1).normal(size=(12, 3)) * 50
    members = flock.Flock.of_instances(matrices, table, up=up)
    assert np.isclose(members.body_length, 3 * table.body_length)
    finest = table.vertices[np.unique(table.triangles[slice(*table.ranges[0])])]
    for own, theirs in zip(members.transforms(), matrices, strict=True):
        placed = finest @ own[:3, :3].T + own[:3, 3]
        expected = mesh.vertices @ theirs[:3, :3].T + theirs[:3, 3]
        nearest = np.abs(placed[:, None] - expected[None]).max(axis=2).min(axis=0)
        assert nearest.max() < 1e-3
    camera = flock.FlockCamera(
        eye=(300, 20, 20), look=(0, 0, 0), up=(0, 1, 0) if up == "y" else (0, 0, 1)
    )
    levels = flock.Selector(table, "screen-error").select(members, camera)
    assert (levels < table.depth).all()


def test_pictures_show_the_members(table):
    members, camera = flock.Film(members=30, size=(160, 120)).next_frame()
    selector = flock.Selector(table)
    levels = selector.select(members, camera, triangles=9000)
    picture = table.draw(members, levels, camera)
    assert picture.shape == (120, 160, 4) and picture.dtype == np.uint8
    nothing = table.draw(members, np.full(30, flock.HIDDEN, np.uint16), camera)
    impostors = table.draw(members, np.full(30, flock.IMPOSTOR, np.uint16), camera)
    full = table.draw(members, np.zeros(30, np.uint16), camera)

    def apart(a, b):
        return np.abs(a.astype(int) - b.astype(int)).mean()

    assert apart(picture, full) < 0.2 * apart(picture, nothing)
    assert 0 < apart(impostors, full) < 0.5 * apart(nothing, full)


def test_the_example_of_the_readme(mesh, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh.save("fish.glb")
    readme = pathlib.Path(__file__).parent.parent / "README.md"
    blocks = re.findall(r"```python\n(.*?)```", readme.read_text(), re.DOTALL)
    [example] = [block for block in blocks if "meshlod.flock" in block]
    uploaded = []
    rng = np.random.default_rng(2)
    names = {
        "meshlod": meshlod,
        "upload": lambda *arrays: uploaded.append(arrays),
        "positions": rng.normal(size=(50, 3)) * 20,
        "headings": rng.normal(size=(50, 3)),
        "camera": meshlod.Camera(eye=(0, 0, 60), look=(0, 0, 0)),
    }
    exec(example, names)
    [(vertices, indices)] = uploaded
    assert vertices.shape[1] == indices.shape[1] == 3
    assert 0 < names["selector"].triangles <= 20_000
    assert sum(map(len, names["instances"].values())) == (names["levels"] < flock.IMPOSTOR).sum()
