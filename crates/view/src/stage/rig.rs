//! Camera that orbits a point, flies, and moves smoothly from place to place; turns as in Blender.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::{DVec2, DVec3};
use meshlod::mesh::Bounds;
use meshlod::picture::{Camera, UpAxis, View};

use super::pose::{Flight, RigPose, Side};

/// Camera that looks at a target from a distance, on a turntable whose axis is "up".
#[derive(Clone, Debug, PartialEq)]
pub struct CameraRig {
    pose: RigPose,
    up: UpAxis,
    fov_rad: f64,
    flight: Option<Flight>,
}

/// Duration of a smooth move, in seconds.
const FLIGHT_SECONDS: f64 = 0.35;
/// Part of the picture's width or height that a framed object fills.
const FILL: f64 = 0.8;
impl Default for CameraRig {
    fn default() -> Self {
        Self::new(UpAxis::Y)
    }
}

impl CameraRig {
    /// Creates a rig that looks at the origin from slightly above and right of the front.
    pub fn new(up: UpAxis) -> Self {
        let pose = RigPose {
            target: [0.0; 3],
            distance: 3.0,
            yaw_rad: 0.5f64.atan2(1.0),
            pitch_rad: (-0.4f64).atan2(1.25f64.sqrt()),
        };
        Self { pose, up, fov_rad: FRAC_PI_4, flight: None }
    }

    /// Returns where the camera is, or is flying to.
    pub fn pose(&self) -> RigPose {
        self.flight.map_or(self.pose, |flight| flight.to)
    }

    /// Moves the camera to a pose at once.
    pub fn set_pose(&mut self, pose: RigPose) {
        self.flight = None;
        self.pose = pose.clamped();
    }

    /// Returns the axis that points up.
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// Sets the axis that points up; the angles stay.
    pub fn set_up(&mut self, up: UpAxis) {
        self.up = up;
    }

    /// Returns the field of view along the shorter side, in radians.
    pub fn fov_rad(&self) -> f64 {
        self.fov_rad
    }

    /// Sets the field of view along the shorter side, in radians, between 5° and 120°.
    pub fn set_fov_rad(&mut self, fov_rad: f64) {
        self.fov_rad = fov_rad.clamp(5f64.to_radians(), 120f64.to_radians());
    }

    /// Returns the camera as it is now.
    pub fn camera(&self) -> Camera {
        let [_, up, forward] = self.axes();
        let target = DVec3::from(self.pose.target);
        let eye = target - forward * self.pose.distance;
        Camera::look_at(eye.into(), target.into(), up.into(), self.fov_rad)
    }

    /// Advances a smooth move by a time in seconds. Returns true while the camera moves.
    pub fn advance(&mut self, seconds: f64) -> bool {
        let Some(flight) = &mut self.flight else { return false };
        flight.part += seconds.max(0.0) / FLIGHT_SECONDS;
        self.pose = flight.pose();
        if flight.part >= 1.0 {
            self.pose = flight.to;
            self.flight = None;
        }
        true
    }

    /// Returns true while a smooth move is under way.
    pub fn is_flying(&self) -> bool {
        self.flight.is_some()
    }

    /// Turns around the target by angles in radians: `turn` to the right, `tilt` downwards, as a
    /// drag of the pointer to the right and down turns the object.
    pub fn orbit(&mut self, turn: f64, tilt: f64) {
        let mut pose = self.settled();
        pose.yaw_rad -= turn;
        pose.pitch_rad -= tilt;
        self.set_pose(pose);
    }

    /// Turns around the eye by angles in radians, to the right and up.
    pub fn look(&mut self, right: f64, up: f64) {
        let eye = self.eye();
        let mut pose = self.settled();
        pose.yaw_rad -= right;
        pose.pitch_rad += up;
        self.set_pose(pose);
        self.pose.target = (eye + self.axes()[2] * self.pose.distance).into();
    }

    /// Moves the camera so that the target follows a drag by pixels right and down; `shorter` is
    /// the shorter side of the picture in pixels.
    pub fn pan(&mut self, pixels: [f64; 2], shorter: f64) {
        let mut pose = self.settled();
        let unit = 2.0 * pose.distance * (self.fov_rad / 2.0).tan() / shorter.max(1.0);
        let [right, up, _] = self.axes();
        let target = DVec3::from(pose.target) + (up * pixels[1] - right * pixels[0]) * unit;
        pose.target = target.into();
        self.set_pose(pose);
    }

