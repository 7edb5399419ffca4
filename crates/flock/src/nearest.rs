//! View-dependent levels of the nearest members: cuts of the model's multiresolution.
//!
//! A level of a [`LevelTable`](crate::levels::LevelTable) is as fine on the side that the eye does not
//! see as on the other. That is nothing for thousands of members that are each a few pixels wide, but
//! for the few that fill the picture a level of their own pays off: fine where they are near, coarse
//! where they are far or out of the picture.
//!
//! ```
//! use meshlod_flock::levels::{ModelAxes, in_member_frame};
//! use meshlod_flock::nearest::{NearestCuts, NearestOptions};
//! use meshlod_flock::select::InstanceLevel;
//! use meshlod_flock::{FlockCamera, Flock};
//! use meshlod_multires::{Forest, Model};
//! use meshlod_simplify::Options;
//!
//! let mut fish = in_member_frame(&meshlod_samples::fish(4_000), &ModelAxes::FISH)?;
//! fish.attributes = None;
//! let model = Model::new(&Forest::new(&fish, &Options::default())?)?;
//! let cuts = NearestCuts::new(model, NearestOptions { members: 1, ..NearestOptions::default() });
//!
//! let mut flock = Flock::default();
//! flock.members.push([0.0; 3], [0.0, 0.0, 1.0]);
//! flock.members.push([0.0, 0.0, -20.0], [0.0, 0.0, 1.0]);
//! let camera = FlockCamera::look_at([0.5, 0.2, 1.5], [0.0; 3], 0.8, [1920, 1080])?;
//! // As a `Selector` chose them.
//! let levels = [InstanceLevel::drawn(0); 2];
//!
//! for cut in cuts.cuts(&flock, &camera, &levels)? {
//!     // Drawn in place of the member's level, with the member's frame and position.
//!     let mesh = cut.level.mesh();
//!     assert!(cut.member == 0 && mesh.faces.len() < fish.faces.len());
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use meshlod_multires::{Focus, Level, Model, Query, QueryError, Tolerance};
use serde::{Deserialize, Serialize};

use crate::camera::FlockCamera;
use crate::flock::Flock;
use crate::select::InstanceLevel;

/// Cuts of a model's multiresolution for the members nearest to the eye.
#[derive(Clone, Debug)]
pub struct NearestCuts {
    model: Model,
    options: NearestOptions,
}

/// Options for the cuts of the nearest members.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct NearestOptions {
    /// Upper limit of the members that get a cut.
    pub members: usize,
    /// Number of pixels that the error of a cut may span in the middle of the picture.
    pub tolerance_px: f64,
    /// Part of a member that is fine.
    pub focus: CutFocus,
}

/// Part of a member that its cut makes fine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CutFocus {
    /// The part in the view frustum; the rest is as coarse as possible. A shadow of the member may
    /// show that.
    #[default]
    Frustum,
    /// All of it.
    Everything,
}

/// Cut of one member.
#[derive(Clone, Debug)]
pub struct NearCut {
    /// Member that it stands for.
    pub member: usize,
    /// Distance of the member's position from the eye, in body lengths.
    pub distance: f32,
    /// Query that it answers, in the frame of the member.
    pub query: Query<'static>,
    /// Its mesh in the frame of the member: positions and faces, without normals, texture coordinates
    /// or materials, which multiresolution models do not store.
    pub level: Level,
}

impl Default for NearestOptions {
    fn default() -> Self {
        Self { members: 4, tolerance_px: 1.0, focus: CutFocus::default() }
    }
}

impl NearestCuts {
    /// Creates cuts of a model in the frame of a member, as
    /// [`in_member_frame`](crate::levels::in_member_frame) makes it.
    ///
    /// A model comes from a [`Forest`](meshlod_multires::Forest) by [`Model::new`], or from an
    /// [`Archive`](meshlod_multires::Archive) by [`Model::from_implicit`].
    pub fn new(model: Model, options: NearestOptions) -> Self {
        Self { model, options }
    }

