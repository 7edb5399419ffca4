//! Queries as plain data: how coarse a mesh may be, and where.

use std::fmt;

use meshlod_multires::{
    Focus, Ground, GroundShape, ModelFile, Query, Source, Tolerance, ViewCamera,
};

use crate::Bound;
use crate::jobs::JobError;

/// A query of a multiresolution file as plain data.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct QueryRequest {
    /// How coarse the mesh may be; by default as the finest level is.
    pub target: QueryTarget,
    /// Where the error counts. Elsewhere the mesh is as coarse as the file has it.
    pub focus: FocusRequest,
    /// Camera for errors in pixels and the focus of what it sees.
    pub camera: Option<ViewCamera>,
    /// Vertical axis of a focus on the ground, 0 to 2; `None` for that of the heights of a height
    /// field, and otherwise y.
    pub up: Option<usize>,
}

/// Size of an extracted mesh: by an error, or by a number of faces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum QueryTarget {
    /// The coarsest mesh within an error.
    Error(ErrorLimit),
    /// The best mesh of at most so many faces: for the camera if there is one, else from all sides.
    Faces(usize),
}

/// Largest error allowed in the focus of a query.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum ErrorLimit {
    /// Distance from the original; 0 for the finest level.
    Length(Bound),
    /// Distance in pixels, projected by the camera.
    Pixels(f64),
}

/// Region in which an error counts.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum FocusRequest {
    /// The whole surface.
    #[default]
    Everything,
    /// The view of the camera.
    Frustum,
    /// A region of space.
    Region(Focus),
    /// A shape on the ground.
    Ground(GroundShape),
}

impl Default for QueryTarget {
    fn default() -> Self {
        Self::Error(ErrorLimit::Length(Bound::Length(0.0)))
    }
}

impl fmt::Display for ErrorLimit {
    /// Writes the limit as `0.5`, `0.1%` or `1px`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(bound) => bound.fmt(f),
            Self::Pixels(pixels) => write!(f, "{pixels}px"),
        }
    }
}

impl QueryRequest {
    /// Returns the largest number of faces, if that is what is asked for.
    pub fn most_faces(&self) -> Option<usize> {
        match self.target {
            QueryTarget::Faces(most) => Some(most),
            QueryTarget::Error(_) => None,
        }
    }

    /// Returns true if the error counts in a region only.
    pub fn has_focus(&self) -> bool {
        !matches!(self.focus, FocusRequest::Everything | FocusRequest::Region(Focus::Everything))
    }

    /// Returns true if the mesh is to be finer in some places than in others.
    pub fn is_local(&self) -> bool {
        self.has_focus() || self.camera.is_some()
    }

    /// Returns the query that is put to a file, about the scene that it shows. A number of faces is
    /// spread as for an error of one pixel, or evenly.
    ///
    /// # Errors
    /// [`JobError::Request`] for a missing camera, and for an axis that is not that of the file.
    pub fn query<S: Source>(&self, file: &ModelFile<S>) -> Result<Query<'static>, JobError> {
        let up = self.up_axis(file)?;
        let camera = |field, reason: &str| {
            self.camera.ok_or_else(|| JobError::request(field, format_args!("{reason} a camera")))
        };
        let focus = match &self.focus {
            FocusRequest::Everything => Focus::Everything,
            FocusRequest::Region(focus) => focus.clone(),
            FocusRequest::Frustum => Focus::Frustum(camera("focus", "a frustum needs")?),
            FocusRequest::Ground(shape) => Focus::Ground(Ground { up, shape: *shape }),
        };
        let limit = match (self.target, self.camera) {
            (QueryTarget::Error(limit), _) => limit,
            (QueryTarget::Faces(_), Some(_)) => ErrorLimit::Pixels(1.0),
            (QueryTarget::Faces(_), None) => ErrorLimit::Length(Bound::OfDiagonal(1.0)),
        };
        let tolerance = match limit {
            ErrorLimit::Length(bound) => Tolerance::Uniform(bound.length(file.diagonal())),
            ErrorLimit::Pixels(pixels) => {
                Tolerance::Pixels { camera: camera("error", "pixels need")?, pixels }
            }
        };
        Ok(Query { focus, tolerance })
    }

    /// Returns the vertical axis of a focus on the ground.
    fn up_axis<S: Source>(&self, file: &ModelFile<S>) -> Result<usize, JobError> {
        const Y: usize = 1;
        let names = ["x", "y", "z"];
        match (file.up(), self.up) {
            (Some(own), Some(given)) if own != given => {
                let reason = format_args!("the heights of this file are along {}", names[own]);
                Err(JobError::request("up", reason))
            }
            (None, Some(given)) if given >= names.len() => {
                Err(JobError::request("up", format_args!("{given} is no axis; use 0, 1 or 2")))
            }
            (own, given) => Ok(own.or(given).unwrap_or(Y)),
        }
    }
}
