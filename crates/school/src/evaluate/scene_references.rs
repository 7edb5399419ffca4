//! Pairs of frames of a scene with their references, against which arms are scored.

use std::sync::Arc;

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{LevelTable, Look};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName};
use meshlod::picture::{Background, Picture, PictureError};

use crate::evaluate::arms::Arm;
use crate::evaluate::chosen_levels::{ChosenLevels, FramePair, run_start};
use crate::evaluate::curve::{Row, mean};
use crate::evaluate::score::{FrameScore, Reference, temporal_error, visible_members};
use crate::footage::Footage;

/// Picture that a page may show.
pub struct StillPicture {
    /// Name of the scene.
    pub scene: String,
    /// Name of the arm; `None` for full detail.
    pub arm: Option<String>,
    /// Share of the triangles of full detail.
    pub share: f64,
    /// Picture of the first scored frame.
    pub picture: Picture,
}

/// Scene with its references.
pub(super) struct SceneReferences<'a> {
    footage: &'a Footage,
    table: &'a Arc<LevelTable>,
    painter: FlockPainter<'a>,
    /// First frame of each scored pair.
    pairs: Vec<usize>,
    /// References of both frames of each pair.
    references: Vec<[Reference; 2]>,
    /// Members that are visible in the frames before each pair and in the pair.
    visible: Vec<Vec<Vec<bool>>>,
    /// Mean triangles of full detail in view.
    pub full_triangles: f64,
}

impl<'a> SceneReferences<'a> {
    /// Draws full detail in some pairs of frames, evenly spread.
    pub fn new(
        footage: &'a Footage,
        table: &'a Arc<LevelTable>,
        look: &'a Look,
        pairs: usize,
    ) -> Result<Self, PictureError> {
        let mut painter = FlockPainter::new(table, look, &footage.obstacles);
        painter.background = Background::Plain([128; 3]);
        let last = footage.len().saturating_sub(2);
        let count = pairs.max(1);
        let pairs: Vec<usize> = (0..count).map(|i| (2 * i + 1) * last / (2 * count)).collect();
        let mut references = Vec::new();
        for &first in &pairs {
            let mut reference = |frame: usize| {
                let frame = frame.min(footage.len() - 1);
                Reference::new(&mut painter, &footage.flocks[frame], &footage.cameras[frame])
            };
            references.push([reference(first)?, reference(first + 1)?]);
        }
        let visible = visible_in_runs(&mut painter, footage, &pairs, &references)?;
        let full_triangles = 0.0;
        let mut scene =
            Self { footage, table, painter, pairs, references, visible, full_triangles };
        let full = Arm::Policy(PolicyName::None);
        scene.full_triangles = scene.choose(full, &Budget::default()).mean_triangles();
        Ok(scene)
    }

    /// Scores full detail with its samples shifted against itself.
    pub fn floor(&mut self) -> Result<FrameScore, PictureError> {
        let (flock, camera) =
            (&self.footage.flocks[self.pairs[0]], self.footage.cameras[self.pairs[0]]);
        let levels = vec![InstanceLevel::drawn(0); flock.members.len()];
        let frame = self.painter.frame(flock, &levels);
        let picture = self.painter.render(&frame, &camera, &camera.shifted([0.25, 0.25]))?;
        self.references[0][0].score(&frame, &camera, &picture)
    }

    /// Returns the picture of the first scored frame in full detail.
    pub fn reference_still(&self) -> StillPicture {
        let picture = self.references[0][0].picture.clone();
        StillPicture { scene: self.footage.name.clone(), arm: None, share: 1.0, picture }
    }

    /// Draws and scores an arm at a share of the triangles.
    pub fn row(&mut self, arm: Arm, share: f64) -> Result<(Row, StillPicture), PictureError> {
        let choice = self.at_share(arm, share);
        let (mut frames, mut temporal, mut shown) = (Vec::new(), Vec::new(), None);
        for (pair, levels) in choice.levels.iter().enumerate() {
            let mut pictures = Vec::new();
            for (second, levels) in levels.iter().enumerate() {
                let at = (self.pairs[pair] + second).min(self.footage.len() - 1);
                let camera = &self.footage.cameras[at];
                let frame = self.painter.frame(&self.footage.flocks[at], levels);
                let picture = self.painter.render(&frame, camera, &camera.for_picture())?;
                frames.push(self.references[pair][second].score(&frame, camera, &picture)?);
                pictures.push(picture);
            }
            let [a, b] = &self.references[pair];
            temporal.push(temporal_error([a, b], [&pictures[0], &pictures[1]]));
            shown.get_or_insert(pictures.swap_remove(0));
        }
        let row = Row {
            scene: self.footage.name.clone(),
            arm: arm.name(),
            share,
            switches_per_second: choice.switches_per_second(),
            selection_seconds: choice.selection_seconds(),
            triangles: choice.triangles,
            frames,
            temporal_error: mean(temporal.into_iter()),
        };
        let still = StillPicture {
            scene: row.scene.clone(),
            arm: Some(row.arm.clone()),
            share,
            picture: shown.expect("there is at least one pair"),
        };
        Ok((row, still))
    }

    /// Sets the bias of an arm so that it draws a share of the triangles, as a mean over the frames
    /// and by bisection: the greatest that draws no more, where there is one.
    fn at_share(&mut self, arm: Arm, share: f64) -> ChosenLevels {
        let wanted = share * self.full_triangles;
        let budget = |log: f64| match arm.has_budget() {
            true => {
                Budget { triangles: (wanted * (log / 8.0).exp2()) as usize, ..Budget::default() }
            }
            false => {
                Budget { triangles: usize::MAX, detail: log.exp2() as f32, ..Budget::default() }
            }
        };
        let (mut low, mut high) = (-16.0, 16.0);
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            let fits = self.choose(arm, &budget(middle)).mean_triangles() <= wanted;
            if fits { low = middle } else { high = middle }
        }
        self.choose(arm, &budget(low))
    }
    /// Runs an arm over the frames of all pairs and before.
    fn choose(&self, arm: Arm, budget: &Budget) -> ChosenLevels {
        let mut chosen = ChosenLevels::default();
        for (&first, visible) in self.pairs.iter().zip(&self.visible) {
            let pair = FramePair { footage: self.footage, first, visible };
            chosen.add(&pair, arm, self.table, budget);
        }
        chosen
    }
}

/// Finds the visible members in every pair and the frames before it.
fn visible_in_runs(
    painter: &mut FlockPainter<'_>,
    footage: &Footage,
    pairs: &[usize],
    references: &[[Reference; 2]],
) -> Result<Vec<Vec<Vec<bool>>>, PictureError> {
    let mut visible = Vec::new();
    for (&first, [one, other]) in pairs.iter().zip(references) {
        let mut seen = Vec::new();
        for frame in run_start(first)..first {
            let (flock, camera) = (&footage.flocks[frame], &footage.cameras[frame]);
            seen.push(visible_members(painter, flock, camera)?);
        }
        seen.extend([one.visible.clone(), other.visible.clone()]);
        visible.push(seen);
    }
    Ok(visible)
}
