//! Impostor: a member as one quad with a picture of the model.

mod atlas;

use glam::Vec3;
use meshlod_picture::{CardAtlas, Lighting, Picture};

use crate::levels::directions::{DirectionGrid, MAX_SIDE};
use crate::levels::look::Look;
use crate::levels::table::{LevelTable, TableError};
use crate::members::frame_of;

/// Pictures of a model from all sides, for members so small that they can be one quad.
///
/// A renderer binds the atlas, and draws for each member two triangles through the corners that
/// [`Impostor::quad`] computes: blended by alpha from far to near, or cut out where alpha is below
/// a half. Lighting is in the pictures; with [`Lighting::Unlit`] they show colours alone.
///
/// Memory: with the defaults the atlas has 768 by 768 pixels, 2.3 MB, and a third more with its
/// mipmaps on a GPU. For drawing on the CPU it is kept a second time with 21 bytes a pixel, 12 MB.
#[derive(Clone, Debug)]
pub struct Impostor {
    /// Views in the cells of the grid, row after row from the top: sRGB with straight alpha.
    /// Transparent pixels have the colour of their neighbours, so that filters do not darken rims.
    pub atlas: Picture,
    /// Directions in the frame of a member, from it to the eye; a view is taken along the axis of
    /// each cell.
    pub directions: DirectionGrid,
    /// Half of the width and height that a view shows, in body lengths.
    pub half_width: f32,
    /// Width and height of a view in the atlas, in pixels: a power of two, so that mipmaps down to
    /// one pixel a view do not mix the views.
    pub side_px: u32,
    /// Right and up in each view, in the frame of a member.
    axes: Vec<[Vec3; 2]>,
    cards: CardAtlas,
}

/// Options for drawing an [`Impostor`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpostorOptions {
    /// Number of views along the side of the grid of directions, 2 to 32.
    pub views_per_side: usize,
    /// Width and height of a view in pixels, a power of two from 8 to 512.
    pub side_px: u32,
    /// Lighting in the views. With [`Lighting::Headlight`] they look like members in the pictures of
    /// [`draw`](crate::draw), wherever the eye is.
    pub lighting: Lighting,
}

impl Default for ImpostorOptions {
    fn default() -> Self {
        Self { views_per_side: 12, side_px: 64, lighting: Lighting::Headlight }
    }
}

/// Quad that shows a member.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpostorQuad {
    /// Cell of [`Impostor::directions`] in which the eye is.
    pub cell: usize,
    /// Upper left and lower right corner of the view in the atlas; (0, 0) is the upper left corner of
    /// the atlas, (1, 1) the lower right.
    pub uv: [[f32; 2]; 2],
    /// Upper left, lower left, lower right and upper right corner in the world, in body lengths:
    /// counter-clockwise for the eye.
    pub corners: [Vec3; 4],
}

impl Impostor {
    /// Draws the model of a table, in full detail, from the directions of a grid.
    ///
    /// Cost: a picture of the model for each view; with the defaults 144 pictures of 64 by 64 pixels.
    ///
    /// # Errors
    /// An option out of range, and materials that do not fit the model.
    pub fn draw(
        table: &LevelTable,
        look: &Look,
        options: &ImpostorOptions,
    ) -> Result<Self, TableError> {
        let ImpostorOptions { views_per_side, side_px, .. } = *options;
        if !(2..=MAX_SIDE).contains(&views_per_side) {
            let message = format!("the views per side must be 2 to 32, not {views_per_side}");
            return Err(TableError::Option(message));
        }
        if !(8..=512).contains(&side_px) || !side_px.is_power_of_two() {
            let message = format!("the side of a view must be 8, 16, .. 512 pixels, not {side_px}");
            return Err(TableError::Option(message));
        }
        let directions = DirectionGrid::new(views_per_side);
        // A pixel is left at each rim.
        let half_width = table.radius * side_px as f32 / (side_px - 2) as f32;
        let axes: Vec<_> = (0..directions.len()).map(|i| upright(directions.axis(i))).collect();
        let atlas = atlas::draw(table, look, options, &axes, half_width)?;
        let cards = CardAtlas::new(&atlas, side_px)?;
        Ok(Self { atlas, directions, half_width, side_px, axes, cards })
    }

    /// Returns the quad that shows a member to an eye: it is centred at the member, and parallel to
    /// the view of the cell in which the eye is, so that it does not turn with the eye.
    ///
    /// An eye at the member's position gets any of the views.
    #[inline]
    pub fn quad(&self, position: Vec3, heading: Vec3, eye: Vec3) -> ImpostorQuad {
        let frame = frame_of(heading);
        let cell = self.directions.cell(frame.transpose() * (eye - position));
        let [right, up] = self.axes[cell].map(|axis| frame * axis * self.half_width);
        let corners = [up - right, -up - right, right - up, right + up];
        let side = (self.axes.len() as f32).sqrt();
        let across = side as usize;
        let place = [cell % across, cell / across].map(|i| i as f32);
        let uv = [0.0, 1.0].map(|step| place.map(|place| (place + step) / side));
        ImpostorQuad { cell, uv, corners: corners.map(|corner| position + corner) }
    }

    /// Returns the atlas for drawing on the CPU.
    pub(crate) fn cards(&self) -> &CardAtlas {
        &self.cards
    }
}

/// Returns right and up for an eye in a direction from the member; up is as close to the member's
/// as it can be.
fn upright(direction: Vec3) -> [Vec3; 2] {
    let right = Vec3::Y.cross(direction).try_normalize().unwrap_or(Vec3::X);
    [right, direction.cross(right)]
}

#[cfg(test)]
mod tests;
