//! Reading and writing mesh files by path; the suffix determines the format.

use std::fs;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use meshlod_mesh::{Mesh, VertexId};
use serde::{Deserialize, Serialize};

use beside::{Beside, bare_name};
use write_gltf::write_gltf;
use write_obj::write_obj;
use write_ply::write_ply;

use crate::gltf::{Levels, LodLayout};
use crate::replace::replace;
use crate::{
    Format, IoError, Note, ParseError, Precision, Scene, Unsupported, gltf, influences, normals,
    obj, off, ply, remarks, smf, stl, weld,
};

mod beside;
mod images;
mod write_gltf;
mod write_obj;
mod write_ply;

/// Policy for merging vertices at equal or close positions when a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weld {
    /// Keeps the vertices as they are in the file.
    Off,
    /// Merges vertices at bit-identical positions in glTF and STL, which split vertices at seams.
    ///
    /// Each set of attributes of a merged vertex becomes a wedge. Other formats index their
    /// vertices and are left as they are.
    #[default]
    Exact,
    /// Merges vertices within this distance of each other, in model units, in every format.
    Within(f64),
}

/// Options for reading a mesh file with [`read()`] or [`read_bytes`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadOptions {
    /// Choice of the vertices to merge, such as those at bit-identical positions.
    pub weld: Weld,
}

/// Options for writing a mesh file with [`write()`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WriteOptions {
    /// Precision of coordinates in PLY, OBJ, OFF, SMF and text STL. Binary STL and glTF always use
    /// 32 bits; glTF counts them from a centre of the mesh where that is needed, see
    /// [`gltf::write_glb`].
    pub precision: Precision,
}

/// Callback that loads the files a mesh file refers to by name: buffers, images, material
/// libraries.
///
/// It receives the name as the file has it, with `%20` and other escapes decoded, and returns
/// `None` if there is no such file.
pub type Resolve<'a> = &'a mut dyn FnMut(&str) -> Option<Vec<u8>>;

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
            write_gltf(path, |name| gltf::files(scene, levels, None, name)).map(drop)
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
                let files = gltf::strip_files(scene, strips, name)?;
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
        Format::Gltf => {
            write_gltf(path, |name| gltf::files(scene, Levels::default(), Some(compression), name))
        }
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

/// Returns a name as a path if joining it to a folder stays within that folder, on any system.
pub(crate) fn inner_path(name: &str) -> Option<PathBuf> {
    if bare_name(name).is_some() {
        return None;
    }
    let path = Path::new(name);
    let mut parts = path.components().filter(|part| *part != Component::CurDir).peekable();
    let is_empty = parts.peek().is_none();
    let inside = parts.all(|part| matches!(part, Component::Normal(_)));
    (inside && !is_empty).then(|| path.to_owned())
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests;
