//! Directions in the plane of the unfolded octahedron, without its fold.
//!
//! Crossing an edge of the square re-enters it, rotated by 180° about the edge's midpoint. So a code
//! has several places in the plane, and close directions have places that are close.

/// A place in the plane, in codes.
pub(super) type Place = [i32; 2];

/// The square of codes, with all places around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct OctahedralPlane {
    last: i32,
}

impl OctahedralPlane {
    pub(super) fn new(bits: u8) -> Self {
        Self { last: (1 << bits) - 1 }
    }

    /// Returns the places of a code in the square and those around it.
    fn places(self, [x, y]: Place) -> [Place; 9] {
        let last = self.last;
        let (turned_x, turned_y) = (last - x, last - y);
        [
            [x, y],
            [-x, turned_y],
            [2 * last - x, turned_y],
            [turned_x, -y],
            [turned_x, 2 * last - y],
            [x - last, y - last],
            [x - last, y + last],
            [x + last, y - last],
            [x + last, y + last],
        ]
    }

    /// Returns the place of a code that is nearest to another place.
    pub(super) fn near(self, code: Place, to: Place) -> Place {
        let away = |at: &Place| {
            // A hostile file can put the other place anywhere: only unsigned squares have room.
            let [dx, dy] = [0, 1].map(|k| i64::from(at[k]).abs_diff(i64::from(to[k])));
            dx * dx + dy * dy
        };
        let places = self.places(code);
        // Mostly it is the code itself: all others are across an edge.
        let quarter = u64::from(self.last.unsigned_abs() / 4);
        if away(&places[0]) <= quarter * quarter && self.is_inside(to) {
            return code;
        }
        places.into_iter().min_by_key(away).expect("there are nine")
    }

    fn is_inside(self, at: Place) -> bool {
        at.iter().all(|x| (self.last / 4..=self.last - self.last / 4).contains(x))
    }

    /// Returns the place of a code at which a number of steps from another place ends, for each
    /// coordinate, with the fewest steps, and these.
    pub(super) fn steps_to(self, code: Place, from: Place, step: Place) -> Option<(Place, Place)> {
        let steps = |at: Place| {
            let apart = [0, 1].map(|k| at[k].wrapping_sub(from[k]));
            let is_whole = (0..2).all(|k| apart[k] % step[k] == 0);
            is_whole.then(|| (at, [0, 1].map(|k| apart[k] / step[k])))
        };
        let count = |(_, steps): &(Place, Place)| {
            steps.iter().map(|x| u64::from(x.unsigned_abs())).sum::<u64>()
        };
        self.places(code).into_iter().filter_map(steps).min_by_key(count)
    }

    /// Returns the code at a place, and whether it is turned by half there. Places far outside, which
    /// only damaged data has, become codes on the edge.
    pub(super) fn code(self, at: Place) -> (Place, bool) {
        let last = self.last;
        let [mut x, mut y] = at.map(|x| x.clamp(-2 * last, 3 * last));
        let mut is_turned = false;
        for _ in 0..6 {
            // On an edge, a code and the one across its middle are the same direction.
            (x, y) = match () {
                () if x < 0 => (-x, last - y),
                () if x > last => (2 * last - x, last - y),
                () if y < 0 => (last - x, -y),
                () if y > last => (last - x, 2 * last - y),
                () if (x == 0 || x == last) && 2 * y > last => (x, last - y),
                () if (y == 0 || y == last) && 2 * x > last => (last - x, y),
                () => break,
            };
            is_turned = !is_turned;
        }
        ([x, y].map(|x| x.clamp(0, last)), is_turned)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshlod_mesh::octahedral::unfold;

    #[test]
    fn places_beyond_an_edge_are_close_directions() {
        let plane = OctahedralPlane::new(6);
        for at in -3..=66 {
            for place in [[-1, at], [64, at], [at, -1], [at, 64]] {
                let code = plane.code(place).0;
                let inside = place.map(|x| x.clamp(0, 63));
                let [a, b] = [code, inside].map(|at| unfold(at.map(|x| x as u32), 6));
                assert!(a.angle_between(b) < 0.2, "{place:?} {code:?}");
            }
        }
    }

    #[test]
    fn the_nearest_to_a_place_that_is_as_far_as_can_be_is_found() {
        let plane = OctahedralPlane::new(16);
        let far = [i32::MIN, i32::MIN + 1];
        let nearest =
            plane.places([9, 5]).into_iter().min_by_key(|[x, y]| i64::from(*x) + i64::from(*y));
        assert_eq!(Some(plane.near([9, 5], far)), nearest);
    }

    #[test]
    fn codes_near_another_are_themselves_again() {
        let plane = OctahedralPlane::new(3);
        for n in 0..8 * 8 * 8 * 8 {
            let (code, to) = ([n % 8, n / 8 % 8], [n / 64 % 8, n / 512]);
            let code = plane.code(code).0;
            assert_eq!(plane.code(plane.near(code, to)).0, code);
            assert!(plane.places(code).iter().all(|&at| plane.code(at).0 == code));
            let found = plane.steps_to(code, to, [3, 5]);
            assert!(found.is_none_or(|(at, steps)| {
                plane.code(at).0 == code && at == [to[0] + 3 * steps[0], to[1] + 5 * steps[1]]
            }));
        }
        for far in [[i32::MIN, i32::MAX], [1000, -1000], [9, 9]] {
            let code = plane.code(far).0;
            assert!(code.iter().all(|x| (0..8).contains(x)), "{far:?} {code:?}");
        }
    }
}
