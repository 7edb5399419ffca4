//! Objects made one before they are made coarser.

use clap::Args;
use meshlod::check::Fused;
use meshlod::{Scene, Target, fuse_scene};
use serde_json::{Value, json};

use crate::numbers::{count, faces, plural};
use crate::session::Session;

/// What is made one.
#[derive(Args)]
pub struct Fusing {
    /// Fuse closed objects that intersect into one surface: cut them where they meet, remove the parts
    /// inside, join the rest. Object labels are kept, and ratios refer to the faces before fusing
    #[arg(long)]
    pub fuse: bool,
}

/// What fusing a scene did, and to how many faces that it shows.
pub struct Done {
    pub before: usize,
    after: usize,
    fused: Fused,
}

impl Fusing {
    /// Fuses a scene, if that is wanted.
    pub fn apply(&self, scene: &mut Scene, session: &Session) -> Option<Done> {
        self.fuse.then(|| {
            session.progress.stage("fusing");
            let before = shown_faces(scene);
            let fused = fuse_scene(scene);
            Done { before, after: shown_faces(scene), fused }
        })
    }
}

impl Done {
    /// Whether anything met.
    pub fn is_change(&self) -> bool {
        self.fused != Fused::default()
    }

    /// The target with parts of the faces that there were before.
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
        })
    }

    /// One line.
    pub fn to_text(&self) -> String {
        let Fused { imprint, buried, joined } = self.fused;
        format!(
            "fused: {} to {} ({} cut, {} inner piece{} removed, {} edge{} joined)\n",
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

/// The JSON of what was done, or null.
pub fn to_json(done: Option<&Done>) -> Value {
    done.map_or(Value::Null, Done::to_json)
}

/// The line of what was done, or nothing.
pub fn to_text(done: Option<&Done>) -> String {
    done.map_or(String::new(), Done::to_text)
}

fn shown_faces(scene: &Scene) -> usize {
    scene.instances().iter().map(|place| scene.meshes[place.mesh].mesh.faces.len()).sum()
}
