//! Animations of a glTF document, and the poses of its nodes.

mod key_times;
pub(crate) mod packing;
mod sampler;
mod skin;
mod slerp;
mod track;

use glam::{DMat4, DQuat, DVec3};
use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::document::schema::parse_target_name;
use crate::scene::Scene;
use sampler::AnimatedProperty;
pub use skin::Skin;
use track::{Quantity, Track};

/// Animations and skins of a scene, which pose its nodes.
///
/// Parts that cannot be evaluated are left out, with a note on the reason.
#[derive(Clone, Debug, Default)]
pub struct Animator {
    nodes: Vec<RestNode>,
    /// Nodes in an order where each comes after its parent.
    order: Vec<usize>,
    clips: Vec<Clip>,
    skins: Vec<Option<Skin>>,
    /// Reasons for omissions, one line each.
    pub notes: Vec<String>,
}

/// A moment of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Index of the animation in the document.
    pub animation: usize,
    /// Time in seconds.
    pub seconds: f64,
}

/// Transforms and morph weights of the nodes of a scene at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Column-major matrix of each node, from its own space to that of the scene.
    pub worlds: Vec<[[f64; 4]; 4]>,
    /// Weights of the morph targets of the mesh of each node.
    pub weights: Vec<Vec<f64>>,
}

/// Node in its rest pose.
#[derive(Clone, Debug, Default)]
struct RestNode {
    parent: Option<usize>,
    local: Local,
    skin: Option<usize>,
    weights: Vec<f64>,
}

/// Transform of a node to its parent.
#[derive(Clone, Copy, Debug)]
enum Local {
    Parts { translation: DVec3, rotation: DQuat, scale: DVec3 },
    Matrix(DMat4),
}

/// An animation.
#[derive(Clone, Debug)]
struct Clip {
    number: usize,
    channels: Vec<AnimatedChannel>,
}

/// Movement of one property of one node.
#[derive(Clone, Debug)]
struct AnimatedChannel {
    node: usize,
    property: AnimatedProperty,
    track: Track,
}

impl Animator {
    /// Reads the animations and skins of a scene; `None` if it has no glTF document.
    ///
    /// Supported: translations, rotations, scales and weights of morph targets, by steps, linear or
    /// by splines. Other channels, such as `KHR_animation_pointer`, and animations with a damaged
    /// channel are left out with a note.
    ///
    /// Cost: linear in the document.
    /// # References
    /// [Kap20], Animations and appendix C.
    pub fn new(scene: &Scene) -> Option<Self> {
        let contents = &scene.source.as_ref()?.0;
        let animations = contents.json["animations"].as_array();
        let document = Document::new(&contents.json, &contents.buffers).ok()?;
        let mut this = Self::default();
        this.read_nodes(&document, scene);
        for (number, animation) in animations.into_iter().flatten().enumerate() {
            match this.clip(&document, number, animation) {
                Ok(clip) if clip.channels.is_empty() => {}
                Ok(clip) => this.clips.push(clip),
                Err(why) => this.notes.push(format!("animation {number} is left out: {why}")),
            }
        }
        for skin in 0..document.json["skins"].as_array().map_or(0, Vec::len) {
            let read = Skin::read(&document, skin);
            let note = |why: &String| this.notes.push(format!("skin {skin} is left out: {why}"));
            this.skins.push(read.inspect_err(note).ok());
        }
        Some(this)
    }

    /// Returns the number of animations that can be evaluated.
    pub fn animation_count(&self) -> usize {
        self.clips.len()
    }

    /// Chooses at most `most` moments, spread evenly over the animations: key times, then the
    /// midpoints between them. The choice depends only on the animations.
    pub fn moments(&self, most: usize) -> Vec<Moment> {
        let times: Vec<Vec<f64>> = self.clips.iter().map(Clip::key_times).collect();
        let moment = |(clip, seconds): (usize, f64)| {
            let animation: &Clip = &self.clips[clip];
            Moment { animation: animation.number, seconds }
        };
        key_times::choose(&times, most).into_iter().map(moment).collect()
    }

