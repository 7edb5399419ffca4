//! Growing a patch face by face, across open edges as long as there are any.

use super::front::{Front, PatchGate};

/// Step in the growth of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GrowthStep {
    /// Nodes of the gate that it crosses; `None` for a corner of a face that starts anew.
    pub(super) gate: Option<[u32; 2]>,
    pub(super) finds: Found,
}

/// Node that a step finds across a gate, or at a corner of a face that starts anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// No face, and so no node.
    Nothing,
    /// Node that the patch has not met before.
    New(u32),
    /// Node after the gate on the border.
    Next,
    /// Node before the gate on the border.
    Previous,
    /// Any other node that the patch has met, by its number there.
    Known(u32),
}

impl GrowthStep {
    pub(super) fn new_node(&self) -> Option<u32> {
        if let Found::New(node) = self.finds { Some(node) } else { None }
    }
}

/// Grows patches one after the other.
pub(super) struct PatchGrower {
    /// The patch's number of each node that it has met, else [`UNMET`].
    numbers: Vec<u32>,
}

const UNMET: u32 = u32::MAX;

impl PatchGrower {
    pub(super) fn new(nodes: usize) -> Self {
        Self { numbers: vec![UNMET; nodes] }
    }

    /// Returns the steps that produce all these faces, and the faces in that order.
    pub(super) fn grow(&mut self, faces: &[[u32; 3]]) -> (Vec<GrowthStep>, Vec<u32>) {
        let mut sides = Sides::new(faces);
        let mut front = Front::default();
        let mut steps = Vec::with_capacity(faces.len() * 3 / 2);
        let mut met = Vec::new();
        while sides.left > 0 {
            let Some(gate) = front.pass() else {
                let face = faces[sides.any()];
                let face = face.map(|node| {
                    let finds = self.corner(node, &mut front, &mut met);
                    steps.push(GrowthStep { gate: None, finds });
                    self.numbers[node as usize]
                });
                front.start(face);
                continue;
            };
            let nodes = [gate.from, gate.to].map(|number| met[number as usize]);
            let finds = match sides.across(nodes) {
                None => Found::Nothing,
                Some(third) => {
                    let finds = self.third(third, gate, &mut front, &mut met);
                    front.grow(gate, self.numbers[third as usize]);
                    finds
                }
            };
            steps.push(GrowthStep { gate: Some(nodes), finds });
        }
        met.into_iter().for_each(|node| self.numbers[node as usize] = UNMET);
        (steps, sides.made)
    }

    fn corner(&mut self, node: u32, front: &mut Front, met: &mut Vec<u32>) -> Found {
        match self.numbers[node as usize] {
            UNMET => {
                self.numbers[node as usize] = front.meet();
                met.push(node);
                Found::New(node)
            }
            number => Found::Known(number),
        }
    }

    fn third(
        &mut self,
        node: u32,
        gate: PatchGate,
        front: &mut Front,
        met: &mut Vec<u32>,
    ) -> Found {
        match self.corner(node, front, met) {
            Found::Known(number) if front.next(gate) == Some(number) => Found::Next,
            Found::Known(number) if front.previous(gate) == Some(number) => Found::Previous,
            finds => finds,
        }
    }
}

/// Sides of faces that are not yet made.
struct Sides<'a> {
    faces: &'a [[u32; 3]],
    is_made: Vec<bool>,
    /// The faces that are made, in order.
    made: Vec<u32>,
    left: usize,
    /// All faces before this one are made.
    first: usize,
    /// Start and end of each side, and the corner `3 face + k` at its start; sorted.
    sides: Vec<([u32; 2], u32)>,
    /// For the first of several sides with equal ends: how many of them are certainly made.
    passed: Vec<u32>,
}

impl<'a> Sides<'a> {
    fn new(faces: &'a [[u32; 3]]) -> Self {
        let of = |(at, &[a, b, c]): (u32, &[u32; 3])| {
            [([a, b], 3 * at), ([b, c], 3 * at + 1), ([c, a], 3 * at + 2)]
        };
        let mut sides: Vec<_> = (0..).zip(faces).flat_map(of).collect();
        sides.sort_unstable();
        Self {
            faces,
            is_made: vec![false; faces.len()],
            made: Vec::with_capacity(faces.len()),
            left: faces.len(),
            first: 0,
            passed: vec![0; sides.len()],
            sides,
        }
    }

    /// Makes any face that is not yet made.
    fn any(&mut self) -> usize {
        let rest = &self.is_made[self.first..];
        self.first += rest.iter().position(|is_made| !is_made).expect("some are left");
        self.make(self.first)
    }

    /// Makes a face that has this side and returns its third corner; `None` if none exists.
    fn across(&mut self, ends: [u32; 2]) -> Option<u32> {
        let first = self.sides.partition_point(|&(side, _)| side < ends);
        loop {
            let &(side, corner) = self.sides.get(first + *self.passed.get(first)? as usize)?;
            if side != ends {
                return None;
            }
            self.passed[first] += 1;
            let (face, k) = (corner as usize / 3, corner as usize % 3);
            if !self.is_made[face] {
                self.make(face);
                return Some(self.faces[face][(k + 2) % 3]);
            }
        }
    }

    fn make(&mut self, face: usize) -> usize {
        self.is_made[face] = true;
        self.made.push(face as u32);
        self.left -= 1;
        face
    }
}
