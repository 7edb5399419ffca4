//! A compressed file to a mesh or a scene in one call.

use std::path::Path;

use meshlod_codec::{Compressed, Malformed, TransportFile};
use meshlod_io::{IoError, Scene};
use meshlod_mesh::Mesh;

use crate::compressed::CompressedFileError;
use crate::{ModelScene, ModelSceneError};

/// Reads a mesh from a compressed file. The format, `.mlq` or `.mlz`, is recognised by the content.
///
/// # Errors
/// A file that cannot be read, is damaged or has another format.
pub fn decompress(path: &Path) -> Result<Mesh, CompressedFileError> {
    let bytes = std::fs::read(path).map_err(|error| IoError::system(path, error))?;
    decompress_bytes(&bytes)
        .map_err(|source| CompressedFileError::Malformed { path: path.to_owned(), source })
}

/// Decodes a mesh from the bytes of a compressed file. The format, `.mlq` or `.mlz`, is recognised
/// by the content.
///
/// # Errors
/// Bytes that are damaged or have another format.
pub fn decompress_bytes(bytes: &[u8]) -> Result<Mesh, Malformed> {
    decode(bytes).map(|(mesh, _)| mesh)
}

/// Decodes the mesh and the resources of a compressed file.
fn decode(bytes: &[u8]) -> Result<(Mesh, Vec<u8>), Malformed> {
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

/// Decodes a scene from the bytes of a compressed file: that which
/// [`compress_scene`](crate::compress_scene) stored, or a mesh called `name`, with white materials
/// by the names of its labels.
///
/// # Errors
/// Bytes that are damaged or have another format.
pub fn decompress_scene(bytes: &[u8], name: impl Into<String>) -> Result<Scene, Malformed> {
    let (mesh, resources) = decode(bytes)?;
    let scene = ModelScene::unpack(&resources).and_then(|model| model.into_scene(name, mesh));
    scene.map_err(|error| damaged_scene(bytes, &resources, error))
}

/// Decodes the mesh of a compressed file from its bytes, and the scene that [`ModelScene`] makes of
/// it. Of several instances of a mesh, the one mesh has the largest.
///
/// # Errors
/// Bytes that are damaged or have another format.
pub fn decompress_model(bytes: &[u8]) -> Result<(Mesh, ModelScene), Malformed> {
    let (mesh, resources) = decode(bytes)?;
    let model = ModelScene::unpack(&resources);
    let model = model.map_err(|error| damaged_scene(bytes, &resources, error))?;
    Ok((mesh, model))
}

/// Describes a damaged scene in the resources, which end the file.
fn damaged_scene(bytes: &[u8], resources: &[u8], error: ModelSceneError) -> Malformed {
    Malformed { at: bytes.len() - resources.len(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use meshlod_io::Image;
    use meshlod_mesh::Labels;

    use super::*;
    use crate::{CompressOptions, compress, compress_scene};

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
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.mlq", "a.mlz"] {
            let path = folder.path().join(name);
            let report = compress_scene(scene(), &path, &CompressOptions::default()).unwrap();
            assert!((100_000..101_500).contains(&report.bytes), "{}", report.bytes);
            let bytes = std::fs::read(&path).unwrap();
            let is = decompress_scene(&bytes, "strip").unwrap();
            let was = scene();
            assert_eq!((&is.materials, &is.images), (&was.materials, &was.images), "{name}");
            assert_eq!(is.meshes[0].materials, was.meshes[0].materials);
            let count = |scene: &Scene, label| {
                let materials = scene.meshes[0].mesh.materials.as_ref().unwrap();
                materials.of_face.iter().filter(|&&of| of == label).count()
            };
            assert_eq!([count(&is, 0), count(&is, 1)], [count(&was, 0), count(&was, 1)]);
            let names = |scene: &Scene| scene.meshes[0].mesh.objects.clone().unwrap().names;
            assert_eq!(names(&is), names(&was));
            assert_eq!(decompress(&path).unwrap().faces.len(), was.meshes[0].mesh.faces.len());
            for at in [bytes.len() - 1, bytes.len() - 50_000] {
                let mut damaged = bytes.clone();
                damaged[at] ^= 1;
                assert!(decompress_scene(&damaged, "strip").is_err());
            }
        }
    }

    #[test]
    fn a_mesh_alone_has_white_materials_by_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.mlq", "a.mlz"] {
            let path = folder.path().join(name);
            let mesh = scene().into_mesh();
            compress(&mesh, &path, &CompressOptions::default()).unwrap();
            let is = decompress_scene(&std::fs::read(&path).unwrap(), "strip").unwrap();
            let names: Vec<_> = is.materials.iter().map(|material| &material.name[..]).collect();
            assert_eq!(names, ["red", "wood"]);
            assert!(is.images.is_empty());
        }
    }
}