    /// Returns the nearest members that are drawn with a level, nearest first; of equally near ones
    /// the first. Members whose position is not finite are left out.
    ///
    /// `levels` has an entry for every member, as a [`Selector`](crate::select::Selector) chooses
    /// them: it hides members outside the frustum. Cost: linear in the members.
    pub fn nearest(
        &self,
        flock: &Flock,
        camera: &FlockCamera,
        levels: &[InstanceLevel],
    ) -> Vec<usize> {
        let drawn = levels.iter().take(flock.members.len()).enumerate();
        let mut found: Vec<(f32, usize)> = drawn
            .filter(|(_, level)| level.level().is_some())
            .map(|(member, _)| (distance(flock, camera, member), member))
            .filter(|(distance, _)| distance.is_finite())
            .collect();
        let order = |a: &(f32, usize), b: &(f32, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let count = self.options.members;
        if count < found.len() {
            found.select_nth_unstable_by(count, order);
            found.truncate(count);
        }
        found.sort_unstable_by(order);
        found.into_iter().map(|(_, member)| member).collect()
    }

    /// Returns the query for a member: the camera in the frame of the member, with the tolerance and
    /// the focus of the options.
    pub fn query(&self, flock: &Flock, camera: &FlockCamera, member: usize) -> Query<'static> {
        let place = (flock.members.position(member), flock.members.heading(member));
        let camera = camera.for_member(place.0, place.1);
        let focus = match self.options.focus {
            CutFocus::Frustum => Focus::Frustum(camera),
            CutFocus::Everything => Focus::Everything,
        };
        Query { focus, tolerance: Tolerance::Pixels { camera, pixels: self.options.tolerance_px } }
    }

    /// Returns the cuts of the nearest members, nearest first. All others keep their levels.
    ///
    /// A cut is the smallest that answers its query. An eye inside a member is no special case: the
    /// member is finest around the eye. Cost: that of
    /// [`Extractor::exact`](meshlod_multires::Extractor::exact) for each cut.
    ///
    /// # Errors
    /// A tolerance that is negative or not a number.
    pub fn cuts(
        &self,
        flock: &Flock,
        camera: &FlockCamera,
        levels: &[InstanceLevel],
    ) -> Result<Vec<NearCut>, QueryError> {
        let mut extractor = self.model.extractor();
        let mut cut = |member: usize| {
            let query = self.query(flock, camera, member);
            let level = extractor.exact(&query)?.clone();
            Ok(NearCut { member, distance: distance(flock, camera, member), query, level })
        };
        self.nearest(flock, camera, levels).into_iter().map(&mut cut).collect()
    }
}

