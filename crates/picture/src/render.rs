//! Rendering of a mesh as a picture.

use glam::Vec3;
use meshlod_mesh::Mesh;

use crate::albedo::Albedo;
use crate::bins::Tiling;
use crate::camera::Lens;
use crate::culling::Culling;
use crate::error::check_size;
use crate::facet::Facet;
use crate::light::Lights;
use crate::normals::CornerNormals;
use crate::raster::SampleRect;
use crate::srgb::{decode, encode};
use crate::visibility::{NO_FACE, Sample, draw_tiles};
use crate::{BackFaces, Background, Camera, Picture, PictureError, Style};

/// Renders a mesh as a picture, seen by a camera, in a style.
///
/// First, the nearest face of every sample is found tile by tile, as in [`visibility`]. Then every
/// pixel is shaded once per face that it sees, at the mean position of that face's samples, and the
/// shades are averaged in linear light [BH13]. Pixels do not depend on the number of threads or on
/// the machine.
///
/// Cost: O(faces + samples covered, counting layers + pixels). Memory beside the picture: 16 bytes
/// a vertex, 4 a face, and for smooth normals 12 a vertex (creased: 12 a face and 4 a vertex).
///
/// # Errors
/// A mesh that breaks [`Mesh::validate`], a size out of range, or a paint that does not match the
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
    // A tile is 64 to 128 samples wide: at 8 bytes a sample, it stays in the L2 cache.
    let tiling = Tiling { size: samples, side: across * if across == 1 { 64 } else { 32 } };
    let lens = camera.lens(samples[0], samples[1]);
    let culling = Culling::of_style(mesh, style);
    let tiles = draw_tiles(mesh, &lens, tiling, culling, |window, samples| {
        let grid = TileSamples { samples, window, across: across as usize };
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

/// Everything needed to shade a pixel.
struct Scene<'a> {
    mesh: &'a Mesh,
    style: &'a Style<'a>,
    /// Camera mapped to pixels, not samples.
    lens: Lens,
    lights: Lights,
    normals: CornerNormals<'a>,
    albedo: Albedo<'a>,
}

/// Samples of a tile.
struct TileSamples<'a> {
    samples: &'a [Sample],
    window: SampleRect,
    /// Samples per pixel side.
    across: usize,
}

/// Visible part of a face in a pixel.
#[derive(Clone, Copy, Default)]
struct VisiblePart {
    face: u32,
    samples: u32,
    /// Sum of the positions of its samples, relative to the tile's corner.
    sum: [u32; 2],
}

/// Maximum number of samples per pixel.
const MAX_SAMPLES: usize = 16;

/// Number of faces cached while a tile is shaded; neighbouring pixels mostly share theirs.
const FACET_CACHE: usize = 128;

impl<'a> Scene<'a> {
    fn new(mesh: &'a Mesh, camera: &Camera, style: &'a Style) -> Result<Self, PictureError> {
        let lens = camera.lens(style.size[0], style.size[1]);
        let lights = Lights::new(style.lighting, lens.axes());
        let albedo = Albedo::new(mesh, &style.paint)?;
        let normals = CornerNormals::new(mesh, style.normals);
        Ok(Self { mesh, style, lens, lights, normals, albedo })
    }

    /// Shades the pixels of a tile, four bytes each.
    fn shade(&self, grid: &TileSamples) -> Vec<u8> {
        let pixels = grid.pixels();
        let mut facets = vec![None; FACET_CACHE];
        let mut rgba = Vec::new();
        for (row, y) in (pixels.start[1]..pixels.end[1]).enumerate() {
            let background = self.background(y);
            for column in 0..(pixels.end[0] - pixels.start[0]) as usize {
                let mut parts = [VisiblePart::default(); MAX_SAMPLES];
                let count = grid.parts(column, row, &mut parts);
                let shade = |part: &VisiblePart| self.shade_part(part, grid, &mut facets);
                rgba.extend(mix(&parts[..count], shade, background, grid.across));
            }
        }
        rgba
    }

