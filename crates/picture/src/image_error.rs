//! Visual error of a level of detail: pictures from twelve sides, compared with those of the
//! original.

use std::ops::Range;

use meshlod_mesh::Mesh;

use crate::culling::Culling;
use crate::visibility::culled_visibility;
use crate::{Camera, Paint, Picture, PictureError, Style, flip, render, ssim};

/// Visual difference between a level of detail and its original, measured on pictures from twelve
/// sides.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageError {
    /// Mean FLIP error over the twelve views, from 0 (equal) to 1; see [`flip`](crate::flip()).
    pub flip: f64,
    /// Mean structural similarity over the twelve views, 1 if equal; see [`ssim`](crate::ssim()).
    pub ssim: f64,
    /// Errors of each view, in the order of [`Camera::icosahedron_views`].
    pub views: [ViewError; 12],
}

/// Visual difference between a level of detail and its original, seen from one side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewError {
    /// Mean FLIP error over the pixels that show the original or the level, from 0 (equal) to 1.
    pub flip: f64,
    /// Mean structural similarity (SSIM) over the pixels that show the original or the level; 1 if
    /// equal.
    pub ssim: f64,
    /// Number of pixels that show the original or the level.
    pub pixels: usize,
}

/// Pictures of an original mesh from twelve sides, to compare its levels of detail with.
pub struct ReferenceImages<'a> {
    style: Style<'a>,
    views: Vec<ReferenceImage>,
}

/// Picture of the original from one side, and the pixels that show it.
struct ReferenceImage {
    camera: Camera,
    picture: Picture,
    shown: Vec<bool>,
}

/// Compares pictures of a level of detail with those of its original, from twelve sides.
///
/// The cameras are those of the original, the style is [`Style::comparison`] with this paint, which
/// must suit both meshes.
///
/// Cost: 24 pictures of 1024 by 1024 and their comparison, two to six seconds of one core.
///
/// # Errors
/// Errors of [`render`].
pub fn image_error(
    original: &Mesh,
    level: &Mesh,
    paint: &Paint<'_>,
) -> Result<ImageError, PictureError> {
    ReferenceImages::new(original, paint)?.error_of(level)
}

impl<'a> ReferenceImages<'a> {
    /// Draws the pictures of an original mesh from twelve sides; they take 60 MB.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn new(original: &Mesh, paint: &Paint<'a>) -> Result<Self, PictureError> {
        Self::with_style(original, Style { paint: paint.clone(), ..Style::comparison() })
    }

    /// Draws the pictures of an original mesh from twelve sides, `side` pixels wide and high.
    ///
    /// With smaller pictures, comparison is faster but less strict, as small differences are not
    /// visible; state the side along with such a figure.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn of_side(original: &Mesh, paint: &Paint<'a>, side: u32) -> Result<Self, PictureError> {
        let style = Style { paint: paint.clone(), size: [side; 2], ..Style::comparison() };
        Self::with_style(original, style)
    }

    /// Draws the pictures of an original mesh from twelve sides, in a style of their own; it must
    /// suit the levels too. Figures are comparable only if the style is [`Style::comparison`],
    /// except for its paint and its [single-sided](Style::single_sided) materials.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn with_style(original: &Mesh, style: Style<'a>) -> Result<Self, PictureError> {
        Self::seen_by(original, Camera::icosahedron_views(original), style)
    }

    /// Draws pictures of an original mesh as twelve cameras see it, in a style of their own; it must
    /// suit the levels too.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn seen_by(
        original: &Mesh,
        cameras: [Camera; 12],
        style: Style<'a>,
    ) -> Result<Self, PictureError> {
        let view = |camera| {
            let (picture, shown) = draw(original, &camera, &style)?;
            Ok(ReferenceImage { camera, picture, shown })
        };
        let views = cameras.map(view);
        Ok(Self { views: views.into_iter().collect::<Result<_, PictureError>>()?, style })
    }

    /// Compares pictures of a level of detail with those of the original, from twelve sides.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn error_of(&self, level: &Mesh) -> Result<ImageError, PictureError> {
        self.error_with(level, &self.style.paint)
    }

    /// Compares pictures of a level of detail that has a paint of its own, such as smaller textures.
    ///
    /// # Errors
    /// Errors of [`render`].
    pub fn error_with(&self, level: &Mesh, paint: &Paint<'_>) -> Result<ImageError, PictureError> {
        let style = Style { paint: paint.clone(), ..self.style.clone() };
        let mut views = [ViewError::default(); 12];
        for (error, view) in views.iter_mut().zip(&self.views) {
            *error = view.error_of(level, &style)?;
        }
        let mean = |of: fn(&ViewError) -> f64| views.iter().map(of).sum::<f64>() / 12.0;
        Ok(ImageError { flip: mean(|view| view.flip), ssim: mean(|view| view.ssim), views })
    }
}

