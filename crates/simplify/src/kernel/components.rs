//! The connected components of the input, each of which may vanish as a whole.

use std::borrow::Cow;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::Vec3;
use meshlod_mesh::{Bounds, FaceId, Mesh, VertexId, face_components};
use meshlod_spatial::LabelledBvh;
use rayon::prelude::*;

use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::schedule::bucket_queue::{bucket, last_bucket};
use crate::kernel::setup::vertex_order::is_face;

/// Largest number of faces of a component that are sampled.
const SAMPLED_FACES: usize = 24;

/// Components that may vanish take part from the start if they have more than one face in this many.
const EARLY_SHARE: usize = 32;

/// Weights of a face's centre and of each of its corners in the mean square distance. For a
/// quadratic function they give the exact mean.
const AT_CENTRE: f32 = 0.75;
const AT_CORNER: f32 = 1.0 / 12.0;

/// A connected component of the input.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    /// Diagonal of the bounding box, in the frame's units.
    size: f32,
    /// Area, in the frame's units.
    area: f32,
    /// Factor on the cost of removing it.
    protection: f32,
    /// True if a lock or a tie holds a vertex of it.
    is_held: bool,
    faces: Range<usize>,
    vertices: Range<usize>,
    samples: Range<usize>,
}

/// Sample point on the surface of a component, and its weight.
#[derive(Clone, Copy, Debug)]
struct WeightedPoint {
    place: Vec3,
    weight: f32,
}

/// Square distances of a component from what remains without it, in the frame's units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Apart {
    pub(crate) mean: f32,
    pub(crate) greatest: f32,
}

/// Connected components that may be removed as a whole, and those that have been.
pub(crate) struct Components {
    all: Vec<Component>,
    /// Vertices of all components, one component after the other.
    vertices: Vec<u32>,
    samples: Vec<WeightedPoint>,
    /// Faces of all components, one component after the other.
    faces: Vec<u32>,
    frame: Frame,
    /// The faces of the input that have not vanished, labelled by component.
    input: LabelledBvh,
    /// Components that may vanish, by a lower bound of the bucket of their cost.
    waiting: BinaryHeap<Reverse<(u16, u32)>>,
    /// Components that have been refused.
    refused: Vec<u32>,
    vanished: Vec<u32>,
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
    /// Finds the components of an unchanged surface. All but the largest may vanish whose bounding
    /// box has a diagonal below `below`, in model units, and which no lock or tie holds. Returns
    /// `None` if there are no such components.
    ///
    /// `faces` are those of the mesh in the kernel's vertices. Cost: O(n log n), n = faces.
    pub(crate) fn new<M: Metric>(
        pieces: &Pieces<'_, '_>,
        faces: impl Iterator<Item = [u32; 3]> + Clone,
        below: f64,
    ) -> Option<Self> {
        let mesh = pieces.mesh;
        let mut corners = Cow::Borrowed(&mesh.faces);
        if !faces.clone().all(is_face) {
            // Faces that are left out join nothing.
            let joined = |(now, face): ([u32; 3], &[VertexId; 3])| match is_face(now) {
                true => *face,
                false => [face[0]; 3],
            };
            corners = Cow::Owned(faces.clone().zip(&mesh.faces).map(joined).collect());
        }
        let (of_face, count) = face_components(&corners, mesh.positions.len());
        if count < 2 {
            return None;
        }
        let mut components = Self::survey(pieces, faces, of_face, count);
        let all = &components.all;
        let by_area = |a: &usize, b: &usize| all[*a].area.total_cmp(&all[*b].area).then(b.cmp(a));
        let largest = (0..count).max_by(by_area);
        let below = (below / pieces.frame.unit) as f32;
        let may_vanish = |&i: &usize| {
            let Component { size, area, is_held, .. } = all[i];
            Some(i) != largest && size < below && area > 0.0 && !is_held
        };
        let found: Vec<usize> = (0..count).filter(may_vanish).collect();
        let entry = |&i: &usize| {
            let apart = components.apart(i as u32);
            Reverse((components.bucket::<M>(i as u32, &apart, all[i].faces.len()), i as u32))
        };
        let waiting: Vec<_> = found.par_iter().map(entry).collect();
        components.waiting = waiting.into();
        (!components.waiting.is_empty()).then_some(components)
    }

    /// Measures and samples all components.
    fn survey(
        pieces: &Pieces<'_, '_>,
        faces: impl Iterator<Item = [u32; 3]>,
        mut of_face: Vec<u32>,
        count: usize,
    ) -> Self {
        let mut lists = vec![Vec::new(); count];
        let mut vertices = vec![Vec::new(); count];
        for (i, face) in faces.enumerate() {
            let component = &mut of_face[i];
            if is_face(face) {
                lists[*component as usize].push(i);
                vertices[*component as usize].extend(face);
            } else {
                *component = count as u32;
            }
        }
        let left_out: Vec<usize> =
            (0..of_face.len()).filter(|&i| of_face[i] == count as u32).collect();
        let mut input = LabelledBvh::new(pieces.mesh, of_face).expect("the mesh was found valid");
        left_out.into_iter().for_each(|i| input.remove(FaceId::new(i)));
        let mut components = Self {
            all: Vec::with_capacity(count),
            vertices: Vec::new(),
            samples: Vec::new(),
            faces: Vec::new(),
            frame: *pieces.frame,
            input,
            waiting: BinaryHeap::new(),
            refused: Vec::new(),
            vanished: Vec::new(),
        };
        for (faces, vertices) in lists.into_iter().zip(vertices) {
            components.add(pieces, &faces, vertices);
        }
        components
    }

