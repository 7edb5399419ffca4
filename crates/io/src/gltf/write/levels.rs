//! Levels of detail of a scene, and their layout in a document.

use meshlod_mesh::Mesh;

use crate::error::Unsupported;

/// Coarser level of detail of a whole scene, to be written to a glTF file.
#[derive(Clone, Debug)]
pub struct Level {
    /// Simplified version of each mesh of the scene, in the same order and with the same material
    /// labels.
    pub meshes: Vec<Mesh>,
    /// Fraction of the screen that the object covers, 0 to 1, below which this level is shown
    /// instead of the finer one.
    pub screen_coverage: f64,
}

/// Layout of the levels of a scene in a glTF document.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LodLayout {
    /// Coarser levels are linked to the finest by `MSFT_lod`; programs that do not know the extension
    /// show the finest alone.
    #[default]
    Linked,
    /// All levels are shown nodes, `NAME_LOD0`, `NAME_LOD1` and so on, children of the node that had
    /// the mesh: the names from which engines build groups of levels.
    Siblings,
}

/// Levels of a scene and sizes of its images, to be written as `NEEDLE_progressive`.
#[derive(Clone, Copy, Debug)]
pub struct NeedleLevels<'a> {
    /// Coarser levels of the scene, finest first; the last goes into the document.
    pub levels: &'a [Level],
    /// Measured error of each level in model units, if known: written to `extras`.
    pub errors: &'a [Option<f64>],
    /// Images in several sizes; all others go into the document as they are.
    pub images: &'a [ImageSizes],
}

/// Image of a scene in several sizes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageSizes {
    /// Index into [`Scene::images`](crate::Scene::images).
    pub image: usize,
    /// The sizes, largest first: the image itself, then smaller ones, at least one. The last goes
    /// into the document.
    pub sizes: Vec<SizedImage>,
}

/// One size of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SizedImage {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Encoded bytes, as PNG, JPEG or WebP.
    pub bytes: Vec<u8>,
}

/// Levels and images to be written as `NEEDLE_progressive`, and the name of the document without its suffix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needle<'a> {
    pub levels: NeedleLevels<'a>,
    pub stem: &'a str,
}

/// Levels of a scene and their layout; [`Levels::default`] has no levels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Levels<'a> {
    pub levels: &'a [Level],
    pub layout: LodLayout,
    /// Written instead of the layout, if there is one.
    pub needle: Option<&'a Needle<'a>>,
}

impl<'a> From<&'a [Level]> for Levels<'a> {
    fn from(levels: &'a [Level]) -> Self {
        Self { levels, ..Self::default() }
    }
}

/// Refuses levels that do not fit a document with this number of meshes.
pub(crate) fn check_levels(levels: &[Level], meshes: usize) -> Result<(), Unsupported> {
    for (k, level) in levels.iter().enumerate() {
        let wrong = |reason| Err(Unsupported::new(format!("level {}", k + 1), reason));
        if level.meshes.len() != meshes {
            let found = level.meshes.len();
            return wrong(format!("has {found} meshes, but the scene has {meshes}"));
        }
        if !(0.0..=1.0).contains(&level.screen_coverage) {
            return wrong(format!(
                "the screen coverage must be in [0, 1], not {}",
                level.screen_coverage
            ));
        }
    }
    Ok(())
}
