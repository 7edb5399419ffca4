//! Functions for all that is done with a mesh besides simplifying it.

use std::path::{PathBuf, absolute};

use meshlod::check::{HoleLimits, RepairOptions, Severity, Stitch};
use meshlod::io::write_file;
use meshlod::jobs::{
    self, CheckRequest, CompressRequest, CompressTarget, JobError, MeasureRequest, Packing,
    RepairRequest,
};
use meshlod::measure::{area, volume};
use meshlod::mesh::LayerKind;
use meshlod::picture::{Camera, UpAxis, View, Wireframe};
use meshlod::scene::{OwnedPaint, normals_of};
use meshlod::strip::{StripOptions, StripQuality, stripify};
use meshlod::{Bound as Length, FileKind, Mesh, Scene};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::errors::{raised, raised_by_file};
use crate::mesh::NativeMesh;
use crate::report;
use crate::work::{Watch, run};

/// Index that ends a strip, as in 32-bit index buffers of GPUs.
const RESTART: u32 = u32::MAX;

/// Measures the distance between two meshes in both directions.
///
/// # Errors
/// A mesh without area, or no samples.
#[pyfunction]
pub fn measure<'py>(
    py: Python<'py>,
    a: &NativeMesh,
    b: &NativeMesh,
    samples: usize,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let (a, b) = (a.shared(), b.shared());
    let request = MeasureRequest { samples, seed, ..MeasureRequest::default() };
    let work = move |watch: &mut Watch| {
        let [a, b] = [a, b].map(|mesh| Scene::from_mesh("", Mesh::clone(&mesh)));
        jobs::measure(&a, &b, &request, watch)
    };
    let found = run(py, None, work)?.map_err(|error| match error {
        JobError::Input(error) => raised(format_args!("the first mesh: {error}")),
        JobError::Second(error) => raised(format_args!("the second mesh: {error}")),
        error => raised(error),
    })?;
    report::measured(py, &found.distance)
}

/// Returns the area of a mesh, and the volume that it encloses.
#[pyfunction]
pub fn sizes(py: Python<'_>, mesh: &NativeMesh) -> PyResult<(f64, f64)> {
    let mesh = mesh.shared();
    run(py, None, move |_| (area(&mesh), volume(&mesh)))
}

/// Number of findings of each kind that was found, and whether they are errors, in the order of the
/// checks.
#[pyfunction]
pub fn check(py: Python<'_>, mesh: &NativeMesh) -> PyResult<Vec<(&'static str, usize, bool)>> {
    let mesh = mesh.shared();
    let request = CheckRequest { limit: 0, ..CheckRequest::default() };
    let report = run(py, None, move |_| jobs::check(&mesh, &request, &()))?.map_err(raised)?;
    let is_error = |kind: meshlod::check::Kind| kind.severity() == Severity::Error;
    let found = report.summary.found();
    Ok(found.map(|(kind, count)| (kind.name(), count, is_error(kind))).collect())
}

/// Repairs a mesh, and returns it with the number of changes of each kind that was made.
///
/// # Errors
/// A length that is negative, and a mesh of which no face is left.
#[pyfunction]
pub fn repair(
    py: Python<'_>,
    mesh: &NativeMesh,
    weld: Option<f64>,
    stitch: Option<f64>,
    fill_holes: Option<usize>,
) -> PyResult<(NativeMesh, Vec<(&'static str, usize)>)> {
    for (name, length) in [("weld", weld), ("stitch", stitch)] {
        if let Some(length) = length.filter(|length| length.is_nan() || *length < 0.0) {
            return Err(raised(format_args!("{name} must be at least 0, not {length}")));
        }
    }
    let holes = fill_holes.map(|edges| HoleLimits { edges, length: None });
    let stitch = stitch.map_or(Stitch::Off, Stitch::Within);
    let steps = RepairOptions { weld, stitch, holes, ..RepairOptions::default() };
    let request = RepairRequest { steps, ..RepairRequest::default() };
    let mesh = mesh.shared();
    let work = move |watch: &mut Watch| {
        let scene = Scene::from_mesh("", Mesh::clone(&mesh));
        jobs::repair(scene, &request, watch)
    };
    let (mut scene, report) = run(py, None, work)?.map_err(raised)?;
    let counts = report.steps.nonzero().map(|(step, count)| (step.name(), count)).collect();
    Ok((NativeMesh::new(scene.meshes.swap_remove(0).mesh)?, counts))
}

/// Returns triangle strips of the faces as one array of points, each strip but the last followed by
/// the restart index.
#[pyfunction]
pub fn strip<'py>(
    py: Python<'py>,
    mesh: &NativeMesh,
    quality: &str,
) -> PyResult<Bound<'py, PyArray1<u32>>> {
    let quality = match quality {
        "quick" => StripQuality::QUICK,
        "thorough" => StripQuality::THOROUGH,
        _ => {
            let names = "quick or thorough";
            return Err(raised(format_args!("quality must be {names}, not {quality}")));
        }
    };
    let mesh = mesh.shared();
    let indices = run(py, None, move |_| {
        // Strips run over points, which differ at a seam.
        let faces: Vec<_> = match mesh.is_per_vertex() {
            true => mesh.faces.clone(),
            false => {
                let points = mesh.to_arrays().faces;
                points.into_iter().map(|face| face.map(meshlod::mesh::VertexId)).collect()
            }
        };
        let strips = stripify(&faces, &StripOptions { quality, ..StripOptions::default() });
        let mut indices = Vec::new();
        for strip in strips.iter() {
            if !indices.is_empty() {
                indices.push(RESTART);
            }
            indices.extend(strip.iter().map(|v| v.0));
        }
        indices
    })?;
    Ok(PyArray1::from_vec(py, indices))
}

