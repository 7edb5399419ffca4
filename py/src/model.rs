//! Multiresolution files: building them, and meshes extracted from them.

use std::fs::File;
use std::path::PathBuf;

use meshlod::multires::{ErrorKind, Focus, ModelFile, Query, QueryError, Tolerance, ViewCamera};
use meshlod::{BuildOptions, ExtractOptions, IoError, extract};
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

/// Writes all levels of a mesh to a `.mlod` file, and returns what the report says.
///
/// # Errors
/// A mesh that cannot be simplified, and errors of the file system.
#[pyfunction]
pub fn build<'py>(
    py: Python<'py>,
    mesh: &NativeMesh,
    path: PathBuf,
    lossless: bool,
    errors: &str,
) -> PyResult<Bound<'py, PyDict>> {
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
    let report = run(py, None, move |_| meshlod::build(&mesh, &path, &options))?.map_err(raised)?;
    let dict = PyDict::new(py);
    dict.set_item("full_faces", report.full_faces)?;
    dict.set_item("base_faces", report.base_faces)?;
    dict.set_item("updates", report.updates)?;
    dict.set_item("bytes", report.bytes)?;
    Ok(dict)
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
    /// `faces` faces; fine in a ball or a box alone.
    #[pyo3(signature = (error, faces, camera, sphere, corners, verify, crop))]
    #[allow(clippy::too_many_arguments)]
    fn extract(
        &self,
        py: Python<'_>,
        error: f64,
        faces: Option<usize>,
        camera: Option<CameraArguments>,
        sphere: Option<([f64; 3], f64)>,
        corners: Option<[[f64; 3]; 2]>,
        verify: bool,
        crop: bool,
    ) -> PyResult<NativeMesh> {
        let query = query(error, camera, sphere, corners);
        let options = ExtractOptions { max_faces: faces, verify, crop, ..Default::default() };
        query.validate().map_err(raised)?;
        let path = self.path.clone();
        let mesh = run(py, None, move |_| {
            let query = Query { focus: query.focus.clone(), tolerance: query.uniform_or_pixels() };
            extract(&path, &ExtractOptions { query, ..options })
        })?;
        NativeMesh::new(mesh.map_err(raised)?)
    }
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
