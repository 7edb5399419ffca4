//! Distance between two scenes, with their areas and volumes.

mod farthest;

use meshlod_io::Scene;
use meshlod_measure::{
    CertifiedDistance, CertifiedOptions, Distance, DistanceOptions, PreparedSurface, area,
    certified_surface_distance, surface_distance, volume,
};
use meshlod_mesh::{Connectivity, Mesh};

use crate::jobs::copies::Copies;
use crate::jobs::faceless::refuse_points;
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
/// Meshes that A shows many times and B in the same places are measured once, each against its own
/// level, unless the maximum is to be proved.
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
    refuse_points(a)?;
    refuse_points(b).map_err(JobError::second)?;
    begin(watch, "measuring")?;
    if let Some(report) = of_copies([a, b], request)? {
        return Ok(report);
    }
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
    Ok(report(surfaces.each_ref().map(Sizes::of), (distance, certified), pose))
}

/// Measures two scenes that show as many meshes in the same places, each many times; `None` for
/// others.
fn of_copies(
    scenes: [&Scene; 2],
    request: &MeasureRequest,
) -> Result<Option<MeasureReport>, JobError> {
    // A proof is of all that is shown.
    if request.poses.is_some() || request.certified {
        return Ok(None);
    }
    let [a, b] = scenes;
    let copies = Copies::of(a).and_then(|copies| Some((copies.counterparts(b)?, copies)));
    let Some((theirs, copies)) = copies else { return Ok(None) };
    let own = |i: usize| &a.meshes[i].mesh;
    let their = |i: usize| &b.meshes[theirs[i]].mesh;
    let prepared = copies.prepare(own).and_then(|own| Some((own, copies.prepare(their)?)));
    let Some((a, b)) = prepared else { return Ok(None) };
    let options = DistanceOptions { samples: request.samples, seed: request.seed };
    let distance = copies.apart([&a, &b], &options);
    let distance = distance.map_err(|error| JobError::request("", error))?;
    let sizes = [&own as &dyn Fn(usize) -> _, &their].map(|of: &dyn Fn(usize) -> _| Sizes {
        area: copies.sum(|i| area(of(i)), 2),
        volume: copies.sum(|i| volume(of(i)), 3),
        is_closed: copies.all(|i| is_closed(of(i))),
    });
    Ok(Some(report(sizes, (distance, None), None)))
}

/// Area and volume of a surface.
struct Sizes {
    area: f64,
    volume: f64,
    is_closed: bool,
}

impl Sizes {
    fn of(mesh: &Mesh) -> Self {
        Self { area: area(mesh), volume: volume(mesh), is_closed: is_closed(mesh) }
    }
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
    [a, b]: [Sizes; 2],
    (distance, certified): (Distance, Option<CertifiedDistance>),
    pose: Option<FarthestPose>,
) -> MeasureReport {
    MeasureReport {
        distance,
        certified,
        area_a: a.area,
        volume_a: a.volume,
        closed_a: a.is_closed,
        area_b: b.area,
        volume_b: b.volume,
        closed_b: b.is_closed,
        area_change: relative([a.area, b.area]),
        volume_change: relative([a.volume, b.volume]).filter(|_| a.is_closed && b.is_closed),
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

    /// A scene of a mesh and copies of it, scaled and far apart.
    fn flock(faces: usize) -> Scene {
        let mut scene = Scene::from_mesh("torus", samples::torus(faces));
        let node = scene.nodes[0].clone();
        for i in 1..6u8 {
            let (scale, x) = (f64::from(i), 100.0 * f64::from(i));
            let transform = [
                [0.0, scale, 0.0, 0.0],
                [-scale, 0.0, 0.0, 0.0],
                [0.0, 0.0, scale, 0.0],
                [x, 0.0, 0.0, 1.0],
            ];
            scene.roots.push(scene.nodes.len());
            scene.nodes.push(meshlod_io::Node { transform, ..node.clone() });
        }
        scene
    }

    #[test]
    fn copies_are_measured_once_and_as_they_are_shown() {
        let [a, b] = [2_000, 200].map(flock);
        let [merged_a, merged_b] = [&a, &b].map(|scene| Scene::from_mesh("", scene.flatten()));
        let request = MeasureRequest { samples: 50_000, ..Default::default() };
        assert!(Copies::of(&a).is_some());
        let once = measure(&a, &b, &request, &()).unwrap();
        let all = measure(&merged_a, &merged_b, &request, &()).unwrap();
        let near = |a: f64, b: f64, within: f64| assert!((a / b - 1.0).abs() < within, "{a} {b}");
        near(once.distance.diagonal, all.distance.diagonal, 1e-9);
        near(once.distance.forward.max, all.distance.forward.max, 0.02);
        near(once.distance.backward.max, all.distance.backward.max, 0.02);
        near(once.distance.mean(), all.distance.mean(), 0.02);
        near(once.distance.rms(), all.distance.rms(), 0.02);
        near(once.area_b, all.area_b, 1e-9);
        near(once.volume_a, all.volume_a, 1e-9);
        let place = once.distance.forward.place;
        assert_eq!(merged_b.meshes[0].mesh.faces.len(), 6 * b.meshes[0].mesh.faces.len());
        let face = merged_b.meshes[0].mesh.faces[place.face.index()];
        let triangle = merged_b.meshes[0].mesh.triangle(face);
        let there = meshlod_spatial::closest_point(place.to.into(), &triangle);
        assert!(there.distance(place.to.into()) < 1e-6, "{place:?}");
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
