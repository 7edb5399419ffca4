//! Spots where a level lets through what its original hides: the background through a crack, an
//! inner part through an outer one.

use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::error::check_length;
use crate::{Camera, PictureError, visibility};

/// A mesh whose faces are told apart: by component, object or what else is seen as a whole.
#[derive(Clone, Copy, Debug)]
pub struct LabelledMesh<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// The part that each face belongs to.
    pub label_of_face: &'a [u32],
}

/// How breaches are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeeThroughOptions {
    /// Width and height of a view, in pixels.
    pub side: u32,
    /// What the original shows within so many pixels of a spot may be seen at the spot.
    pub radius: u32,
    /// Outlines may move by so many pixels.
    pub outline: u32,
}

impl Default for SeeThroughOptions {
    fn default() -> Self {
        Self { side: 1024, radius: 4, outline: 32 }
    }
}

/// How much of a level is breached.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeeThroughCounts {
    /// Pixels that show the original.
    pub shown: usize,
    /// Those of them where the level lets the background through.
    pub background: usize,
    /// Those of them where the level lets a hidden part through.
    pub hidden: usize,
}

/// What a level shows at a pixel that its original hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeeThrough {
    /// Nothing at all.
    Background,
    /// This part.
    Hidden(u32),
}

/// An original from 24 sides.
///
/// A pixel is a breach where the level lets a part or the background through that the original does
/// not show nearby ([`SeeThroughOptions::radius`]). Outlines shift in any level: what the original has
/// right beyond the nearest border of what it shows at the pixel, no farther than
/// [`SeeThroughOptions::outline`], is no breach, if that border is an outline: before the background, or
/// with a leap in depth. So these are breaches: a gap between parts that touched, a hole within a
/// part, an inner part that comes through an outer one, a line where parts cross that wanders. A fin
/// that gets shorter is none, be it before the background or before the body.
///
/// Memory: 8 bytes a pixel: 200 MB by the default.
pub struct ReferenceVisibility {
    frame: Frame,
    views: Vec<ReferenceView>,
}

/// How pixels lie in a view, and which are near.
struct Frame {
    side: usize,
    /// Pixels beside each side of a view that show nothing, so that no step leads out of it.
    margin: usize,
    /// Steps to the pixels around a pixel, nearest first.
    steps: Vec<isize>,
    /// How many of them are within the radius.
    within: usize,
}

/// What each pixel shows, with the margin.
struct ReferenceView {
    camera: Camera,
    seen: Vec<VisibleLabel>,
    /// Neighbouring pixels whose depths differ by more than this part of them are before and behind.
    leap: f32,
}

/// A part and its depth.
#[derive(Clone, Copy)]
struct VisibleLabel {
    part: u32,
    depth: f32,
}

/// Depths that differ by more than so many widths of a pixel from one pixel to the next are a leap:
/// that is the slope of a surface seen at 7 degrees.
const LEAP_PX: f32 = 8.0;

/// No part.
const BACKGROUND: u32 = u32::MAX;
/// What the margin shows.
const OUTSIDE: u32 = u32::MAX - 1;

impl ReferenceVisibility {
    /// Looks at the original from the corners of two icosahedra, by [`Camera::icosahedron_views`]
    /// and [`Camera::other_icosahedron_views`].
    ///
    /// # Errors
    /// As for [`visibility()`], and labels for another number of faces.
    pub fn new(
        original: LabelledMesh<'_>,
        options: SeeThroughOptions,
    ) -> Result<Self, PictureError> {
        let first = Camera::icosahedron_views(original.mesh);
        let cameras = first.into_iter().chain(Camera::other_icosahedron_views(original.mesh));
        let frame = Frame::new(options);
        let view = |camera| {
            let mut padded = vec![VisibleLabel { part: OUTSIDE, depth: 0.0 }; frame.pixels()];
            for (at, seen) in look(original, &camera, options.side)?.into_iter().enumerate() {
                padded[frame.padded(at)] = seen;
            }
            let leap = LEAP_PX * camera.pixel_width(options.side) as f32;
            Ok(ReferenceView { camera, seen: padded, leap })
        };
        let views = cameras.map(view).collect::<Result<_, PictureError>>()?;
        Ok(Self { frame, views })
    }

