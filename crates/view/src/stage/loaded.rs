//! Files read into memory, on any thread.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use meshlod::codec::{Compressed, Malformed};
use meshlod::mesh::Bounds;
use meshlod::model::{MissingParts, ModelScene, ModelSceneError};
use meshlod::multires::{FileError, Hierarchy, ModelFile, Query, UpdateLimits};
use meshlod::picture::Normals;
use meshlod::scene::{OwnedPaint, materials_of, normals_of, single_sided_materials};
use meshlod::{AnyFile, AnyFileError, IoError, Mesh, ReadOptions, Scene};
use thiserror::Error;

use crate::CutModel;

/// File in memory, ready to be shown: a mesh, its appearance, and the other contents of the file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Path of the file.
    pub path: PathBuf,
    /// Size of the file in bytes.
    pub file_bytes: u64,
    /// Surface in world space; the finest level of a multiresolution file.
    pub mesh: Arc<Mesh>,
    /// Colours of the surface.
    pub paint: Arc<OwnedPaint>,
    /// Whether each material is single-sided; see
    /// [`Style::single_sided`](meshlod::picture::Style::single_sided).
    pub single_sided: Arc<[bool]>,
    /// Normals with which the surface is shaded.
    pub normals: Normals,
    /// Box around all faces.
    pub bounds: Bounds,
    /// Contents of the file.
    pub content: LoadedContent,
    /// Time that reading and decoding took.
    pub time: Duration,
    /// Warnings, such as those about images that could not be read.
    pub warnings: Vec<String>,
}

/// Contents of a file, apart from its surface.
#[derive(Clone, Debug)]
pub enum LoadedContent {
    /// A mesh file.
    Mesh,
    /// Levels of detail of a mesh or a height field: a `.mlod` file.
    Levels(Arc<CutModel>),
    /// Compressed geometry that can be drawn from directly: `.mlq`.
    Compressed(Arc<Compressed>),
    /// Compressed geometry to be sent: `.mlz`.
    Transport,
}

/// Reason why a file cannot be shown.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] IoError),
    /// A compressed file cannot be read, or is damaged.
    #[error(transparent)]
    File(#[from] AnyFileError),
    /// A compressed file is damaged.
    #[error("{}: {source}", path.display())]
    Compressed {
        /// Path of the file.
        path: PathBuf,
        /// Description of the defect.
        source: Malformed,
    },
    /// A multiresolution file is damaged.
    #[error("{}: {source}", path.display())]
    Levels {
        /// Path of the file.
        path: PathBuf,
        /// Description of the defect.
        source: FileError,
    },
    /// The scene of a multiresolution file is damaged.
    #[error("{}: {source}", path.display())]
    Scene {
        /// Path of the file.
        path: PathBuf,
        /// Description of the defect.
        source: ModelSceneError,
    },
    /// The file holds no faces.
    #[error("{}: the mesh has no faces", .0.display())]
    Empty(PathBuf),
}

impl LoadedContent {
    /// Returns the kind of file, as a title names it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Mesh => "Mesh",
            Self::Levels(levels) => match levels.levels() {
                Hierarchy::Contractions(_) => "Levels of detail",
                Hierarchy::RightTriangles(_) => "Levels of a height field",
            },
            Self::Compressed(_) => "Compressed mesh",
            Self::Transport => "Compressed mesh, for transport",
        }
    }
}

impl Loaded {
    /// Reads a file: a mesh of any format, or `.mlod`, `.mlq`, `.mlz`.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged, and one without faces.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, LoadError> {
        let start = Instant::now();
        let suffix = path.extension().map(|suffix| suffix.to_string_lossy().to_lowercase());
        let loaded = match suffix.as_deref() {
            Some("mlod") => levels(path),
            Some("mlq" | "mlz") => compressed(path),
            _ => mesh_file(path, options),
        }?;
        match loaded.mesh.faces.is_empty() {
            true => Err(LoadError::Empty(path.to_owned())),
            false => Ok(Self { time: start.elapsed(), ..loaded }),
        }
    }

    /// Wraps a mesh that is in memory already, such as a level; `paint` must match it.
    pub fn from_mesh(name: impl Into<PathBuf>, mesh: Mesh, paint: Arc<OwnedPaint>) -> Self {
        let used = mesh.faces.iter().flatten().map(|v| &mesh.positions[v.index()]);
        Self {
            path: name.into(),
            file_bytes: 0,
            bounds: Bounds::of(used),
            normals: normals_of(&mesh),
            mesh: Arc::new(mesh),
            paint,
            single_sided: Arc::new([]),
            content: LoadedContent::Mesh,
            time: Duration::ZERO,
            warnings: Vec::new(),
        }
    }

    /// Returns the file name without its folder.
    pub fn name(&self) -> String {
        let name = self.path.file_name().unwrap_or(self.path.as_os_str());
        name.to_string_lossy().into_owned()
    }

    fn of(path: &Path, mesh: Mesh, paint: OwnedPaint, content: LoadedContent) -> Self {
        let file_bytes = std::fs::metadata(path).map_or(0, |file| file.len());
        Self { file_bytes, content, ..Self::from_mesh(path, mesh, Arc::new(paint)) }
    }
}

