//! Comparison of successive levels with one input.

use glam::DVec3;
use meshlod_measure::{BeyondOptions, FaceBeyond, PreparedSurface, faces_beyond};
use meshlod_mesh::{FaceId, Mesh, VertexId};
use meshlod_simplify::{Excess, ExcessFace};
use rustc_hash::FxHashSet;

/// Limit on the divisions of faces in each direction. Where errors are far below a thousandth of a
/// percent of the diagonal and large flats are divided into other faces, more would be needed.
const MOST_SPLITS: usize = 32_000_000;

/// Limits on the divisions of all comparisons together: for each face of the input, and for all of
/// them. A mesh of few faces that cannot be proved is given up after a few seconds.
const SPLITS_PER_FACE: usize = 1000;
const SPLITS: [usize; 2] = [1 << 23, 1 << 28];

/// Part of the error, with room for rounding, within which a face of the input may have been near one
/// that is gone.
const REACH: f64 = 1.000_001;

/// Result of the comparison of a level with the input.
pub(super) enum Outcome {
    /// No point of either is farther from the other than allowed.
    Near,
    /// These faces have points that are.
    Far(Vec<Excess>),
    /// It is not known of some faces whether they have, and no other face has.
    Undecided,
    /// The level has no area, and cannot be compared.
    NoArea,
}

/// Comparison of levels with one input, in which what has been proved of a face once is not proved
/// again.
pub(super) struct Comparison<'i, 'm> {
    input: &'i PreparedSurface<'m>,
    mesh: &'m Mesh,
    /// Largest distance allowed, in model units.
    error: f64,
    /// Relative slack of what is allowed.
    slack: f64,
    /// Number of divisions that are left.
    left: usize,
    last: Option<Compared>,
}

/// A level that has been compared, and what was found.
struct Compared {
    /// Corners of all faces of the level.
    corners: Vec<Corners>,
    /// Corners of the faces that are near enough.
    near: FxHashSet<Corners>,
    /// Faces of the input that are too far away.
    far: Vec<FaceId>,
}

/// Bits of the positions of a face's corners.
type Corners = [[u64; 3]; 3];

impl<'i, 'm> Comparison<'i, 'm> {
    pub(super) fn new(
        mesh: &'m Mesh,
        input: &'i PreparedSurface<'m>,
        [error, slack]: [f64; 2],
    ) -> Self {
        let [least, most] = SPLITS;
        let left = mesh.faces.len().saturating_mul(SPLITS_PER_FACE).clamp(least, most);
        Self { input, mesh, error, slack, left, last: None }
    }

    /// Forgets what was proved of the last level.
    pub(super) fn start_again(&mut self) {
        self.last = None;
    }

    /// Returns true if a level has exactly the faces of the input.
    pub(super) fn is_input(&self, level: &Mesh) -> bool {
        let corners: Vec<Corners> = level.faces.iter().map(|face| corners(level, face)).collect();
        self.faces_of_one_only(&corners)
            .iter()
            .all(|faces| faces.as_ref().is_some_and(Vec::is_empty))
    }

    /// Compares a level with the input, in both directions.
    pub(super) fn with(&mut self, level: &Mesh) -> Outcome {
        let Ok(surface) = PreparedSurface::new(level) else { return Outcome::NoArea };
        let corners: Vec<Corners> = level.faces.iter().map(|face| corners(level, face)).collect();
        let [of_level, of_input] = match &self.last {
            None => self.faces_of_one_only(&corners),
            Some(last) => [Some(last.new_faces(&corners)), Some(self.doubtful(last, &corners))],
        };
        let (limit, slack) = (self.error / (1.0 + self.slack), self.slack);
        let left = &mut self.left;
        let mut far = |from, to, faces: Option<Vec<FaceId>>| {
            let most_splits = MOST_SPLITS.min(*left);
            let options = BeyondOptions { slack, most_splits, faces: faces.as_deref() };
            let found = faces_beyond(from, to, &|_| limit, &options);
            *left -= found.splits;
            found.faces
        };
        let of_level = far(&surface, self.input, of_level);
        let of_input = far(self.input, &surface, of_input);
        let mut near: FxHashSet<Corners> = corners.iter().copied().collect();
        of_level.iter().for_each(|far| _ = near.remove(&corners[far.face.index()]));
        let faces = of_input.iter().map(|far| far.face).collect();
        self.last = Some(Compared { corners, near, far: faces });
        if of_level.is_empty() && of_input.is_empty() {
            return Outcome::Near;
        }
        let excess = |face: ExcessFace, far: &FaceBeyond| {
            let ratio = (far.distance / limit).max(1.0);
            far.decided.then_some(Excess { face, ratio })
        };
        let of_level = of_level.iter().map(|far| excess(ExcessFace::OfLevel(far.face), far));
        let of_input = of_input.iter().map(|far| excess(ExcessFace::OfInput(far.face), far));
        let far: Vec<Excess> = of_level.chain(of_input).flatten().collect();
        if far.is_empty() { Outcome::Undecided } else { Outcome::Far(far) }
    }

