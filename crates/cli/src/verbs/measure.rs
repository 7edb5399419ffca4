//! `measure`: measures the distance between two meshes and the change of area and volume.

use std::path::PathBuf;

use clap::Args;
use meshlod::jobs::figures::DistanceFigures;
use meshlod::measure::{
    CertifiedOptions, area, certified_surface_distance, surface_distance, volume,
};
use meshlod::mesh::Connectivity;
use meshlod::{Mesh, Scene};
use serde::Serialize;

use crate::options::args::{ReadArgs, SamplingArgs};
use crate::options::parse;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::distance::{self, CertifiedFigures};
use crate::text::numbers::{change, value};
use crate::text::poses::{FarthestFigures, FarthestPose};
use crate::text::table::aligned;

/// Measure the distance between two meshes, both ways
#[derive(Args)]
pub struct Measure {
    /// The original: forward distances start on it, and percentages refer to its diagonal
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The mesh to compare with it
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Also prove the maximum distance, to within 1%
    ///
    /// It is enclosed between a lower and an upper bound by dividing faces until none can reach
    /// farther: a proof, where samples may miss a peak.
    #[arg(long)]
    certified: bool,
    /// Measure in N poses of the animations of A
    ///
    /// At key times and, if N is large enough, between them; reports the pose in which the two are
    /// farthest apart. B must be a level of A.
    #[arg(long, value_name = "N", value_parser = parse::positive, allow_negative_numbers = true)]
    poses: Option<usize>,
    #[command(flatten)]
    sampling: SamplingArgs,
    #[command(flatten)]
    reading: ReadArgs,
}

/// Figures of a measurement for programs.
#[derive(Serialize)]
struct MeasureFigures {
    #[serde(flatten)]
    distance: DistanceFigures,
    #[serde(skip_serializing_if = "Option::is_none")]
    certified: Option<CertifiedFigures>,
    area_a: f64,
    volume_a: f64,
    closed_a: bool,
    area_b: f64,
    volume_b: f64,
    closed_b: bool,
    /// Relative; `None` if the area of A is zero.
    area_change: Option<f64>,
    /// Relative; `None` unless both are closed.
    volume_change: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pose: Option<FarthestFigures>,
}

impl Measure {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        if files::is_pipe(&self.a) && files::is_pipe(&self.b) {
            return Err(Failure::usage("-: only one of the two meshes can be standard input"));
        }
        let [a, b] = [&self.a, &self.b].map(|path| files::read(path, &self.reading, session));
        let scenes = [a?, b?];
        session.progress.stage("measuring");
        let (a, b, pose) = self.surfaces(&scenes, session)?;
        let surfaces = (distance::ready(&a, &self.a)?, distance::ready(&b, &self.b)?);
        let apart = surface_distance(&surfaces.0, &surfaces.1, &self.sampling.options())
            .map_err(Failure::new)?;
        let certified = self.certified.then(|| {
            session.progress.stage("certifying");
            let options = CertifiedOptions::default();
            certified_surface_distance(&surfaces.0, &surfaces.1, &options)
        });
        let (areas, volumes) = ([area(&a), area(&b)], [volume(&a), volume(&b)]);
        let closed = [is_closed(&a), is_closed(&b)];

        let figures = MeasureFigures {
            distance: (&apart).into(),
            certified: certified.as_ref().map(CertifiedFigures::from),
            area_a: areas[0],
            volume_a: volumes[0],
            closed_a: closed[0],
            area_b: areas[1],
            volume_b: volumes[1],
            closed_b: closed[1],
            area_change: relative(areas),
            volume_change: relative(volumes).filter(|_| closed == [true; 2]),
            pose: pose.as_ref().map(FarthestPose::figures),
        };
        let row = |name: &str, [a, b]: [f64; 2]| [name.into(), value(a), value(b), change(a, b)];
        let text = format!(
            "{}{}{}diagonal {}\n\n{}{}",
            pose.map(|pose| pose.to_text()).unwrap_or_default(),
            distance::to_table(&apart),
            certified.as_ref().map(distance::certified_table).unwrap_or_default(),
            value(apart.diagonal),
            aligned(&[
                ["", "A", "B", "change"].map(String::from),
                row("area", areas),
                row("volume", volumes),
            ]),
            open_note(closed),
        );
        Ok(Answer::new(figures, text))
    }

    /// Returns the surfaces of both scenes, as they are or in the pose that keeps them farthest apart.
    fn surfaces(
        &self,
        scenes: &[Scene; 2],
        session: &Session,
    ) -> Result<(Mesh, Mesh, Option<FarthestPose>), Failure> {
        let Some(most) = self.poses else {
            let [a, b] =
                scenes.each_ref().map(|scene| distance::surface_of(scene, distance::meshes(scene)));
            return Ok((a, b, None));
        };
        let options = self.sampling.options();
        let paths = [self.a.as_path(), &self.b];
        let mut pose = FarthestPose::of(scenes.each_ref(), paths, (most, &options), session)?;
        let [a, b] = std::mem::take(&mut pose.meshes);
        Ok((a, b, Some(pose)))
    }
}

fn is_closed(mesh: &Mesh) -> bool {
    Connectivity::new(&mesh.faces, mesh.positions.len()).is_closed()
}

/// Returns the relative change of a quantity; `None` if it was zero.
fn relative([before, after]: [f64; 2]) -> Option<f64> {
    let change = (after - before) / before.abs();
    change.is_finite().then_some(change)
}

/// Returns a line that names the meshes that are not closed.
fn open_note(closed: [bool; 2]) -> &'static str {
    match closed {
        [true, true] => "",
        [false, true] => "A is open: its volume is not that of a closed surface\n",
        [true, false] => "B is open: its volume is not that of a closed surface\n",
        [false, false] => "both are open: the volumes are not those of closed surfaces\n",
    }
}
