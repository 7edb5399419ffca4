//! An open file, with its level, its findings and its query.

use std::sync::Arc;

use meshlod::Method;
use meshlod::check::Kind;
use meshlod::jobs::CheckReport;
use meshlod::multires::{Focus, ViewCamera};
use meshlod::picture::Camera;

use crate::stage::{Loaded, LoadedContent, SubjectId};
use crate::{CutQuery, CutTolerance};

/// Number of an open file, never used again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DocumentId(pub usize);

/// Open file with everything made from it.
#[derive(Debug)]
pub(crate) struct Document {
    pub id: DocumentId,
    pub loaded: Arc<Loaded>,
    pub original: SubjectId,
    pub mode: ShownSide,
    /// Settings of the next level.
    pub order: LevelOrder,
    /// Simplified level.
    pub level: Option<DocumentLevel>,
    pub findings: Findings,
    /// Level of a multiresolution file that follows a query.
    pub cut: Option<CutControl>,
}

/// Side of a document that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum ShownSide {
    #[default]
    Original,
    Level,
    /// Original and level side by side.
    Both,
}

/// Goal of a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LevelGoal {
    Faces,
    Error,
    Pixels,
}

/// Settings of a simplification.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelOrder {
    pub method: Method,
    pub goal: LevelGoal,
    pub faces: usize,
    /// Largest error, in percent of the diagonal.
    pub error_percent: f64,
    /// Largest error on the screen, in pixels, at the distance of the target.
    pub pixels: f64,
}

/// Simplified level with the figures of its report.
#[derive(Debug)]
pub(crate) struct DocumentLevel {
    pub loaded: Arc<Loaded>,
    pub subject: SubjectId,
    pub method: Method,
    pub seconds: f64,
    /// Error that the method estimates, in model units.
    pub error_estimate: f64,
    pub reached: bool,
    /// Distances between the original and the level, once measured.
    pub distance: Option<LevelDistance>,
}

/// Distances between vertices of one surface and the other surface, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LevelDistance {
    pub greatest: f64,
    pub rms: f64,
}

/// Findings of a check.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    pub report: Option<CheckReport>,
    /// Place of each listed finding.
    pub places: Vec<Option<[f64; 3]>>,
    pub selected: Option<usize>,
    /// Kind that is unfolded in the list.
    pub unfolded: Option<Kind>,
}

/// Query of a multiresolution file, and the cut that follows it.
#[derive(Debug)]
pub(crate) struct CutControl {
    pub goal: LevelGoal,
    pub faces: usize,
    pub error_percent: f64,
    pub pixels: f64,
    pub focus: FocusKind,
    /// Middle of the focus; it follows the point that the camera looks at unless it is held.
    pub center: [f64; 3],
    pub is_held: bool,
    /// Radius of the focus, relative to the diagonal.
    pub radius: f64,
    /// Camera of the query, if it does not follow the view.
    pub frozen: Option<Camera>,
    /// Vertices move smoothly to their new positions.
    pub moves: bool,
    /// Old triangles dissolve into new ones, if vertices do not move.
    pub dissolves: bool,
    /// The last query sent to the cut.
    pub asked: Option<CutWish>,
}

/// Query of a cut, as settings and a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CutWish {
    pub goal: LevelGoal,
    pub faces: usize,
    /// Error in model units.
    pub error: f64,
    pub pixels: f64,
    pub focus: FocusKind,
    pub center: [f64; 3],
    pub radius: f64,
    pub camera: ViewCamera,
}

/// Kind of a focus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FocusKind {
    Everything,
    View,
    Point,
    Box,
    Sphere,
}

impl FocusKind {
    pub const ALL: [Self; 5] = [Self::Everything, Self::View, Self::Point, Self::Box, Self::Sphere];

    pub fn name(self) -> &'static str {
        match self {
            Self::Everything => "Everything",
            Self::View => "Field of view",
            Self::Point => "Point",
            Self::Box => "Box",
            Self::Sphere => "Sphere",
        }
    }
}

impl Document {
    pub fn new(id: DocumentId, loaded: Arc<Loaded>, original: SubjectId) -> Self {
        let faces = loaded.mesh.faces.len();
        let has_levels = matches!(loaded.content, LoadedContent::Levels(_));
        Self {
            id,
            original,
            mode: ShownSide::Original,
            order: LevelOrder {
                method: Method::default(),
                goal: LevelGoal::Faces,
                faces: (faces / 10).max(4),
                error_percent: 0.1,
                pixels: 1.0,
            },
            level: None,
            findings: Findings::default(),
            cut: has_levels.then(|| CutControl::new(&loaded)),
            loaded,
        }
    }

    /// Returns the subjects to show, from the left.
    pub fn shown(&self) -> Vec<SubjectId> {
        match (&self.level, self.mode) {
            (Some(level), ShownSide::Level) => vec![level.subject],
            (Some(level), ShownSide::Both) => vec![self.original, level.subject],
            _ => vec![self.original],
        }
    }

    /// Returns true if there is a level to compare with the original.
    pub fn has_sides(&self) -> bool {
        self.level.is_some()
    }
}

impl CutControl {
    fn new(loaded: &Loaded) -> Self {
        Self {
            goal: LevelGoal::Pixels,
            faces: (loaded.mesh.faces.len() / 10).max(4),
            error_percent: 0.05,
            pixels: 1.0,
            focus: FocusKind::Everything,
            center: loaded.bounds.center(),
            is_held: false,
            radius: 0.1,
            frozen: None,
            moves: true,
            dissolves: false,
            asked: None,
        }
    }

    /// Returns the query of the settings for a camera, in a model of a diagonal.
    pub fn wish(&self, camera: ViewCamera, diagonal: f64) -> CutWish {
        CutWish {
            goal: self.goal,
            faces: self.faces,
            error: self.error_percent / 100.0 * diagonal,
            pixels: self.pixels,
            focus: self.focus,
            center: self.center,
            radius: self.radius * diagonal,
            camera,
        }
    }
}

impl CutWish {
    /// Returns true if another wish gives the same cut: cameras count only where they matter.
    pub fn is_like(&self, other: &Self) -> bool {
        let sees = self.goal == LevelGoal::Pixels || self.focus == FocusKind::View;
        let camera = if sees { self.camera } else { other.camera };
        let moves = !matches!(self.focus, FocusKind::Everything | FocusKind::View);
        let center = if moves { self.center } else { other.center };
        Self { camera, center, ..*self } == *other
    }

    /// Returns the query for a cut.
    pub fn query(&self) -> CutQuery {
        let Self { center, radius, camera, .. } = *self;
        let corner = |by: f64| center.map(|x| x + by);
        let focus = match self.focus {
            FocusKind::Everything => Focus::Everything,
            FocusKind::View => Focus::Frustum(camera),
            FocusKind::Point => Focus::Point(center),
            FocusKind::Sphere => Focus::Sphere { center, radius },
            FocusKind::Box => Focus::Box([corner(-radius), corner(radius)]),
        };
        let tolerance = match self.goal {
            LevelGoal::Pixels => CutTolerance::Pixels { camera, pixels: self.pixels },
            LevelGoal::Error => CutTolerance::Uniform(self.error),
            LevelGoal::Faces => CutTolerance::Faces(self.faces),
        };
        CutQuery { focus, tolerance }
    }
}
