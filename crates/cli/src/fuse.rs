//! Fusing of intersecting objects before simplification.

use clap::Args;
use meshlod::check::Fused;
use meshlod::{Constraints, Scene, Target};
use serde_json::{Value, json};

use crate::numbers::{count, faces, plural};
use crate::session::Session;

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

/// Result of fusing a scene.
pub struct FuseReport {
    pub before: usize,
    after: usize,
    fused: Fused,
}

impl FuseArgs {
    /// Fuses intersecting objects of a scene if `--fuse` is given.
    pub fn apply(&self, scene: &mut Scene, session: &Session) -> Option<FuseReport> {
        if self.fuse {
            session.progress.stage("fusing");
        }
        let before = shown_faces(scene);
        let constraints = Constraints { fuse: self.fuse, ..Constraints::default() };
        let fused = constraints.fuse(scene)?;
        Some(FuseReport { before, after: shown_faces(scene), fused })
    }
}

impl FuseReport {
    /// Returns true if fusing changed the scene.
    pub fn is_change(&self) -> bool {
        self.fused != Fused { left: self.fused.left, ..Fused::default() }
    }

    /// Converts a target ratio to a number of faces, based on the faces before fusing.
    pub fn target(&self, target: Target) -> Target {
        match target {
            Target::Ratio(ratio) => Target::Faces((self.before as f64 * ratio) as usize),
            target => target,
        }
    }

    pub fn to_json(&self) -> Value {
        json!({
            "input_faces": self.before,
            "output_faces": self.after,
            "cut_faces": self.fused.imprint.faces,
            "new_vertices": self.fused.imprint.vertices,
            "buried_faces": self.fused.buried,
            "joined_edges": self.fused.joined,
            "components_not_fused": self.fused.left,
        })
    }

    /// Formats the changes made by fusing as one line.
    pub fn to_text(&self) -> String {
        let Fused { imprint, buried, joined, left } = self.fused;
        let left = match left {
            0 => String::new(),
            left => {
                format!(", {} component{} not fused: open or inside out", count(left), plural(left))
            }
        };
        format!(
            "fused: {} to {} ({} cut, {} inner piece{} removed, {} edge{} joined{left})\n",
            faces(self.before),
            count(self.after),
            count(imprint.faces),
            count(buried),
            plural(buried),
            count(joined),
            plural(joined),
        )
    }
}

/// Returns the changes made by fusing as JSON; `null` without `--fuse`.
pub fn to_json(done: Option<&FuseReport>) -> Value {
    done.map_or(Value::Null, FuseReport::to_json)
}

/// Formats the changes made by fusing as one line; empty without `--fuse`.
pub fn to_text(done: Option<&FuseReport>) -> String {
    done.map_or(String::new(), FuseReport::to_text)
}

fn shown_faces(scene: &Scene) -> usize {
    scene.instances().iter().map(|place| scene.meshes[place.mesh].mesh.faces.len()).sum()
}
