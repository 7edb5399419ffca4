//! Meshes and scenes in compressed files of our own.

use meshlod_codec::{Compressed, Malformed, TransportFile};
use meshlod_mesh::Mesh;

use crate::model::{ModelScene, ModelSceneError};

/// Decodes the mesh of a compressed file from its bytes, and the scene that [`ModelScene`] makes of
/// it. Of several instances of a mesh, the one mesh has the largest.
///
/// # Errors
/// Bytes that are damaged or have another format.
pub(super) fn decode(bytes: &[u8]) -> Result<(Mesh, ModelScene), Malformed> {
    let (mesh, resources) = mesh_and_resources(bytes)?;
    let model = ModelScene::unpack(&resources);
    let model = model.map_err(|error| damaged_scene(bytes, &resources, error))?;
    Ok((mesh, model))
}

/// Decodes the mesh and the resources of a compressed file.
fn mesh_and_resources(bytes: &[u8]) -> Result<(Mesh, Vec<u8>), Malformed> {
    if bytes.starts_with(&TransportFile::MAGIC) {
        let file = TransportFile::open(bytes)?;
        return Ok((file.decode()?, file.resources()?.to_vec()));
    }
    if !bytes.starts_with(&Compressed::MAGIC) {
        return Err(Malformed { at: 0, reason: "not an .mlq or .mlz file".into() });
    }
    let compressed = Compressed::from_bytes(bytes)?;
    Ok((compressed.decode()?, compressed.resources().to_vec()))
}

/// Describes a damaged scene in the resources, which end the file.
fn damaged_scene(bytes: &[u8], resources: &[u8], error: ModelSceneError) -> Malformed {
    Malformed { at: bytes.len() - resources.len(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use meshlod_io::{Image, ReadOptions, Scene};
    use meshlod_mesh::Labels;

    use crate::jobs::{CompressRequest, Packing, compress};
    use crate::{AnyFile, FileKind};

    const KINDS: [FileKind; 2] = [FileKind::Resident, FileKind::Sent];

    /// Returns a compressed scene.
    fn packed(scene: Scene, kind: FileKind) -> Vec<u8> {
        let packing = Packing::of(kind).unwrap();
        let request = CompressRequest { packing, ..CompressRequest::default() };
        compress(scene, &request, &()).unwrap().0
    }

    /// Returns the scene in a compressed file; `None` if it is damaged.
    fn unpacked(bytes: Vec<u8>, kind: FileKind) -> Option<Scene> {
        let read = ReadOptions::default();
        let file = AnyFile::from_bytes("strip", kind, bytes, &mut |_| None, &read).unwrap();
        file.into_scene().ok()
    }

    /// A scene of a strip with seams whose faces have two materials, one of them with an image.
    fn scene() -> Scene {
        let mut mesh = meshlod_fixtures::seam_strip();
        let of_face = (0..mesh.faces.len()).map(|f| (f % 2) as u32).collect();
        mesh.materials = Some(Labels { names: vec!["red".into(), "wood".into()], of_face });
        mesh.objects =
            Some(Labels { names: vec!["strip".into()], of_face: vec![0; mesh.faces.len()] });
        let mut scene = Scene::from_mesh("strip", mesh);
        scene.materials[0].base_color = [1.0, 0.0, 0.0, 0.5];
        scene.materials[1].base_color_image = Some(0);
        scene.materials[1].is_double_sided = false;
        scene.images.push(Image { name: "wood.png".into(), bytes: noise() });
        scene
    }

    /// Bytes that do not compress.
    fn noise() -> Vec<u8> {
        let next =
            |state: &u64| Some(state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1));
        let states = std::iter::successors(Some(1u64), next);
        states.take(100_000).map(|state| (state >> 56) as u8).collect()
    }

    #[test]
    fn scenes_come_back_with_their_materials() {
        for kind in KINDS {
            let bytes = packed(scene(), kind);
            assert!((100_000..101_500).contains(&bytes.len()), "{}", bytes.len());
            let is = unpacked(bytes.clone(), kind).unwrap();
            let was = scene();
            assert_eq!((&is.materials, &is.images), (&was.materials, &was.images), "{kind:?}");
            assert_eq!(is.meshes[0].materials, was.meshes[0].materials);
            let count = |scene: &Scene, label| {
                let materials = scene.meshes[0].mesh.materials.as_ref().unwrap();
                materials.of_face.iter().filter(|&&of| of == label).count()
            };
            assert_eq!([count(&is, 0), count(&is, 1)], [count(&was, 0), count(&was, 1)]);
            let names = |scene: &Scene| scene.meshes[0].mesh.objects.clone().unwrap().names;
            assert_eq!(names(&is), names(&was));
            for at in [bytes.len() - 1, bytes.len() - 50_000] {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1;
                assert!(unpacked(damaged, kind).is_none());
            }
        }
    }

    #[test]
    fn a_mesh_alone_has_white_materials_by_name() {
        for kind in KINDS {
            let alone = Scene::from_mesh("strip", scene().into_mesh());
            let is = unpacked(packed(alone, kind), kind).unwrap();
            let names: Vec<_> = is.materials.iter().map(|material| &material.name[..]).collect();
            assert_eq!(names, ["red", "wood"]);
            assert!(is.images.is_empty());
        }
    }

    #[test]
    fn another_file_is_refused_by_its_name() {
        let read = ReadOptions::default();
        let bytes = b"something else".to_vec();
        let file = AnyFile::from_bytes("b.mlq", FileKind::Sent, bytes, &mut |_| None, &read);
        let error = file.unwrap().into_scene().unwrap_err().to_string();
        assert_eq!(error, "b.mlq: byte 0: not an .mlq or .mlz file");
    }
}
