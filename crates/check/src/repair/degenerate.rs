//! Faces without an area.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, LayerKind, Mesh, Side, Twin, VertexId, WedgeId};
use rustc_hash::FxHashSet;

use super::edit::{labels, retain_faces};
use crate::imprint::blend::to_unit_length;
use crate::zero_area::has_zero_area;

/// How often flipping starts anew: each round takes one face of a row of slivers that lie on each
/// other, and two or three rounds are what meshes need.
const ROUNDS: usize = 16;

/// The greatest star that is searched for an edge.
const MOST_AROUND: usize = 256;

/// What was done.
#[derive(Debug, Default, PartialEq)]
pub struct Mended {
    /// Edges flipped, each of which gave one face an area.
    pub flipped: usize,
    /// Faces left out.
    pub dropped: usize,
}

/// Rids a mesh of faces without an area.
///
/// One whose middle corner lies on the opposite edge shares that edge with a neighbour: the two are
/// divided anew, from the middle corner to the neighbour's tip, and the surface stays whole and
/// where it is. What cannot be helped so is left out; that a corner repeats a place leaves borders
/// on each other, which are for stitching.
pub fn mend(mesh: &mut Mesh) -> Mended {
    let repeats = |[a, b, c]: [VertexId; 3]| a == b || b == c || c == a;
    let faces = std::mem::take(&mut mesh.faces);
    let dropped = {
        mesh.faces = faces.clone();
        retain_faces(mesh, |face| !repeats(faces[face]))
    };
    let mut flipped = 0;
    for _ in 0..ROUNDS {
        let empty = without_area(mesh);
        let helped = if empty.is_empty() { 0 } else { flip_round(mesh, &empty) };
        flipped += helped;
        if helped == 0 {
            break;
        }
    }
    let empty: FxHashSet<FaceId> = without_area(mesh).into_iter().collect();
    Mended {
        flipped,
        dropped: dropped + retain_faces(mesh, |face| !empty.contains(&FaceId(face as u32))),
    }
}

fn without_area(mesh: &Mesh) -> Vec<FaceId> {
    let corners = |face: &[VertexId; 3]| face.map(|v| mesh.positions[v.index()]);
    let faces = mesh.faces.iter().enumerate();
    faces.filter(|(_, face)| has_zero_area(corners(face))).map(|(f, _)| FaceId::new(f)).collect()
}

/// Flips what can be flipped at once, and says how many.
fn flip_round(mesh: &mut Mesh, empty: &[FaceId]) -> usize {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let mut touched: FxHashSet<FaceId> = FxHashSet::default();
    let mut drawn: FxHashSet<[VertexId; 2]> = FxHashSet::default();
    let before = touched.len();
    for &face in empty {
        let Some(flip) = Flip::of(mesh, &connectivity, face) else { continue };
        let [b, d] = [flip.middle, flip.tip];
        if touched.contains(&face) || touched.contains(&flip.neighbour) {
            continue;
        }
        if drawn.insert([b.min(d), b.max(d)]) {
            flip.apply(mesh);
            touched.extend([face, flip.neighbour]);
        }
    }
    (touched.len() - before) / 2
}

/// A face whose corner `middle` lies on its opposite edge, and the face across that edge.
struct Flip {
    face: FaceId,
    /// Which corner of the face the middle is.
    corner: usize,
    middle: VertexId,
    neighbour: FaceId,
    /// Which corner of the neighbour lies opposite.
    tip_corner: usize,
    tip: VertexId,
}

impl Flip {
    /// `None` where no corner lies strictly within the opposite edge, that edge has not two faces,
    /// the neighbour has no area either, or the new edge is there already.
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
        let fits = star.len() <= MOST_AROUND
            && !has_zero_area(across.map(|v| mesh.positions[v.index()]))
            && !star.iter().any(|face| mesh.faces[face.index()].contains(&tip));
        fits.then_some(Self { face, corner, middle, neighbour, tip_corner, tip })
    }

    /// The two faces become the neighbour's halves: each has the middle in the place of one end of
    /// the edge between them.
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
        for labels in labels(mesh) {
            labels.of_face[self.face.index()] = labels.of_face[self.neighbour.index()];
        }
    }

    /// The wedge of the middle in the neighbour's halves: its own, or where a seam runs along the
    /// edge, a new one with what the neighbour has there.
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

/// Whether corner `k` of three on a line lies between the others, at neither.
fn is_between(corners: [DVec3; 3], k: usize) -> bool {
    let [at, from, to] = [corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]];
    let within = (0..3).all(|axis| {
        let (low, high) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
        low <= at[axis] && at[axis] <= high
    });
    within && at != from && at != to
}

/// Values between two wedges: of joints, those of the nearer.
fn between(kind: LayerKind, a: &[f32], b: &[f32], part: f32) -> Vec<f32> {
    if let LayerKind::Joints(_) = kind {
        return if part <= 0.5 { a.to_vec() } else { b.to_vec() };
    }
    let mut values: Vec<f32> = a.iter().zip(b).map(|(a, b)| a + (b - a) * part).collect();
    if let LayerKind::Normal | LayerKind::Tangent = kind {
        to_unit_length(&mut values[..3]);
        values[3..].copy_from_slice(&a[3..]);
    }
    values
}
