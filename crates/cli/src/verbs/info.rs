//! `info`: prints what a file contains.

mod contents;

use std::path::PathBuf;

use clap::Args;
use meshlod::measure::{area, volume};
use meshlod::mesh::{Connectivity, face_components};
use meshlod::{Mesh, Scene};
use serde_json::{Value, json};

use crate::answer::Answer;
use crate::args::ReadArgs;
use crate::failure::Failure;
use crate::files;
use crate::numbers::{coordinate, count, faces, value};
use crate::own_files::{self, OwnFormat};
use crate::session::Session;
use crate::table::aligned;
use crate::verbs::info::contents::Contents;

/// Print what a file contains: counts, bounds, area, volume, closed or open; textures, skins,
/// animations, instances, extensions and bytes
#[derive(Args)]
pub struct Info {
    /// Mesh to read, or -
    #[arg(value_name = "IN")]
    input: PathBuf,
    #[command(flatten)]
    reading: ReadArgs,
}

impl Info {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        let scene = files::read(&self.input, &self.reading, session)?;
        session.progress.stage("inspecting");
        let meshes = scene.meshes.len();
        let file = (!files::is_pipe(&self.input)).then(|| std::fs::metadata(&self.input));
        let file_bytes = file.and_then(Result::ok).map(|file| file.len());
        let own = OwnFormat::of_path(&self.input);
        let stored = own.map(|own| own_files::stored(&self.input, own, session)).transpose()?;
        let contents = Contents::of(&scene, file_bytes, own.is_some());
        let faces_once = faces_of_meshes(&scene);
        let mesh = scene.into_mesh();
        let facts = Facts::of(&mesh);
        let mut json = facts.json();
        json["file"] = files::name(&self.input).into();
        json["meshes"] = meshes.into();
        contents.add_to(&mut json);
        let mut text = format!("{}\n{}{}", files::name(&self.input), facts.text(), contents.text());
        if let Some(stored) = stored {
            json["stored"] = stored.json;
            json["stored"]["faces"] = faces_once.into();
            text += &match faces_once == mesh.faces.len() {
                true => "stored as\n".to_owned(),
                false => format!("stored as {}, each mesh once\n", faces(faces_once)),
            };
            let rows = stored.rows.into_iter().map(|[name, of]| [format!("  {name}"), of]);
            text += &aligned(&rows.collect::<Vec<_>>());
        }
        Ok(Answer::new(json, text))
    }
}

/// Returns the number of faces of the meshes that a scene shows, each once.
fn faces_of_meshes(scene: &Scene) -> usize {
    let mut is_shown = vec![false; scene.meshes.len()];
    scene.instances().iter().for_each(|instance| is_shown[instance.mesh] = true);
    let shown = scene.meshes.iter().zip(is_shown).filter(|(_, is_shown)| *is_shown);
    shown.map(|(mesh, _)| mesh.mesh.faces.len()).sum()
}

/// Counts and measurements of a flattened scene.
struct Facts<'m> {
    mesh: &'m Mesh,
    connectivity: Connectivity,
    components: usize,
    objects: usize,
    unreferenced: usize,
    area: f64,
    volume: f64,
}

impl<'m> Facts<'m> {
    fn of(mesh: &'m Mesh) -> Self {
        let components = face_components(&mesh.faces, mesh.positions.len()).1;
        // Objects are the named ones of the file, else connected components.
        let objects = mesh.objects.as_ref().map_or(components, labels_in_use);
        Self {
            mesh,
            connectivity: Connectivity::new(&mesh.faces, mesh.positions.len()),
            components,
            objects,
            unreferenced: mesh.used_vertices().iter().filter(|used| !**used).count(),
            area: area(mesh),
            volume: volume(mesh),
        }
    }

