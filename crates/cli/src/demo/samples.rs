//! Sample meshes of the demo, with their descriptions and drawing styles.

use meshlod::Scene;
use meshlod::picture::{Normals, Wireframe};
use meshlod::samples;

use crate::page::style::{OwnedPaint, SubjectStyle};
use crate::page::subject::Subject;

/// A sample mesh of the demo, with its description and drawing style.
pub struct DemoSample {
    /// Name of the sample mesh and of its files.
    pub name: &'static str,
    pub title: &'static str,
    /// Description of the sample: the features to look at.
    pub about: &'static str,
    /// Approximate number of faces to generate.
    pub faces: usize,
    pub paint: OwnedPaint,
    pub normals: Normals,
    /// Colour of the wireframe, chosen to stand out from the surface.
    pub line_color: [u8; 3],
    /// Opacity of the wireframe, from 0 to 1.
    pub line_opacity: f32,
    /// Viewing direction of the pictures.
    pub direction: [f64; 3],
}

/// Dihedral angle, in radians, above which an edge is a crease: about 20°.
const CREASE_RAD: f64 = 0.35;

/// Sample meshes in the order of the page; the first is also on the title picture.
pub const ALL: [DemoSample; 3] = [
    DemoSample {
        name: "fish",
        title: "Fish",
        about: "One closed surface with colours, normals and texture coordinates. Thin fins, round \
                eyes and the mouth need their faces; the flanks get by with few. Colours and normals \
                carry over from level to level, and seams stay closed.",
        faces: 20_000,
        paint: OwnedPaint::Colors,
        normals: Normals::FromMesh,
        line_color: [158, 190, 216],
        line_opacity: 0.55,
        direction: [0.62, -0.28, -1.0],
    },
    DemoSample {
        name: "gyroid",
        title: "Gyroid",
        about: "A ball cut out of a surface full of tunnels. However few faces are left, no \
                tunnel may close and no bridge may break.",
        faces: 40_000,
        paint: OwnedPaint::Plain([214, 186, 150]),
        normals: Normals::Smooth,
        line_color: [40, 34, 28],
        line_opacity: 0.8,
        direction: [-0.5, -0.4, -1.0],
    },
    DemoSample {
        name: "faceted-torus",
        title: "Faceted torus",
        about: "Seventy-two flat facets that meet in creases, each finely subdivided. All but 144 \
                faces could go without any error; no crease may blur.",
        faces: 10_000,
        paint: OwnedPaint::Plain([150, 182, 200]),
        normals: Normals::Creased { crease_rad: CREASE_RAD },
        line_color: [24, 32, 46],
        line_opacity: 0.8,
        direction: [0.4, 0.8, 0.75],
    },
];

impl DemoSample {
    /// Generates the sample mesh.
    pub fn subject(&self) -> Subject {
        let mesh = samples::by_name(self.name, Some(self.faces)).expect("every one is a sample");
        let scene = Scene::from_mesh(self.name, mesh);
        Subject::new([self.name, self.title], scene, |_| self.style())
    }

    fn style(&self) -> SubjectStyle {
        SubjectStyle {
            paint: self.paint.clone(),
            normals: self.normals,
            single_sided: Vec::new(),
            wire_paint: self.paint.clone(),
            wireframe: Wireframe {
                color: self.line_color,
                width_px: 0.9,
                opacity: self.line_opacity,
            },
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
