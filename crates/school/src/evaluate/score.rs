//! Image error of a frame, on the pixels that show the flock.

use meshlod::flock::Flock;
use meshlod::flock::FlockCamera;
use meshlod::flock::draw::{FlockPainter, FrameMesh};
use meshlod::flock::select::InstanceLevel;
use meshlod::picture::{Picture, PictureError, flip, ssim, visibility};
use serde::Serialize;

/// Frame in full detail, with which others are compared.
pub struct Reference {
    /// Picture of the frame.
    pub picture: Picture,
    /// For every pixel, whether it shows a member.
    pub shows_member: Vec<bool>,
    /// For every member, whether any of it is visible.
    pub visible: Vec<bool>,
}

/// How a frame differs from full detail.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrameScore {
    /// Mean FLIP over the pixels that show members in either picture, 0 to 1.
    pub flip: f64,
    /// Mean SSIM over those pixels, 1 for equal pictures.
    pub ssim: f64,
    /// Number of those pixels.
    pub pixels: usize,
}

/// Pixels around the flock that are compared with it, since the filters of FLIP reach that far.
const MARGIN: usize = 10;

impl Reference {
    /// Draws a frame in full detail.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn new(
        painter: &mut FlockPainter<'_>,
        flock: &Flock,
        camera: &FlockCamera,
    ) -> Result<Self, PictureError> {
        let frame = full_detail(painter, flock);
        let picture = painter.render(&frame, camera, &camera.for_picture())?;
        let (shows_member, visible) = seen(&frame, camera, flock.members.len())?;
        Ok(Self { picture, shows_member, visible })
    }

    /// Compares another picture of the frame with this.
    ///
    /// # Errors
    /// A picture of another size.
    pub fn score(
        &self,
        frame: &FrameMesh,
        camera: &FlockCamera,
        picture: &Picture,
    ) -> Result<FrameScore, PictureError> {
        let shown = frame.shows_member(camera)?;
        let compared: Vec<bool> =
            self.shows_member.iter().zip(shown).map(|(&a, b)| a || b).collect();
        let Some(window) = Window::around(&compared, camera.size()) else {
            return Ok(FrameScore { flip: 0.0, ssim: 1.0, pixels: 0 });
        };
        let (reference, test) = (window.of(&self.picture)?, window.of(picture)?);
        let inside = window.select(&compared);
        let pixels = inside.iter().filter(|&&inside| inside).count();
        let mean = |values: Vec<f32>| {
            let counted = values.iter().zip(&inside).filter(|(_, inside)| **inside);
            counted.map(|(&value, _)| f64::from(value)).sum::<f64>() / pixels as f64
        };
        let (flip, ssim) = (mean(flip(&reference, &test)?), mean(ssim(&reference, &test)?));
        Ok(FrameScore { flip, ssim, pixels })
    }
}

/// Returns for every member of a flock whether any of it is visible in full detail.
pub(super) fn visible_members(
    painter: &mut FlockPainter<'_>,
    flock: &Flock,
    camera: &FlockCamera,
) -> Result<Vec<bool>, PictureError> {
    let frame = full_detail(painter, flock);
    Ok(seen(&frame, camera, flock.members.len())?.1)
}

fn full_detail(painter: &mut FlockPainter<'_>, flock: &Flock) -> FrameMesh {
    painter.frame(flock, &vec![InstanceLevel::drawn(0); flock.members.len()])
}

/// Returns for every pixel whether it shows a member, and for every member whether it is visible,
/// with four samples a pixel as in pictures.
fn seen(
    frame: &FrameMesh,
    camera: &FlockCamera,
    members: usize,
) -> Result<(Vec<bool>, Vec<bool>), PictureError> {
    let [width, height] = camera.size();
    let found = visibility(&frame.mesh, &camera.for_picture(), [2 * width, 2 * height])?;
    let mut visible = vec![false; members];
    let mut shows_member = vec![false; width as usize * height as usize];
    for (i, face) in found.faces().enumerate() {
        let Some(member) = face.and_then(|face| frame.member_of(face.index())) else { continue };
        visible[member] = true;
        let (x, y) = (i % (2 * width as usize) / 2, i / (2 * width as usize) / 2);
        shows_member[y * width as usize + x] = true;
    }
    Ok((shows_member, visible))
}

/// Returns how much the error of a picture changes from a frame to the next: the mean difference of
/// the two errors over the pixels that show members in full detail, in parts of white.
pub(super) fn temporal_error(references: [&Reference; 2], pictures: [&Picture; 2]) -> f64 {
    let [a, b] = references;
    let shows = a.shows_member.iter().zip(&b.shows_member).map(|(&a, &b)| a || b);
    let bytes = |i: usize| 4 * i..4 * i + 3;
    let error = |frame: usize, i: usize| {
        let [test, full] =
            [pictures[frame], &references[frame].picture].map(|p| &p.rgba()[bytes(i)]);
        [0, 1, 2].map(|c| i32::from(test[c]) - i32::from(full[c]))
    };
    let (mut sum, mut count) = (0u64, 0u64);
    for (i, _) in shows.enumerate().filter(|(_, shows)| *shows) {
        let (before, after) = (error(0, i), error(1, i));
        sum += (0..3).map(|c| u64::from(before[c].abs_diff(after[c]))).sum::<u64>();
        count += 3;
    }
    sum as f64 / (255 * count.max(1)) as f64
}

/// Rectangle of a picture.
struct Window {
    width: usize,
    start: [usize; 2],
    end: [usize; 2],
}

impl Window {
    fn around(marks: &[bool], size: [u32; 2]) -> Option<Self> {
        let [width, height] = size.map(|side| side as usize);
        let (mut start, mut end) = ([width, height], [0, 0]);
        for (i, _) in marks.iter().enumerate().filter(|(_, marked)| **marked) {
            let at = [i % width, i / width];
            start = [0, 1].map(|axis| start[axis].min(at[axis].saturating_sub(MARGIN)));
            end = [0, 1].map(|axis| end[axis].max(at[axis] + 1 + MARGIN));
        }
        let end = [end[0].min(width), end[1].min(height)];
        (start[0] < end[0]).then_some(Self { width, start, end })
    }

    fn rows(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let at = |x: usize, y: usize| y * self.width + x;
        (self.start[1]..self.end[1]).map(move |y| at(self.start[0], y)..at(self.end[0], y))
    }

    fn select(&self, marks: &[bool]) -> Vec<bool> {
        self.rows().flat_map(|row| marks[row].iter().copied()).collect()
    }

    fn of(&self, picture: &Picture) -> Result<Picture, PictureError> {
        let [width, height] = [0, 1].map(|axis| (self.end[axis] - self.start[axis]) as u32);
        let rows = self.rows().flat_map(|row| &picture.rgba()[4 * row.start..4 * row.end]);
        Picture::new(width, height, rows.copied().collect())
    }
}