impl ReferenceImage {
    fn error_of(&self, level: &Mesh, style: &Style<'_>) -> Result<ViewError, PictureError> {
        let (picture, shown) = draw(level, &self.camera, style)?;
        let union: Vec<bool> = self.shown.iter().zip(&shown).map(|(&a, &b)| a || b).collect();
        let width = picture.width();
        let Some(crop) = Crop::around(&union, width) else {
            return Ok(ViewError { flip: 0.0, ssim: 1.0, pixels: 0 });
        };
        let [reference, test] = [&self.picture, &picture].map(|picture| crop.apply(picture));
        let (reference, test) = (reference?, test?);
        let inside: Vec<bool> = crop.rows(width).flat_map(|row| union[row].to_vec()).collect();
        let pixels = inside.iter().filter(|&&inside| inside).count();
        let mean = |values: Vec<f32>| {
            let counted = values.iter().zip(&inside).filter(|(_, inside)| **inside);
            counted.map(|(&value, _)| f64::from(value)).sum::<f64>() / pixels as f64
        };
        let [flip, ssim] = [mean(flip(&reference, &test)?), mean(ssim(&reference, &test)?)];
        Ok(ViewError { flip, ssim, pixels })
    }
}

/// Draws a mesh and marks the pixels that show it.
fn draw(
    mesh: &Mesh,
    camera: &Camera,
    style: &Style<'_>,
) -> Result<(Picture, Vec<bool>), PictureError> {
    let picture = render(mesh, camera, style)?;
    let seen = culled_visibility(mesh, camera, style.size, Culling::of_style(mesh, style))?;
    Ok((picture, seen.faces().map(|face| face.is_some()).collect()))
}

/// Rectangle of pixels in a picture.
struct Crop {
    start: [usize; 2],
    end: [usize; 2],
}

impl Crop {
    /// Returns the rectangle around the marked pixels, or `None` if no pixel is marked. A margin of
    /// background makes filters, which repeat the outermost pixels, give the values of the whole
    /// picture.
    fn around(marks: &[bool], width: u32) -> Option<Self> {
        const MARGIN: usize = 2;
        let width = width as usize;
        let size = [width, marks.len() / width];
        let (mut start, mut end) = (size, [0, 0]);
        for (i, _) in marks.iter().enumerate().filter(|(_, marked)| **marked) {
            let at = [i % width, i / width];
            start = [0, 1].map(|axis| start[axis].min(at[axis]));
            end = [0, 1].map(|axis| end[axis].max(at[axis] + 1));
        }
        let crop = Self {
            start: start.map(|s| s.saturating_sub(MARGIN)),
            end: [0, 1].map(|axis| (end[axis] + MARGIN).min(size[axis])),
        };
        (end != [0, 0]).then_some(crop)
    }

    /// Returns its rows as ranges of pixel indices in a picture of the given width.
    fn rows(&self, width: u32) -> impl Iterator<Item = Range<usize>> {
        let [left, right] = [self.start[0], self.end[0]];
        let width = width as usize;
        (self.start[1]..self.end[1]).map(move |y| y * width + left..y * width + right)
    }

