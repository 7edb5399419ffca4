//! Reading and writing mesh files by path; the suffix determines the format.

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use meshlod_mesh::{Mesh, VertexId};

use crate::replace::replace;
use crate::{
    Format, Image, IoError, Note, ParseError, Precision, Scene, Unsupported, gltf, normals, obj,
    off, ply, smf, stl, weld,
};

/// Policy for merging vertices at equal or close positions when a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Choice of the vertices to merge, such as those at bit-identical positions.
    pub weld: Weld,
}

/// Options for writing a mesh file with [`write()`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Precision of coordinates in PLY, OBJ, OFF and SMF. STL and glTF always use 32 bits; glTF
    /// counts them from a centre of the mesh where that is needed, see [`gltf::write_glb`].
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
/// # Errors
/// One line that names the file, the location in it and the reason: an unknown suffix, a missing
/// file, or invalid contents.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Scene, IoError> {
    let format = Format::of_path(path)?;
    let bytes = fs::read(path).map_err(|error| IoError::system(path, error))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut resolve = |name: &str| read_beside(folder, name);
    let mut scene = read_bytes(&bytes, format, &mut resolve, options)
        .map_err(|error| IoError::parse(path, error))?;
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
    let is_gltf = matches!(format, Format::Gltf | Format::Glb);
    let mut scene = match format {
        Format::Gltf | Format::Glb => gltf::read(bytes, resolve, options.weld)?,
        Format::Obj => obj::read(bytes, resolve)?,
        Format::Ply => ply::read_scene(bytes, resolve)?,
        Format::Stl => Scene::from_mesh("", stl::read(bytes)?),
        Format::Off => Scene::from_mesh("", off::read(bytes)?),
        Format::Smf => Scene::from_mesh("", smf::read(bytes)?),
    };
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
    note_missing_images(&mut scene);
    Ok(scene)
}

fn note_missing_images(scene: &mut Scene) {
    let missing = scene.images.iter().filter(|image| image.bytes.is_empty());
    let names: Vec<String> = missing.map(|image| image.name.clone()).collect();
    if !names.is_empty() {
        let (one, many) = ("image that was not found", "images that were not found");
        scene.notes.push(Note::left_out(names.len(), one, many).named(names));
    }
}

/// Writes a scene as a mesh file, with the `.bin`, `.mtl` and image files that belong to it next to
/// it.
///
/// Each file is written under a temporary name in the same folder and renamed when complete, the
/// one at `path` last. PLY, STL, OFF and SMF store a single mesh: the result of [`Scene::flatten`].
/// An existing image with different contents is not overwritten.
///
/// # Errors
/// One line that names the file: an unknown suffix, an error of the system, or the part of the
/// scene that the format cannot store. A file that was at `path` before is then still there.
pub fn write(path: &Path, scene: &Scene, options: &WriteOptions) -> Result<(), IoError> {
    let precision = options.precision;
    match Format::of_path(path)? {
        Format::Gltf | Format::Glb => write_lods(path, scene, &[]),
        Format::Obj => write_obj(path, scene, precision),
        Format::Ply => write_ply(path, scene, precision),
        Format::Stl => write_one(path, |out| stl::write(&scene.shown_mesh(), out)),
        Format::Off => write_one(path, |out| off::write(&scene.shown_mesh(), precision, out)),
        Format::Smf => write_one(path, |out| smf::write(&scene.shown_mesh(), precision, out)),
    }
}

/// Writes a scene and its coarser levels of detail as glTF or GLB, linked by `MSFT_lod`.
///
/// See [`gltf::write_glb`] for details.
///
/// # Errors
/// Errors of [`write()`]; also any other suffix, and levels whose number of meshes differs from the
/// scene's.
pub fn write_lods(path: &Path, scene: &Scene, levels: &[gltf::Level]) -> Result<(), IoError> {
    let unsupported = |error| IoError::unsupported(path, error);
    match Format::of_path(path)? {
        Format::Glb => {
            let bytes = gltf::write_glb(scene, levels).map_err(unsupported)?;
            write_one(path, |out| out.write_all(&bytes))
        }
        Format::Gltf => {
            write_gltf(path, &gltf::write(scene, levels, &stem(path)).map_err(unsupported)?)
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
            let files = gltf::write_strips(scene, strips, &stem(path)).map_err(unsupported)?;
            write_gltf(path, &files)
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
            let (written, report) = gltf::write_compressed(scene, &[], &stem(path), compression)
                .map_err(unsupported)?;
            write_gltf(path, &written)?;
            Ok(report)
        }
        _ => Err(unsupported(Unsupported::new(
            "file",
            "only .glb and .gltf can be compressed; use one of those",
        ))),
    }
}

