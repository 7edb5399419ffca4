//! Filters that remove vertices which draw nothing from display strips.

use meshlod_mesh::VertexId;

use crate::strips::Strips;
use crate::verify::has_three_corners;

/// Filter that removes vertices from a triangle strip without changing what the strip draws.
///
/// It looks at each strip by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Removes nothing from the strip.
    #[default]
    None,
    /// The simple triangle strip scanner [ESAV99], which collapses repetitions of one or two
    /// vertices.
    Stss,
    /// The degenerate-triangle-free filter [KY05], which rebuilds strips from the triangles drawn,
    /// as far as each continues the one before.
    Dtff,
}

impl Filter {
    /// Filters a triangle strip and appends the result to `to`.
    ///
    /// Cost: linear.
    pub fn strip(self, strip: &[VertexId], to: &mut Strips) {
        match self {
            Self::None => to.push(strip.iter().copied()),
            Self::Stss => to.push(stss(strip)),
            Self::Dtff => dtff(strip, to),
        }
    }
}

/// Collapses (*aa*)⁺ to *aa* and (*ab*)⁺ to *ab*; it removes two vertices at a time, so windings
/// are kept.
fn stss(strip: &[VertexId]) -> Vec<VertexId> {
    let mut left = Vec::with_capacity(strip.len());
    for &vertex in strip {
        left.push(vertex);
        if let [.., a, b, c, d] = left[..]
            && [a, b] == [c, d]
        {
            left.truncate(left.len() - 2);
        }
    }
    left
}

fn dtff(strip: &[VertexId], to: &mut Strips) {
    let mut written = Vec::new();
    let mut last: Option<Window> = None;
    let windows = strip.array_windows().enumerate();
    for (place, &[a, b, c]) in windows.filter(|(_, window)| has_three_corners(window)) {
        let next = Window { place, corners: [a, b, c] };
        match last.map(|last| last.step(&next)) {
            Some(Step::Regular) => written.push(c),
            Some(Step::Swap) => written.extend([b, c]),
            Some(Step::Reset) | None => {
                to.push(written.drain(..));
                // A strip that begins at an odd position doubles its first vertex to keep the
                // winding.
                written.extend((place % 2 == 1).then_some(a));
                written.extend([a, b, c]);
            }
        }
        last = Some(next);
    }
    to.push(written);
}

/// A triangle of a strip and its position.
#[derive(Clone, Copy)]
struct Window {
    place: usize,
    corners: [VertexId; 3],
}

/// Step of a strip from one triangle to the next [KY05, 3.1].
enum Step {
    /// *abc*, *bcd*: by one vertex.
    Regular,
    /// *abc*, *cbd*, with the same winding: by two vertices and one degenerate window.
    Swap,
    /// The strip ends and a new one starts.
    Reset,
}

impl Window {
    fn step(&self, next: &Self) -> Step {
        let [_, b, c] = self.corners;
        let is_turned = self.place % 2 != next.place % 2;
        match next.corners {
            [first, second, _] if is_turned && [b, c] == [first, second] => Step::Regular,
            [first, second, _] if !is_turned && [c, b] == [first, second] => Step::Swap,
            _ => Step::Reset,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(filter: Filter, letters: &str) -> Vec<String> {
        let strip: Vec<_> = letters.chars().map(|c| VertexId(c as u32)).collect();
        let mut strips = Strips::default();
        filter.strip(&strip, &mut strips);
        let letter = |v: &VertexId| char::from_u32(v.0).expect("a letter");
        strips.iter().map(|strip| strip.iter().map(letter).collect()).collect()
    }

    #[test]
    fn the_scanner_does_what_the_paper_shows() {
        assert_eq!(filtered(Filter::Stss, "22223535"), ["2235"]);
        assert_eq!(filtered(Filter::Stss, "aaabababc"), ["aaabc"]);
        assert_eq!(filtered(Filter::Stss, "abcbcbd"), ["abcbd"]);
    }

    #[test]
    fn the_filter_does_what_the_paper_shows() {
        // [KY05, 3.1], with the vertex restored that the print lost, and without the surplus one
        // behind its swap.
        assert_eq!(filtered(Filter::Dtff, "aabcbcbcddccdcffxxyzz"), ["aabcdcf", "xxyz"]);
    }

    #[test]
    fn regular_swap_and_reset_are_told_by_winding() {
        assert_eq!(filtered(Filter::Dtff, "abcd"), ["abcd"]);
        assert_eq!(filtered(Filter::Dtff, "abcbd"), ["abcbd"], "a swap");
        assert_eq!(filtered(Filter::Dtff, "abccbd"), ["abc", "ccbd"], "turned by another vertex");
        assert_eq!(filtered(Filter::Dtff, "abbabba"), [""; 0]);
    }
}
