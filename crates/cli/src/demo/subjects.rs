//! What is shown, and why.

use meshlod::Mesh;
use meshlod::mesh::sample;
use meshlod::picture::{Normals, Paint};

/// A sample and how it is shown.
pub struct Subject {
    /// Its name as a sample, and that of its files.
    pub name: &'static str,
    pub title: &'static str,
    /// Why it is here: what to look for.
    pub about: &'static str,
    /// Faces to ask for.
    pub faces: usize,
    pub paint: fn() -> Paint<'static>,
    pub normals: Normals,
    /// The colour of edges, to be seen on the paint.
    pub lines: [u8; 3],
    /// How much of the paint they hide.
    pub line_opacity: f32,
    /// Where to look.
    pub direction: [f64; 3],
}

/// Faces that bend by more than this meet in a crease: in radians, about 20°.
const CREASE_RAD: f64 = 0.35;

/// In the order of the page; the first is its picture.
pub const ALL: [Subject; 3] = [
    Subject {
        name: "fish",
        title: "Fish",
        about: "One closed surface with colours, normals and texture coordinates. Thin fins, round \
                eyes and a mouth need their faces; the flanks can do with few. Colours and normals \
                go along from level to level, and seams stay shut.",
        faces: 20_000,
        paint: || Paint::Colors,
        normals: Normals::FromMesh,
        lines: [158, 190, 216],
        line_opacity: 0.55,
        direction: [0.62, -0.28, -1.0],
    },
    Subject {
        name: "gyroid",
        title: "Gyroid",
        about: "A ball cut out of a surface full of tunnels. However few faces are left, no \
                tunnel may close and no bridge may break.",
        faces: 40_000,
        paint: || Paint::Plain([214, 186, 150]),
        normals: Normals::Smooth,
        lines: [40, 34, 28],
        line_opacity: 0.8,
        direction: [-0.5, -0.4, -1.0],
    },
    Subject {
        name: "faceted-torus",
        title: "Faceted torus",
        about: "Seventy-two flat facets that meet in creases, each split finely. All but 144 faces \
                could go at no error at all; no crease may blur.",
        faces: 10_000,
        paint: || Paint::Plain([150, 182, 200]),
        normals: Normals::Creased { crease_rad: CREASE_RAD },
        lines: [24, 32, 46],
        line_opacity: 0.8,
        direction: [0.4, 0.8, 0.75],
    },
];

impl Subject {
    pub fn mesh(&self) -> Mesh {
        sample::by_name(self.name, Some(self.faces)).expect("every subject is a sample")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subject_is_a_sample_of_about_its_size() {
        for subject in &ALL {
            let faces = subject.mesh().faces.len() as f64;
            assert!((faces / subject.faces as f64 - 1.0).abs() < 0.05, "{}: {faces}", subject.name);
        }
    }
}
