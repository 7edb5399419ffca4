//! Corrects a simplified mesh to exactly the volume of the original, at the precision of the output
//! file.
//!
//! Rounding to `f32` alone changes a volume by 1e-9 of it and more. The volume is linear in each
//! vertex: a unit step along an axis changes six times the volume by that component of the vertex's
//! normal, which is the sum of its faces' normals, each twice the area long. Vertices are therefore
//! moved along their normals, all by the same factor, and what rounding then leaves is removed by
//! steps of one unit in the last place, which come in as many sizes as there are coordinates.

use glam::DVec3;
use meshlod_mesh::{Frame, Lock, Locks, Mesh, VertexId, closed_faces};
use meshlod_spatial::CompensatedSum;
use rustc_hash::FxHashMap;
use thiserror::Error;

/// Largest displacement of a vertex, as a fraction of the diagonal. `qem` at 10 % of the faces of
/// spot, the duck and the sample fish takes less; at 5 % spot and the duck, which have lost a
/// twentieth of their volume, take more and are refused.
const FARTHEST: f64 = 5e-3;

/// Smallest cosine by which a face may turn.
const MIN_COSINE: f64 = 0.2;

/// Sums of normals and of volume terms below this fraction of the sum of their magnitudes are
/// rounding errors.
const CANCELLED: f64 = 1e-9;

/// Fraction of the volume below which a residual is rounding error; no step is that small.
const NEGLIGIBLE_RESIDUAL: f64 = 1e-15;

/// Limit on the steps of Newton's method; few are needed.
const NEWTON_STEPS: usize = 12;

/// Number of rounds of last-place steps. Two steps on one edge also interact, by about 1e-15 of the
/// volume, which the next round corrects.
const ROUNDS: usize = 4;

/// Number format in which a file stores positions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Digits {
    /// 32-bit floats, as in binary mesh files by default.
    #[default]
    F32,
    /// Shortest decimals of 32-bit floats, which are read back as 64-bit floats, as in text files.
    Decimal,
    /// 64-bit floats, which keep positions exactly.
    F64,
}

impl Digits {
    /// Returns the value that a reader obtains for a written float.
    fn read(self, x: f32) -> f64 {
        match self {
            Self::Decimal => x.to_string().parse().unwrap_or(f64::NAN),
            _ => x.into(),
        }
    }
}

/// Relative difference in volume between a simplified mesh, as written to a file, and the original.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VolumeResidual {
    /// Difference in volume before the correction, as a fraction of the original volume.
    pub before: f64,
    /// Difference in volume after the correction, as a fraction of the original volume.
    pub after: f64,
    /// Greatest distance by which the correction moved a vertex, including rounding, in model
    /// units.
    pub farthest: f64,
}

/// Reason why the volume of a simplified mesh cannot be corrected.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ExactVolumeError {
    /// No component of the original mesh is closed and consistently oriented.
    #[error("no part of the mesh is a closed, oriented surface with a volume: see `meshlod check`")]
    OpenMesh,
    /// No component of the simplified mesh is closed and consistently oriented: the closed ones
    /// have vanished.
    #[error("no part of the level is a closed, oriented surface with a volume")]
    OpenLevel,
    /// The original mesh is closed but encloses no volume.
    #[error("the mesh encloses no volume, or parts of opposite orientation cancel")]
    Flat,
    /// The correction would move vertices by a visible distance, or turn a face over.
    #[error(
        "the level's volume is off by {relative:e}, and correcting it would move vertices by more \
         than 0.5 % of the diagonal or fold a face: use a method that conserves the volume, or fewer locks"
    )]
    TooFar {
        /// Difference in volume, as a fraction of the original volume.
        relative: f64,
    },
    /// A position is outside the range of 32-bit floats.
    #[error("the positions are out of the range of f32: write f64")]
    Unwritable,
}

