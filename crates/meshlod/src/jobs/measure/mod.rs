//! Distance between two scenes, with their areas and volumes.

mod farthest;

use meshlod_io::Scene;
use meshlod_measure::{
    CertifiedDistance, CertifiedOptions, Distance, DistanceOptions, PreparedSurface, area,
    certified_surface_distance, surface_distance, volume,
};
use meshlod_mesh::{Connectivity, Mesh};

use crate::jobs::scene_run::own_surface;
use crate::jobs::{JobError, Watch, begin};

pub use farthest::FarthestPose;

/// Request to measure the distance between two scenes; see [`measure`].
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct MeasureRequest {
    /// Number of samples on each surface, in addition to all vertices.
    pub samples: usize,
    /// Seed of the random samples.
    pub seed: u64,
    /// True to prove the maximum distance too, to within 1%.
    pub certified: bool,
    /// Maximum number of poses of the animations of A in which to look for the greatest distance;
    /// `None` to measure the scenes as their nodes stand.
    pub poses: Option<usize>,
}

impl Default for MeasureRequest {
    fn default() -> Self {
        let DistanceOptions { samples, seed } = DistanceOptions::default();
        Self { samples, seed, certified: false, poses: None }
    }
}

/// Report of [`measure`]. Lengths are in the units of the scenes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MeasureReport {
    /// Distance from A to B and back. Serde writes percentages of the diagonal, too.
    #[cfg_attr(feature = "serde", serde(flatten))]
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::jobs::figures::distance"))]
    pub distance: Distance,
    /// Bounds of its maximum, if a proof was asked for.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "serde", serde(serialize_with = "crate::jobs::figures::certified"))]
    pub certified: Option<CertifiedDistance>,
    /// Area of A.
    pub area_a: f64,
    /// Volume that A encloses, if it is closed.
    pub volume_a: f64,
    /// True if A has no boundary.
    pub closed_a: bool,
    /// Area of B.
    pub area_b: f64,
    /// Volume that B encloses, if it is closed.
    pub volume_b: f64,
    /// True if B has no boundary.
    pub closed_b: bool,
    /// Change of the area as a part of that of A; `None` if that is zero.
    pub area_change: Option<f64>,
    /// Change of the volume as a part of that of A; `None` unless both are closed.
    pub volume_change: Option<f64>,
    /// Pose in which all of this was measured, if poses were asked for.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub pose: Option<FarthestPose>,
}

/// Measures the distance between the surfaces of two scenes in both directions, and the change of
/// area and volume from A to B.
///
/// With [`poses`](MeasureRequest::poses), B must be a level of A: both are posed alike, and
/// measured in the pose in which they are farthest apart.
///
/// Cost: O((samples + vertices + faces) log faces) a pose; in parallel.
///
/// # Errors
/// A surface without area: of A it is [`JobError::Input`], of B [`JobError::Second`]. No samples,
/// no animations, and animations or nodes that differ.
///
/// ```
/// use meshlod::jobs::{MeasureRequest, measure};
/// use meshlod::{Scene, samples};
///
/// let [fine, coarse] = [4_000, 400].map(|faces| Scene::from_mesh("", samples::torus(faces)));
/// let request = MeasureRequest { samples: 10_000, ..MeasureRequest::default() };
/// let report = measure(&fine, &coarse, &request, &())?;
/// assert!(report.distance.percent(report.distance.max()) < 2.0);
/// assert!(report.volume_change.unwrap() < 0.0, "the coarse torus is inside the fine one");
/// # Ok::<(), meshlod::jobs::JobError>(())
/// ```
pub fn measure(
    a: &Scene,
    b: &Scene,
    request: &MeasureRequest,
    watch: &dyn Watch,
) -> Result<MeasureReport, JobError> {
    begin(watch, "measuring")?;
    let (surfaces, pose) = match request.poses {
        None => ([a, b].map(own_surface), None),
        Some(most) => farthest::pose([a, b], most, request, watch)
            .map(|(surfaces, pose)| (surfaces, Some(pose)))?,
    };
    let ready = prepared(&surfaces)?;
    let distance = apart(&ready, request)?;
    let certified = match request.certified {
        false => None,
        true => {
            begin(watch, "certifying")?;
            let options = CertifiedOptions::default();
            Some(certified_surface_distance(&ready[0], &ready[1], &options))
        }
    };
    drop(ready);
    Ok(report(&surfaces, (distance, certified), pose))
}

/// Prepares the surfaces of A and B.
fn prepared(surfaces: &[Mesh; 2]) -> Result<[PreparedSurface<'_>; 2], JobError> {
    let a = PreparedSurface::new(&surfaces[0]).map_err(JobError::input)?;
    let b = PreparedSurface::new(&surfaces[1]).map_err(JobError::second)?;
    Ok([a, b])
}

fn apart(
    [a, b]: &[PreparedSurface<'_>; 2],
    request: &MeasureRequest,
) -> Result<Distance, JobError> {
    let options = DistanceOptions { samples: request.samples, seed: request.seed };
    surface_distance(a, b, &options).map_err(|error| JobError::request("", error))
}

fn report(
    surfaces: &[Mesh; 2],
    (distance, certified): (Distance, Option<CertifiedDistance>),
    pose: Option<FarthestPose>,
) -> MeasureReport {
    let [areas, volumes] = [area, volume].map(|size| surfaces.each_ref().map(size));
    let closed = surfaces.each_ref().map(is_closed);
    MeasureReport {
        distance,
        certified,
        area_a: areas[0],
        volume_a: volumes[0],
        closed_a: closed[0],
        area_b: areas[1],
        volume_b: volumes[1],
        closed_b: closed[1],
        area_change: relative(areas),
        volume_change: relative(volumes).filter(|_| closed == [true; 2]),
        pose,
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

#[cfg(test)]
mod tests {
    use meshlod_fixtures::folding_strip;
    use meshlod_io::Weld;
    use meshlod_samples as samples;

    use super::*;

    fn request(poses: Option<usize>) -> MeasureRequest {
        MeasureRequest { samples: 1_000, poses, ..MeasureRequest::default() }
    }

    fn torus() -> Scene {
        Scene::from_mesh("torus", samples::torus(400))
    }

    #[test]
    fn an_error_tells_which_of_the_two_is_at_fault() {
        let (none, torus) = (Scene::default(), torus());
        let measured = |a: &Scene, b: &Scene| measure(a, b, &request(None), &());
        assert!(matches!(measured(&none, &torus), Err(JobError::Input(_))));
        assert!(matches!(measured(&torus, &none), Err(JobError::Second(_))));
    }

    #[test]
    fn only_scenes_that_move_alike_are_posed() {
        let folding = meshlod_io::gltf::read(&folding_strip(40), &mut |_| None, Weld::Exact);
        let folding = folding.unwrap();
        let report = measure(&folding, &folding, &request(Some(8)), &()).unwrap();
        assert!(report.distance.max() < 1e-6 && report.pose.unwrap().measured > 1);
        let why =
            |a: &Scene, b: &Scene| measure(a, b, &request(Some(8)), &()).unwrap_err().to_string();
        assert_eq!(why(&torus(), &folding), "A has no animations");
        assert_eq!(why(&folding, &torus()), "B has no animations");
        let more =
            Scene { nodes: [&folding.nodes[..], &torus().nodes].concat(), ..folding.clone() };
        assert!(why(&folding, &more).starts_with("both need the same nodes"));
    }
}
