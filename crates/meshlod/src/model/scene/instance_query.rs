//! Queries about a scene whose meshes are shown in other places than those that their levels have.

use glam::{DMat3, DMat4, DVec3};
use meshlod_io::MeshInstance;
use meshlod_mesh::{Bounds, Mesh};
use meshlod_multires::{
    FileError, Focus, Ground, GroundShape, ModelFile, Query, Source, Tolerance, ViewCamera,
};
use meshlod_spatial::closest_point;
use thiserror::Error;

use super::placement::stretch;
use super::{ModelScene, ModelSceneError};

/// Maximum number of instances of a mesh that are queried separately; beyond that, the strictest
/// tolerance applies to the whole mesh.
const MOST_PLACES: usize = 1024;
/// Part of the diagonal of a mesh by which its levels may be larger than its finest one.
const MARGIN: f64 = 0.25;
/// Condition number above which a transform is no similarity.
const SIMILAR: f64 = 1.0 + 1e-9;

/// Reason why a query about a scene cannot be put to the levels of its meshes.
#[derive(Debug, Error)]
pub enum SceneQueryError {
    /// An invalid query, or a damaged file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The scene does not fit its levels.
    #[error(transparent)]
    Scene(#[from] ModelSceneError),
}

impl ModelScene {
    /// Translates a query about the scene into one about the levels of its meshes, each in its own
    /// place.
    ///
    /// Where a mesh is shown several times, **its levels are as fine as the most demanding of its
    /// instances needs**, wherever these are: regions and cameras are moved into the place of the
    /// levels, and lengths scaled. A region that a turned or unevenly scaled instance distorts is
    /// enlarged. A point is the closest one that the scene shows, and comes back where the levels
    /// have it. A tolerance that is a field, and all queries about scenes that
    /// [are flat](Self::is_flat), stay as they are but for points, which
    /// [`ModelFile::at_surface`] moves. With `max_faces`, a number of faces is asked for.
    ///
    /// Cost: linear in the number of instances; where they are not where the levels are, that of
    /// reading the finest level, and for a point linear in the faces that the scene shows.
    /// # Errors
    /// An invalid query, or a damaged file.
    pub fn query_of_levels<'f, S: Source>(
        &self,
        file: &ModelFile<S>,
        query: &Query<'f>,
        max_faces: Option<usize>,
    ) -> Result<(Query<'f>, Option<[f64; 3]>), SceneQueryError> {
        query.validate().map_err(FileError::from)?;
        // What holds for the largest instance, which the levels have, holds for all.
        let is_alike = query.is_everywhere() && matches!(query.tolerance, Tolerance::Uniform(_));
        let is_kept = matches!(query.tolerance, Tolerance::Field(_) | Tolerance::Each(_));
        if self.is_flat() || is_alike || is_kept {
            return Ok(file.at_surface(query, max_faces)?);
        }
        let level = file.extract(&Query::finest())?.level.mesh();
        let shown = self.clone().into_scene("", level)?;
        let meshes: Vec<&Mesh> = shown.meshes.iter().map(|mesh| &mesh.mesh).collect();
        let places = self.places(&shown.instances());
        Ok(match query.focus {
            Focus::Point(point) => at_point(&meshes, &places, query, (point, max_faces)),
            _ => (in_all_places(&meshes, &places, query), None),
        })
    }

    /// Returns every place where a mesh of the levels is shown, without those where it is a point.
    fn places(&self, instances: &[MeshInstance]) -> Vec<InstancePlace> {
        let place = |instance: &MeshInstance| {
            let entry = self.head.meshes.get(instance.mesh)?.as_ref()?;
            let [placement, world] =
                [entry.placement, instance.transform].map(|t| DMat4::from_cols_array_2d(&t));
            let place = InstancePlace::new(instance.mesh, placement, world);
            (place.growth > 0.0).then_some(place)
        };
        instances.iter().filter_map(place).collect()
    }
}

/// Place where the scene shows a mesh.
struct InstancePlace {
    mesh: usize,
    /// Transforms from the mesh's own space to that of the levels, and to that of the scene.
    placement: DMat4,
    world: DMat4,
    /// Transform from the space of the scene to that of the levels; `None` of a flat instance.
    to_levels: Option<DMat4>,
    /// Largest factors by which a length grows from the levels to the scene, and back.
    growth: f64,
    growth_back: f64,
}

impl InstancePlace {
    fn new(mesh: usize, placement: DMat4, world: DMat4) -> Self {
        let (out, to_levels) = match placement == world {
            true => (DMat4::IDENTITY, DMat4::IDENTITY),
            false => (world * placement.inverse(), placement * world.inverse()),
        };
        let growth_back = stretch(to_levels);
        let can_go_back = to_levels.is_finite() && growth_back.is_finite();
        let to_levels = can_go_back.then_some(to_levels);
        Self { mesh, placement, world, to_levels, growth: stretch(out), growth_back }
    }

    /// Returns true if the scene shows the mesh at its place in the levels.
    fn is_of_levels(&self) -> bool {
        self.to_levels == Some(DMat4::IDENTITY)
    }

