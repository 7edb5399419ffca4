//! Encoding of the properties of PLY faces after their vertices.

use std::collections::HashSet;

use meshlod_mesh::{FaceLayer, FaceLayerKind, Layer, WedgeId};

use super::extras::PlyExtras;
use super::layers::free_name;
use super::plan::Plan;
use super::scalar::Scalar;
use super::write::LayerEncoder;

/// Encoder for the properties after the vertices of a face.
pub(super) struct FaceEncoder<'a> {
    plan: &'a Plan<'a>,
    corners: &'a [[WedgeId; 3]],
    uvs: Option<&'a Layer>,
    colors: Option<LayerEncoder<'a>>,
    scalars: Vec<ScalarColumn<'a>>,
}

impl<'a> FaceEncoder<'a> {
    pub fn new(plan: &'a Plan<'a>, extras: &PlyExtras) -> Self {
        let scalars = ScalarColumn::of(plan, extras);
        let Some(attributes) = &plan.mesh.attributes else {
            return Self { plan, corners: &[], uvs: None, colors: None, scalars };
        };
        let colors = plan.colors.map(|i| {
            let layer = &attributes.layers[i];
            let names = ["red", "green", "blue", "alpha"].map(str::to_owned);
            let names = names.into_iter().take(layer.width).collect();
            LayerEncoder::new(layer, names, extras, "face ")
        });
        let uvs = plan.uvs.map(|i| &attributes.layers[i]);
        Self { plan, corners: &attributes.corners, uvs, colors, scalars }
    }

    pub fn properties(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if self.uvs.is_some() {
            lines.push("property list uchar float texcoord".to_owned());
        }
        if self.plan.texture_of_face.is_some() {
            lines.push("property int texnumber".to_owned());
        }
        lines.extend(self.colors.iter().flat_map(LayerEncoder::properties));
        let labels = self.plan.labels.iter();
        lines.extend(labels.map(|l| format!("property {} {}", l.kind.name(), l.property)));
        let scalars = self.scalars.iter();
        lines.extend(scalars.map(|s| format!("property {} {}", s.kind.name(), s.name)));
        lines
    }

    pub fn append(&self, face: usize, block: &mut Vec<u8>) {
        if let Some(uvs) = self.uvs {
            block.push(6);
            let values = self.corners[face].iter().flat_map(|&wedge| uvs.of(wedge));
            values.for_each(|x| block.extend_from_slice(&x.to_le_bytes()));
        }
        if let Some(textures) = &self.plan.texture_of_face {
            block.extend_from_slice(&textures[face].to_le_bytes());
        }
        if let Some(colors) = &self.colors {
            colors.append(Some(self.corners[face][0]), block);
        }
        if let (Some(labels), Some(objects)) = (&self.plan.labels, &self.plan.mesh.objects) {
            labels.kind.append(labels.numbers[objects.of(face) as usize] as f64, block);
        }
        self.scalars.iter().for_each(|scalar| scalar.kind.append(scalar.values[face], block));
    }
}

/// Layer of faces that is a scalar property.
struct ScalarColumn<'a> {
    name: String,
    kind: Scalar,
    values: &'a [f64],
}

impl<'a> ScalarColumn<'a> {
    /// Chooses unique names, and types that hold all values: the type in the file if possible, else
    /// the default one.
    fn of(plan: &'a Plan<'a>, extras: &PlyExtras) -> Vec<Self> {
        let known = ["vertex_indices", "vertex_index", "texcoord", "texnumber"];
        let colors =
            ["red", "green", "blue", "alpha"].into_iter().filter(|_| plan.colors.is_some());
        let label = plan.labels.as_ref().map(|labels| &*labels.property);
        let used = known.into_iter().chain(colors).chain(label);
        let mut used: HashSet<String> = used.map(str::to_owned).collect();
        let layers = plan.mesh.face_layers.iter();
        let scalars = layers.filter(|layer| layer.kind == FaceLayerKind::Other);
        let column = |layer: &'a FaceLayer| {
            let name = free_name(&layer.name, 1, &used).swap_remove(0);
            used.insert(name.clone());
            let known = extras.kind(&format!("face {}", layer.name), Scalar::I32);
            let usual = [known, Scalar::I32, Scalar::U32, Scalar::F32];
            let holds = |kind: &Scalar| layer.values.iter().all(|&value| kind.holds(value));
            let kind = usual.into_iter().find(holds).unwrap_or(Scalar::F64);
            Self { name, kind, values: &layer.values }
        };
        scalars.map(column).collect()
    }
}
