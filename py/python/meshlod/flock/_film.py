"""Schools that swim, and the camera that follows them."""

from __future__ import annotations

import numpy as np

from .. import _native
from .._asked import number, size_px, whole, word
from .._errors import MeshlodError
from .._mesh import Mesh
from ._camera import FlockCamera, fov_along
from ._members import Flock, School


class Film:
    """A scenario that runs: every frame is a flock and the camera that sees it.

    ``scenario`` is ``"ring"``, whose camera circles a school, ``"inside"``, ``"far"``,
    ``"obstacles"`` or ``"terrain"``. Lengths are in body lengths, with +y up. The film is the same
    again for the same arguments, and that of ``meshlod flock`` with them.
    """

    __slots__ = ("_native",)

    def __init__(
        self,
        scenario: str = "ring",
        *,
        members: int = 150,
        schools: int = 1,
        seed: int = 1,
        size: tuple[int, int] = (960, 540),
        fps: float = 30.0,
    ) -> None:
        rate = number("fps", fps)
        if not 0.1 <= rate <= 1000:
            raise MeshlodError(f"fps must be between 0.1 and 1000, not {fps!r}")
        self._native = _native.NativeFilm(
            word("scenario", scenario),
            whole("members", members, 1, 5_000_000),
            whole("schools", schools, 1, 64),
            whole("seed", seed, 0, 2**64 - 1),
            size_px(size),
            1 / rate,
        )

    def next_frame(self) -> tuple[Flock, FlockCamera]:
        """Advances by the time of a frame, and returns the flock and its camera."""
        (positions, headings, speeds, schools), camera = self._native.next_frame()
        swim = [School(range(*members), *places) for members, *places in schools]
        eye, forward, fov, (width, height), velocity, gaze = camera
        if width < height:
            fov = fov_along(height, fov, width)
        look = tuple(np.add(eye, forward).tolist())
        seen = FlockCamera(
            eye=tuple(eye), look=look, fov=fov, size=(width, height), velocity=tuple(velocity)
        )
        return Flock(positions, headings, speeds, swim), seen

    @property
    def obstacles(self) -> list[Mesh]:
        """Obstacles that the schools swim round."""
        return [Mesh._of(native) for native in self._native.obstacles()]
