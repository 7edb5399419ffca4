//! Imprinting: cuts faces where components intersect, so that both components have the intersection
//! as edges. No vertex moves.

mod crossings;
mod cut_mesh;
pub(crate) mod interpolate;
mod points;
mod triangulate;

use meshlod_mesh::{FaceId, Mesh, VertexId};
use rustc_hash::FxHashSet;

use crate::check::CheckOptions;
use crate::check::subject::Subject;
use crate::intersect::ScaledPositions;
use crate::objects::ObjectsBy;
use cut_mesh::CutMesh;
use points::IntersectionPoints;

/// Counts of the cuts that [`imprint`] made in a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Imprint {
    /// Number of pairs of faces that intersected in more than a common corner.
    pub pairs: usize,
    /// Number of original faces that were cut.
    pub faces: usize,
    /// Number of vertices added along the cuts.
    pub vertices: usize,
}

/// Cuts faces where they intersect other components of the mesh, which must have passed
/// [`Mesh::validate`].
///
/// Afterwards both sides of an intersection have vertices at bitwise the same positions and edges
/// between them, even where intersections with several components cross in a face. In a face with
/// thousands of intersections some may be left out: at most 2^24 pairs of them are tested for
/// crossings. Vertices keep their ids, and the pieces of a face replace it in order. Attributes are
/// interpolated, except joints and their weights, which come from the nearest corner; labels are
/// those of the face. Coplanar faces that overlap are cut only where other faces pass through them.
/// Self-intersections of a component are not cut.
///
/// Cost: that of [`check`](crate::check()) for contacts, plus n log n for each cut face with n
/// points.
pub fn imprint(mesh: &Mesh) -> (Mesh, Imprint) {
    let (mut done, imprint) = at_safe_scale(mesh, |mesh| {
        let Imprinted { mesh, imprint, .. } = imprinted(mesh, |_| true);
        (mesh, imprint)
    });
    done.positions[..mesh.positions.len()].copy_from_slice(&mesh.positions);
    (done, imprint)
}

/// Applies `act` to a mesh scaled so that powers of its coordinates neither overflow nor underflow,
/// and scales the result back.
pub(crate) fn at_safe_scale<T>(mesh: &Mesh, act: impl FnOnce(&Mesh) -> (Mesh, T)) -> (Mesh, T) {
    let scale = ScaledPositions::of(&mesh.positions, &mesh.faces).scale();
    if scale == 1.0 {
        return act(mesh);
    }
    let mut scaled = mesh.clone();
    // Vertices that no face uses may be anywhere.
    let most = f64::MAX.sqrt();
    scaled
        .positions
        .as_flattened_mut()
        .iter_mut()
        .for_each(|x| *x = (*x * scale).clamp(-most, most));
    let (mut done, report) = act(&scaled);
    done.positions.as_flattened_mut().iter_mut().for_each(|x| *x /= scale);
    (done, report)
}

/// An imprinted mesh with the origin of its faces and edges.
pub(crate) struct Imprinted {
    pub(crate) mesh: Mesh,
    pub(crate) imprint: Imprint,
    /// Original face that each face came from.
    pub(crate) parents: Vec<FaceId>,
    /// Edges along which components intersect, as vertex pairs with the lower id first.
    pub(crate) contact_edges: FxHashSet<[VertexId; 2]>,
    /// Number of components that intersect others but were not to take part.
    pub(crate) left: usize,
}

/// Imprints like [`imprint`], but only the components that `takes_part` chooses, and also returns
/// the origin of faces and edges.
pub(crate) fn imprinted(mesh: &Mesh, takes_part: impl Fn(usize) -> bool) -> Imprinted {
    let options = CheckOptions { objects: ObjectsBy::Components, ..CheckOptions::default() };
    let subject = Subject::of(mesh, &options);
    let component = &subject.objects().component_of_face;
    let takes_part = |face: FaceId| takes_part(component[face.index()] as usize);
    let points = IntersectionPoints::of(&subject, takes_part);
    let mut left: Vec<u32> = Vec::new();
    for faces in subject.intersecting_pairs().pairs() {
        let of = faces.map(|face| component[face.index()]);
        if of[0] != of[1] {
            left.extend(
                faces.iter().filter(|&&face| !takes_part(face)).map(|f| component[f.index()]),
            );
        }
    }
    left.sort_unstable();
    left.dedup();
    let mut cut = CutMesh::new(mesh, subject.unique_positions(), &points);
    let mut parents = Vec::with_capacity(mesh.faces.len());
    let mut faces = 0;
    for face in (0..mesh.faces.len()).map(FaceId::new) {
        // Not along an edge that lies on one that is cut, either.
        let count = if takes_part(face) { cut.add(face) } else { cut.keep(face) };
        parents.resize(parents.len() + count, face);
        faces += usize::from(count > 1);
    }
    let (imprinted, contact_edges) = cut.finish();
    let vertices = imprinted.positions.len() - mesh.positions.len();
    let imprint = Imprint { pairs: points.pairs, faces, vertices };
    Imprinted { mesh: imprinted, imprint, parents, contact_edges, left: left.len() }
}
