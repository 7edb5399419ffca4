//! Files by path: the suffix decides on the format.

use std::fs;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use meshlod_mesh::{Mesh, VertexId};

use crate::replace::replace;
use crate::{
    Format, Image, IoError, ParseError, Precision, Scene, Unsupported, gltf, obj, off, ply, smf,
    stl, weld,
};

/// How vertices at the same place are treated on reading.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Weld {
    /// As the file has them.
    Off,
    /// glTF and STL tear vertices at seams: there those at bit-identical places become one, with a
    /// wedge for each set of attributes. Other formats say themselves what is one.
    #[default]
    Exact,
    /// Those within this distance become one, in model units, in any format.
    Within(f64),
}

/// How a file is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// What becomes one vertex.
    pub weld: Weld,
}

/// How a file is written.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WriteOptions {
    /// Of coordinates in PLY, OBJ, OFF and SMF; STL and glTF have 32 bits always.
    pub precision: Precision,
}

/// Finds the files that a file names, such as buffers, images and material libraries.
///
/// It is given the name as the file has it, `%20` and the like decoded; `None` means not there.
pub type Resolve<'a> = &'a mut dyn FnMut(&str) -> Option<Vec<u8>>;

/// Reads a mesh file and the files that it names, relative to its folder.
///
/// # Errors
/// One line that names the file, the place in it and the reason: an unknown suffix, a file that
/// is not there, wrong contents.
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

/// Reads a mesh file that is in memory; `resolve` gives the files that it names.
///
/// # Errors
/// The place and the reason when the contents are wrong.
pub fn read_bytes(
    bytes: &[u8],
    format: Format,
    resolve: Resolve<'_>,
    options: &ReadOptions,
) -> Result<Scene, ParseError> {
    let mut scene = match format {
        Format::Gltf | Format::Glb => return gltf::read(bytes, resolve, options.weld),
        Format::Obj => obj::read(bytes, resolve)?,
        Format::Ply => Scene::from_mesh("", ply::read(bytes)?),
        Format::Stl => Scene::from_mesh("", stl::read(bytes)?),
        Format::Off => Scene::from_mesh("", off::read(bytes)?),
        Format::Smf => Scene::from_mesh("", smf::read(bytes)?),
    };
    for mesh in &mut scene.meshes {
        match options.weld {
            Weld::Within(epsilon) => drop(weld(&mut mesh.mesh, epsilon)),
            Weld::Off if format == Format::Stl => unweld(&mut mesh.mesh),
            Weld::Exact | Weld::Off => {}
        }
    }
    Ok(scene)
}

/// Writes a scene; files that go with it (`.bin`, `.mtl`, images) come beside.
///
/// Each file is written under another name in the same folder and renamed when complete, the one
/// at `path` last. PLY, STL, OFF and SMF hold one mesh: that of [`Scene::flatten`]. An image that
/// is there already with other bytes is not overwritten.
///
/// # Errors
/// One line that names the file: an unknown suffix, a refusal of the system, or what of the scene
/// the format cannot hold. Then what was at `path` before is still there.
pub fn write(path: &Path, scene: &Scene, options: &WriteOptions) -> Result<(), IoError> {
    let precision = options.precision;
    match Format::of_path(path)? {
        Format::Gltf | Format::Glb => write_lods(path, scene, &[]),
        Format::Obj => write_obj(path, scene, precision),
        Format::Ply => write_one(path, |out| ply::write(&scene.shown_mesh(), precision, out)),
        Format::Stl => write_one(path, |out| stl::write(&scene.shown_mesh(), out)),
        Format::Off => write_one(path, |out| off::write(&scene.shown_mesh(), precision, out)),
        Format::Smf => write_one(path, |out| smf::write(&scene.shown_mesh(), precision, out)),
    }
}

/// Writes a scene and coarser levels of its meshes as glTF or GLB, linked by `MSFT_lod`; see
/// [`gltf::write_glb`].
///
/// # Errors
/// As for [`write()`]; also another suffix, and levels with another number of meshes than the scene.
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
            "only .glb and .gltf hold levels; use one of those",
        ))),
    }
}

