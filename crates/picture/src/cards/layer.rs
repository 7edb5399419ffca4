//! Drawing of cards.

use std::ops::Range;

use glam::{DVec3, Vec2, Vec3, Vec4};
use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::camera::Lens;
use crate::cards::CardAtlas;
use crate::error::check_size;
use crate::srgb::{decode, encode};
use crate::visibility::visibility;
use crate::{Camera, Picture, PictureError};

/// Parallelogram in space that shows a cell of an atlas, from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Card {
    /// Cell of the atlas.
    pub cell: usize,
    /// Upper left corner of the cell.
    pub corner: [f64; 3],
    /// Edge from there to the upper right corner.
    pub right: [f64; 3],
    /// Edge from there to the lower left corner.
    pub down: [f64; 3],
}

/// Cards seen by a camera, without the background.
#[derive(Clone, Debug, PartialEq)]
pub struct CardLayer {
    size: [u32; 2],
    /// Linear light times alpha, and alpha.
    pixels: Vec<Vec4>,
}

/// Samples along the side of a pixel, as with [`Antialiasing::Four`](crate::Antialiasing::Four).
const ACROSS: u32 = 2;

/// Rows of pixels that one task draws.
const BAND: usize = 16;

/// Draws cards as far as a mesh does not hide them.
///
/// Each of four samples a pixel is filtered over its own part of the pixel, blended from the farthest
/// card to the nearest by the depths of their middles, and hidden where the mesh is nearer. Cards
/// that pass through each other are not cut. Footprints are square, so a card that is seen nearly
/// edge-on looks blurred. Pixels do not depend on the number of threads.
///
/// `size` is width and height in pixels. Cost: that of [`visibility`](crate::visibility()) for four
/// samples a pixel, and O(samples covered, counting layers).
///
/// # Errors
/// An invalid mesh, a side above half of [`MAX_SIDE`](crate::MAX_SIDE), or a cell that the atlas
/// lacks.
pub fn card_layer(
    cards: &[Card],
    atlas: &CardAtlas,
    mesh: &Mesh,
    camera: &Camera,
    size: [u32; 2],
) -> Result<CardLayer, PictureError> {
    check_size(size[0].into(), size[1].into())?;
    if let Some(card) = cards.iter().find(|card| card.cell >= atlas.cells()) {
        return Err(PictureError::NoCell { cell: card.cell, count: atlas.cells() });
    }
    let samples = size.map(|side| side * ACROSS);
    let seen = visibility(mesh, camera, samples)?;
    let depths: Vec<f64> = seen.depths().map(|depth| depth.unwrap_or(f64::INFINITY)).collect();
    let lens = camera.lens(samples[0], samples[1]);
    let mut placed: Vec<Placed> =
        cards.iter().filter_map(|card| Placed::new(card, atlas, &lens, samples)).collect();
    placed.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let width = size[0] as usize;
    let mut pixels = vec![Vec4::ZERO; width * size[1] as usize];
    let bands = pixels.par_chunks_mut(BAND * width).enumerate();
    bands.for_each_init(Vec::new, |band, (i, pixels)| {
        let row = samples[0] as usize;
        let first = i * BAND * ACROSS as usize;
        let rows = first..first + pixels.len() / width * ACROSS as usize;
        band.clear();
        band.resize(row * rows.len(), Vec4::ZERO);
        for card in &placed {
            card.draw(band, &depths[row * first..], rows.clone(), row, atlas);
        }
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let at = 2 * (i / width) * row + 2 * (i % width);
            let four = [at, at + 1, at + row, at + row + 1].map(|at| band[at]);
            *pixel = four.into_iter().sum::<Vec4>() * 0.25;
        }
    });
    Ok(CardLayer { size, pixels })
}

impl CardLayer {
    /// Returns a picture with the cards over it, blended in linear light.
    ///
    /// # Errors
    /// A picture of another size.
    pub fn over(&self, picture: &Picture) -> Result<Picture, PictureError> {
        let size = [picture.width(), picture.height()];
        if size != self.size {
            return Err(PictureError::DifferentSizes { a: self.size, b: size });
        }
        let mut rgba = picture.rgba().to_vec();
        for (pixel, card) in rgba.chunks_exact_mut(4).zip(&self.pixels).filter(|(_, c)| c.w > 0.0) {
            let behind = f32::from(pixel[3]) / 255.0 * (1.0 - card.w);
            let alpha = card.w + behind;
            let color: Vec3 =
                (card.truncate() + decode([pixel[0], pixel[1], pixel[2]]) * behind) / alpha;
            pixel[..3].copy_from_slice(&color.to_array().map(encode));
            pixel[3] = (alpha * 255.0 + 0.5) as u8;
        }
        Picture::new(size[0], size[1], rgba)
    }

