//! Files in which the levels of a chain are.

use std::path::PathBuf;

use clap::ValueEnum;
use meshlod::Format;

use super::Lods;
use crate::session::failure::Failure;
use crate::session::files;

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub(super) enum ChainLayout {
    /// One glTF; coarser levels are linked by MSFT_lod
    Msft,
    /// One glTF; all levels are nodes of the scene, NAME_LOD0, NAME_LOD1, …, as engines import them
    Scene,
    /// One file a level, the input being NAME_LOD0
    Files,
}

impl ChainLayout {
    /// Returns the layout asked for, or the usual one of the format.
    pub fn of(asked: Option<Self>, format: Format) -> Result<Self, Failure> {
        let is_gltf = format.is_gltf();
        match asked {
            None if is_gltf => Ok(Self::Msft),
            None => Ok(Self::Files),
            Some(layout) if layout == Self::Files || is_gltf => Ok(layout),
            Some(layout) => Err(Failure::usage(format_args!(
                "--layout {} needs .glb or .gltf, which hold several levels",
                layout.name()
            ))),
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Msft => "msft",
            Self::Scene => "scene",
            Self::Files => "files",
        }
    }
}

impl Lods {
    /// Returns the path of the file that says when to show each level.
    pub(super) fn guide_file(&self) -> PathBuf {
        self.output.with_extension("lods.json")
    }

    /// Returns the path of the file that holds a level.
    pub(super) fn file_of(&self, level: usize, layout: ChainLayout) -> PathBuf {
        if layout != ChainLayout::Files {
            return self.output.clone();
        }
        let stem = files::stem(&self.output);
        let suffix = self.output.extension().unwrap_or_default().to_string_lossy();
        self.output.with_file_name(format!("{stem}_LOD{level}.{suffix}"))
    }
}
