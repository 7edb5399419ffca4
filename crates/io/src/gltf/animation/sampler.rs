//! Samplers of animations: key times, interpolation and the animated property.

use serde_json::Value;

use crate::gltf::document::Document;
use crate::gltf::document::accessor::Values;

/// Interpolation between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolation {
    Linear,
    Step,
    /// Hermite splines; each key has a tangent before its value and one after it.
    CubicSpline,
}

/// Property of a node that animations move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum AnimatedProperty {
    Translation,
    Rotation,
    Scale,
    /// Weights of morph targets.
    Weights,
}

impl AnimatedProperty {
    /// Returns the property of this name; `None` for properties of extensions.
    pub(crate) fn named(path: &str) -> Option<Self> {
        match path {
            "translation" => Some(Self::Translation),
            "rotation" => Some(Self::Rotation),
            "scale" => Some(Self::Scale),
            "weights" => Some(Self::Weights),
            _ => None,
        }
    }
}

/// Arrays of a sampler with at least one key.
pub(crate) struct Sampler {
    pub(crate) interpolation: Interpolation,
    /// Key times in seconds, strictly increasing.
    pub(crate) times: Vec<f32>,
    /// Values at these times; their number is unchecked.
    pub(crate) output: Values,
}

impl Sampler {
    /// Reads a sampler of an animation.
    ///
    /// # Errors
    /// An unknown interpolation, missing accessors, or times that do not increase.
    pub(crate) fn read(document: &Document<'_>, sampler: &Value) -> Result<Self, String> {
        let interpolation = match sampler.get("interpolation").map(Value::as_str) {
            None | Some(Some("LINEAR")) => Interpolation::Linear,
            Some(Some("STEP")) => Interpolation::Step,
            Some(Some("CUBICSPLINE")) => Interpolation::CubicSpline,
            Some(other) => {
                return Err(format!("its interpolation is {:?}", other.unwrap_or_default()));
            }
        };
        let read = |key: &str| {
            let index = sampler[key].as_u64().ok_or(format!("its {key} is no accessor"))?;
            document.floats(index as usize).map_err(|error| error.to_string())
        };
        let (input, output): (Values, Values) = (read("input")?, read("output")?);
        if input.width != 1 || input.values.is_empty() {
            return Err("its input must be one time or more".to_owned());
        }
        if let Some(at) = input.values.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(format!("its times do not rise at key {}", at + 1));
        }
        Ok(Self { interpolation, times: input.values, output })
    }
}