/// Moves vertices of `level`, which was simplified from `mesh`, until its volume as written equals
/// that of `mesh`. Only [closed components](closed_faces) of either count.
///
/// Where the method conserves the volume, vertices move by fractions of a millionth of the diagonal;
/// otherwise by as much as the volume demands. They end on numbers of the format `digits`. Vertices
/// locked in `mesh`, those that share a position with others, and those of open components stay. The
/// remaining difference is about 1e-14 of the volume for levels of five hundred vertices; with
/// fewer vertices there are fewer steps to choose from. The residual states it. Components may
/// exchange volume.
///
/// Cost: O(faces of the mesh), a few percent of the time to make the level.
/// # Errors
/// Meshes without closed components or without volume, and levels that would have to move visibly. The level is
/// then unchanged.
pub fn conserve_volume(
    level: &mut Mesh,
    mesh: &Mesh,
    digits: Digits,
    locks: &Locks,
) -> Result<VolumeResidual, ExactVolumeError> {
    let bounds = mesh.bounds();
    let frame = Frame::of(&bounds);
    let mut wanted = VolumeSums::of(&closed(mesh), &mesh.positions, &frame);
    if wanted.lengths == 0.0 {
        // Closed all the same, if only borders that lie on each other are not sewn.
        wanted = VolumeSums::of(&mesh.faces, &mesh.positions, &frame);
        if !wanted.is_closed() {
            return Err(ExactVolumeError::OpenMesh);
        }
    }
    let faces = closed(level);
    if faces.is_empty() {
        return Err(ExactVolumeError::OpenLevel);
    }
    if wanted.volume.abs() <= CANCELLED * wanted.terms {
        return Err(ExactVolumeError::Flat);
    }
    let free = free(level, &faces, mesh, locks);
    let mut correction = VolumeCorrection { level, faces, frame, wanted: wanted.volume, free };
    correction.correct(digits, FARTHEST * bounds.diagonal())
}

/// Returns the faces of a mesh that are in closed components.
fn closed(mesh: &Mesh) -> Vec<[VertexId; 3]> {
    let is_closed = closed_faces(&mesh.faces, mesh.positions.len());
    let closed = mesh.faces.iter().zip(is_closed).filter(|(_, is_closed)| *is_closed);
    closed.map(|(face, _)| *face).collect()
}

/// Sums over the faces of a mesh for six times its volume, in a frame's units.
#[derive(Debug)]
struct VolumeSums {
    volume: f64,
    /// Sum of the absolute values of the terms.
    terms: f64,
    /// Sum of the faces' normals, zero for a closed surface.
    normal: DVec3,
    lengths: f64,
}

impl VolumeSums {
    fn of(faces: &[[VertexId; 3]], positions: &[[f64; 3]], frame: &Frame) -> Self {
        let mut sum = CompensatedSum::default();
        let (mut terms, mut normal, mut lengths) = (0.0, DVec3::ZERO, 0.0);
        for face in faces {
            let [a, b, c] = face.map(|v| frame.local(positions[v.index()]));
            let n = (b - a).cross(c - a);
            let term = a.dot(n);
            sum.add(term);
            terms += term.abs();
            normal += n;
            lengths += n.length();
        }
        Self { volume: sum.value(), terms, normal, lengths }
    }

    fn is_closed(&self) -> bool {
        self.normal.length() <= CANCELLED * self.lengths
    }
}

/// Marks the vertices of a level that may move: those of closed components that are neither locked
/// nor at the same position as another.
fn free(level: &Mesh, faces: &[[VertexId; 3]], mesh: &Mesh, locks: &Locks) -> Vec<bool> {
    let key = |p: &[f64; 3]| p.map(|x| (x + 0.0).to_bits());
    let mut at = FxHashMap::<_, u32>::default();
    for position in &level.positions {
        *at.entry(key(position)).or_default() += 1;
    }
    let locked = locks.of_vertex.iter().zip(&mesh.positions);
    for (_, position) in locked.filter(|(lock, _)| **lock == Lock::Locked) {
        at.insert(key(position), 2);
    }
    let mut free = vec![false; level.positions.len()];
    for v in faces.iter().flatten() {
        free[v.index()] = at[&key(&level.positions[v.index()])] == 1;
    }
    free
}

/// Volume correction in progress.
struct VolumeCorrection<'l> {
    level: &'l mut Mesh,
    /// Faces of the level that are in closed components.
    faces: Vec<[VertexId; 3]>,
    frame: Frame,
    /// Six times the target volume.
    wanted: f64,
    free: Vec<bool>,
}

/// Step of one coordinate to the next representable number.
struct CoordinateStep {
    /// Absolute change of six times the volume.
    gain: f64,
    coordinate: usize,
    to: f64,
}

