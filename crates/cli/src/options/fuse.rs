//! Fusing of intersecting objects before simplification.

use clap::Args;
use meshlod::Scene;
pub use meshlod::scene::FuseReport;

use crate::session::Session;
use crate::text::numbers::{count, faces, plural};

/// Option to fuse objects.
#[derive(Args)]
#[command(next_help_heading = "Constraints")]
pub struct FuseArgs {
    /// Fuse closed objects that intersect into one surface
    ///
    /// They are cut where they meet, the parts inside are removed, and the rest is joined. Object
    /// labels are kept, and ratios refer to the faces before fusing.
    #[arg(long)]
    pub fuse: bool,
}

impl FuseArgs {
    /// Fuses intersecting objects of a scene if `--fuse` is given.
    pub fn apply(&self, scene: &mut Scene, session: &Session) -> Option<FuseReport> {
        if self.fuse {
            session.progress.stage("fusing");
        }
        self.fuse.then(|| FuseReport::of(scene))
    }
}

/// Formats the changes made by fusing as one line; empty without `--fuse`.
pub fn to_text(done: Option<&FuseReport>) -> String {
    done.map_or(String::new(), line)
}

fn line(fused: &FuseReport) -> String {
    let left = match fused.components_not_fused {
        0 => String::new(),
        left => {
            format!(", {} component{} not fused: open or inside out", count(left), plural(left))
        }
    };
    format!(
        "fused: {} to {} ({} cut, {} inner piece{} removed, {} edge{} joined{left})\n",
        faces(fused.input_faces),
        count(fused.output_faces),
        count(fused.cut_faces),
        count(fused.buried_faces),
        plural(fused.buried_faces),
        count(fused.joined_edges),
        plural(fused.joined_edges),
    )
}
