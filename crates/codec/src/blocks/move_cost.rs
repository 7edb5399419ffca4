//! Cost of moving a vertex to a cell: the faces that it flips, then the squared distances of its
//! faces from their planes.

use glam::{DMat3, DVec3};

use super::assign_cells::{AssignOptions, BlockGrid};
use super::original::{Face, OriginalSurface, outer};

/// Displacements while vertices of one chunk are assigned: those of the chunk as they are now, and
/// those of all others as they were before, so that chunks do not depend on each other's progress.
pub(super) struct Moves<'m> {
    pub(super) before: &'m [DVec3],
    /// First vertex of the chunk.
    pub(super) start: usize,
    pub(super) own: &'m mut [DVec3],
}

/// Cost of moving one vertex.
pub(super) struct MoveCost<'s> {
    surface: &'s OriginalSurface,
    vertex: usize,
    /// Quadratic and linear term of the squared distances to planes, given the neighbours.
    square: DMat3,
    pull: DVec3,
    /// Penalty for the squared distance beyond the limit.
    penalty: f64,
    limit: f64,
    /// Faces that a candidate cell might flip.
    hinges: &'s [Hinge],
}

/// Twice the signed area of a face as a function of one corner's displacement, which is linear.
#[derive(Clone, Copy)]
pub(super) struct Hinge {
    area: f64,
    slope: DVec3,
    /// Value at and below which the face counts as flipped.
    least: f64,
}

/// Cost of a cell: the number of flipped faces, then the error.
pub(super) type Cost = (usize, f64);

/// Penalty factor beyond the limit: such a cell is a last resort.
const PENALTY: f64 = 100.0;

impl Moves<'_> {
    pub(super) fn of(&self, v: usize) -> DVec3 {
        let own = v.checked_sub(self.start).and_then(|at| self.own.get(at));
        *own.unwrap_or_else(|| &self.before[v])
    }
}

impl Hinge {
    /// Creates the hinge of a face about the edge opposite a vertex.
    fn new(surface: &OriginalSurface, face: &Face, vertex: usize, moves: &Moves) -> Self {
        let first = face.after(vertex as u32);
        let away =
            |v: u32| surface.places[v as usize] + moves.of(v as usize) - surface.places[vertex];
        let [b, c] = [first, face.after(first)].map(away);
        // (b - p) × (c - p) = b × c + p × (b - c) for a corner at p.
        Self {
            area: face.normal.dot(b.cross(c)),
            slope: (b - c).cross(face.normal),
            least: face.least_area(),
        }
    }

    fn is_flipped(&self, moved: DVec3) -> bool {
        self.area + self.slope.dot(moved) <= self.least
    }
}

impl<'s> MoveCost<'s> {
    pub(super) fn new(
        surface: &'s OriginalSurface,
        grid: &BlockGrid,
        vertex: usize,
        moves: &Moves,
        options: &AssignOptions,
        hinges: &'s mut Vec<Hinge>,
    ) -> Self {
        let (mut square, mut pull, mut area) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        let mut height = f64::INFINITY;
        for face in surface.faces_around(vertex) {
            // The mean square over a face is (a² + b² + c² + (a + b + c)²) / 12 of its corners'
            // distances.
            let others = face.corners.iter().filter(|&&corner| corner as usize != vertex);
            let distances = others.map(|&other| face.normal.dot(moves.of(other as usize)));
            square += outer(face.normal) * face.area;
            pull += face.normal * (face.area * 0.5 * distances.sum::<f64>());
            area += face.area;
            height = height.min(face.height);
        }
        let boundary = surface.boundary(vertex);
        square += DMat3::from_diagonal(DVec3::splat(area * options.along));
        square += boundary.map_or(DMat3::ZERO, |boundary| *boundary * area);
        let cell: f64 = grid.sides.iter().map(|side| side.length()).sum();
        hinges.clear();
        // No candidate cell can flip faces that are as high as that.
        if height <= 4.0 * cell {
            let faces = surface.faces_around(vertex);
            hinges.extend(faces.map(|face| Hinge::new(surface, face, vertex, moves)));
        }
        let penalty = PENALTY * area;
        Self { surface, vertex, square, pull, penalty, limit: options.limit, hinges }
    }

    /// Returns the cost of a displacement.
    pub(super) fn cost(&self, moved: DVec3) -> Cost {
        (self.flips(moved).count(), self.effect(moved) + self.excess(moved))
    }

    /// Returns the cost of a displacement if it is less than `best`, without working out more of
    /// it than that takes.
    pub(super) fn less(&self, moved: DVec3, best: Cost) -> Option<Cost> {
        let effect = self.effect(moved);
        if best.0 == 0 && effect >= best.1 {
            return None;
        }
        let flips = self.flips(moved).take(best.0 + 1).count();
        if (flips, effect) >= best {
            return None;
        }
        let cost = (flips, effect + self.excess(moved));
        (cost < best).then_some(cost)
    }

    fn flips(&self, moved: DVec3) -> impl Iterator<Item = &Hinge> {
        self.hinges.iter().filter(move |hinge| hinge.is_flipped(moved))
    }

    /// Returns the change of the summed squares.
    fn effect(&self, moved: DVec3) -> f64 {
        moved.dot(self.square * moved + self.pull * 2.0)
    }

    /// Returns the penalty for a distance beyond the limit.
    fn excess(&self, moved: DVec3) -> f64 {
        if moved.length_squared() <= self.limit * self.limit {
            return 0.0;
        }
        let over = (self.surface.plane_distance(self.vertex, moved) - self.limit).max(0.0);
        self.penalty * over * over
    }

    /// Returns the best multiple of `side` to add; `None` if it makes no difference.
    pub(super) fn best_along(&self, side: DVec3, moved: DVec3) -> Option<f64> {
        let bend = self.square * side;
        let times = -(bend.dot(moved) + side.dot(self.pull)) / bend.dot(side);
        times.is_finite().then_some(times)
    }
}
