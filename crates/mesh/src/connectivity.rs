//! Who touches whom: stars of vertices, twins of sides, marks for what is not manifold.
//!
//! Built in one pass over compact arrays, from faces alone: connectivity never reads positions.
//! Any input is taken. A face that repeats a vertex has no sides and is left out.

use crate::{FaceId, VertexId};

/// One side of a face: side `k` of face `f` runs from its corner `k` to corner `k + 1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Side(u32);

impl Side {
    /// Side `k` (0, 1 or 2) of `face`.
    #[inline]
    pub fn new(face: FaceId, k: usize) -> Self {
        debug_assert!(k < 3);
        Self(face.0 * 3 + k as u32)
    }

    /// The face it belongs to.
    #[inline]
    pub fn face(self) -> FaceId {
        FaceId(self.0 / 3)
    }

    /// Which side of the face: the corner it starts from.
    #[inline]
    pub fn corner(self) -> usize {
        (self.0 % 3) as usize
    }

    /// The vertices it runs between.
    #[inline]
    pub fn ends(self, faces: &[[VertexId; 3]]) -> [VertexId; 2] {
        let face = faces[self.face().index()];
        [face[self.corner()], face[(self.corner() + 1) % 3]]
    }
}

/// What lies across a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// One other face, by its side on the same edge. Its direction is opposite where the two faces
    /// are consistently oriented.
    Side(Side),
    /// Nothing: a boundary edge.
    Boundary,
    /// Two or more other faces.
    NonManifold,
    /// The face repeats a vertex and has no part in the connectivity.
    Degenerate,
}

/// What is special about a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Marks(u8);

impl Marks {
    const BOUNDARY: u8 = 1;
    const NON_MANIFOLD_EDGE: u8 = 2;
    const PINCHED: u8 = 4;

    /// It ends a boundary edge.
    #[inline]
    pub fn boundary(self) -> bool {
        self.0 & Self::BOUNDARY != 0
    }

    /// It ends a non-manifold edge, or its faces form more than one fan.
    #[inline]
    pub fn non_manifold(self) -> bool {
        self.0 & (Self::NON_MANIFOLD_EDGE | Self::PINCHED) != 0
    }

    /// Its faces form more than one fan.
    #[inline]
    pub fn pinched(self) -> bool {
        self.0 & Self::PINCHED != 0
    }
}

const BOUNDARY: u32 = u32::MAX;
const NON_MANIFOLD: u32 = u32::MAX - 1;
const DEGENERATE: u32 = u32::MAX - 2;

/// Stars, twins and marks of a mesh. Holds 4 bytes per side, 4 per corner, 5 per vertex.
#[derive(Clone, Debug)]
pub struct Connectivity {
    star_start: Vec<u32>,
    star: Vec<FaceId>,
    twins: Vec<u32>,
    marks: Vec<Marks>,
    edges: EdgeCounts,
    degenerate_faces: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct EdgeCounts {
    all: usize,
    boundary: usize,
    non_manifold: usize,
    inconsistent: usize,
}

impl Connectivity {
    /// Connects `faces` over `vertex_count` vertices, in time linear in both (a vertex of valence
    /// k costs k log k).
    ///
    /// Panics on a vertex out of range and above 1.4 billion faces.
    pub fn new(faces: &[[VertexId; 3]], vertex_count: usize) -> Self {
        let mut connectivity = Self::stars_only(faces, vertex_count);
        let mut scratch = Scratch::default();
        let mut ring = Ring::new(vertex_count);
        for vertex in (0..vertex_count).map(|v| VertexId(v as u32)) {
            // Nearly all vertices of nearly all meshes have one closed fan, and that is quickly seen.
            if ring.closes(faces, connectivity.star(vertex), vertex) {
                ring.record(vertex, &mut connectivity.twins, &mut connectivity.edges);
            } else {
                connectivity.connect(faces, vertex, &mut scratch);
            }
        }
        connectivity
    }

    fn stars_only(faces: &[[VertexId; 3]], vertex_count: usize) -> Self {
        assert!(faces.len() < (DEGENERATE / 3) as usize, "sides are numbered in 32 bits");
        let (star_start, star) = stars(faces, vertex_count);
        Self {
            degenerate_faces: faces.len() - star.len() / 3,
            star_start,
            star,
            twins: vec![DEGENERATE; faces.len() * 3],
            marks: vec![Marks::default(); vertex_count],
            edges: EdgeCounts::default(),
        }
    }

    /// How many vertices there are, also those that no face uses.
    #[inline]
    pub fn vertex_count(&self) -> usize {
        self.marks.len()
    }

    /// The faces around a vertex, lowest id first.
    #[inline]
    pub fn star(&self, vertex: VertexId) -> &[FaceId] {
        let v = vertex.index();
        &self.star[self.star_start[v] as usize..self.star_start[v + 1] as usize]
    }

    /// What lies across a side.
    #[inline]
    pub fn twin(&self, side: Side) -> Twin {
        match self.twins[side.0 as usize] {
            BOUNDARY => Twin::Boundary,
            NON_MANIFOLD => Twin::NonManifold,
            DEGENERATE => Twin::Degenerate,
            side => Twin::Side(Side(side)),
        }
    }