    /// Returns the linear colour of the background in a row of pixels; `None` if transparent.
    fn background(&self, y: i32) -> Option<Vec3> {
        match self.style.background {
            Background::Transparent => None,
            Background::Plain(color) => Some(decode(color)),
            Background::Gradient { top, bottom } => {
                let t = (y as f32 + 0.5) / self.style.size[1] as f32;
                // Interpolated in sRGB, where even steps look even.
                let [top, bottom] = [top, bottom].map(|color| Vec3::from(color.map(f32::from)));
                let between = top.lerp(bottom, t) / 255.0;
                Some(Vec3::from(between.to_array().map(crate::srgb::decode_unit)))
            }
        }
    }

    /// Shades the part of a face that is visible in a pixel.
    fn shade_part(
        &self,
        part: &VisiblePart,
        grid: &TileSamples,
        facets: &mut [Option<Facet>],
    ) -> Vec3 {
        let facet = self.facet(part.face as usize, facets);
        let [x, y] = grid.middle(part);
        let fragment = facet.at(&self.lens, x, y);
        let color = match self.style.back_faces {
            BackFaces::Tint(tint) if facet.from_behind => decode(tint),
            _ => self.albedo.color(self.mesh, &fragment),
        };
        let to_eye = -self.lens.ray(x, y).as_vec3().normalize_or_zero();
        let lit = self.lights.on(color, facet.normal(&fragment), to_eye);
        let Some(wireframe) = &self.style.wireframe else { return lit };
        let line = fragment.line(wireframe.width_px) * wireframe.opacity;
        lit.min(Vec3::ONE).lerp(decode(wireframe.color), line.clamp(0.0, 1.0))
    }

    fn facet(&self, face: usize, facets: &mut [Option<Facet>]) -> Facet {
        let slot = &mut facets[face % FACET_CACHE];
        match slot {
            Some(facet) if facet.face == face => *facet,
            _ => *slot.insert(Facet::new(self.mesh, face, self.lens.eye(), &self.normals)),
        }
    }
}

impl TileSamples<'_> {
    /// Returns the rectangle of pixels that the tile covers.
    fn pixels(&self) -> SampleRect {
        let across = self.across as i32;
        SampleRect {
            start: self.window.start.map(|s| s / across),
            end: self.window.end.map(|s| s / across),
        }
    }

    /// Collects the faces that a pixel of the tile sees, in the order of their first samples.
    fn parts(&self, column: usize, row: usize, found: &mut [VisiblePart; MAX_SAMPLES]) -> usize {
        let tile_width = (self.window.end[0] - self.window.start[0]) as usize;
        let mut count = 0;
        for y in row * self.across..(row + 1) * self.across {
            for x in column * self.across..(column + 1) * self.across {
                let face = self.samples[y * tile_width + x].face;
                if face == NO_FACE {
                    continue;
                }
                let known = found[..count].iter().position(|part| part.face == face);
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

    /// Returns the mean position of a fragment's samples, in pixels of the picture.
    fn middle(&self, part: &VisiblePart) -> [f64; 2] {
        [0, 1].map(|axis| {
            let mean = f64::from(part.sum[axis]) / f64::from(part.samples);
            (f64::from(self.window.start[axis]) + mean + 0.5) / self.across as f64
        })
    }
}

/// Averages the visible parts of faces in a pixel with the uncovered background.
fn mix(
    parts: &[VisiblePart],
    mut shade: impl FnMut(&VisiblePart) -> Vec3,
    background: Option<Vec3>,
    across: usize,
) -> [u8; 4] {
    let (mut sum, mut covered) = (Vec3::ZERO, 0);
    for part in parts {
        // Clamped one by one, or a glossy spot would outshine the antialiasing of its edge.
        sum += shade(part).clamp(Vec3::ZERO, Vec3::ONE) * part.samples as f32;
        covered += part.samples;
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
