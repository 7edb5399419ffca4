//! Fusing of intersecting objects before simplification.

use clap::Args;
use meshlod::check::Fused;
use meshlod::{Constraints, Scene, Target};
use serde::Serialize;

use crate::session::Session;
use crate::text::numbers::{count, faces, plural};

/// Option to fuse objects.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct FuseArgs {
    /// Fuse closed objects that intersect into one surface: cut them where they meet, remove the
    /// parts inside, join the rest. Object labels are kept, and ratios refer to the faces before
    /// fusing
    #[arg(long)]
    pub fuse: bool,
}

/// Changes made by fusing a scene, under the keys of JSON.
#[derive(Clone, Copy, Serialize)]
pub struct FuseReport {
    pub input_faces: usize,
    output_faces: usize,
    cut_faces: usize,
    new_vertices: usize,
    buried_faces: usize,
    joined_edges: usize,
    components_not_fused: usize,
    /// True if anything intersected that could be fused.
    #[serde(skip)]
    pub is_change: bool,
}

impl FuseArgs {
    /// Fuses intersecting objects of a scene if `--fuse` is given.
    pub fn apply(&self, scene: &mut Scene, session: &Session) -> Option<FuseReport> {
        if self.fuse {
            session.progress.stage("fusing");
        }
        let input_faces = shown_faces(scene);
        let constraints = Constraints { fuse: self.fuse, ..Constraints::default() };
        let fused = constraints.fuse(scene)?;
        let Fused { imprint, buried, joined, left } = fused;
        Some(FuseReport {
            input_faces,
            output_faces: shown_faces(scene),
            cut_faces: imprint.faces,
            new_vertices: imprint.vertices,
            buried_faces: buried,
            joined_edges: joined,
            components_not_fused: left,
            is_change: fused != Fused { left, ..Fused::default() },
        })
    }
}

impl FuseReport {
    /// Converts a target ratio to a number of faces, based on the faces before fusing.
    pub fn target(self, target: Target) -> Target {
        match target {
            Target::Ratio(ratio) => Target::Faces((self.input_faces as f64 * ratio) as usize),
            target => target,
        }
    }

    /// Formats the changes made by fusing as one line.
    pub fn to_text(self) -> String {
        let left = match self.components_not_fused {
            0 => String::new(),
            left => {
                format!(", {} component{} not fused: open or inside out", count(left), plural(left))
            }
        };
        format!(
            "fused: {} to {} ({} cut, {} inner piece{} removed, {} edge{} joined{left})\n",
            faces(self.input_faces),
            count(self.output_faces),
            count(self.cut_faces),
            count(self.buried_faces),
            plural(self.buried_faces),
            count(self.joined_edges),
            plural(self.joined_edges),
        )
    }
}

/// Formats the changes made by fusing as one line; empty without `--fuse`.
pub fn to_text(done: Option<&FuseReport>) -> String {
    done.copied().map_or(String::new(), FuseReport::to_text)
}

fn shown_faces(scene: &Scene) -> usize {
    scene.instances().iter().map(|place| scene.meshes[place.mesh].mesh.faces.len()).sum()
}
