//! `info`: prints what a file contains.

mod contents;

use std::path::{Path, PathBuf};

use clap::Args;
use meshlod::measure::{area, volume};
use meshlod::mesh::{Bounds, Connectivity, face_components};
use meshlod::{Mesh, Scene};
use serde::Serialize;
use serde_json::Value;

use crate::options::args::ReadArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::files;
use crate::session::own_files;
use crate::session::several;
use crate::text::numbers::{coordinate, count, faces, value};
use crate::text::table::aligned;
use crate::verbs::info::contents::Contents;

/// Print what a file contains
///
/// Counts, bounds, area, volume, closed or open; textures, skins, animations, instances, extensions
/// and bytes.
#[derive(Args)]
pub struct Info {
    /// Meshes to read, or -
    #[arg(id = "input", value_name = "IN", required = true)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Info {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        several::answer(&self.inputs, session, |path| self.one(path, session))
    }

    fn one(&self, path: &Path, session: &Session) -> Result<Answer, Failure> {
        let file = files::open(path, &self.reading, session)?;
        let stored = own_files::stored(&file).transpose()?;
        let scene = files::scene_of(file, session)?;
        session.progress.stage("inspecting");
        let meshes = scene.meshes.len();
        let file = (!files::is_pipe(path)).then(|| std::fs::metadata(path));
        let file_bytes = file.and_then(Result::ok).map(|file| file.len());
        let contents = Contents::of(&scene, file_bytes, stored.is_some());
        let faces_once = faces_of_meshes(&scene);
        let mesh = scene.into_mesh();
        let facts = Facts::of(&mesh);
        let mut text = format!("{}\n{}{}", files::name(path), facts.text(), contents.text());
        if let Some(stored) = &stored {
            text += &match faces_once == mesh.faces.len() {
                true => "stored as\n".to_owned(),
                false => format!("stored as {}, each mesh once\n", faces(faces_once)),
            };
            let rows = stored.rows.iter().map(|[name, of]| [format!("  {name}"), of.clone()]);
            text += &aligned(&rows.collect::<Vec<_>>());
        }
        let figures = InfoFigures {
            facts,
            file: files::name(path),
            meshes,
            contents,
            stored: stored.map(|stored| StoredFigures { form: stored.json, faces: faces_once }),
        };
        Ok(Answer::new(figures, text))
    }
}

/// All that is printed for programs.
#[derive(Serialize)]
struct InfoFigures<'i> {
    #[serde(flatten)]
    facts: Facts<'i>,
    file: String,
    meshes: usize,
    #[serde(flatten)]
    contents: Contents,
    #[serde(skip_serializing_if = "Option::is_none")]
    stored: Option<StoredFigures>,
}

/// How a file of our own stores its mesh, with the faces of its meshes, each once.
#[derive(Serialize)]
struct StoredFigures {
    #[serde(flatten)]
    form: Value,
    faces: usize,
}

/// Returns the number of faces of the meshes that a scene shows, each once.
fn faces_of_meshes(scene: &Scene) -> usize {
    let mut is_shown = vec![false; scene.meshes.len()];
    scene.instances().iter().for_each(|instance| is_shown[instance.mesh] = true);
    let shown = scene.meshes.iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
    shown.map(|(mesh, _)| mesh.mesh.faces.len()).sum()
}

/// Counts and measurements of a flattened scene, under the keys of JSON.
#[derive(Serialize)]
struct Facts<'m> {
    vertices: usize,
    unreferenced: usize,
    faces: usize,
    degenerate_faces: usize,
    edges: usize,
    boundary_edges: usize,
    non_manifold_edges: usize,
    inconsistent_edges: usize,
    pinched_vertices: usize,
    components: usize,
    objects: usize,
    closed: bool,
    bounds: Bounds,
    diagonal: f64,
    area: f64,
    volume: f64,
    wedges: Option<usize>,
    attributes: Vec<String>,
    materials: &'m [String],
}

