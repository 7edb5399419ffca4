//! Differences between pictures of the levels of a member.

use glam::{DVec3, Vec3};
use meshlod_mesh::Mesh;
use meshlod_picture::{
    Antialiasing, Background, Camera, Lighting, Normals, Picture, Style, render,
};
use rayon::prelude::*;

use crate::levels::directions::DirectionGrid;
use crate::levels::look::Look;
use crate::levels::table::TableError;

/// Differences between pictures of a model and of its levels, by direction and size.
///
/// A difference is an area: pixels that are half as bright as they should be count half. Details
/// smaller than a pixel blend with their surroundings, so a small picture shows less of a
/// difference than a large one of the same area.
#[derive(Clone, Debug, PartialEq)]
pub struct Differences {
    directions: DirectionGrid,
    levels: usize,
    /// For each direction, level and octave of size, the area in square body lengths.
    areas: Vec<f32>,
    /// Area that the model covers, in square body lengths, for each direction.
    silhouettes: Vec<f32>,
}

/// Cells along the side of the grid of directions: 6 gives 36, at most 29° from their pictures.
const DIRECTIONS: usize = 6;

/// Side of the largest pictures in pixels.
const SIDE: u32 = 128;

/// Sizes at which pictures are compared: the largest, then halves.
pub(crate) const OCTAVES: usize = 7;

/// Power of differences in brightness that adds up. Triangles that `ours` needs over those of
/// `screen-error` for a FLIP of .02 and .1, with .5, .7, 1, 1.5 and 2: .79 .71 .68 .66 .66, and .84
/// .78 .73 .69 .69.
const POWER: f32 = 1.5;

/// Width of the pictures in body lengths: a ball around the longest diagonal fits.
const WIDTH: f64 = 1.25;

/// Pixels per body length in the largest pictures.
pub(crate) const FINEST_PX: f32 = SIDE as f32 / WIDTH as f32;

impl Differences {
    /// Draws all levels of a chain from all directions and compares them with the first.
    pub(crate) fn measure(levels: &[Mesh], look: &Look) -> Result<Self, TableError> {
        let directions = Self::grid();
        let seen_from = |cell: usize| -> Result<(Vec<f32>, f32), TableError> {
            let camera = camera(directions.axis(cell));
            let model = draw(&levels[0], look, &camera)?;
            let mut areas = vec![0.0; OCTAVES];
            for level in &levels[1..] {
                areas.extend(pyramid(&model, &draw(level, look, &camera)?));
            }
            Ok((areas, covered(&model)))
        };
        let cells: Result<Vec<_>, _> =
            (0..directions.len()).into_par_iter().map(seen_from).collect();
        let (areas, silhouettes): (Vec<_>, _) = cells?.into_iter().unzip();
        Ok(Self { directions, levels: levels.len(), areas: areas.concat(), silhouettes })
    }

    /// Returns the directions from which the levels were compared.
    pub fn directions(&self) -> &DirectionGrid {
        &self.directions
    }

    /// Returns the difference of a level of the whole chain from the model, in square body lengths,
    /// seen from a direction of the grid at `px` pixels per body length.
    pub fn area(&self, direction: usize, level: usize, px: f32) -> f32 {
        let at = (direction * self.levels + level) * OCTAVES;
        let octave = (FINEST_PX / px.max(1e-6)).log2().clamp(0.0, (OCTAVES - 1) as f32);
        let (low, part) = (octave.floor() as usize, octave.fract());
        let high = (low + 1).min(OCTAVES - 1);
        self.areas[at + low] * (1.0 - part) + self.areas[at + high] * part
    }

    /// Number of sizes at which levels are compared.
    pub const SIZES: usize = OCTAVES;

    /// Returns the sizes at which levels are compared, in pixels per body length.
    pub fn pixels_per_body_length() -> [f32; Self::SIZES] {
        std::array::from_fn(|octave| FINEST_PX / (1 << octave) as f32)
    }

    /// Returns the grid of the directions from which levels are compared.
    pub fn grid() -> DirectionGrid {
        DirectionGrid::new(DIRECTIONS)
    }

    /// Returns the areas by direction, level and size, and the silhouettes by direction.
    pub fn arrays(&self) -> (&[f32], &[f32]) {
        (&self.areas, &self.silhouettes)
    }

    /// Creates differences from what [`Self::arrays`] has returned for `levels` levels.
    pub fn from_arrays(levels: usize, areas: Vec<f32>, silhouettes: Vec<f32>) -> Self {
        Self { directions: Self::grid(), levels, areas, silhouettes }
    }

    /// Returns the area that the model covers, in square body lengths, seen from a direction.
    pub fn silhouette(&self, direction: usize) -> f32 {
        self.silhouettes[direction]
    }
}

/// Returns the camera that sees the ball around a member from afar.
fn camera(axis: Vec3) -> Camera {
    const DISTANCE: f64 = 20.0;
    let fov = 2.0 * (0.5 * WIDTH / DISTANCE).atan();
    let eye = axis.as_dvec3() * DISTANCE;
    Camera::look_at(eye.into(), [0.0; 3], DVec3::Y.into(), fov)
}

fn draw(mesh: &Mesh, look: &Look, camera: &Camera) -> Result<Picture, TableError> {
    let style = Style {
        size: [SIDE; 2],
        paint: look.paint(),
        normals: Normals::FromMesh,
        lighting: Lighting::Headlight,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    Ok(render(mesh, camera, &style)?)
}

/// Returns the area of a pixel in square body lengths.
fn pixel_area() -> f32 {
    (WIDTH as f32 / SIDE as f32).powi(2)
}

/// Returns the area that a picture covers, in square body lengths.
fn covered(picture: &Picture) -> f32 {
    let sum: u32 = picture.rgba().iter().skip(3).step_by(4).map(|&alpha| u32::from(alpha)).sum();
    sum as f32 / 255.0 * pixel_area()
}

/// Returns the mean difference of two pictures at each octave, times their area.
fn pyramid(model: &Picture, level: &Picture) -> [f32; OCTAVES] {
    let mut differences: Vec<Vec3> =
        over_grey(model).zip(over_grey(level)).map(|(a, b)| a - b).collect();
    let mut side = SIDE as usize;
    let whole = pixel_area() * (SIDE * SIDE) as f32;
    std::array::from_fn(|octave| {
        if octave > 0 {
            differences = halved(&differences, side);
            side /= 2;
        }
        let sum: f32 = differences.iter().map(|d| (d.abs().element_sum() / 3.0).powf(POWER)).sum();
        sum / differences.len() as f32 * whole
    })
}

/// Returns the pixels of a picture over mid-grey, in the steps of sRGB, in which equal differences
/// look alike.
fn over_grey(picture: &Picture) -> impl Iterator<Item = Vec3> {
    picture.rgba().chunks_exact(4).map(|p| {
        let color = Vec3::new(p[0].into(), p[1].into(), p[2].into()) / 255.0;
        Vec3::splat(0.5).lerp(color, f32::from(p[3]) / 255.0)
    })
}

/// Averages blocks of two by two.
fn halved(values: &[Vec3], side: usize) -> Vec<Vec3> {
    let half = side / 2;
    let at = |x: usize, y: usize| values[y * side + x];
    let block = |i: usize| {
        let (x, y) = (2 * (i % half), 2 * (i / half));
        (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) * 0.25
    };
    (0..half * half).map(block).collect()
}
