//! Cards: flat pieces of an atlas that stand in for distant models, and are seen through.
//!
//! [`card_layer`] draws cards as the rest of a scene hides them, and [`CardLayer::over`] lays them
//! over its picture.

mod atlas;
mod layer;

pub use atlas::{CardAtlas, bleed};
pub use layer::{Card, CardLayer, card_layer};
