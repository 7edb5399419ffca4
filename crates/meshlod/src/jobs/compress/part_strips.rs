//! Triangle strips inside the parts of compressed meshes.

use meshlod_codec::{Compressed, StripsError};
use meshlod_mesh::VertexId;
use meshlod_strip::{Prices, StripOptions, StripQuality, stripify};

/// Stores the faces of a mesh that is compressed in parts as triangle strips, so that faces, too,
/// are drawn without decoding them first.
///
/// The strips have the fewest indices found, restarts counted. None runs from one part or one
/// material to another, and those of a part come material by material.
///
/// Cost: one [`stripify`].
/// # Errors
/// Positions in another scheme, or damaged data that the checksums did not catch.
pub(super) fn with_strips(
    compressed: Compressed,
    quality: StripQuality,
) -> Result<Compressed, StripsError> {
    let faces = compressed.stored()?.faces;
    let materials = compressed.materials();
    let count = materials.as_ref().map_or(1, |labels| labels.names.len());
    let mut of_material: Vec<Vec<[VertexId; 3]>> = vec![Vec::new(); count];
    for (at, face) in faces.iter().enumerate() {
        let material = materials.as_ref().map_or(0, |labels| labels.of(at) as usize);
        of_material[material].push(face.map(VertexId));
    }
    // A part has nodes of its own, so its faces are not connected with those of other parts.
    let options =
        StripOptions { quality, prices: Prices::with_restarts(), ..StripOptions::default() };
    let strips: Vec<_> = of_material.iter().map(|faces| stripify(faces, &options)).collect();
    let strips = strips.iter().flat_map(|strips| strips.iter());
    compressed.with_strips(strips.map(|strip| strip.iter().map(|node| node.0)))
}

#[cfg(test)]
mod tests {
    use meshlod_codec::{CompressionTarget, Reconstruction, Scheme, compress};
    use meshlod_mesh::{AttributeBounds, Labels, Mesh};
    use meshlod_samples as samples;

    use super::*;

    fn in_parts(mesh: &Mesh) -> Compressed {
        let scheme = Scheme::Parts(Reconstruction::Centred);
        let target = CompressionTarget::Bits(10);
        compress(mesh, scheme, target, &AttributeBounds::default()).unwrap().compressed
    }

    #[test]
    fn strips_of_a_part_come_material_by_material() {
        let mut mesh = samples::gyroid(4_000);
        let of_face = (0..mesh.faces.len() as u32).map(|face| face / 11 % 3).collect();
        mesh.materials = Some(Labels { names: ["a", "b", "c"].map(String::from).into(), of_face });
        let stripped = with_strips(in_parts(&mesh), StripQuality::Fast).unwrap();
        let materials = stripped.materials().unwrap().of_face;
        let stored = stripped.stored().unwrap();
        assert!(stored.patches.len() > 3);
        for patch in stored.patches {
            let own = &materials[patch.start as usize..patch.end as usize];
            assert!(own.is_sorted(), "{own:?}");
        }
        let count =
            |labels: &[u32]| [0, 1, 2].map(|of| labels.iter().filter(|&&x| x == of).count());
        assert_eq!(count(&materials), count(&mesh.materials.unwrap().of_face));
    }

    #[test]
    fn strips_need_parts() {
        let done = compress(
            &samples::sphere(200),
            Scheme::Blocks,
            CompressionTarget::Bits(9),
            &AttributeBounds::default(),
        );
        let refused = with_strips(done.unwrap().compressed, StripQuality::Fast);
        assert_eq!(refused, Err(StripsError::NoParts));
    }
}
