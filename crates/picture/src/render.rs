//! Meshes to pictures.

use glam::Vec3;
use meshlod_mesh::Mesh;

use crate::albedo::Albedo;
use crate::bins::Tiling;
use crate::camera::Lens;
use crate::error::check_size;
use crate::facet::Facet;
use crate::light::Lights;
use crate::normals::CornerNormals;
use crate::raster::SampleRect;
use crate::srgb::{decode, encode};
use crate::visibility::{NO_FACE, Sample, draw_tiles};
use crate::{BackFaces, Background, Camera, Picture, PictureError, Style};

/// Draws a mesh.
///
/// First the nearest face of every sample is found, tile by tile, as [`visibility`] does it; then
/// every pixel is shaded once per face that it sees, at the middle of what it sees of it, and the
/// shades are averaged in linear light [BH13]. The same pixels for any number of threads and on
/// any machine.
///
/// Cost: O(faces + samples covered, counting layers + pixels). Memory beside the picture: 16 bytes
/// a vertex, 4 a face, and for smooth normals 12 a vertex (creased: 12 a face and 4 a vertex).
///
/// # Errors
/// A mesh that breaks [`Mesh::validate`], an impossible size, or a paint that does not go with the
/// mesh.
///
/// [`visibility`]: crate::visibility()
pub fn render(mesh: &Mesh, camera: &Camera, style: &Style) -> Result<Picture, PictureError> {
    let [width, height] = style.size;
    check_size(width.into(), height.into())?;
    mesh.validate()?;
    let scene = Scene::new(mesh, camera, style)?;
    let across = style.antialiasing.across();
    let samples = style.size.map(|side| side * across);
    // In samples a tile is about 64 to 128 wide: its 8 bytes a sample stay in the second cache.
    let tiling = Tiling { size: samples, side: across * if across == 1 { 64 } else { 32 } };
    let lens = camera.lens(samples[0], samples[1]);
    let tiles = draw_tiles(mesh, &lens, tiling, |window, samples| {
        let grid = Grid { samples, window, across: across as usize };
        (grid.pixels(), scene.shade(&grid))
    });
    let mut rgba = vec![0; 4 * width as usize * height as usize];
    for (pixels, tile) in tiles {
        let row_bytes = 4 * (pixels.end[0] - pixels.start[0]) as usize;
        for (row, y) in tile.chunks_exact(row_bytes).zip(pixels.start[1]..) {
            let at = 4 * (y as usize * width as usize + pixels.start[0] as usize);
            rgba[at..at + row_bytes].copy_from_slice(row);
        }
    }
    Picture::new(width, height, rgba)
}

/// All that shading a pixel needs.
struct Scene<'a> {
    mesh: &'a Mesh,
    style: &'a Style<'a>,
    /// Over pixels, not samples.
    lens: Lens,
    lights: Lights,
    normals: CornerNormals<'a>,
    pigment: Albedo<'a>,
}

/// The samples of a tile.
struct Grid<'a> {
    samples: &'a [Sample],
    window: SampleRect,
    /// Samples along a pixel's side.
    across: usize,
}

/// What a pixel sees of one face.
#[derive(Clone, Copy, Default)]
struct Glimpse {
    face: u32,
    samples: u32,
    /// Sum of the places of its samples, counted in samples from the tile's corner.
    sum: [u32; 2],
}

/// Samples in a pixel at most.
const MOST_SAMPLES: usize = 16;

/// Faces kept at hand while a tile is shaded; neighbouring pixels mostly share theirs.
const FACETS_AT_HAND: usize = 128;

impl<'a> Scene<'a> {
    fn new(mesh: &'a Mesh, camera: &Camera, style: &'a Style) -> Result<Self, PictureError> {
        let lens = camera.lens(style.size[0], style.size[1]);
        let lights = Lights::new(style.lighting, lens.axes());
        let pigment = Albedo::new(mesh, &style.paint)?;
        let normals = CornerNormals::new(mesh, style.normals);
        Ok(Self { mesh, style, lens, lights, normals, pigment })
    }

    /// The pixels of a tile, four bytes each.
    fn shade(&self, grid: &Grid) -> Vec<u8> {
        let pixels = grid.pixels();
        let mut facets = vec![None; FACETS_AT_HAND];
        let mut rgba = Vec::new();
        for (row, y) in (pixels.start[1]..pixels.end[1]).enumerate() {
            let background = self.background(y);
            for column in 0..(pixels.end[0] - pixels.start[0]) as usize {
                let mut glimpses = [Glimpse::default(); MOST_SAMPLES];
                let count = grid.glimpses(column, row, &mut glimpses);
                let shade = |glimpse: &Glimpse| self.shade_glimpse(glimpse, grid, &mut facets);
                rgba.extend(mix(&glimpses[..count], shade, background, grid.across));
            }
        }
        rgba
    }