/// Writes a scene as small glTF or GLB and tells what that came to; see [`gltf::write_compressed_glb`].
///
/// # Errors
/// As for [`write()`]; also another suffix, and bits that cannot be.
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
            "only .glb and .gltf are written small; use one of those",
        ))),
    }
}

/// Writes a document and what goes with it, the document last.
fn write_gltf(path: &Path, written: &gltf::Written) -> Result<(), IoError> {
    for image in &written.images {
        write_image(path, image)?;
    }
    if let Some((name, bytes)) = &written.buffer {
        write_one(&path.with_file_name(name), |out| out.write_all(bytes))?;
    }
    write_one(path, |out| out.write_all(&written.document))
}

/// Gives every corner a vertex of its own, as STL has them.
fn unweld(mesh: &mut Mesh) {
    mesh.positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    for (i, vertex) in mesh.faces.iter_mut().flatten().enumerate() {
        *vertex = VertexId::new(i);
    }
}

fn write_obj(path: &Path, scene: &Scene, precision: Precision) -> Result<(), IoError> {
    let library = (!scene.materials.is_empty()).then(|| format!("{}.mtl", stem(path)));
    let mut images = scene.images.clone();
    for image in images.iter_mut().filter(|image| !image.bytes.is_empty()) {
        if let Some(name) = plain_name(path, image) {
            image.name = name;
        }
        write_image(path, image)?;
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

/// Writes an image under its name beside `path`, unless it is there; one that differs is not ours
/// to overwrite.
fn write_image(path: &Path, image: &Image) -> Result<(), IoError> {
    let Some(name) = inner_path(&image.name) else {
        if is_beside(path, image) {
            return Ok(());
        }
        let reason = "its name leads out of the folder; write .glb, which holds images inside";
        return Err(IoError::unsupported(
            path,
            Unsupported::new(format!("image {:?}", image.name), reason),
        ));
    };
    let target = path.parent().unwrap_or(Path::new("")).join(name);
    match fs::read(&target) {
        Ok(found) if found == image.bytes => return Ok(()),
        Ok(_) => {
            let reason = "another image of that name is there already; move it, or write .glb";
            return Err(IoError::unsupported(&target, Unsupported::new("image", reason)));
        }
        Err(_) => {}
    }
    if let Some(folder) = target.parent() {
        fs::create_dir_all(folder).map_err(|error| IoError::system(folder, error))?;
    }
    write_one(&target, |out| out.write_all(&image.bytes))
}

/// The file name alone of an image whose name leads out of the folder, unless it leads to that
/// image from `path`, too.
fn plain_name(path: &Path, image: &Image) -> Option<String> {
    if inner_path(&image.name).is_some() || is_beside(path, image) {
        return None;
    }
    Path::new(&image.name).file_name().map(|name| name.to_string_lossy().into_owned())
}

/// Whether the name of an image leads from the folder of `path` to a file of the same bytes.
fn is_beside(path: &Path, image: &Image) -> bool {
    let folder = path.parent().unwrap_or(Path::new(""));
    read_beside(folder, &image.name).is_some_and(|found| found == image.bytes)
}

/// A name as a path that stays within the folder that it is joined to.
pub(crate) fn inner_path(name: &str) -> Option<PathBuf> {
    let path = Path::new(name);
    let inside = path.components().all(|part| matches!(part, Component::Normal(_)));
    (inside && !name.is_empty()).then(|| path.to_owned())
}

/// The file of a name relative to a folder; an absolute one names none, as no file that is passed
/// on can know where things are here.
fn read_beside(folder: &Path, name: &str) -> Option<Vec<u8>> {
    // Exporters on Windows write backslashes.
    let names = [name.to_owned(), name.replace('\\', "/")];
    let relative = names.iter().filter(|name| is_relative(Path::new(name)));
    // A device would be read without end.
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
