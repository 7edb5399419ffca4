//! Material properties that have both a field and MTL statements.

use super::meaning::Meaning;
use crate::scene::material::{Material, MtlMap, MtlStatement};

/// A material property and the statements that set it.
pub(super) struct MtlProperty {
    /// Keywords of the statements, in lower case.
    pub words: &'static [&'static str],
    /// Reports whether the statements agree with the field of a material.
    pub is_stated: fn(&Meaning, &Material) -> bool,
    /// Writes the field of a material as a statement, or returns `None` without an image.
    pub write: fn(&Material) -> Option<MtlStatement>,
}

pub(super) const PROPERTIES: [MtlProperty; 11] = [
    MtlProperty {
        words: &["kd"],
        is_stated: |said, own| said.base_color[..3] == own.base_color[..3],
        write: |own| Some(color(own)),
    },
    MtlProperty {
        words: &["d", "tr"],
        is_stated: |said, own| said.base_color[3] == own.base_color[3],
        write: |own| Some(values("d", &own.base_color[3..])),
    },
    MtlProperty {
        words: &["pr"],
        is_stated: |said, own| said.shading.roughness == own.shading.roughness,
        write: |own| Some(values("Pr", &[own.shading.roughness])),
    },
    MtlProperty {
        words: &["pm"],
        is_stated: |said, own| said.shading.metallic == own.shading.metallic,
        write: |own| Some(values("Pm", &[own.shading.metallic])),
    },
    MtlProperty {
        words: &["ke"],
        is_stated: |said, own| said.shading.emission == own.shading.emission,
        write: |own| Some(values("Ke", &own.shading.emission)),
    },
    MtlProperty {
        words: &["map_kd"],
        is_stated: |said, own| said.base_color_image == own.base_color_image,
        write: |own| map("map_Kd", own.base_color_image),
    },
    MtlProperty {
        words: &["map_pr"],
        is_stated: |said, own| said.shading.roughness_image == own.shading.roughness_image,
        write: |own| map("map_Pr -imfchan g", own.shading.roughness_image),
    },
    MtlProperty {
        words: &["map_pm"],
        is_stated: |said, own| said.shading.metallic_image == own.shading.metallic_image,
        write: |own| map("map_Pm -imfchan b", own.shading.metallic_image),
    },
    MtlProperty {
        words: &["map_ke"],
        is_stated: |said, own| said.shading.emission_image == own.shading.emission_image,
        write: |own| map("map_Ke", own.shading.emission_image),
    },
    MtlProperty {
        words: &["map_d"],
        is_stated: |said, own| said.shading.opacity_image == own.shading.opacity_image,
        write: |own| map("map_d -imfchan m", own.shading.opacity_image),
    },
    MtlProperty {
        words: &["norm", "bump", "map_bump"],
        is_stated: |said, own| {
            let [said, own] = [&said.shading, &own.shading];
            (said.normal_image, said.normal_scale) == (own.normal_image, own.normal_scale)
                || (said.normal_image, own.normal_image) == (None, None)
        },
        write: |own| match own.shading.normal_scale {
            1.0 => map("norm", own.shading.normal_image),
            scale => map(&format!("norm -bm {}", finite(scale)), own.shading.normal_image),
        },
    },
];

/// Writes the colour of a material as a statement.
pub(super) fn color(own: &Material) -> MtlStatement {
    values("Kd", &own.base_color[..3])
}

fn values(word: &str, values: &[f32]) -> MtlStatement {
    let values: String = values.iter().map(|&value| format!(" {}", finite(value))).collect();
    MtlStatement { text: format!("{word}{values}"), map: None }
}

fn finite(value: f32) -> f32 {
    if value.is_finite() { value } else { 0.0 }
}

fn map(words: &str, image: Option<usize>) -> Option<MtlStatement> {
    let map = MtlMap { image: image?, name: String::new(), rest: String::new() };
    Some(MtlStatement { text: format!("{words} "), map: Some(map) })
}
