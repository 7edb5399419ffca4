//! Border of the part of a block that is already known, to which faces are added one by one.
//!
//! Border edges form loops. The edge of a node runs from the node's vertex to the next node's
//! vertex, in its direction within the known face on it; a new face is added on the other side, as
//! in a cut-border machine [GS98]. Encoder and decoder make the same steps here, so both know the
//! same about every edge.

/// Greatest number of faces in a block.
pub(super) const MAX_FACES: usize = 1024;
/// Capacity for nodes: a face makes at most three. A power of two, so that masked indices are in
/// bounds.
pub(super) const NODES: usize = 4 * MAX_FACES;
const MASK: usize = NODES - 1;

/// Operation on a border edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// Add a face with a new vertex.
    New,
    /// Add a face with the vertex before the edge, which completes the fan of the edge's first
    /// vertex.
    Previous,
    /// Add a face with the vertex after the edge, which completes the fan of its second vertex.
    Next,
    /// Add no face.
    Nothing,
    /// Add a face with any other vertex of the border.
    Other,
}

impl Step {
    pub(super) const ALL: [Self; 5] =
        [Self::New, Self::Previous, Self::Next, Self::Nothing, Self::Other];
}

/// Vertex on a border loop, with the edge that leaves from it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    pub(super) vertex: u16,
    pub(super) next: u16,
    pub(super) previous: u16,
    /// Third vertex of the known face on the edge.
    pub(super) apex: u16,
    /// Apex before this one in the fan around the node's vertex.
    pub(super) previous_apex: u16,
    pub(super) state: EdgeState,
}

/// State of a node's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum EdgeState {
    /// There may be a face on the other side.
    #[default]
    Open,
    /// There is no face on the other side.
    Closed,
    /// The node is no longer on the border.
    Removed,
}

pub(super) struct Border {
    nodes: Box<[Node; NODES]>,
    len: usize,
    /// Nodes whose edges are still to be processed, in order of creation.
    queue: Box<[u16; NODES]>,
    queued: usize,
    taken: usize,
    /// Number of known faces at each vertex.
    faces: Box<[u8; NODES]>,
}

impl Border {
    pub(super) fn new() -> Self {
        let nodes: Box<[Node]> = vec![Node::default(); NODES].into();
        let queue: Box<[u16]> = vec![0; NODES].into();
        let faces: Box<[u8]> = vec![0; NODES].into();
        Self {
            nodes: nodes.try_into().expect("as many as there are"),
            len: 0,
            queue: queue.try_into().expect("as many as there are"),
            queued: 0,
            taken: 0,
            faces: faces.try_into().expect("as many as there are"),
        }
    }

    pub(super) fn clear(&mut self) {
        self.len = 0;
        self.queued = 0;
        self.taken = 0;
    }

    #[inline(always)]
    pub(super) fn node(&self, at: u16) -> &Node {
        &self.nodes[usize::from(at) & MASK]
    }

    #[inline(always)]
    pub(super) fn node_mut(&mut self, at: u16) -> &mut Node {
        &mut self.nodes[usize::from(at) & MASK]
    }

    /// Returns the number of known faces at a vertex.
    #[inline(always)]
    pub(super) fn faces_at(&self, vertex: u16) -> u8 {
        self.faces[usize::from(vertex) & MASK]
    }

    /// Sets the number of known faces at a vertex.
    #[inline(always)]
    pub(super) fn set_faces(&mut self, vertex: u16, count: u8) {
        self.faces[usize::from(vertex) & MASK] = count;
    }

    /// Returns the number of nodes so far.
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    fn add_face(&mut self, corners: [u16; 3]) {
        for v in corners {
            let count = &mut self.faces[usize::from(v) & MASK];
            *count = count.saturating_add(1);
        }
    }

    /// Returns the first node in the queue whose edge is open.
    #[inline(always)]
    pub(super) fn pivot(&mut self) -> Option<u16> {
        while self.taken < self.queued {
            let at = self.queue[self.taken & MASK];
            if self.node(at).state == EdgeState::Open {
                return Some(at);
            }
            self.taken += 1;
        }
        None
    }

    /// Adds a separate face with three new vertices and returns its first node.
    pub(super) fn start(&mut self, vertices: [u16; 3]) -> u16 {
        let at = self.len as u16;
        for k in 0..3u16 {
            let [vertex, _, apex] = [0, 1, 2].map(|i| vertices[usize::from(k + i) % 3]);
            self.set_faces(vertex, 0);
            let (next, previous) = (at + (k + 1) % 3, at + (k + 2) % 3);
            self.push(Node {
                vertex,
                next,
                previous,
                apex,
                previous_apex: apex,
                state: EdgeState::Open,
            });
        }
        self.add_face(vertices);
        at
    }

