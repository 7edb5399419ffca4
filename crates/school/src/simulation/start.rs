//! Start of a simulation: members in their slots, with the headings of their leaders.

use glam::Vec3;
use meshlod::flock::frame_of;

use crate::simulation::avoid::Waters;
use crate::simulation::options::SimulationOptions;
use crate::simulation::slots::{Slots, mix};
use crate::simulation::swarm::Swarm;

/// Distance by which members are scattered about their slots, so that no two are at one point even
/// in an ellipsoid without volume.
const SCATTER: f32 = 0.02;

/// Returns all members of all schools in free water.
pub fn swarm(options: &SimulationOptions, balls: &[(Vec3, f32)]) -> Swarm {
    let waters = Waters::new(&options.obstacles, balls, &options.behaviour);
    let mut swarm = Swarm::default();
    for (index, school) in options.schools.iter().enumerate() {
        let (leader, heading) = school.leader.after(0.0);
        let frame = frame_of(heading);
        let seed = mix(options.seed.wrapping_add(mix(index as u64)));
        let slots = Slots::new(seed).zip(Slots::new(!seed)).take(school.members);
        for (slot, scatter) in slots {
            let slot = slot * school.radii;
            let point = leader + frame * slot + scatter * SCATTER;
            let position = if waters.is_empty() { point } else { waters.find_free(point) };
            swarm.push(position, heading * school.speed, index, slot);
        }
    }
    swarm.start();
    swarm
}
