//! Sample mesh of mountains: an open height field of fractal noise.

use glam::{DVec2, DVec3};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};

use crate::grid::{self, Size, quad, split};

/// Builds mountains as a height field over the square [-1, 1]² of x and z: an open surface with one
/// boundary, and +y up.
///
/// Faces: `2 n²` with the closest n, off by at most about one part in n; at least 2. The landscape
/// is the same at any size: more faces only resolve finer rocks.
pub fn terrain(faces: usize) -> Mesh {
    let rows = TerrainRows::new(faces);
    let size = Size { columns: rows.side, rows: rows.side };
    grid::open(size, |column, row| rows.place(column, row))
}

/// Builds [`terrain`] with a colour for each vertex, by its height.
pub fn colored_terrain(faces: usize) -> Mesh {
    let mesh = terrain(faces);
    let colors = mesh.positions.iter().flat_map(|place| terrain_color(place[1]));
    let layer = Layer {
        kind: LayerKind::Color(0),
        name: "color".to_owned(),
        width: 3,
        values: colors.map(|x| f32::from(x) / 255.0).collect(),
    };
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let wedge_count = mesh.positions.len();
    let attributes = Attributes { corners, wedge_count, layers: vec![layer] };
    Mesh { attributes: Some(attributes), ..mesh }
}

/// Vertices and faces of [`terrain`] row by row, for terrains that are larger than memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TerrainRows {
    /// Number of quads along a side.
    side: usize,
}

impl TerrainRows {
    /// Creates the rows of the terrain of about this many faces.
    pub fn new(faces: usize) -> Self {
        Self { side: (faces as f64 / 2.0).sqrt().round().max(1.0) as usize }
    }

    /// Returns the number of rows of vertices, and of vertices in each; there is one row of faces
    /// less.
    pub fn count(self) -> usize {
        self.side + 1
    }

    /// Returns the number of vertices and of faces.
    pub fn sizes(self) -> [u64; 2] {
        let side = self.side as u64;
        [(side + 1) * (side + 1), 2 * side * side]
    }

    /// Returns the vertices of a row.
    pub fn places(self, row: usize) -> impl Iterator<Item = [f64; 3]> {
        (0..=self.side).map(move |column| self.place(column, row).into())
    }

    /// Returns the faces between a row of vertices and the next.
    pub fn faces(self, row: usize) -> impl Iterator<Item = [u32; 3]> {
        let vertex = move |column, row| (row * (self.side + 1) + column) as u32;
        (0..self.side).flat_map(move |c| split(quad(c, row).map(|[c, r]| vertex(c, r))))
    }

    fn place(self, column: usize, row: usize) -> DVec3 {
        let [x, z] = [column, self.side - row].map(|i| 2.0 * i as f64 / self.side as f64 - 1.0);
        DVec3::new(x, height(DVec2::new(x, z)), z)
    }
}

/// Heights and the colours at them, between which colours are mixed: water, grass, wood, rock and
/// snow.
const COLORS: [(f64, [f64; 3]); 6] = [
    (-0.25, [46.0, 84.0, 92.0]),
    (-0.12, [110.0, 138.0, 74.0]),
    (0.02, [70.0, 104.0, 54.0]),
    (0.16, [116.0, 104.0, 84.0]),
    (0.30, [146.0, 142.0, 138.0]),
    (0.42, [240.0, 243.0, 246.0]),
];

/// Returns the colour of a [`terrain`] at a height, as red, green and blue.
pub fn terrain_color(height: f64) -> [u8; 3] {
    let above = COLORS.iter().position(|(from, _)| height < *from).unwrap_or(COLORS.len());
    let [(low, from), (high, to)] =
        [above.max(1) - 1, above.min(COLORS.len() - 1)].map(|i| COLORS[i]);
    let part = if high > low { (height - low) / (high - low) } else { 0.0 };
    let part = part.clamp(0.0, 1.0);
    [0, 1, 2].map(|i| (from[i] + part * (to[i] - from[i])).round() as u8)
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
