//! Instances of a node as separate nodes.

use std::borrow::Cow;

use crate::scene::{Node, Scene};

/// Returns the scene with a child node for each instance of a node's mesh.
///
/// Existing nodes keep their indices.
pub(crate) fn with_copies_as_nodes(scene: &Scene) -> Cow<'_, Scene> {
    if scene.nodes.iter().all(|node| node.instances.is_empty()) {
        return Cow::Borrowed(scene);
    }
    let mut scene = scene.clone();
    for i in 0..scene.nodes.len() {
        if scene.nodes[i].instances.is_empty() {
            continue;
        }
        let mesh = scene.nodes[i].mesh.take();
        for transform in std::mem::take(&mut scene.nodes[i].instances) {
            let copy = scene.nodes.len();
            scene.nodes.push(Node { transform, mesh, ..Node::default() });
            scene.nodes[i].children.push(copy);
        }
    }
    Cow::Owned(scene)
}
