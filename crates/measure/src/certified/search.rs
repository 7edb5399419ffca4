//! Search for the point of one surface that is farthest from another, by dividing faces.

use std::mem;

use glam::DVec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::{Bvh, Sheet};
use rayon::prelude::*;

use crate::certified::cell::{Cell, Probe};
use crate::certified::rounding::Rounding;
use crate::certified::{Bracket, CertifiedOptions};
use crate::distance::Place;
use crate::prepared::PreparedSurface;

/// Cells divided in a round, those of the greatest bounds. Fixed, since the result depends on it.
const ROUND: usize = 1 << 16;

/// Points, faces or cells that a task processes in sequence.
const CHUNK: usize = 1024;

/// Branch-and-bound search for the maximum distance in one direction.
pub(super) struct Search<'s> {
    to: &'s PreparedSurface<'s>,
    surface: &'s Bvh,
    options: &'s CertifiedOptions,
    rounding: Rounding,
    /// Distance that counts as none.
    floor: f64,
    /// Cells that may hold a point farther away than the tolerance allows.
    open: Vec<Cell>,
    /// Farthest point so far.
    farthest: Probe,
    /// Greatest bound of the discarded cells.
    discarded: f64,
    splits: usize,
}

impl<'s> Search<'s> {
    /// Measures all vertices of `from`, and collects the faces that may reach farther.
    pub(super) fn new(
        from: &PreparedSurface<'_>,
        to: &'s PreparedSurface<'_>,
        options: &'s CertifiedOptions,
    ) -> Self {
        let vertices = vertex_probes(from, &to.bvh);
        let used = from.vertices.iter().map(|v| vertices[v.index()]);
        let rounding = Rounding::between(from.mesh, to.mesh);
        let mut search = Self {
            to,
            surface: &to.bvh,
            options,
            rounding,
            floor: rounding.least().max(options.floor * from.diagonal.max(to.diagonal)),
            open: Vec::new(),
            farthest: used.reduce(Probe::farther).expect("a prepared surface has faces"),
            discarded: 0.0,
            splits: 0,
        };
        let corners = |face: &FaceId| from.mesh.faces[face.index()].map(|v| vertices[v.index()]);
        let faces = from.bvh.faces_in_leaf_order();
        let enough = search.enough();
        search.process(faces, |face, (surface, sheet), into| {
            let mut cell = Cell::new(corners(face), surface, [enough, f64::INFINITY]);
            if cell.upper > enough {
                let middle = cell.probe_middle(surface, enough);
                into.found(middle);
                if cell.upper > enough {
                    cell.bound_by_sheet(middle.face, sheet, [0.5 * enough, enough]);
                }
            }
            into.keep(cell, enough);
        });
        search
    }

    /// Divides cells until none is left, or the limit is reached.
    pub(super) fn run(&mut self) {
        loop {
            let enough = self.enough();
            let discarded = &mut self.discarded;
            self.open.retain(|cell| {
                let is_open = cell.upper > enough;
                *discarded = if is_open { *discarded } else { discarded.max(cell.upper) };
                is_open
            });
            let room = self.options.most_splits - self.splits;
            if self.open.is_empty() || room == 0 {
                return;
            }
            let round = self.take_greatest(ROUND.min(room));
            self.splits += round.len();
            self.process(&round, |cell, (surface, _), into| {
                let (halves, middle) = cell.halves(surface, enough);
                into.found(middle);
                halves.into_iter().for_each(|half| into.keep(half, enough));
            });
        }
    }

    /// Returns the bounds found, widened by what rounding may have changed.
    pub(super) fn bracket(&self) -> Bracket {
        let Rounding { point, closest } = self.rounding;
        // A distance near 0 may not have been the least.
        let found = self.surface.closest(self.farthest.at.into(), Some(self.farthest.face));
        let open = self.open.iter().map(|cell| cell.upper);
        let upper = open.fold(self.discarded.max(self.farthest.distance), f64::max);
        Bracket {
            lower: (found.distance_squared.sqrt() - point - closest).max(0.0),
            upper: upper + point,
            place: Place { from: self.farthest.at.into(), to: found.point, face: found.face },
            reached: self.open.is_empty(),
            splits: self.splits,
        }
    }

    /// Returns the bound at which a cell may be discarded.
    fn enough(&self) -> f64 {
        (self.farthest.distance * (1.0 + self.options.tolerance)).max(self.floor)
    }

    /// Takes the cells of the greatest bounds out of the open ones.
    fn take_greatest(&mut self, count: usize) -> Vec<Cell> {
        let Some(rest) = self.open.len().checked_sub(count).filter(|&rest| rest > 0) else {
            return mem::take(&mut self.open);
        };
        self.open.select_nth_unstable_by(rest, |a, b| a.upper.total_cmp(&b.upper));
        self.open.split_off(rest)
    }

    /// Processes items on all threads, and takes over what they found, in their order.
    fn process<T: Sync>(
        &mut self,
        items: &[T],
        each: impl Fn(&T, (&Bvh, &mut Sheet<'s>), &mut Outcome) + Sync,
    ) {
        let (surface, mates) = (self.surface, self.to.mates());
        let start = Outcome { open: Vec::new(), farthest: self.farthest, discarded: 0.0 };
        let outcome = |chunk: &[T]| {
            let mut outcome = start.clone();
            let mut sheet = Sheet::new(surface, mates);
            chunk.iter().for_each(|item| each(item, (surface, &mut sheet), &mut outcome));
            outcome
        };
        let outcomes: Vec<Outcome> = items.par_chunks(CHUNK).map(outcome).collect();
        for outcome in outcomes {
            self.open.extend(outcome.open);
            self.farthest = self.farthest.farther(outcome.farthest);
            self.discarded = self.discarded.max(outcome.discarded);
        }
    }
}

/// Cells and the farthest point that a task found.
#[derive(Clone)]
struct Outcome {
    open: Vec<Cell>,
    farthest: Probe,
    discarded: f64,
}

impl Outcome {
    fn found(&mut self, probe: Probe) {
        self.farthest = self.farthest.farther(probe);
    }

    fn keep(&mut self, cell: Cell, enough: f64) {
        match cell.upper > enough {
            true => self.open.push(cell),
            false => self.discarded = self.discarded.max(cell.upper),
        }
    }
}

/// Measures the vertices that faces use, one probe per vertex of the mesh.
fn vertex_probes(from: &PreparedSurface<'_>, to: &Bvh) -> Vec<Probe> {
    let measured: Vec<Probe> = from
        .vertices
        .par_chunks(CHUNK)
        .flat_map_iter(|chunk| {
            let mut hint = None;
            chunk.iter().map(move |v| {
                let probe = Probe::new(from.mesh.positions[v.index()].into(), to, hint);
                hint = Some(probe.face);
                probe
            })
        })
        .collect();
    let nowhere = Probe { at: DVec3::NAN, distance: 0.0, face: FaceId(0) };
    let mut probes = vec![nowhere; from.mesh.positions.len()];
    for (v, probe) in from.vertices.iter().zip(measured) {
        probes[v.index()] = probe;
    }
    probes
}
