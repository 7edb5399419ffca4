//! Reading and writing mesh files by path; the suffix determines the format.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use meshlod_mesh::{Mesh, VertexId, weld};

use beside::Beside;
use names::bare_name;
use write_gltf::write_gltf;
use write_obj::write_obj;
use write_ply::write_ply;

use crate::error::{IoError, ParseError, Unsupported};
use crate::files::names::stem;
use crate::format::Format;
use crate::gltf::write::levels::{Levels, LodLayout};
use crate::notes::Note;
use crate::options::{ReadOptions, Resolve, Weld, WriteOptions};
use crate::scene::{Scene, influences, normals};
use crate::{gltf, obj, off, ply, remarks, smf, stl};
use replace::replace;

mod beside;
mod images;
pub(crate) mod names;
pub(crate) mod replace;
mod staged;
mod write_gltf;
mod write_obj;
mod write_ply;

/// Reads a mesh file and the files that it refers to, such as buffers and images, from its folder.
///
/// Images and material libraries with absolute paths are read from that folder, too, by the last
/// part of their names, with a note.
///
/// # Errors
/// One line that names the file, the location in it and the reason: an unknown suffix, a missing
/// file, or invalid contents.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Scene, IoError> {
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

/// Parses the contents of a mesh file held in memory; `resolve` loads the files that it refers to.
///
/// # Errors
/// The location and the reason if the contents are invalid.
pub fn read_bytes(
    bytes: &[u8],
    format: Format,
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, ParseError> {
    let mut scene = parse(bytes, format, resolve, options)?;
    note_missing_images(&mut scene, None);
    Ok(scene)
}

fn parse(
    bytes: &[u8],
    format: Format,
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, ParseError> {
    let is_gltf = matches!(format, Format::Gltf | Format::Glb);
    let mut scene = match format {
        Format::Gltf | Format::Glb => gltf::read(bytes, resolve, options.weld)?,
        Format::Obj => obj::read(bytes, resolve)?,
        Format::Ply => ply::read_scene(bytes, resolve)?,
        Format::Stl => stl::read_scene(bytes)?,
        Format::Off => off::read_scene(bytes)?,
        Format::Smf => smf::read_scene(bytes)?,
    };
    if matches!(format, Format::Obj | Format::Off | Format::Smf) {
        scene.ply.remarks = remarks::of_text(bytes);
    }
    // glTF was welded as it was read: its document depends on it.
    let meshes = if is_gltf { &mut [][..] } else { &mut scene.meshes };
    for mesh in meshes {
        match options.weld {
            Weld::Within(epsilon) => drop(weld(&mut mesh.mesh, epsilon)),
            Weld::Off if format == Format::Stl => unweld(&mut mesh.mesh),
            Weld::Exact | Weld::Off => {}
        }
    }
    normals::make_unit(&mut scene);
    influences::note_sums(&mut scene);
    Ok(scene)
}

/// Notes the images without bytes, and where the first was looked for, if that is known.
fn note_missing_images(scene: &mut Scene, folder: Option<&Path>) {
    let missing = scene.images.iter().filter(|image| image.bytes.is_empty());
    let names: Vec<String> = missing.map(|image| image.name.clone()).collect();
    let Some(first) = names.first() else { return };
    let (one, many) = (
        "image that was not found or cannot be used",
        "images that were not found or cannot be used",
    );
    let mut note = Note::left_out(names.len(), one, many);
    if let Some(folder) = folder {
        note = note.remedied(image_remedy(first, folder));
    }
    scene.notes.push(note.named(names));
}

/// Says what to do about an image that a file in a folder names but that is not there.
fn image_remedy(name: &str, folder: &Path) -> String {
    if name.contains("://") {
        return "images are not downloaded; save them beside the model, and name those".to_owned();
    }
    if ["<UDIM>", "<UVTILE>", "%(UDIM)d"].iter().any(|tiles| name.contains(tiles)) {
        return "tiles of UDIM are not read; bake them into one image".to_owned();
    }
    let place = folder.join(bare_name(name).unwrap_or(name));
    format!("put an image at {}", place.display())
}

/// Writes a scene as a mesh file, with the `.bin`, `.mtl` and image files that belong to it next to
/// it.
///
/// Files are written under temporary names and renamed when all are complete, the one at `path`
/// last, so that it never meets the files of another version: where the file there uses a buffer or
/// library that differs, the new one is called `stem-2.bin` or `stem-2.mtl`, and the old one is
/// removed at the end. PLY, STL, OFF and SMF store a single mesh: the result of [`Scene::flatten`].
/// An existing image with different contents is not overwritten: for OBJ and PLY, the new one is
/// called `image-2.png` then; for glTF it is an error. Material libraries that already say what the
/// scene does stay.
///
/// # Errors
/// One line that names the file: an unknown suffix, an error of the system, or the part of the
/// scene that the format cannot store. A file that was at `path` before is then still there, with the
/// files that it uses, and no new one.
pub fn write(path: &Path, scene: &Scene, options: &WriteOptions) -> Result<(), IoError> {
    let precision = options.precision;
    match Format::of_path(path)? {
        Format::Gltf | Format::Glb => write_lods(path, scene, &[], LodLayout::default()),
        Format::Obj => write_obj(path, scene, precision),
        Format::Ply => write_ply(path, scene, precision),
        Format::Stl => write_one(path, |out| stl::write_scene(scene, precision, out)),
        Format::Off => write_one(path, |out| off::write_scene(scene, precision, out)),
        Format::Smf => write_one(path, |out| smf::write_scene(scene, precision, out)),
    }
}

/// Writes a scene and its coarser levels of detail as glTF or GLB, laid out as asked.
///
/// See [`gltf::write_glb`] for details.
///
/// # Errors
/// Errors of [`write()`]; also any other suffix, and levels whose number of meshes differs from the
/// scene's.
pub fn write_lods(
    path: &Path,
    scene: &Scene,
    levels: &[gltf::Level],
    layout: LodLayout,
) -> Result<(), IoError> {
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_path(path)? {
        Format::Glb => {
            let bytes = gltf::write_lods_glb(scene, levels, layout).map_err(unsupported)?;
            write_one(path, |out| out.write_all(&bytes))
        }
        Format::Gltf => {
            let levels = Levels { levels, layout };
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
pub fn write_strips(path: &Path, scene: &Scene, strips: &[gltf::StripMesh]) -> Result<(), IoError> {
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_path(path)? {
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
    path: &Path,
    scene: &Scene,
    compression: &gltf::Compression,
) -> Result<gltf::CompressionReport, IoError> {
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_path(path)? {
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

/// Gives every corner a vertex of its own, as STL files have them.
fn unweld(mesh: &mut Mesh) {
    mesh.positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    for (i, vertex) in mesh.faces.iter_mut().flatten().enumerate() {
        *vertex = VertexId::new(i);
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
