//! Removes faces of zero area.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, LayerKind, Mesh, Side, Twin, VertexId, WedgeId};
use rustc_hash::FxHashSet;

use super::edit::{copy_face_values, retain_faces};
use crate::imprint::interpolate::normalize;
use crate::zero_area::has_zero_area;

/// Maximum number of rounds of flips. Each round fixes one face of a stack of slivers; meshes need
/// two or three.
const ROUNDS: usize = 16;

/// Largest star that is searched for an existing edge.
const MOST_STAR: usize = 256;

/// Counts of the changes made to remove faces of zero area.
#[derive(Debug, Default, PartialEq)]
pub struct Removed {
    /// Number of edges flipped, each of which gave a face an area.
    pub flipped: usize,
    /// Number of faces removed.
    pub dropped: usize,
}

/// Removes the faces of zero area from a mesh.
///
/// If a corner lies on the opposite edge, that edge is flipped: the face and its neighbour become
/// the two halves of the neighbour, split from the middle corner to the neighbour's tip, and the
/// surface stays unchanged. Other faces of zero area are dropped. Where two corners coincide,
/// dropping the face leaves coincident boundary edges for stitching.
pub fn remove(mesh: &mut Mesh) -> Removed {
    let repeats = |[a, b, c]: [VertexId; 3]| a == b || b == c || c == a;
    let faces = std::mem::take(&mut mesh.faces);
    let dropped = {
        mesh.faces = faces.clone();
        retain_faces(mesh, |face| !repeats(faces[face]))
    };
    let mut flipped = 0;
    for _ in 0..ROUNDS {
        let empty = zero_area_faces(mesh);
        let count = if empty.is_empty() { 0 } else { flip_round(mesh, &empty) };
        flipped += count;
        if count == 0 {
            break;
        }
    }
    let empty: FxHashSet<FaceId> = zero_area_faces(mesh).into_iter().collect();
    Removed {
        flipped,
        dropped: dropped + retain_faces(mesh, |face| !empty.contains(&FaceId(face as u32))),
    }
}

fn zero_area_faces(mesh: &Mesh) -> Vec<FaceId> {
    let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
    let faces = mesh.faces.iter().enumerate();
    faces.filter(|(_, face)| has_zero_area(corners(face))).map(|(f, _)| FaceId::new(f)).collect()
}

/// Flips the edges that can be flipped independently; returns their number.
fn flip_round(mesh: &mut Mesh, empty: &[FaceId]) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let mut touched: FxHashSet<FaceId> = FxHashSet::default();
    let mut new_edges: FxHashSet<[VertexId; 2]> = FxHashSet::default();
    let before = touched.len();
    for &face in empty {
        let Some(flip) = Flip::of(mesh, &connectivity, face) else { continue };
        let [b, d] = [flip.middle, flip.tip];
        if touched.contains(&face) || touched.contains(&flip.neighbour) {
            continue;
        }
        if new_edges.insert([b.min(d), b.max(d)]) {
            flip.apply(mesh);
            touched.extend([face, flip.neighbour]);
        }
    }
    (touched.len() - before) / 2
}

/// Flip of an edge that contains the opposite corner `middle` of a face.
struct Flip {
    face: FaceId,
    /// Index of the middle corner in the face.
    corner: usize,
    middle: VertexId,
    neighbour: FaceId,
    /// Index of the neighbour's corner opposite the edge.
    tip_corner: usize,
    tip: VertexId,
}

