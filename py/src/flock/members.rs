//! Members of a flock as arrays from numpy, and back.

use std::ops::Range;

use meshlod::flock::{Flock, Members, School};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::errors::raised;
use crate::numpy_views::given;

/// Greatest coordinate, in body lengths, so that single precision resolves a tenth of one.
const FARTHEST: f32 = 1e6;

/// A flock as contiguous arrays with a row for each member, in body lengths, with +y up.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct FlockArguments<'py> {
    positions: PyReadonlyArray2<'py, f32>,
    headings: PyReadonlyArray2<'py, f32>,
    speeds: PyReadonlyArray1<'py, f32>,
    schools: Vec<SchoolArguments>,
}

/// A school: its first member and the one behind its last; its leader, heading and radii.
type SchoolArguments = ([usize; 2], [f32; 3], [f32; 3], [f32; 3]);

/// Positions, headings and speeds, with a row for each member, and the schools.
pub type FlockArrays<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f32>>,
    Vec<SchoolArguments>,
);

impl FlockArguments<'_> {
    /// Copies the arrays, which may change or go as soon as the GIL is released.
    ///
    /// # Errors
    /// A coordinate or speed that is not finite, a place too far away, a heading without direction,
    /// and schools that overlap or have members that are not there.
    pub fn to_flock(&self) -> PyResult<Flock> {
        let (positions, _) = self.positions.as_slice()?.as_chunks::<3>();
        let (headings, _) = self.headings.as_slice()?.as_chunks::<3>();
        let speeds = self.speeds.as_slice()?;
        if let Some(row) = positions.iter().position(|p| !is_near(p)) {
            let must = "must be within a million body lengths of the camera";
            return Err(raised(format_args!("positions: row {row} {must}")));
        }
        if let Some(row) = speeds.iter().position(|speed| !speed.is_finite()) {
            return Err(raised(format_args!("speeds: row {row} is not finite")));
        }
        let unit = headings.iter().enumerate().map(|(row, &heading)| {
            direction(heading).ok_or_else(|| {
                raised(format_args!("headings: row {row} must have a direction, not {heading:?}"))
            })
        });
        let unit = unit.collect::<PyResult<Vec<_>>>()?;
        let members =
            Members { position: columns(positions), heading: columns(&unit), speed: speeds.into() };
        let schools = schools(&self.schools, members.len())?;
        Ok(Flock { members, schools })
    }
}

/// Returns a flock as arrays.
pub fn arrays<'py>(py: Python<'py>, flock: &Flock) -> PyResult<FlockArrays<'py>> {
    let Flock { members, schools } = flock;
    let all = 0..members.len();
    let positions = all.clone().map(|member| members.position(member).to_array()).collect();
    let headings = all.map(|member| members.heading(member).to_array()).collect();
    let schools = schools.iter().map(|school| {
        let Range { start, end } = school.members;
        ([start, end], school.leader.into(), school.heading.into(), school.radii.into())
    });
    let speeds = PyArray1::from_slice(py, &members.speed);
    Ok((given(py, positions)?, given(py, headings)?, speeds, schools.collect()))
}

fn schools(given: &[SchoolArguments], members: usize) -> PyResult<Vec<School>> {
    let mut behind = 0;
    let schools = given.iter().enumerate().map(|(i, &([start, end], leader, heading, radii))| {
        let refused = |what: &str| raised(format_args!("school {i}: {what}"));
        if start < behind || end < start || end > members {
            let must = format!("must come after those before them and be among {members}");
            return Err(refused(&format!("members {start} to {end} {must}")));
        }
        behind = end;
        let is_size = |radius: &f32| (0.0..=FARTHEST).contains(radius);
        if !is_near(&leader) || !radii.iter().all(is_size) {
            return Err(refused("leader and radii must be finite, and radii at least 0"));
        }
        let heading = direction(heading).ok_or_else(|| refused("heading must have a direction"))?;
        let [leader, heading, radii] = [leader, heading, radii].map(Into::into);
        Ok(School { members: start..end, leader, heading, radii })
    });
    schools.collect()
}

fn is_near(point: &[f32; 3]) -> bool {
    point.iter().all(|x| x.abs() <= FARTHEST)
}

/// Returns a unit vector; one that has that length is kept bit for bit.
fn direction(heading: [f32; 3]) -> Option<[f32; 3]> {
    let squared = heading.map(|x| f64::from(x) * f64::from(x)).iter().sum::<f64>();
    let length = squared.sqrt();
    match (squared - 1.0).abs() < 1e-6 {
        true => Some(heading),
        false if length.is_finite() && length > 0.0 => {
            Some(heading.map(|x| (f64::from(x) / length) as f32))
        }
        false => None,
    }
}

fn columns(rows: &[[f32; 3]]) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|axis| rows.iter().map(|row| row[axis]).collect())
}