impl<'m> Facts<'m> {
    fn of(mesh: &'m Mesh) -> Self {
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let components = face_components(&mesh.faces, mesh.positions.len()).1;
        let bounds = mesh.bounds();
        Self {
            vertices: mesh.positions.len(),
            unreferenced: mesh.used_vertices().iter().filter(|used| !**used).count(),
            faces: mesh.faces.len(),
            degenerate_faces: connectivity.degenerate_faces(),
            edges: connectivity.edge_count(),
            boundary_edges: connectivity.boundary_edges(),
            non_manifold_edges: connectivity.non_manifold_edges(),
            inconsistent_edges: connectivity.inconsistent_edges(),
            pinched_vertices: connectivity.pinched_vertices(),
            components,
            // Objects are the named ones of the file, else connected components.
            objects: mesh.objects.as_ref().map_or(components, labels_in_use),
            closed: connectivity.is_closed(),
            bounds,
            diagonal: bounds.diagonal(),
            area: area(mesh),
            volume: volume(mesh),
            wedges: mesh.attributes.as_ref().map(|attributes| attributes.wedge_count),
            attributes: attributes(mesh),
            materials: mesh.materials.as_ref().map_or(&[], |labels| &labels.names),
        }
    }

    fn text(&self) -> String {
        let number = |name: &str, number: usize| [format!("  {name}"), count(number)];
        let mut rows = vec![number("vertices", self.vertices)];
        // Defects are listed only if there are any.
        let odd = |rows: &mut Vec<_>, name: &str, amount: usize| {
            if amount > 0 {
                rows.push(number(name, amount));
            }
        };
        odd(&mut rows, "  unused", self.unreferenced);
        rows.push(number("faces", self.faces));
        odd(&mut rows, "  degenerate", self.degenerate_faces);
        rows.push(number("edges", self.edges));
        rows.push(number("  boundary", self.boundary_edges));
        rows.push(number("  non-manifold", self.non_manifold_edges));
        odd(&mut rows, "  inconsistent", self.inconsistent_edges);
        odd(&mut rows, "pinched vertices", self.pinched_vertices);
        rows.push(number("components", self.components));
        rows.push(number("objects", self.objects));
        let closed = if self.closed { "yes" } else { "no" };
        rows.push(["  closed".into(), closed.into()]);
        for (name, amount) in
            [("diagonal", self.diagonal), ("area", self.area), ("volume", self.volume)]
        {
            rows.push([format!("  {name}"), value(amount)]);
        }
        aligned(&rows) + &self.lines()
    }

    /// Formats bounds, attributes and materials, which do not fit into columns.
    fn lines(&self) -> String {
        let bounds = &self.bounds;
        let corner = |corner: [f64; 3]| {
            [0, 1, 2].map(|i| coordinate(corner[i], bounds.max[i] - bounds.min[i])).join(" ")
        };
        let mut text = String::new();
        if !bounds.is_empty() {
            text += &format!("  from  {}\n  to    {}\n", corner(bounds.min), corner(bounds.max));
        }
        if let Some(wedges) = self.wedges {
            let names = self.attributes.join(", ");
            text += &format!("  attributes  {names} at {} wedges\n", count(wedges));
        }
        if !self.materials.is_empty() {
            text += &format!("  materials   {}\n", self.materials.join(", "));
        }
        text
    }
}

/// Names the attributes of a mesh: by their type, or by their own names where the type has none.
fn attributes(mesh: &Mesh) -> Vec<String> {
    let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    layers
        .map(|layer| match layer.kind {
            kind if kind.is_named() => layer.name.clone(),
            kind => kind.to_string(),
        })
        .collect()
}

fn labels_in_use(labels: &meshlod::mesh::Labels) -> usize {
    let mut used = vec![false; labels.names.len()];
    labels.of_face.iter().for_each(|&label| used[label as usize] = true);
    used.iter().filter(|used| **used).count()
}
