//! The open edges that a patch grows over: the same for who writes it and who reads it.

/// An edge with a face on one side: as the face that is missing would have it. By the patch's own numbers of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenEdge {
    pub(super) from: u32,
    pub(super) to: u32,
    is_open: bool,
}

/// The gates of a patch, in the order in which they opened.
#[derive(Clone, Debug, Default)]
pub(super) struct Front {
    gates: Vec<OpenEdge>,
    passed: usize,
    /// The last gate that opened from each node, and the last to each.
    last: Vec<Ends>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    from: Option<u32>,
    to: Option<u32>,
}

impl Front {
    /// How many nodes are known.
    pub(super) fn known(&self) -> u32 {
        self.last.len() as u32
    }

    /// One more, and its number.
    pub(super) fn meet(&mut self) -> u32 {
        self.last.push(Ends::default());
        self.known() - 1
    }

    /// The open gate that has waited longest: it is open no more.
    pub(super) fn pass(&mut self) -> Option<OpenEdge> {
        while let Some(&gate) = self.gates.get(self.passed) {
            self.passed += 1;
            if gate.is_open {
                self.close(self.passed - 1);
                return Some(gate);
            }
        }
        None
    }

    /// The node after a gate on the border.
    pub(super) fn next(&self, gate: OpenEdge) -> Option<u32> {
        self.last[gate.to as usize].from.map(|next| self.gates[next as usize].to)
    }

    /// The node before it.
    pub(super) fn previous(&self, gate: OpenEdge) -> Option<u32> {
        self.last[gate.from as usize].to.map(|previous| self.gates[previous as usize].from)
    }

    /// A face that starts anew.
    pub(super) fn start(&mut self, [a, b, c]: [u32; 3]) {
        self.side(a, b);
        self.side(b, c);
        self.side(c, a);
    }

    /// A face across a gate that has been passed.
    pub(super) fn grow(&mut self, gate: OpenEdge, third: u32) {
        self.side(gate.to, third);
        self.side(third, gate.from);
    }

    /// A side of a face: what waited for it is closed, else a gate opens.
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
        self.gates.push(OpenEdge { from: to, to: from, is_open: true });
        self.last[to as usize].from = at;
        self.last[from as usize].to = at;
    }

    fn close(&mut self, at: usize) {
        let OpenEdge { from, to, .. } = self.gates[at];
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
