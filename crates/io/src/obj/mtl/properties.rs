//! Properties of materials that have both a field and statements of MTL.

use super::meaning::Meaning;
use crate::{Material, MtlMap, MtlStatement};

/// Property of a material, and the statements that say it.
pub(super) struct Property {
    /// Words of the statements, in lower case.
    pub words: &'static [&'static str],
    /// Reports whether statements say what a material has.
    pub is_said: fn(&Meaning, &Material) -> bool,
    /// Writes what a material has as a statement, if it takes one.
    pub write: fn(&Material) -> Option<MtlStatement>,
}

pub(super) const PROPERTIES: [Property; 11] = [
    Property {
        words: &["kd"],
        is_said: |said, own| said.base_color[..3] == own.base_color[..3],
        write: |own| Some(values("Kd", &own.base_color[..3])),
    },
    Property {
        words: &["d", "tr"],
        is_said: |said, own| said.base_color[3] == own.base_color[3],
        write: |own| Some(values("d", &own.base_color[3..])),
    },
    Property {
        words: &["pr"],
        is_said: |said, own| said.surface.roughness == own.surface.roughness,
        write: |own| Some(values("Pr", &[own.surface.roughness])),
    },
    Property {
        words: &["pm"],
        is_said: |said, own| said.surface.metallic == own.surface.metallic,
        write: |own| Some(values("Pm", &[own.surface.metallic])),
    },
    Property {
        words: &["ke"],
        is_said: |said, own| said.surface.emission == own.surface.emission,
        write: |own| Some(values("Ke", &own.surface.emission)),
    },
    Property {
        words: &["map_kd"],
        is_said: |said, own| said.base_color_image == own.base_color_image,
        write: |own| map("map_Kd", own.base_color_image),
    },
    Property {
        words: &["map_pr"],
        is_said: |said, own| said.surface.roughness_image == own.surface.roughness_image,
        write: |own| map("map_Pr -imfchan g", own.surface.roughness_image),
    },
    Property {
        words: &["map_pm"],
        is_said: |said, own| said.surface.metallic_image == own.surface.metallic_image,
        write: |own| map("map_Pm -imfchan b", own.surface.metallic_image),
    },
    Property {
        words: &["map_ke"],
        is_said: |said, own| said.surface.emission_image == own.surface.emission_image,
        write: |own| map("map_Ke", own.surface.emission_image),
    },
    Property {
        words: &["map_d"],
        is_said: |said, own| said.surface.opacity_image == own.surface.opacity_image,
        write: |own| map("map_d -imfchan m", own.surface.opacity_image),
    },
    Property {
        words: &["norm", "bump", "map_bump"],
        is_said: |said, own| {
            let [said, own] = [&said.surface, &own.surface];
            (said.normal_image, said.normal_scale) == (own.normal_image, own.normal_scale)
                || (said.normal_image, own.normal_image) == (None, None)
        },
        write: |own| match own.surface.normal_scale {
            1.0 => map("norm", own.surface.normal_image),
            scale => map(&format!("norm -bm {}", finite(scale)), own.surface.normal_image),
        },
    },
];

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
