//! Parent pointers with path compression.

use meshlod_mesh::VertexId;

/// For each vertex, a vanished ancestor from which the search for its representative can continue.
///
/// A vertex vanishes before its parent. So the descendants of a vanished vertex have vanished too,
/// and a shortcut is valid as long as its target has vanished; when the target returns, the search
/// ignores it.
/// # References
/// [ESAV99], path compression.
#[derive(Clone, Debug)]
pub(super) struct Pointers {
    last: Vec<VertexId>,
}

impl Pointers {
    pub(super) fn new(vertices: usize) -> Self {
        Self { last: (0..vertices).map(VertexId::new).collect() }
    }

    /// Returns the nearest ancestor that has not vanished.
    #[inline]
    pub(super) fn shown(
        &mut self,
        vertex: VertexId,
        parents: &[VertexId],
        is_gone: impl Fn(VertexId) -> bool,
    ) -> VertexId {
        if !is_gone(vertex) {
            return vertex;
        }
        let mut last = vertex;
        loop {
            let further = self.last[last.index()];
            if further != last && is_gone(further) {
                last = further;
            }
            let next = parents[last.index()];
            if !is_gone(next) {
                self.last[vertex.index()] = last;
                return next;
            }
            last = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortened_pointers_follow_what_comes_back() {
        // 0 merges into 1, 1 into 2, …
        let parents: Vec<_> = (1..=9).chain([9]).map(VertexId::new).collect();
        let mut pointers = Pointers::new(10);
        for made in [9, 3, 7, 0, 5, 9, 1, 2, 0] {
            for v in 0..10 {
                let shown = pointers.shown(VertexId(v), &parents, |v| v.0 < made);
                assert_eq!(shown.0, v.max(made), "{made}");
            }
        }
    }

    #[test]
    fn a_way_that_was_gone_is_short() {
        let parents: Vec<_> = (1..=999).chain([999]).map(VertexId::new).collect();
        let mut pointers = Pointers::new(1000);
        let looks = std::cell::Cell::new(0);
        let mut follow = |v| {
            looks.set(0);
            let is_gone = |v: VertexId| {
                looks.set(looks.get() + 1);
                v.0 < 999
            };
            assert_eq!(pointers.shown(VertexId(v), &parents, is_gone).0, 999);
            looks.get()
        };
        assert!(follow(0) > 900 && follow(0) < 10);
    }
}