    /// Linear light of the background in a row of pixels; none where it is transparent.
    fn background(&self, y: i32) -> Option<Vec3> {
        match self.style.background {
            Background::Transparent => None,
            Background::Plain(color) => Some(decode(color)),
            Background::Gradient { top, bottom } => {
                let t = (y as f32 + 0.5) / self.style.size[1] as f32;
                // Even steps of sRGB look like even steps.
                let [top, bottom] = [top, bottom].map(|color| Vec3::from(color.map(f32::from)));
                let between = top.lerp(bottom, t) / 255.0;
                Some(Vec3::from(between.to_array().map(crate::srgb::decode_unit)))
            }
        }
    }

    /// Linear light of what a pixel sees of a face.
    fn shade_glimpse(&self, glimpse: &Glimpse, grid: &Grid, facets: &mut [Option<Facet>]) -> Vec3 {
        let facet = self.facet(glimpse.face as usize, facets);
        let [x, y] = grid.middle(glimpse);
        let fragment = facet.at(&self.lens, x, y);
        let color = match self.style.back_faces {
            BackFaces::Tint(tint) if facet.from_behind => decode(tint),
            _ => self.pigment.color(self.mesh, &fragment),
        };
        let to_eye = -self.lens.ray(x, y).as_vec3().normalize_or_zero();
        let lit = self.lights.on(color, facet.normal(&fragment), to_eye);
        let Some(wireframe) = &self.style.wireframe else { return lit };
        let line = fragment.line(wireframe.width_px) * wireframe.opacity;
        lit.min(Vec3::ONE).lerp(decode(wireframe.color), line.clamp(0.0, 1.0))
    }

    fn facet(&self, face: usize, facets: &mut [Option<Facet>]) -> Facet {
        let slot = &mut facets[face % FACETS_AT_HAND];
        match slot {
            Some(facet) if facet.face == face => *facet,
            _ => *slot.insert(Facet::new(self.mesh, face, self.lens.eye(), &self.normals)),
        }
    }
}

impl Grid<'_> {
    /// The tile in pixels.
    fn pixels(&self) -> SampleRect {
        let across = self.across as i32;
        SampleRect {
            start: self.window.start.map(|s| s / across),
            end: self.window.end.map(|s| s / across),
        }
    }

    /// The faces that a pixel of the tile sees, in the order of their first samples.
    fn glimpses(&self, column: usize, row: usize, found: &mut [Glimpse; MOST_SAMPLES]) -> usize {
        let tile_width = (self.window.end[0] - self.window.start[0]) as usize;
        let mut count = 0;
        for y in row * self.across..(row + 1) * self.across {
            for x in column * self.across..(column + 1) * self.across {
                let face = self.samples[y * tile_width + x].face;
                if face == NO_FACE {
                    continue;
                }
                let known = found[..count].iter().position(|glimpse| glimpse.face == face);
                let at = known.unwrap_or(count);
                count = count.max(at + 1);
                found[at].face = face;
                found[at].samples += 1;
                found[at].sum[0] += x as u32;
                found[at].sum[1] += y as u32;
            }
        }
        count
    }

    /// The middle of a glimpse's samples, which lies on the face, in pixels of the picture.
    fn middle(&self, glimpse: &Glimpse) -> [f64; 2] {
        [0, 1].map(|axis| {
            let mean = f64::from(glimpse.sum[axis]) / f64::from(glimpse.samples);
            (f64::from(self.window.start[axis]) + mean + 0.5) / self.across as f64
        })
    }
}

/// The mean of a pixel's glimpses and what they leave of the background.
fn mix(
    glimpses: &[Glimpse],
    mut shade: impl FnMut(&Glimpse) -> Vec3,
    background: Option<Vec3>,
    across: usize,
) -> [u8; 4] {
    let (mut sum, mut covered) = (Vec3::ZERO, 0);
    for glimpse in glimpses {
        // Clamped one by one, or a glossy spot would outshine the edge that smooths it.
        sum += shade(glimpse).clamp(Vec3::ZERO, Vec3::ONE) * glimpse.samples as f32;
        covered += glimpse.samples;
    }
    let all = (across * across) as u32;
    let (mean, alpha) = match background {
        Some(behind) => ((sum + behind * (all - covered) as f32) / all as f32, 255),
        None if covered == 0 => (Vec3::ZERO, 0),
        None => (sum / covered as f32, ((covered * 510 + all) / (2 * all)) as u8),
    };
    let [r, g, b] = mean.to_array().map(encode);
    [r, g, b, alpha]
}

#[cfg(test)]
mod tests;