    /// Returns the part of each pixel that cards cover, 0 to 1, row after row from the top.
    pub fn coverage(&self) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.pixels.iter().map(|pixel| pixel.w)
    }
}

/// Card in front of a camera.
struct Placed {
    cell: usize,
    /// Depth of the middle.
    depth: f64,
    near: f64,
    /// Columns and rows of samples that may show it.
    columns: Range<usize>,
    rows: Range<usize>,
    /// Ray through the middle of the first sample of the grid at depth 1, and its changes.
    ray: DVec3,
    steps: [DVec3; 2],
    /// Normal, and its product with the way from the eye to the corner.
    normal: DVec3,
    offset: f64,
    /// Way from the corner to the eye, and what maps ways to parts of the edges.
    to_eye: DVec3,
    parts: [DVec3; 2],
    /// Texels that a sample spans at depth 1.
    texels: f64,
}

impl Placed {
    /// Places a card; `None` if it is behind the camera or has no area.
    fn new(card: &Card, atlas: &CardAtlas, lens: &Lens, samples: [u32; 2]) -> Option<Self> {
        let [corner, right, down] = [card.corner, card.right, card.down].map(DVec3::from);
        let normal = right.cross(down);
        let square = normal.length_squared();
        if !square.is_normal() {
            return None;
        }
        let corners = [corner, corner + right, corner + down, corner + right + down];
        let seen = corners.map(|corner| lens.project(corner));
        let near = lens.near();
        if seen.iter().all(|p| p.z <= near) {
            return None;
        }
        let passes_eye = seen.iter().any(|p| p.z <= near);
        let range = |axis: usize| {
            let places = seen.map(|p| p[axis] / p.z);
            let low = places.into_iter().fold(f64::INFINITY, f64::min);
            let high = places.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let most = samples[axis] as usize;
            if passes_eye {
                0..most
            } else {
                (low as usize).min(most)..(high as usize + 1).min(most)
            }
        };
        let (columns, rows) = (range(0), range(1));
        let steps = lens.ray_steps();
        Some(Self {
            cell: card.cell,
            depth: seen.iter().map(|p| p.z).sum::<f64>() * 0.25,
            near,
            columns,
            rows,
            ray: lens.ray(0.5, 0.5),
            steps,
            normal,
            offset: normal.dot(corner - lens.eye()),
            to_eye: lens.eye() - corner,
            // The ways across the other edge, in the plane.
            parts: [down.cross(normal) / square, normal.cross(right) / square],
            texels: steps[0].length() / right.length() * f64::from(atlas.cell_px()),
        })
    }

