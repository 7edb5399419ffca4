//! Queries: a focus, and an error in model units or in the pixels of a camera.

use meshlod::Bound;
use meshlod::jobs::{ErrorLimit, FocusRequest, QueryRequest, QueryTarget};
use meshlod::multires::{Focus, Query, Tolerance, ViewCamera};
use pyo3::prelude::*;

use crate::errors::raised;

/// A camera: eye, point looked at, direction upwards, vertical field of view in radians, and width
/// and height of the picture in pixels.
pub type CameraArguments = ([f64; 3], [f64; 3], [f64; 3], f64, [u32; 2]);

/// A query that may go to another thread: its tolerance is no function.
#[derive(Clone)]
pub struct SentQuery {
    focus: Focus,
    error: f64,
    camera: Option<ViewCamera>,
}

impl SentQuery {
    /// Makes a query of a ball, a box, the view of a camera, or everything.
    ///
    /// # Errors
    /// A number that makes no sense there.
    pub fn new(
        error: f64,
        camera: Option<CameraArguments>,
        sphere: Option<([f64; 3], f64)>,
        corners: Option<[[f64; 3]; 2]>,
    ) -> PyResult<Self> {
        let camera = camera.map(|(eye, look, up, fov_rad, viewport)| ViewCamera {
            eye,
            look,
            up,
            fov_rad,
            viewport,
        });
        let focus = match (sphere, corners, camera) {
            (Some((center, radius)), ..) => Focus::Sphere { center, radius },
            (None, Some(corners), _) => Focus::Box(corners),
            (None, None, Some(camera)) => Focus::Frustum(camera),
            (None, None, None) => Focus::Everything,
        };
        let this = Self { focus, error, camera };
        this.query().validate().map_err(raised)?;
        Ok(this)
    }

    /// Returns the query as data, for the best mesh of at most `faces` faces if they are given.
    pub fn request(&self, faces: Option<usize>) -> QueryRequest {
        let limit = match self.camera {
            Some(_) => ErrorLimit::Pixels(self.error),
            None => ErrorLimit::Length(Bound::Length(self.error)),
        };
        QueryRequest {
            target: faces.map_or(QueryTarget::Error(limit), QueryTarget::Faces),
            focus: FocusRequest::Region(self.focus.clone()),
            camera: self.camera,
            up: None,
        }
    }

    /// Returns the query.
    pub fn query(&self) -> Query<'static> {
        let tolerance = match self.camera {
            Some(camera) => Tolerance::Pixels { camera, pixels: self.error },
            None => Tolerance::Uniform(self.error),
        };
        Query { focus: self.focus.clone(), tolerance }
    }
}
