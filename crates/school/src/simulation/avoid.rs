//! Avoidance of obstacles: members steer round them ahead of time, and never enter them.

use glam::Vec3;

use crate::simulation::obstacle::Obstacle;
use crate::simulation::options::Behaviour;

/// Obstacles of a simulation, and how members avoid them.
pub struct Waters<'a> {
    obstacles: &'a [Obstacle],
    /// Centre and radius of a ball around each obstacle.
    balls: &'a [(Vec3, f32)],
    behaviour: &'a Behaviour,
}

/// Points on the way ahead at which members look for obstacles, as fractions of the look-ahead
/// time, each with the fraction of the velocity given up for an obstacle there.
const AHEAD: [(f32, f32); 4] = [(0.0, 1.0), (0.25, 0.9), (0.55, 0.7), (1.0, 0.5)];
/// Speed away from an obstacle over the speed along it, for a member that gives way entirely.
const REPULSION: f32 = 0.3;
/// Rounds in which a point is pushed out of overlapping obstacles.
const ROUNDS: usize = 12;

impl<'a> Waters<'a> {
    pub fn new(
        obstacles: &'a [Obstacle],
        balls: &'a [(Vec3, f32)],
        behaviour: &'a Behaviour,
    ) -> Self {
        Self { obstacles, balls, behaviour }
    }

    pub fn is_empty(&self) -> bool {
        self.obstacles.is_empty()
    }

    /// Returns the obstacles whose balls are within `reach` of a point.
    fn near(&self, point: Vec3, reach: f32) -> impl Iterator<Item = &'a Obstacle> + use<'a> {
        let pairs = self.obstacles.iter().zip(self.balls);
        pairs
            .filter(move |(_, (center, radius))| {
                point.distance_squared(*center) <= (radius + reach) * (radius + reach)
            })
            .map(|(obstacle, _)| obstacle)
    }

    /// Returns the slot itself if it is free, else the nearest free water.
    pub fn free_slot(&self, slot: Vec3) -> Vec3 {
        let keep = 0.5 * (self.behaviour.clearance + self.behaviour.berth);
        let mut free = slot;
        for obstacle in self.near(slot, keep) {
            let found = obstacle.distance(free);
            free += found.outward * (keep - found.distance).max(0.0);
        }
        free
    }

    /// Returns the velocity with which a member swims round the obstacles ahead.
    ///
    /// The first obstacle within its berth on the way takes away the part of `wanted` that leads
    /// into it, the more the nearer it is; the rest is made as fast as it was.
    pub fn around(&self, position: Vec3, velocity: Vec3, wanted: Vec3) -> Vec3 {
        let Behaviour { clearance, berth, look_ahead_s, .. } = *self.behaviour;
        let mut wanted = wanted;
        for obstacle in self.near(position, berth + velocity.length() * look_ahead_s) {
            let seen = AHEAD.iter().find_map(|&(part, weight)| {
                let found = obstacle.distance(position + velocity * (part * look_ahead_s));
                let depth = (berth - found.distance) / (berth - clearance).max(1e-3);
                (depth > 0.0).then_some((found.outward, depth.min(1.0) * weight))
            });
            if let Some((outward, urgency)) = seen {
                wanted = along(wanted, velocity, outward, urgency);
            }
        }
        wanted
    }

    /// Moves a member from `from`, outside all obstacles, towards `to`: all the way, or as near as
    /// the obstacles allow.
    ///
    /// Both ends of the way keep the clearance, and the way is at most twice as long, so all of it
    /// is outside.
    pub fn hold_out(&self, from: Vec3, to: Vec3) -> Vec3 {
        let clearance = self.behaviour.clearance;
        let at = self.push_out(to);
        let is_free = self.is_free(at) && at.distance(from) <= 2.0 * clearance;
        if is_free { at } else { from }
    }

    /// Returns a free point near `point`, where a member can start.
    pub fn find_free(&self, point: Vec3) -> Vec3 {
        let mut at = self.push_out(point);
        let mut rise = self.behaviour.clearance;
        // The obstacles are finite, so that there is free water above them.
        while !self.is_free(at) && rise.is_finite() {
            at = point + Vec3::Y * rise;
            rise *= 1.5;
        }
        at
    }

    fn push_out(&self, point: Vec3) -> Vec3 {
        // A little farther than it must, so that rounding does not bring it back.
        let clearance = self.behaviour.clearance * 1.001;
        let mut at = point;
        for _ in 0..ROUNDS {
            let mut is_free = true;
            for obstacle in self.near(at, clearance) {
                let found = obstacle.distance(at);
                if found.distance < clearance {
                    at += found.outward * (clearance - found.distance);
                    is_free = false;
                }
            }
            if is_free {
                break;
            }
        }
        at
    }

    fn is_free(&self, point: Vec3) -> bool {
        let clearance = self.behaviour.clearance;
        self.near(point, clearance).all(|obstacle| obstacle.distance(point).distance >= clearance)
    }
}

/// Returns `wanted` without the share `urgency` of what leads into an obstacle, and as fast.
fn along(wanted: Vec3, velocity: Vec3, outward: Vec3, urgency: f32) -> Vec3 {
    let into = wanted.dot(outward);
    if into >= 0.0 {
        return wanted;
    }
    let flat = wanted - outward * into;
    // Head-on there is no side to prefer: the member's own way decides, then its left.
    let aside = velocity - outward * velocity.dot(outward);
    let side = flat
        .try_normalize()
        .or_else(|| aside.try_normalize())
        .unwrap_or_else(|| outward.any_orthonormal_vector());
    wanted.lerp((side + outward * REPULSION) * wanted.length(), urgency)
}
