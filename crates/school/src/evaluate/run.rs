//! Evaluation of all arms on all footage.

use std::sync::Arc;
use std::time::Instant;

use meshlod::picture::{Picture, PictureError};
use serde::{Deserialize, Serialize};

use crate::evaluate::arms::Arm;
use crate::evaluate::bootstrap::Interval;
use crate::evaluate::curve::{Needed, Row, mean, triangles_for};
use crate::evaluate::score::{FrameScore, Reference, temporal_error, visible_members};
use crate::footage::Footage;
use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{LevelTable, Look};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName, Selector};

/// Options of an evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EvaluationOptions {
    /// Arms to compare.
    pub arms: Vec<Arm>,
    /// Shares of the triangles of full detail in view at which every arm is drawn, ascending.
    pub shares: Vec<f64>,
    /// Pairs of consecutive frames that are drawn in every scene, evenly spread.
    pub pairs: usize,
    /// Image errors for which the triangles needed are found.
    pub flips: Vec<f64>,
}

impl Default for EvaluationOptions {
    fn default() -> Self {
        Self {
            arms: Arm::all(),
            shares: vec![0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4],
            pairs: 4,
            flips: vec![0.01, 0.02, 0.05],
        }
    }
}

/// Results of an evaluation.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// Scores of every arm in every scene at every share.
    pub rows: Vec<Row>,
    /// Triangles that every arm needs in every scene.
    pub needed: Vec<Needed>,
    /// Floor of every scene: full detail with its samples shifted by a quarter of a pixel.
    pub floors: Vec<(String, FrameScore)>,
    /// Mean triangles of full detail in view in every scene.
    pub full_triangles: Vec<(String, f64)>,
}

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

/// Frames before a scored pair for which levels are chosen, so that hysteresis has its effect.
const RUN_UP: usize = 6;

/// Evaluates all arms on all footage. Cost: some three pictures a pair of frames, share and arm.
///
/// `watch` is called before every arm with the part of the work that is done, from 0 to 1; `still`
/// gets pictures of the first scored frame.
///
/// # Errors
/// A size that pictures cannot have.
pub fn evaluate(
    footage: &[Footage],
    table: &Arc<LevelTable>,
    look: &Look,
    options: &EvaluationOptions,
    watch: &mut dyn FnMut(f64, &str),
    still: &mut dyn FnMut(StillPicture),
) -> Result<Evaluation, PictureError> {
    let mut result = Evaluation {
        rows: Vec::new(),
        needed: Vec::new(),
        floors: Vec::new(),
        full_triangles: Vec::new(),
    };
    let filled: Vec<&Footage> = footage.iter().filter(|footage| !footage.is_empty()).collect();
    let steps = (filled.len() * (options.arms.len() + 1)) as f64;
    for (i, footage) in filled.into_iter().enumerate() {
        let done = (i * (options.arms.len() + 1)) as f64;
        watch(done / steps, &footage.name);
        let mut stage = Stage::new(footage, table, look, options.pairs)?;
        result.floors.push((footage.name.clone(), stage.floor()?));
        result.full_triangles.push((footage.name.clone(), stage.full_triangles));
        still(stage.reference_still());
        for (k, &arm) in options.arms.iter().enumerate() {
            watch((done + 1.0 + k as f64) / steps, &format!("{}: {}", footage.name, arm.name()));
            for &share in &options.shares {
                let (row, picture) = stage.row(arm, share)?;
                still(StillPicture {
                    scene: row.scene.clone(),
                    arm: Some(row.arm.clone()),
                    share,
                    picture,
                });
                result.rows.push(row);
            }
        }
    }
    result.find_needed(&options.flips);
    Ok(result)
}

/// Scene with its references.
struct Stage<'a> {
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
    full_triangles: f64,
}

/// Levels that an arm chose with one bias.
struct ChosenLevels {
    /// Levels in both frames of each pair.
    levels: Vec<[Vec<InstanceLevel>; 2]>,
    /// Triangles of the scored frames.
    triangles: Vec<usize>,
    switches_per_second: f64,
    selection_seconds: f64,
}

