//! Shortest paths on the unfolded octahedron, whose sides are folded onto themselves.

/// Returns the shortest way from one code to another, along both axes. A way may leave the square:
/// beyond a side it comes back at the opposite place of the same side.
///
/// It leads to this code and no other one of the same direction: blocks must agree on every bit.
pub(super) fn shortest(from: [i32; 2], to: [i32; 2], bits: u32) -> [i32; 2] {
    let last = (1 << bits) - 1;
    let [x, y] = to;
    let images = [
        [x, y],
        [-x, last - y],
        [2 * last - x, last - y],
        [last - x, -y],
        [last - x, 2 * last - y],
    ];
    let images = images.into_iter().filter(|&image| fold_in(image, bits) == to);
    let ways = images.map(|[x, y]| [x - from[0], y - from[1]]);
    ways.min_by_key(|[x, y]| x.abs() + y.abs()).expect("the code itself")
}

/// Returns the code at a place that may be beyond the sides.
pub(super) fn fold_in(at: [i32; 2], bits: u32) -> [i32; 2] {
    let last = (1 << bits) - 1;
    let [x, y] = at;
    let [x, y] = match () {
        () if x < 0 => [x.wrapping_neg(), last - y.clamp(0, last)],
        () if x > last => [(2 * last).wrapping_sub(x), last - y.clamp(0, last)],
        () if y < 0 => [last - x.clamp(0, last), y.wrapping_neg()],
        () if y > last => [last - x.clamp(0, last), (2 * last).wrapping_sub(y)],
        () => [x, y],
    };
    // Only damaged data leads farther.
    [x.clamp(0, last), y.clamp(0, last)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_leads_to_its_code_and_is_short() {
        let last = 15;
        let codes = || (0..=last).flat_map(|x| (0..=last).map(move |y| [x, y]));
        for from in codes() {
            for to in codes() {
                let way = shortest(from, to, 4);
                assert_eq!(fold_in([from[0] + way[0], from[1] + way[1]], 4), to, "{from:?}");
                assert!(
                    way[0].abs() + way[1].abs()
                        <= (to[0] - from[0]).abs() + (to[1] - from[1]).abs()
                );
            }
        }
        // On either side of a folded edge.
        assert_eq!(shortest([0, 3], [1, 12], 4), [-1, 0]);
    }
}