    /// Returns the pose at a moment, or the rest pose without one. An unknown animation also gives
    /// the rest pose.
    pub fn pose(&self, moment: Option<Moment>) -> Pose {
        let mut nodes: Vec<(Local, Vec<f64>)> =
            self.nodes.iter().map(|node| (node.local, node.weights.clone())).collect();
        let clip = moment.and_then(|at| self.clips.iter().find(|clip| clip.number == at.animation));
        for channel in clip.iter().flat_map(|clip| &clip.channels) {
            let (local, weights) = &mut nodes[channel.node];
            let value = channel.track.at(moment.map_or(0.0, |at| at.seconds));
            match channel.property {
                AnimatedProperty::Weights => *weights = value,
                property => local.set(property, &value),
            }
        }
        let mut worlds = vec![DMat4::IDENTITY; nodes.len()];
        for &node in &self.order {
            let parent = self.nodes[node].parent.map_or(DMat4::IDENTITY, |parent| worlds[parent]);
            worlds[node] = parent * nodes[node].0.matrix();
        }
        Pose {
            worlds: worlds.iter().map(DMat4::to_cols_array_2d).collect(),
            weights: nodes.into_iter().map(|(_, weights)| weights).collect(),
        }
    }

    /// Returns the skin of a node, unless it was left out.
    pub fn skin(&self, node: usize) -> Option<&Skin> {
        self.skins.get(self.nodes.get(node)?.skin?)?.as_ref()
    }

    fn read_nodes(&mut self, document: &Document<'_>, scene: &Scene) {
        for (i, node) in scene.nodes.iter().enumerate() {
            let json = &document.json["nodes"][i];
            let index = json["skin"].as_u64();
            self.nodes.push(RestNode {
                parent: None,
                local: Local::of(json, &node.transform),
                skin: index.map(|skin| skin as usize),
                weights: rest_weights(document, json, scene, node.mesh),
            });
        }
        for (parent, node) in scene.nodes.iter().enumerate() {
            node.children.iter().for_each(|&child| self.nodes[child].parent = Some(parent));
        }
        let roots = (0..self.nodes.len()).filter(|&node| self.nodes[node].parent.is_none());
        self.order = roots.collect();
        for i in 0.. {
            let Some(&node) = self.order.get(i) else { break };
            self.order.extend(&scene.nodes[node].children);
        }
    }

    fn clip(
        &mut self,
        document: &Document<'_>,
        number: usize,
        animation: &Value,
    ) -> Result<Clip, String> {
        let mut clip = Clip { number, channels: Vec::new() };
        let channels = animation["channels"].as_array().ok_or("it has no channels")?;
        for (i, channel) in channels.iter().enumerate() {
            let target = &channel["target"];
            let path = target["path"].as_str();
            let Some(property) = path.and_then(AnimatedProperty::named) else {
                let path = path.unwrap_or("nothing");
                self.notes.push(format!(
                    "animation {number}: channel {i} is left out, as it moves {path:?}"
                ));
                continue;
            };
            // A channel without a node is one for extensions.
            let Some(node) = target.get("node") else { continue };
            let node = node.as_u64().map(|node| node as usize);
            let node = node.filter(|&node| node < self.nodes.len());
            let node = node.ok_or(format!("channel {i} moves a node that is not there"))?;
            let channel = self.channel(document, animation, channel, (node, property));
            clip.channels.push(channel.map_err(|why| format!("channel {i}: {why}"))?);
        }
        Ok(clip)
    }

