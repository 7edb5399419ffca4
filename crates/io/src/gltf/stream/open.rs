//! Pools and runs of a document: what its scene shows.

use std::sync::Arc;

use meshlod_mesh::{Attributes, Layer, LayerKind};
use rustc_hash::FxHashMap;

use super::rows::{AccessorRows, RowsOfAccessors};
use super::survey::{SurveyedMesh, SurveyedPrimitive, survey};
use super::{GltfRun, GltfStream, Odd, Pool};
use crate::error::ParseError;
use crate::gltf::document::Document;
use crate::gltf::document::buffers::Buffers;
use crate::gltf::document::source::{Contents, SourceDocument};
use crate::gltf::read::{Prepared, images, materials, materials_of, nodes};
use crate::notes::{Note, grouped};
use crate::options::{Resolve, Weld};
use crate::remarks;
use crate::scene::flatten::{Placement, union_of_layers};
use crate::scene::{Scene, SceneMesh, normals};

/// Number of vertices that are checked at a time.
const CHECKED: usize = 1 << 12;

/// Largest number of triangles that are shown, unless the file has more bytes.
const MOST_STEPS: usize = 1 << 28;

/// Pools and runs in the making.
struct Opening<'d> {
    document: &'d Document<'d>,
    layers: Vec<Layer>,
    rows: RowsOfAccessors,
    pools: Vec<Pool>,
    /// Pool of an accessor of positions and those of the layers.
    known: FxHashMap<(usize, Vec<Option<usize>>), usize>,
}

impl GltfStream {
    /// Opens a document, and goes once through its vertices; `None` if it shows no face.
    ///
    /// # Errors
    /// As those of [`read`](crate::gltf::read()), but for indices that are too large.
    pub(crate) fn open(
        prepared: Prepared,
        resolve: Resolve<'_>,
        keeps: fn(&Layer) -> bool,
    ) -> Result<Option<(Self, Scene)>, ParseError> {
        let Prepared { json, mut buffers, facts, notes } = prepared;
        let document = Document::new(&json, &buffers)?;
        let mut scene = Scene { notes, ..Scene::default() };
        scene.images = images::read_images(&document, resolve)?;
        scene.materials = materials::materials(&json, scene.images.len())?;
        let count = document.meshes.len();
        let meshes =
            (0..count).map(|mesh| survey(&document, mesh)).collect::<Result<Vec<_>, _>>()?;
        for (index, mesh) in meshes.iter().enumerate() {
            scene.meshes.push(scene_mesh(&document, index, mesh, scene.materials.len())?);
        }
        nodes::read(&document, &mut scene)?;
        scene.ply.remarks = remarks::of_document(&json);
        let (runs, placements, opening) = runs(&document, &meshes, &scene, keeps)?;
        let Opening { layers, rows, pools, .. } = opening;
        let expanded = rows.expanded;
        drop(document);
        buffers.push(expanded)?;
        let contents = Contents {
            json,
            buffers: Buffers::default(),
            weld: Weld::Off,
            emptied: Vec::new(),
            facts,
        };
        scene.source = Some(SourceDocument(Arc::new(contents)));
        let rounding = normals::rounding(&scene);
        let stream = Self { buffers, layers, pools, placements, runs, rounding };
        if stream.runs.is_empty() {
            return Ok(None);
        }
        let notes = stream.check()?;
        scene.notes.extend(notes.into_iter().filter(|note| note.count > 0));
        Ok(Some((stream, scene)))
    }

    /// Goes through all vertices, and notes what is odd.
    fn check(&self) -> Result<[Note; 4], ParseError> {
        let mut all = Odd::default();
        let (mut places, mut values) = (Vec::new(), Vec::new());
        for (pool, Pool { count, .. }) in self.pools.iter().enumerate() {
            for first in (0..*count).step_by(CHECKED) {
                places.clear();
                values.clear();
                let some = (first, CHECKED.min(count - first));
                let odd = self.read(pool, some, &mut places, &mut values)?;
                all.replaced.add(odd.replaced);
                all.scaled += odd.scaled;
                all.bare += odd.bare;
            }
        }
        let replaced = Note::not_finite(all.replaced.values);
        let bare = Note::changed(
            all.bare,
            "normal without a length replaced by that of its face",
            "normals without a length replaced by those of their faces",
        );
        Ok([replaced, normals::scaled_note(all.scaled), bare, self.bare_note()])
    }

    /// Notes the faces that lack normals, although others have them; those of strips and fans without
    /// an area count, too.
    fn bare_note(&self) -> Note {
        let normals = self.layers.iter().position(|layer| layer.kind == LayerKind::Normal);
        let lacks = |run: &&GltfRun| {
            normals.is_some_and(|layer| self.pools[run.pool].values[layer].is_none())
        };
        let all: usize = self.runs.iter().map(|run| run.steps).sum();
        let bare: usize = self.runs.iter().filter(lacks).map(|run| run.steps).sum();
        let what = format!("of {} faces that lack normals, which get their own", grouped(all));
        Note::changed(bare, &what, &what)
    }
}

