//! Verification of triangle strips against an independent simplification.

use std::cmp::Reverse;

use meshlod::mesh::{FaceId, VertexId};
use meshlod::simplify::Simplifier;
use meshlod::strip::{MergeTree, difference};
use meshlod::{SimplifyError, Target};

use super::StrippedLevel;
use crate::constraints::FlatInput;

/// Compares the triangles drawn at each level with the faces left by simplifying to it, and at full
/// size with `whole`, the cleaned faces of the mesh.
pub(super) fn compare(
    input: &FlatInput,
    whole: &[[VertexId; 3]],
    levels: &mut [StrippedLevel],
) -> Result<(), SimplifyError> {
    let mut levels: Vec<&mut StrippedLevel> = levels.iter_mut().collect();
    levels.sort_by_key(|level| Reverse(level.triangles));
    let finest = levels.partition_point(|level| level.triangles == whole.len());
    let (finest, coarser) = levels.split_at_mut(finest);
    for level in finest {
        level.difference = Some(difference(&level.strips, whole));
    }
    if coarser.is_empty() {
        return Ok(());
    }
    let options = MergeTree::options(&input.options);
    let mut simplifier = Simplifier::new(&input.mesh, &options)?;
    for level in coarser {
        simplifier.run(Target::Faces(level.triangles), &mut ())?;
        let surface = simplifier.surface();
        let ids = (0..surface.face_count()).map(FaceId::new);
        let alive = ids.filter(|&face| surface.is_alive(face));
        let faces: Vec<_> = alive.map(|face| surface.face(face)).collect();
        level.difference = Some(difference(&level.strips, &faces));
    }
    Ok(())
}
