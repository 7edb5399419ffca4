//! Closed shells that look inwards.

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
    let mut shells = Shells::of(subject);
    while let Some(shell) = shells.next() {
        if let Some(volume) = shell.volume.filter(|&volume| volume < 0.0) {
            visit(&Finding::InsideOut { face: shell.first, volume })?;
        }
    }
    ControlFlow::Continue(())
}

/// Faces that hang together through edges.
struct Shell {
    first: FaceId,
    /// What it encloses, where it is closed and consistently oriented and that is clearly not 0.
    volume: Option<f64>,
}

/// Walks shell after shell, by their first faces.
struct Shells<'a> {
    subject: &'a Subject<'a>,
    seen: Vec<bool>,
    next: usize,
    /// The faces of the shell in hand; those from `done` on still have neighbours to see.
    faces: Vec<FaceId>,
}

impl<'a> Shells<'a> {
    fn of(subject: &'a Subject<'a>) -> Self {
        Self { subject, seen: vec![false; subject.faces.len()], next: 0, faces: Vec::new() }
    }

    fn next(&mut self) -> Option<Shell> {
        let connectivity = self.subject.connectivity();
        while *self.seen.get(self.next)?
            || connectivity.twin(Side::new(FaceId(self.next as u32), 0)) == Twin::Degenerate
        {
            self.next += 1;
        }
        let first = FaceId(self.next as u32);
        let sound = self.flood(first);
        Some(Shell { first, volume: sound.then(|| self.volume()).flatten() })
    }

    /// Gathers the faces that hang together with `first`, and says whether they are closed and
    /// consistently oriented.
    fn flood(&mut self, first: FaceId) -> bool {
        let connectivity = self.subject.connectivity();
        let faces = &self.subject.faces;
        let all_agree = connectivity.inconsistent_edges() == 0;
        let mut sound = true;
        self.faces.clear();
        self.faces.push(first);
        self.seen[first.index()] = true;
        let mut done = 0;
        while let Some(&face) = self.faces.get(done) {
            done += 1;
            for side in [0, 1, 2].map(|k| Side::new(face, k)) {
                let Twin::Side(twin) = connectivity.twin(side) else {
                    sound = false;
                    continue;
                };
                sound &= all_agree || side.ends(faces) != twin.ends(faces);
                if !std::mem::replace(&mut self.seen[twin.face().index()], true) {
                    self.faces.push(twin.face());
                }
            }
        }
        sound
    }

    /// The volume of the gathered faces, `None` where rounding may have made its sign.
    fn volume(&self) -> Option<f64> {
        let mesh = self.subject.mesh;
        // From a vertex of the shell, since far from the origin the terms would drown the sum.
        let origin = mesh.triangle(mesh.faces[self.faces[0].index()])[0];
        let (mut sum, mut magnitude) = (0.0, 0.0);
        for face in &self.faces {
            let [a, b, c]: [DVec3; 3] = mesh.triangle(mesh.faces[face.index()]).map(|p| p - origin);
            let six = a.dot(b.cross(c));
            sum += six;
            magnitude += six.abs();
        }
        (sum.abs() > magnitude * ROUNDING).then_some(sum / 6.0)
    }
}