    /// Multiplies the distance from the target by a factor. `at` is the point of the picture that
    /// stays where it is, relative to the middle, in units of half the shorter side.
    pub fn zoom(&mut self, factor: f64, at: [f64; 2]) {
        let mut pose = self.settled();
        let [right, up, _] = self.axes();
        let DVec2 { x, y } = DVec2::from(at) * (self.fov_rad / 2.0).tan();
        let moved = (right * x - up * y) * pose.distance * (1.0 - factor);
        pose.target = (DVec3::from(pose.target) + moved).into();
        pose.distance *= factor;
        self.set_pose(pose);
    }

    /// Moves the eye and the target by lengths to the right, up and forward, in model units.
    pub fn travel(&mut self, [x, y, z]: [f64; 3]) {
        let mut pose = self.settled();
        let [right, up, forward] = self.axes();
        pose.target = (DVec3::from(pose.target) + right * x + up * y + forward * z).into();
        self.set_pose(pose);
    }

    /// Flies to a view from one side, around the same target.
    pub fn fly_to_side(&mut self, side: Side) {
        let (yaw, pitch_rad) = side.angles();
        let now = self.pose();
        self.fly_to(RigPose { yaw_rad: yaw.unwrap_or(now.yaw_rad), pitch_rad, ..now });
    }

    /// Flies to where a box fills the picture, seen from the same direction; `aspect` is the
    /// picture's width divided by its height.
    pub fn fly_to_bounds(&mut self, bounds: &Bounds, aspect: f64) {
        let pose = self.framing(bounds, aspect);
        self.fly_to(pose);
    }

    /// Jumps to where a box fills the picture, seen from the same direction.
    pub fn frame(&mut self, bounds: &Bounds, aspect: f64) {
        self.set_pose(self.framing(bounds, aspect));
    }

    /// Flies to a point, and as close as to see a ball of a radius around it.
    pub fn fly_to_point(&mut self, point: [f64; 3], radius: f64) {
        let distance = radius.max(f64::MIN_POSITIVE) / (self.fov_rad / 2.0).tan();
        self.fly_to(RigPose { target: point, distance, ..self.pose() });
    }

    /// Flies to a pose, the short way round.
    pub fn fly_to(&mut self, to: RigPose) {
        let from = self.settled();
        let to = to.clamped();
        let turns = ((to.yaw_rad - from.yaw_rad) / (4.0 * FRAC_PI_2)).round();
        let to = RigPose { yaw_rad: to.yaw_rad - turns * 4.0 * FRAC_PI_2, ..to };
        self.flight = Some(Flight { from, to, part: 0.0 });
    }

    /// Returns the pose in which a box fills the picture.
    fn framing(&self, bounds: &Bounds, aspect: f64) -> RigPose {
        let now = Self { pose: self.pose(), ..self.clone() };
        let [_, up, forward] = now.axes();
        let view = View {
            direction: forward.into(),
            up: up.into(),
            fov_rad: self.fov_rad,
            fill: FILL,
            aspect: aspect.clamp(0.01, 100.0),
        };
        let eye = DVec3::from(Camera::fit(bounds, &view).eye());
        let middle = if bounds.is_empty() { DVec3::ZERO } else { bounds.center().into() };
        let distance = (middle - eye).dot(forward);
        RigPose { target: (eye + forward * distance).into(), distance, ..now.pose }.clamped()
    }

    /// Ends a smooth move where it is, and returns the pose.
    fn settled(&mut self) -> RigPose {
        self.flight = None;
        self.pose
    }

    fn eye(&self) -> DVec3 {
        DVec3::from(self.pose.target) - self.axes()[2] * self.pose.distance
    }

