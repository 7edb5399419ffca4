//! Strips of parts, in indices of 16 bits.

use std::ops::Range;

use meshlod::codec::{StoredMesh, StoredPositions};

use super::parts::RUN;

/// Parts that one draw call draws by strips.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct StripRun {
    /// Range of the index buffer.
    pub indices: Range<u32>,
    /// Node that index 0 stands for.
    pub first_node: i32,
    /// Run of parts in which the shader looks up its part.
    pub instance: u32,
}

/// Index of a restart.
const RESTART: u16 = u16::MAX;

/// Joins the strips of as many parts as 16-bit indices and an instance hold to runs; `None` without
/// strips, or if a part alone has too many nodes.
///
/// WebGPU has no indices of a byte, so every index takes two.
pub(super) fn strips(stored: &StoredMesh<'_>) -> Option<(Vec<StripRun>, Vec<u16>)> {
    let (StoredPositions::Parts(parts), Some(strips)) = (&stored.positions, &stored.strips) else {
        return None;
    };
    let (mut runs, mut indices): (Vec<StripRun>, Vec<u16>) = (Vec::new(), Vec::new());
    for (number, part) in parts.parts.iter().enumerate() {
        let instance = (number / RUN) as u32;
        let fits = |run: &StripRun| {
            run.instance == instance && part.nodes.end - run.first_node as u32 <= RESTART.into()
        };
        match runs.last() {
            Some(run) if fits(run) => indices.push(RESTART),
            _ => {
                if part.nodes.len() > RESTART.into() {
                    return None;
                }
                let (start, first_node) = (indices.len() as u32, i32::try_from(part.nodes.start));
                let first_node = first_node.ok()?;
                runs.push(StripRun { indices: start..start, first_node, instance });
            }
        }
        let run = runs.last_mut()?;
        let first = part.nodes.start - run.first_node as u32;
        let index = |local: Option<u32>| local.map_or(RESTART, |local| (first + local) as u16);
        indices.extend(strips.indices(number).map(index));
        run.indices.end = u32::try_from(indices.len()).ok()?;
    }
    // Buffers are written in whole words.
    indices.extend((indices.len() % 2 == 1).then_some(RESTART));
    Some((runs, indices))
}

#[cfg(test)]
mod tests {
    use meshlod::codec::Compressed;
    use meshlod::jobs::{CompressRequest, CompressTarget, Packing, PositionScheme, compress};
    use meshlod::mesh::{AttributeBounds, strip_triangles};
    use meshlod::strip::StripQuality;
    use meshlod::{Scene, samples};

    use super::*;

    #[test]
    fn runs_draw_the_faces_of_all_parts() {
        let mesh = samples::gyroid(300_000);
        let packing = Packing::Resident {
            scheme: Some(PositionScheme::Parts { strips: Some(StripQuality::Fast) }),
            attributes: AttributeBounds::default(),
        };
        let target = CompressTarget::Reduction(0.6);
        let request = CompressRequest { packing, target, ..CompressRequest::default() };
        let (bytes, _) = compress(Scene::from_mesh("", mesh.clone()), &request, &()).unwrap();
        let stripped = Compressed::from_bytes(&bytes).unwrap();
        let stored = stripped.stored().unwrap();
        let (runs, indices) = strips(&stored).unwrap();
        assert!(stored.patches.len() > RUN && runs.len() > stored.patches.len() / RUN);
        let mut drawn = Vec::new();
        for run in &runs {
            let indices = &indices[run.indices.start as usize..run.indices.end as usize];
            let faces = indices.split(|&index| index == RESTART).flat_map(strip_triangles);
            let node = |index: u16| run.first_node as u32 + u32::from(index);
            drawn.extend(faces.map(|face| face.map(node)));
        }
        assert!(drawn == stored.faces, "in the order of the file");
        assert!(2 * indices.len() < 4 * mesh.faces.len(), "a third of 12 bytes per face");
    }
}