    /// Adds a node, which waits in the queue.
    #[inline(always)]
    pub(super) fn push(&mut self, node: Node) -> u16 {
        let at = self.len as u16;
        *self.node_mut(at) = node;
        self.len += 1;
        self.wait(at);
        at
    }

    /// Lets a node wait in the queue.
    #[inline(always)]
    fn wait(&mut self, at: u16) {
        self.queue[self.queued & MASK] = at;
        self.queued += 1;
    }

    /// Adds a face on an edge to a new vertex, and a node for it between the edge's two.
    #[inline(always)]
    pub(super) fn add_new(&mut self, at: u16, vertex: u16) -> [u16; 3] {
        let Node { vertex: a, next: second, apex, .. } = *self.node(at);
        let b = self.node(second).vertex;
        self.set_faces(vertex, 0);
        let new = self.push(Node {
            vertex,
            next: second,
            previous: at,
            apex: a,
            previous_apex: a,
            state: EdgeState::Open,
        });
        let node = self.node_mut(at);
        (node.next, node.apex, node.previous_apex) = (new, b, apex);
        self.node_mut(second).previous = new;
        self.add_face([b, a, vertex]);
        [b, a, vertex]
    }

    /// Adds a face on an edge to the vertex before it.
    #[inline(always)]
    pub(super) fn add_previous(&mut self, at: u16) -> [u16; 3] {
        let Node { vertex: a, next: second, previous, .. } = *self.node(at);
        let b = self.node(second).vertex;
        self.node_mut(at).state = EdgeState::Removed;
        let node = self.node_mut(previous);
        let c = node.vertex;
        (node.next, node.previous_apex, node.apex) = (second, node.apex, a);
        self.node_mut(second).previous = previous;
        self.add_face([b, a, c]);
        self.zip(previous);
        [b, a, c]
    }

    /// Adds a face on an edge to the vertex after it.
    #[inline(always)]
    pub(super) fn add_next(&mut self, at: u16) -> [u16; 3] {
        let Node { vertex: a, next: second, apex, .. } = *self.node(at);
        let Node { vertex: b, next: third, .. } = *self.node(second);
        self.node_mut(second).state = EdgeState::Removed;
        let node = self.node_mut(at);
        (node.next, node.previous_apex, node.apex) = (third, apex, b);
        let node = self.node_mut(third);
        let c = node.vertex;
        node.previous = at;
        self.add_face([b, a, c]);
        self.zip(at);
        [b, a, c]
    }

    /// Removes two edges that run back and forth between the same two nodes: they are one inner
    /// edge.
    #[inline(always)]
    fn zip(&mut self, at: u16) {
        let Node { next, previous, state, .. } = *self.node(at);
        if next == previous && state == EdgeState::Open && self.node(next).state == EdgeState::Open
        {
            self.node_mut(at).state = EdgeState::Removed;
            self.node_mut(next).state = EdgeState::Removed;
        }
    }

    /// Adds a face on an edge to the vertex of any other node, which splits a loop or joins two.
    pub(super) fn add_other(&mut self, at: u16, other: u16) -> [u16; 3] {
        let Node { vertex: a, next: second, apex, .. } = *self.node(at);
        let b = self.node(second).vertex;
        let Node { vertex: c, next: after, .. } = *self.node(other);
        let state = self.node(other).state;
        let Node { apex: other_apex, previous_apex: other_older, .. } = *self.node(other);
        let twin = self.push(Node {
            vertex: c,
            next: after,
            previous: at,
            apex: other_apex,
            previous_apex: other_older,
            state,
        });
        self.node_mut(after).previous = twin;
        let node = self.node_mut(at);
        (node.next, node.apex, node.previous_apex) = (twin, b, apex);
        let node = self.node_mut(other);
        (node.next, node.apex, node.previous_apex) = (second, a, a);
        node.state = EdgeState::Open;
        self.node_mut(second).previous = other;
        self.wait(other);
        self.add_face([b, a, c]);
        [b, a, c]
    }

    /// Marks an edge as having no face.
    #[inline(always)]
    pub(super) fn close(&mut self, at: u16) {
        self.node_mut(at).state = EdgeState::Closed;
    }

    /// Returns a node of a vertex, if the vertex is on the border.
    pub(super) fn find(&self, vertex: u16) -> Option<u16> {
        let is_there = |node: &Node| node.vertex == vertex && node.state != EdgeState::Removed;
        self.nodes[..self.len].iter().position(is_there).map(|at| at as u16)
    }

    /// Returns the vertices on the border, possibly more than once.
    pub(super) fn vertices(&self) -> impl Iterator<Item = u16> {
        let nodes = self.nodes[..self.len].iter();
        nodes.filter(|node| node.state != EdgeState::Removed).map(|node| node.vertex)
    }

    /// Returns `at` if there is such a node, else the first node.
    pub(super) fn known(&self, at: u16) -> u16 {
        if usize::from(at) < self.len { at } else { 0 }
    }
}