    fn channel(
        &self,
        document: &Document<'_>,
        animation: &Value,
        channel: &Value,
        (node, property): (usize, AnimatedProperty),
    ) -> Result<AnimatedChannel, String> {
        let rest = &self.nodes[node];
        let quantity = match property {
            AnimatedProperty::Weights => Quantity::Numbers(rest.weights.len()),
            AnimatedProperty::Rotation => Quantity::Rotation,
            AnimatedProperty::Translation | AnimatedProperty::Scale => Quantity::Numbers(3),
        };
        if property != AnimatedProperty::Weights && matches!(rest.local, Local::Matrix(_)) {
            return Err(format!("node {node} has a matrix, which animations cannot move"));
        }
        let number = channel["sampler"].as_u64().ok_or("it has no sampler")?;
        let sampler = animation["samplers"].get(number as usize);
        let sampler = sampler.ok_or(format!("sampler {number} is not there"))?;
        let track = Track::read(document, sampler, quantity);
        let track = track.map_err(|why| format!("sampler {number}: {why}"))?;
        Ok(AnimatedChannel { node, property, track })
    }
}

impl Clip {
    /// Lists the distinct key times of all channels in order.
    fn key_times(&self) -> Vec<f64> {
        let tracks = self.channels.iter().map(|channel| channel.track.times());
        let mut times: Vec<f64> = tracks.flatten().copied().collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

impl Local {
    /// Reads the transform of a node in the form of its JSON; `matrix` is the combined transform.
    fn of(json: &Value, matrix: &[[f64; 4]; 4]) -> Self {
        if json.get("matrix").is_some() {
            return Self::Matrix(DMat4::from_cols_array_2d(matrix));
        }
        let numbers = |key: &str, rest: [f64; 4]| {
            let given = json[key].as_array();
            let number = |k: usize| given.and_then(|given| given.get(k)?.as_f64());
            std::array::from_fn(|k| number(k).unwrap_or(rest[k]))
        };
        let [x, y, z, _] = numbers("translation", [0.0; 4]);
        let [sx, sy, sz, _] = numbers("scale", [1.0; 4]);
        let rotation = DQuat::from_array(numbers("rotation", [0.0, 0.0, 0.0, 1.0]));
        let (translation, scale) = (DVec3::new(x, y, z), DVec3::new(sx, sy, sz));
        Self::Parts { translation, rotation: rotation.normalize(), scale }
    }

    fn set(&mut self, property: AnimatedProperty, value: &[f64]) {
        let Self::Parts { translation, rotation, scale } = self else { return };
        match property {
            AnimatedProperty::Translation => *translation = DVec3::from_slice(value),
            AnimatedProperty::Rotation => *rotation = DQuat::from_slice(value),
            AnimatedProperty::Scale => *scale = DVec3::from_slice(value),
            AnimatedProperty::Weights => {}
        }
    }

    fn matrix(&self) -> DMat4 {
        match *self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                DMat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

impl Default for Local {
    fn default() -> Self {
        Self::Matrix(DMat4::IDENTITY)
    }
}

/// Returns the rest weight of each morph target of a node's mesh.
fn rest_weights(
    document: &Document<'_>,
    node: &Value,
    scene: &Scene,
    mesh: Option<usize>,
) -> Vec<f64> {
    let Some(index) = mesh else { return Vec::new() };
    let mesh = &document.json["meshes"][index];
    let primitives = mesh["primitives"].as_array().into_iter().flatten();
    let targets = primitives.map(|primitive| primitive["targets"].as_array().map_or(0, Vec::len));
    let attributes = scene.meshes.get(index).and_then(|mesh| mesh.mesh.attributes.as_ref());
    let layers = attributes.into_iter().flat_map(|attributes| &attributes.layers);
    let of_layers = layers.filter_map(|layer| Some(parse_target_name(&layer.name)?.0 + 1));
    let given = node.get("weights").or(mesh.get("weights")).and_then(Value::as_array);
    let weight = |k: usize| given.and_then(|given| given.get(k)?.as_f64()).unwrap_or(0.0);
    (0..targets.chain(of_layers).max().unwrap_or(0)).map(weight).collect()
}
