//! Multiresolution files: building them, and meshes extracted from them.

use std::fs::File;
use std::path::PathBuf;

use meshlod::multires::{ErrorKind, Focus, ModelFile, Query, QueryError, Tolerance, ViewCamera};
use meshlod::{BuildOptions, ExtractOptions, ExtractReport, IoError, extract_reported};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::{raised, raised_by_file};
use crate::mesh::NativeMesh;
use crate::work::run;

/// A `.mlod` file, of which every extraction reads what it needs.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeModel {
    path: PathBuf,
}

/// A camera: eye, point looked at, direction upwards, vertical field of view in radians, and width
/// and height of the picture in pixels.
pub type CameraArguments = ([f64; 3], [f64; 3], [f64; 3], f64, [u32; 2]);

/// Writes all levels of a mesh to a `.mlod` file.
///
/// # Errors
/// A mesh that cannot be simplified, and errors of the file system.
#[pyfunction]
pub fn build(
    py: Python<'_>,
    mesh: &NativeMesh,
    path: PathBuf,
    lossless: bool,
    errors: &str,
) -> PyResult<()> {
    let errors = match errors {
        "estimate" => ErrorKind::Estimate,
        "measured" => ErrorKind::Measured,
        "bound" => ErrorKind::Bound,
        _ => {
            let names = "estimate, measured or bound";
            return Err(raised(format_args!("errors must be {names}, not {errors}")));
        }
    };
    let options = BuildOptions { lossless, errors, ..BuildOptions::default() };
    let mesh = mesh.shared();
    run(py, None, move |_| meshlod::build(&mesh, &path, &options))?.map_err(raised)?;
    Ok(())
}

#[pymethods]
impl NativeModel {
    /// Opens a file and reads its header.
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let file = File::open(&path).map_err(|error| IoError::system(&path, error));
        ModelFile::open(file.map_err(raised_by_file)?)
            .map_err(|error| raised(format_args!("{}: {error}", path.display())))?;
        Ok(Self { path })
    }

    /// Extracts a mesh: within an error in model units or, with a camera, in pixels; of at most
    /// `faces` faces; fine in a ball or a box alone. Returns it with its report.
    #[pyo3(signature = (error, faces, camera, sphere, corners, verify, crop))]
    #[allow(clippy::too_many_arguments)]
    fn extract<'py>(
        &self,
        py: Python<'py>,
        error: f64,
        faces: Option<usize>,
        camera: Option<CameraArguments>,
        sphere: Option<([f64; 3], f64)>,
        corners: Option<[[f64; 3]; 2]>,
        verify: bool,
        crop: bool,
    ) -> PyResult<(NativeMesh, Bound<'py, PyDict>)> {
        let query = query(error, camera, sphere, corners);
        let options = ExtractOptions { max_faces: faces, verify, crop, ..Default::default() };
        query.validate().map_err(raised)?;
        let path = self.path.clone();
        let found = run(py, None, move |_| {
            let query = Query { focus: query.focus.clone(), tolerance: query.uniform_or_pixels() };
            extract_reported(&path, &ExtractOptions { query, ..options })
        })?;
        let (mesh, report) = found.map_err(raised)?;
        Ok((NativeMesh::new(mesh)?, extracted(py, &report)?))
    }
}

/// Returns the report of an extraction as a dictionary.
fn extracted<'py>(py: Python<'py>, report: &ExtractReport) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("level_faces", report.level_faces)?;
    dict.set_item("holds", report.verification.map(|proof| proof.holds))?;
    dict.set_item("rounding", report.verification.map(|proof| proof.rounding))?;
    dict.set_item("pieces", (report.pieces[0], report.pieces[1]))?;
    dict.set_item("piece_name", report.piece_name)?;
    dict.set_item("meets_focus", report.meets_focus)?;
    Ok(dict)
}

/// A query that may go to another thread: its tolerance is no function.
struct SentQuery {
    focus: Focus,
    error: f64,
    camera: Option<ViewCamera>,
}

impl SentQuery {
    fn uniform_or_pixels(&self) -> Tolerance<'static> {
        match self.camera {
            Some(camera) => Tolerance::Pixels { camera, pixels: self.error },
            None => Tolerance::Uniform(self.error),
        }
    }

    fn validate(&self) -> Result<(), QueryError> {
        Query { focus: self.focus.clone(), tolerance: self.uniform_or_pixels() }.validate()
    }
}

fn query(
    error: f64,
    camera: Option<CameraArguments>,
    sphere: Option<([f64; 3], f64)>,
    corners: Option<[[f64; 3]; 2]>,
) -> SentQuery {
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
    SentQuery { focus, error, camera }
}
