//! The connected components of the input that are small enough to vanish as a whole.

use meshlod_mesh::{Bounds, Mesh, VertexId, face_components, first_near};

use crate::engine::vanishing;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::{Metric, protection};
use crate::kernel::schedule::bucket_queue::{bucket, last_bucket};

/// A connected component that may be removed as a whole.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    /// Queue bucket of the component's cost.
    pub(crate) bucket: u16,
    /// Diagonal of the component's bounding box in the input, in the frame's units.
    pub(crate) size: f32,
    /// All vertices of the component.
    pub(crate) vertices: Vec<u32>,
}

/// Components that may be removed as a whole, and those that have been.
#[derive(Clone, Debug, Default)]
pub(crate) struct Components {
    /// Components that may vanish, the cheapest last.
    waiting: Vec<Component>,
    /// Components larger than the error bound.
    pub(crate) refused: Vec<Component>,
    pub(crate) vanished: Vec<Component>,
}

/// Arguments of [`Components::new`].
pub(crate) struct Pieces<'a, 'v> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) frame: &'a Frame,
    pub(crate) vertices: &'a Vertices<'v>,
    /// True for each vertex of the input that a lock or a tie holds.
    pub(crate) is_held: &'a [bool],
}

impl Components {
    /// Finds the components of an unchanged surface whose bounding box has a diagonal below
    /// `below`, in model units, and which no lock or tie holds. Components that share a position
    /// count as one: what is seen as one surface vanishes or stays as one, however its vertices are
    /// split.
    ///
    /// `faces` are those of the mesh in the kernel's vertices. Cost: linear, and n log n in the
    /// components that may vanish.
    pub(crate) fn new<M: Metric>(
        pieces: &Pieces<'_, '_>,
        faces: impl Iterator<Item = [u32; 3]>,
        below: f64,
    ) -> Self {
        let Pieces { mesh, frame, vertices, is_held } = pieces;
        let first = first_near(&mesh.positions, 0.0);
        let live: Vec<(usize, [u32; 3])> =
            faces.enumerate().filter(|(_, [a, b, c])| a != b && b != c && c != a).collect();
        let corners: Vec<[VertexId; 3]> =
            live.iter().map(|&(i, _)| mesh.faces[i].map(|v| VertexId(first[v.index()]))).collect();
        let (of_face, count) = face_components(&corners, mesh.positions.len());
        let mut found = vec![Piece::default(); count];
        for (&(i, face), &component) in live.iter().zip(&of_face) {
            let piece = &mut found[component as usize];
            let [a, b, c] = mesh.triangle(mesh.faces[i]);
            piece.area += 0.5 * (b - a).cross(c - a).length();
            piece.faces += 1;
            for (k, v) in mesh.faces[i].into_iter().enumerate() {
                piece.bounds.add(mesh.positions[v.index()]);
                piece.is_held |= is_held[v.index()];
                piece.is_protected |= vertices.get(face[k]).flags.any(VertexFlags::PROTECTED);
            }
        }
        let mut of_piece: Vec<Option<Component>> =
            found.iter().map(|piece| piece.component::<M>(frame, below)).collect();
        for (&(_, face), &component) in live.iter().zip(&of_face) {
            if let Some(component) = &mut of_piece[component as usize] {
                component.vertices.extend(face);
            }
        }
        let mut components = Self::default();
        for mut component in of_piece.into_iter().flatten() {
            component.vertices.sort_unstable();
            component.vertices.dedup();
            components.waiting.push(component);
        }
        components.sort();
        components
    }

    /// Returns the queue bucket of the cheapest component that may be removed.
    #[inline]
    pub(crate) fn next_bucket(&self) -> Option<u16> {
        self.waiting.last().map(|component| component.bucket)
    }

    /// Takes the cheapest component out of the list if its bucket is at most `last`.
    pub(crate) fn take_up_to(&mut self, last: u16) -> Option<Component> {
        let is_due = |component: &mut Component| component.bucket <= last.min(last_bucket());
        self.waiting.pop_if(is_due)
    }

    /// Makes components that an error bound has refused candidates for removal again.
    pub(crate) fn wake_all(&mut self) {
        if !self.refused.is_empty() {
            self.waiting.append(&mut self.refused);
            self.sort();
        }
    }

    fn sort(&mut self) {
        self.waiting.sort_by(|a, b| {
            b.bucket.cmp(&a.bucket).then_with(|| b.vertices.first().cmp(&a.vertices.first()))
        });
    }
}

/// A connected component of the input.
#[derive(Clone)]
struct Piece {
    bounds: Bounds,
    area: f64,
    faces: usize,
    is_held: bool,
    is_protected: bool,
}

impl Default for Piece {
    fn default() -> Self {
        let bounds = Bounds::EMPTY;
        Self { bounds, area: 0.0, faces: 0, is_held: false, is_protected: false }
    }
}

impl Piece {
    fn component<M: Metric>(&self, frame: &Frame, below: f64) -> Option<Component> {
        let size = self.bounds.diagonal();
        if size >= below || self.is_held {
            return None;
        }
        let cost = vanishing::cost(M::METHOD, size, self.area, self.faces);
        let cost = (cost / frame.unit.powi(M::METHOD.cost_power())) as f32;
        let cost = if self.is_protected { cost * protection::<M>() } else { cost };
        let size = (size / frame.unit) as f32;
        Some(Component { bucket: bucket(cost), size, vertices: Vec::new() })
    }
}
