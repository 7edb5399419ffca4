"""The native part: what it takes is contiguous and of the right type."""

from collections.abc import Callable, Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

class Asked(TypedDict):
    kind: str
    value: float
    method: str
    topology: str
    lock_boundary: bool
    locks: list[int]
    weights: tuple[float, float, float] | None
    precision: str
    progress: Callable[[float], object] | None

class FlockArguments(TypedDict):
    positions: NDArray[np.float32]
    headings: NDArray[np.float32]
    speeds: NDArray[np.float32]
    schools: list[tuple[list[int], list[float], list[float], list[float]]]

#: Eye, direction, field of view, size, velocity, gaze.
FlockCameraArguments = tuple[
    list[float], list[float], float, list[int], list[float], list[float]
]

class MeshlodError(ValueError):
    """An input that is not what it should be: the message says what, where, and what to do."""

class NativeMesh:
    @property
    def vertices(self) -> NDArray[np.float64]: ...
    @property
    def faces(self) -> NDArray[np.int32]: ...
    def attributes(self) -> list[tuple[str, NDArray[np.float32]]]: ...
    def vertex_of_points(self) -> NDArray[np.uint32]: ...
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None: ...
    def objects(self) -> tuple[list[str], NDArray[np.uint32]] | None: ...
    def bounds(self) -> list[list[float]] | None: ...
    def to_arrays(
        self,
    ) -> tuple[NDArray[np.float64], NDArray[np.int32], list[tuple[str, NDArray[np.float32]]]]: ...

class NativeScene:
    @staticmethod
    def of(name: str, mesh: NativeMesh) -> NativeScene: ...
    def meshes(self) -> list[tuple[str, NativeMesh]]: ...
    def mesh_count(self) -> int: ...
    def instances(self) -> list[tuple[int, list[list[float]]]]: ...
    def materials(self) -> list[str]: ...
    def flatten(self) -> NativeMesh: ...
    def face_count(self) -> int: ...
    def beyond_mesh(self) -> list[str]: ...

class NativeModel:
    def __init__(self, path: str) -> None: ...
    def extract(
        self,
        error: float,
        faces: int | None,
        camera: tuple[list[float], list[float], list[float], float, list[int]] | None,
        sphere: tuple[list[float], float] | None,
        corners: list[list[float]] | None,
        verify: bool,
        crop: bool,
    ) -> tuple[NativeMesh, dict[str, Any]]: ...
    def cut(self) -> tuple[NativeCut, tuple[int, int], str]: ...

class NativeCut:
    def update(
        self,
        error: float,
        camera: tuple[list[float], list[float], list[float], float, list[int]] | None,
        sphere: tuple[list[float], float] | None,
        corners: list[list[float]] | None,
        changes: int | None,
        seconds: float | None,
    ) -> tuple[NDArray[np.uint32], NDArray[np.int32], int, int, bool]: ...
    def triangles(self) -> NDArray[np.int32]: ...
    def face_count(self) -> int: ...
    def vertices(
        self,
    ) -> tuple[NDArray[np.float64], list[tuple[str, NDArray[np.float32]]]]: ...
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None: ...
    def mesh(self) -> NativeMesh: ...

class NativeLevelTable:
    def __init__(
        self,
        mesh: NativeMesh,
        forward: list[float],
        up: list[float],
        method: str,
        step: float,
        coarsest: int,
        directions: int,
    ) -> None: ...
    @property
    def vertices(self) -> NDArray[np.float32]: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    def attributes(self) -> list[tuple[str, NDArray[np.float32]]]: ...
    def materials(self) -> tuple[list[str], NDArray[np.uint32]] | None: ...
    @property
    def ranges(self) -> NDArray[np.int64]: ...
    @property
    def errors(self) -> NDArray[np.float32]: ...
    def depth(self) -> int: ...
    def mesh(self, level: int) -> NativeMesh: ...
    def draw(
        self,
        flock: FlockArguments,
        levels: NDArray[np.uint16],
        camera: FlockCameraArguments,
        obstacles: list[NativeMesh],
        scales: NDArray[np.float32] | None,
    ) -> bytes: ...

class NativeFilm:
    def __init__(
        self,
        scenario: str,
        members: int,
        schools: int,
        seed: int,
        size: list[int],
        frame_s: float,
    ) -> None: ...
    def next_frame(
        self,
    ) -> tuple[
        tuple[
            NDArray[np.float32],
            NDArray[np.float32],
            NDArray[np.float32],
            list[tuple[list[int], list[float], list[float], list[float]]],
        ],
        FlockCameraArguments,
    ]: ...
    def obstacles(self) -> list[NativeMesh]: ...

class NativeSelector:
    def __init__(self, table: NativeLevelTable, policy: str) -> None: ...
    def select(
        self,
        flock: FlockArguments,
        camera: FlockCameraArguments,
        triangles: int,
        detail: float,
        impostors_below_px: float | None,
        visible: NDArray[np.bool_] | None,
    ) -> tuple[NDArray[np.uint16], int]: ...

def from_arrays(
    points: NDArray[Any],
    faces: NDArray[Any],
    attributes: list[tuple[str, str, NDArray[np.float32]]],
    numbered: bool,
) -> tuple[NativeMesh, NDArray[np.uint32] | None]: ...
def simplify(mesh: NativeMesh, asked: Asked) -> tuple[NativeMesh, dict[str, Any]]: ...
def simplify_scene(scene: NativeScene, asked: Asked) -> tuple[NativeScene, dict[str, Any]]: ...
def levels(
    mesh: NativeMesh, ratios: Sequence[float], asked: Asked
) -> list[tuple[NativeMesh, dict[str, Any]]]: ...
def load(path: str) -> tuple[NativeScene, list[str]]: ...
def save(scene: NativeScene, path: str, precision: str) -> list[str]: ...
def build(
    scene: NativeScene, path: str, lossless: bool, errors: str, order: str
) -> list[str]: ...
def measure(a: NativeMesh, b: NativeMesh, samples: int, seed: int) -> dict[str, Any]: ...
def sizes(mesh: NativeMesh) -> tuple[float, float]: ...
def check(mesh: NativeMesh) -> list[tuple[str, int, bool]]: ...
def repair(
    mesh: NativeMesh, weld: float | None, stitch: float | None, fill_holes: int | None
) -> tuple[NativeMesh, list[tuple[str, int]]]: ...
def strip(mesh: NativeMesh, quality: str) -> NDArray[np.uint32]: ...
def compress(
    mesh: NativeMesh, path: str, bits: int, error: float | None
) -> tuple[int, bool]: ...
def render(
    mesh: NativeMesh,
    size: list[int],
    wireframe: bool,
    up: str,
    direction: tuple[float, float, float] | None,
    png: bool,
) -> bytes: ...
def run_command(arguments: list[str]) -> int: ...
def answer(
    arguments: list[str], progress: Callable[[float], object] | None = None
) -> str: ...
def run_file_of_batch(arguments: list[str], input: str, output: str) -> str: ...
def record_file_of_batch(folder: str, recipe: str, report: str) -> None: ...
def remove_abandoned(paths: list[str]) -> None: ...
