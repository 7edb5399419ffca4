//! Stratified random sampling of a surface, independent of the number of threads.

use std::ops::Range;

use crate::prepared::PreparedSurface;

/// Iterates over the samples in the range `which` of `count`, each a random point of its own
/// stratum of equal area.
///
/// Strata follow the faces in leaf order and each face along a triangle-filling curve, so they are
/// compact and neighbouring samples are near each other. A sample depends only on `seed` and its
/// index.
pub(crate) fn samples<'s>(
    surface: &'s PreparedSurface<'_>,
    count: usize,
    seed: u64,
    which: Range<usize>,
) -> impl Iterator<Item = [f64; 3]> + 's {
    let up_to = &surface.area_up_to;
    let total = up_to[up_to.len() - 1];
    // Rounding could step past the end: the last face with area takes those samples.
    let last = up_to.partition_point(|&area| area < total);
    let start = total * (which.start as f64 / count as f64);
    let mut slot = up_to.partition_point(|&area| area <= start).min(last);
    which.map(move |i| {
        let target = total * ((i as f64 + random_unit(seed, i as u64)) / count as f64);
        while slot < last && up_to[slot] <= target {
            slot += 1;
        }
        let before = if slot == 0 { 0.0 } else { up_to[slot - 1] };
        let [s, t] = along_triangle((target - before) / (up_to[slot] - before));
        let face = surface.bvh.faces_in_leaf_order()[slot];
        let [a, b, c] = surface.mesh.triangle(surface.mesh.faces[face.index()]);
        (a + (b - a) * s + (c - a) * t).into()
    })
}

/// Returns the point at the fraction `part` of a curve that fills the triangle (0, 0), (1, 0),
/// (0, 1); equal fractions cover equal areas.
///
/// Each two bits of `part` choose one of four smaller triangles; after 32 bits the point is the
/// centroid.
///
/// # References
/// [BO15], the triangular van der Corput points; differs: the order of the four triangles.
fn along_triangle(part: f64) -> [f64; 2] {
    // The cast saturates if rounding leaves the range.
    let mut bits = (part * 2f64.powi(32)) as u32;
    // The corner at the right angle and the signed length of the legs.
    let (mut s, mut t, mut leg) = (0.0, 0.0, 1.0);
    for _ in 0..16 {
        let half = leg * 0.5;
        leg = half;
        match bits >> 30 {
            0 => {}
            1 => (s, t, leg) = (s + half, t + half, -half),
            2 => s += half,
            _ => t += half,
        }
        bits <<= 2;
    }
    [s + leg / 3.0, t + leg / 3.0]
}

/// Returns number `index` of the pseudorandom sequence of `seed`, uniform in [0, 1).
///
/// # References
/// [SLF14], the generator SplitMix64, which can jump to any index.
fn random_unit(seed: u64, index: u64) -> f64 {
    // Hashed, so that the sequences of neighbouring seeds are not shifts of each other.
    let start = hash(seed.wrapping_add(STEP));
    let state = start.wrapping_add(STEP.wrapping_mul(index.wrapping_add(1)));
    (hash(state) >> 11) as f64 / (1u64 << 53) as f64
}

/// Increment of the generator: 2^64 over the golden ratio.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

fn hash(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;
    use crate::fixtures::{cube, plane, sphere};

    #[test]
    fn the_generator_gives_the_published_numbers() {
        let state = |step| 1_234_567u64.wrapping_add(STEP.wrapping_mul(step));
        assert_eq!(hash(state(1)), 6_457_827_717_110_365_317);
        assert_eq!(hash(state(2)), 3_203_168_211_198_807_973);
    }

    #[test]
    fn the_curve_fills_the_triangle_evenly() {
        // 64 steps, and 64 small triangles: half squares of a grid of 8 by 8.
        let cell = |i: u32| {
            let [s, t] = along_triangle((f64::from(i) + 0.5) / 64.0);
            assert!(s > 0.0 && t > 0.0 && s + t < 1.0);
            let above = (s * 8.0).fract() + (t * 8.0).fract() > 1.0;
            ((s * 8.0) as u32, (t * 8.0) as u32, above)
        };
        let cells: std::collections::HashSet<_> = (0..64).map(cell).collect();
        assert_eq!(cells.len(), 64);
        for part in [-1e-9, 0.0, 1.0, 1.5] {
            let [s, t] = along_triangle(part);
            assert!(s >= 0.0 && t >= 0.0 && s + t <= 1.0, "{part}");
        }
    }

    #[test]
    fn area_gets_its_share() {
        // One side of the cube is divided into many small faces.
        let mut mesh = plane(10, 0.0);
        let shift = mesh.positions.len() as u32;
        let cube = cube();
        mesh.positions.extend(cube.positions);
        let sides = cube.faces.into_iter().skip(2).map(|face| face.map(|v| VertexId(v.0 + shift)));
        mesh.faces.extend(sides);
        let surface = PreparedSurface::new(&mesh).unwrap();
        let bottom = samples(&surface, 6000, 1, 0..6000).filter(|point| point[2] == 0.0).count();
        assert!((950..=1050).contains(&bottom), "{bottom}");
    }

    #[test]
    fn samples_are_spread_more_evenly_than_by_chance() {
        // Faces smaller than the cells, and faces that hold many.
        for squares in [40, 1] {
            let mesh = plane(squares, 0.0);
            let surface = PreparedSurface::new(&mesh).unwrap();
            let mut cells = [0usize; 64];
            for [x, y, _] in samples(&surface, 6400, 7, 0..6400) {
                cells[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
            }
            // By chance the variance would be about 100.
            let variance = cells.iter().map(|&n| (n as f64 - 100.0).powi(2)).sum::<f64>() / 64.0;
            assert!(variance < 15.0, "{squares}: {variance}");
        }
    }

    #[test]
    fn ranges_give_what_the_whole_gives() {
        let mesh = sphere(10, 1.0);
        let surface = PreparedSurface::new(&mesh).unwrap();
        let whole: Vec<_> = samples(&surface, 1000, 3, 0..1000).collect();
        let parts = (0..10).flat_map(|i| samples(&surface, 1000, 3, i * 100..(i + 1) * 100));
        assert!(parts.eq(whole.iter().copied()));
        let other: Vec<_> = samples(&surface, 1000, 4, 0..1000).collect();
        assert_ne!(whole, other);
    }

    #[test]
    fn faces_without_area_get_nothing() {
        let mut mesh = plane(1, 0.0);
        mesh.positions.push([0.5, 0.5, 9.0]);
        let tip = VertexId::new(mesh.positions.len() - 1);
        let corner = mesh.faces[0][0];
        mesh.faces.splice(0..0, [[corner, tip, tip], [corner, corner, tip]]);
        mesh.faces.push([tip, tip, corner]);
        let surface = PreparedSurface::new(&mesh).unwrap();
        assert!(samples(&surface, 500, 0, 0..500).all(|point| point[2] == 0.0));
    }
}
