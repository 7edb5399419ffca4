//! Eight at a time: rows of floats that go through the same arithmetic, lane by lane.
//!
//! A loop over the lanes of rows, with no branch in it, becomes registers as wide as the machine has
//! them; the numbers are the same for any width. [`widest`] is where the width is chosen.

use glam::{Mat4, Vec3, Vec4};

/// How many.
pub(crate) const LANES: usize = 8;

/// Keeps a division by nothing from being one.
pub(crate) const TINY: f32 = 1e-30;

/// A number of each.
pub(crate) type Row = [f32; LANES];

/// A vector of each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row3 {
    pub(crate) x: Row,
    pub(crate) y: Row,
    pub(crate) z: Row,
}

impl Row3 {
    pub(crate) const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    #[inline(always)]
    pub(crate) fn all(v: Vec3) -> Self {
        Self { x: [v.x; LANES], y: [v.y; LANES], z: [v.z; LANES] }
    }

    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, v: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}

/// Eight rows of four as four rows of eight.
#[inline(always)]
pub(crate) fn transpose(rows: [Vec4; LANES]) -> [Row; 4] {
    let [a, b, c, d, e, f, g, h] = rows;
    let (left, right) = (Mat4::from_cols(a, b, c, d), Mat4::from_cols(e, f, g, h));
    let (left, right) = (left.transpose(), right.transpose());
    [
        concat(left.x_axis, right.x_axis),
        concat(left.y_axis, right.y_axis),
        concat(left.z_axis, right.z_axis),
        concat(left.w_axis, right.w_axis),
    ]
}

#[inline(always)]
fn concat(left: Vec4, right: Vec4) -> Row {
    let ([a, b, c, d], [e, f, g, h]) = (left.to_array(), right.to_array());
    [a, b, c, d, e, f, g, h]
}

/// Four rows of eight as eight rows of four.
#[inline(always)]
pub(crate) fn transpose_back(rows: [Row; 4]) -> [Vec4; LANES] {
    let half = |start: usize| {
        let four = |row: &Row| Vec4::from_slice(&row[start..start + 4]);
        let [a, b, c, d] = &rows;
        Mat4::from_cols(four(a), four(b), four(c), four(d)).transpose()
    };
    let (l, r) = (half(0), half(4));
    [l.x_axis, l.y_axis, l.z_axis, l.w_axis, r.x_axis, r.y_axis, r.z_axis, r.w_axis]
}

/// The sum of all lanes, halves by halves.
#[inline(always)]
pub(crate) fn sum_of(&[a, b, c, d, e, f, g, h]: &Row) -> f32 {
    (Vec4::new(a, b, c, d) + Vec4::new(e, f, g, h)).element_sum()
}

/// The lesser of two; where one is no number, the second.
#[inline(always)]
pub(crate) fn select_min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater of two; where one is no number, the second.
#[inline(always)]
pub(crate) fn select_max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// SimdTask for [`widest`]. A function that is always inlined, which a closure need not be.
pub(crate) trait SimdTask {
    /// What it comes to.
    type Output;

    fn work(self) -> Self::Output;
}

/// Does the work with the widest registers that this machine has.
pub(crate) fn widest<W: SimdTask>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") && !tests_are_narrow() {
        #[target_feature(enable = "avx2")]
        fn with_avx2<W: SimdTask>(work: W) -> W::Output {
            work.work()
        }
        // SAFETY: the machine has what the function is compiled for.
        #[allow(unsafe_code)]
        return unsafe { with_avx2(work) };
    }
    work.work()
}

#[cfg(not(test))]
fn tests_are_narrow() -> bool {
    false
}

#[cfg(test)]
use self::tests::tests_are_narrow;

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

    use meshlod_mesh::Mesh;
    use meshlod_samples as samples;

    use super::*;
    use crate::kernel::attributes::import_export::tests::{faceted, halved};
    use crate::{Method, Options, Target, simplify};

    /// Whether tests go without wide registers, all of them: it is not to be seen.
    static ARE_NARROW: AtomicBool = AtomicBool::new(false);

    pub(crate) fn tests_are_narrow() -> bool {
        ARE_NARROW.load(Relaxed)
    }

    #[test]
    fn the_width_is_not_seen() {
        let bare = Mesh { attributes: None, ..samples::terrain(4000) };
        for (mesh, method) in [
            (samples::knot(4000), Method::LindstromTurk),
            (samples::fish(4000), Method::LindstromTurk),
            (samples::terrain(4000), Method::LindstromTurk),
            (halved(samples::knot(4000)), Method::LindstromTurk),
            (faceted(samples::torus(2000)), Method::LindstromTurk),
            (samples::knot(4000), Method::Qem),
            (bare, Method::Qem),
        ] {
            let options = Options { method: Some(method), ..Options::default() };
            let [wide, narrow] = [false, true].map(|are_narrow| {
                ARE_NARROW.store(are_narrow, Relaxed);
                simplify(&mesh, Target::Ratio(0.1), &options).unwrap().0
            });
            ARE_NARROW.store(false, Relaxed);
            assert_eq!(wide, narrow);
        }
    }

    #[test]
    fn rows_become_columns() {
        let mut rows = [Vec4::ZERO; LANES];
        for (lane, row) in rows.iter_mut().enumerate() {
            *row = Vec4::new(0.0, 10.0, 20.0, 30.0) + lane as f32;
        }
        let columns = transpose(rows);
        for (i, column) in columns.iter().enumerate() {
            for (lane, x) in column.iter().enumerate() {
                assert_eq!(*x, (10 * i + lane) as f32);
            }
        }
        assert_eq!(transpose_back(columns), rows);
    }

    #[test]
    fn what_is_no_number_gives_way() {
        assert_eq!((select_min(f32::NAN, 1.0), select_max(f32::NAN, 1.0)), (1.0, 1.0));
        assert_eq!((select_min(2.0, 1.0), select_max(2.0, 1.0)), (1.0, 2.0));
    }
}