    fn is_similar(&self) -> bool {
        self.growth * self.growth_back <= SIMILAR
    }

    /// Returns what a query about the scene asks of the levels here. The mesh's own box is `own`.
    fn query<'f>(&self, query: &Query<'f>, own: &Bounds) -> Query<'f> {
        let Some(to_levels) = self.to_levels else {
            let most = match &query.tolerance {
                Tolerance::Pixels { camera, pixels } => {
                    let eye = DVec3::from(camera.eye);
                    let shown = moved(own, &self.world);
                    let [min, max] = [shown.min, shown.max].map(DVec3::from);
                    pixels * camera.pixel() * eye.distance(eye.clamp(min, max))
                }
                Tolerance::Uniform(most) => *most,
                Tolerance::Field(_) | Tolerance::Each(_) => 0.0,
            };
            return Query::uniform(most / self.growth);
        };
        let tolerance = match &query.tolerance {
            Tolerance::Uniform(most) => Tolerance::Uniform(most / self.growth),
            Tolerance::Pixels { camera, pixels } => Tolerance::Pixels {
                camera: moved_camera(camera, &to_levels, self.is_similar()),
                pixels: pixels / (self.growth * self.growth_back).max(1.0),
            },
            other => other.clone(),
        };
        Query { focus: self.focus(&query.focus, &to_levels), tolerance }
    }

    /// Returns a region of the levels that holds a focus of the scene.
    fn focus(&self, focus: &Focus, to_levels: &DMat4) -> Focus {
        let point = |p: [f64; 3]| to_levels.transform_point3(p.into()).to_array();
        match focus {
            Focus::Point(at) => Focus::Point(point(*at)),
            Focus::Segment(ends) => Focus::Segment(ends.map(point)),
            Focus::Box([min, max]) => {
                let Bounds { min, max } = moved(&Bounds { min: *min, max: *max }, to_levels);
                Focus::Box([min, max])
            }
            Focus::Sphere { center, radius } => {
                Focus::Sphere { center: point(*center), radius: radius * self.growth_back }
            }
            Focus::Frustum(camera) if self.is_similar() => {
                Focus::Frustum(moved_camera(camera, to_levels, true))
            }
            Focus::Ground(ground) => moved_ground(ground, to_levels),
            Focus::Frustum(_) | Focus::Everything => Focus::Everything,
        }
    }
}

/// Returns the union of a query in all places, each mesh for itself.
///
/// Meshes that are shown nowhere but where the levels are share the query as it is.
fn in_all_places<'f>(meshes: &[&Mesh], places: &[InstancePlace], query: &Query<'f>) -> Query<'f> {
    let mut of_meshes: Vec<Vec<&InstancePlace>> = meshes.iter().map(|_| Vec::new()).collect();
    places.iter().for_each(|place| of_meshes[place.mesh].push(place));
    let is_moved = |here: &[&InstancePlace]| here.iter().any(|place| !place.is_of_levels());
    let of_mesh = |(index, mesh): (usize, &&Mesh)| {
        let here = &of_meshes[index];
        if !is_moved(here) {
            return None;
        }
        let own = Some(mesh.bounds()).filter(|own| !own.is_empty())?;
        let around = enlarged(moved(&own, &here[0].placement));
        let asked = here.iter().map(|place| place.query(query, &own));
        let asked = needed(asked.filter(|asked| asked.focus.may_meet(&around)).collect(), &around);
        let focus = Focus::Box([around.min, around.max]);
        // The only mesh needs no box that keeps it apart.
        let focus = if meshes.len() == 1 { Focus::Everything } else { focus };
        Some(Query { focus, tolerance: Tolerance::Each(asked) })
    };
    let mut each: Vec<_> = meshes.iter().enumerate().filter_map(of_mesh).collect();
    if of_meshes.iter().any(|here| !here.is_empty() && !is_moved(here)) {
        each.push(query.clone());
    }
    Query { focus: Focus::Everything, tolerance: Tolerance::Each(each) }
}

/// Returns the queries about one mesh, in this box, without those that others imply; one for all if
/// they are too many.
fn needed<'f>(asked: Vec<Query<'f>>, around: &Bounds) -> Vec<Query<'f>> {
    let ranges: Vec<[f64; 2]> =
        asked.iter().map(|query| tolerances(&query.tolerance, around)).collect();
    let everywhere = asked.iter().zip(&ranges).filter(|(query, _)| query.is_everywhere());
    let enough = everywhere.map(|(_, range)| range[1]).fold(f64::INFINITY, f64::min);
    let least = ranges.iter().map(|range| range[0]).fold(f64::INFINITY, f64::min);
    let pairs = asked.into_iter().zip(ranges);
    let kept: Vec<Query<'f>> =
        pairs.filter(|(_, range)| range[0] <= enough).map(|(query, _)| query).collect();
    if kept.len() > MOST_PLACES { vec![Query::uniform(least)] } else { kept }
}

