//! See-through test: finds pixels where a level of detail shows what its original hides.
//!
//! This can be the background through a crack, or an inner part through an outer one.

use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::error::check_length;
use crate::{Camera, PictureError, visibility};

/// Mesh with a label for each face: its component, its object or any other part.
#[derive(Clone, Copy, Debug)]
pub struct LabelledMesh<'a> {
    /// Mesh to be rendered.
    pub mesh: &'a Mesh,
    /// Label of each face; faces with the same label form a part.
    pub label_of_face: &'a [u32],
}

/// Options for the see-through test, which finds cracks and hidden parts showing through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeeThroughOptions {
    /// Width and height of each rendered view, in pixels.
    pub side: u32,
    /// Distance in pixels by which parts of a level may be shifted from where the original shows
    /// them.
    pub radius: u32,
    /// Distance in pixels by which silhouettes of a level may move.
    pub outline: u32,
}

impl Default for SeeThroughOptions {
    fn default() -> Self {
        Self { side: 1024, radius: 4, outline: 32 }
    }
}

/// Numbers of pixels where a level of detail shows what its original hides, over all views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeeThroughCounts {
    /// Number of pixels that show the original.
    pub shown: usize,
    /// Number of pixels that show the original but where the level lets the background through.
    pub background: usize,
    /// Number of pixels that show the original but where the level shows a part that should be
    /// hidden.
    pub hidden: usize,
}

/// Background or hidden part that a level wrongly shows at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeeThrough {
    /// The background shows through the level, as through a crack.
    Background,
    /// A part that the original hides shows through; this is its label.
    Hidden(u32),
}

/// Original mesh as seen from 24 sides, against which its levels of detail are tested for cracks
/// and hidden parts that show through.
///
/// A pixel is see-through if the level shows a part, or the background, that the original neither
/// shows there nor nearby ([`SeeThroughOptions::radius`]). Silhouettes move in any level, so it is
/// allowed to show what the original has just beyond the nearest border of the part at that pixel,
/// if the border is within [`SeeThroughOptions::outline`] and a silhouette: next to the background,
/// or at a jump in depth. Hence these count: a gap between parts that touched, a hole in a part, an
/// inner part that pokes through an outer one, an intersection of parts that shifts. A fin that
/// gets shorter does not count, be it in front of the background or of the body.
///
/// Memory: 8 bytes a pixel, 200 MB with default options.
pub struct ReferenceVisibility {
    frame: Frame,
    views: Vec<ReferenceView>,
}

/// Pixel layout of a view, and the neighbourhood of a pixel.
struct Frame {
    side: usize,
    /// Empty pixels around the view, so that no offset leaves it.
    margin: usize,
    /// Offsets to the pixels around a pixel, nearest first.
    steps: Vec<isize>,
    /// Number of offsets within the radius.
    within: usize,
}

/// View of the original: what each pixel shows, including the margin.
struct ReferenceView {
    camera: Camera,
    seen: Vec<VisibleLabel>,
    /// Relative difference in depth above which neighbouring pixels form a silhouette.
    jump: f32,
}

/// Label and depth at a pixel.
#[derive(Clone, Copy)]
struct VisibleLabel {
    label: u32,
    depth: f32,
}

/// Depth difference between neighbouring pixels that counts as a jump, in pixel widths: the slope
/// of a surface seen at 7 degrees.
const JUMP_PX: f32 = 8.0;

/// Label of the background.
const BACKGROUND: u32 = u32::MAX;
/// Label of the margin.
const OUTSIDE: u32 = u32::MAX - 1;

impl ReferenceVisibility {
    /// Renders the original mesh from 24 sides, the corners of two icosahedra.
    ///
    /// See [`Camera::icosahedron_views`] and [`Camera::other_icosahedron_views`].
    ///
    /// # Errors
    /// Errors of [`visibility()`], and a number of labels that differs from the number of faces.
    pub fn new(
        original: LabelledMesh<'_>,
        options: SeeThroughOptions,
    ) -> Result<Self, PictureError> {
        let first = Camera::icosahedron_views(original.mesh);
        let cameras = first.into_iter().chain(Camera::other_icosahedron_views(original.mesh));
        let frame = Frame::new(options);
        let view = |camera| {
            let mut padded = vec![VisibleLabel { label: OUTSIDE, depth: 0.0 }; frame.pixels()];
            for (at, seen) in
                labels_and_depths(original, &camera, options.side)?.into_iter().enumerate()
            {
                padded[frame.padded(at)] = seen;
            }
            let jump = JUMP_PX * camera.pixel_width(options.side) as f32;
            Ok(ReferenceView { camera, seen: padded, jump })
        };
        let views = cameras.map(view).collect::<Result<_, PictureError>>()?;
        Ok(Self { frame, views })
    }

    /// Counts the pixels, over all views, where a level of detail shows what the original hides.
    ///
    /// # Errors
    /// Errors of [`ReferenceVisibility::new`].
    pub fn see_through_counts(
        &self,
        level: LabelledMesh<'_>,
    ) -> Result<SeeThroughCounts, PictureError> {
        let mut sum = SeeThroughCounts::default();
        for (view, original) in self.views.iter().enumerate() {
            sum.shown += original.seen.iter().filter(|seen| seen.label < OUTSIDE).count();
            for pixel in self.see_through_pixels(view, level)?.into_iter().flatten() {
                match pixel {
                    SeeThrough::Background => sum.background += 1,
                    SeeThrough::Hidden(_) => sum.hidden += 1,
                }
            }
        }
        Ok(sum)
    }