    /// How often a level shows what the original hides, over all views.
    ///
    /// # Errors
    /// As for [`ReferenceVisibility::new`].
    pub fn breaches(&self, level: LabelledMesh<'_>) -> Result<SeeThroughCounts, PictureError> {
        let mut sum = SeeThroughCounts::default();
        for (view, original) in self.views.iter().enumerate() {
            sum.shown += original.seen.iter().filter(|seen| seen.part < OUTSIDE).count();
            for breach in self.breaches_in(view, level)?.into_iter().flatten() {
                match breach {
                    SeeThrough::Background => sum.background += 1,
                    SeeThrough::Hidden(_) => sum.hidden += 1,
                }
            }
        }
        Ok(sum)
    }

    /// The same of one view, pixel by pixel, row after row from the top.
    ///
    /// # Errors
    /// As for [`ReferenceVisibility::new`].
    pub fn breaches_in(
        &self,
        view: usize,
        level: LabelledMesh<'_>,
    ) -> Result<Vec<Option<SeeThrough>>, PictureError> {
        let view = &self.views[view];
        let level = look(level, &view.camera, self.frame.side as u32)?;
        let of = |at: usize| self.frame.breach(view, self.frame.padded(at), level[at].part);
        Ok((0..level.len()).into_par_iter().map(of).collect())
    }

    /// Where the views are taken from.
    pub fn cameras(&self) -> impl ExactSizeIterator<Item = Camera> + '_ {
        self.views.iter().map(|view| view.camera)
    }
}

impl Frame {
    fn new(SeeThroughOptions { side, radius, outline }: SeeThroughOptions) -> Self {
        let square = |[right, down]: [isize; 2]| right * right + down * down;
        let [radius, reach] = [radius, outline.max(radius)].map(|r| r as isize);
        let margin = reach as usize;
        let row = (side as usize + 2 * margin) as isize;
        let all = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
        let mut steps: Vec<_> = all.filter(|&step| square(step) <= reach * reach).collect();
        steps.sort_by_key(|&step| square(step));
        let within = steps.partition_point(|&step| square(step) <= radius * radius);
        let steps = steps.into_iter().map(|[right, down]| down * row + right).collect();
        Self { side: side as usize, margin, steps, within }
    }

    fn pixels(&self) -> usize {
        (self.side + 2 * self.margin).pow(2)
    }

    /// Where a pixel of the picture is in a view with its margin.
    fn padded(&self, at: usize) -> usize {
        let [x, y] = [at % self.side, at / self.side].map(|i| i + self.margin);
        y * (self.side + 2 * self.margin) + x
    }

    /// What is wrong where the level shows `shown`.
    fn breach(
        &self,
        ReferenceView { seen, leap, .. }: &ReferenceView,
        at: usize,
        shown: u32,
    ) -> Option<SeeThrough> {
        let part = seen[at].part;
        if part == shown || part == BACKGROUND {
            return None;
        }
        let mut around = self.steps.iter().map(|&step| at.wrapping_add_signed(step));
        if around.clone().take(self.within).any(|near| seen[near].part == shown) {
            return None;
        }
        let beyond = around.find(|&near| seen[near].part != part && seen[near].part != OUTSIDE);
        if let Some(beyond) = beyond
            && seen[beyond].part == shown
            && (shown == BACKGROUND || self.is_behind(seen, beyond, part, *leap))
        {
            return None;
        }
        match shown {
            BACKGROUND => Some(SeeThrough::Background),
            shown => Some(SeeThrough::Hidden(shown)),
        }
    }

    /// Whether a pixel is well behind those beside it that show a part.
    fn is_behind(&self, seen: &[VisibleLabel], at: usize, part: u32, leap: f32) -> bool {
        let row = (self.side + 2 * self.margin) as isize;
        let sides = [-row - 1, -row, 1 - row, -1, 1, row - 1, row, row + 1];
        let beside = sides.map(|step| seen[at.wrapping_add_signed(step)]);
        let mut before = beside.into_iter().filter(|beside| beside.part == part);
        before.all(|before| seen[at].depth - before.depth > leap * before.depth)
    }
}