/// Returns the least and the greatest tolerance in a box.
fn tolerances(tolerance: &Tolerance<'_>, around: &Bounds) -> [f64; 2] {
    match tolerance {
        Tolerance::Uniform(most) => [*most; 2],
        Tolerance::Pixels { camera, pixels } => {
            let eye = DVec3::from(camera.eye);
            let [min, max] = [around.min, around.max].map(DVec3::from);
            let near = eye.distance(eye.clamp(min, max));
            let far = (eye - min).abs().max((eye - max).abs()).length();
            [near, far].map(|away| pixels * camera.pixel() * away)
        }
        Tolerance::Field(_) | Tolerance::Each(_) => [0.0, f64::INFINITY],
    }
}

/// Returns a query at the scene point closest to `point`, and that point in the space of the levels.
fn at_point<'f>(
    meshes: &[&Mesh],
    places: &[InstancePlace],
    query: &Query<'f>,
    (point, max_faces): ([f64; 3], Option<usize>),
) -> (Query<'f>, Option<[f64; 3]>) {
    let to = DVec3::from(point);
    let mut best: Option<(f64, DVec3, &InstancePlace)> = None;
    for place in places.iter().filter(|place| place.to_levels.is_some()) {
        let mesh = meshes[place.mesh];
        for &face in &mesh.faces {
            let corners = mesh.triangle(face).map(|at| place.world.transform_point3(at));
            let on_face = closest_point(to, &corners);
            let away = on_face.distance_squared(to);
            if best.is_none_or(|(least, ..)| away < least) {
                best = Some((away, on_face, place));
            }
        }
    }
    let Some((place, on_face, to_levels)) =
        best.and_then(|(_, at, place)| Some((place, at, place.to_levels?)))
    else {
        return (query.clone(), None);
    };
    let center = to_levels.transform_point3(on_face).to_array();
    let tolerance = place.query(query, &meshes[place.mesh].bounds()).tolerance;
    let focus = match tolerance {
        Tolerance::Uniform(radius) if radius.is_finite() && max_faces.is_none() => {
            Focus::Sphere { center, radius }
        }
        _ => Focus::Point(center),
    };
    (Query { focus, tolerance }, Some(center))
}

fn moved_camera(camera: &ViewCamera, by: &DMat4, is_similar: bool) -> ViewCamera {
    let eye = by.transform_point3(camera.eye.into());
    let mut ahead = DVec3::from(camera.look) - DVec3::from(camera.eye);
    let mut up = DVec3::from(camera.up);
    if is_similar {
        [ahead, up] = [ahead, up].map(|along| by.transform_vector3(along.normalize_or_zero()));
    }
    // As far away as the eye, so that the direction is not rounded away.
    let look = eye + ahead.normalize_or_zero() * eye.length().max(1.0);
    let [eye, look, up] = [eye, look, up.normalize_or_zero()].map(|at| at.to_array());
    ViewCamera { eye, look, up, ..*camera }
}

/// Returns a region that holds a moved one over the ground.
fn moved_ground(ground: &Ground, by: &DMat4) -> Focus {
    let up = ground.up;
    let linear = DMat3::from_mat4(*by);
    let is_vertical = |axis: usize| (0..3).all(|k| k == axis || linear.col(axis)[k].abs() == 0.0);
    let keeps_up = is_vertical(up) && (0..3).all(|k| k == up || linear.col(k)[up].abs() == 0.0);
    if !keeps_up {
        return Focus::Everything;
    }
    let across = [[1, 2], [0, 2], [0, 1]][up];
    let point = |place: [f64; 2]| {
        let mut at = DVec3::ZERO;
        (at[across[0]], at[across[1]]) = (place[0], place[1]);
        let at = by.transform_point3(at);
        across.map(|axis| at[axis])
    };
    let shape = match ground.shape {
        GroundShape::Line(ends) => GroundShape::Line(ends.map(point)),
        GroundShape::Box([[x, y], [u, v]]) => {
            let corners = [[x, y], [u, y], [x, v], [u, v]].map(point);
            let ends = [0, 1].map(|k| {
                let along = corners.map(|corner| corner[k]);
                [
                    along.into_iter().fold(f64::INFINITY, f64::min),
                    along.into_iter().fold(f64::NEG_INFINITY, f64::max),
                ]
            });
            GroundShape::Box([[ends[0][0], ends[1][0]], [ends[0][1], ends[1][1]]])
        }
    };
    Focus::Ground(Ground { up, shape })
}

/// Returns a box around a moved box.
fn moved(bounds: &Bounds, by: &DMat4) -> Bounds {
    let corner = |i: usize| {
        let pick = |k: usize| if i >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] };
        by.transform_point3(DVec3::new(pick(0), pick(1), pick(2))).to_array()
    };
    Bounds::of(&std::array::from_fn::<_, 8, _>(corner))
}

fn enlarged(bounds: Bounds) -> Bounds {
    let more = MARGIN * bounds.diagonal();
    Bounds { min: bounds.min.map(|x| x - more), max: bounds.max.map(|x| x + more) }
}

#[cfg(test)]
mod tests;
