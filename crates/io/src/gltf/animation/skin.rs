//! Skins: the joints of a mesh, and their inverse bind matrices.

use serde_json::Value;

use crate::gltf::document::Document;
use crate::scene::IDENTITY;

/// Joints of a skin with the matrices from the mesh to each of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skin {
    /// Nodes of the joints, by the indices stored at vertices.
    pub joints: Vec<usize>,
    /// Column-major matrix of each joint, from the mesh's space to the joint's.
    pub inverse_bind: Vec<[[f64; 4]; 4]>,
}

impl Skin {
    /// Reads a skin by index.
    ///
    /// # Errors
    /// The reason why the skin is invalid.
    pub(crate) fn read(document: &Document<'_>, skin: usize) -> Result<Self, String> {
        let json = &document.json["skins"][skin];
        let node_count = document.json["nodes"].as_array().map_or(0, Vec::len);
        let joints = json["joints"].as_array().ok_or("it has no joints")?;
        let node = |joint: &Value| {
            let node = joint.as_u64().map(|node| node as usize).filter(|&node| node < node_count);
            node.ok_or(format!("its joint {joint} is no node of the file"))
        };
        let joints = joints.iter().map(node).collect::<Result<Vec<usize>, _>>()?;
        let Some(accessor) = json.get("inverseBindMatrices") else {
            document.spend("skin", 16 * joints.len()).map_err(|error| error.to_string())?;
            let inverse_bind = vec![IDENTITY; joints.len()];
            return Ok(Self { joints, inverse_bind });
        };
        let accessor = accessor.as_u64().ok_or("its inverseBindMatrices are no accessor")?;
        let read = document.floats(accessor as usize).map_err(|error| error.to_string())?;
        if read.width != 16 || read.count() < joints.len() {
            return Err("it needs an inverse bind matrix for each joint".to_owned());
        }
        let matrix = |values: &[f32; 16]| {
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(values[4 * i + j])))
        };
        let inverse_bind = read.values.as_chunks().0[..joints.len()].iter().map(matrix).collect();
        Ok(Self { joints, inverse_bind })
    }
}