impl VolumeCorrection<'_> {
    fn correct(
        &mut self,
        digits: Digits,
        farthest: f64,
    ) -> Result<VolumeResidual, ExactVolumeError> {
        let unmoved = self.level.positions.clone();
        let mut written = round(&unmoved, digits)?;
        let before = self.residual(&written);
        let mut places = unmoved.clone();
        self.move_along_normals(&mut places);
        let most = self.farthest(&unmoved, &places);
        if most.is_nan() || most > farthest || self.folds(&unmoved, &places) {
            return Err(ExactVolumeError::TooFar { relative: before / self.wanted });
        }
        written = round(&places, digits)?;
        let mut after = self.residual(&written);
        for _ in 0..if digits == Digits::F64 { 0 } else { ROUNDS } {
            let mut next = written.clone();
            self.step_coordinates(&mut next, after, digits);
            let left = self.residual(&next);
            if left.abs() >= after.abs() {
                break;
            }
            (written, after) = (next, left);
        }
        if after.abs() > before.abs() {
            (written, after) = (unmoved.clone(), before);
        }
        let farthest = self.farthest(&unmoved, &written);
        for ((position, to), free) in self.level.positions.iter_mut().zip(written).zip(&self.free) {
            if *free {
                *position = to;
            }
        }
        let relative = |residual: f64| residual / self.wanted;
        Ok(VolumeResidual { before: relative(before), after: relative(after), farthest })
    }

    fn residual(&self, positions: &[[f64; 3]]) -> f64 {
        VolumeSums::of(&self.faces, positions, &self.frame).volume - self.wanted
    }

    fn farthest(&self, from: &[[f64; 3]], to: &[[f64; 3]]) -> f64 {
        let moved = from.iter().zip(to).zip(&self.free).filter(|(_, free)| **free);
        let apart = |((a, b), _): ((&[f64; 3], &[f64; 3]), _)| {
            DVec3::from(*a).distance_squared(DVec3::from(*b))
        };
        moved.map(apart).fold(0.0, f64::max).sqrt()
    }

    /// Returns the normal sum of each free vertex, and zero for the others.
    fn normals(&self, positions: &[[f64; 3]]) -> Vec<DVec3> {
        let mut normals = vec![DVec3::ZERO; positions.len()];
        for face in &self.faces {
            let [a, b, c] = face.map(|v| self.frame.local(positions[v.index()]));
            let n = (b - a).cross(c - a);
            face.iter().for_each(|v| normals[v.index()] += n);
        }
        for (normal, free) in normals.iter_mut().zip(&self.free) {
            if !free {
                *normal = DVec3::ZERO;
            }
        }
        normals
    }

    /// Returns true if a face turns too far between two sets of positions.
    fn folds(&self, from: &[[f64; 3]], to: &[[f64; 3]]) -> bool {
        let normal = |positions: &[[f64; 3]], face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| self.frame.local(positions[v.index()]));
            (b - a).cross(c - a)
        };
        self.faces.iter().any(|face| {
            let (old, new) = (normal(from, face), normal(to, face));
            old.dot(new) < MIN_COSINE * old.length() * new.length()
        })
    }

    /// Moves all free vertices along their normals by a common factor until the volume matches.
    fn move_along_normals(&self, positions: &mut [[f64; 3]]) {
        // Newton's method converges quadratically; a step of several percent takes five or six.
        for _ in 0..NEWTON_STEPS {
            let residual = self.residual(positions);
            let normals = self.normals(positions);
            let slope: f64 = normals.iter().map(|n| n.length_squared()).sum();
            if residual.abs() <= NEGLIGIBLE_RESIDUAL * self.wanted.abs() || slope == 0.0 {
                return;
            }
            let by = -residual / slope / self.frame.scale();
            for (position, normal) in positions.iter_mut().zip(normals) {
                *position = (DVec3::from(*position) + normal * by).to_array();
            }
        }
    }

    /// Reduces the residual by the largest steps that do not overshoot it, one per coordinate.
    fn step_coordinates(&self, written: &mut [[f64; 3]], residual: f64, digits: Digits) {
        let least = 0.1 * NEGLIGIBLE_RESIDUAL * self.wanted.abs();
        let mut steps = Vec::new();
        for (v, normal) in self.normals(written).into_iter().enumerate() {
            for axis in 0..3 {
                let (x, slope) = (written[v][axis] as f32, normal[axis] * self.frame.scale());
                let to = if slope * residual < 0.0 { x.next_up() } else { x.next_down() };
                let to = digits.read(to);
                let gain = (slope * (to - written[v][axis])).abs();
                if gain > least && gain.is_finite() {
                    steps.push(CoordinateStep { gain, coordinate: 3 * v + axis, to });
                }
            }
        }
        let order = |a: &CoordinateStep, b: &CoordinateStep| {
            b.gain.total_cmp(&a.gain).then_with(|| a.coordinate.cmp(&b.coordinate))
        };
        steps.sort_unstable_by(order);
        let mut left = residual.abs();
        for step in steps {
            if step.gain <= left {
                left -= step.gain;
                written[step.coordinate / 3][step.coordinate % 3] = step.to;
            }
        }
    }
}