/// What each pixel's middle sees.
fn look(
    of: LabelledMesh<'_>,
    camera: &Camera,
    side: u32,
) -> Result<Vec<VisibleLabel>, PictureError> {
    check_length("parts of faces", of.label_of_face.len(), of.mesh.faces.len())?;
    let seen = visibility(of.mesh, camera, [side; 2])?;
    let seen = seen.faces().zip(seen.depths()).map(|(face, depth)| VisibleLabel {
        part: face.map_or(BACKGROUND, |face| of.label_of_face[face.index()]),
        depth: depth.unwrap_or_default() as f32,
    });
    Ok(seen.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{ball, sheet};

    const OPTIONS: SeeThroughOptions = SeeThroughOptions { side: 128, radius: 3, outline: 8 };

    /// A ball of part 0 with a smaller one of part 1 in it, and what to do with both.
    fn balls(outer: f64, inner: f64) -> (Mesh, Vec<u32>) {
        let (mut mesh, small) = (ball(3), ball(2));
        mesh.positions.iter_mut().flatten().for_each(|x| *x *= outer);
        let (vertices, faces) = (mesh.positions.len(), mesh.faces.len());
        mesh.positions.extend(small.positions.iter().map(|p| p.map(|x| x * inner)));
        let moved = |v: meshlod_mesh::VertexId| meshlod_mesh::VertexId::new(vertices + v.index());
        mesh.faces.extend(small.faces.iter().map(|face| face.map(moved)));
        let parts = (0..mesh.faces.len()).map(|face| u32::from(face >= faces)).collect();
        (mesh, parts)
    }

    fn breaches(original: &(Mesh, Vec<u32>), level: &(Mesh, Vec<u32>)) -> SeeThroughCounts {
        let parted = |of: &'_ (Mesh, Vec<u32>)| (of.0.clone(), of.1.clone());
        let (original, level) = (parted(original), parted(level));
        ReferenceVisibility::new(
            LabelledMesh { mesh: &original.0, label_of_face: &original.1 },
            OPTIONS,
        )
        .unwrap()
        .breaches(LabelledMesh { mesh: &level.0, label_of_face: &level.1 })
        .unwrap()
    }

    #[test]
    fn an_original_is_not_breached_and_outlines_may_move() {
        let original = balls(1.0, 0.8);
        for outer in [1.0, 0.98, 0.9] {
            let level = breaches(&original, &balls(outer, 0.8));
            assert_eq!((level.background, level.hidden), (0, 0), "{outer}");
            assert!(level.shown > 24 * 8_000, "{level:?}");
        }
    }

    #[test]
    fn an_outline_that_goes_far_is_a_breach() {
        assert!(breaches(&balls(1.0, 0.5), &balls(0.7, 0.5)).background > 24 * 1000);
    }

    #[test]
    fn an_inner_part_that_comes_through_is_a_breach() {
        let through = breaches(&balls(1.0, 0.9), &balls(1.0, 1.05));
        assert_eq!(through.background, 0);
        assert!(through.hidden * 10 > through.shown * 7, "{through:?}");
    }

    #[test]
    fn parts_that_part_are_breached_and_their_outlines_are_not() {
        let whole = sheet(16);
        // The left and the right half are two parts; all of the last column of the left goes.
        let column = |face: usize| face / 2 % 16;
        let parts = |keep: fn(usize) -> bool| {
            let faces = (0..512).filter(|&face| keep(column(face)));
            let mut mesh = whole.clone();
            mesh.faces = faces.clone().map(|face| whole.faces[face]).collect();
            (mesh, faces.map(|face| u32::from(column(face) > 7)).collect::<Vec<_>>())
        };
        let original = parts(|_| true);
        let parted = breaches(&original, &parts(|column| column != 7));
        let trimmed = breaches(&original, &parts(|column| column != 0));
        assert!(parted.background > 10 * trimmed.background, "{parted:?} {trimmed:?}");
        assert!(parted.background * 20 > parted.shown, "{parted:?}");
    }

    /// The sheet of part 0, and a small one of part 1 of some size at a height over it.
    fn plaque(half: f64, height: f64) -> (Mesh, Vec<u32>) {
        let (mut mesh, small) = (sheet(2), sheet(1));
        let faces = mesh.faces.len();
        mesh.faces
            .extend(small.faces.iter().map(|face| face.map(|v| meshlod_mesh::VertexId(v.0 + 9))));
        mesh.positions.extend(small.positions.iter().map(|[x, y, _]| [x * half, y * half, height]));
        let parts = (0..mesh.faces.len()).map(|face| u32::from(face >= faces)).collect();
        (mesh, parts)
    }

    #[test]
    fn an_outline_before_another_part_may_move_and_a_line_of_contact_may_not() {
        let [hovers, lies] = [0.25, 0.001].map(|z| breaches(&plaque(0.5, z), &plaque(0.35, z)));
        assert!(lies.hidden > 10 * hovers.hidden, "{lies:?} {hovers:?}");
        assert!(lies.hidden * 50 > lies.shown, "{lies:?}");
    }
}
