//! Finds closed shells whose faces point inwards.

use std::borrow::Cow;
use std::ops::ControlFlow;

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};

use super::Visit;
use super::subject::Subject;
use crate::finding::Finding;

pub fn inside_out(subject: &Subject, visit: &mut Visit) -> ControlFlow<()> {
    let connectivity = subject.connectivity();
    let labels = if shells_are_components(connectivity) {
        Cow::Borrowed(&subject.objects().component_of_face[..])
    } else {
        Cow::Owned(labels(connectivity, subject.faces.len()))
    };
    for shell in Shells::new(subject.mesh, &subject.faces, connectivity, labels).all {
        if let Some(volume) = shell.volume().filter(|&volume| volume < 0.0) {
            visit(&Finding::InsideOut { face: shell.first, volume })?;
        }
    }
    ControlFlow::Continue(())
}

/// The shells of a mesh: sets of faces connected through manifold edges.
pub(crate) struct Shells<'a> {
    /// Shell of every face, an index into `all`; out of range if the face repeats a vertex.
    pub of_face: Cow<'a, [u32]>,
    /// Shells in the order of their first faces.
    pub all: Vec<Shell>,
}

/// A shell with the sums from which its volume is computed.
pub(crate) struct Shell {
    /// First face of the shell.
    pub first: FaceId,
    /// A vertex of the shell: relative to a far-away origin, cancellation would swamp the volume.
    origin: DVec3,
    closed: bool,
    sum: f64,
    magnitude: f64,
}

impl Shells<'static> {
    /// Finds the shells of a mesh whose indices are in range.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let labels = Cow::Owned(labels(&connectivity, mesh.faces.len()));
        Shells::new(mesh, &mesh.faces, &connectivity, labels)
    }
}

impl<'a> Shells<'a> {
    fn new(
        mesh: &Mesh,
        faces: &[[VertexId; 3]],
        connectivity: &Connectivity,
        of_face: Cow<'a, [u32]>,
    ) -> Self {
        let all_agree = connectivity.inconsistent_edges() == 0;
        let mut all: Vec<Shell> = Vec::new();
        for (f, (&label, &face)) in of_face.iter().zip(faces).enumerate() {
            if label == NONE {
                continue;
            }
            let sides = [0, 1, 2].map(|k| Side::new(FaceId(f as u32), k));
            let closed = sides.iter().all(|&side| match connectivity.twin(side) {
                Twin::Side(twin) => all_agree || side.ends(faces) != twin.ends(faces),
                _ => false,
            });
            let corners = mesh.triangle(face);
            if label as usize == all.len() {
                all.push(Shell::from(FaceId(f as u32), corners[0]));
            }
            all[label as usize].add(corners, closed);
        }
        Self { of_face, all }
    }
}

impl Shell {
    /// Volume, relative to the sum of the magnitudes of its terms, below which it counts as
    /// rounding error. Adding a million terms with an error of 2^-52 each could give 2e-10; errors
    /// of random sign stay far below.
    const ROUNDING: f64 = 1e-12;

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

    /// Returns the signed volume that the shell encloses, in cubic model units; `None` if the shell
    /// is open or inconsistently oriented, or if rounding may have decided the sign.
    pub fn volume(&self) -> Option<f64> {
        let certain = self.sum.abs() > self.magnitude * Self::ROUNDING;
        (self.closed && certain).then_some(self.sum / 6.0)
    }
}

/// Shell of a face that belongs to none.
const NONE: u32 = u32::MAX;

/// Returns true if shells are the components by shared vertices: every vertex has a single fan.
fn shells_are_components(connectivity: &Connectivity) -> bool {
    connectivity.degenerate_faces() == 0 && connectivity.pinched_vertices() == 0
}

/// Labels every face with its shell; shells are numbered in the order of their first faces.
fn labels(connectivity: &Connectivity, faces: usize) -> Vec<u32> {
    let mut labels = vec![NONE; faces];
    let mut count = 0;
    let mut front = Vec::new();
    for first in (0..faces).map(|f| FaceId(f as u32)) {
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
    labels
}
