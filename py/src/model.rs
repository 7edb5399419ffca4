//! Multiresolution files: building them, and meshes extracted from them.

use std::fs::File;
use std::path::{PathBuf, absolute};

use meshlod::io::write_file;
use meshlod::multires::{ErrorKind, FileError, ModelFile};
use meshlod::{
    BuildOptions, ExtractOptions, ExtractReport, IoError, LevelsError, build_bytes,
    extract_reported,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::cut::NativeCut;
use crate::errors::{raised, raised_by_file};
use crate::mesh::NativeMesh;
use crate::query::{CameraArguments, SentQuery};
use crate::work::{Watch, run};

/// A `.mlod` file, of which every extraction reads what it needs.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeModel {
    path: PathBuf,
}

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
    // The folder of the process may change while the work runs.
    let target = absolute(&path)?;
    let work = move |watch: &mut Watch| -> Result<(), LevelsError> {
        let built = build_bytes(&mesh, &options);
        let (bytes, _) = built.map_err(|source| LevelsError::File { path, source })?;
        watch.commit();
        Ok(write_file(&target, &bytes)?)
    };
    run(py, None, work)?.map_err(|error| match error {
        LevelsError::Io(error) => raised_by_file(error),
        other => raised(other),
    })
}

#[pymethods]
impl NativeModel {
    /// Opens a file and reads its header.
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        let this = Self { path };
        this.open()?;
        Ok(this)
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
        let query = SentQuery::new(error, camera, sphere, corners)?;
        let options = ExtractOptions { max_faces: faces, verify, crop, ..Default::default() };
        let path = self.path.clone();
        let found = run(py, None, move |_| {
            extract_reported(&path, &ExtractOptions { query: query.query(), ..options })
        })?;
        let (mesh, report) = found.map_err(raised)?;
        Ok((NativeMesh::new(mesh)?, extracted(py, &report)?))
    }

    /// Reads all levels and returns a cut of them at the coarsest, with the numbers of pieces that
    /// are there and that a whole file has, and the word for one.
    fn cut(&self, py: Python<'_>) -> PyResult<(NativeCut, [usize; 2], &'static str)> {
        let file = self.open()?;
        let (pieces, word) = (file.pieces(), file.piece_name());
        let levels = run(py, None, move |_| file.read())?;
        Ok((NativeCut::new(levels.map_err(|error| self.damaged(&error))?), pieces, word))
    }
}

impl NativeModel {
    fn open(&self) -> PyResult<ModelFile<File>> {
        let file = File::open(&self.path).map_err(|error| IoError::system(&self.path, error));
        ModelFile::open(file.map_err(raised_by_file)?).map_err(|error| self.damaged(&error))
    }

    fn damaged(&self, error: &FileError) -> PyErr {
        raised(format_args!("{}: {error}", self.path.display()))
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