/// Compresses a mesh to a file, `.mlq` or `.mlz`, and returns its size in bytes and whether the
/// target was met.
///
/// # Errors
/// Another suffix, an invalid target, a mesh that cannot be compressed, errors of the file system.
#[pyfunction]
pub fn compress(
    py: Python<'_>,
    mesh: &NativeMesh,
    path: PathBuf,
    bits: u32,
    error: Option<f64>,
) -> PyResult<(usize, bool)> {
    let Some(packing) = FileKind::own_of_path(&path).and_then(Packing::of) else {
        let must = "a compressed file must end in .mlq or .mlz";
        return Err(raised(format_args!("{}: {must}", path.display())));
    };
    let target = match error {
        Some(length) => CompressTarget::Error(Length::Length(length)),
        None => CompressTarget::Bits(bits),
    };
    let request = CompressRequest { packing, target, ..CompressRequest::default() };
    let mesh = mesh.shared();
    // The folder of the process may change while the work runs.
    let target = absolute(&path)?;
    let work = move |watch: &mut Watch| {
        let scene = Scene::from_mesh("", Mesh::clone(&mesh));
        let (bytes, report) = jobs::compress(scene, &request, watch).map_err(raised)?;
        watch.commit();
        write_file(&target, &bytes).map_err(raised_by_file)?;
        Ok::<_, PyErr>(report)
    };
    let report = run(py, None, work)??;
    Ok((report.bytes_total, report.reached))
}

/// Draws a mesh, and returns the pixels as RGBA bytes, or as a PNG file.
///
/// # Errors
/// A mesh without faces, a size of 0 or too large, and a direction without length.
#[pyfunction]
pub fn render<'py>(
    py: Python<'py>,
    mesh: &NativeMesh,
    size: [u32; 2],
    wireframe: bool,
    up: &str,
    direction: Option<[f64; 3]>,
    png: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    let up = match up {
        "y" => UpAxis::Y,
        "z" => UpAxis::Z,
        _ => return Err(raised(format_args!("up must be y or z, not {up}"))),
    };
    let mesh = mesh.shared();
    if mesh.faces.is_empty() {
        return Err(raised("the mesh has no faces"));
    }
    if let Some([x, y, z]) = direction {
        let length = (x * x + y * y + z * z).sqrt();
        if !(length.is_finite() && length > 0.0) {
            let must = "direction must have a length, greater than 0 and finite";
            return Err(raised(format_args!("{must}, not ({x}, {y}, {z})")));
        }
    }
    let mut view = View::three_quarter(up);
    view.aspect = f64::from(size[0]) / f64::from(size[1].max(1));
    view.direction = direction.unwrap_or(view.direction);
    let pixels = run(py, None, move |_| {
        let layers = mesh.attributes.as_ref();
        let has_colors = layers.is_some_and(|all| all.layer(LayerKind::Color(0)).is_some());
        let paint = if has_colors { OwnedPaint::Colors } else { OwnedPaint::CLAY };
        let style = meshlod::picture::Style {
            size,
            paint: paint.as_paint(),
            normals: normals_of(&mesh),
            wireframe: wireframe.then(Wireframe::default),
            ..Default::default()
        };
        let picture = meshlod::picture::render(&mesh, &Camera::fit_mesh(&mesh, &view), &style)?;
        Ok::<_, meshlod::picture::PictureError>(match png {
            true => picture.png(),
            false => picture.rgba().to_vec(),
        })
    })?
    .map_err(raised)?;
    Ok(PyBytes::new(py, &pixels))
}