    /// What is special about a vertex.
    #[inline]
    pub fn marks(&self, vertex: VertexId) -> Marks {
        self.marks[vertex.index()]
    }

    /// How many edges there are, each counted once.
    pub fn edge_count(&self) -> usize {
        self.edges.all
    }

    /// Edges with one face.
    pub fn boundary_edges(&self) -> usize {
        self.edges.boundary
    }

    /// Edges with three faces or more.
    pub fn non_manifold_edges(&self) -> usize {
        self.edges.non_manifold
    }

    /// Edges whose two faces run along them the same way.
    pub fn inconsistent_edges(&self) -> usize {
        self.edges.inconsistent
    }

    /// Vertices whose faces form more than one fan.
    pub fn pinched_vertices(&self) -> usize {
        self.marks.iter().filter(|marks| marks.pinched()).count()
    }

    /// Faces that repeat a vertex.
    pub fn degenerate_faces(&self) -> usize {
        self.degenerate_faces
    }

    /// Whether there are faces, and every edge has exactly two.
    pub fn is_closed(&self) -> bool {
        self.edges.all > 0 && self.edges.boundary == 0 && self.edges.non_manifold == 0
    }

    /// Each edge once, by one of its sides; an edge of three faces or more, by each of them.
    pub fn edges(&self) -> impl Iterator<Item = Side> + '_ {
        self.twins.iter().enumerate().filter_map(|(side, &twin)| match twin {
            DEGENERATE => None,
            BOUNDARY | NON_MANIFOLD => Some(Side(side as u32)),
            twin => (side as u32 <= twin).then_some(Side(side as u32)),
        })
    }

    /// Finds the edges and fans at one vertex by sorting its two sides per face by neighbour.
    fn connect(&mut self, faces: &[[VertexId; 3]], vertex: VertexId, scratch: &mut Scratch) {
        let range =
            self.star_start[vertex.index()] as usize..self.star_start[vertex.index() + 1] as usize;
        let star = &self.star[range];
        scratch.gather(faces, star, vertex);
        let mut fans = star.len();
        let mut rest = scratch.spokes.as_slice();
        while let Some(&first) = rest.first() {
            let run = rest.iter().take_while(|s| s.neighbour() == first.neighbour()).count();
            let (spokes, after) = rest.split_at(run);
            rest = after;
            let marks = &mut self.marks[vertex.index()];
            match spokes {
                [_] => marks.0 |= Marks::BOUNDARY,
                [a, b] => fans -= usize::from(scratch.fans.join(a.local(), b.local())),
                _ => marks.0 |= Marks::NON_MANIFOLD_EDGE,
            }
            // Both ends of an edge see it; the lower one writes it down.
            if vertex < first.neighbour() {
                record(spokes, star, faces, vertex, &mut self.twins, &mut self.edges);
            }
        }
        if fans > 1 {
            self.marks[vertex.index()].0 |= Marks::PINCHED;
        }
    }
}

/// Faces by vertex, as a start per vertex (and one past the end) into one array.
fn stars(faces: &[[VertexId; 3]], vertex_count: usize) -> (Vec<u32>, Vec<FaceId>) {
    let whole =
        |face: &[VertexId; 3]| face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
    let mut start = vec![0u32; vertex_count + 1];
    for v in faces.iter().filter(|face| whole(face)).flatten() {
        start[v.index()] += 1;
    }
    let mut sum = 0;
    for slot in &mut start {
        sum += *slot;
        *slot = sum;
    }
    // Filled from the back, each vertex's end walks down to its start.
    let mut star = vec![FaceId(0); sum as usize];
    for (f, face) in faces.iter().enumerate().rev().filter(|(_, face)| whole(face)) {
        for v in face {
            start[v.index()] -= 1;
            star[start[v.index()] as usize] = FaceId(f as u32);
        }
    }
    (start, star)
}

/// The star of a vertex as one closed fan of faces that agree, where it is one.
struct Ring {
    /// For each vertex, the vertex in hand it was last a neighbour of, and the place in its star of
    /// the face that leaves to it.
    leaves_to: Vec<(VertexId, u32)>,
    spans: [Span; Ring::MOST],
    len: usize,
}

/// What a face of the star spans: it leaves by one side and arrives by another, which comes from a
/// neighbour; `next` is the place of the face that leaves to that neighbour.
#[derive(Clone, Copy, Default)]
struct Span {
    leaving: u32,
    arriving: u32,
    neighbour: VertexId,
    next: u32,
}

impl Ring {
    /// The greatest star it takes.
    const MOST: usize = 32;

    fn new(vertex_count: usize) -> Self {
        Self {
            leaves_to: vec![(VertexId(u32::MAX), 0); vertex_count],
            spans: [Span::default(); Self::MOST],
            len: 0,
        }
    }

