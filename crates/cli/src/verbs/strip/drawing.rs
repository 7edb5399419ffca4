//! Strips of faces by what is asked on the command line, and the faces that they are held against.

use meshlod::mesh::{FaceId, VertexId};
use meshlod::simplify::Simplifier;
use meshlod::strip::{self, Strips};
use meshlod::{Mesh, Method, Options, SimplifyError, Target};

use super::{Quality, Tried};

/// Strips of some faces.
pub(super) fn stripify(faces: &[[VertexId; 3]], quality: Quality, effort: Tried) -> Strips {
    let quality = match (quality, effort) {
        (Quality::Fast, _) => strip::Quality::Fast,
        (Quality::Best, Tried::Quick) => strip::Quality::Best { moves_per_face: 40.0 },
        (Quality::Best, Tried::Thorough) => strip::Quality::Best { moves_per_face: 1000.0 },
    };
    strip::stripify(faces, &strip::Options { quality, ..strip::Options::default() })
}

/// A simplification of its own, for levels from fine to coarse.
pub(super) struct Engine<'m>(Simplifier<'m>);

impl<'m> Engine<'m> {
    pub(super) fn new(mesh: &'m Mesh) -> Result<Self, SimplifyError> {
        let options = Options { method: Method::QemEndpoint, ..Options::default() };
        Ok(Self(Simplifier::new(mesh, &options)?))
    }

    /// The faces of the level of so many, by the vertices of the mesh.
    pub(super) fn faces(&mut self, count: usize) -> Result<Vec<[VertexId; 3]>, SimplifyError> {
        self.0.run(Target::Faces(count), &mut ())?;
        let surface = self.0.surface();
        let ids = (0..surface.face_count()).map(FaceId::new);
        Ok(ids.filter(|&face| surface.is_alive(face)).map(|face| surface.face(face)).collect())
    }
}
