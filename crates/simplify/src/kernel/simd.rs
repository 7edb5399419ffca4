//! Rows of eight floats that go through the same arithmetic lane by lane.
//!
//! A loop over the lanes of rows, without a branch, is compiled to registers as wide as the machine
//! has them. The results are the same for any width, which [`widest`] chooses.

use glam::{Mat4, Vec3, Vec4};

/// Number of lanes in a row.
pub(crate) const LANES: usize = 8;

/// Added to denominators to avoid a division by zero.
pub(crate) const TINY: f32 = 1e-30;

/// One number per lane.
pub(crate) type Row = [f32; LANES];

/// One vector per lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row3 {
    pub(crate) x: Row,
    pub(crate) y: Row,
    pub(crate) z: Row,
}

impl Row3 {
    pub(crate) const ZERO: Self = Self { x: [0.0; LANES], y: [0.0; LANES], z: [0.0; LANES] };

    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, v: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (v.x, v.y, v.z);
    }
}

/// Transposes eight rows of four to four rows of eight.
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

/// Transposes four rows of eight to eight rows of four.
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

/// Sums all lanes, in a fixed order.
#[inline(always)]
pub(crate) fn sum_of(&[a, b, c, d, e, f, g, h]: &Row) -> f32 {
    (Vec4::new(a, b, c, d) + Vec4::new(e, f, g, h)).element_sum()
}

/// Returns the smaller of two numbers; the second if one is NaN.
#[inline(always)]
pub(crate) fn select_min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers; the second if one is NaN.
#[inline(always)]
pub(crate) fn select_max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Work for [`widest`]. Unlike a closure, its method can be marked `inline(always)`.
pub(crate) trait SimdTask {
    /// Result of the work.
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
    use crate::{Method, Options, Target, contract_to};

    /// Makes all tests go without wide registers, which must not change any result.
    static ARE_NARROW: AtomicBool = AtomicBool::new(false);

    pub(crate) fn tests_are_narrow() -> bool {
        ARE_NARROW.load(Relaxed)
    }

    #[test]
    fn results_do_not_depend_on_the_register_width() {
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
            let options = Options { method, ..Options::default() };
            let [wide, narrow] = [false, true].map(|are_narrow| {
                ARE_NARROW.store(are_narrow, Relaxed);
                contract_to(&mesh, Target::Ratio(0.1), &options).unwrap().0
            });
            ARE_NARROW.store(false, Relaxed);
            assert_eq!(wide, narrow);
        }
    }

    #[test]
    fn transposing_swaps_rows_and_columns() {
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
    fn nan_gives_way_to_numbers() {
        assert_eq!((select_min(f32::NAN, 1.0), select_max(f32::NAN, 1.0)), (1.0, 1.0));
        assert_eq!((select_min(2.0, 1.0), select_max(2.0, 1.0)), (1.0, 2.0));
    }
}