    /// Measures and samples a component, given its faces and the vertices at their corners.
    fn add(&mut self, pieces: &Pieces<'_, '_>, faces: &[usize], mut own: Vec<u32>) {
        let &Pieces { mesh, frame, vertices, is_held } = pieces;
        own.sort_unstable();
        own.dedup();
        let (mut bounds, mut held) = (Bounds::EMPTY, false);
        for v in faces.iter().flat_map(|&i| mesh.faces[i]) {
            bounds.add(mesh.positions[v.index()]);
            held |= is_held[v.index()];
        }
        let is_protected = |v: &u32| vertices.get(*v).flags.any(VertexFlags::PROTECTED);
        let protection = if own.iter().any(is_protected) { vertices.protection } else { 1.0 };
        let places = |i: usize| mesh.faces[i].map(|v| frame.to_local(mesh.positions[v.index()]));
        let triangles: Vec<[Vec3; 3]> = faces.iter().map(|&i| places(i)).collect();
        let (first, start) = (self.vertices.len(), self.samples.len());
        self.sample(&triangles);
        self.vertices.extend(own);
        self.all.push(Component {
            size: (bounds.diagonal() / frame.unit) as f32,
            area: triangles.iter().map(area).sum(),
            protection,
            is_held: held,
            faces: self.faces.len()..self.faces.len() + faces.len(),
            vertices: first..self.vertices.len(),
            samples: start..self.samples.len(),
        });
        self.faces.extend(faces.iter().map(|&i| i as u32));
    }

    /// Samples a component at the centres and corners of some of its faces.
    fn sample(&mut self, triangles: &[[Vec3; 3]]) {
        for triangle in triangles.iter().step_by(triangles.len().div_ceil(SAMPLED_FACES).max(1)) {
            let area = area(triangle);
            let centre = triangle.iter().sum::<Vec3>() / 3.0;
            self.samples.push(WeightedPoint { place: centre, weight: AT_CENTRE * area });
            let corner = |&place: &Vec3| WeightedPoint { place, weight: AT_CORNER * area };
            self.samples.extend(triangle.iter().map(corner));
        }
    }

    /// Measures how far a component is from the input without it and without what has vanished.
    pub(crate) fn apart(&self, component: u32) -> Apart {
        let to_frame = self.frame.unit.powi(-2);
        let (mut sum, mut weights, mut greatest) = (0.0, f32::MIN_POSITIVE, 0.0f32);
        for &WeightedPoint { place, weight } in
            &self.samples[self.all[component as usize].samples.clone()]
        {
            let squared = self.input.squared_distance(self.frame.to_model(place), component);
            let squared = (squared * to_frame) as f32;
            sum += weight * squared;
            weights += weight;
            greatest = greatest.max(squared);
        }
        Apart { mean: sum / weights, greatest }
    }

    /// Returns the bucket of the cost of removing a component that has `faces` faces left.
    pub(crate) fn bucket<M: Metric>(&self, component: u32, apart: &Apart, faces: usize) -> u16 {
        let Component { area, protection, .. } = self.all[component as usize];
        let cost = M::vanishing_cost(area, faces as f32, apart.mean) * protection;
        bucket(cost).min(last_bucket())
    }

    /// Returns the squared distance that counts when a component vanishes: its distance from the
    /// rest, but at most its size.
    pub(crate) fn loss(&self, component: u32, apart: &Apart) -> f32 {
        apart.greatest.min(self.all[component as usize].size.powi(2))
    }

    /// Returns true if components that may vanish have a good part of this many faces: then they
    /// must take part from the start.
    pub(crate) fn are_many(&self, faces: usize) -> bool {
        let faces_of = |entry: &Reverse<(u16, u32)>| self.all[entry.0.1 as usize].faces.len();
        self.waiting.iter().map(faces_of).sum::<usize>() > faces / EARLY_SHARE
    }

    /// Returns the number of components of the input.
    pub(crate) fn count(&self) -> usize {
        self.all.len()
    }

    /// Returns the vertices of a component.
    pub(crate) fn vertices(&self, component: u32) -> &[u32] {
        &self.vertices[self.all[component as usize].vertices.clone()]
    }

    /// Returns a lower bound of the bucket of the cheapest component that may be removed.
    #[inline]
    pub(crate) fn next_bucket(&self) -> Option<u16> {
        self.waiting.peek().map(|Reverse((bucket, _))| *bucket)
    }

    /// Takes the first component whose bucket is at most `last` out of the queue.
    pub(crate) fn take_up_to(&mut self, last: u16) -> Option<u32> {
        self.next_bucket().filter(|&bucket| bucket <= last.min(last_bucket()))?;
        self.waiting.pop().map(|Reverse((_, component))| component)
    }

    /// Queues a component.
    pub(crate) fn put_back(&mut self, component: u32, bucket: u16) {
        self.waiting.push(Reverse((bucket, component)));
    }

    /// Sets a component aside that is refused, until all are made eligible again.
    pub(crate) fn refuse(&mut self, component: u32) {
        self.refused.push(component);
    }

    /// Removes a component for good.
    pub(crate) fn remove(&mut self, component: u32) {
        for &face in &self.faces[self.all[component as usize].faces.clone()] {
            self.input.remove(FaceId(face));
        }
        self.vanished.push(component);
    }

    /// Returns the components that have vanished, in their order.
    pub(crate) fn vanished(&self) -> &[u32] {
        &self.vanished
    }

    /// Makes components that were refused candidates for removal again.
    pub(crate) fn wake_all(&mut self) {
        for component in std::mem::take(&mut self.refused) {
            self.put_back(component, 0);
        }
    }
}

fn area([a, b, c]: &[Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}