impl ChosenLevels {
    fn mean_triangles(&self) -> f64 {
        mean(self.triangles.iter().map(|&count| count as f64))
    }
}

impl<'a> Stage<'a> {
    fn new(
        footage: &'a Footage,
        table: &'a Arc<LevelTable>,
        look: &'a Look,
        pairs: usize,
    ) -> Result<Self, PictureError> {
        let mut painter = FlockPainter::new(table, look, &footage.obstacles);
        painter.background = meshlod::picture::Background::Plain([128; 3]);
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
        let mut visible = Vec::new();
        for (&first, [one, other]) in pairs.iter().zip(&references) {
            let mut seen = Vec::new();
            for frame in first.saturating_sub(RUN_UP)..first {
                let (flock, camera) = (&footage.flocks[frame], &footage.cameras[frame]);
                seen.push(visible_members(&mut painter, flock, camera)?);
            }
            seen.extend([one.visible.clone(), other.visible.clone()]);
            visible.push(seen);
        }
        let full_triangles = 0.0;
        let mut stage =
            Self { footage, table, painter, pairs, references, visible, full_triangles };
        let full = Arm::Policy(PolicyName::None);
        stage.full_triangles = stage.choose(full, &Budget::default()).mean_triangles();
        Ok(stage)
    }

    /// Scores full detail with its samples shifted against itself.
    fn floor(&mut self) -> Result<FrameScore, PictureError> {
        let (flock, camera) =
            (&self.footage.flocks[self.pairs[0]], self.footage.cameras[self.pairs[0]]);
        let levels = vec![InstanceLevel::drawn(0); flock.members.len()];
        let frame = self.painter.frame(flock, &levels);
        let picture = self.painter.render(&frame, &camera, &camera.shifted([0.25, 0.25]))?;
        self.references[0][0].score(&frame, &camera, &picture)
    }

    fn reference_still(&self) -> StillPicture {
        let picture = self.references[0][0].picture.clone();
        StillPicture { scene: self.footage.name.clone(), arm: None, share: 1.0, picture }
    }

    /// Draws and scores an arm at a share of the triangles.
    fn row(&mut self, arm: Arm, share: f64) -> Result<(Row, Picture), PictureError> {
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
            triangles: choice.triangles,
            frames,
            temporal_error: mean(temporal.into_iter()),
            switches_per_second: choice.switches_per_second,
            selection_seconds: choice.selection_seconds,
        };
        Ok((row, shown.expect("there is at least one pair")))
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
        let Footage { flocks, cameras, frame_s, .. } = self.footage;
        let mut choice = ChosenLevels {
            levels: Vec::new(),
            triangles: Vec::new(),
            switches_per_second: 0.0,
            selection_seconds: 0.0,
        };
        let (mut switches, mut member_seconds, mut runs) = (0usize, 0.0, 0);
        for (pair, &first) in self.pairs.iter().enumerate() {
            let mut selector = Selector::with_policy(arm.policy(self.table), self.table.clone());
            let mut levels = [Vec::new(), Vec::new()];
            let mut before: Vec<InstanceLevel> = Vec::new();
            let last = (first + 1).min(flocks.len() - 1);
            for frame in first.saturating_sub(RUN_UP)..=last {
                let run = frame - first.saturating_sub(RUN_UP);
                let visible = arm.skips_occluded().then(|| &self.visible[pair][run][..]);
                let start = Instant::now();
                let chosen =
                    selector.select_visible(&flocks[frame], &cameras[frame], budget, visible);
                choice.selection_seconds += start.elapsed().as_secs_f64();
                runs += 1;
                if !before.is_empty() {
                    let look = |level: &InstanceLevel| level.appearance(self.table);
                    let both = before.iter().map(look).zip(chosen.iter().map(look));
                    let (same, other): (Vec<_>, Vec<_>) =
                        both.filter(|(a, b)| a.is_some() && b.is_some()).partition(|(a, b)| a == b);
                    switches += other.len();
                    member_seconds += (same.len() + other.len()) as f64 * f64::from(*frame_s);
                }
                before = chosen.to_vec();
                if frame >= first {
                    choice.triangles.push(selector.triangles());
                    levels[frame - first].clone_from(&before);
                }
            }
            if last == first {
                levels[1] = levels[0].clone();
                choice.triangles.extend(choice.triangles.last().copied());
            }
            choice.levels.push(levels);
        }
        choice.selection_seconds /= f64::from(runs.max(1));
        choice.switches_per_second = switches as f64 / f64::max(member_seconds, 1e-9);
        choice
    }
}

