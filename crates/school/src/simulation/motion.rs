//! One step of a member: the velocity it wants and the one it can reach.

use glam::{Mat3, Vec3};

use crate::simulation::avoid::Waters;
use crate::simulation::neighbours::Neighbours;
use crate::simulation::options::Behaviour;

/// Leader of a school over one step.
#[derive(Clone, Copy, Debug)]
pub struct Lead {
    /// Position and frame at the end of the step.
    pub position: Vec3,
    pub frame: Mat3,
    /// Position and heading at the beginning of the step.
    pub position_before: Vec3,
    pub heading_before: Vec3,
    /// Changes of both per second.
    pub velocity: Vec3,
    pub turning: Mat3,
}

/// One member at the beginning of a step.
#[derive(Clone, Copy, Debug)]
pub struct Member {
    pub id: u32,
    pub position: Vec3,
    pub velocity: Vec3,
    /// Offset of the slot from the leader, in the leader's frame.
    pub slot: Vec3,
    /// Velocity that the last look at the neighbours added.
    pub social: Vec3,
}

impl Behaviour {
    /// Returns the velocity that the neighbours add to that for the slot: separation, alignment and
    /// cohesion, from sums that include the member itself.
    #[inline]
    pub(super) fn social(&self, neighbours: &Neighbours, velocity: Vec3) -> Vec3 {
        let others = neighbours.own - 1.0;
        let away = neighbours.away * self.separation;
        if others < 0.5 {
            return away;
        }
        let mean = (neighbours.velocity - velocity) / others;
        let center = neighbours.offset / others;
        away + (mean - velocity) * self.alignment + center * self.cohesion
    }

    /// Returns position and velocity of a member after a step of `step_s` that ends at `time_s`.
    #[inline]
    pub(super) fn swim(
        &self,
        member: &Member,
        lead: &Lead,
        waters: &Waters<'_>,
        [step_s, time_s]: [f32; 2],
    ) -> (Vec3, Vec3) {
        let Member { position, velocity, .. } = *member;
        let offset = member.slot + drift(member.id, time_s) * self.drift;
        let mut slot = lead.position + lead.frame * offset;
        if !waters.is_empty() {
            slot = waters.free_slot(slot);
        }
        let of_slot = (lead.velocity + lead.turning * offset).clamp_length_max(self.max_speed);
        let approach = ((slot - position) * self.keeping).clamp_length_max(self.catch_up);
        let mut wanted = of_slot + approach + member.social;
        if !waters.is_empty() {
            wanted = waters.around(position, velocity, wanted);
        }
        let acceleration =
            ((wanted - velocity) / self.response_s).clamp_length_max(self.max_acceleration);
        let next = self.limit(velocity, velocity + acceleration * step_s, step_s);
        let to = position + next * step_s;
        let to = if waters.is_empty() { to } else { waters.hold_out(position, to) };
        (to, next)
    }

    /// Returns the velocity closest to `wanted` that a member can have a step after `velocity`.
    #[inline]
    fn limit(&self, velocity: Vec3, wanted: Vec3, step_s: f32) -> Vec3 {
        let length = wanted.length();
        let heading = velocity / velocity.length();
        let toward = if length > 1e-6 { wanted / length } else { heading };
        let speed = length.clamp(self.min_speed, self.max_speed);
        let most = (self.turn_rad_s * step_s).min(MOST_TURN);
        let along = heading.dot(toward);
        // The cosine to second order is less than the cosine: only what may be too far is measured.
        if along >= 1.0 - 0.45 * most * most {
            return toward * speed;
        }
        let side = (toward - heading * along)
            .try_normalize()
            .unwrap_or_else(|| heading.any_orthonormal_vector());
        let (sin, cos) = most.sin_cos();
        if along >= cos {
            return toward * speed;
        }
        (heading * cos + side * sin).normalize() * speed
    }
}

/// Greatest angle of a turn in one step: headings in between can then be interpolated.
const MOST_TURN: f32 = 1.5;

/// Returns the drift of a slot, each coordinate within ±1, slow and different for every member.
#[inline]
fn drift(id: u32, time_s: f32) -> Vec3 {
    // Periods of about 5 to 9 s; the phases spread by a multiplicative hash.
    let phase = |factor: u32| (id.wrapping_mul(factor) >> 8) as f32 * (1.0 / (1 << 24) as f32);
    let wave = |cycles: f32| {
        // A parabola in place of the sine.
        let x = 2.0 * (cycles - cycles as i32 as f32) - 1.0;
        4.0 * x * (1.0 - x.abs())
    };
    Vec3::new(
        wave(phase(0x9e37_79b1) + time_s * 0.13),
        wave(phase(0x85eb_ca6b) + time_s * 0.17),
        wave(phase(0xc2b2_ae35) + time_s * 0.11),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_is_as_far_as_allowed_and_no_farther() {
        let behaviour = Behaviour { turn_rad_s: 2.0, ..Behaviour::default() };
        for wanted in [Vec3::NEG_X, Vec3::Z, Vec3::new(-1.0, 0.01, 0.0), Vec3::ZERO, Vec3::X] {
            let next = behaviour.limit(Vec3::X * 2.0, wanted * 2.0, 0.1);
            let turned = next.angle_between(Vec3::X);
            let asked = if wanted == Vec3::ZERO { 0.0 } else { wanted.angle_between(Vec3::X) };
            assert!((turned - asked.min(0.2)).abs() < 1e-3, "{wanted}: {turned}");
            assert!(next.length() >= behaviour.min_speed * 0.999);
        }
    }

    #[test]
    fn the_drift_is_smooth_and_bounded() {
        for id in 0..100 {
            for i in 0..1000 {
                let [a, b] = [0.0, 0.01].map(|more| drift(id, i as f32 * 0.037 + more));
                assert!(a.abs().max_element() <= 1.0 && a.distance(b) < 0.03);
            }
        }
    }
}
