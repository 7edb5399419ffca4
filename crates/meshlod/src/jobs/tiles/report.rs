//! Report of tiles.

use meshlod_tiles::plan::Plan;
use meshlod_tiles::review::TilesetReview;
use meshlod_tiles::tileset::Finished;

/// Report of [`tiles`](crate::jobs::tiles()).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TilesReport {
    /// Number of faces of the model.
    pub input_faces: usize,
    /// Number of faces that had two corners at one point of the lattice, and are left out.
    pub degenerate_faces: usize,
    /// Number of tiles.
    pub tiles: usize,
    /// Bytes of all contents.
    pub bytes: u64,
    /// Length of a step of the lattice, in model units; vertices are on every second one.
    pub lattice_step: f64,
    /// Levels, the coarsest first. Each is a whole model: leaves that are less deep belong to it.
    pub levels: Vec<TileLevel>,
    /// Number of tiles that could not be simplified without harm to their borders, and are as fine
    /// as what they were made from.
    pub unchanged_tiles: usize,
    /// Number of images that tiles should show and that cannot be decoded; they are left out.
    pub lost_images: usize,
}

/// Level of a tileset.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TileLevel {
    /// Depth of its tiles.
    pub depth: usize,
    /// Number of tiles.
    pub tiles: usize,
    /// Number of faces, without skirts.
    pub faces: usize,
    /// Greatest error of its tiles, proved, in model units.
    pub error_proved: f64,
}

/// Report of [`check_tileset`](crate::jobs::check_tileset).
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TilesetReport {
    /// Number of tiles.
    pub tiles: usize,
    /// Number of levels.
    pub levels: usize,
    /// Number of faces of all tiles, without skirts.
    pub faces: usize,
    /// Faults, one line each.
    pub findings: Vec<String>,
}

impl TilesetReport {
    pub(super) fn of(review: TilesetReview) -> Self {
        let TilesetReview { tiles, levels, faces, findings } = review;
        Self { tiles, levels, faces, findings }
    }
}

impl TilesReport {
    pub(super) fn of(plan: &Plan, finished: &Finished) -> Self {
        let records = &finished.records;
        let is_leaf: Vec<bool> =
            (0..records.len()).map(|task| plan.parts(task).is_empty()).collect();
        let level = |depth: usize| {
            let shown = records.iter().zip(&is_leaf).filter(|(record, is_leaf)| {
                let own = usize::from(record.cell.depth);
                own == depth || (own < depth && **is_leaf)
            });
            let level = TileLevel { depth, tiles: 0, faces: 0, error_proved: 0.0 };
            shown.fold(level, |level, (record, _)| TileLevel {
                tiles: level.tiles + 1,
                faces: level.faces + record.faces,
                error_proved: level.error_proved.max(record.error),
                ..level
            })
        };
        Self {
            input_faces: plan.faces + plan.degenerate,
            degenerate_faces: plan.degenerate,
            tiles: records.len(),
            bytes: records.iter().map(|record| record.bytes).sum(),
            lattice_step: plan.lattice.step,
            levels: (0..=usize::from(plan.tree.depth())).map(level).collect(),
            unchanged_tiles: records.iter().filter(|record| record.is_unchanged).count(),
            lost_images: finished.lost_images(plan).len(),
        }
    }
}
