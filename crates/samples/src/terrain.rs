//! Sample mesh of mountains: an open height field of fractal noise.

use glam::{DVec2, DVec3};
use meshlod_mesh::Mesh;

use crate::grid::{self, Size};

/// Builds mountains as a height field over the square [-1, 1]² of x and z: an open surface with one
/// boundary, and +y up.
///
/// Faces: `2 n²` with the closest n, off by at most about one part in n; at least 2. The landscape
/// is the same at any size: more faces only resolve finer rocks.
pub fn terrain(faces: usize) -> Mesh {
    let n = (faces as f64 / 2.0).sqrt().round().max(1.0) as usize;
    grid::open(Size { columns: n, rows: n }, |column, row| {
        let [x, z] = [column, n - row].map(|i| 2.0 * i as f64 / n as f64 - 1.0);
        DVec3::new(x, height(DVec2::new(x, z)), z)
    })
}

/// Octaves of noise: the finest has 2,048 cells along a side, enough for millions of faces.
const OCTAVES: u32 = 11;
/// Cells of the coarsest octave along a side.
const FREQUENCY: f64 = 1.2;
/// Slope at which finer noise has faded to half.
const STEEPNESS: f64 = 0.7;

/// Returns the height above the plain, roughly in [-0.3, 0.6].
///
/// Every octave fades where the slope so far is steep, so that valleys are rough, flanks smooth and
/// ridges sharp, as if eroded.
fn height(place: DVec2) -> f64 {
    let mut sum = 0.0;
    let mut slope = DVec2::ZERO;
    let (mut amplitude, mut frequency) = (0.33, FREQUENCY);
    for octave in 0..OCTAVES {
        let noise = noise(place * frequency, octave);
        slope += noise.slope * amplitude;
        let fade = STEEPNESS * STEEPNESS / (STEEPNESS * STEEPNESS + slope.length_squared());
        sum += amplitude * fade * noise.value;
        amplitude *= 0.48;
        frequency *= 2.03;
    }
    sum
}

/// Noise at a point, in [-1, 1], and its derivative.
struct Noise {
    value: f64,
    slope: DVec2,
}

/// Computes smooth noise: hashed values at integer points, blended by quintics.
fn noise(place: DVec2, seed: u32) -> Noise {
    let cell = place.floor();
    let [x, y] = (place - cell).to_array();
    let at = |dx: i32, dy: i32| hashed(cell.x as i32 + dx, cell.y as i32 + dy, seed);
    let (v00, v10, v01, v11) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
    let ((sx, dx), (sy, dy)) = (quintic(x), quintic(y));
    let (along_x, along_y, twist) = (v10 - v00, v01 - v00, v00 - v10 - v01 + v11);
    Noise {
        value: v00 + along_x * sx + along_y * sy + twist * sx * sy,
        slope: DVec2::new((along_x + twist * sy) * dx, (along_y + twist * sx) * dy),
    }
}

/// 6t⁵ − 15t⁴ + 10t³ and its derivative: flat to the second order at both ends.
fn quintic(t: f64) -> (f64, f64) {
    (t * t * t * (t * (6.0 * t - 15.0) + 10.0), 30.0 * t * t * (t - 1.0) * (t - 1.0))
}

/// Hashes the three arguments to a number in [-1, 1].
fn hashed(x: i32, y: i32, seed: u32) -> f64 {
    let mut bits = (x as u32).wrapping_mul(0x9E37_79B1)
        ^ (y as u32).wrapping_mul(0x85EB_CA77)
        ^ seed.wrapping_mul(0xC2B2_AE3D);
    for _ in 0..2 {
        bits = (bits ^ (bits >> 15)).wrapping_mul(0x2C1B_3C6D);
        bits = (bits ^ (bits >> 12)).wrapping_mul(0x297A_2D39);
    }
    f64::from(bits ^ (bits >> 15)) / f64::from(u32::MAX) * 2.0 - 1.0
}
