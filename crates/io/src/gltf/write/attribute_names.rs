//! Names of attributes in glTF for the layers of a mesh.

use std::collections::BTreeMap;

use meshlod_mesh::{Layer, LayerKind, Mesh};

use crate::gltf::document::schema::parse_target_name;

/// Returns the layers of a mesh by the attribute names they are written under.
pub(crate) fn by_attribute(mesh: &Mesh) -> BTreeMap<String, &Layer> {
    let mut named: BTreeMap<String, &Layer> = BTreeMap::new();
    let layers = mesh.attributes.as_ref().map_or(&[][..], |attributes| &attributes.layers);
    for layer in layers {
        let mut name = attribute_name(layer);
        // Names may collide after conversion; no layer is lost.
        while named.contains_key(&name) {
            name.push('_');
        }
        named.insert(name, layer);
    }
    named
}

fn attribute_name(layer: &Layer) -> String {
    match layer.kind {
        LayerKind::Normal => "NORMAL".into(),
        LayerKind::Tangent => "TANGENT".into(),
        LayerKind::Uv(set) => format!("TEXCOORD_{set}"),
        LayerKind::Color(set) => format!("COLOR_{set}"),
        LayerKind::Joints(set) => format!("JOINTS_{set}"),
        LayerKind::Weights(set) => format!("WEIGHTS_{set}"),
        LayerKind::Other | LayerKind::Label if layer.name.starts_with('_') => layer.name.clone(),
        LayerKind::Other if parse_target_name(&layer.name).is_some() => layer.name.clone(),
        // glTF requires custom attribute names to begin with an underscore, in capitals.
        LayerKind::Other | LayerKind::Label => {
            let plain =
                |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '_' };
            format!("_{}", layer.name.chars().map(plain).collect::<String>())
        }
    }
}
