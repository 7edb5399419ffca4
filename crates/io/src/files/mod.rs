//! Reading and writing mesh files by path; the suffix determines the format.

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use beside::Beside;
use meshlod_mesh::Layer;
use write_gltf::write_gltf;
use write_obj::write_obj;
use write_ply::write_ply;

pub use write_needle::{WrittenFile, write_needle};
pub use write_ply::write_ply_stream;

use self::missing_images::note_missing_images;
use crate::error::{IoError, Unsupported};
use crate::files::names::stem;
use crate::format::Format;
use crate::format::facts::Holds;
use crate::gltf;
use crate::gltf::write::levels::{Levels, LodLayout};
use crate::gltf::{GltfStream, StoreFiles, StreamHead};
use crate::memory::{parse, write_to};
use crate::obj::{ObjEnd, ObjStream};
use crate::options::{ReadOptions, WriteOptions};
use crate::scene::Scene;
use replace::replace;

mod beside;
mod images;
pub(crate) mod missing_images;
pub(crate) mod names;
pub(crate) mod replace;
mod staged;
mod write_gltf;
mod write_needle;
mod write_obj;
mod write_ply;

/// Reads a mesh file, and the buffers, images and other files it refers to from its folder.
///
/// Absolute paths of images and material libraries are replaced by their last part, with a note.
///
/// # Errors
/// One line that names the file, the location in it and the reason: an unknown suffix, a missing
/// file, or invalid contents.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Scene, IoError> {
    let path = path.as_ref();
    let format = Format::of_path(path)?;
    let bytes = fs::read(path).map_err(|error| IoError::system(path, error))?;
    let mut beside = Beside::of(path, format);
    let mut resolve = |name: &str| beside.read(name);
    let mut scene = parse(&bytes, format, &mut resolve, options)
        .map_err(|error| IoError::parse(path, error))?;
    note_missing_images(&mut scene, path.parent());
    scene.notes.extend(Some(beside.note()).filter(|note| note.count > 0));
    if let [only] = &mut scene.meshes[..]
        && only.name.is_empty()
        && scene.source.is_none()
    {
        only.name = stem(path);
    }
    Ok(scene)
}

/// Ends an OBJ file that was read part by part, and loads its materials and images from the folder of
/// `path`.
///
/// # Errors
/// As those of [`ObjStream::finish`].
pub fn finish_obj_stream(path: &Path, stream: ObjStream) -> Result<ObjEnd, IoError> {
    let mut beside = Beside::of(path, Format::Obj);
    let mut end = stream
        .finish(&mut |name: &str| beside.read(name))
        .map_err(|error| IoError::parse(path, error))?;
    note_missing_images(&mut end.scene, path.parent());
    end.scene.notes.extend(Some(beside.note()).filter(|note| note.count > 0));
    Ok(end)
}

/// Opens a glTF or GLB file to read its geometry in passing, if the file and its buffers, or what is
/// compressed in them, have at least a number of bytes and it is no other tile; the layers of corners
/// are those that are kept.
///
/// The scene has what [`read()`] gives but the values of its meshes; it is not to be written.
///
/// # Errors
/// As those of [`read()`]. An index that is too large is only found when its triangle is read.
pub fn open_gltf_stream(
    path: &Path,
    least: u64,
    files: Arc<dyn StoreFiles>,
    keeps: fn(&Layer) -> bool,
) -> Result<Option<(GltfStream, Scene)>, IoError> {
    let file = files.open(path).map_err(|error| IoError::system(path, error))?;
    let parse = |error| IoError::parse(path, error);
    let length = file.length();
    let head = match StreamHead::read(file) {
        Ok(head) => head.filter(|head| head.bytes() >= least),
        // A small file tells it when it is read as a whole.
        Err(_) if length < least => None,
        Err(error) => return Err(parse(error)),
    };
    let Some(head) = head else { return Ok(None) };
    let mut beside = Beside::of(path, Format::Gltf);
    let opened = |name: &str| beside.find(name).and_then(|path| files.open(&path).ok());
    let document = head.load(&files, opened).map_err(parse)?;
    let opened = GltfStream::open(document, &mut |name| beside.read(name), keeps).map_err(parse)?;
    Ok(opened.map(|(stream, mut scene)| {
        note_missing_images(&mut scene, path.parent());
        scene.notes.extend(Some(beside.note()).filter(|note| note.count > 0));
        (stream, scene)
    }))
}