    fn json(&self) -> Value {
        let Self { mesh, connectivity, .. } = self;
        let bounds = mesh.bounds();
        let box_json =
            (!bounds.is_empty()).then(|| json!({ "min": bounds.min, "max": bounds.max }));
        let materials = mesh.materials.as_ref().map_or(&[][..], |labels| &labels.names);
        json!({
            "vertices": mesh.positions.len(),
            "unreferenced": self.unreferenced,
            "faces": mesh.faces.len(),
            "degenerate_faces": connectivity.degenerate_faces(),
            "edges": connectivity.edge_count(),
            "boundary_edges": connectivity.boundary_edges(),
            "non_manifold_edges": connectivity.non_manifold_edges(),
            "inconsistent_edges": connectivity.inconsistent_edges(),
            "pinched_vertices": connectivity.pinched_vertices(),
            "components": self.components,
            "objects": self.objects,
            "closed": connectivity.is_closed(),
            "bounds": box_json,
            "diagonal": bounds.diagonal(),
            "area": self.area,
            "volume": self.volume,
            "wedges": mesh.attributes.as_ref().map(|attributes| attributes.wedge_count),
            "attributes": self.attributes(),
            "materials": materials,
        })
    }

    fn text(&self) -> String {
        let Self { mesh, connectivity, .. } = self;
        let number = |name: &str, number: usize| [format!("  {name}"), count(number)];
        let mut rows = vec![number("vertices", mesh.positions.len())];
        // Defects are listed only if there are any.
        let odd = |rows: &mut Vec<_>, name: &str, amount: usize| {
            if amount > 0 {
                rows.push(number(name, amount));
            }
        };
        odd(&mut rows, "  unused", self.unreferenced);
        rows.push(number("faces", mesh.faces.len()));
        odd(&mut rows, "  degenerate", connectivity.degenerate_faces());
        rows.push(number("edges", connectivity.edge_count()));
        rows.push(number("  boundary", connectivity.boundary_edges()));
        rows.push(number("  non-manifold", connectivity.non_manifold_edges()));
        odd(&mut rows, "  inconsistent", connectivity.inconsistent_edges());
        odd(&mut rows, "pinched vertices", connectivity.pinched_vertices());
        rows.push(number("components", self.components));
        rows.push(number("objects", self.objects));
        let closed = if connectivity.is_closed() { "yes" } else { "no" };
        rows.push(["  closed".into(), closed.into()]);
        for (name, amount) in
            [("diagonal", mesh.bounds().diagonal()), ("area", self.area), ("volume", self.volume)]
        {
            rows.push([format!("  {name}"), value(amount)]);
        }
        aligned(&rows) + &self.lines()
    }

    /// Formats bounds, attributes and materials, which do not fit into columns.
    fn lines(&self) -> String {
        let bounds = self.mesh.bounds();
        let corner = |corner: [f64; 3]| {
            [0, 1, 2].map(|i| coordinate(corner[i], bounds.max[i] - bounds.min[i])).join(" ")
        };
        let mut text = String::new();
        if !bounds.is_empty() {
            text += &format!("  from  {}\n  to    {}\n", corner(bounds.min), corner(bounds.max));
        }
        if let Some(attributes) = &self.mesh.attributes {
            let names = self.attributes().join(", ");
            text += &format!("  attributes  {names} at {} wedges\n", count(attributes.wedge_count));
        }
        if let Some(labels) = &self.mesh.materials {
            text += &format!("  materials   {}\n", labels.names.join(", "));
        }
        text
    }

    fn attributes(&self) -> Vec<String> {
        let layers = self.mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        layers
            .map(|layer| match layer.kind {
                kind if kind.is_named() => layer.name.clone(),
                kind => kind.to_string(),
            })
            .collect()
    }
}

fn labels_in_use(labels: &meshlod::mesh::Labels) -> usize {
    let mut used = vec![false; labels.names.len()];
    labels.of_face.iter().for_each(|&label| used[label as usize] = true);
    used.iter().filter(|used| **used).count()
}
