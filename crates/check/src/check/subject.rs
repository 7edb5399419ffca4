//! What the kinds share: the faces that take part, and what is derived from them once.

use std::borrow::Cow;
use std::cell::OnceCell;

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};

use super::CheckOptions;
use crate::intersect::{Ground, Meetings};
use crate::objects::Objects;
use crate::places::Places;

/// A mesh under check. What is derived is made when the first kind asks for it.
pub struct Subject<'a> {
    pub mesh: &'a Mesh,
    options: &'a CheckOptions,
    /// The faces that take part. Those that cannot stand here as [`LEFT_OUT`], so that ids stay.
    pub faces: Cow<'a, [[VertexId; 3]]>,
    /// Whether all faces take part.
    pub all_sound: bool,
    connectivity: OnceCell<Connectivity>,
    places: OnceCell<Places>,
    used: OnceCell<Vec<bool>>,
    objects: OnceCell<Objects>,
    meetings: OnceCell<Meetings>,
}

/// What stands for a face that takes no part: it repeats a vertex, so that [`Connectivity`] leaves
/// it out, and no mesh has that vertex.
pub const LEFT_OUT: [VertexId; 3] = [VertexId(u32::MAX); 3];

impl<'a> Subject<'a> {
    pub fn of(mesh: &'a Mesh, options: &'a CheckOptions) -> Self {
        let faces = sound_faces(mesh);
        Self {
            mesh,
            options,
            all_sound: matches!(faces, Cow::Borrowed(_)),
            faces,
            connectivity: OnceCell::new(),
            places: OnceCell::new(),
            used: OnceCell::new(),
            objects: OnceCell::new(),
            meetings: OnceCell::new(),
        }
    }

    pub fn connectivity(&self) -> &Connectivity {
        self.connectivity.get_or_init(|| Connectivity::new(&self.faces, self.mesh.positions.len()))
    }

    pub fn places(&self) -> &Places {
        self.places.get_or_init(|| Places::of(&self.mesh.positions))
    }

    pub fn objects(&self) -> &Objects {
        self.objects.get_or_init(|| Objects::of(self.mesh, self.options.objects))
    }

    pub fn meetings(&self) -> &Meetings {
        self.meetings.get_or_init(|| {
            let ground = Ground {
                positions: &self.mesh.positions,
                faces: &self.faces,
                connectivity: self.connectivity(),
                places: self.places(),
                objects: self.objects(),
            };
            Meetings::of(&ground, self.options.net)
        })
    }

    /// One flag per vertex: does any face name it, also one that takes no part?
    pub fn used(&self) -> &[bool] {
        self.used.get_or_init(|| {
            let mut used = vec![false; self.mesh.positions.len()];
            for v in self.mesh.faces.iter().flatten() {
                if let Some(used) = used.get_mut(v.index()) {
                    *used = true;
                }
            }
            used
        })
    }

    /// The faces that take part, with their ids.
    pub fn sound(&self) -> impl Iterator<Item = (FaceId, [VertexId; 3])> + '_ {
        let faces = self.faces.iter().enumerate();
        faces.filter(|(_, face)| **face != LEFT_OUT).map(|(f, &face)| (FaceId(f as u32), face))
    }
}

/// The faces of a mesh, those that name a vertex that is not there or not finite replaced by
/// [`LEFT_OUT`].
fn sound_faces(mesh: &Mesh) -> Cow<'_, [[VertexId; 3]]> {
    let count = mesh.positions.len();
    let finite = |v: &[f64; 3]| v.iter().all(|x| x.is_finite());
    let all_finite = mesh.positions.iter().all(finite);
    if all_finite && mesh.faces.iter().flatten().all(|v| v.index() < count) {
        return Cow::Borrowed(&mesh.faces);
    }
    let sound = |face: &[VertexId; 3]| {
        face.iter().all(|v| mesh.positions.get(v.index()).is_some_and(finite))
    };
    mesh.faces.iter().map(|face| if sound(face) { *face } else { LEFT_OUT }).collect()
}
