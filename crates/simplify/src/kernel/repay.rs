//! Repays, when a level is made, the volume that contractions still owe.
//!
//! Where a place of equal volume would spoil the shape, a contraction leaves a debt, which a later
//! one repays. What is still owed where contractions end is repaid in the level alone: the vertices
//! around move along their normals, by a common factor and by no more than a small part of an edge.
//! The smallest number of rings around the debt that can afford it takes part.
//!
//! What no rings can afford is repaid by the whole component: there the surface is off already, and
//! its vertices move by no more than that.

use std::collections::BTreeMap;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId, joined_vertices};
use rustc_hash::{FxHashMap, FxHashSet};

/// Largest displacement of a vertex, as a part of the root of its area normal, which is about two
/// edges long.
const FARTHEST: f64 = 0.02;

/// Smallest cosine by which a face may turn.
const MIN_COSINE: f64 = 0.9;

/// Number of attempts at one size, each without the vertices of faces that have turned too far.
const ATTEMPTS: usize = 4;

/// Number of steps of Newton's method, which converges quadratically from a step this small.
const NEWTON_STEPS: usize = 4;

/// Number of times that the factor of a whole component is halved: to the last bit.
const HALVINGS: usize = 64;

/// Largest number of rings around a debt. A debt that they cannot repay is its component's.
const MOST_RINGS: usize = 16;

/// Largest displacement of a vertex that repays what a component owes, as a part of the greatest
/// distance that contractions have moved the surface there. With .25 assemblies at 10 % lack up to a
/// sixtieth of their volume, with .5 and 1 none.
const OF_MOVED: f64 = 0.5;

/// Volume owed at a vertex of a level.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Debt {
    pub(crate) vertex: VertexId,
    /// Six times the volume that is missing, in cubic model units.
    pub(crate) sixfold: f64,
}

/// Limits on the displacements that repay debts.
pub(crate) struct Means<'a> {
    /// True for each vertex that stays.
    pub(crate) held: &'a [bool],
    /// Distance that contractions have moved the surface at each vertex, in model units.
    pub(crate) moved: &'a [f64],
}

/// Repays debts one after the other as far as possible, then what is left of those of each
/// component, and returns six times the volume repaid, in cubic model units. Vertices that are held
/// stay, and so do boundaries.
///
/// Cost: O(n) for n faces, if there are debts, and for each debt the size of its patch.
pub(crate) fn repay(level: &mut Mesh, debts: &[Debt], means: &Means<'_>) -> f64 {
    if debts.is_empty() {
        return 0.0;
    }
    let connectivity = Connectivity::new(&level.faces, level.positions.len());
    let stays = |v: VertexId| connectivity.marks(v).boundary() || means.held[v.index()];
    let (mut repaid, mut stuck) = (0.0, Vec::new());
    for &debt in debts {
        match repay_nearby(level, &connectivity, &stays, debt) {
            Some(gain) => repaid += gain,
            None => stuck.push(debt),
        }
    }
    repaid + repay_by_components(level, (&connectivity, &stays), &stuck, means.moved)
}

/// Repays a debt by the smallest number of rings that can afford it. Returns six times the volume.
fn repay_nearby(
    level: &mut Mesh,
    connectivity: &Connectivity,
    stays: &impl Fn(VertexId) -> bool,
    debt: Debt,
) -> Option<f64> {
    let mut patch = Patch::new(debt.vertex);
    for _ in 0..MOST_RINGS {
        if let Some(inflation) = patch.inflation(level, connectivity, stays, debt.sixfold) {
            inflation.apply(level);
            return Some(inflation.gain());
        }
        if !patch.grow(level, connectivity) {
            break;
        }
    }
    None
}

/// Repays the sum of what each component owes, all its vertices together, as far as they may go.
fn repay_by_components(
    level: &mut Mesh,
    (connectivity, stays): (&Connectivity, &impl Fn(VertexId) -> bool),
    debts: &[Debt],
    moved: &[f64],
) -> f64 {
    if debts.is_empty() {
        return 0.0;
    }
    let mut joined = joined_vertices(&level.faces, level.positions.len());
    let mut owed: BTreeMap<u32, f64> = BTreeMap::new();
    for debt in debts {
        *owed.entry(joined.find(debt.vertex.0)).or_default() += debt.sixfold;
    }
    let mut members: BTreeMap<u32, Vec<VertexId>> = BTreeMap::new();
    for v in 0..level.positions.len() as u32 {
        let of = joined.find(v);
        if owed.contains_key(&of) {
            members.entry(of).or_default().push(VertexId(v));
        }
    }
    let mut repaid = 0.0;
    for (of, vertices) in members {
        let farthest = vertices.iter().map(|v| moved[v.index()]).fold(0.0, f64::max);
        let mut patch = Patch { vertices, ..Patch::new(VertexId(of)) };
        let (owed, farthest) = (owed[&of], OF_MOVED * farthest);
        if let Some(part) = patch.deformation(level, connectivity, stays, (owed, farthest)) {
            part.apply(level);
            repaid += part.gain();
        }
    }
    repaid
}

