//! The connected components of the input, each of which may vanish as a whole.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use glam::Vec3;
use meshlod_mesh::UnionFind;
use meshlod_spatial::{PartBvh, PartBvhBuilder};

use crate::kernel::apart::{Apart, ComponentSamples, area};
use crate::kernel::coats::{Imprint, pair};
use crate::kernel::handles::PER_CUT;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::schedule::bucket_queue::{bucket, last_bucket};
use crate::kernel::setup::vertex_order::{Order, is_face};

/// Components that may vanish take part from the start if they have more than one face in this many.
const EARLY_SHARE: usize = 32;

/// Component of vertices without faces.
const NO_COMPONENT: u32 = u32::MAX;

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
    /// Number of faces at first.
    faces: u32,
    /// The component that is its other coat.
    coat: Option<u32>,
    vertices: Range<usize>,
}

/// Connected components that may be removed as a whole, and those that have been.
pub(crate) struct Components {
    all: Vec<Component>,
    /// Vertices of all components, one component after the other.
    vertices: Vec<u32>,
    /// Component of each vertex.
    of_vertex: Vec<u32>,
    /// Number of faces left of each component, if they are [counted](Self::are_counted).
    faces_left: Vec<u32>,
    /// True if the numbers of faces are those of the surface, which they are while it is one part.
    are_counted: bool,
    samples: ComponentSamples,
    /// The faces of the input that have not vanished, by component.
    input: PartBvh,
    /// Components that may vanish, by a lower bound of the bucket of their cost.
    waiting: BinaryHeap<Reverse<(u16, u32)>>,
    /// Components that have been refused.
    refused: Vec<u32>,
    vanished: Vec<u32>,
}

/// Arguments of [`Components::new`].
pub(crate) struct Pieces<'a, 'v> {
    pub(crate) frame: &'a Frame,
    pub(crate) order: &'a Order,
    pub(crate) vertices: &'a Vertices<'v>,
    /// True for each vertex of the input that a lock or a tie holds.
    pub(crate) is_held: &'a [bool],
    /// True if a component needs its other coat.
    pub(crate) single_sided: bool,
}

/// Cost of removing a component.
pub(crate) enum VanishingCost {
    /// It lies at least in this bucket.
    AtLeast(u16),
    /// It lies in this bucket, and this is how far the component is apart.
    Exactly(u16, Apart),
}

impl Components {
    /// Finds the components of an unchanged surface. All but the largest may vanish whose bounding
    /// box has a diagonal below `below`, in model units, and which no lock or tie holds. Returns
    /// `None` if there are no such components.
    ///
    /// `faces` are those of the input in the kernel's vertices; copies of a vertex are in one
    /// component. Cost: O(n), n = faces, and O(c log c), c = components.
    pub(crate) fn new(
        pieces: &Pieces<'_, '_>,
        faces: impl Iterator<Item = [u32; 3]> + Clone,
        below: f64,
    ) -> Option<Self> {
        let (joined, joins) = join(pieces.vertices, faces.clone());
        let with_faces = pieces.vertices.all.iter().filter(|vertex| vertex.len > 0).count();
        if pieces.vertices.copies().is_empty() && joins + 1 == with_faces {
            return None;
        }
        let (of_vertex, count) = number(pieces.vertices, faces, joined);
        if count < 2 {
            return None;
        }
        let mut components = Self::survey(pieces, of_vertex, count);
        let all = &components.all;
        let by_area = |a: &usize, b: &usize| all[*a].area.total_cmp(&all[*b].area).then(b.cmp(a));
        let largest = (0..count).max_by(by_area);
        let below = (below / pieces.frame.unit) as f32;
        let may_vanish = |&i: &usize| {
            let Component { size, area, is_held, .. } = all[i];
            Some(i) != largest && size < below && area > 0.0 && !is_held
        };
        components.waiting =
            (0..count).filter(may_vanish).map(|i| Reverse((0, i as u32))).collect();
        (!components.waiting.is_empty()).then_some(components)
    }

