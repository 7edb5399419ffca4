//! Room on disk that tiles need while they are made, estimated before the first byte is written.

use std::io;
use std::path::Path;

use crate::error::TilesError;
use crate::plan::{Look, TileOptions, scatter};
use crate::source::{Source, Triangles};
use crate::survey::Survey;

/// Number of triangles that are cut to see how many bytes their pieces take.
const SAMPLED: usize = 1 << 20;

/// Bytes of contents for each piece of the leaves, with all levels: of geometry, and of each value of
/// a corner. Measured on a terrain with colours and a gyroid of 300,000 to 400,000 faces.
const COMPRESSED: [f64; 2] = [4.3, 0.5];

/// Bytes of contents without compression.
const PLAIN: [f64; 2] = [12.6, 0.8];

/// Bytes of the meshes of all levels, as a multiple of what leaves would take whose blocks had no
/// corner in common; measured likewise.
const ALL_MESHES: f64 = 1.15;

/// Bytes of the images of all levels, as a multiple of those of the model: of each level a quarter.
const ALL_IMAGES: f64 = 4.0 / 3.0;

/// Bytes of a face in the file of a mesh, beside its part of the vertices.
const MESH_FACE: usize = 12;

/// Bytes that tiles need, about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Space {
    /// Pieces of the faces, until the tileset is finished.
    pub pieces: u64,
    /// Meshes that coarser tiles are made from, of all tiles at once.
    pub meshes: u64,
    /// Contents of all tiles.
    pub contents: u64,
    /// Images of the materials, until the tileset is finished.
    pub images: u64,
}

impl Space {
    /// Estimates the bytes by cutting some triangles of the model. Exact for the pieces of a model
    /// that is not larger than that; about as many corners a face are assumed for the rest.
    ///
    /// # Errors
    /// Errors of the source.
    pub fn estimate(
        survey: &Survey,
        (source, look): (&dyn Source, &Look),
        options: &TileOptions,
    ) -> Result<Self, TilesError> {
        let first = FirstTriangles { source, most: SAMPLED };
        let has_materials = !look.labels.is_empty();
        let (blocks, bytes) = scatter(&first, survey, has_materials, io::sink())
            .map_err(|error| TilesError::system(Path::new(""), error))?;
        let all = || blocks.iter().flatten();
        let pieces: usize = all().map(|block| block.pieces as usize).sum();
        let corners: usize = all().map(|block| block.corners as usize).sum();
        let triangles = survey.faces + survey.degenerate;
        let scale = triangles as f64 / triangles.min(SAMPLED) as f64;
        let layout = source.layout();
        let wedge = if layout.is_empty() { 0 } else { MESH_FACE };
        let face = MESH_FACE + wedge + if has_materials { 4 } else { 0 };
        let meshes = pieces * face + corners * (12 + layout.bytes());
        let [geometry, value] = if options.meshopt { COMPRESSED } else { PLAIN };
        let contents = pieces as f64 * (geometry + value * layout.width() as f64);
        let images: u64 = look.images.iter().map(|image| image.bytes.len() as u64).sum();
        Ok(Self {
            pieces: (bytes as f64 * scale) as u64,
            meshes: (ALL_MESHES * meshes as f64 * scale) as u64,
            contents: (contents * scale) as u64 + (ALL_IMAGES * images as f64) as u64,
            images,
        })
    }

    /// Returns more bytes than a model of so many faces needs, whatever its faces are like.
    pub fn most(survey: &Survey, (source, look): (&dyn Source, &Look)) -> u64 {
        let faces = (survey.faces + survey.degenerate) as u64;
        let corner = 12 + source.layout().bytes() as u64;
        let images: u64 = look.images.iter().map(|image| image.bytes.len() as u64).sum();
        faces * 12 * (corner + 12) + 4 * images
    }

    /// Returns all bytes if the meshes of all tiles are there at once.
    pub fn of_steps(&self) -> u64 {
        self.pieces + self.meshes + self.contents + self.images
    }

    /// Returns all bytes if meshes go as soon as nothing is made from them any more: those that are
    /// there at once belong to so many threads.
    pub fn of_run(&self, survey: &Survey, threads: usize, most_faces: usize) -> u64 {
        let faces = (survey.faces.max(1)) as u64;
        let at_once = (threads * 8 * most_faces * usize::from(survey.tree.depth())) as u64;
        let meshes = self.meshes as f64 * (at_once as f64 / faces as f64).min(1.0);
        self.pieces + meshes as u64 + self.contents + self.images
    }
}

/// Returns the bytes that are free on the disk of a folder, which need not be there; `None` if the
/// system does not say.
pub fn free_space(folder: &Path) -> Option<u64> {
    let folder = std::path::absolute(folder).ok()?;
    let there = folder.ancestors().find(|folder| folder.exists())?;
    fs4::available_space(there).ok()
}

/// First triangles of a source.
struct FirstTriangles<'a> {
    source: &'a dyn Source,
    most: usize,
}

impl Source for FirstTriangles<'_> {
    fn layout(&self) -> &crate::layout::Layout {
        self.source.layout()
    }

    fn triangles(&self, take: &mut dyn FnMut(&Triangles) -> io::Result<()>) -> io::Result<()> {
        let (mut left, width) = (self.most, self.layout().width());
        let mut is_enough = false;
        let done = self.source.triangles(&mut |some| {
            if some.places.len() <= left {
                left -= some.places.len();
                take(some)?;
            } else {
                let mut part = some.clone();
                part.resize(left, width);
                left = 0;
                take(&part)?;
            }
            is_enough = left == 0;
            // Ends the source early.
            if is_enough { Err(io::ErrorKind::Interrupted.into()) } else { Ok(()) }
        });
        if is_enough { Ok(()) } else { done }
    }
}
