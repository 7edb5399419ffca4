//! Measured distances between scenes, and their JSON and text.

use std::path::Path;

use meshlod::measure::{
    Bracket, CertifiedDistance, Distance, OneSidedDistance, Place, PreparedSurface,
};
use meshlod::{Mesh, Scene, io::SceneMesh};
use serde::Serialize;

use crate::session::failure::Failure;
use crate::text::numbers;
use crate::text::table::aligned;

/// Joins the meshes of a scene into one surface in world space without attributes, with `meshes` in
/// place of its own.
pub fn surface_of<'m>(scene: &Scene, meshes: impl IntoIterator<Item = &'m Mesh>) -> Mesh {
    let bare = |mesh: &Mesh| Mesh::new(mesh.positions.clone(), mesh.faces.clone());
    let meshes = meshes.into_iter().map(|m| SceneMesh { mesh: bare(m), ..SceneMesh::default() });
    Scene {
        meshes: meshes.collect(),
        nodes: scene.nodes.clone(),
        roots: scene.roots.clone(),
        ..Scene::default()
    }
    .into_mesh()
}

/// Iterates over the meshes of a scene.
pub fn meshes(scene: &Scene) -> impl Iterator<Item = &Mesh> {
    scene.meshes.iter().map(|mesh| &mesh.mesh)
}

/// Prepares a mesh read from a file for distance measurements.
pub fn ready<'m>(mesh: &'m Mesh, path: &Path) -> Result<PreparedSurface<'m>, Failure> {
    PreparedSurface::new(mesh).map_err(|error| Failure::at(path, error))
}

/// Formats the distances in each direction and combined as a table.
pub fn to_table(distance: &Distance) -> String {
    let row = |name: &str, mean: f64, rms: f64, max: f64| {
        let cell = |length| {
            [numbers::value(length), format!("({})", numbers::percent(distance.percent(length)))]
        };
        let ([a, b], [c, d], [e, f]) = (cell(mean), cell(rms), cell(max));
        [name.into(), a, b, c, d, e, f]
    };
    let way = |name, way: &OneSidedDistance| row(name, way.mean, way.rms, way.max);
    aligned(&[
        ["", "mean", "", "RMS", "", "max", ""].map(String::from),
        way("forward", &distance.forward),
        way("backward", &distance.backward),
        row("both", distance.mean(), distance.rms(), distance.max()),
    ])
}

/// Bounds of the maximum distance in each direction and combined, in model units and percent of the
/// diagonal.
#[derive(Serialize)]
pub struct CertifiedFigures {
    #[serde(flatten)]
    both: BracketFigures,
    forward: BracketFigures,
    backward: BracketFigures,
}

#[derive(Serialize)]
struct BracketFigures {
    lower: f64,
    upper: f64,
    lower_percent: f64,
    upper_percent: f64,
    reached: bool,
    place: Place,
}

impl From<&CertifiedDistance> for CertifiedFigures {
    fn from(distance: &CertifiedDistance) -> Self {
        let way = |Bracket { lower, upper, place, reached, .. }: Bracket| {
            let [lower_percent, upper_percent] = [lower, upper].map(|l| distance.percent(l));
            BracketFigures { lower, upper, lower_percent, upper_percent, reached, place }
        };
        Self {
            both: way(distance.symmetric()),
            forward: way(distance.forward),
            backward: way(distance.backward),
        }
    }
}

/// Formats the bounds of the maximum distance in each direction and combined as a table.
pub fn certified_table(distance: &CertifiedDistance) -> String {
    let row = |name: &str, way: Bracket| {
        let cell = |length| {
            [numbers::value(length), format!("({})", numbers::percent(distance.percent(length)))]
        };
        let ([a, b], [c, d]) = (cell(way.lower), cell(way.upper));
        let note = if way.reached { "" } else { "limit of the search reached" };
        [name.into(), a, b, c, d, note.into()]
    };
    let table = aligned(&[
        ["max", "at least", "", "at most", "", ""].map(String::from),
        row("forward", distance.forward),
        row("backward", distance.backward),
        row("both", distance.symmetric()),
    ]);
    format!("\n{table}")
}
