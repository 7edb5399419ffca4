//! Decides which faces of one surface have a point farther from another than is allowed.
//!
//! A decision costs less than a maximum: faces do not wait for each other, and most are decided by
//! their corners. Each undecided face is divided depth first, so a few cells of it exist at a time.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId};
use meshlod_spatial::{Bvh, Sheet};
use rayon::prelude::*;

use crate::certified::cell::{CALM, Cell, Probe};
use crate::certified::rounding::Rounding;
use crate::distance::Place;
use crate::prepared::PreparedSurface;

/// Vertices that a task processes in sequence.
const CHUNK: usize = 256;

/// Divisions that take about as long as a search for faces that cover a part.
const SPLITS_OF_SHEET: usize = 4;

/// Options for [`faces_beyond`].
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct BeyondOptions<'a> {
    /// Fraction of the limit by which an unlisted face may still exceed it.
    ///
    /// The smaller, the more divisions faces near the limit take.
    pub slack: f64,
    /// Limit on the divisions of all faces together; undecided faces have equal shares of it.
    pub most_splits: usize,
    /// Faces to examine, each once; `None` for all. Not part of what serde writes and reads.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub faces: Option<&'a [FaceId]>,
}

impl Default for BeyondOptions<'_> {
    fn default() -> Self {
        Self { slack: 0.01, most_splits: 4_000_000, faces: None }
    }
}

/// Faces that are, or may be, farther from a surface than allowed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FacesBeyond {
    /// The faces, in the order in which they were given, or in that of the hierarchy's leaves.
    pub faces: Vec<FaceBeyond>,
    /// Number of divisions of faces that it took.
    pub splits: usize,
}

/// Face with a point farther from a surface than allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceBeyond {
    /// The face.
    pub face: FaceId,
    /// Farthest point of the face that was looked at, with the point closest to it.
    pub place: Place,
    /// Distance between the two, in model units.
    pub distance: f64,
    /// False if no point beyond the limit was found within the allowed number of divisions, and
    /// nothing shows that there is none.
    pub decided: bool,
}

/// Lists the faces of one prepared surface that have a point farther from another than `limit`.
///
/// `limit` returns the least distance allowed in a triangle, in model units: infinity where any is.
/// It is asked for faces, for parts of them and, with three equal corners, for points; for a part it
/// must be no less than for the whole. **Every examined face that is not listed is, at each of its
/// points, within `limit` × (1 + slack)**, the rounding of `f64` included. A listed face has a point
/// beyond its limit, to the precision of `f64`, or is marked as undecided. The result is the same to
/// the bit for any number of threads.
///
/// A limit below the rounding of `f64`, such as 0, is never proven: such faces are listed.
///
/// Cost: O((vertices + faces + splits) log faces) of what is examined, in parallel. Points nearer
/// than a third of the limit need no closest point, which makes this several times faster than
/// [`super::certified_one_way`] where few faces are near the limit.
///
/// # References
/// The bounds of [`super::certified_distance`].
pub fn faces_beyond(
    from: &PreparedSurface<'_>,
    to: &PreparedSurface<'_>,
    limit: &(dyn Fn([[f64; 3]; 3]) -> f64 + Sync),
    options: &BeyondOptions<'_>,
) -> FacesBeyond {
    let point = Rounding::of_points(from.mesh, to.mesh);
    let decision = Decision { to, surface: &to.bvh, limit, point, slack: options.slack };
    let faces = options.faces.unwrap_or_else(|| from.bvh.faces_in_leaf_order());
    let mut examined = decision.start(from.mesh, faces);
    let mut left = options.most_splits;
    let is_open = |face: &&Examined| face.state == State::Open;
    loop {
        let open = examined.par_iter().filter(is_open).count();
        if open == 0 || left < open {
            break;
        }
        let share = left / open;
        let open = examined.par_iter_mut().filter(|face| face.state == State::Open);
        let sheet = || decision.sheet();
        let divide = |sheet: &mut Sheet<'_>, face| decision.divide(face, share, sheet);
        left = left.saturating_sub(open.map_init(sheet, divide).sum());
    }
    let beyond = |face: &Examined| (face.state != State::Within).then(|| decision.report(face));
    FacesBeyond {
        faces: examined.par_iter().filter_map(beyond).collect(),
        splits: options.most_splits - left,
    }
}

/// Question that is asked of every face.
struct Decision<'d> {
    to: &'d PreparedSurface<'d>,
    surface: &'d Bvh,
    limit: &'d (dyn Fn([[f64; 3]; 3]) -> f64 + Sync),
    /// Allowance for rounding, in model units.
    point: f64,
    slack: f64,
}

/// Face that is not shown to be within its limit.
struct Examined {
    face: FaceId,
    /// Undecided parts.
    open: Vec<Cell>,
    farthest: Probe,
    state: State,
}

/// State of knowledge about a face.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// Undecided: no point beyond the limit is known, nor a proof that none exists.
    Open,
    /// There is a point beyond the limit.
    Beyond,
    /// The limit is below rounding: nothing shows that the face is within it.
    Unproven,
    /// Every point is within the limit.
    Within,
}

