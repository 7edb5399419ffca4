//! Finds which of the newest faces intersect others.

use std::ops::ControlFlow;

use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};

use crate::box_blocks::BoxBlocks;
use crate::check::subject::EXCLUDED;
use crate::intersect::{BroadPhase, IntersectingPairs, SearchInput};
use crate::objects::{Objects, ObjectsBy};
use crate::unique_positions::UniquePositions;

/// Returns the faces from `first` on that intersect any face beyond what they share; `None` if the
/// search gives up.
///
/// Only faces whose boxes overlap one of these are searched, so a few holes in a large mesh cost a
/// small part of a full search.
pub fn intersecting(mesh: &Mesh, first: usize) -> Option<Vec<FaceId>> {
    let kept = |(face, near): (&[VertexId; 3], bool)| if near { *face } else { EXCLUDED };
    let faces: Vec<[VertexId; 3]> = mesh.faces.iter().zip(near(mesh, first)).map(kept).collect();
    let input = SearchInput {
        positions: &mesh.positions,
        faces: &faces,
        connectivity: &Connectivity::new(&faces, mesh.positions.len()),
        unique: &UniquePositions::of(&mesh.positions),
        // Of the whole mesh: what is connected far away is one object here too.
        objects: &Objects::of(mesh, ObjectsBy::Components),
    };
    let pairs = IntersectingPairs::of(&input, BroadPhase::Tree);
    let new = |face: &FaceId| face.index() >= first;
    let found = pairs.pairs().iter().flatten().copied().filter(new);
    pairs.complete().then(|| found.collect())
}

/// Limit on rows of overlapping boxes per face. Real fillings have a tenth of one.
const MOST_ROWS: usize = 64;

/// Returns a flag per face: true if it is one from `first` on or its box overlaps one of theirs.
fn near(mesh: &Mesh, first: usize) -> Vec<bool> {
    let box_of = |face: u32| {
        let [a, b, c] = mesh.triangle(mesh.faces[face as usize]);
        [a.min(b).min(c), a.max(b).max(c)]
    };
    let count = mesh.faces.len();
    let mut near: Vec<bool> = (0..count).map(|face| face >= first).collect();
    // Pairs of old faces are skipped as one group.
    let old = |face: u32| ((face as usize) < first).then_some(0);
    let blocks = BoxBlocks::grouped(count, box_of, old);
    let items = blocks.items();
    let mut rows = MOST_ROWS * count;
    let searched = blocks.pairs(&mut |row| {
        rows = rows.checked_sub(1).map_or(ControlFlow::Break(()), ControlFlow::Continue)?;
        let one = items[row.slot] as usize;
        for other in row.others() {
            let other = items[other] as usize;
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
