//! Pictures of an evaluation: arms side by side, and strips of frames.

use std::sync::Arc;

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{LevelTable, Look};
use meshlod::flock::select::{Budget, PolicyName, Selector};
use meshlod::picture::{Picture, grid};
use meshlod_school::Footage;
use meshlod_school::evaluate::StillPicture;

use crate::flock::evaluate::{BUDGET, OURS, SHOWN_SHARE};
use crate::session::failure::Failure;

/// Pictures by file name.
#[derive(Default)]
pub struct Pictures {
    /// Scene, arm or full detail, and picture.
    stills: Vec<(String, String, Picture)>,
    /// Scene and frames: full detail above, `budget` and `ours` below.
    strips: Vec<(String, Picture)>,
}

/// Arms whose pictures are shown.
const SHOWN: [&str; 4] = ["screen-error", BUDGET, "paper", OURS];

/// Name of the picture of full detail.
const FULL: &str = "full detail";

/// Frames in a strip.
const STRIP: usize = 6;

impl Pictures {
    /// Keeps a picture if it is to be shown.
    pub fn keep(&mut self, still: StillPicture) {
        let StillPicture { scene, arm, share, picture } = still;
        match arm {
            None => self.stills.push((scene, FULL.into(), picture)),
            Some(arm) if share == SHOWN_SHARE && SHOWN.contains(&arm.as_str()) => {
                self.stills.push((scene, arm, picture));
            }
            Some(_) => {}
        }
    }

    /// Draws a strip of frames of every scene.
    pub fn strips(
        &mut self,
        footage: &[Footage],
        table: &Arc<LevelTable>,
        look: &Look,
    ) -> Result<(), Failure> {
        for footage in footage {
            let strip = strip(footage, table, look)?;
            self.strips.push((footage.name.clone(), strip));
        }
        Ok(())
    }

    /// Iterates over the names of the pictures of a scene with their files.
    pub fn of_scene(&self, scene: &str) -> impl Iterator<Item = (&str, String)> {
        let stills = self.stills.iter().filter(move |(of, _, _)| of == scene);
        stills.map(|(scene, arm, _)| (arm.as_str(), still_file(scene, arm)))
    }

    /// Returns the file of the strip of a scene.
    pub fn strip_of(scene: &str) -> String {
        format!("{scene}-frames.png")
    }

    /// Iterates over all files.
    pub fn files(&self) -> impl Iterator<Item = (String, Vec<u8>)> {
        let stills = self.stills.iter();
        let strips = self.strips.iter();
        stills
            .map(|(scene, arm, picture)| (still_file(scene, arm), picture.png()))
            .chain(strips.map(|(scene, picture)| (Self::strip_of(scene), picture.png())))
    }
}

fn still_file(scene: &str, arm: &str) -> String {
    format!("{scene}-{}.png", arm.replace(' ', "-"))
}

/// Draws frames of a scene in three rows: full detail, `budget` and `ours`.
fn strip(footage: &Footage, table: &Arc<LevelTable>, look: &Look) -> Result<Picture, Failure> {
    let mut painter = FlockPainter::new(table, look, &footage.obstacles);
    let mut rows = Vec::new();
    let mut most = usize::MAX;
    for policy in [PolicyName::None, PolicyName::Budget, PolicyName::Ours] {
        let mut selector = Selector::new(policy, table.clone());
        let budget = Budget { triangles: most, ..Budget::default() };
        let shown = (0..STRIP).map(|i| i * footage.len().saturating_sub(1) / (STRIP - 1));
        let shown: Vec<usize> = shown.collect();
        let mut least = usize::MAX;
        for frame in 0..footage.len() {
            let (flock, camera) = (&footage.flocks[frame], &footage.cameras[frame]);
            let levels = selector.select(flock, camera, &budget).to_vec();
            least = least.min(selector.triangles());
            if shown.contains(&frame) {
                let picture = painter.draw(flock, &levels, camera).map_err(Failure::new)?;
                rows.push(halved(&picture)?);
            }
        }
        if policy == PolicyName::None {
            most = (SHOWN_SHARE * least as f64) as usize;
        }
    }
    let columns = rows.len() / 3;
    grid(&rows, columns).map_err(Failure::new)
}

/// Averages blocks of two by two pixels, until the picture is at most 480 wide.
fn halved(picture: &Picture) -> Result<Picture, Failure> {
    const WIDEST: u32 = 480;
    if picture.width() <= WIDEST {
        return Ok(picture.clone());
    }
    let (width, height) = (picture.width() / 2, picture.height() / 2);
    let pixel = |i: u32| {
        let (x, y) = (2 * (i % width), 2 * (i / width));
        let block = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
        let sum = |c: usize| -> u32 {
            block.iter().map(|&(x, y)| u32::from(picture.pixel(x, y)[c])).sum()
        };
        [0, 1, 2, 3].map(|c| (sum(c) / 4) as u8)
    };
    let rgba: Vec<[u8; 4]> = (0..width * height).map(pixel).collect();
    halved(&Picture::new(width, height, rgba.into_flattened()).map_err(Failure::new)?)
}
