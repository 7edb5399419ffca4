//! Traversal of a block by the encoder, from face to face.

use meshlod_mesh::{Connectivity, FaceId, Side, Twin, VertexId};

use super::border::{Border, EdgeState, Step};
use super::gate::{Gate, NEARBY, context, node_at_offset};

/// Block as a sequence of steps.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockWalk {
    /// Faces over the block's vertices, in the order in which they are decoded.
    pub(super) faces: Vec<[u16; 3]>,
    /// First side of each face, in the mesh.
    pub(super) sides: Vec<Side>,
    /// Each step, with the context in which it is coded.
    pub(super) steps: Vec<(u8, Step)>,
    /// Target of each [`Step::Other`]: its index in [`NEARBY`], else its node.
    pub(super) others: Vec<Result<usize, u16>>,
    /// Gate from which each vertex is predicted.
    pub(super) gates: Vec<Gate>,
    /// Mesh vertex of each block vertex. One where the block's faces are not connected appears more
    /// than once.
    pub(super) vertices: Vec<u32>,
    /// True for vertices that the decoder sees on the final border.
    pub(super) borders: Vec<bool>,
}

/// Walks over blocks, one after the other.
pub(super) struct Walker<'a> {
    faces: &'a [[VertexId; 3]],
    connectivity: &'a Connectivity,
    /// Block of each face that has not been visited.
    block_of: Vec<u32>,
    border: Border,
    /// Side of the known face on each node's edge.
    sides: Vec<Side>,
    /// Latest block vertex of each mesh vertex.
    local: Vec<u16>,
}

const NONE: u16 = u16::MAX;
const DONE: u32 = u32::MAX;

impl<'a> Walker<'a> {
    pub(super) fn new(
        faces: &'a [[VertexId; 3]],
        connectivity: &'a Connectivity,
        block_of: Vec<u32>,
    ) -> Self {
        let local = vec![NONE; connectivity.vertex_count()];
        Self { faces, connectivity, block_of, border: Border::new(), sides: Vec::new(), local }
    }

    /// Walks over a block. It starts at the first of its faces; disconnected pieces start at the
    /// first face left.
    pub(super) fn walk(&mut self, block: u32, members: &[u32]) -> BlockWalk {
        let mut out = BlockWalk {
            faces: Vec::with_capacity(members.len()),
            sides: Vec::with_capacity(members.len()),
            steps: Vec::with_capacity(2 * members.len()),
            gates: Vec::with_capacity(members.len()),
            vertices: Vec::with_capacity(members.len()),
            ..BlockWalk::default()
        };
        self.border.clear();
        self.sides.clear();
        let mut rest = members.iter();
        let mut left = members.len();
        while left > 0 {
            let Some(at) = self.border.pivot() else {
                let is_left = |&&f: &&u32| self.block_of[f as usize] == block;
                let f = *rest.find(is_left).expect("some are left");
                self.start(f, &mut out);
                left -= 1;
                continue;
            };
            let context = context(&self.border, at) as u8;
            let step = self.step(at, block, &mut out);
            out.steps.push((context, step));
            left -= usize::from(step != Step::Nothing);
        }
        out.borders = vec![false; out.vertices.len()];
        for vertex in self.border.vertices() {
            out.borders[usize::from(vertex)] = true;
        }
        for &v in &out.vertices {
            self.local[v as usize] = NONE;
        }
        out
    }

    fn vertex(&mut self, v: VertexId, gate: Gate, out: &mut BlockWalk) -> u16 {
        let local = out.vertices.len() as u16;
        self.local[v.index()] = local;
        out.vertices.push(v.0);
        out.gates.push(gate);
        local
    }

    fn start(&mut self, f: u32, out: &mut BlockWalk) {
        let corners = self.faces[f as usize];
        let vertices = [0, 1, 2].map(|k| self.vertex(corners[k], Gate::corner(k as u8), out));
        self.border.start(vertices);
        out.faces.push(vertices);
        out.sides.push(Side::new(FaceId(f), 0));
        self.sides.extend((0..3).map(|k| Side::new(FaceId(f), k)));
        self.block_of[f as usize] = DONE;
    }

    fn step(&mut self, at: u16, block: u32, out: &mut BlockWalk) -> Step {
        let Some(side) = self.across(at, block, out) else {
            self.border.close(at);
            return Step::Nothing;
        };
        let k = side.corner();
        let apex = self.faces[side.face().index()][(k + 2) % 3];
        let to_apex = Side::new(side.face(), (k + 1) % 3);
        let from_apex = Side::new(side.face(), (k + 2) % 3);
        self.block_of[side.face().index()] = DONE;
        out.sides.push(side);
        let local = self.local[apex.index()];
        let node = *self.border.node(at);
        let previous = self.border.node(node.previous);
        let second = self.border.node(node.next);
        if previous.vertex == local && previous.state == EdgeState::Open {
            out.faces.push(self.border.add_previous(at));
            self.sides[usize::from(node.previous)] = from_apex;
            return Step::Previous;
        }
        if self.border.node(second.next).vertex == local && second.state == EdgeState::Open {
            out.faces.push(self.border.add_next(at));
            self.sides[usize::from(at)] = to_apex;
            return Step::Next;
        }
        // Most vertices are new and need not be searched for.
        let known = if local == NONE { None } else { self.border.find(local) };
        let (step, from) = match known {
            Some(other) => {
                let by = NEARBY
                    .iter()
                    .position(|&(by, _)| node_at_offset(&self.border, at, by) == other);
                out.others.push(by.ok_or(other));
                out.faces.push(self.border.add_other(at, other));
                self.sides.push(self.sides[usize::from(other)]);
                (Step::Other, other)
            }
            None => {
                let gate = Gate::at(&self.border, at);
                let vertex = self.vertex(apex, gate, out);
                out.faces.push(self.border.add_new(at, vertex));
                self.sides.push(from_apex);
                (Step::New, self.sides.len() as u16 - 1)
            }
        };
        self.sides[usize::from(at)] = to_apex;
        self.sides[usize::from(from)] = from_apex;
        step
    }

    /// Returns the side of the block's unvisited face across an edge, if it runs the opposite way.
    fn across(&self, at: u16, block: u32, out: &BlockWalk) -> Option<Side> {
        let Twin::Side(side) = self.connectivity.twin(self.sides[usize::from(at)]) else {
            return None;
        };
        let f = side.face().index();
        let first = out.vertices[usize::from(self.border.node(at).vertex)];
        let is_there =
            self.block_of[f] == block && self.faces[f][(side.corner() + 1) % 3].0 == first;
        is_there.then_some(side)
    }
}