/// A vertex and some rings around it.
struct Patch {
    vertices: Vec<VertexId>,
    contained: FxHashSet<VertexId>,
    /// Number of vertices before the outermost ring.
    inner: usize,
    /// Vertices that stay because a thin face of theirs would turn too far.
    fixed: FxHashSet<VertexId>,
}

impl Patch {
    fn new(center: VertexId) -> Self {
        Self {
            vertices: vec![center],
            contained: FxHashSet::from_iter([center]),
            inner: 0,
            fixed: FxHashSet::default(),
        }
    }

    /// Adds a ring. Returns false if there is none.
    fn grow(&mut self, level: &Mesh, connectivity: &Connectivity) -> bool {
        let outer = self.inner..self.vertices.len();
        self.inner = outer.end;
        for i in outer {
            for face in connectivity.star(self.vertices[i]) {
                for v in level.faces[face.index()] {
                    if self.contained.insert(v) {
                        self.vertices.push(v);
                    }
                }
            }
        }
        self.vertices.len() > self.inner
    }

    /// Returns the displacement that lets the patch gain a sixth of `sixfold`, or as much of it as moves
    /// no vertex farther than `farthest`; `None` if faces would turn too far.
    fn deformation(
        &mut self,
        level: &Mesh,
        connectivity: &Connectivity,
        stays: &impl Fn(VertexId) -> bool,
        (sixfold, farthest): (f64, f64),
    ) -> Option<Inflation> {
        for _ in 0..ATTEMPTS {
            let moves = |v: &VertexId| !stays(*v) && !self.fixed.contains(v);
            let moving: Vec<VertexId> = self.vertices.iter().copied().filter(moves).collect();
            let mut inflation = Inflation::along_normals(level, connectivity, &moving);
            inflation.factor = inflation.factor_within(sixfold, farthest)?;
            let turned = self.fixed.len();
            self.fixed.extend(inflation.turned());
            if self.fixed.len() == turned {
                return Some(inflation);
            }
        }
        None
    }

    /// Returns the displacement that lets the patch gain a sixth of `sixfold`; `None` if that takes it too
    /// far.
    fn inflation(
        &mut self,
        level: &Mesh,
        connectivity: &Connectivity,
        stays: &impl Fn(VertexId) -> bool,
        sixfold: f64,
    ) -> Option<Inflation> {
        for _ in 0..ATTEMPTS {
            let moves = |v: &VertexId| !stays(*v) && !self.fixed.contains(v);
            let moving: Vec<VertexId> = self.vertices.iter().copied().filter(moves).collect();
            let inflation = Inflation::gaining(sixfold, level, connectivity, &moving);
            if !inflation.is_near() {
                return None;
            }
            let turned = self.fixed.len();
            self.fixed.extend(inflation.turned());
            if self.fixed.len() == turned {
                return Some(inflation);
            }
        }
        None
    }
}

/// Displacement of vertices along their normals by a common factor.
struct Inflation {
    factor: f64,
    /// Area normals of the vertices that move: sums over their faces, each twice its area long.
    normals: Vec<(VertexId, DVec3)>,
    /// Corners of all faces that move.
    faces: Vec<[MovingCorner; 3]>,
}

/// MovingCorner of a face.
#[derive(Clone, Copy)]
struct MovingCorner {
    vertex: VertexId,
    from: DVec3,
    /// Area normal of the vertex; zero if it stays.
    normal: DVec3,
}

impl Inflation {
    /// Returns the displacement of vertices that gains a sixth of `sixfold`.
    fn gaining(
        sixfold: f64,
        level: &Mesh,
        connectivity: &Connectivity,
        moving: &[VertexId],
    ) -> Self {
        let mut inflation = Self::along_normals(level, connectivity, moving);
        let slope: f64 = inflation.normals.iter().map(|(_, n)| n.length_squared()).sum();
        inflation.factor = sixfold / slope;
        for _ in 0..NEWTON_STEPS {
            inflation.factor += (sixfold - inflation.gain()) / slope;
        }
        inflation
    }