    /// Blends the card over the samples of a band: rows `rows` of the grid, `width` samples each.
    fn draw(
        &self,
        band: &mut [Vec4],
        depths: &[f64],
        rows: Range<usize>,
        width: usize,
        atlas: &CardAtlas,
    ) {
        for y in self.rows.start.max(rows.start)..self.rows.end.min(rows.end) {
            for x in self.columns.clone() {
                let ray = self.ray + self.steps[0] * x as f64 + self.steps[1] * y as f64;
                let depth = self.offset / self.normal.dot(ray);
                let at = (y - rows.start) * width + x;
                if !(depth > self.near && depth < depths[at]) {
                    continue;
                }
                let way = self.to_eye + ray * depth;
                let part = self.parts.map(|part| part.dot(way) as f32);
                if !part.iter().all(|part| (0.0..=1.0).contains(part)) {
                    continue;
                }
                let texels = (self.texels * depth) as f32;
                let shown = atlas.sample(self.cell, Vec2::from(part), texels);
                band[at] = shown + band[at] * (1.0 - shown.w);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{from_front, stack};

    /// Atlas of one cell of four by four in one colour.
    fn plain(color: [u8; 4]) -> CardAtlas {
        CardAtlas::new(&Picture::new(4, 4, color.repeat(16)).unwrap(), 4).unwrap()
    }

    /// Square of this half side around the z axis.
    fn square(half: f64, z: f64) -> Card {
        let side = 2.0 * half;
        let (right, down) = ([side, 0.0, 0.0], [0.0, -side, 0.0]);
        Card { cell: 0, corner: [-half, half, z], right, down }
    }

    fn layer(cards: &[Card], atlas: &CardAtlas, mesh: &Mesh) -> CardLayer {
        card_layer(cards, atlas, mesh, &from_front(3.0), [9, 9]).unwrap()
    }

    #[test]
    fn what_is_nearer_hides_a_card() {
        let atlas = plain([255; 4]);
        let covered = |z: f64| {
            let layer = layer(&[square(9.0, z)], &atlas, &stack(&[0.0]));
            layer.coverage().map(f64::from).sum::<f64>()
        };
        assert_eq!(covered(0.5), 81.0, "before the triangle it fills the view");
        let hidden = 81.0 - covered(-0.5);
        let shows = visibility(&stack(&[0.0]), &from_front(3.0), [18, 18]).unwrap();
        assert_eq!(hidden, shows.covered() as f64 / 4.0);
        assert_eq!(covered(3.5), 0.0, "behind the eye");
    }

    #[test]
    fn it_covers_its_area_and_shows_its_cell_upright() {
        let halves = [[0, 0, 0, 0], [255, 0, 0, 255]].map(|color| color.repeat(8)).concat();
        let atlas = CardAtlas::new(&Picture::new(4, 4, halves).unwrap(), 4).unwrap();
        let camera = Camera::look_at([0.0, 0.0, 4.0], [0.0; 3], [0.0, 1.0, 0.0], 0.5);
        let mesh = Mesh::default();
        let layer = card_layer(&[square(0.5, 0.0)], &atlas, &mesh, &camera, [200, 200]).unwrap();
        let sum: f32 = layer.coverage().sum();
        let side = 200.0 / (2.0 * 4.0 * 0.25f32.tan());
        assert!((sum / (0.5 * side * side) - 1.0).abs() < 0.02, "{sum}");
        let black = Picture::new(200, 200, [0, 0, 0, 255].repeat(40_000)).unwrap();
        let picture = layer.over(&black).unwrap();
        assert_eq!(picture.pixel(100, 80), [0, 0, 0, 255]);
        assert_eq!(picture.pixel(100, 120), [255, 0, 0, 255]);
    }

    #[test]
    fn the_order_of_cards_is_that_of_their_depths() {
        let colors = [[255, 0, 0, 255], [0, 255, 0, 128]].map(|color| color.repeat(2)).concat();
        let atlas = CardAtlas::new(&Picture::new(2, 2, colors.clone()).unwrap(), 1).unwrap();
        let [red, green] =
            [Card { cell: 0, ..square(9.0, 0.0) }, Card { cell: 2, ..square(9.0, 1.0) }];
        let mesh = Mesh::default();
        let both = layer(&[red, green], &atlas, &mesh);
        assert_eq!(both, layer(&[green, red], &atlas, &mesh));
        let blank = Picture::new(9, 9, vec![0; 4 * 81]).unwrap();
        // Half of linear light is 188 in sRGB.
        assert_eq!(both.over(&blank).unwrap().pixel(4, 4), [187, 188, 0, 255]);
        let green = layer(&[green], &atlas, &mesh);
        assert_eq!(green.over(&blank).unwrap().pixel(4, 4), [0, 255, 0, 128]);
    }

    #[test]
    fn odd_cards_are_left_out() {
        let atlas = plain([9; 4]);
        let odd = [f64::NAN, 1e300, 0.0].map(|x| Card { right: [x; 3], ..square(1.0, 0.0) });
        let mut cards = odd.to_vec();
        cards.push(Card { down: [0.0, 0.0, 9.0], ..square(1.0, -1.0) });
        let through_the_eye = layer(&cards, &atlas, &Mesh::default());
        assert!(through_the_eye.coverage().all(f32::is_finite));
        let lost = Card { cell: 1, ..square(1.0, 0.0) };
        let found = card_layer(&[lost], &atlas, &Mesh::default(), &from_front(3.0), [4, 4]);
        assert!(matches!(found, Err(PictureError::NoCell { cell: 1, count: 1 })));
        assert!(through_the_eye.over(&Picture::new(1, 1, vec![0; 4]).unwrap()).is_err());
    }
}
