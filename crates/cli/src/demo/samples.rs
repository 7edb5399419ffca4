//! What is shown, and why.

use meshlod::Scene;
use meshlod::picture::{Normals, Wireframe};
use meshlod::samples;

use crate::page::look::{Coat, Look};
use crate::page::subject::Subject;

/// A sample and how it is shown.
pub struct Sample {
    /// Its name as a sample, and that of its files.
    pub name: &'static str,
    pub title: &'static str,
    /// Why it is here: what to look for.
    pub about: &'static str,
    /// Faces to ask for.
    pub faces: usize,
    pub coat: Coat,
    pub normals: Normals,
    /// The colour of edges, to be seen on the coat.
    pub lines: [u8; 3],
    /// How much of the coat they hide.
    pub line_opacity: f32,
    /// Where to look.
    pub direction: [f64; 3],
}

/// Faces that bend by more than this meet in a crease: in radians, about 20°.
const CREASE_RAD: f64 = 0.35;

/// In the order of the page; the first is its picture.
pub const ALL: [Sample; 3] = [
    Sample {
        name: "fish",
        title: "Fish",
        about: "One closed surface with colours, normals and texture coordinates. Thin fins, round \
                eyes and the mouth need their faces; the flanks get by with few. Colours and normals \
                carry over from level to level, and seams stay closed.",
        faces: 20_000,
        coat: Coat::Colors,
        normals: Normals::FromMesh,
        lines: [158, 190, 216],
        line_opacity: 0.55,
        direction: [0.62, -0.28, -1.0],
    },
    Sample {
        name: "gyroid",
        title: "Gyroid",
        about: "A ball cut out of a surface full of tunnels. However few faces are left, no \
                tunnel may close and no bridge may break.",
        faces: 40_000,
        coat: Coat::Plain([214, 186, 150]),
        normals: Normals::Smooth,
        lines: [40, 34, 28],
        line_opacity: 0.8,
        direction: [-0.5, -0.4, -1.0],
    },
    Sample {
        name: "faceted-torus",
        title: "Faceted torus",
        about: "Seventy-two flat facets that meet in creases, each finely subdivided. All but 144 \
                faces could go without any error; no crease may blur.",
        faces: 10_000,
        coat: Coat::Plain([150, 182, 200]),
        normals: Normals::Creased { crease_rad: CREASE_RAD },
        lines: [24, 32, 46],
        line_opacity: 0.8,
        direction: [0.4, 0.8, 0.75],
    },
];

impl Sample {
    /// Makes it.
    pub fn subject(&self) -> Subject {
        let mesh = samples::by_name(self.name, Some(self.faces)).expect("every one is a sample");
        let scene = Scene::from_mesh(self.name, mesh);
        Subject::new([self.name, self.title], scene, |_| self.look())
    }

    fn look(&self) -> Look {
        Look {
            coat: self.coat.clone(),
            normals: self.normals,
            under_lines: self.coat.clone(),
            lines: Wireframe { color: self.lines, width_px: 0.9, opacity: self.line_opacity },
            direction: self.direction,
            up: [0.0, 1.0, 0.0],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_is_of_about_its_size() {
        for sample in &ALL {
            let faces = sample.subject().mesh.faces.len() as f64;
            assert!((faces / sample.faces as f64 - 1.0).abs() < 0.05, "{}: {faces}", sample.name);
        }
    }
}