    /// Measures and samples all components.
    fn survey(pieces: &Pieces<'_, '_>, of_vertex: Vec<u32>, count: usize) -> Self {
        let (vertices, ends) = by_component(&of_vertex, count);
        let mut builder = PartBvhBuilder::default();
        let mut samples = ComponentSamples::default();
        let mut slots = vec![u32::MAX; of_vertex.len()];
        let mut all = Vec::with_capacity(count);
        let mut imprints = Vec::new();
        let mut faces = Vec::new();
        let mut start = 0;
        for end in ends {
            let own = &vertices[start..end];
            faces.clear();
            own.iter().for_each(|&v| faces_at(pieces.vertices, v, &mut faces));
            let place = |v: u32| pieces.vertices.get(v).place();
            // `map` over an array is not inlined.
            builder.add(faces.iter().map(|&[a, b, c]: &[u32; 3]| [place(a), place(b), place(c)]));
            samples.add(&faces, place, &mut slots);
            if pieces.single_sided {
                imprints.push(Imprint::of(own, &faces, place));
            }
            all.push(Component::new(pieces, own, &faces, start..end));
            start = end;
        }
        for (component, coat) in all.iter_mut().zip(pair(&imprints)) {
            component.coat = coat;
        }
        Self {
            faces_left: all.iter().map(|component| component.faces).collect(),
            all,
            vertices,
            of_vertex,
            are_counted: true,
            samples,
            input: builder.build(),
            waiting: BinaryHeap::new(),
            refused: Vec::new(),
            vanished: Vec::new(),
        }
    }

    /// Returns the cost of removing a component, measured as far as is needed to tell whether it is
    /// beyond the bucket `last`.
    pub(crate) fn cost<M: Metric>(&mut self, component: u32, last: u16) -> VanishingCost {
        let Component { area, protection, coat, .. } = self.all[component as usize];
        let faces = self.faces_left[component as usize] as f32;
        let bucket_of = |mean_square: f32| {
            let cost = M::vanishing_cost(area, faces, mean_square) * protection;
            bucket(cost).min(last_bucket())
        };
        let is_beyond = |mean_square: f32| bucket_of(mean_square) > last;
        match self.samples.measure([component, coat.unwrap_or(component)], &self.input, is_beyond) {
            Ok(apart) => VanishingCost::Exactly(bucket_of(apart.mean), apart),
            Err(least) => VanishingCost::AtLeast(bucket_of(least)),
        }
    }

    /// Returns the squared distance that counts when a component vanishes: its distance from the
    /// rest, but at most its size.
    pub(crate) fn loss(&self, component: u32, apart: &Apart) -> f32 {
        apart.greatest.min(self.all[component as usize].size.powi(2))
    }

    /// Returns true if components that may vanish have a good part of this many faces: then they
    /// must take part from the start.
    pub(crate) fn are_many(&self, faces: usize) -> bool {
        let faces_of = |entry: &Reverse<(u16, u32)>| self.all[entry.0.1 as usize].faces as usize;
        self.waiting.iter().map(faces_of).sum::<usize>() > faces / EARLY_SHARE
    }

    /// Returns the number of components of the input.
    pub(crate) fn number(&self) -> usize {
        self.all.len()
    }

    /// Returns true if a vertex belongs to a component.
    pub(crate) fn has(&self, component: u32, v: u32) -> bool {
        self.of_vertex.get(v as usize) == Some(&component)
    }

    /// Adds the copies of vertices at a cut, and the faces that close it for a moment.
    pub(crate) fn cut(&mut self, copies: [[u32; 2]; PER_CUT], faces: u32) {
        for [v, copy] in copies {
            let of = self.of_vertex[v as usize];
            self.of_vertex.resize(copy as usize + 1, NO_COMPONENT);
            self.of_vertex[copy as usize] = of;
        }
        let of_cut = self.of_vertex[copies[0][0] as usize];
        if let Some(left) = self.faces_left.get_mut(of_cut as usize) {
            *left += faces;
        }
    }

    /// Counts the faces left of all components, unless they are known, as they are while the
    /// surface is one part.
    pub(crate) fn count(&mut self, vertices: &mut Vertices<'_>) {
        if std::mem::replace(&mut self.are_counted, true) {
            return;
        }
        let mut corners = vec![0_u32; self.all.len()];
        for v in vertices.ids() {
            if vertices.get(v).flags.any(VertexFlags::DEAD) {
                continue;
            }
            vertices.refresh(v);
            // Vertices for cuts to come belong to none.
            let Some(&of) = self.of_vertex.get(v as usize) else { continue };
            if let Some(count) = corners.get_mut(of as usize) {
                *count += faces_around(vertices, v);
            }
        }
        self.faces_left = corners.into_iter().map(|corners| corners / 3).collect();
    }

    /// Says that contractions go uncounted while the surface is in several parts.
    pub(crate) fn lose_count(&mut self) {
        self.are_counted = false;
    }

