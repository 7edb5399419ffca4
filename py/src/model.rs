//! Multiresolution files: building them, and meshes extracted from them.

use std::fs::File;
use std::path::{Path, PathBuf, absolute};

use meshlod::io::write_file;
use meshlod::jobs::{
    self, BuildRequest, ExtractReport, ExtractRequest, JobError, KnownError, LevelOrder,
};
use meshlod::multires::{ErrorKind, FileError, ModelFile};
use meshlod::{IoError, Scene};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::cut::NativeCut;
use crate::errors::{raised, raised_by_file};
use crate::files::texts;
use crate::mesh::NativeMesh;
use crate::query::{CameraArguments, SentQuery};
use crate::report;
use crate::scene::NativeScene;
use crate::work::{Watch, run};

/// A `.mlod` file, of which every extraction reads what it needs.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeModel {
    path: PathBuf,
}

/// Writes all levels of a scene to a `.mlod` file, and returns notes on what it lacks.
///
/// # Errors
/// A scene that cannot be simplified, and errors of the file system.
#[pyfunction]
pub fn build(
    py: Python<'_>,
    scene: &NativeScene,
    path: PathBuf,
    lossless: bool,
    errors: &str,
    order: &str,
) -> PyResult<Vec<String>> {
    let errors = match errors {
        "estimate" => ErrorKind::Estimate,
        "measured" => ErrorKind::Measured,
        "bound" => ErrorKind::Bound,
        _ => {
            let names = "estimate, measured or bound";
            return Err(raised(format_args!("errors must be {names}, not {errors}")));
        }
    };
    let order = match order {
        "cost" => LevelOrder::Cost,
        "error" => LevelOrder::Error,
        _ => return Err(raised(format_args!("order must be cost or error, not {order}"))),
    };
    let request = BuildRequest { lossless, errors, order, ..BuildRequest::default() };
    let scene = scene.shared();
    // The folder of the process may change while the work runs.
    let target = absolute(&path)?;
    let work = move |watch: &mut Watch| -> Result<_, JobError> {
        let (bytes, report) = jobs::build(Scene::clone(&scene), &request, watch)?;
        watch.commit();
        Ok(write_file(&target, &bytes).map(|()| report.notes))
    };
    let written = run(py, None, work)?.map_err(|error| raised_at(&path, &error))?;
    Ok(texts(&written.map_err(raised_by_file)?))
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

    /// Returns the diagonal of the bounding box of the finest level.
    fn diagonal(&self) -> PyResult<f64> {
        Ok(self.open()?.diagonal())
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
        let query = query.request(faces);
        // The error of a number of faces is not measured, which takes longer than the rest.
        let verify = verify && faces.is_none();
        let request = ExtractRequest { query, verify, crop, ..ExtractRequest::default() };
        let file = self.open()?;
        let (pieces, piece_name) = (file.pieces(), file.piece_name());
        let found = run(py, None, move |watch| jobs::extract(&file, &request, watch))?;
        let (scene, report) = found.map_err(|error| raised_at(&self.path, &error))?;
        let dict = extracted(py, &report)?;
        dict.set_item("pieces", (pieces[0], pieces[1]))?;
        dict.set_item("piece_name", piece_name)?;
        Ok((NativeMesh::new(scene.into_mesh())?, dict))
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

/// Makes an exception of a job that was not done, with the name of the file.
fn raised_at(path: &Path, error: &JobError) -> PyErr {
    raised(format_args!("{}: {error}", path.display()))
}

/// Returns the report of an extraction as a dictionary, under the keys of the command's JSON and
/// those of this package.
fn extracted<'py>(py: Python<'py>, report: &ExtractReport) -> PyResult<Bound<'py, PyDict>> {
    let dict = report::of_json(py, report)?;
    let proof = match report.error.known {
        KnownError::Verified(proof) => Some(proof),
        KnownError::Stored | KnownError::Measured(_) => None,
    };
    dict.set_item("level_faces", report.level_faces)?;
    dict.set_item("holds", proof.map(|proof| proof.holds))?;
    dict.set_item("rounding", proof.map(|proof| proof.rounding))?;
    dict.set_item("meets_focus", report.meets_focus)?;
    Ok(dict)
}
