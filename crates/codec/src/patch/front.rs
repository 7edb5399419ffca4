//! Front of open edges over which a patch grows, in step for writer and reader.

/// Gate: edge with a face on one side, in the direction of the missing face, between nodes numbered
/// by the patch.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchGate {
    pub(super) from: u32,
    pub(super) to: u32,
    is_open: bool,
}

/// Gates of a patch, in the order in which they opened.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    gates: Vec<PatchGate>,
    passed: usize,
    /// Last gate that opened from each node, and last to each.
    last: Vec<Ends>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    from: Option<u32>,
    to: Option<u32>,
}

impl Front {
    /// Returns the number of known nodes.
    pub(super) fn known(&self) -> u32 {
        self.last.len() as u32
    }

    /// Adds a node and returns its number.
    pub(super) fn meet(&mut self) -> u32 {
        self.last.push(Ends::default());
        self.known() - 1
    }

    /// Closes and returns the open gate that has waited longest.
    pub(super) fn pass(&mut self) -> Option<PatchGate> {
        while let Some(&gate) = self.gates.get(self.passed) {
            self.passed += 1;
            if gate.is_open {
                self.close(self.passed - 1);
                return Some(gate);
            }
        }
        None
    }

    /// Returns the node after a gate on the border.
    pub(super) fn next(&self, gate: PatchGate) -> Option<u32> {
        self.last[gate.to as usize].from.map(|next| self.gates[next as usize].to)
    }

    /// Returns the node before a gate on the border.
    pub(super) fn previous(&self, gate: PatchGate) -> Option<u32> {
        self.last[gate.from as usize].to.map(|previous| self.gates[previous as usize].from)
    }

    /// Adds a face that is not adjacent to the front.
    pub(super) fn start(&mut self, [a, b, c]: [u32; 3]) {
        self.side(a, b);
        self.side(b, c);
        self.side(c, a);
    }

    /// Adds a face across a gate that has been passed.
    pub(super) fn grow(&mut self, gate: PatchGate, third: u32) {
        self.side(gate.to, third);
        self.side(third, gate.from);
    }

    /// Adds a side of a face: closes the gate that it matches, or opens one.
    fn side(&mut self, from: u32, to: u32) {
        let waits = [self.last[from as usize].from, self.last[to as usize].to];
        let is_it = |&at: &u32| {
            let gate = self.gates[at as usize];
            (gate.from, gate.to) == (from, to)
        };
        if let Some(at) = waits.into_iter().flatten().find(is_it) {
            return self.close(at as usize);
        }
        let at = Some(self.gates.len() as u32);
        self.gates.push(PatchGate { from: to, to: from, is_open: true });
        self.last[to as usize].from = at;
        self.last[from as usize].to = at;
    }

    fn close(&mut self, at: usize) {
        let PatchGate { from, to, .. } = self.gates[at];
        self.gates[at].is_open = false;
        let forget = |end: &mut Option<u32>| {
            if *end == Some(at as u32) {
                *end = None;
            }
        };
        forget(&mut self.last[from as usize].from);
        forget(&mut self.last[to as usize].to);
    }
}