/// Writes a scene as a mesh file, with its `.bin`, `.mtl` and image files beside it.
///
/// Files are written under temporary names and renamed once all are complete, the one at `path`
/// last, so that versions never mix: if the old file uses a different buffer or library, the new
/// one is called `stem-2.bin` or `stem-2.mtl`, and the old one is removed at the end. PLY, STL, OFF
/// and SMF store a single mesh: the result of [`Scene::flatten`]. An existing image with different
/// contents is not overwritten: for OBJ and PLY, the new one is called `image-2.png`; for glTF it
/// is an error. Material libraries that already define the materials of the scene stay.
///
/// # Errors
/// One line that names the file: an unknown suffix, an error of the system, or the part of the
/// scene that the format cannot store. An old file at `path` then stays with its companions, and no
/// new file is left.
pub fn write(path: impl AsRef<Path>, scene: &Scene, options: &WriteOptions) -> Result<(), IoError> {
    let path = path.as_ref();
    let format = Format::of_output(path)?;
    if format.stores().holds != Holds::Document && scene.has_only_points() {
        let reason = "only .glb and .gltf hold points and lines, and there are no faces";
        return Err(IoError::unsupported(path, Unsupported::new("file", reason)));
    }
    match format.stores().holds {
        Holds::Document => write_lods(path, scene, &[], LodLayout::default()),
        Holds::Library => write_obj(path, scene, options.precision),
        Holds::Properties => write_ply(path, scene, options.precision),
        Holds::MeshAlone => write_one(path, |out| write_to(out, scene, format, options)),
    }
}

/// Writes a scene and its coarser levels of detail as glTF or GLB in the given layout.
///
/// See [`gltf::write_lods_glb`] for details.
///
/// # Errors
/// Errors of [`write()`]; also any other suffix, and levels whose number of meshes differs from the
/// scene's.
pub fn write_lods(
    path: impl AsRef<Path>,
    scene: &Scene,
    levels: &[gltf::Level],
    layout: LodLayout,
) -> Result<(), IoError> {
    let path = path.as_ref();
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_output(path)? {
        Format::Glb => {
            let bytes = gltf::write_lods_glb(scene, levels, layout).map_err(unsupported)?;
            write_one(path, |out| out.write_all(&bytes))
        }
        Format::Gltf => {
            let levels = Levels { levels, layout, needle: None };
            write_gltf(path, |name| gltf::write::files(scene, levels, None, name)).map(drop)
        }
        _ => Err(unsupported(Unsupported::new(
            "levels",
            "only .glb and .gltf can store levels of detail; use one of those",
        ))),
    }
}

/// Writes a scene as glTF or GLB with triangle strips in place of faces, and their levels.
///
/// See [`gltf::write_strips_glb`] for details.
///
/// # Errors
/// Errors of [`write()`]; also any other suffix, and strips that do not fit the scene.
pub fn write_strips(
    path: impl AsRef<Path>,
    scene: &Scene,
    strips: &[gltf::StripMesh],
) -> Result<(), IoError> {
    let path = path.as_ref();
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_output(path)? {
        Format::Glb => {
            let bytes = gltf::write_strips_glb(scene, strips).map_err(unsupported)?;
            write_one(path, |out| out.write_all(&bytes))
        }
        Format::Gltf => {
            let written = write_gltf(path, |name| {
                let files = gltf::write::strips::strip_files(scene, strips, name)?;
                Ok((files, gltf::CompressionReport::default()))
            });
            written.map(drop)
        }
        _ => Err(unsupported(Unsupported::new(
            "strips",
            "only .glb and .gltf can store strips; use one of those",
        ))),
    }
}

/// Writes a scene as compressed glTF or GLB; returns the compressed sizes and the quantization
/// error.
///
/// See [`gltf::write_compressed_glb`] for details.
///
/// # Errors
/// Errors of [`write()`]; also any other suffix, and bit counts out of range.
pub fn write_compressed(
    path: impl AsRef<Path>,
    scene: &Scene,
    compression: &gltf::Compression,
) -> Result<gltf::CompressionReport, IoError> {
    let path = path.as_ref();
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_output(path)? {
        Format::Glb => {
            let (bytes, report) =
                gltf::write_compressed_glb(scene, &[], compression).map_err(unsupported)?;
            write_one(path, |out| out.write_all(&bytes))?;
            Ok(report)
        }
        Format::Gltf => write_gltf(path, |name| {
            gltf::write::files(scene, Levels::default(), Some(compression), name)
        }),
        _ => Err(unsupported(Unsupported::new(
            "file",
            "only .glb and .gltf can be compressed; use one of those",
        ))),
    }
}

fn write_one(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), IoError> {
    replace(path, fill).map_err(|error| IoError::system(path, error))
}

#[cfg(test)]
mod tests;
