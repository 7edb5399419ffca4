//! A compressed file to a mesh or a scene in one call.

use std::path::Path;

use meshlod_codec::{Compressed, Malformed, TransportFile};
use meshlod_io::{IoError, Scene};
use meshlod_mesh::Mesh;

use crate::compressed::CompressedFileError;
use crate::packed_materials::{scene_with_materials, unpack_materials};

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

/// Decodes a scene from the bytes of a compressed file: one mesh called `name`, with the materials
/// that [`compress_scene`] stored. A file without materials gives white ones, by the names of the
/// mesh.
///
/// # Errors
/// Bytes that are damaged or have another format.
pub fn decompress_scene(bytes: &[u8], name: impl Into<String>) -> Result<Scene, Malformed> {
    let (mesh, resources) = decode(bytes)?;
    if resources.is_empty() {
        return Ok(Scene::from_mesh(name, mesh));
    }
    let materials = unpack_materials(&resources).map_err(|error| Malformed {
        at: bytes.len() - resources.len(),
        reason: error.to_string(),
    })?;
    Ok(scene_with_materials(name, mesh, materials))
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
        scene.images.push(Image { name: "wood.png".into(), bytes: vec![7; 100_000] });
        scene
    }

    #[test]
    fn scenes_come_back_with_their_materials() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.mlq", "a.mlz"] {
            let path = folder.path().join(name);
            let report = compress_scene(scene(), &path, &CompressOptions::default()).unwrap();
            assert!(report.bytes > 100_000);
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
