//! The triangles of a triangle strip.

/// Iterates over the triangles that a strip draws, in drawing order and with their winding.
///
/// Every window of three corners is a triangle. Windows at odd positions have their first two
/// corners exchanged, which keeps the winding; windows that repeat a corner draw nothing.
pub fn strip_triangles<T: Copy + PartialEq>(strip: &[T]) -> impl Iterator<Item = [T; 3]> {
    let wound = |(place, window): (usize, &[T])| {
        let (a, b, c) = (window[0], window[1], window[2]);
        if place % 2 == 0 { [a, b, c] } else { [b, a, c] }
    };
    strip.windows(3).enumerate().map(wound).filter(|[a, b, c]| a != b && b != c && c != a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_second_triangle_is_turned_and_repeated_corners_draw_nothing() {
        let drawn = |strip: &[u32]| strip_triangles(strip).collect::<Vec<_>>();
        assert_eq!(drawn(&[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(drawn(&[4, 4, 5, 6]), [[5, 4, 6]]);
        assert_eq!(drawn(&[0, 1]), [[0; 3]; 0]);
    }
}
