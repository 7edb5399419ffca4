//! Title picture of the demo page: a sample at several levels of detail, side by side.

use std::path::{Path, PathBuf};

use meshlod::Mesh;
use meshlod::io::write_file;
use meshlod::picture::{Background, Camera, Style, render, side_by_side};

use crate::demo::sample_report::SampleReport;
use crate::page::inline_picture::InlinePicture;
use crate::page::renderer;
use crate::session::failure::Failure;
use crate::text::numbers::count;

/// Width and height of one of its four tiles.
const SIZE: [u32; 2] = [400, 320];

/// Title picture of the demo page, embedded in it and as a file.
pub struct TitlePicture {
    pub file: PathBuf,
    pub picture: InlinePicture,
    /// Number of faces of the mesh in each tile of the picture.
    pub faces: Vec<usize>,
}

impl TitlePicture {
    /// Draws the sample and its levels side by side, leaving out the first level.
    pub fn make(report: &SampleReport, folder: &Path) -> Result<Self, Failure> {
        let subject = &report.subject;
        let levels = report.shown.iter().skip(1);
        let meshes: Vec<&Mesh> = std::iter::once(&subject.mesh).chain(levels).collect();
        let camera = Camera::fit_mesh(meshes[0], &renderer::view(&subject.style, SIZE, 0.96));
        let style =
            Style { size: SIZE, background: Background::Transparent, ..subject.style.wired() };
        let draw = |mesh: &&Mesh| render(mesh, &camera, &style);
        let tiles: Vec<_> =
            meshes.iter().map(draw).collect::<Result<_, _>>().map_err(Failure::new)?;
        let picture = side_by_side(&tiles).map_err(Failure::new)?;
        let file = folder.join("hero.png");
        write_file(&file, &picture.png())?;
        let faces: Vec<usize> = meshes.iter().map(|mesh| mesh.faces.len()).collect();
        let counts: Vec<String> = faces.iter().map(|&faces| count(faces)).collect();
        let alt = format!("{} with {} faces", subject.title, counts.join(", "));
        Ok(Self { file, picture: InlinePicture::new(&picture, alt), faces })
    }
}
