//! Options for what may happen to the topology of a mesh.

use clap::{Args, ValueEnum};
use meshlod::mesh::{Conditioning, NearBorders};
use meshlod::{Borders, Topology};

use crate::options::locks::InputScene;
use crate::options::parse::Bound;
use crate::options::tolerance::Tolerance;
use crate::session::Session;
use crate::session::failure::Failure;
use crate::text::numbers::{count, value};

/// Options for what may happen to the topology of a mesh.
#[derive(Args, Clone)]
#[command(next_help_heading = "Constraints")]
pub struct TopologyArgs {
    /// Changes that are allowed to the topology of the surface [default: free]
    #[arg(long, value_name = "KIND")]
    topology: Option<TopologyArg>,
    /// Largest component that may vanish: 5% or a length
    ///
    /// By the diagonal of its bounding box, in model units or relative to the model's diagonal; 1mm
    /// is read for glTF. By default lindstrom-turk and qem have no limit, and with other methods
    /// nothing vanishes.
    #[arg(long, value_name = "SIZE", value_parser = Tolerance::parse, allow_hyphen_values = true)]
    vanish_below: Option<Tolerance>,
    /// Do not sew boundary edges that coincide exactly
    #[arg(long)]
    no_stitch: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TopologyArg {
    /// Components may vanish and handles close (tunnels are filled, rings cut) where that costs less
    /// than simplifying them, borders that lie on each other are sewn together, non-manifold places
    /// may move and come apart, and charts and borders of materials give way where that costs least.
    /// With --error, charts, borders of materials and handles stay; in .mlod files, handles do
    Free,
    /// Closed stays closed, manifold stays manifold, no component vanishes and no handle closes, as
    /// printing and simulation need it
    Keep,
}

impl TopologyArgs {
    /// Returns the limit of components that may vanish.
    pub fn vanish_below(&self, input: &InputScene<'_>) -> Result<Option<Bound>, Failure> {
        if self.topology == Some(TopologyArg::Keep) && self.vanish_below.is_some() {
            return Err(Failure::usage(
                "--vanish-below does not go with --topology keep, with which nothing vanishes",
            ));
        }
        let size = self.vanish_below.as_ref();
        size.map(|size| size.bound_in(input.scene, "--vanish-below", input.path)).transpose()
    }

    /// Returns what may happen to the topology.
    pub fn kind(&self) -> Topology {
        match self.topology {
            Some(TopologyArg::Keep) => Topology::Keep,
            Some(TopologyArg::Free) | None => Topology::Free,
        }
    }

    /// Makes these the options for an output that keeps the topology, and says why if they ask for
    /// more.
    pub fn keep(&mut self, reason: &str) -> Result<(), Failure> {
        let is_free = self.topology == Some(TopologyArg::Free) || self.vanish_below.is_some();
        if is_free {
            return Err(Failure::usage(format_args!(
                "{reason}: leave out --topology free and --vanish-below"
            )));
        }
        self.topology = Some(TopologyArg::Keep);
        Ok(())
    }

    /// Returns the treatment of boundary edges that lie on each other.
    pub fn borders(&self) -> Borders {
        if self.no_stitch { Borders::Keep } else { Borders::Stitch }
    }
}

/// Formats lines about what conditioning has changed in a scene; empty if that is nothing.
pub fn to_text(counts: &Conditioning) -> String {
    let mut text = String::new();
    if counts.stitched_edges > 0 {
        let noun = if counts.stitched_edges == 1 { "pair" } else { "pairs" };
        let edges = count(counts.stitched_edges);
        text += &format!("{edges} {noun} of boundary edges stitched\n");
    }
    if counts.split_vertices > 0 {
        let noun = if counts.split_vertices == 1 { "vertex" } else { "vertices" };
        text += &format!("{} non-manifold {noun} split\n", count(counts.split_vertices));
    }
    text
}

/// Warns of many boundary edges that lie near each other, and names what would join them.
pub fn warn(near: Option<NearBorders>, session: &Session) {
    if let Some(near) = near {
        let distance = value(near.distance);
        session.warn(format_args!(
            "{} of {} boundary edges lie within {distance} of others: --weld {distance} would join them",
            count(near.near_edges),
            count(near.boundary_edges),
        ));
    }
}
