//! Closed shells that look inwards.

use std::borrow::Cow;
use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{FaceId, Side, Twin};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

/// A volume below this part of the sum of its terms' magnitudes is rounding: 2^-52 for each of a
/// million terms added in line would be 2e-10; errors of random sign stay far below.
const ROUNDING: f64 = 1e-12;

pub fn inside_out(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    for (face, volume) in volumes(subject) {
        if volume < 0.0 {
            visit(&Finding::InsideOut { face, volume })?;
        }
    }
    ControlFlow::Continue(())
}

/// The first face and the volume of every closed shell whose faces agree, as far as that is clearly
/// not 0.
fn volumes(subject: &Subject) -> impl Iterator<Item = (FaceId, f64)> {
    let connectivity = subject.connectivity();
    let all_agree = connectivity.inconsistent_edges() == 0;
    let mut shells: Vec<Shell> = Vec::new();
    let labels = labels(subject);
    for (f, (&label, &face)) in labels.iter().zip(subject.faces.iter()).enumerate() {
        if label == NONE {
            continue;
        }
        let sides = [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k));
        let closed = sides.iter().all(|&side| match connectivity.twin(side) {
            Twin::Side(twin) => all_agree || side.ends(&subject.faces) != twin.ends(&subject.faces),
            _ => false,
        });
        let corners = subject.mesh.triangle(face);
        if label as usize == shells.len() {
            shells.push(Shell::from(FaceId(f as u32), corners[0]));
        }
        shells[label as usize].add(corners, closed);
    }
    shells.into_iter().filter_map(|shell| Some((shell.first, shell.volume()?)))
}

/// A shell on the way to its volume.
struct Shell {
    first: FaceId,
    /// A vertex of it, since far from the origin of coordinates the terms would drown the sum.
    origin: DVec3,
    closed: bool,
    sum: f64,
    magnitude: f64,
}

impl Shell {
    fn from(first: FaceId, origin: DVec3) -> Self {
        Self { first, origin, closed: true, sum: 0.0, magnitude: 0.0 }
    }

    #[inline]
    fn add(&mut self, corners: [DVec3; 3], closed: bool) {
        let [a, b, c] = corners.map(|p| p - self.origin);
        let six = a.dot(b.cross(c));
        self.sum += six;
        self.magnitude += six.abs();
        self.closed &= closed;
    }

    /// `None` where it is open, or rounding may have made the sign.
    fn volume(&self) -> Option<f64> {
        let clear = self.sum.abs() > self.magnitude * ROUNDING;
        (self.closed && clear).then_some(self.sum / 6.0)
    }
}

/// The shell of a face that has none: it repeats a vertex, or takes no part.
const NONE: u32 = u32::MAX;

/// The shell of every face, numbered by their first faces.
fn labels<'s>(subject: &'s Subject) -> Cow<'s, [u32]> {
    let connectivity = subject.connectivity();
    if connectivity.degenerate_faces() == 0 && connectivity.pinched_vertices() == 0 {
        // Where every vertex has one fan, what shares vertices shares edges.
        return Cow::Borrowed(&subject.objects().component_of_face);
    }
    let mut labels = vec![NONE; subject.faces.len()];
    let mut count = 0;
    let mut front = Vec::new();
    for first in (0..labels.len()).map(|f| FaceId(f as u32)) {
        let takes_part = connectivity.twin(Side::new(first, 0)) != Twin::Degenerate;
        if labels[first.index()] != NONE || !takes_part {
            continue;
        }
        labels[first.index()] = count;
        front.push(first);
        while let Some(face) = front.pop() {
            for side in [0, 1, 2].map(|k| Side::new(face, k)) {
                let Twin::Side(twin) = connectivity.twin(side) else { continue };
                let label = &mut labels[twin.face().index()];
                if *label == NONE {
                    *label = count;
                    front.push(twin.face());
                }
            }
        }
        count += 1;
    }
    Cow::Owned(labels)
}
