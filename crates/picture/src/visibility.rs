//! The face visible at each pixel, for rendering and for crack tests.

use meshlod_mesh::{FaceId, Mesh};
use rayon::prelude::*;

use crate::bins::{Bins, Tiling};
use crate::camera::Lens;
use crate::culling::Culling;
use crate::error::check_size;
use crate::project::Point;
use crate::raster::{SampleRect, cover};
use crate::{Camera, PictureError};

/// Picture of visible faces: the face at the centre of each pixel, with its depth.
#[derive(Clone, Debug, PartialEq)]
pub struct Visibility {
    width: u32,
    height: u32,
    near: f64,
    samples: Vec<Sample>,
}

/// Nearest face at a sample; none if `face` is [`NO_FACE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    pub nearness: f32,
    pub face: u32,
}

/// Id that no face has.
pub(crate) const NO_FACE: u32 = u32::MAX;

/// Finds the face nearest to the camera at the centre of every pixel; of equally near ones, the
/// lowest-numbered.
///
/// `size` is width and height in pixels. Faces are seen from both sides. Faces with a common edge
/// leave no gap along it, and a boundary edge covers no pixel twice, so a pixel without a face
/// within a closed silhouette is a crack. The result does not depend on the number of threads.
///
/// Cost: O(faces + pixels covered, counting layers). Memory: 16 bytes a vertex, 8 a pixel, 4 per
/// face and 64-pixel tile that it touches.
///
/// # Errors
/// A mesh that breaks [`Mesh::validate`], or a size out of range.
pub fn visibility(
    mesh: &Mesh,
    camera: &Camera,
    size: [u32; 2],
) -> Result<Visibility, PictureError> {
    culled_visibility(mesh, camera, size, Culling::NONE)
}

/// Finds visible faces as [`visibility`] does, without those that are culled.
pub(crate) fn culled_visibility(
    mesh: &Mesh,
    camera: &Camera,
    size: [u32; 2],
    culling: Culling<'_>,
) -> Result<Visibility, PictureError> {
    let [width, height] = size;
    check_size(width.into(), height.into())?;
    mesh.validate()?;
    let lens = camera.lens(width, height);
    let tiling = Tiling { size, side: 64 };
    let copy = |window, samples: &[Sample]| (window, samples.to_vec());
    let tiles = draw_tiles(mesh, &lens, tiling, culling, copy);
    let mut samples = vec![Sample::NOTHING; width as usize * height as usize];
    for (window, tile) in tiles {
        let tile_width = (window.end[0] - window.start[0]) as usize;
        for (row, y) in tile.chunks_exact(tile_width).zip(window.start[1]..) {
            let at = y as usize * width as usize + window.start[0] as usize;
            samples[at..at + tile_width].copy_from_slice(row);
        }
    }
    Ok(Visibility { width, height, near: lens.near(), samples })
}

impl Visibility {
    /// Returns the width of the picture in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Returns the height of the picture in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Returns the face visible at each pixel, or `None` for the background, row after row from the
    /// top.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = Option<FaceId>> + '_ {
        self.samples.iter().map(|s| (s.face != NO_FACE).then_some(FaceId(s.face)))
    }

    /// Returns the depth of the visible face at each pixel, in model units along the viewing
    /// direction; `None` for the background.
    pub fn depths(&self) -> impl ExactSizeIterator<Item = Option<f64>> + '_ {
        let depth = |s: &Sample| self.near / f64::from(s.nearness);
        self.samples.iter().map(move |s| (s.face != NO_FACE).then(|| depth(s)))
    }

    /// Returns the number of pixels that show a face rather than the background.
    pub fn covered(&self) -> usize {
        self.faces().flatten().count()
    }
}

impl Sample {
    const NOTHING: Self = Self { nearness: 0.0, face: NO_FACE };
}

/// Draws all tiles and passes the rectangle and samples of each to `finish`; returns its results in
/// the order of the tiles.
pub(crate) fn draw_tiles<T: Send>(
    mesh: &Mesh,
    lens: &Lens,
    tiling: Tiling,
    culling: Culling<'_>,
    finish: impl Fn(SampleRect, &[Sample]) -> T + Sync,
) -> Vec<T> {
    let bins = Bins::new(mesh, lens, tiling, culling);
    let draw = |samples: &mut Vec<Sample>, tile| {
        let window = tiling.window(tile);
        let [width, height] = [0, 1].map(|axis| (window.end[axis] - window.start[axis]) as usize);
        samples.clear();
        samples.resize(width * height, Sample::NOTHING);
        bins.visit(tile, |face, triangle| draw(samples, &window, face, triangle));
        finish(window, samples)
    };
    (0..tiling.count()).into_par_iter().map_init(Vec::new, draw).collect()
}

