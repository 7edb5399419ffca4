//! Figures of a school, frame by frame, for graphs.

use std::collections::VecDeque;

use meshlod::flock::Flock;
use meshlod_school::simulation::SchoolOptions;

/// Figures of one frame of a school.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SchoolFrame {
    /// Triangles that are drawn with the levels of the policy.
    pub triangles: u64,
    /// Triangles of the same members in full detail.
    pub full_triangles: u64,
    /// Members that are drawn.
    pub members: usize,
    /// Time of the simulation in milliseconds.
    pub simulate_ms: f64,
    /// Time of the choice of levels in milliseconds.
    pub select_ms: f64,
    /// Time since the frame before in milliseconds; 0 for the first.
    pub frame_ms: f64,
    /// Mean over members of their speed over that of their leader.
    pub relative_speed: f32,
    /// Mean over members of the cosine between their heading and that of their leader.
    pub agreement: f32,
}

/// Figures of the last frames of a school, the oldest first.
#[derive(Clone, Debug)]
pub struct SchoolHistory {
    frames: VecDeque<SchoolFrame>,
    longest: usize,
}

impl SchoolHistory {
    /// Creates a history of up to a number of frames.
    pub fn new(longest: usize) -> Self {
        Self { frames: VecDeque::with_capacity(longest), longest }
    }

    /// Returns the frames, the oldest first.
    pub fn frames(&self) -> impl ExactSizeIterator<Item = &SchoolFrame> {
        self.frames.iter()
    }

    /// Returns the last frame.
    pub fn last(&self) -> Option<&SchoolFrame> {
        self.frames.back()
    }

    pub(super) fn push(&mut self, frame: SchoolFrame) {
        if self.frames.len() >= self.longest {
            self.frames.pop_front();
        }
        self.frames.push_back(frame);
    }
}

/// Returns how fast and how much the same way members swim as their leaders: the means over all
/// members of schools of the relative speed, and of the cosine between headings.
pub(super) fn cohesion(flock: &Flock, options: &[SchoolOptions]) -> [f32; 2] {
    let (mut speed, mut agreement, mut count) = (0.0f64, 0.0f64, 0usize);
    for (school, options) in flock.schools.iter().zip(options) {
        for member in school.members.clone() {
            speed += f64::from(flock.members.speed[member] / options.speed.max(1e-6));
            agreement += f64::from(flock.members.heading(member).dot(school.heading));
        }
        count += school.members.len();
    }
    let count = count.max(1) as f64;
    [speed, agreement].map(|sum| (sum / count) as f32)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use meshlod::flock::School;

    use super::*;

    #[test]
    fn a_history_keeps_the_last_frames() {
        let mut history = SchoolHistory::new(3);
        for triangles in 0..5 {
            history.push(SchoolFrame { triangles, ..SchoolFrame::default() });
        }
        let kept: Vec<u64> = history.frames().map(|frame| frame.triangles).collect();
        assert_eq!(kept, [2, 3, 4]);
        assert_eq!(history.last().unwrap().triangles, 4);
    }

    #[test]
    fn members_are_held_against_their_leader() {
        let mut flock = Flock::default();
        flock.members.push([0.0; 3], [0.0, 0.0, 1.0]);
        flock.members.push([0.0; 3], [1.0, 0.0, 0.0]);
        flock.members.speed = vec![2.0, 4.0];
        let (leader, heading) = (Vec3::ZERO, Vec3::Z);
        flock.schools.push(School { members: 0..2, leader, heading, radii: Vec3::ONE });
        let options = SchoolOptions { speed: 2.0, ..SchoolOptions::of(2) };
        assert_eq!(cohesion(&flock, &[options]), [1.5, 0.5]);
        assert_eq!(cohesion(&Flock::default(), &[]), [0.0; 2]);
    }
}
