//! Impostors of a frame, as cards.

use std::sync::Arc;

use glam::Vec3;
use meshlod_mesh::Mesh;
use meshlod_picture::{Card, CardLayer, PictureError, card_layer};

use crate::camera::FlockCamera;
use crate::levels::{Impostor, ImpostorQuad};
use crate::members::Members;

/// Members of a frame that are impostors.
pub(super) struct FrameImpostors {
    impostor: Option<Arc<Impostor>>,
    /// Position and heading of each.
    places: Vec<[Vec3; 2]>,
}

impl FrameImpostors {
    pub(super) fn new(impostor: Option<Arc<Impostor>>) -> Self {
        Self { impostor, places: Vec::new() }
    }

    /// Adds a member; returns false if there is no impostor of the model.
    pub(super) fn add(&mut self, members: &Members, member: usize) -> bool {
        if self.impostor.is_some() {
            self.places.push([members.position(member), members.heading(member)]);
        }
        self.impostor.is_some()
    }

    /// Draws the impostors as far as a mesh does not hide them; `None` if there are none.
    pub(super) fn layer(
        &self,
        mesh: &Mesh,
        camera: &FlockCamera,
        seen_by: &meshlod_picture::Camera,
    ) -> Result<Option<CardLayer>, PictureError> {
        let Some(impostor) = self.impostor.as_ref().filter(|_| !self.places.is_empty()) else {
            return Ok(None);
        };
        let quads = self.places.iter().map(|&[p, heading]| impostor.quad(p, heading, camera.eye()));
        let cards: Vec<Card> = quads.map(|quad| card(&quad)).collect();
        card_layer(&cards, impostor.cards(), mesh, seen_by, camera.size()).map(Some)
    }
}

fn card(quad: &ImpostorQuad) -> Card {
    let [corner, below, _, beside] = quad.corners.map(|corner| corner.as_dvec3());
    let (right, down) = (beside - corner, below - corner);
    Card { cell: quad.cell, corner: corner.into(), right: right.into(), down: down.into() }
}