    /// Counts faces that are lost at a vertex.
    #[inline(always)]
    pub(crate) fn lose(&mut self, v: u32, faces: usize) {
        if let Some(left) = self.faces_left.get_mut(self.of_vertex[v as usize] as usize) {
            *left = left.saturating_sub(faces as u32);
        }
    }

    /// Returns the number of faces left of a component.
    pub(crate) fn faces_left(&self, component: u32) -> usize {
        self.faces_left[component as usize] as usize
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
        self.input.remove(component);
        self.faces_left[component as usize] = 0;
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

impl Component {
    /// Measures a component, given its vertices and faces.
    fn new(
        pieces: &Pieces<'_, '_>,
        own: &[u32],
        faces: &[[u32; 3]],
        vertices: Range<usize>,
    ) -> Self {
        let &Pieces { vertices: all, order, is_held, .. } = pieces;
        let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (mut held, mut protected) = (false, false);
        for &v in own {
            let vertex = all.get(v);
            (lo, hi) = (lo.min(vertex.place()), hi.max(vertex.place()));
            held |= is_held[order.input(all.origin(v)) as usize];
            protected |= vertex.flags.any(VertexFlags::PROTECTED);
        }
        let place = |v: u32| all.get(v).place();
        Self {
            size: (hi - lo).length(),
            area: faces.iter().map(|&[a, b, c]| area([place(a), place(b), place(c)])).sum(),
            protection: if protected { all.protection } else { 1.0 },
            is_held: held,
            faces: faces.len() as u32,
            coat: None,
            vertices,
        }
    }
}

/// Joins the corners of faces, and copies with their vertices. Returns how often two sets became one.
fn join(vertices: &Vertices<'_>, faces: impl Iterator<Item = [u32; 3]>) -> (UnionFind, usize) {
    let mut joined = UnionFind::new(vertices.all.len());
    let mut joins = 0;
    for face @ [a, b, c] in faces {
        if is_face(face) {
            joins += usize::from(joined.union(a, b)) + usize::from(joined.union(a, c));
        }
    }
    for v in vertices.copies() {
        joins += usize::from(joined.union(v, vertices.origin(v)));
    }
    (joined, joins)
}

/// Numbers the components in the order of their first faces. Returns the component of each vertex,
/// and their number.
fn number(
    vertices: &Vertices<'_>,
    faces: impl Iterator<Item = [u32; 3]>,
    mut joined: UnionFind,
) -> (Vec<u32>, usize) {
    let mut of_set = vec![NO_COMPONENT; vertices.all.len()];
    let mut count = 0;
    for face in faces.filter(|&face| is_face(face)) {
        let number = &mut of_set[joined.find(face[0]) as usize];
        if *number == NO_COMPONENT {
            *number = count;
            count += 1;
        }
    }
    let of = |v: u32| of_set[joined.find(v) as usize];
    (vertices.ids().map(of).collect(), count as usize)
}

/// Returns the vertices of all components, one component after the other, and where each ends.
fn by_component(of_vertex: &[u32], count: usize) -> (Vec<u32>, Vec<usize>) {
    let mut ends = vec![0; count];
    let of = of_vertex.iter().map(|&component| component as usize);
    of.clone().for_each(|component| ends.get_mut(component).into_iter().for_each(|n| *n += 1));
    let mut sum = 0;
    for end in &mut ends {
        sum += std::mem::replace(end, sum);
    }
    let mut vertices = vec![0; sum];
    for (v, component) in (0..).zip(of) {
        if let Some(end) = ends.get_mut(component) {
            vertices[*end] = v;
            *end += 1;
        }
    }
    (vertices, ends)
}

/// Appends the faces around a vertex whose other corners have greater ids.
pub(crate) fn faces_at(vertices: &Vertices<'_>, v: u32, faces: &mut Vec<[u32; 3]>) {
    let ring = vertices.neighbours(v);
    let Some(&last) = ring.last() else { return };
    let mut a = last;
    for &b in ring {
        if v < a && v < b && a != GHOST && b != GHOST {
            faces.push([v, a, b]);
        }
        a = b;
    }
}

/// Returns the number of faces around a vertex.
fn faces_around(vertices: &Vertices<'_>, v: u32) -> u32 {
    let ring = vertices.neighbours(v);
    let Some(&last) = ring.last() else { return 0 };
    let mut a = last;
    let mut count = 0;
    for &b in ring {
        count += u32::from(a != GHOST && b != GHOST);
        a = b;
    }
    count
}
