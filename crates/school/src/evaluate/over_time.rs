//! Triangles over time with one setting for all arms, as the paper shows them.

use std::sync::Arc;

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{LevelTable, Look};
use meshlod::flock::select::{Budget, Selector};
use meshlod::picture::PictureError;
use serde::Serialize;

use crate::evaluate::arms::Arm;
use crate::evaluate::score::Reference;
use crate::footage::Footage;

/// Triangles of an arm in every frame of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Track {
    /// Name of the arm.
    pub arm: String,
    /// Triangles drawn in each frame.
    pub triangles: Vec<usize>,
    /// Frames that were drawn, with their mean FLIP against full detail.
    pub flips: Vec<(usize, f64)>,
}

/// Runs arms over a scene with the same budget, and compares every `step`th frame with full detail.
///
/// The image error is not equal: the paper's figures 19 to 22 are taken like that.
///
/// # Errors
/// A size that pictures cannot have.
/// # References
/// [CC05] §4.3.
pub fn over_time(
    footage: &Footage,
    table: &Arc<LevelTable>,
    look: &Look,
    arms: &[Arm],
    budget: &Budget,
    step: usize,
) -> Result<Vec<Track>, PictureError> {
    let mut painter = FlockPainter::new(table, look, &footage.obstacles);
    painter.background = meshlod::picture::Background::Plain([128; 3]);
    let blank = |arm: &Arm| Track { arm: arm.name(), triangles: Vec::new(), flips: Vec::new() };
    let mut tracks: Vec<Track> = arms.iter().map(blank).collect();
    let mut selectors: Vec<Selector> =
        arms.iter().map(|arm| Selector::with_policy(arm.policy(table), table.clone())).collect();
    for frame in 0..footage.len() {
        let (flock, camera) = (&footage.flocks[frame], &footage.cameras[frame]);
        let is_drawn = frame % step.max(1) == 0;
        let reference =
            is_drawn.then(|| Reference::new(&mut painter, flock, camera)).transpose()?;
        for (track, selector) in tracks.iter_mut().zip(&mut selectors) {
            let levels = selector.select(flock, camera, budget).to_vec();
            track.triangles.push(selector.triangles());
            if let Some(reference) = &reference {
                let shown = painter.frame(flock, &levels);
                let picture = painter.render(&shown, camera, &camera.for_picture())?;
                track.flips.push((frame, reference.score(&shown, camera, &picture)?.flip));
            }
        }
    }
    Ok(tracks)
}
