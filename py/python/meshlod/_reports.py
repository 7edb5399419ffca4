"""What was done and what was found, as plain classes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Report:
    """Report of a simplification. Lengths are in model units."""

    #: Method that ran.
    method: str
    #: Number of faces before.
    input_faces: int
    #: Number of faces after.
    output_faces: int
    #: True if the target was reached.
    reached: bool
    #: Estimate of the method; no bound.
    error_estimate: float
    #: Proved bound of the distance in that precision, if an error was asked for.
    error_proved: float | None
    #: Number of edges and faces contracted.
    contractions: int
    #: Number of connected components that were removed as a whole.
    vanished: int
    #: Number of faces left out because they repeat a vertex.
    degenerate_faces: int
    #: Number of faces left out because they repeat another one.
    duplicate_faces: int
    #: Number of vertices kept in place.
    locked: int
    #: Volume before minus volume after, in cubic model units, as the method counts it.
    volume_lost: float
    #: Number of refused contractions, by reason.
    refusals: Mapping[str, int] = field(default_factory=dict)
    #: Number of vertices kept in place because the surface is no manifold there.
    non_manifold_vertices: int = 0
    #: Volume of the components that were removed.
    vanished_volume: float = 0.0
    #: Number of handles closed: tunnels filled, or arms of rings cut; ``None`` where none may close.
    handles_closed: int | None = None
    #: Distance asked for, if one was.
    error_asked: float | None = None
    #: Number of times that contractions were taken back to hold it.
    error_rounds: int | None = None
    #: Largest distance by which the precision moves a point.
    error_of_rounding: float | None = None
    #: Number of faces that went because what is flat can do without them, if those went first.
    flat_faces: int | None = None
    #: Number of faces that the shape needs, the fewest with the corners of its flats, if those went first.
    needed_faces: int | None = None
    #: Number of pairs of boundary edges that were sewn together before.
    stitched_edges: int = 0
    #: Number of vertices that were merged by that.
    stitched_vertices: int = 0
    #: Number of vertices that were divided before.
    split_vertices: int = 0
    #: Time of the method with its connectivity.
    simplify_seconds: float | None = None
    #: Precision of coordinates for which the error is proved: "f32" or "f64".
    precision: str | None = None

    def why_not_reached(self) -> str:
        """Says why the target was missed."""
        if self.error_asked is not None:
            if self.error_proved is None:
                return f"max_error {self.error_asked} is not proved: a surface has no area"
            help_ = "a larger error can be kept"
            if (self.error_of_rounding or 0) > 0.5 * self.error_asked:
                help_ = 'coordinates are rounded by more than half of that: use precision="f64"'
            return f"max_error {self.error_asked}: only {self.error_proved} is proved; {help_}"
        counts = ", ".join(f"{name} {count}" for name, count in self.refusals.items())
        faces = "face" if self.output_faces == 1 else "faces"
        return (
            f"target not reached: no further contraction is possible at {self.output_faces} "
            f"{faces} (refused: {counts or 'none'})"
        )


@dataclass(frozen=True)
class OneSidedDistance:
    """Distance from points on one surface to the other, in model units."""

    #: Mean over the samples.
    mean: float
    #: Root mean square over the samples.
    rms: float
    #: Maximum over samples and vertices, a lower bound of the true one.
    max: float
    #: Point at which the maximum was found.
    max_from: tuple[float, float, float]
    #: Point of the other surface that is closest to it.
    max_to: tuple[float, float, float]


@dataclass(frozen=True)
class Distance:
    """Distance between two surfaces, measured in both directions, in model units."""

    #: Mean of both directions.
    mean: float
    #: Root mean square of both directions.
    rms: float
    #: Maximum of both directions, a lower bound of the true one.
    max: float
    #: Diagonal of the bounding box of the first mesh.
    diagonal: float
    #: From the first mesh to the second.
    forward: OneSidedDistance
    #: From the second mesh to the first.
    backward: OneSidedDistance


@dataclass(frozen=True)
class CheckReport:
    """Numbers of findings of a check, by kind."""

    #: Findings that are errors.
    errors: Mapping[str, int]
    #: Findings that are no errors.
    warnings: Mapping[str, int]

    @property
    def is_clean(self) -> bool:
        """True if nothing was found."""
        return not self.errors and not self.warnings

    def __str__(self) -> str:
        found = {**self.errors, **self.warnings}
        return "\n".join(f"{kind}: {count}" for kind, count in found.items()) or "clean"


@dataclass(frozen=True)
class TileLevel:
    """Level of a tileset: a whole model, if everything were drawn at its depth."""

    #: Depth of its tiles in the tree; 0 for the root.
    depth: int
    #: Number of tiles, with those of leaves that are less deep.
    tiles: int
    #: Number of their faces, without skirts.
    faces: int
    #: Proved bound of the distance from the input, both ways, in model units.
    error_proved: float


@dataclass(frozen=True)
class TilesReport:
    """Report of tiles. Lengths are in model units."""

    #: Number of faces of the model.
    input_faces: int
    #: Number of faces left out because two corners were at one point of the lattice.
    degenerate_faces: int
    #: Number of tiles.
    tiles: int
    #: Bytes of all contents.
    bytes: int
    #: Length of a step of the lattice; vertices are on every second one.
    lattice_step: float
    #: Levels, the coarsest first.
    levels: Sequence[TileLevel]
    #: Number of tiles that could not be made coarser than what they were made from.
    unchanged_tiles: int
    #: Number of images that cannot be decoded and are left out.
    lost_images: int

    def __str__(self) -> str:
        tiles = "tile" if self.tiles == 1 else "tiles"
        levels = "level" if len(self.levels) == 1 else "levels"
        return f"{self.tiles:,} {tiles} in {len(self.levels)} {levels}, {self.bytes:,} bytes"

    @classmethod
    def _of(cls, fields: Mapping[str, Any]) -> TilesReport:
        names = TileLevel.__dataclass_fields__
        levels = [TileLevel(**{name: row[name] for name in names}) for row in fields["levels"]]
        own = {name: fields[name] for name in cls.__dataclass_fields__}
        return cls(**own | {"levels": levels})
