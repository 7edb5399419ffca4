//! Textures of a tile: its parts of the model's images, at the resolution of its level.
//!
//! A leaf has its textures as the model has them, a tile above it at half the resolution, and so
//! on. Reading order: `charts` finds connected faces; `pack` joins the rectangles around them and
//! puts these side by side; `atlas` maps texture coordinates and cuts texels; `layers` has the
//! images of a material; `arrange` chooses between an atlas and whole images; `encode` writes files.
//! `decoded` keeps images between tiles.

mod arrange;
mod atlas;
mod charts;
mod decoded;
mod encode;
mod layers;
mod pack;

use std::collections::{BTreeMap, BTreeSet};

use meshlod_io::{Image, Material};
use meshlod_mesh::{LayerKind, Mesh};
use rustc_hash::FxHashMap;

use crate::plan::Look;
use arrange::{arrange, cut, whole, whole_level};
use atlas::Atlas;
use charts::{Chart, Charts};
use decoded::EncodedKey;
use layers::{Layer, set_images, take_layers};

pub use decoded::DecodedImages;

/// Materials of a tile, and the images that they use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TileLook {
    /// Materials, as many as the model has; only those that the tile shows have images.
    pub materials: Vec<Material>,
    /// Images of the materials.
    pub images: Vec<Image>,
    /// Images of the model that the tile should show and that are missing or damaged.
    pub lost: BTreeSet<usize>,
}

/// Cuts the textures that a mesh shows out of the images of its materials, halved as often as its
/// level asks for, and changes its first texture coordinates to match.
///
/// A material whose textures repeat in the tile, or are needed in nearly all their parts, keeps
/// whole images at that resolution. Images that are missing or damaged are left out, and told.
pub fn repack(look: &Look, mesh: &mut Mesh, halvings: u32) -> TileLook {
    let charts = match look.images.is_empty() {
        true => Charts::default(),
        false => Charts::find(mesh),
    };
    let mut of_label: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, chart) in charts.all.iter().enumerate() {
        of_label.entry(chart.label as usize).or_default().push(i);
    }
    let mut images = TileImages::of(look, halvings);
    let mut atlas_of: Vec<Option<(usize, usize)>> = vec![None; charts.all.len()];
    let mut atlases = Vec::new();
    let mut materials = look.materials.clone();
    for (label, material) in materials.iter_mut().enumerate() {
        let own = of_label.get(&label).map_or(&[][..], |own| own);
        let shown: Vec<&Chart> = own.iter().map(|&i| &charts.all[i]).collect();
        if let Some(atlas) = images.add(material, &shown) {
            own.iter()
                .enumerate()
                .for_each(|(i, &chart)| atlas_of[chart] = Some((atlases.len(), i)));
            atlases.push(atlas);
        }
    }
    map_uvs(mesh, &charts, |chart| atlas_of[chart].map(|(atlas, own)| (&atlases[atlas], own)));
    TileLook { materials, images: images.all, lost: images.lost }
}

/// Images of a tile in the making.
struct TileImages<'a> {
    look: &'a Look,
    halvings: u32,
    all: Vec<Image>,
    lost: BTreeSet<usize>,
    /// Index of each whole image.
    whole: FxHashMap<EncodedKey, usize>,
}

impl<'a> TileImages<'a> {
    fn of(look: &'a Look, halvings: u32) -> Self {
        let (all, lost) = (Vec::new(), BTreeSet::new());
        Self { look, halvings, all, lost, whole: FxHashMap::default() }
    }

    /// Gives a material the images that its charts show. Returns the atlas that they were cut by,
    /// unless they are whole.
    fn add(&mut self, material: &mut Material, charts: &[&Chart]) -> Option<Atlas> {
        let layers = match charts {
            [] => Vec::new(),
            _ => take_layers(self.look, material, &mut self.lost),
        };
        let atlas = arrange(charts, &layers, self.halvings);
        let images: Vec<usize> = match &atlas {
            Some(atlas) => layers.iter().map(|layer| self.cut(layer, &layers, atlas)).collect(),
            None => layers.iter().map(|layer| self.keep(layer)).collect(),
        };
        set_images(material, &layers, &images);
        atlas
    }

    fn cut(&mut self, layer: &Layer, layers: &[Layer], atlas: &Atlas) -> usize {
        self.all.push(cut(self.look, layer, layers, atlas));
        self.all.len() - 1
    }

    /// Returns the index of a whole image, which several materials may have.
    fn keep(&mut self, layer: &Layer) -> usize {
        let key = (layer.image, layer.role, whole_level(&layer.texture, self.halvings));
        *self.whole.entry(key).or_insert_with(|| {
            let image = self.look.decoded.encoded(key, || whole(self.look, layer, key.2));
            self.all.push(Image::clone(&image));
            self.all.len() - 1
        })
    }
}

/// Maps the texture coordinates of charts that are in an atlas, as the chart of a number.
fn map_uvs<'a>(
    mesh: &mut Mesh,
    charts: &Charts,
    atlas_of: impl Fn(usize) -> Option<(&'a Atlas, usize)>,
) {
    let layers = mesh.attributes.iter_mut().flat_map(|attributes| &mut attributes.layers);
    let Some(uvs) = layers.into_iter().find(|layer| layer.kind == LayerKind::Uv(0)) else { return };
    for (uv, chart) in uvs.values.as_chunks_mut::<2>().0.iter_mut().zip(&charts.of_wedge) {
        let Some(chart) = chart.map(|chart| chart as usize) else { continue };
        if let Some((atlas, own)) = atlas_of(chart) {
            *uv = atlas.map(own, charts.all[chart].shift, *uv);
        }
    }
}