    /// Returns unit vectors to the right, up and forward, also where the camera looks along "up".
    fn axes(&self) -> [DVec3; 3] {
        let (sin, cos) = self.pose.yaw_rad.sin_cos();
        let (rise, run) = self.pose.pitch_rad.sin_cos();
        let right = DVec3::new(cos, 0.0, -sin);
        let forward = DVec3::new(-sin * run, rise, -cos * run);
        let axes = [right, right.cross(forward), forward];
        match self.up {
            UpAxis::Y => axes,
            UpAxis::Z => axes.map(|a| DVec3::new(a.x, -a.z, a.y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { min: [1.0, -2.0, 0.0], max: [3.0, 5.0, 1.0] };

    fn near(a: [f64; 3], b: [f64; 3]) -> bool {
        (DVec3::from(a) - DVec3::from(b)).length() < 1e-9
    }

    #[test]
    fn sides_look_along_their_axes_for_either_up_axis() {
        let cases = [
            (Side::Front, [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
            (Side::Right, [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            (Side::Left, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            (Side::Back, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]),
            (Side::Top, [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]),
            (Side::Bottom, [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ];
        for (side, forward, up) in cases {
            for axis in [UpAxis::Y, UpAxis::Z] {
                let turned = |v: [f64; 3]| if axis == UpAxis::Y { v } else { [v[0], -v[2], v[1]] };
                let mut rig = CameraRig::new(axis);
                rig.fly_to_side(side);
                while rig.advance(0.1) {}
                let [_, seen_up, seen_forward] = rig.camera().axes();
                assert!(near(seen_forward, turned(forward)), "{side:?} {axis:?} {seen_forward:?}");
                assert!(near(seen_up, turned(up)), "{side:?} {axis:?} up {seen_up:?}");
            }
        }
    }

    #[test]
    fn the_first_view_is_that_of_pictures() {
        for up in [UpAxis::Y, UpAxis::Z] {
            let direction = DVec3::from(View::three_quarter(up).direction).normalize();
            assert!(near(CameraRig::new(up).camera().forward(), direction.into()));
        }
    }

    #[test]
    fn a_framed_box_is_seen_as_by_a_fitted_camera() {
        let mut rig = CameraRig::default();
        rig.frame(&BOUNDS, 1.5);
        let fitted = Camera::fit(&BOUNDS, &View { aspect: 1.5, ..View::default() });
        assert!(near(rig.camera().eye(), fitted.eye()));
        rig.frame(&Bounds::EMPTY, f64::NAN);
        assert!(rig.camera().eye().iter().all(|x| x.is_finite()));
    }

    #[test]
    fn looking_around_keeps_the_eye() {
        let mut rig = CameraRig::default();
        rig.frame(&BOUNDS, 1.0);
        let eye = rig.camera().eye();
        rig.look(0.7, -0.2);
        assert!(near(rig.camera().eye(), eye));
    }

    #[test]
    fn orbiting_keeps_the_target_and_stops_at_the_poles() {
        let mut rig = CameraRig::default();
        let before = rig.pose();
        rig.orbit(1.0, 9.0);
        assert_eq!(rig.pose().target, before.target);
        assert_eq!(rig.pose().pitch_rad, -FRAC_PI_2);
    }

    #[test]
    fn a_zoom_keeps_the_point_under_the_pointer() {
        let mut rig = CameraRig::default();
        let at = [0.5, -0.25];
        let under = |rig: &CameraRig| {
            let [right, up, _] = rig.axes();
            let reach = rig.pose.distance * (rig.fov_rad / 2.0).tan();
            (DVec3::from(rig.pose.target) + (right * at[0] - up * at[1]) * reach).to_array()
        };
        let before = under(&rig);
        rig.zoom(0.5, at);
        assert!(near(under(&rig), before));
    }

    #[test]
    fn a_flight_takes_the_short_way_and_ends() {
        let mut rig = CameraRig::default();
        rig.set_pose(RigPose { yaw_rad: 3.0, ..rig.pose() });
        rig.fly_to(RigPose { yaw_rad: -3.0, ..rig.pose() });
        let mut steps = 0;
        while rig.advance(0.02) {
            assert!(rig.pose.yaw_rad >= 3.0 - 1e-9, "it goes on past π");
            steps += 1;
        }
        assert!((10..100).contains(&steps));
        assert!((rig.pose().yaw_rad + 3.0).rem_euclid(4.0 * FRAC_PI_2) < 1e-9);
    }
}
