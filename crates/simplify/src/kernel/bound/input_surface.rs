//! The input surface, as the error bound measures distances from it.

use std::sync::Arc;

use glam::Vec3;
use meshlod_mesh::{FaceId, Mesh};
use meshlod_spatial::{Bvh, Cover, Mates, Sheet};

use crate::kernel::mesh::local_frame::Frame;

/// Faces of the input, and the points of it that must stay near the surface: its vertices, and
/// samples along prominent edges, where the surface ends or is sharp. What lies between is then
/// near too.
pub(crate) struct InputSurface {
    faces: Arc<Bvh>,
    mates: Arc<Mates>,
    frame: Frame,
    /// Places of all vertices in the frame, copies included.
    places: Vec<Vec3>,
    /// Prominent edges.
    rims: Vec<[u32; 2]>,
}

/// Distance of a new face from the input, by the faces that lie over it.
pub(crate) enum Covered {
    /// No point of the face is farther from the input.
    Within(f32),
    /// A point is beyond the bound.
    Beyond,
    /// Undecided: they do not cover it, or are not near along its normal.
    Unknown,
}

/// Points along edges, grouped by the nearest vertex.
pub(crate) struct EdgeSamples {
    points: Vec<Vec3>,
    /// Start of each vertex's points; empty if there are no points.
    starts: Vec<u32>,
}

/// A vertex is prominent if the normals of its faces sum to less than this part of their lengths,
/// as on a ridge of 28 degrees. The sample `fish` within .3 % of the diagonal: .30 %, without such
/// points .55 %.
const SHARP: f32 = 0.97;

/// Part of the bound up to which faces that lie over a new one need not be closer: the surface then
/// counts as having travelled as far, and is measured again at the next step.
const ROUGH: f64 = 0.5;

/// The edges of a closed ring sum to zero, up to rounding errors below this fraction of their
/// length.
const CLOSED: f32 = 1e-3;

/// Largest number of points on one edge.
const MAX_EDGE_POINTS: usize = 32;

impl InputSurface {
    /// Builds the surface of a valid mesh with faces; `faces` and `places` are in the kernel's
    /// vertices.
    pub(crate) fn new(
        mesh: &Mesh,
        frame: Frame,
        places: Vec<Vec3>,
        faces: impl Iterator<Item = [u32; 3]> + Clone,
    ) -> Self {
        let rims = rims(&places, faces);
        let faces = Arc::new(Bvh::new(mesh).expect("the mesh was found valid and has faces"));
        let mates = Arc::new(Mates::new(mesh, &faces));
        Self { faces, mates, frame, places, rims }
    }

    /// Returns the hierarchy over the faces, and which of them share edges.
    pub(crate) fn hierarchy(&self) -> (Arc<Bvh>, Arc<Mates>) {
        (self.faces.clone(), self.mates.clone())
    }

    /// Returns the position of a vertex in the input.
    #[inline]
    pub(crate) fn place(&self, v: u32) -> Vec3 {
        self.places[v as usize]
    }

    /// Returns the distance between a position and the input surface, in the frame's units; any
    /// value up to `enough` if it is no larger than that, `None` beyond `max_error`. `near` is a
    /// face expected to be close.
    #[inline]
    pub(crate) fn distance(
        &self,
        place: Vec3,
        near: &mut Option<FaceId>,
        [enough, max_error]: [f32; 2],
    ) -> Option<f32> {
        let unit = self.frame.unit;
        let limits = [f64::from(enough) * unit, f64::from(max_error) * unit];
        let found = self.faces.near(self.frame.to_model(place), *near, limits)?;
        *near = Some(found.face);
        Some((found.distance_squared.sqrt() / unit) as f32)
    }

    /// Creates a search for faces of the input that cover new ones.
    pub(crate) fn sheet(&self) -> Sheet<'_> {
        Sheet::new(&self.faces, &self.mates)
    }

    /// Bounds the distances of the points of a new face from the input, by the faces of the input
    /// that lie over it; `near` is one that is close.
    pub(crate) fn covered(
        &self,
        sheet: &mut Sheet<'_>,
        face: [Vec3; 3],
        near: FaceId,
        max_error: f32,
    ) -> Covered {
        let most = f64::from(max_error) * self.frame.unit;
        match sheet.cover(
            face.map(|place| self.frame.to_model(place)),
            &[near],
            [ROUGH * most, most],
        ) {
            Cover::Within(bound) => Covered::Within((bound / self.frame.unit) as f32),
            Cover::High(at) if self.faces.near(at, Some(near), [most; 2]).is_none() => {
                Covered::Beyond
            }
            Cover::High(_) | Cover::Open => Covered::Unknown,
        }
    }

    /// Samples the prominent edges at this spacing, up to a limit on the number of samples.
    pub(crate) fn between(&self, spacing: f32) -> EdgeSamples {
        let mut found = Vec::new();
        for &[u, v] in &self.rims {
            let [from, to] = [u, v].map(|v| self.places[v as usize]);
            let count = ((from.distance(to) / spacing) as usize).min(MAX_EDGE_POINTS);
            for i in 1..=count {
                let t = i as f32 / (count + 1) as f32;
                found.push((if t < 0.5 { u } else { v }, from.lerp(to, t)));
            }
        }
        found.sort_by_key(|&(v, _)| v);
        let before = |v: usize| found.partition_point(|&(of, _)| (of as usize) < v) as u32;
        let vertices = if found.is_empty() { 0 } else { self.places.len() + 1 };
        let starts = (0..vertices).map(before).collect();
        EdgeSamples { points: found.into_iter().map(|(_, point)| point).collect(), starts }
    }
}

impl EdgeSamples {
    /// Returns the samples that are grouped at a vertex.
    #[inline]
    pub(crate) fn of(&self, v: u32) -> &[Vec3] {
        match self.starts.get(v as usize..v as usize + 2) {
            Some(&[start, end]) => &self.points[start as usize..end as usize],
            _ => &[],
        }
    }
}

/// Sums over the faces at a vertex that show whether it is prominent.
#[derive(Clone, Copy, Default)]
struct StarSums {
    normal: Vec3,
    area: f32,
    /// Sum of the edges opposite the vertex, which form a closed ring if there is no boundary.
    across: Vec3,
    length: f32,
}

impl StarSums {
    fn is_open(&self) -> bool {
        self.across.length() > CLOSED * self.length
    }

    fn stands_out(&self) -> bool {
        self.is_open() || self.normal.length() < SHARP * self.area
    }
}

/// Returns the edges at prominent vertices.
fn rims(places: &[Vec3], faces: impl Iterator<Item = [u32; 3]> + Clone) -> Vec<[u32; 2]> {
    let mut sums = vec![StarSums::default(); places.len()];
    for face in faces.clone() {
        let [a, b, c] = face.map(|v| places[v as usize]);
        let normal = (b - a).cross(c - a);
        for (v, across) in face.into_iter().zip([c - b, a - c, b - a]) {
            let sums = &mut sums[v as usize];
            sums.normal += normal;
            sums.area += normal.length();
            sums.across += across;
            sums.length += across.length();
        }
    }
    // One side is enough for an edge with two faces; a boundary edge may run in either direction.
    let is_rim = |&[u, v]: &[u32; 2]| {
        let [u_sums, v_sums] = [sums[u as usize], sums[v as usize]];
        let stand_out = u_sums.stands_out() || v_sums.stands_out();
        stand_out && (u < v || (u_sums.is_open() && v_sums.is_open()))
    };
    faces.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).filter(is_rim).collect()
}