/// Returns the distance of a member's position from the eye, in body lengths.
fn distance(flock: &Flock, camera: &FlockCamera, member: usize) -> f32 {
    flock.members.position(member).distance(camera.eye())
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};
    use meshlod_multires::Forest;
    use meshlod_simplify::Options;

    use super::*;
    use crate::levels::{ModelAxes, in_member_frame};
    use crate::members::frame_of;

    fn cuts(members: usize, focus: CutFocus) -> NearestCuts {
        let mut ball =
            in_member_frame(&meshlod_samples::sphere(4_000), &ModelAxes::default()).unwrap();
        ball.attributes = None;
        let model = Model::new(&Forest::new(&ball, &Options::default()).unwrap()).unwrap();
        NearestCuts::new(model, NearestOptions { members, tolerance_px: 0.5, focus })
    }

    fn camera(eye: Vec3, target: Vec3) -> FlockCamera {
        FlockCamera::look_at(eye.into(), target.into(), 0.8, [160, 90]).unwrap()
    }

    fn flock(positions: &[Vec3], heading: Vec3) -> Flock {
        let mut flock = Flock::default();
        positions.iter().for_each(|p| flock.members.push((*p).into(), heading.into()));
        flock
    }

    /// Number of faces whose middle is more than `from` along a direction.
    fn faces_along(cut: &NearCut, way: Vec3, from: f64) -> usize {
        let mesh = cut.level.mesh();
        let middle = |face: &[meshlod_mesh::VertexId; 3]| {
            mesh.triangle(*face).into_iter().sum::<DVec3>() / 3.0
        };
        mesh.faces.iter().filter(|face| middle(face).dot(way.as_dvec3()) > from).count()
    }

    #[test]
    fn the_side_that_faces_the_eye_is_finer() {
        let cuts = cuts(1, CutFocus::Everything);
        for heading in [Vec3::Z, Vec3::new(0.6, 0.48, -0.64)] {
            let (place, side) = (Vec3::new(2.0, -3.0, 5.0), Vec3::new(0.8, 0.0, 0.6));
            let flock = flock(&[place], heading);
            let eye = place + frame_of(heading) * side * 0.75;
            let levels = [InstanceLevel::drawn(0)];
            let cut = &cuts.cuts(&flock, &camera(eye, place), &levels).unwrap()[0];
            assert!((cut.distance - 0.75).abs() < 1e-5);
            let [near, far] = [side, -side].map(|way| faces_along(cut, way, 0.1));
            assert!(near > 2 * far && far > 4, "{near} {far}");
        }
    }

    #[test]
    fn only_the_nearest_drawn_members_get_cuts() {
        let cuts = cuts(2, CutFocus::Frustum);
        let places = [9.0, 3.0, 1.5, 2.0, 4.0, f32::NAN].map(|z| Vec3::new(0.0, 0.0, -z));
        let flock = flock(&places, Vec3::X);
        let mut levels = [InstanceLevel::drawn(3); 6];
        levels[2] = InstanceLevel::HIDDEN;
        levels[3] = InstanceLevel::IMPOSTOR;
        let camera = camera(Vec3::ZERO, Vec3::NEG_Z);
        let found = cuts.cuts(&flock, &camera, &levels).unwrap();
        assert_eq!(found.iter().map(|cut| cut.member).collect::<Vec<_>>(), [1, 4]);
        assert!(found[0].level.faces.len() > found[1].level.faces.len());
        assert_eq!(cuts.nearest(&flock, &camera, &levels[..2]), [1, 0]);
    }

    #[test]
    fn an_eye_inside_a_member_sees_what_is_before_it() {
        let flock = flock(&[Vec3::ZERO], Vec3::Z);
        let camera = camera(Vec3::ZERO, Vec3::X);
        let levels = [InstanceLevel::drawn(0)];
        let counts = [CutFocus::Frustum, CutFocus::Everything].map(|focus| {
            let found = cuts(3, focus).cuts(&flock, &camera, &levels).unwrap();
            [Vec3::X, Vec3::NEG_X].map(|way| faces_along(&found[0], way, 0.35))
        });
        let [[before, behind], [all_before, all_behind]] = counts;
        assert!(before > 3 * behind, "{counts:?}");
        assert!(all_behind > all_before / 2 && all_before >= before / 2, "{counts:?}");
    }

    #[test]
    fn without_members_there_are_no_cuts() {
        let cuts = cuts(4, CutFocus::Frustum);
        let camera = camera(Vec3::ZERO, Vec3::X);
        assert!(cuts.cuts(&Flock::default(), &camera, &[]).unwrap().is_empty());
        let none = NearestCuts::new(cuts.model, NearestOptions { members: 0, ..cuts.options });
        let flock = flock(&[Vec3::X], Vec3::X);
        let found = none.cuts(&flock, &camera, &[InstanceLevel::drawn(0)]).unwrap();
        assert!(found.is_empty());
    }

    #[test]
    fn the_camera_of_a_member_sees_what_the_camera_sees() {
        let (place, heading) = (Vec3::new(4.0, 1.0, 2.0), Vec3::new(0.48, 0.6, -0.64));
        let camera = camera(Vec3::new(1.0, 2.0, 9.0), place);
        let seen = camera.for_member(place, heading);
        let eye = DVec3::from(seen.eye).as_vec3();
        assert!((frame_of(heading) * eye + place - camera.eye()).length() < 1e-5);
        let forward = (DVec3::from(seen.look) - DVec3::from(seen.eye)).normalize();
        assert!((forward + DVec3::from(seen.eye).normalize()).length() < 1e-5, "at the member");
        assert!((seen.pixel() * f64::from(camera.pixels_at_one()) - 1.0).abs() < 1e-6);
    }
}
