//! One picture for the top of the page: a sample at several levels, side by side.

use std::path::{Path, PathBuf};

use meshlod::Mesh;
use meshlod::io::write_file;
use meshlod::picture::{Background, Camera, Style, beside, render};

use crate::demo::exhibit::Exhibit;
use crate::failure::Failure;
use crate::numbers::count;
use crate::page::studio;

/// Width and height of one of the four in it.
const SIZE: [u32; 2] = [400, 320];

/// The picture, on the page and as a file.
pub struct Hero {
    pub file: PathBuf,
    pub plate: studio::Plate,
    pub size: [u32; 2],
    /// Of each fish in it.
    pub faces: Vec<usize>,
}

impl Hero {
    /// Draws the input and the levels from the second on.
    pub fn make(exhibit: &Exhibit, folder: &Path) -> Result<Self, Failure> {
        let subject = &exhibit.subject;
        let levels = exhibit.shown.iter().skip(1);
        let meshes: Vec<&Mesh> = std::iter::once(&subject.mesh).chain(levels).collect();
        let camera = Camera::fit_mesh(meshes[0], &studio::view(&subject.look, SIZE, 0.96));
        let style =
            Style { size: SIZE, background: Background::Transparent, ..subject.look.wired() };
        let draw = |mesh: &&Mesh| render(mesh, &camera, &style);
        let tiles: Vec<_> =
            meshes.iter().map(draw).collect::<Result<_, _>>().map_err(Failure::new)?;
        let picture = beside(&tiles).map_err(Failure::new)?;
        let file = folder.join("hero.png");
        write_file(&file, &picture.png())?;
        let faces: Vec<usize> = meshes.iter().map(|mesh| mesh.faces.len()).collect();
        let counts: Vec<String> = faces.iter().map(|&faces| count(faces)).collect();
        let alt = format!("{} with {} faces", subject.title, counts.join(", "));
        let plate = studio::Plate { uri: studio::uri(&picture), alt };
        Ok(Self { file, plate, size: [picture.width(), picture.height()], faces })
    }
}