impl Evaluation {
    fn find_needed(&mut self, flips: &[f64]) {
        for (scene, arm) in self.curves() {
            for &flip in flips {
                let triangles = triangles_for(&self.points(&scene, &arm, None), flip);
                self.needed.push(Needed {
                    scene: scene.clone(),
                    arm: arm.clone(),
                    flip,
                    triangles,
                });
            }
        }
    }

    /// Lists all pairs of scene and arm.
    fn curves(&self) -> Vec<(String, String)> {
        let mut curves: Vec<(String, String)> = Vec::new();
        for row in &self.rows {
            let curve = (row.scene.clone(), row.arm.clone());
            if !curves.contains(&curve) {
                curves.push(curve);
            }
        }
        curves
    }

    /// Returns mean triangles and FLIP of an arm in a scene, by share; of some frames or all.
    fn points(&self, scene: &str, arm: &str, frames: Option<&[usize]>) -> Vec<[f64; 2]> {
        let rows = self.rows.iter().filter(|row| row.scene == scene && row.arm == arm);
        rows.map(|row| match frames {
            None => [row.mean_triangles(), row.flip()],
            Some(frames) => [
                mean(frames.iter().map(|&f| row.triangles[f] as f64)),
                mean(frames.iter().map(|&f| row.frames[f].flip)),
            ],
        })
        .collect()
    }

    /// Returns the triangles that an arm needs over those of another for an image error, as a
    /// geometric mean over the scenes, with a bootstrap interval.
    ///
    /// `None` if one of them does not reach the error in every scene.
    pub fn ratio(&self, arm: &str, other: &str, flip: f64) -> Option<Interval> {
        let scenes: Vec<&String> = self.full_triangles.iter().map(|(scene, _)| scene).collect();
        // Both frames of a pair are drawn together: they are nearly alike.
        let pairs = self.rows.first().map_or(0, |row| row.frames.len() / 2);
        Interval::of(scenes.len(), pairs, |drawn| {
            let log = |(scene, pairs): &(usize, Vec<usize>)| {
                let frames: Vec<usize> = pairs.iter().flat_map(|p| [2 * p, 2 * p + 1]).collect();
                let points = |arm| self.points(scenes[*scene], arm, Some(&frames));
                let needs = |arm| triangles_for(&points(arm), flip);
                Some((needs(arm)? / needs(other)?).ln())
            };
            let logs: Option<Vec<f64>> = drawn.iter().map(log).collect();
            logs.filter(|logs| !logs.is_empty()).map(|logs| mean(logs.into_iter()).exp())
        })
    }

    /// Returns the mean over all scenes of a figure of an arm at a share of the triangles; `None` if
    /// the arm is off by more than a tenth of the share in one of them.
    pub fn mean(&self, arm: &str, share: f64, figure: impl Fn(&Row) -> f64) -> Option<f64> {
        let rows = self.rows.iter().filter(|row| row.arm == arm && row.share == share);
        // Some arms cannot draw so little, or so much.
        let is_near = |row: &Row| {
            let full = self.full_triangles.iter().find(|(scene, _)| *scene == row.scene);
            let full = full.map_or(0.0, |(_, full)| *full);
            (row.mean_triangles() / full / share - 1.0).abs() < 0.1
        };
        let rows: Vec<&Row> = rows.collect();
        if !rows.iter().all(|row| is_near(row)) {
            return None;
        }
        let values: Vec<f64> = rows.into_iter().map(figure).collect();
        (!values.is_empty()).then(|| mean(values.into_iter()))
    }
}