    fn apply(&self, picture: &Picture) -> Result<Picture, PictureError> {
        let [width, height] = [0, 1].map(|axis| (self.end[axis] - self.start[axis]) as u32);
        let rows = self.rows(picture.width());
        let rgba = rows.flat_map(|row| &picture.rgba()[4 * row.start..4 * row.end]);
        Picture::new(width, height, rgba.copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{ball, sheet_with_uv};
    use crate::{Antialiasing, Background};

    fn portrait(mesh: &Mesh) -> ReferenceImages<'static> {
        ReferenceImages::with_style(mesh, Style { size: [160, 160], ..Style::comparison() })
            .unwrap()
    }

    #[test]
    fn an_original_has_no_error() {
        let ball = ball(3);
        let error = portrait(&ball).error_of(&ball).unwrap();
        assert_eq!(error.flip, 0.0);
        assert!((error.ssim - 1.0).abs() < 1e-4 && error.views.iter().all(|v| v.pixels > 9_000));
    }

    #[test]
    fn coarser_levels_err_more() {
        let portrait = portrait(&ball(4));
        let [fine, coarse, coarsest] = [3, 2, 1].map(|n| portrait.error_of(&ball(n)).unwrap());
        assert!(fine.flip > 0.0 && 1.5 * fine.flip < coarse.flip, "{fine:?} {coarse:?}");
        assert!(1.5 * coarse.flip < coarsest.flip, "{coarse:?} {coarsest:?}");
        assert!(fine.ssim > coarse.ssim && coarse.ssim > coarsest.ssim);
    }

    #[test]
    fn a_texture_out_of_place_is_an_error() {
        let original = sheet_with_uv(8);
        let mut moved = original.clone();
        moved.attributes.as_mut().unwrap().layers[0].values.iter_mut().for_each(|uv| *uv += 0.03);
        let style =
            Style { size: [160, 160], paint: Paint::Checker { squares: 4 }, ..Style::comparison() };
        let portrait = ReferenceImages::with_style(&original, style).unwrap();
        assert!(portrait.error_of(&moved).unwrap().flip > 0.02);
    }

    #[test]
    fn the_object_fills_the_frame_and_its_surroundings_do_not_count() {
        for view in portrait(&ball(4)).views {
            let crop = Crop::around(&view.shown, 160).unwrap();
            let sides = [0, 1].map(|axis| crop.end[axis] - crop.start[axis] - 4);
            assert!(sides.iter().all(|side| (126..=128).contains(side)), "{sides:?}");
            let disc = std::f64::consts::PI * 64.0 * 64.0;
            let shown = view.shown.iter().filter(|&&shown| shown).count() as f64;
            assert!((shown / disc - 1.0).abs() < 0.03, "{shown} of {disc}");
        }
    }

    #[test]
    fn both_silhouettes_count() {
        let ball = ball(3);
        let mut half = ball.clone();
        half.positions.iter_mut().flatten().for_each(|x| *x *= 0.5);
        let portrait = portrait(&ball);
        let with = portrait.error_of(&ball).unwrap().views[0].pixels;
        assert_eq!(portrait.error_of(&half).unwrap().views[0].pixels, with);
        half.positions.iter_mut().flatten().for_each(|x| *x *= 2.2);
        assert!(portrait.error_of(&half).unwrap().views[0].pixels > with * 115 / 100);
    }

    #[test]
    fn a_window_leaves_values_as_they_are() {
        let mesh = ball(2);
        let style =
            Style { size: [160, 160], antialiasing: Antialiasing::Four, ..Style::comparison() };
        assert!(matches!(style.background, Background::Plain(_)));
        let camera = Camera::icosahedron_views(&mesh)[3];
        let [a, b] = [&mesh, &ball(1)].map(|mesh| draw(mesh, &camera, &style).unwrap());
        let crop = Crop::around(&a.1, 160).unwrap();
        let whole = flip(&a.0, &b.0).unwrap();
        let part = flip(&crop.apply(&a.0).unwrap(), &crop.apply(&b.0).unwrap()).unwrap();
        let expected: Vec<f32> = crop.rows(160).flat_map(|row| whole[row].to_vec()).collect();
        assert_eq!(part, expected);
        assert!(part.iter().any(|&error| error > 0.1));
    }

    #[test]
    fn another_paint_is_an_error() {
        let sheet = sheet_with_uv(8);
        let style =
            Style { size: [160, 160], paint: Paint::Checker { squares: 4 }, ..Style::comparison() };
        let portrait = ReferenceImages::with_style(&sheet, style).unwrap();
        let error = |squares| portrait.error_with(&sheet, &Paint::Checker { squares }).unwrap();
        assert_eq!(error(4).flip, 0.0);
        assert!(error(16).flip > 0.02);
    }

    #[test]
    fn nothing_to_see_is_no_error() {
        let nothing = Mesh::default();
        let error = portrait(&nothing).error_of(&nothing).unwrap();
        assert_eq!((error.flip, error.ssim), (0.0, 1.0));
    }
}