    /// Finds the pixels of one view where a level of detail shows what the original hides, row
    /// after row from the top.
    ///
    /// # Errors
    /// Errors of [`ReferenceVisibility::new`].
    pub fn see_through_pixels(
        &self,
        view: usize,
        level: LabelledMesh<'_>,
    ) -> Result<Vec<Option<SeeThrough>>, PictureError> {
        let view = &self.views[view];
        let level = labels_and_depths(level, &view.camera, self.frame.side as u32)?;
        let of =
            |at: usize| self.frame.see_through_at(view, self.frame.padded(at), level[at].label);
        Ok((0..level.len()).into_par_iter().map(of).collect())
    }

    /// Returns the cameras of the 24 views.
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

    /// Returns the index of a pixel in a view with its margin.
    fn padded(&self, at: usize) -> usize {
        let [x, y] = [at % self.side, at / self.side].map(|i| i + self.margin);
        y * (self.side + 2 * self.margin) + x
    }

    /// Tests the pixel `at`, where the level shows `shown`.
    fn see_through_at(
        &self,
        ReferenceView { seen, jump, .. }: &ReferenceView,
        at: usize,
        shown: u32,
    ) -> Option<SeeThrough> {
        let label = seen[at].label;
        if label == shown || label == BACKGROUND {
            return None;
        }
        let mut around = self.steps.iter().map(|&step| at.wrapping_add_signed(step));
        if around.clone().take(self.within).any(|near| seen[near].label == shown) {
            return None;
        }
        let beyond = around.find(|&near| seen[near].label != label && seen[near].label != OUTSIDE);
        if let Some(beyond) = beyond
            && seen[beyond].label == shown
            && (shown == BACKGROUND || self.is_behind(seen, beyond, label, *jump))
        {
            return None;
        }
        match shown {
            BACKGROUND => Some(SeeThrough::Background),
            shown => Some(SeeThrough::Hidden(shown)),
        }
    }

    /// Reports whether a pixel is well behind those of its neighbours that show a part.
    fn is_behind(&self, seen: &[VisibleLabel], at: usize, label: u32, jump: f32) -> bool {
        let row = (self.side + 2 * self.margin) as isize;
        let sides = [-row - 1, -row, 1 - row, -1, 1, row - 1, row, row + 1];
        let beside = sides.map(|step| seen[at.wrapping_add_signed(step)]);
        let mut before = beside.into_iter().filter(|beside| beside.label == label);
        before.all(|before| seen[at].depth - before.depth > jump * before.depth)
    }
}

/// Finds the label and depth at each pixel.
fn labels_and_depths(
    of: LabelledMesh<'_>,
    camera: &Camera,
    side: u32,
) -> Result<Vec<VisibleLabel>, PictureError> {
    check_length("labels of faces", of.label_of_face.len(), of.mesh.faces.len())?;
    let seen = visibility(of.mesh, camera, [side; 2])?;
    let seen = seen.faces().zip(seen.depths()).map(|(face, depth)| VisibleLabel {
        label: face.map_or(BACKGROUND, |face| of.label_of_face[face.index()]),
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

    fn counts(original: &(Mesh, Vec<u32>), level: &(Mesh, Vec<u32>)) -> SeeThroughCounts {
        let parted = |of: &'_ (Mesh, Vec<u32>)| (of.0.clone(), of.1.clone());
        let (original, level) = (parted(original), parted(level));
        ReferenceVisibility::new(
            LabelledMesh { mesh: &original.0, label_of_face: &original.1 },
            OPTIONS,
        )
        .unwrap()
        .see_through_counts(LabelledMesh { mesh: &level.0, label_of_face: &level.1 })
        .unwrap()
    }

    #[test]
    fn an_original_is_not_see_through_and_silhouettes_may_move() {
        let original = balls(1.0, 0.8);
        for outer in [1.0, 0.98, 0.9] {
            let level = counts(&original, &balls(outer, 0.8));
            assert_eq!((level.background, level.hidden), (0, 0), "{outer}");
            assert!(level.shown > 24 * 8_000, "{level:?}");
        }
    }

    #[test]
    fn a_silhouette_that_moves_far_is_see_through() {
        assert!(counts(&balls(1.0, 0.5), &balls(0.7, 0.5)).background > 24 * 1000);
    }

    #[test]
    fn an_inner_part_that_pokes_through_is_see_through() {
        let through = counts(&balls(1.0, 0.9), &balls(1.0, 1.05));
        assert_eq!(through.background, 0);
        assert!(through.hidden * 10 > through.shown * 7, "{through:?}");
    }

    #[test]
    fn a_gap_between_parts_is_see_through_and_a_trimmed_silhouette_is_not() {
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
        let parted = counts(&original, &parts(|column| column != 7));
        let trimmed = counts(&original, &parts(|column| column != 0));
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
        let [hovers, lies] = [0.25, 0.001].map(|z| counts(&plaque(0.5, z), &plaque(0.35, z)));
        assert!(lies.hidden > 10 * hovers.hidden, "{lies:?} {hovers:?}");
        assert!(lies.hidden * 50 > lies.shown, "{lies:?}");
    }
}