    fn along_normals(level: &Mesh, connectivity: &Connectivity, moving: &[VertexId]) -> Self {
        let origin = moving.first().map_or(DVec3::ZERO, |v| level.positions[v.index()].into());
        let at = |v: VertexId| DVec3::from(level.positions[v.index()]) - origin;
        let area_normal = |face: &FaceId| normal(level.faces[face.index()].map(at));
        let mut faces = Vec::new();
        let mut normals = Vec::with_capacity(moving.len());
        for &v in moving {
            faces.extend_from_slice(connectivity.star(v));
            normals.push((v, connectivity.star(v).iter().map(area_normal).sum()));
        }
        faces.sort_unstable();
        faces.dedup();
        let of: FxHashMap<VertexId, DVec3> = normals.iter().copied().collect();
        let corner = |vertex: VertexId| MovingCorner {
            vertex,
            from: at(vertex),
            normal: of.get(&vertex).copied().unwrap_or_default(),
        };
        let faces = faces.iter().map(|face| level.faces[face.index()].map(corner)).collect();
        Self { factor: 0.0, normals, faces }
    }

    /// Returns six times the volume gained.
    fn gain(&self) -> f64 {
        let sixfold = |[a, b, c]: [DVec3; 3]| a.cross(b).dot(c);
        let gain = |face: &[MovingCorner; 3]| {
            sixfold(face.map(|corner| self.moved(corner))) - sixfold(face.map(|c| c.from))
        };
        self.faces.iter().map(gain).sum()
    }

    fn moved(&self, MovingCorner { from, normal, .. }: MovingCorner) -> DVec3 {
        from + self.factor * normal
    }

    /// Returns true if no vertex goes far.
    fn is_near(&self) -> bool {
        let is_near = |n: &DVec3| self.factor.abs() * n.length() <= FARTHEST * n.length().sqrt();
        self.factor.is_finite() && self.normals.iter().all(|(_, n)| is_near(n))
    }

    /// Returns the factor that gains a sixth of `sixfold`, or as much of it as moves no vertex
    /// farther than `farthest`.
    fn factor_within(&self, sixfold: f64, farthest: f64) -> Option<f64> {
        let longest = self.normals.iter().map(|(_, n)| n.length()).fold(0.0, f64::max);
        let most = (farthest / longest).copysign(sixfold);
        if !most.is_finite() {
            return None;
        }
        let [linear, square, cube] = self.gains();
        let falls_short = |t: f64| ((cube * t + square) * t + linear) * t / sixfold < 1.0;
        let (mut low, mut high) = (0.0, most);
        if falls_short(most) {
            return Some(most);
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            *(if falls_short(middle) { &mut low } else { &mut high }) = middle;
        }
        Some(low)
    }

    /// Returns the coefficients of six times the volume gained, which is a polynomial of the factor.
    fn gains(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for [a, b, c] in &self.faces {
            let around = [[a, b, c], [b, c, a], [c, a, b]];
            for [a, b, c] in around {
                sum[0] += a.normal.dot(b.from.cross(c.from));
                sum[1] += a.from.dot(b.normal.cross(c.normal));
            }
            sum[2] += a.normal.dot(b.normal.cross(c.normal));
        }
        sum
    }

    /// Returns the vertices of faces that turn too far.
    fn turned(&self) -> impl Iterator<Item = VertexId> + '_ {
        let turns = |face: &&[MovingCorner; 3]| {
            let old = normal(face.map(|corner| corner.from));
            let new = normal(face.map(|corner| self.moved(corner)));
            old.dot(new) < MIN_COSINE * old.length() * new.length()
        };
        self.faces.iter().filter(turns).flatten().map(|corner| corner.vertex)
    }

    fn apply(&self, level: &mut Mesh) {
        for &(v, normal) in &self.normals {
            let position = &mut level.positions[v.index()];
            *position = (DVec3::from(*position) + self.factor * normal).into();
        }
    }
}

/// Returns the normal of a triangle, twice its area long.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    #[test]
    fn what_cannot_be_repaid_is_not_counted() {
        let sphere = samples::sphere(2000);
        let debt = |sixfold| Debt { vertex: VertexId(7), sixfold };
        let (none_held, moved) =
            (vec![false; sphere.positions.len()], vec![0.0; sphere.positions.len()]);
        let means = Means { held: &none_held, moved: &moved };
        let mut level = sphere.clone();
        // More than a sphere of this size can gain by small moves.
        let repaid = repay(&mut level, &[debt(1e-4), debt(10.0)], &means);
        assert!((repaid / 1e-4 - 1.0).abs() < 1e-9 && level != sphere, "{repaid:e}");
        let mut level = sphere.clone();
        let all_held = vec![true; sphere.positions.len()];
        assert_eq!(repay(&mut level, &[debt(1e-4)], &Means { held: &all_held, ..means }), 0.0);
        assert_eq!(level, sphere);
    }
}