fn mesh_file(path: &Path, options: &ReadOptions) -> Result<Loaded, LoadError> {
    Ok(of_scene(path, meshlod::read(path, options)?, LoadedContent::Mesh))
}

fn of_scene(path: &Path, scene: Scene, content: LoadedContent) -> Loaded {
    let (materials, images) = materials_of(&scene);
    let paint = OwnedPaint::of(&scene, materials);
    let warning =
        |image: meshlod::scene::ImageWarning| format!("image {}: {}", image.name, image.reason);
    let warnings = images.into_iter().map(warning).collect();
    let single_sided = single_sided_materials(&scene).into();
    let loaded = Loaded::of(path, scene.into_mesh(), paint, content);
    Loaded { warnings, single_sided, ..loaded }
}

/// Warning for compressed geometry that is drawn as it is stored.
const SHOWN_ONCE: &str = "each mesh is shown once, as the largest of its instances; decompress the \
                          file to see all";

fn compressed(path: &Path) -> Result<Loaded, LoadError> {
    let damaged = |source| LoadError::Compressed { path: path.to_owned(), source };
    let file = AnyFile::open(path, &ReadOptions::default())?;
    let resident = file.compressed().filter(|bytes| bytes.starts_with(&Compressed::MAGIC));
    let Some(bytes) = resident else {
        return Ok(of_scene(path, file.into_scene()?, LoadedContent::Transport));
    };
    let compressed = Compressed::from_bytes(bytes).map_err(damaged)?;
    let mesh = compressed.decode().map_err(damaged)?;
    let warnings = match ModelScene::unpack(compressed.resources()) {
        Ok(model) if model.is_flat() => Vec::new(),
        Ok(_) => vec![SHOWN_ONCE.into()],
        Err(error) => vec![error.to_string()],
    };
    let paint = paint_of_bare(&mesh);
    let content = LoadedContent::Compressed(Arc::new(compressed));
    Ok(Loaded { warnings, ..Loaded::of(path, mesh, paint, content) })
}

fn levels(path: &Path) -> Result<Loaded, LoadError> {
    let damaged = |source| LoadError::Levels { path: path.to_owned(), source };
    let unfit = |source| LoadError::Scene { path: path.to_owned(), source };
    let file = File::open(path).map_err(|error| IoError::system(path, error))?;
    let file = ModelFile::open(file).map_err(damaged)?;
    let scene = match &file {
        ModelFile::Contractions(archive) => ModelScene::read(archive).map_err(unfit)?,
        ModelFile::HeightField(..) => ModelScene::default(),
    };
    let levels = file.read().map_err(damaged)?;
    let mut cut = levels.cut();
    let finest = cut.update(&Query::uniform(0.0), &UpdateLimits::default());
    finest.map_err(|error| damaged(error.into()))?;
    let finest = cut.level().mesh();
    drop(cut);
    let objects = finest.objects.as_ref().map_or(1, |objects| objects.names.len());
    let (layout, missing) = (scene.layout(objects), scene.missing);
    // What it refuses, the layout does not fit either.
    let shown = scene.into_scene("", finest).map_err(unfit)?;
    let loaded = of_scene(path, shown, LoadedContent::Mesh);
    let model = CutModel::new(levels, &layout).map_err(|error| damaged(error.into()))?;
    let model = model.with_paint(loaded.paint.clone(), loaded.single_sided.clone());
    let mut warnings = missing_parts(&missing);
    warnings.extend(loaded.warnings);
    let content = LoadedContent::Levels(Arc::new(model));
    Ok(Loaded { content, warnings, ..loaded })
}

/// Returns a line for each kind of part that a truncated file lacks.
fn missing_parts(missing: &MissingParts) -> Vec<String> {
    let previews = format!("{} images are shown smaller than they are", missing.previews);
    let images = format!("{} images are missing", missing.images);
    let lines = [
        (missing.scene, "materials and nodes are missing".to_owned()),
        (missing.previews > 0, previews),
        (missing.images > 0, images),
    ];
    let there = lines.into_iter().filter(|(is_missing, _)| *is_missing);
    there.map(|(_, what)| format!("the file is cut off: {what}")).collect()
}

/// Returns the colouring of a mesh without materials.
fn paint_of_bare(mesh: &Mesh) -> OwnedPaint {
    let color = meshlod::mesh::LayerKind::Color(0);
    match mesh.attributes.as_ref().is_some_and(|all| all.layer(color).is_some()) {
        true => OwnedPaint::Colors,
        false => OwnedPaint::CLAY,
    }
}
