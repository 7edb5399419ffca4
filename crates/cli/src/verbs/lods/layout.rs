//! Files in which the levels of a chain are.

use std::path::PathBuf;

use clap::ValueEnum;
use meshlod::Format;

use super::Lods;
use crate::session::Session;
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
    /// A small glTF, and finer levels and larger textures in NAME_levels, as gltf-progressive loads
    Needle,
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
            Self::Needle => "needle",
        }
    }
}

impl Lods {
    /// Names the files of a chain after the input if the output is a folder, with its suffix.
    ///
    /// # Errors
    /// If the input has no name, and for formats that are only read.
    pub(super) fn name_in_folder(&mut self, session: &Session) -> Result<(), Failure> {
        let is_named = Format::of_path(&self.output).is_ok() || files::is_pipe(&self.output);
        if is_named || !files::is_folder(&self.output) {
            return Ok(());
        }
        if files::is_pipe(&self.input) {
            let folder = files::name(&self.output);
            return Err(Failure::usage(format_args!("{folder}: is a folder; name a file in it")));
        }
        let of_input = Format::of_path(&self.input).ok();
        session.check_format()?;
        let format = session.format().or(of_input);
        let is_fit = |format: &Format| ChainLayout::of(self.layout, *format).is_ok();
        let suffix = format.filter(is_fit).unwrap_or(Format::Glb);
        let stem = files::stem(&self.input);
        self.output = self.output.join(format!("{stem}.{suffix}"));
        match *self.layout.get_or_insert(ChainLayout::Files) {
            ChainLayout::Files => Ok(()),
            _ => files::check_apart(&self.output, &[&self.input]),
        }
    }

    /// Refuses an input in the folder of the levels, whose old files go.
    pub(super) fn check_levels_folder(&self) -> Result<(), Failure> {
        let folder = format!("{}_levels", files::stem(&self.output));
        let folder = self.output.with_file_name(folder).canonicalize();
        let of_input = self.input.parent().and_then(|parent| parent.canonicalize().ok());
        match folder.is_ok_and(|folder| of_input == Some(folder)) {
            true => Err(Failure::at(
                &self.input,
                "is in the folder of levels that OUT replaces; give OUT another name",
            )),
            false => Ok(()),
        }
    }

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