/// Makes a mesh that has layers, but no values and no faces.
fn scene_mesh(
    document: &Document<'_>,
    index: usize,
    surveyed: &SurveyedMesh,
    count: usize,
) -> Result<SceneMesh, ParseError> {
    let materials = materials_of(document, index, count)?;
    let mut scene_mesh = SceneMesh { materials, ..SceneMesh::default() };
    scene_mesh.name = document.meshes[index].name.clone().unwrap_or_default();
    let layers = surveyed.layers.clone();
    let attributes = Attributes { layers, ..Attributes::default() };
    scene_mesh.mesh.attributes = (!attributes.layers.is_empty()).then_some(attributes);
    Ok(scene_mesh)
}

type Shown<'d> = (Vec<GltfRun>, Vec<Placement>, Opening<'d>);

/// Lists what a scene shows.
fn runs<'d>(
    document: &'d Document<'d>,
    meshes: &[SurveyedMesh],
    scene: &Scene,
    keeps: fn(&Layer) -> bool,
) -> Result<Shown<'d>, ParseError> {
    let instances = scene.instances();
    let mut layers = union_of_layers(instances.iter().map(|own| &scene.meshes[own.mesh].mesh));
    layers.retain(keeps);
    let rows = RowsOfAccessors::new(document.buffers);
    let (pools, known) = (Vec::new(), FxHashMap::default());
    let mut opening = Opening { document, layers, rows, pools, known };
    let mut own_runs: Vec<Option<Vec<GltfRun>>> = vec![None; meshes.len()];
    let (mut runs, mut steps) = (Vec::new(), 0usize);
    for (placement, instance) in instances.iter().enumerate() {
        let mesh = instance.mesh;
        if own_runs[mesh].is_none() {
            own_runs[mesh] = Some(opening.runs(&meshes[mesh], &scene.meshes[mesh], scene)?);
        }
        for run in own_runs[mesh].iter().flatten() {
            steps = steps.saturating_add(run.steps);
            runs.push(GltfRun { placement, ..*run });
        }
        if steps > MOST_STEPS.max(document.buffers.stored) {
            let reason = format!("the scene shows more than {MOST_STEPS} faces");
            return Err(ParseError::part(format!("node {}", instance.node), reason));
        }
    }
    Ok((runs, instances.iter().map(Placement::of).collect(), opening))
}

impl Opening<'_> {
    /// Lists the primitives of a mesh that have triangles.
    fn runs(
        &mut self,
        mesh: &SurveyedMesh,
        scene_mesh: &SceneMesh,
        scene: &Scene,
    ) -> Result<Vec<GltfRun>, ParseError> {
        let none = scene.materials.len();
        let mut runs = Vec::with_capacity(mesh.primitives.len());
        for primitive in mesh.primitives.iter().filter(|primitive| primitive.steps() > 0) {
            let material = scene_mesh.materials.get(primitive.label).copied().flatten();
            let document = self.document;
            document.spend(&primitive.part, primitive.corners.saturating_mul(3))?;
            let indices = primitive.indices.map(|indices| self.rows.find(document, indices));
            runs.push(GltfRun {
                pool: self.pool(primitive)?,
                steps: primitive.steps(),
                material: material.unwrap_or(none) as u32,
                mode: primitive.mode,
                indices: indices.transpose()?,
                placement: 0,
            });
        }
        Ok(runs)
    }

    /// Finds the vertices of a primitive.
    fn pool(&mut self, primitive: &SurveyedPrimitive) -> Result<usize, ParseError> {
        let kinds = self.layers.iter().map(|layer| layer.kind);
        let accessors: Vec<Option<usize>> = kinds.map(|kind| primitive.accessor(kind)).collect();
        let key = (primitive.positions, accessors);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let (document, count) = (self.document, primitive.vertices);
        let width: usize = self.layers.iter().map(|layer| layer.width).sum();
        document.spend(&primitive.part, count.saturating_mul(3 + width))?;
        let positions = self.rows.find(document, primitive.positions)?;
        let mut find = |accessor: &Option<usize>| {
            accessor.map(|accessor| self.rows.find(document, accessor)).transpose()
        };
        let values =
            key.1.iter().map(&mut find).collect::<Result<Vec<Option<AccessorRows>>, _>>()?;
        self.pools.push(Pool { count, positions, values });
        self.known.insert(key, self.pools.len() - 1);
        Ok(self.pools.len() - 1)
    }
}
