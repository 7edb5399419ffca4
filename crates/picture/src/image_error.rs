//! The error of a level as the eye sees it: pictures from twelve sides, compared.

use std::ops::Range;

use meshlod_mesh::Mesh;

use crate::{Camera, Paint, Picture, PictureError, Style, flip, render, ssim, visibility};

/// How a level's pictures differ from those of its original.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageError {
    /// Mean [`flip`](crate::flip()) of the twelve views: 0 for no difference, 1 at most.
    pub flip: f64,
    /// Mean [`ssim`](crate::ssim()) of the twelve views: 1 for no difference.
    pub ssim: f64,
    /// ReferenceImage by view, in the order of [`Camera::icosahedron_views`].
    pub views: [ViewError; 12],
}

/// The same of one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ViewError {
    /// Mean over the pixels that show the original or the level.
    pub flip: f64,
    /// Mean over the same.
    pub ssim: f64,
    /// How many pixels those are.
    pub pixels: usize,
}

/// An original in its twelve pictures, to compare levels with.
pub struct ReferenceImages<'a> {
    style: Style<'a>,
    views: Vec<ReferenceImage>,
}

/// One picture of a portrait.
struct ReferenceImage {
    camera: Camera,
    picture: Picture,
    shown: Vec<bool>,
}

/// Compares pictures of a level with those of its original, both from twelve sides by the cameras
/// of the original, in [`Style::comparison`] with this paint, which must suit both meshes.
///
/// Cost: that of 24 pictures of 1024 by 1024 and their comparison: two to six seconds of one core.
///
/// # Errors
/// As for [`render`].
pub fn image_error(
    original: &Mesh,
    level: &Mesh,
    paint: &Paint<'_>,
) -> Result<ImageError, PictureError> {
    ReferenceImages::new(original, paint)?.error_of(level)
}

impl<'a> ReferenceImages<'a> {
    /// The twelve pictures of an original. They take 60 MB.
    ///
    /// # Errors
    /// As for [`render`].
    pub fn new(original: &Mesh, paint: &Paint<'a>) -> Result<Self, PictureError> {
        Self::with_style(original, Style { paint: paint.clone(), ..Style::comparison() })
    }

    /// The same in smaller pictures, `side` pixels wide and high: quicker, and less strict, since
    /// what is small is not seen. Name the side beside such a figure.
    ///
    /// # Errors
    /// As for [`render`].
    pub fn of_side(original: &Mesh, paint: &Paint<'a>, side: u32) -> Result<Self, PictureError> {
        let style = Style { paint: paint.clone(), size: [side; 2], ..Style::comparison() };
        Self::with_style(original, style)
    }

    fn with_style(original: &Mesh, style: Style<'a>) -> Result<Self, PictureError> {
        let view = |camera| {
            let (picture, shown) = draw(original, &camera, &style)?;
            Ok(ReferenceImage { camera, picture, shown })
        };
        let views = Camera::icosahedron_views(original).map(view);
        Ok(Self { views: views.into_iter().collect::<Result<_, PictureError>>()?, style })
    }

    /// How a level differs from the original.
    ///
    /// # Errors
    /// As for [`render`].
    pub fn error_of(&self, level: &Mesh) -> Result<ImageError, PictureError> {
        let mut views = [ViewError::default(); 12];
        for (error, view) in views.iter_mut().zip(&self.views) {
            *error = view.error_of(level, &self.style)?;
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
        let Some(window) = Crop::around(&union, width) else {
            return Ok(ViewError { flip: 0.0, ssim: 1.0, pixels: 0 });
        };
        let [reference, test] = [&self.picture, &picture].map(|picture| window.cut(picture));
        let (reference, test) = (reference?, test?);
        let inside: Vec<bool> = window.rows(width).flat_map(|row| union[row].to_vec()).collect();
        let pixels = inside.iter().filter(|&&inside| inside).count();
        let mean = |values: Vec<f32>| {
            let counted = values.iter().zip(&inside).filter(|(_, inside)| **inside);
            counted.map(|(&value, _)| f64::from(value)).sum::<f64>() / pixels as f64
        };
        let [flip, ssim] = [mean(flip(&reference, &test)?), mean(ssim(&reference, &test)?)];
        Ok(ViewError { flip, ssim, pixels })
    }
}

/// A picture of a mesh, and which pixels show it.
fn draw(
    mesh: &Mesh,
    camera: &Camera,
    style: &Style<'_>,
) -> Result<(Picture, Vec<bool>), PictureError> {
    let picture = render(mesh, camera, style)?;
    let shown = visibility(mesh, camera, style.size)?.faces().map(|face| face.is_some()).collect();
    Ok((picture, shown))
}

/// A part of a picture, in pixels.
struct Crop {
    start: [usize; 2],
    end: [usize; 2],
}

impl Crop {
    /// Around marked pixels, with a margin of background: as filters go on with the outermost
    /// pixels, all values inside are those of the whole picture. None without a mark.
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
        let window = Self {
            start: start.map(|s| s.saturating_sub(MARGIN)),
            end: [0, 1].map(|axis| (end[axis] + MARGIN).min(size[axis])),
        };
        (end != [0, 0]).then_some(window)
    }

    /// Its rows as ranges of the pixels of a picture of some width.
    fn rows(&self, width: u32) -> impl Iterator<Item = Range<usize>> {
        let [left, right] = [self.start[0], self.end[0]];
        let width = width as usize;
        (self.start[1]..self.end[1]).map(move |y| y * width + left..y * width + right)
    }

    fn cut(&self, picture: &Picture) -> Result<Picture, PictureError> {
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
            let window = Crop::around(&view.shown, 160).unwrap();
            let sides = [0, 1].map(|axis| window.end[axis] - window.start[axis] - 4);
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
        let window = Crop::around(&a.1, 160).unwrap();
        let whole = flip(&a.0, &b.0).unwrap();
        let part = flip(&window.cut(&a.0).unwrap(), &window.cut(&b.0).unwrap()).unwrap();
        let expected: Vec<f32> = window.rows(160).flat_map(|row| whole[row].to_vec()).collect();
        assert_eq!(part, expected);
        assert!(part.iter().any(|&error| error > 0.1));
    }

    #[test]
    fn nothing_to_see_is_no_error() {
        let nothing = Mesh::default();
        let error = portrait(&nothing).error_of(&nothing).unwrap();
        assert_eq!((error.flip, error.ssim), (0.0, 1.0));
    }
}