impl Flip {
    /// Finds the flip for a face; `None` if no corner lies strictly inside the opposite edge, that
    /// edge does not have two faces, the neighbour also has zero area, or the new edge exists
    /// already.
    fn of(mesh: &Mesh, connectivity: &Connectivity, face: FaceId) -> Option<Self> {
        let corners = mesh.faces[face.index()];
        let corner = (0..3).find(|&k| is_between(mesh.triangle(corners), k))?;
        let Twin::Side(twin) = connectivity.twin(Side::new(face, (corner + 1) % 3)) else {
            return None;
        };
        let neighbour = twin.face();
        let across = mesh.faces[neighbour.index()];
        let tip_corner = (twin.corner() + 2) % 3;
        let (middle, tip) = (corners[corner], across[tip_corner]);
        let star = connectivity.star(middle);
        let fits = star.len() <= MOST_STAR
            && !has_zero_area(across.map(|v| mesh.positions[v.index()]))
            && !star.iter().any(|face| mesh.faces[face.index()].contains(&tip));
        fits.then_some(Self { face, corner, middle, neighbour, tip_corner, tip })
    }

    /// Replaces both faces by the halves of the neighbour, each with the middle corner in place of
    /// one end of the edge between them.
    fn apply(&self, mesh: &mut Mesh) {
        let across = mesh.faces[self.neighbour.index()];
        let ends = [(self.tip_corner + 1) % 3, (self.tip_corner + 2) % 3];
        let wedge = self.wedge(mesh, ends);
        for (face, end) in [(self.neighbour, ends[0]), (self.face, ends[1])] {
            mesh.faces[face.index()] = across;
            mesh.faces[face.index()][end] = self.middle;
        }
        if let (Some(attributes), Some(wedge)) = (&mut mesh.attributes, wedge) {
            let corners = attributes.corners[self.neighbour.index()];
            for (face, end) in [(self.neighbour, ends[0]), (self.face, ends[1])] {
                attributes.corners[face.index()] = corners;
                attributes.corners[face.index()][end] = wedge;
            }
        }
        copy_face_values(mesh, self.neighbour, self.face);
    }

    /// Returns the wedge of the middle corner in the neighbour's halves: its own or, if the edge is
    /// a seam, a new one interpolated from the neighbour's.
    fn wedge(&self, mesh: &mut Mesh, ends: [usize; 2]) -> Option<WedgeId> {
        let across = mesh.faces[self.neighbour.index()];
        let own = mesh.faces[self.face.index()];
        let [from, to] = ends.map(|k| DVec3::from(mesh.positions[across[k].index()]));
        let at = DVec3::from(mesh.positions[self.middle.index()]);
        let part = at.distance(from) / to.distance(from);
        let attributes = mesh.attributes.as_mut()?;
        let [own_corners, corners] =
            [self.face, self.neighbour].map(|f| attributes.corners[f.index()]);
        let seamless = ends.iter().all(|&k| {
            let l = own.iter().position(|&v| v == across[k]);
            l.is_some_and(|l| own_corners[l] == corners[k])
        });
        if seamless {
            return Some(own_corners[self.corner]);
        }
        let [from, to] = ends.map(|k| corners[k]);
        for layer in &mut attributes.layers {
            let (a, b) = (layer.of(from).to_vec(), layer.of(to).to_vec());
            layer.values.extend(between(layer.kind, &a, &b, part as f32));
        }
        attributes.wedge_count += 1;
        Some(WedgeId::new(attributes.wedge_count - 1))
    }
}

/// Returns true if corner `k` of three collinear ones lies strictly between the others.
fn is_between(corners: [DVec3; 3], k: usize) -> bool {
    let [at, from, to] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    let within = (0..3).all(|axis| {
        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        low <= at[axis] && at[axis] <= high
    });
    within && at != from && at != to
}

/// Interpolates the values of two wedges; joints and labels come from the nearer one.
fn between(kind: LayerKind, a: &[f32], b: &[f32], part: f32) -> Vec<f32> {
    if matches!(kind, LayerKind::Joints(_) | LayerKind::Label) {
        return if part <= 0.5 { a.to_vec() } else { b.to_vec() };
    }
    let mut values: Vec<f32> = a.iter().zip(b).map(|(a, b)| a + (b - a) * part).collect();
    if let LayerKind::Normal | LayerKind::Tangent = kind {
        normalize(&mut values[..3]);
        values[3..].copy_from_slice(&a[3..]);
    }
    values
}
