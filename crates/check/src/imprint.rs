//! Imprinting: faces that meet those of another component are cut along the line where they do, so
//! that both have it as edges. Nothing moves.

pub(crate) mod blend;
mod crossings;
mod cut;
mod pieces;
mod spots;

use meshlod_mesh::{FaceId, Mesh, VertexId};
use rustc_hash::FxHashSet;

use crate::check::CheckOptions;
use crate::check::subject::Subject;
use crate::intersect::Points;
use crate::objects::ObjectsBy;
use pieces::Pieces;
use spots::Spots;

/// What imprinting did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Imprint {
    /// Pairs of faces that met otherwise than in a corner of both.
    pub pairs: usize,
    /// Faces that were cut.
    pub faces: usize,
    /// Vertices that came of it.
    pub vertices: usize,
}

/// Cuts the faces of a mesh that has passed [`Mesh::validate`] along the lines where they meet those
/// of other components.
///
/// Afterwards both have vertices at the same places along such a line, to the bit, and edges between
/// them, also where lines of several components cross in a face. In a face with thousands of lines
/// some may be left out: 2^24 pairs of them are looked at. Vertices keep their ids; the pieces of a
/// face stand where it stood. Attributes are interpolated, but joints and their
/// weights are those of the nearest corner; labels are those of the face. Faces that overlap in one
/// plane are cut only where others pass through them; no component is cut by itself.
///
/// Cost: that of [`check`](crate::check()) for what meets, and for each face that is cut its
/// points times their logarithm.
pub fn imprint(mesh: &Mesh) -> (Mesh, Imprint) {
    let (mut done, imprint) = at_fitting_size(mesh, |mesh| {
        let Imprinted { mesh, imprint, .. } = imprinted(mesh);
        (mesh, imprint)
    });
    done.positions[..mesh.positions.len()].copy_from_slice(&mesh.positions);
    (done, imprint)
}

/// Does something with a mesh whose coordinates have a size at which their powers stay in range.
pub(crate) fn at_fitting_size<T>(mesh: &Mesh, act: impl FnOnce(&Mesh) -> (Mesh, T)) -> (Mesh, T) {
    let scale = Points::of(&mesh.positions, &mesh.faces).scale();
    if scale == 1.0 {
        return act(mesh);
    }
    let mut fitting = mesh.clone();
    // What no face uses may be anywhere.
    let most = f64::MAX.sqrt();
    fitting
        .positions
        .as_flattened_mut()
        .iter_mut()
        .for_each(|x| *x = (*x * scale).clamp(-most, most));
    let (mut done, report) = act(&fitting);
    done.positions.as_flattened_mut().iter_mut().for_each(|x| *x /= scale);
    (done, report)
}

/// A mesh with its faces in pieces.
pub(crate) struct Imprinted {
    pub(crate) mesh: Mesh,
    pub(crate) imprint: Imprint,
    /// The face that each is of.
    pub(crate) parents: Vec<FaceId>,
    /// The edges along which it meets others, the lower vertex first.
    pub(crate) lines: FxHashSet<[VertexId; 2]>,
}

/// The same as [`imprint`], with all that is known.
pub(crate) fn imprinted(mesh: &Mesh) -> Imprinted {
    let options = CheckOptions { objects: ObjectsBy::Components, ..CheckOptions::default() };
    let subject = Subject::of(mesh, &options);
    let spots = Spots::of(&subject);
    let mut pieces = Pieces::new(mesh, subject.places(), &spots);
    let mut parents = Vec::with_capacity(mesh.faces.len());
    let mut faces = 0;
    for face in (0..mesh.faces.len()).map(FaceId::new) {
        let count = pieces.add(face);
        parents.resize(parents.len() + count, face);
        faces += usize::from(count > 1);
    }
    let (imprinted, lines) = pieces.finish();
    let vertices = imprinted.positions.len() - mesh.positions.len();
    let imprint = Imprint { pairs: spots.pairs, faces, vertices };
    Imprinted { mesh: imprinted, imprint, parents, lines }
}