/// Writes a glTF document after the images and the buffer that it refers to.
fn write_gltf(path: &Path, written: &gltf::GltfFiles) -> Result<(), IoError> {
    for image in &written.images {
        write_image(path, image)?;
    }
    if let Some((name, bytes)) = &written.buffer {
        write_one(&path.with_file_name(name), |out| out.write_all(bytes))?;
    }
    write_one(path, |out| out.write_all(&written.document))
}

/// Gives every corner a vertex of its own, as STL files have them.
fn unweld(mesh: &mut Mesh) {
    mesh.positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    for (i, vertex) in mesh.faces.iter_mut().flatten().enumerate() {
        *vertex = VertexId::new(i);
    }
}

/// Writes the images that materials use beside a PLY file, and then the file.
fn write_ply(path: &Path, scene: &Scene, precision: Precision) -> Result<(), IoError> {
    let used = scene.materials.iter().filter_map(|material| material.base_color_image);
    let used: BTreeSet<usize> = used.collect();
    let mut images = scene.images.clone();
    for &image in used.range(..images.len()) {
        write_beside(path, &mut images[image])?;
    }
    write_one(path, |out| ply::write_named(scene, &images, precision, out))
}

/// Writes an image that was found to the folder of `path`; its name becomes that of the file.
fn write_beside(path: &Path, image: &mut Image) -> Result<(), IoError> {
    if image.bytes.is_empty() {
        return Ok(());
    }
    if let Some(name) = plain_name(path, image) {
        image.name = name;
    }
    write_image(path, image)
}

fn write_obj(path: &Path, scene: &Scene, precision: Precision) -> Result<(), IoError> {
    let library = (!scene.materials.is_empty()).then(|| format!("{}.mtl", stem(path)));
    let mut images = scene.images.clone();
    for image in &mut images {
        write_beside(path, image)?;
    }
    if let Some(name) = &library {
        let named = Scene { materials: scene.materials.clone(), images, ..Scene::default() };
        write_one(&path.with_file_name(name), |out| obj::write_mtl(&named, out))?;
    }
    write_one(path, |out| obj::write(scene, precision, out, library.as_deref()))
}

fn write_one(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), IoError> {
    replace(path, fill).map_err(|error| IoError::system(path, error))
}

/// Writes an image under its name in the folder of `path`, unless it is already there. An existing
/// file with different contents is not overwritten.
fn write_image(path: &Path, image: &Image) -> Result<(), IoError> {
    let Some(name) = inner_path(&image.name) else {
        if is_beside(path, image) {
            return Ok(());
        }
        let reason = "its name points outside the folder; write .glb, which embeds images";
        return Err(IoError::unsupported(
            path,
            Unsupported::new(format!("image {:?}", image.name), reason),
        ));
    };
    let target = path.parent().unwrap_or(Path::new("")).join(name);
    match fs::read(&target) {
        Ok(found) if found == image.bytes => return Ok(()),
        Ok(_) => {
            let reason = "another image of that name already exists; move it, or write .glb";
            return Err(IoError::unsupported(&target, Unsupported::new("image", reason)));
        }
        Err(_) => {}
    }
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder).map_err(|error| IoError::system(folder, error))?;
    }
    write_one(&target, |out| out.write_all(&image.bytes))
}

/// Returns the bare file name of an image whose name points outside the folder, unless the name
/// also leads to that image from `path`.
fn plain_name(path: &Path, image: &Image) -> Option<String> {
    if inner_path(&image.name).is_some() || is_beside(path, image) {
        return None;
    }
    Path::new(&image.name).file_name().map(|name| name.to_string_lossy().into_owned())
}

/// Reports whether the image's name, relative to the folder of `path`, leads to a file of equal
/// bytes.
fn is_beside(path: &Path, image: &Image) -> bool {
    let folder = path.parent().unwrap_or(Path::new(""));
    read_beside(folder, &image.name).is_some_and(|found| found == image.bytes)
}

/// Returns a name as a path if joining it to a folder stays within that folder.
pub(crate) fn inner_path(name: &str) -> Option<PathBuf> {
    let path = Path::new(name);
    let inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    (inside && !name.is_empty()).then(|| path.to_owned())
}

/// Reads the file of that name relative to a folder. Absolute names are rejected: they say nothing
/// on a machine that the file was copied to.
fn read_beside(folder: &Path, name: &str) -> Option<Vec<u8>> {
    // Exporters on Windows write backslashes.
    let names = [name.to_owned(), name.replace('\\', "/")];
    let relative = names.iter().filter(|name| is_relative(Path::new(name)));
    // Only regular files: reading a device might never end.
    let file = relative.map(|name| folder.join(name)).find(|path| path.is_file());
    fs::read(file?).ok()
}

fn is_relative(path: &Path) -> bool {
    !path.components().any(|part| matches!(part, Component::RootDir | Component::Prefix(_)))
}

fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests;
