//! One picture for the top of the page: a subject at several levels, side by side.

use std::path::{Path, PathBuf};

use meshlod::Mesh;
use meshlod::io::write_file;
use meshlod::picture::{Camera, Style, View, beside, render};

use crate::demo::exhibit::Exhibit;
use crate::demo::studio;
use crate::failure::Failure;
use crate::numbers::count;

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
        let levels = exhibit.main_chain().levels.iter().map(|level| &level.mesh);
        let meshes: Vec<&Mesh> =
            std::iter::once(&exhibit.input.mesh).chain(levels.skip(1)).collect();
        let [width, height] = SIZE.map(f64::from);
        let view = View {
            direction: exhibit.subject.direction,
            fill: 0.96,
            fov_rad: studio::FOV_RAD,
            aspect: width / height,
            ..View::default()
        };
        let camera = Camera::fit_mesh(meshes[0], &view);
        let style = Style { size: SIZE, ..studio::wired(exhibit.subject) };
        let draw = |mesh: &&Mesh| render(mesh, &camera, &style);
        let tiles: Vec<_> =
            meshes.iter().map(draw).collect::<Result<_, _>>().map_err(Failure::new)?;
        let picture = beside(&tiles).map_err(Failure::new)?;
        let file = folder.join("hero.png");
        write_file(&file, &picture.png())?;
        let faces: Vec<usize> = meshes.iter().map(|mesh| mesh.faces.len()).collect();
        let counts: Vec<String> = faces.iter().map(|&faces| count(faces)).collect();
        let alt = format!("{} with {} faces", exhibit.subject.title, counts.join(", "));
        let plate = studio::Plate { uri: studio::uri(&picture), alt };
        Ok(Self { file, plate, size: [picture.width(), picture.height()], faces })
    }
}