/// Rounds positions to the written format.
fn round(positions: &[[f64; 3]], digits: Digits) -> Result<Vec<[f64; 3]>, ExactVolumeError> {
    let written: Vec<[f64; 3]> = match digits {
        Digits::F64 => positions.to_vec(),
        _ => positions.iter().map(|p| p.map(|x| digits.read(x as f32))).collect(),
    };
    let finite = written.iter().flatten().all(|x| x.is_finite());
    if finite { Ok(written) } else { Err(ExactVolumeError::Unwritable) }
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures as fixtures;
    use meshlod_samples as samples;

    use super::*;
    use crate::{Method, Options, Target, contract_to};

    fn coarse(mesh: &Mesh, ratio: f64) -> Mesh {
        let options = Options { method: Method::LindstromTurk, ..Options::default() };
        contract_to(mesh, Target::Ratio(ratio), &options).unwrap().0
    }

    /// Returns the residual as a reader of the file computes it, relative to a corner of the box.
    fn as_read(level: &Mesh, mesh: &Mesh) -> f64 {
        let frame = Frame::of(&meshlod_mesh::Bounds {
            min: mesh.bounds().min,
            max: mesh.bounds().min.map(|x| x + 1.0),
        });
        let read = round(&level.positions, Digits::F32).unwrap();
        let wanted = VolumeSums::of(&mesh.faces, &mesh.positions, &frame).volume;
        VolumeSums::of(&level.faces, &read, &frame).volume / wanted - 1.0
    }

    #[test]
    fn the_written_volume_is_that_of_the_mesh() {
        for mesh in [samples::torus(20_000), samples::knot(20_000), samples::sphere(20_000)] {
            let mut level = coarse(&mesh, 0.2);
            let before = as_read(&level, &mesh);
            let unmoved = level.clone();
            let residual =
                conserve_volume(&mut level, &mesh, Digits::F32, &Locks::default()).unwrap();
            assert!((residual.before - before).abs() < 1e-13 && before.abs() > 1e-11, "{before:e}");
            assert!(residual.after.abs() <= 1e-13, "{residual:?}");
            assert!(as_read(&level, &mesh).abs() <= 1e-13);
            let apart = |(a, b): (&[f64; 3], &[f64; 3])| DVec3::from(*a).distance(DVec3::from(*b));
            let moved = level.positions.iter().zip(&unmoved.positions).map(apart);
            let farthest = moved.fold(0.0, f64::max);
            assert!(farthest <= 3e-7 * mesh.bounds().diagonal());
            assert_eq!(farthest, residual.farthest);
        }
    }

    #[test]
    fn decimals_are_corrected_as_they_are_read() {
        let mesh = samples::torus(20_000);
        let mut level = coarse(&mesh, 0.05);
        conserve_volume(&mut level, &mesh, Digits::Decimal, &Locks::default()).unwrap();
        for x in level.positions.iter().flatten() {
            assert_eq!((*x as f32).to_string().parse(), Ok(*x));
        }
        let frame = Frame::of(&mesh.bounds());
        let volume = |of: &Mesh| VolumeSums::of(&of.faces, &of.positions, &frame).volume;
        assert!((volume(&level) / volume(&mesh) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn doubles_leave_no_residual() {
        let mesh = samples::knot(20_000);
        let mut level = coarse(&mesh, 0.1);
        level.positions.iter_mut().flatten().for_each(|x| *x *= 1.0 + 1e-8);
        let residual = conserve_volume(&mut level, &mesh, Digits::F64, &Locks::default()).unwrap();
        assert!(residual.before > 1e-8 && residual.after.abs() < 1e-14, "{residual:?}");
    }

    #[test]
    fn a_face_given_twice_is_no_other_volume() {
        let mut mesh = samples::torus(2_000);
        let (count, far) = (mesh.positions.len() as u32, samples::sphere(1_000));
        mesh.positions.extend(far.positions.iter().map(|[x, y, z]| [x + 9.0, *y, *z]));
        mesh.faces.extend(far.faces.iter().map(|face| face.map(|v| VertexId(v.0 + count))));
        let volume =
            VolumeSums::of(&mesh.faces, &mesh.positions, &Frame::of(&mesh.bounds())).volume;
        mesh.faces.push(mesh.faces[7]);
        let mut level = coarse(&mesh, 0.3);
        conserve_volume(&mut level, &mesh, Digits::F64, &Locks::default()).unwrap();
        let found = VolumeSums::of(&level.faces, &level.positions, &Frame::of(&mesh.bounds()));
        assert!((found.volume / volume - 1.0).abs() < 1e-13, "{found:?}");
    }

    #[test]
    fn locked_vertices_and_those_that_meet_stay() {
        let mesh = samples::torus(5_000);
        let locked = |v: usize| if v.is_multiple_of(3) { Lock::Locked } else { Lock::Free };
        let locks =
            Locks { of_vertex: (0..mesh.positions.len()).map(locked).collect(), ties: Vec::new() };
        let mut level = mesh.clone();
        // Two tori in one place: every vertex meets another.
        let count = mesh.positions.len() as u32;
        level.positions.extend(mesh.positions.iter());
        level.faces.extend(mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + count))));
        let twice = level.clone();
        let residual = conserve_volume(&mut level, &twice, Digits::F32, &locks).unwrap();
        assert_eq!((&level, residual.farthest), (&twice, 0.0));
        assert_eq!(residual.after, residual.before);
        let mut level = mesh.clone();
        let residual = conserve_volume(&mut level, &mesh, Digits::F32, &locks).unwrap();
        assert!(residual.after.abs() < 1e-14, "{residual:?}");
        let stays = |v: usize| level.positions[v] == mesh.positions[v];
        assert!((0..mesh.positions.len()).step_by(3).all(stays));
        assert!(!(0..mesh.positions.len()).all(stays));
    }

    #[test]
    fn a_mesh_of_four_faces_reports_its_residual() {
        let mesh = fixtures::tetrahedron();
        let mut level = mesh.clone();
        level.positions[0] = level.positions[0].map(|x| x - 1e-6);
        let residual = conserve_volume(&mut level, &mesh, Digits::F32, &Locks::default()).unwrap();
        assert!(residual.after.abs() < residual.before.abs());
        assert!((as_read(&level, &mesh) - residual.after).abs() < 1e-15);
    }

    #[test]
    fn impossible_corrections_are_refused_and_change_nothing() {
        let settle = |level: &Mesh, mesh: &Mesh| {
            let mut moved = level.clone();
            let found = conserve_volume(&mut moved, mesh, Digits::F32, &Locks::default());
            assert_eq!(&moved, level);
            found.unwrap_err()
        };
        let (sphere, open) = (samples::sphere(500), fixtures::grid(4));
        assert_eq!(settle(&sphere, &open), ExactVolumeError::OpenMesh);
        assert_eq!(settle(&open, &sphere), ExactVolumeError::OpenLevel);
        let mut flat = sphere.clone();
        flat.positions.iter_mut().for_each(|p| p[2] = 0.0);
        assert_eq!(settle(&flat, &flat), ExactVolumeError::Flat);
        let mut larger = sphere.clone();
        larger.positions.iter_mut().flatten().for_each(|x| *x *= 1.03);
        assert!(matches!(settle(&larger, &sphere), ExactVolumeError::TooFar { .. }));
        let mut huge = sphere.clone();
        huge.positions.iter_mut().flatten().for_each(|x| *x *= 1e39);
        assert_eq!(settle(&huge, &huge), ExactVolumeError::Unwritable);
    }
}
