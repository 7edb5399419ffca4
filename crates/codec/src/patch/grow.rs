//! Growing a patch: face after face, each across an edge of those before where one is left.

use super::front::{Front, OpenEdge};

/// A step of a patch's growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct GrowthStep {
    /// The nodes of the gate that it is across, or none where a face starts anew.
    pub(super) gate: Option<[u32; 2]>,
    pub(super) finds: Found,
}

/// What there is across a gate, or at a corner of a face that starts anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// No face.
    Nothing,
    /// A node that the patch has not met.
    New(u32),
    /// The node after the gate on the border.
    Next,
    /// The node before it.
    Previous,
    /// Any that the patch has met, by its number there.
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

    /// The steps that make all of these faces.
    pub(super) fn grow(&mut self, faces: &[[u32; 3]]) -> Vec<GrowthStep> {
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
        steps
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

    fn third(&mut self, node: u32, gate: OpenEdge, front: &mut Front, met: &mut Vec<u32>) -> Found {
        match self.corner(node, front, met) {
            Found::Known(number) if front.next(gate) == Some(number) => Found::Next,
            Found::Known(number) if front.previous(gate) == Some(number) => Found::Previous,
            finds => finds,
        }
    }
}

/// The sides of faces that are not made yet.
struct Sides<'a> {
    faces: &'a [[u32; 3]],
    is_made: Vec<bool>,
    left: usize,
    /// Before this all are made.
    first: usize,
    /// From, to, and the corner `3 face + k` that it starts at; in order.
    sides: Vec<([u32; 2], u32)>,
    /// Of the first of sides with the same ends: how many of them are made for certain.
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
            left: faces.len(),
            first: 0,
            passed: vec![0; sides.len()],
            sides,
        }
    }

    /// A face that is not made yet, and now is.
    fn any(&mut self) -> usize {
        let rest = &self.is_made[self.first..];
        self.first += rest.iter().position(|is_made| !is_made).expect("some are left");
        self.make(self.first)
    }

    /// What is across from a side of a face that is not made yet, and now is.
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
        self.left -= 1;
        face
    }
}
