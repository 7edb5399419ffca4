//! Making neighbours agree which side is out.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin};

use super::turn::turn;

/// What came of it.
#[derive(Debug, Default, PartialEq)]
pub struct Oriented {
    /// Faces turned.
    pub turned: usize,
    /// Shells that cannot be oriented, and stay as they are.
    pub impossible: usize,
}

/// Turns faces until those on two sides of an edge agree, in every shell as few as it takes; where
/// that is half of them, the first face stays.
pub fn agree(mesh: &mut Mesh) -> Oriented {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    if connectivity.inconsistent_edges() == 0 {
        return Oriented::default();
    }
    let mut walk = Walk::new(mesh, &connectivity);
    let mut impossible = 0;
    for face in (0..mesh.faces.len()).map(|f| FaceId(f as u32)) {
        impossible += usize::from(!walk.orient_shell(face));
    }
    let turned: Vec<bool> = walk.state.iter().map(|&state| state == State::Turned).collect();
    turn(mesh, &turned);
    Oriented { turned: turned.iter().filter(|turned| **turned).count(), impossible }
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Unseen,
    Kept,
    Turned,
}

struct Walk<'a> {
    mesh: &'a Mesh,
    connectivity: &'a Connectivity,
    state: Vec<State>,
    shell: Vec<FaceId>,
}

impl<'a> Walk<'a> {
    fn new(mesh: &'a Mesh, connectivity: &'a Connectivity) -> Self {
        let state = vec![State::Unseen; mesh.faces.len()];
        Self { mesh, connectivity, state, shell: Vec::new() }
    }

    /// Orients the shell of a face, if it is still to be done; false where that cannot be.
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

    /// Gathers a shell and turns what disagrees with `first`; false where some always will.
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