impl<'d> Decision<'d> {
    fn sheet(&self) -> Sheet<'d> {
        Sheet::new(&self.to.bvh, self.to.mates())
    }

    /// Measures the corners and the middles of the faces, and returns those that may be beyond.
    fn start(&self, mesh: &Mesh, faces: &[FaceId]) -> Vec<Examined> {
        let corners = |face: FaceId| mesh.faces[face.index()];
        let at = |v: VertexId| mesh.positions[v.index()];
        let limit = |&face: &FaceId| {
            let limit = (self.limit)(corners(face).map(at));
            (limit != f64::INFINITY).then_some((face, limit))
        };
        let limited: Vec<(FaceId, f64)> = faces.par_iter().filter_map(limit).collect();
        let (slots, probes) = self.measure_corners(mesh, &limited);
        let examine = |sheet: &mut Sheet<'d>, &(face, limit): &(FaceId, f64)| {
            let corners = corners(face).map(|v| probes[slots[v.index()] as usize]);
            let examined = self.examine((face, limit), corners, sheet);
            (examined.state != State::Within).then_some(examined)
        };
        limited.par_iter().map_init(|| self.sheet(), examine).flatten().collect()
    }

    /// Measures the corners of faces, each once and only as closely as the limits around demand.
    /// Returns the slot of each vertex among the probes, and the probes.
    fn measure_corners(&self, mesh: &Mesh, faces: &[(FaceId, f64)]) -> (Vec<u32>, Vec<Probe>) {
        let mut slots = vec![u32::MAX; mesh.positions.len()];
        let mut vertices: Vec<(DVec3, f64)> = Vec::new();
        for &(face, limit) in faces {
            for v in mesh.faces[face.index()] {
                let slot = &mut slots[v.index()];
                if *slot == u32::MAX {
                    *slot = vertices.len() as u32;
                    vertices.push((mesh.positions[v.index()].into(), f64::INFINITY));
                }
                let least = &mut vertices[*slot as usize].1;
                *least = limit.max(0.0).min(*least);
            }
        }
        let measure = |chunk: &[(DVec3, f64)]| -> Vec<Probe> {
            let mut hint = None;
            let measure = |&(at, limit): &(DVec3, f64)| {
                let probe = Probe::near(at, self.surface, hint, CALM * limit);
                hint = Some(probe.face);
                probe
            };
            chunk.iter().map(measure).collect()
        };
        (slots, vertices.par_chunks(CHUNK).flat_map_iter(measure).collect())
    }

    /// Looks at the corners and the middle of a face.
    fn examine(
        &self,
        (face, limit): (FaceId, f64),
        corners: [Probe; 3],
        sheet: &mut Sheet<'d>,
    ) -> Examined {
        let mut examined =
            Examined { face, open: Vec::new(), farthest: corners[0], state: State::Open };
        corners.into_iter().for_each(|corner| self.look_at(corner, &mut examined));
        let enough = self.enough(limit);
        let mut cell = Cell::new(corners, self.surface, [enough, f64::INFINITY]);
        if cell.upper > enough && examined.state == State::Open {
            let middle = cell.probe_middle(self.surface, enough);
            self.look_at(middle, &mut examined);
            if cell.upper > enough && examined.state == State::Open {
                cell.bound_by_sheet(middle.face, sheet, [enough - self.point; 2]);
            }
        }
        if examined.state == State::Open {
            self.keep(cell, &mut examined);
            examined.settle();
        }
        examined
    }

    /// Divides an open face until it is decided, or `most` times. Returns the number of divisions.
    fn divide(&self, examined: &mut Examined, most: usize, sheet: &mut Sheet<'_>) -> usize {
        let mut splits = 0;
        while splits < most && examined.state == State::Open {
            let Some(cell) = examined.open.pop() else { break };
            splits += 1;
            let enough = self.enough((self.limit)(cell.corners()));
            let (mut halves, middle) = cell.halves(self.surface, enough);
            self.look_at(middle, examined);
            for half in &mut halves {
                if examined.state == State::Open && half.is_large(enough) {
                    splits += SPLITS_OF_SHEET;
                    half.bound_by_sheet(middle.face, sheet, [enough - self.point; 2]);
                }
            }
            let [mut less, mut more] = halves;
            if less.upper > more.upper {
                (less, more) = (more, less);
            }
            // The half more likely to be beyond comes next.
            self.keep(less, examined);
            self.keep(more, examined);
            examined.settle();
        }
        splits
    }

    /// Keeps a cell unless it is within its limit.
    fn keep(&self, cell: Cell, examined: &mut Examined) {
        let enough = self.enough((self.limit)(cell.corners()));
        if cell.upper <= enough {
            return;
        }
        examined.open.push(cell);
        if examined.state == State::Open && (enough < 0.0 || enough.is_nan()) {
            examined.state = State::Unproven;
        }
    }

    fn look_at(&self, probe: Probe, examined: &mut Examined) {
        examined.farthest = examined.farthest.farther(probe);
        let limit = (self.limit)([probe.at.to_array(); 3]);
        if probe.distance > limit.min(self.enough(limit)).max(0.0) {
            examined.state = State::Beyond;
        }
    }

    /// Returns the bound up to which a cell is within its limit; below 0 if nothing is.
    fn enough(&self, limit: f64) -> f64 {
        limit * (1.0 + self.slack) - self.point
    }

    fn report(&self, examined: &Examined) -> FaceBeyond {
        // A distance well within the limit may not have been the least.
        let Probe { at, face: near, .. } = examined.farthest;
        let found = self.surface.closest(at.into(), Some(near));
        FaceBeyond {
            face: examined.face,
            place: Place { from: at.into(), to: found.point, face: found.face },
            distance: found.distance_squared.sqrt(),
            decided: examined.state == State::Beyond,
        }
    }
}

impl Examined {
    /// Notes that the face is within its limit if all its parts are.
    fn settle(&mut self) {
        if self.state == State::Open && self.open.is_empty() {
            self.state = State::Within;
        }
    }
}

#[cfg(test)]
mod tests;
