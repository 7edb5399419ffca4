//! Makes the orientation of neighbouring faces consistent.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin};

use super::reverse::reverse_faces;

/// Counts of the faces reversed and the shells left alone.
#[derive(Debug, Default, PartialEq)]
pub struct Oriented {
    /// Number of faces reversed.
    pub turned: usize,
    /// Number of shells left unchanged because they cannot be oriented consistently.
    pub impossible: usize,
}

/// Reverses as few faces of every shell as possible so that neighbouring faces agree; in a tie the
/// first face keeps its orientation.
pub fn agree(mesh: &mut Mesh) -> Oriented {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    if connectivity.inconsistent_edges() == 0 {
        return Oriented::default();
    }
    let mut walk = OrientationWalk::new(mesh, &connectivity);
    let mut impossible = 0;
    for face in (0..mesh.faces.len()).map(|f| FaceId(f as u32)) {
        impossible += usize::from(!walk.orient_shell(face));
    }
    let turned: Vec<bool> = walk.state.iter().map(|&state| state == State::Turned).collect();
    reverse_faces(mesh, &turned);
    Oriented { turned: turned.iter().filter(|turned| **turned).count(), impossible }
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Kept,
    Turned,
}

struct OrientationWalk<'a> {
    mesh: &'a Mesh,
    connectivity: &'a Connectivity,
    state: Vec<State>,
    shell: Vec<FaceId>,
}

impl<'a> OrientationWalk<'a> {
    fn new(mesh: &'a Mesh, connectivity: &'a Connectivity) -> Self {
        let state = vec![State::Unseen; mesh.faces.len()];
        Self { mesh, connectivity, state, shell: Vec::new() }
    }

    /// Orients the shell of a face unless done already; returns false if it cannot be oriented.
    fn orient_shell(&mut self, first: FaceId) -> bool {
        if self.state[first.index()] != State::Unseen {
            return true;
        }
        let possible = self.flood(first);
        let turned =
            self.shell.iter().filter(|face| self.state[face.index()] == State::Turned).count();
        for face in &self.shell {
            let state = &mut self.state[face.index()];
            *state = match (*state, possible) {
                (_, false) => State::Kept,
                (State::Turned, _) if 2 * turned <= self.shell.len() => State::Turned,
                (State::Kept, _) if 2 * turned > self.shell.len() => State::Turned,
                _ => State::Kept,
            };
        }
        possible
    }

    /// Gathers a shell and marks the faces that disagree with `first`; returns false if the marks
    /// contradict each other.
    fn flood(&mut self, first: FaceId) -> bool {
        self.shell.clear();
        self.shell.push(first);
        self.state[first.index()] = State::Kept;
        let (mut done, mut possible) = (0, true);
        while let Some(&face) = self.shell.get(done) {
            done += 1;
            for side in [0, 1, 2].map(|k| Side::new(face, k)) {
                let Twin::Side(twin) = self.connectivity.twin(side) else { continue };
                let agrees = side.ends(&self.mesh.faces) != twin.ends(&self.mesh.faces);
                let wanted = match (self.state[face.index()], agrees) {
                    (State::Turned, true) | (State::Kept, false) => State::Turned,
                    _ => State::Kept,
                };
                match &mut self.state[twin.face().index()] {
                    state @ State::Unseen => {
                        *state = wanted;
                        self.shell.push(twin.face());
                    }
                    state => possible &= *state == wanted,
                }
            }
        }
        possible
    }
}