    /// Whether the star is one closed fan of faces that agree; then it is kept.
    #[inline]
    fn closes(&mut self, faces: &[[VertexId; 3]], star: &[FaceId], vertex: VertexId) -> bool {
        self.len = star.len();
        if star.len() > Self::MOST {
            return false;
        }
        let mut twice = false;
        for (place, &face) in star.iter().enumerate() {
            let corners = faces[face.index()];
            // Without branches, which would be guessed wrong two times of three.
            let k = usize::from(corners[1] == vertex) + 2 * usize::from(corners[2] == vertex);
            let [k1, k2] = [[1, 2], [2, 0], [0, 1]][k];
            let slot = &mut self.leaves_to[corners[k1].index()];
            twice |= slot.0 == vertex;
            *slot = (vertex, place as u32);
            self.spans[place] = Span {
                leaving: Side::new(face, k).0,
                arriving: Side::new(face, k2).0,
                neighbour: corners[k2],
                next: 0,
            };
        }
        !twice && self.goes_round(vertex)
    }

    /// Whether going from each face to the next comes back after all of them and not before.
    #[inline]
    fn goes_round(&mut self, vertex: VertexId) -> bool {
        let spans = &mut self.spans[..self.len];
        for span in spans.iter_mut() {
            let (by, place) = self.leaves_to[span.neighbour.index()];
            if by != vertex {
                return false;
            }
            span.next = place;
        }
        let mut at = 0;
        for steps in 1..=spans.len() {
            at = spans[at].next as usize;
            if at == 0 {
                return steps == spans.len();
            }
        }
        false
    }

    /// Writes down the twins of the edges whose lower end the vertex is, and counts them.
    #[inline]
    fn record(&self, vertex: VertexId, twins: &mut [u32], edges: &mut EdgeCounts) {
        let spans = &self.spans[..self.len];
        for span in spans {
            let leaving = spans[span.next as usize].leaving;
            twins[span.arriving as usize] = leaving;
            twins[leaving as usize] = span.arriving;
            edges.all += usize::from(vertex < span.neighbour);
        }
    }
}

/// A side at the vertex in hand: its other end, the face's place in the star, and whether it
/// leaves or arrives. One word, so that sorting is by neighbour, then face.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke(u64);

impl Spoke {
    #[inline]
    fn new(neighbour: VertexId, local: usize, leaves: bool) -> Self {
        Self(u64::from(neighbour.0) << 32 | (local as u64) << 1 | u64::from(leaves))
    }

    #[inline]
    fn neighbour(self) -> VertexId {
        VertexId((self.0 >> 32) as u32)
    }

    #[inline]
    fn local(self) -> usize {
        (self.0 as u32 >> 1) as usize
    }

    #[inline]
    fn leaves(self) -> bool {
        self.0 & 1 != 0
    }

    /// The side of the face this is.
    #[inline]
    fn side(self, star: &[FaceId], faces: &[[VertexId; 3]], vertex: VertexId) -> Side {
        let face = star[self.local()];
        let k = corner_of(faces[face.index()], vertex);
        Side::new(face, if self.leaves() { k } else { (k + 2) % 3 })
    }
}

#[derive(Default)]
struct Scratch {
    spokes: Vec<Spoke>,
    fans: Fans,
}

impl Scratch {
    fn gather(&mut self, faces: &[[VertexId; 3]], star: &[FaceId], vertex: VertexId) {
        self.spokes.clear();
        self.fans.reset(star.len());
        for (local, face) in star.iter().enumerate() {
            let face = faces[face.index()];
            let k = corner_of(face, vertex);
            self.spokes.push(Spoke::new(face[(k + 1) % 3], local, true));
            self.spokes.push(Spoke::new(face[(k + 2) % 3], local, false));
        }
        self.spokes.sort_unstable();
    }
}

/// Which fan each face of a star belongs to: a union-find over places in the star.
#[derive(Default)]
struct Fans(Vec<u32>);

impl Fans {
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// Joins two faces' fans; false where they are one already.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b) as u32;
        a != b
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            self.0[i] = self.0[self.0[i] as usize];
            i = self.0[i] as usize;
        }
        i
    }
}

/// Writes down the twins of one edge, and counts it.
fn record(
    spokes: &[Spoke],
    star: &[FaceId],
    faces: &[[VertexId; 3]],
    vertex: VertexId,
    twins: &mut [u32],
    edges: &mut EdgeCounts,
) {
    edges.all += 1;
    let side = |spoke: Spoke| spoke.side(star, faces, vertex).0;
    match spokes {
        &[a] => {
            edges.boundary += 1;
            twins[side(a) as usize] = BOUNDARY;
        }
        &[a, b] => {
            edges.inconsistent += usize::from(a.leaves() == b.leaves());
            let (a, b) = (side(a), side(b));
            twins[a as usize] = b;
            twins[b as usize] = a;
        }
        many => {
            edges.non_manifold += 1;
            for &spoke in many {
                twins[side(spoke) as usize] = NON_MANIFOLD;
            }
        }
    }
}

#[inline]
fn corner_of(face: [VertexId; 3], vertex: VertexId) -> usize {
    if face[0] == vertex {
        0
    } else if face[1] == vertex {
        1
    } else {
        2
    }
}

#[cfg(test)]
mod tests;
