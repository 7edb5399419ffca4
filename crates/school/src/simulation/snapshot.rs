//! The flock between two steps, in the order of the members' ids.

use meshlod::flock::{Flock, School};
use rayon::prelude::*;

use crate::simulation::schools::Simulation;
use crate::simulation::swarm::at;

/// Members that a thread takes at once.
const CHUNK: usize = 4096;

impl Simulation {
    /// Sets `flock` to the schools between the beginning (`alpha` = 0) and the end (1) of the last
    /// step.
    ///
    /// A member keeps its index, and a school the range of its members. `alpha` is clamped; NaN
    /// counts as 1. After the first call with the same flock nothing is allocated.
    pub fn snapshot(&self, alpha: f32, flock: &mut Flock) {
        let alpha = if alpha.is_nan() { 1.0 } else { alpha.clamp(0.0, 1.0) };
        flock.members.resize(self.len());
        let [x, y, z] = flock.members.position.each_mut().map(|axis| axis.par_chunks_mut(CHUNK));
        let [u, v, w] = flock.members.heading.each_mut().map(|axis| axis.par_chunks_mut(CHUNK));
        let speeds = flock.members.speed.par_chunks_mut(CHUNK);
        let places = self.places.par_chunks(CHUNK);
        let (from, to) = (&self.swarm.from, &self.swarm.to);
        (x, y, z, u, v, w, speeds, places).into_par_iter().for_each(
            |(x, y, z, u, v, w, speeds, places)| {
                for (i, &place) in places.iter().enumerate() {
                    let place = place as usize;
                    let ends = [at(&from.position, place), at(&to.position, place)];
                    let position = ends[0].lerp(ends[1], alpha);
                    let headings = [&from.velocity, &to.velocity].map(|axes| at(axes, place));
                    speeds[i] = headings[0].lerp(headings[1], alpha).length();
                    let [before, after] = headings.map(|velocity| velocity.normalize());
                    let heading = before.lerp(after, alpha).normalize();
                    [x[i], y[i], z[i]] = position.to_array();
                    [u[i], v[i], w[i]] = heading.to_array();
                }
            },
        );
        self.snapshot_schools(alpha, &mut flock.schools);
    }

    fn snapshot_schools(&self, alpha: f32, schools: &mut Vec<School>) {
        let mut first = 0;
        schools.clear();
        schools.extend(self.options.schools.iter().zip(&self.leads).map(|(school, lead)| {
            let members = first..first + school.members;
            first = members.end;
            let heading = lead.heading_before.lerp(lead.frame.z_axis, alpha);
            School {
                members,
                leader: lead.position_before.lerp(lead.position, alpha),
                heading: heading.normalize_or(lead.frame.z_axis),
                radii: school.radii,
            }
        }));
    }
}