    /// Returns the faces of a level that the input has not, and those of the input that the level
    /// has not; `None` for all. Others are at no distance.
    fn faces_of_one_only(&self, level: &[Corners]) -> [Option<Vec<FaceId>>; 2] {
        if 2 * level.len() < self.mesh.faces.len() {
            return [None, None];
        }
        let input: Vec<Corners> =
            self.mesh.faces.iter().map(|face| corners(self.mesh, face)).collect();
        let missing = |of: &[Corners], from: &[Corners]| {
            let from: FxHashSet<&Corners> = from.iter().collect();
            let is_missing = |face: &FaceId| !from.contains(&of[face.index()]);
            Some((0..of.len()).map(FaceId::new).filter(is_missing).collect())
        };
        [missing(level, &input), missing(&input, level)]
    }

    /// Returns the faces of the input that may be too far from a level with these faces: those that
    /// were too far from the last one, and those that come near a face that it has no more.
    fn doubtful(&self, last: &Compared, now: &[Corners]) -> Vec<FaceId> {
        let now: FxHashSet<&Corners> = now.iter().collect();
        let mut doubtful = last.far.clone();
        for face in last.corners.iter().filter(|face| !now.contains(face)) {
            let [a, b, c] = face.map(|at| DVec3::from(at.map(f64::from_bits)));
            let least = a.min(b).min(c) - REACH * self.error;
            let most = a.max(b).max(c) + REACH * self.error;
            self.input
                .bvh()
                .faces_near_box([least.into(), most.into()], |near| doubtful.push(near));
        }
        doubtful.sort_unstable();
        doubtful.dedup();
        doubtful
    }
}

impl Compared {
    /// Returns the faces that are not known to be near enough.
    fn new_faces(&self, corners: &[Corners]) -> Vec<FaceId> {
        let is_new = |face: &FaceId| !self.near.contains(&corners[face.index()]);
        (0..corners.len()).map(FaceId::new).filter(is_new).collect()
    }
}

fn corners(mesh: &Mesh, face: &[VertexId; 3]) -> Corners {
    face.map(|v| mesh.positions[v.index()].map(f64::to_bits))
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;
    use meshlod_simplify::{Options, Simplifier, Target};

    use super::*;
    use crate::bounded::Tightness;

    const SLACK: f64 = Tightness::FULL.slack;

    /// Faces that are too far away, by surface and number.
    fn far(outcome: Outcome) -> Vec<(bool, FaceId)> {
        let Outcome::Far(found) = outcome else { return Vec::new() };
        let mut faces: Vec<_> = found
            .iter()
            .map(|excess| match excess.face {
                ExcessFace::OfLevel(face) => (true, face),
                ExcessFace::OfInput(face) => (false, face),
            })
            .collect();
        faces.sort_unstable();
        faces
    }

    #[test]
    fn a_second_level_is_compared_as_if_it_were_the_first() {
        let mesh = samples::knot(4_000);
        let input = PreparedSurface::new(&mesh).unwrap();
        let error = 0.003 * mesh.bounds().diagonal();
        let mut simplifier = Simplifier::new(&mesh, &Options::default()).unwrap();
        let mut levels = [0.9, 0.25, 0.2, 0.15].map(|ratio| {
            simplifier.run(Target::Ratio(ratio), &mut ()).unwrap();
            simplifier.level()
        });
        for back in [false, true] {
            let mut comparison = Comparison::new(&mesh, &input, [error, SLACK]);
            for level in &levels {
                let alone = far(Comparison::new(&mesh, &input, [error, SLACK]).with(level));
                assert_eq!(far(comparison.with(level)), alone, "{back}");
            }
            levels.reverse();
        }
        let coarsest = far(Comparison::new(&mesh, &input, [error, SLACK]).with(&levels[3]));
        assert!(coarsest.len() > 10 && coarsest.len() < mesh.faces.len(), "{}", coarsest.len());
    }

    #[test]
    fn a_surface_is_near_itself_at_no_distance() {
        let mesh = samples::sphere(300);
        let input = PreparedSurface::new(&mesh).unwrap();
        assert!(matches!(Comparison::new(&mesh, &input, [0.0, SLACK]).with(&mesh), Outcome::Near));
        let flat = Mesh { positions: vec![[0.0; 3]; mesh.positions.len()], ..mesh.clone() };
        assert!(matches!(
            Comparison::new(&mesh, &input, [1.0, SLACK]).with(&flat),
            Outcome::NoArea
        ));
    }
}
