//! Long walks in which focus and tolerance change a little at every step and their kinds now and
//! then.

use meshlod_mesh::Mesh;
use meshlod_samples as samples;

use super::walks::{Dice, METHODS, forest, in_forest, topology};
use crate::implicit::Order;
use crate::{Explicit, Focus, Model, Query, Tolerance, UpdateLimits, ViewCamera};

/// A viewer that moves about a mesh.
struct Walker {
    dice: Dice,
    /// Position relative to the mesh's center, in diagonals.
    at: [f64; 3],
    /// Size of the focus and tolerance, as powers of two of the diagonal.
    size: f64,
    coarse: f64,
    focus: usize,
    by_pixels: bool,
}

impl Walker {
    fn new(seed: u64) -> Self {
        let at = [0.4, 0.3, 0.2];
        Self { dice: Dice(seed), at, size: -3.0, coarse: -6.0, focus: 0, by_pixels: true }
    }

    /// Moves a number a little, between two bounds.
    fn wander(&mut self, x: f64, by: f64, [least, most]: [f64; 2]) -> f64 {
        (x + by * (self.dice.roll() - 0.5)).clamp(least, most)
    }

    fn next(&mut self, mesh: &Mesh) -> Query<'static> {
        self.at = self.at.map(|x| x + 0.05 * (self.dice.roll() - 0.5)).map(|x| 0.98 * x);
        self.size = self.wander(self.size, 0.5, [-6.0, 0.0]);
        self.coarse = self.wander(self.coarse, 0.8, [-14.0, -3.0]);
        match (self.dice.roll() * 30.0) as usize {
            0 => self.focus = (self.dice.roll() * 6.0) as usize,
            1 => self.by_pixels = !self.by_pixels,
            _ => {}
        }
        self.query(mesh)
    }

    fn query(&self, mesh: &Mesh) -> Query<'static> {
        let (center, diagonal) = (mesh.bounds().center(), mesh.bounds().diagonal());
        let place = |by: f64| [0, 1, 2].map(|k| center[k] + diagonal * (self.at[k] + by));
        let size = self.size.exp2();
        let camera = ViewCamera {
            eye: [0, 1, 2].map(|k| center[k] + diagonal * 3.0 * self.at[k]),
            look: center,
            up: [0.1, 0.3, 1.0],
            fov_rad: 0.6,
            viewport: [800, 600],
        };
        let focus = match self.focus {
            0 => Focus::Everything,
            1 => Focus::Point(place(0.0)),
            2 => Focus::Segment([place(-size), place(size)]),
            3 => Focus::Box([place(-size), place(size)]),
            4 => Focus::Sphere { center: place(0.0), radius: size * diagonal },
            _ => Focus::Frustum(camera),
        };
        let tolerance = match self.by_pixels {
            true => Tolerance::Pixels { camera, pixels: (self.coarse + 9.0).exp2() },
            false => Tolerance::Uniform(diagonal * self.coarse.exp2()),
        };
        Query { focus, tolerance }
    }
}

/// Compares all encodings all the way, also when interrupted.
#[test]
fn a_thousand_steps_with_every_method() {
    for (seed, method) in (31..).zip(METHODS) {
        for mesh in [samples::terrain(300), samples::torus(300)] {
            let forest = forest(&mesh, method);
            let (order, explicit) = (Order::new(&forest), Explicit::new(&forest));
            let model = Model::new(&forest).unwrap();
            let (mut cut, mut extractor) = (model.cut(), model.extractor());
            let (mut walker, mut changes) = (Walker::new(seed), 0);
            let expected = topology(&mesh);
            for step in 0..1000 {
                let query = walker.next(&mesh);
                let some = UpdateLimits { changes: Some(step % 5), time: None };
                let begun = cut.update(&query, &some).unwrap();
                if step % 4 == 0 {
                    assert_eq!(topology(&cut.level().mesh()), expected, "{step}: {query:?}");
                }
                let ended = cut.update(&query, &UpdateLimits::default()).unwrap();
                assert!(ended.done);
                changes += begun.splits + begun.merges + ended.splits + ended.merges;
                let level = cut.level();
                let fresh = extractor.exact(&query).unwrap();
                assert_eq!(level.canonical(), fresh.canonical(), "{step}: {query:?}");
                if step % 10 == 0 {
                    let published = explicit.extract(&query).unwrap();
                    assert_eq!(in_forest(&level, &order), published.canonical(), "{query:?}");
                    assert_eq!(topology(&level.mesh()), expected, "{step}: {query:?}");
                }
            }
            assert!(changes > 1000, "{} changes {changes}", method.name());
        }
    }
}
