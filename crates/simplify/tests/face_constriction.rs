//! Claims of [LJ05] about itself and [Wu01].

use meshlod_mesh::{Mesh, VertexId};
use meshlod_simplify::{Method, Options, Simplifier};

/// Plane of unit squares with a regular pyramid on it: all edges of its tip turn alike.
fn pyramid_on_a_plain() -> Mesh {
    const SIDE: u32 = 21;
    let at = |x: u32, y: u32| VertexId(y * SIDE + x);
    let middle = SIDE / 2;
    let height = |x: u32, y: u32| if (x, y) == (middle, middle) { 1.0 } else { 0.0 };
    let positions = (0..SIDE * SIDE).map(|i| {
        let (x, y) = (i % SIDE, i / SIDE);
        // Not quite flat, or the order on the plane would be that of rounding errors.
        let ripple = 0.05 * (f64::from(x) * 0.9).sin() * (f64::from(y) * 1.1).cos();
        [f64::from(x), f64::from(y), height(x, y) + ripple]
    });
    let faces = (0..(SIDE - 1) * (SIDE - 1)).flat_map(|i| {
        let (x, y) = (i % (SIDE - 1), i / (SIDE - 1));
        let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        // The diagonals run to the tip, which therefore has the same four faces twice.
        let to_tip = (x + 1 == middle) == (y + 1 == middle);
        if to_tip { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
    });
    Mesh::new(positions.collect(), faces.collect())
}

/// Number of faces left when the tip is removed.
fn faces_at_the_end_of_the_tip(method: Method) -> usize {
    let mesh = pyramid_on_a_plain();
    let options = Options { method, ..Options::default() };
    let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
    while simplifier.step(f64::INFINITY, &mut ()) {
        if simplifier.level().bounds().max[2] < 0.8 {
            break;
        }
    }
    simplifier.live_faces()
}

#[test]
fn a_regular_tip_stays_longer_where_its_edges_count() {
    let [lee_jang, wu] = [Method::LeeJang, Method::Wu].map(faces_at_the_end_of_the_tip);
    assert!(lee_jang < wu, "gone at {lee_jang} and {wu} faces of 800");
}
