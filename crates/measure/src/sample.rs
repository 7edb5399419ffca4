//! Points spread evenly over a surface, the same for every number of threads.

use std::ops::Range;

use crate::surface::Surface;

/// Samples of the range `which` of `count`, which divide the surface into equal areas: each is a
/// random point of its part.
///
/// Parts follow one another in the order of the hierarchy, so they are compact patches, and
/// neighbouring samples are near each other. A sample depends on `seed` and its own number only.
pub(crate) fn samples<'s>(
    surface: &'s Surface<'_>,
    count: usize,
    seed: u64,
    which: Range<usize>,
) -> impl Iterator<Item = [f64; 3]> + 's {
    let up_to = &surface.area_up_to;
    let total = up_to[up_to.len() - 1];
    // Rounding could step past the end: the last face with area takes those.
    let last = up_to.partition_point(|&area| area < total);
    let start = total * (which.start as f64 / count as f64);
    let mut slot = up_to.partition_point(|&area| area <= start).min(last);
    which.map(move |i| {
        let mut random = Random::new(seed, i as u64);
        let target = total * ((i as f64 + random.unit()) / count as f64);
        while slot < last && up_to[slot] <= target {
            slot += 1;
        }
        let face = surface.bvh.faces_in_order()[slot];
        let [a, b, c] = surface.mesh.triangle(surface.mesh.faces[face.index()]);
        let [mut s, mut t] = [random.unit(), random.unit()];
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        (a + (b - a) * s + (c - a) * t).into()
    })
}

/// SplitMix64: a counter, hashed.
///
/// # References
/// [SLF14].
struct Random(u64);

const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

impl Random {
    /// The generator of sample `index`: its own hash of the seed, so that sequences do not overlap
    /// for neighbouring samples.
    fn new(seed: u64, index: u64) -> Self {
        let mut stream = Self(seed);
        let key = stream.next();
        Self(Self(key ^ index).next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Evenly from [0, 1).
    fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;
    use crate::fixtures::{cube, plane, sphere};

    #[test]
    fn the_generator_gives_the_published_numbers() {
        let mut random = Random(1_234_567);
        assert_eq!(random.next(), 6_457_827_717_110_365_317);
        assert_eq!(random.next(), 3_203_168_211_198_807_973);
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
        let surface = Surface::new(&mesh).unwrap();
        let bottom = samples(&surface, 6000, 1, 0..6000).filter(|point| point[2] == 0.0).count();
        assert!((950..=1050).contains(&bottom), "{bottom}");
    }

    #[test]
    fn samples_are_spread_more_evenly_than_by_chance() {
        let surface = plane(40, 0.0);
        let surface = Surface::new(&surface).unwrap();
        let mut cells = [0usize; 64];
        for [x, y, _] in samples(&surface, 6400, 7, 0..6400) {
            cells[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1;
        }
        // By chance the variance would be about 100.
        let variance = cells.iter().map(|&n| (n as f64 - 100.0).powi(2)).sum::<f64>() / 64.0;
        assert!(variance < 30.0, "{variance}");
    }

    #[test]
    fn ranges_give_what_the_whole_gives() {
        let mesh = sphere(10, 1.0);
        let surface = Surface::new(&mesh).unwrap();
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
        let surface = Surface::new(&mesh).unwrap();
        assert!(samples(&surface, 500, 0, 0..500).all(|point| point[2] == 0.0));
    }
}