fn draw(samples: &mut [Sample], window: &SampleRect, face: u32, triangle: &[Point; 3]) {
    let width = (window.end[0] - window.start[0]) as usize;
    cover(triangle, window, |x, y, nearness| {
        let at = (y - window.start[1]) as usize * width + (x - window.start[0]) as usize;
        let seen = &mut samples[at];
        if nearness > seen.nearness || (nearness == seen.nearness && face < seen.face) {
            *seen = Sample { nearness, face };
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::View;
    use crate::scenes::{ball, from_front, sheet, stack};

    #[test]
    fn the_nearer_face_is_seen() {
        let seen = visibility(&stack(&[0.0, 1.0, 0.5]), &from_front(3.0), [9, 9]).unwrap();
        assert_eq!(seen.faces().nth(40).unwrap(), Some(FaceId(1)));
        let depth = seen.depths().nth(40).unwrap().unwrap();
        assert!((depth - 2.0).abs() < 1e-6, "{depth}");
    }

    #[test]
    fn of_equal_faces_the_lower_id_is_seen() {
        let mut mesh = ball(3);
        let count = mesh.faces.len();
        // The same faces turned over and begun elsewhere.
        mesh.faces.extend_from_within(..);
        mesh.faces[count..].iter_mut().for_each(|face| *face = [face[2], face[1], face[0]]);
        let seen =
            visibility(&mesh, &Camera::fit_mesh(&mesh, &View::default()), [300, 300]).unwrap();
        assert!(seen.covered() > 1000);
        assert!(seen.faces().flatten().all(|face| face.index() < count));
    }

    #[test]
    fn a_sheet_has_no_cracks_from_any_side() {
        for [x, y] in [[0.0, 0.0], [0.9, 0.3], [-2.0, 1.7]] {
            let camera = Camera::look_at([x, y, 2.0], [0.0; 3], [0.0, 1.0, 0.0], 0.2);
            let seen = visibility(&sheet(23), &camera, [200, 200]).unwrap();
            assert_eq!(seen.covered(), 200 * 200, "the sheet fills the view from {x} {y}");
        }
    }

    #[test]
    fn flying_through_shows_what_rays_hit() {
        // Half of the ground is behind the eye, some of it too far aside for fixed point.
        let (cells, reach) = (40, 1e6);
        let mut mesh = sheet(cells);
        mesh.positions.iter_mut().for_each(|p| *p = [p[0] * reach, -0.5, p[1] * reach]);
        let camera = Camera::look_at([0.0; 3], [0.0, -0.4, -1.0], [0.0, 1.0, 0.0], 0.7);
        let camera = camera.with_near(1e-3);
        let lens = camera.lens(200, 200);
        let seen = visibility(&mesh, &camera, [200, 200]).unwrap();
        for (pixel, face) in seen.faces().enumerate() {
            let ray = lens.ray((pixel % 200) as f64 + 0.5, (pixel / 200) as f64 + 0.5);
            let hit = ray * (-0.5 / ray.y);
            let [i, j] = [hit.x, hit.z].map(|x| (x / reach + 1.0) * 0.5 * f64::from(cells));
            let face = face.expect("the ground fills the view").index();
            // Snapping to fixed point moves an edge by a part of a pixel.
            let [near_i, near_j] = [i, j].map(|x| (x - x.round()).abs() < 0.01);
            let cell = (j.floor() * f64::from(cells) + i.floor()) as usize;
            assert!(near_i || near_j || face / 2 == cell, "pixel {pixel}: {i} {j} is not f{face}");
        }
    }

    #[test]
    fn huge_and_tiny_models_are_seen_alike() {
        let count = |scale: f64| {
            let mut mesh = sheet(3);
            mesh.positions.iter_mut().flatten().for_each(|x| *x *= scale);
            visibility(&mesh, &Camera::fit_mesh(&mesh, &View::default()), [100, 100])
                .unwrap()
                .covered()
        };
        assert_eq!([1e-9, 1.0, 1e15].map(count), [count(1.0); 3]);
        assert!(count(1.0) > 1000);
    }

    #[test]
    fn endless_spans_do_not_panic() {
        let mut mesh = stack(&[0.0]);
        mesh.positions[0] = [f64::MAX, f64::MIN, f64::MAX];
        for camera in [from_front(3.0), Camera::fit_mesh(&mesh, &View::default())] {
            visibility(&mesh, &camera, [20, 20]).unwrap();
        }
    }
}
