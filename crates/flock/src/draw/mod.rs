//! Pictures of a flock, every member with its level.

mod impostors;
mod merged;
mod paint;

pub use paint::STONE;

use std::sync::Arc;

use meshlod_mesh::{Layer, LayerKind, Mesh};
use meshlod_picture::{
    Antialiasing, Background, Lighting, Normals, Picture, PictureError, Style, render, visibility,
};

use crate::camera::FlockCamera;
use crate::draw::impostors::FrameImpostors;
use crate::draw::merged::{LevelShape, Merged};
use crate::draw::paint::OwnedPaint;
use crate::flock::Flock;
use crate::levels::{Impostor, LevelTable, Look, is_color};
use crate::select::InstanceLevel;

/// Draws flocks of one model, and the obstacles that they swim round.
pub struct FlockPainter<'a> {
    table: &'a LevelTable,
    obstacles: &'a [Mesh],
    paint: OwnedPaint,
    has_materials: bool,
    /// Layers of the table that pictures need.
    layers: Vec<&'a Layer>,
    /// Vertices and triangles of each level, for those that have been drawn.
    shapes: Vec<Option<LevelShape>>,
    /// Lighting of members and obstacles.
    pub lighting: Lighting,
    /// Background of the pictures.
    pub background: Background,
    /// Impostors of the model; without them, members that are impostors are drawn with the coarsest
    /// level of the whole chain.
    pub impostor: Option<Arc<Impostor>>,
}

/// One mesh of all that a frame shows, and the member of each of its faces; and its impostors.
pub struct FrameMesh {
    /// Members, in their order, and then the obstacles.
    pub mesh: Mesh,
    /// First face of every drawn member, with the member, in ascending order.
    pub members: Vec<(u32, u32)>,
    /// Number of faces of members, which precede the faces of obstacles.
    pub member_faces: usize,
    impostors: FrameImpostors,
}

/// Background of pictures of flocks: water from the surface down.
pub const WATER: Background = Background::Gradient { top: [126, 186, 206], bottom: [16, 52, 84] };

impl<'a> FlockPainter<'a> {
    /// Creates a painter; obstacles are in the coordinates of the flock.
    pub fn new(table: &'a LevelTable, look: &'a Look, obstacles: &'a [Mesh]) -> Self {
        let paint = OwnedPaint::new(look, &table.layers);
        let needed = |layer: &&Layer| match (layer.kind, &paint) {
            (LayerKind::Normal, _) => true,
            (LayerKind::Uv(0), OwnedPaint::Materials(_)) => true,
            (_, OwnedPaint::Colors) => is_color(layer),
            _ => false,
        };
        let layers = table.layers.iter().filter(needed).collect();
        let shapes = table.levels.iter().map(|_| None).collect();
        let (lighting, background) = (Lighting::Headlight, WATER);
        Self {
            table,
            obstacles,
            paint,
            has_materials: look.materials.is_some(),
            layers,
            shapes,
            lighting,
            background,
            impostor: None,
        }
    }

    /// Draws a frame: `levels` has an entry for every member of the flock.
    ///
    /// Cost: that of [`render`] for all triangles drawn.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn draw(
        &mut self,
        flock: &Flock,
        levels: &[InstanceLevel],
        camera: &FlockCamera,
    ) -> Result<Picture, PictureError> {
        let frame = self.frame(flock, levels);
        self.render(&frame, camera, &camera.for_picture())
    }

    /// Draws a frame that [`FlockPainter::frame`] made, by any camera of the same size.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn render(
        &self,
        frame: &FrameMesh,
        camera: &FlockCamera,
        seen_by: &meshlod_picture::Camera,
    ) -> Result<Picture, PictureError> {
        let style = Style {
            size: camera.size(),
            paint: self.paint.paint(),
            normals: Normals::FromMesh,
            lighting: self.lighting,
            background: self.background,
            antialiasing: Antialiasing::Four,
            ..Style::default()
        };
        let picture = render(&frame.mesh, seen_by, &style)?;
        match frame.impostors.layer(&frame.mesh, camera, seen_by)? {
            Some(layer) => layer.over(&picture),
            None => Ok(picture),
        }
    }

    /// Puts all members that are drawn, and the obstacles, into one mesh.
    pub fn frame(&mut self, flock: &Flock, levels: &[InstanceLevel]) -> FrameMesh {
        let mut members = Vec::new();
        let mut impostors = FrameImpostors::new(self.impostor.clone());
        let coarsest = self.table.chains[0].levels.end - 1;
        let mut merged = Merged::new(&self.layers, self.has_materials);
        for (member, level) in levels.iter().enumerate() {
            if level.is_impostor() && impostors.add(&flock.members, member) {
                continue;
            }
            let coarsest = level.is_impostor().then_some(coarsest);
            let Some(level) = level.level().or(coarsest) else { continue };
            members.push((merged.faces.len() as u32, member as u32));
            let shape =
                self.shapes[level].get_or_insert_with(|| LevelShape::new(self.table, level));
            let place = (flock.members.frame(member), flock.members.position(member));
            merged.add_member(self.table, &self.layers, shape, level, place);
        }
        let member_faces = merged.faces.len();
        for obstacle in self.obstacles {
            merged.add_obstacle(obstacle, self.paint.stone());
        }
        FrameMesh { mesh: merged.into_mesh(&self.paint), members, member_faces, impostors }
    }
}

impl FrameMesh {
    /// Returns the member that a face belongs to; `None` for obstacles.
    pub fn member_of(&self, face: usize) -> Option<usize> {
        if face >= self.member_faces {
            return None;
        }
        let after = self.members.partition_point(|&(first, _)| first as usize <= face);
        Some(self.members[after - 1].1 as usize)
    }

    /// Returns for every pixel of a camera's picture whether it shows a member: at its middle, or at
    /// least half covered by impostors.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn shows_member(&self, camera: &FlockCamera) -> Result<Vec<bool>, PictureError> {
        let seen_by = camera.for_picture();
        let found = visibility(&self.mesh, &seen_by, camera.size())?;
        let of_member = found.faces().map(|f| f.is_some_and(|f| f.index() < self.member_faces));
        let mut shows: Vec<bool> = of_member.collect();
        if let Some(layer) = self.impostors.layer(&self.mesh, camera, &seen_by)? {
            for (shows, coverage) in shows.iter_mut().zip(layer.coverage()) {
                *shows |= coverage >= 0.5;
            }
        }
        Ok(shows)
    }
}
