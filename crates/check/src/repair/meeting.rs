//! Which of the faces that came last meet others.

use std::ops::ControlFlow;

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};
use meshlod_spatial::{BoxBlocks, LANES, lanes};

use crate::check::subject::LEFT_OUT;
use crate::intersect::{Ground, Meetings, Net};
use crate::objects::{Objects, ObjectsBy};
use crate::places::Places;

/// The faces from `first` on that meet any face beyond what they share; `None` where so many are
/// close that the search gives up.
///
/// Only faces whose boxes overlap one of those are looked at: for a few holes in a large mesh a
/// small part of what a search of all would cost.
pub fn meeting(mesh: &Mesh, first: usize) -> Option<Vec<FaceId>> {
    let seen = |(face, near): (&[VertexId; 3], bool)| if near { *face } else { LEFT_OUT };
    let faces: Vec<[VertexId; 3]> = mesh.faces.iter().zip(near(mesh, first)).map(seen).collect();
    let ground = Ground {
        positions: &mesh.positions,
        faces: &faces,
        connectivity: &Connectivity::new(&faces, mesh.positions.len()),
        places: &Places::of(&mesh.positions),
        // Of the whole mesh: what hangs together far away is one object here too.
        objects: &Objects::of(mesh, ObjectsBy::Components),
    };
    let meetings = Meetings::of(&ground, Net::Tree);
    let new = |face: &FaceId| face.index() >= first;
    let found = meetings.pairs().iter().flatten().copied().filter(new);
    meetings.complete().then(|| found.collect())
}

/// Rows of overlapping boxes that are looked at for each face. Real fillings have a tenth of one.
const MOST_ROWS: usize = 64;

/// For every face, whether it is one of those from `first` on, or its box overlaps one of theirs.
fn near(mesh: &Mesh, first: usize) -> Vec<bool> {
    let box_of = |face: u32| {
        let [a, b, c] = mesh.triangle(mesh.faces[face as usize]);
        [a.min(b).min(c), a.max(b).max(c)]
    };
    let count = mesh.faces.len();
    let mut near: Vec<bool> = (0..count).map(|face| face >= first).collect();
    // Pairs of old faces are not asked for.
    let old = |face: u32| ((face as usize) < first).then_some(0);
    let blocks = BoxBlocks::grouped(count, box_of, old);
    let items = blocks.items();
    let mut rows = MOST_ROWS * count;
    let searched = blocks.pairs(&mut |row| {
        rows = rows.checked_sub(1).map_or(ControlFlow::Break(()), ControlFlow::Continue)?;
        let one = items[row.one as usize] as usize;
        for lane in lanes(row.lanes) {
            let other = items[row.block as usize * LANES + lane] as usize;
            if one >= first || other >= first {
                (near[one], near[other]) = (true, true);
            }
        }
        ControlFlow::Continue(())
    });
    match searched {
        ControlFlow::Continue(()) => near,
        ControlFlow::Break(()) => vec![true; count],
    }
}
