//! Subjects in slots side by side, seen by one camera.

use meshlod::mesh::Bounds;
use meshlod::picture::{Background, Camera, UpAxis};
use wgpu::RenderPass;

use super::{CameraRig, Display, Subject};
use crate::{Backdrop, Ground, Placement, Renderer, Shade, ViewError};

/// Subjects on the GPU, with the slots, the display and the camera that show them.
#[derive(Debug, Default)]
pub struct Stage {
    /// Camera, the same in all slots.
    pub rig: CameraRig,
    /// How subjects are shown.
    pub display: Display,
    subjects: Vec<Option<Subject>>,
    /// Shadows of the subjects, with the axis that was up when they fell.
    grounds: Vec<Option<(UpAxis, Ground)>>,
    slots: Vec<Slot>,
    backdrop: Option<(Background, Backdrop)>,
}

/// Number of a subject on a [`Stage`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SubjectId(usize);

/// Place of a subject in the picture.
#[derive(Debug)]
struct Slot {
    subject: SubjectId,
    placement: Option<Placement>,
}

impl Stage {
    /// Adds a subject, which is not shown yet.
    pub fn add(&mut self, subject: Subject) -> SubjectId {
        self.subjects.push(Some(subject));
        self.grounds.push(None);
        SubjectId(self.subjects.len() - 1)
    }

    /// Replaces a subject by another.
    pub fn replace(&mut self, id: SubjectId, subject: Subject) {
        self.subjects[id.0] = Some(subject);
        self.grounds[id.0] = None;
    }

    /// Removes a subject and the slots that show it. Its number is not used again.
    pub fn remove(&mut self, id: SubjectId) {
        (self.subjects[id.0], self.grounds[id.0]) = (None, None);
        self.slots.retain(|slot| slot.subject != id);
    }

    /// Returns a subject; `None` if it was removed.
    pub fn subject(&self, id: SubjectId) -> Option<&Subject> {
        self.subjects.get(id.0)?.as_ref()
    }

    /// Returns a subject to change; `None` if it was removed.
    pub fn subject_mut(&mut self, id: SubjectId) -> Option<&mut Subject> {
        self.subjects.get_mut(id.0)?.as_mut()
    }

    /// Shows these subjects side by side, from the left; those that were removed are left out.
    pub fn show(&mut self, ids: &[SubjectId]) {
        let there = ids.iter().filter(|id| self.subject(**id).is_some());
        self.slots = there.map(|&subject| Slot { subject, placement: None }).collect();
    }

    /// Returns the subjects that are shown, from the left.
    pub fn shown(&self) -> impl Iterator<Item = SubjectId> + '_ {
        self.slots.iter().map(|slot| slot.subject)
    }

    /// Returns the number of faces of all shown subjects.
    pub fn faces(&self) -> usize {
        self.shown().filter_map(|id| self.subject(id)).map(Subject::faces).sum()
    }

    /// Returns the box around all shown subjects.
    pub fn bounds(&self) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for subject in self.shown().filter_map(|id| self.subject(id)) {
            bounds.merge(&subject.bounds());
        }
        bounds
    }

    /// Returns the size of each slot in a picture of a size in pixels.
    pub fn slot_size(&self, [width, height]: [u32; 2]) -> [u32; 2] {
        [width / self.slots.len().max(1) as u32, height]
    }

    /// Returns the width of a slot divided by its height, in a picture of a size in pixels.
    pub fn aspect(&self, size: [u32; 2]) -> f64 {
        let [width, height] = self.slot_size(size).map(|side| f64::from(side.max(1)));
        width / height
    }

    /// Returns where a point of the world is in a slot, in pixels from the slot's top left corner;
    /// `None` behind the camera.
    pub fn project(&self, point: [f64; 3], slot_size: [u32; 2]) -> Option<[f32; 2]> {
        project(&self.rig.camera(), point, slot_size)
    }

    /// Draws each shown subject from above, once, for its shadow on the ground. Call it before
    /// [`Stage::draw`]; a stage without ground needs no preparation.
    ///
    /// # Errors
    /// The GPU has no room for the shadow.
    pub fn prepare(&mut self, renderer: &Renderer) -> Result<(), ViewError> {
        if !self.display.ground {
            return Ok(());
        }
        let up = self.rig.up();
        for slot in &self.slots {
            let at = slot.subject.0;
            let Some(subject) = self.subjects[at].as_ref().filter(|subject| subject.faces() > 0)
            else {
                continue;
            };
            if self.grounds[at].as_ref().is_some_and(|(made, _)| *made == up) {
                continue;
            }
            let draw = |pass: &mut RenderPass<'_>, placement: &Placement| {
                subject.draw(renderer, pass, placement, &Display::default());
            };
            let ground = Ground::new(renderer, &subject.bounds(), up, subject.origin(), draw)?;
            self.grounds[at] = Some((up, ground));
        }
        Ok(())
    }

    /// Draws all slots into a pass that covers a picture of a size in pixels, and the background
    /// behind them. A picture without pixels stays as it is.
    pub fn draw(&mut self, renderer: &Renderer, pass: &mut RenderPass<'_>, size: [u32; 2]) {
        let slot_size = self.slot_size(size);
        if size.contains(&0) || slot_size.contains(&0) {
            return;
        }
        let camera = self.rig.camera();
        for (slot, column) in self.slots.iter_mut().zip(0u32..) {
            let Some(subject) = self.subjects[slot.subject.0].as_ref() else { continue };
            let placement = slot.placement.get_or_insert_with(|| renderer.placement());
            let shade = subject.display(&self.display).shade();
            let set = |placement: &Placement, shown: f32| {
                placement.set(&camera, slot_size, subject.origin(), &Shade { shown, ..shade });
            };
            set(placement, 1.0);
            subject.place_fade(set);
            set_viewport(pass, column * slot_size[0], slot_size);
            subject.draw(renderer, pass, placement, &self.display);
        }
        set_viewport(pass, 0, size);
        self.draw_backdrop(renderer, pass);
        self.draw_grounds(renderer, pass, &camera, slot_size);
        set_viewport(pass, 0, size);
    }

    fn draw_grounds(
        &self,
        renderer: &Renderer,
        pass: &mut RenderPass<'_>,
        camera: &Camera,
        slot_size: [u32; 2],
    ) {
        if !self.display.ground {
            return;
        }
        for (slot, column) in self.slots.iter().zip(0u32..) {
            let ground = self.grounds[slot.subject.0].as_ref().map(|(_, ground)| ground);
            if let Some(ground) = ground.filter(|ground| ground.format() == renderer.format()) {
                set_viewport(pass, column * slot_size[0], slot_size);
                ground.draw(renderer, pass, camera, slot_size);
            }
        }
    }

    fn draw_backdrop(&mut self, renderer: &Renderer, pass: &mut RenderPass<'_>) {
        let wanted = self.display.background();
        if self.backdrop.as_ref().is_none_or(|(made, _)| *made != wanted) {
            self.backdrop = renderer.backdrop(wanted).map(|backdrop| (wanted, backdrop));
        }
        if let Some((_, backdrop)) = &self.backdrop {
            renderer.draw_backdrop(pass, backdrop);
        }
    }
}

fn set_viewport(pass: &mut RenderPass<'_>, left: u32, [width, height]: [u32; 2]) {
    pass.set_viewport(left as f32, 0.0, width as f32, height as f32, 0.0, 1.0);
}

/// Projects a point to pixels from the top left corner of a picture.
fn project(camera: &Camera, point: [f64; 3], size: [u32; 2]) -> Option<[f32; 2]> {
    let [right, up, forward] = camera.axes().map(glam::DVec3::from);
    let offset = glam::DVec3::from(point) - glam::DVec3::from(camera.eye());
    let depth = offset.dot(forward);
    if depth <= camera.near() {
        return None;
    }
    let [width, height] = size.map(f64::from);
    let focal = width.min(height) / 2.0 / camera.tan_half_fov() / depth;
    let at = [width / 2.0 + offset.dot(right) * focal, height / 2.0 - offset.dot(up) * focal];
    Some(at.map(|x| x as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_target_is_in_the_middle_and_nothing_behind_the_eye() {
        let stage = Stage::default();
        let size = [200, 100];
        assert_eq!(stage.project([0.0; 3], size), Some([100.0, 50.0]));
        let behind = stage.rig.camera().eye().map(|x| 2.0 * x);
        assert_eq!(stage.project(behind, size), None);
    }

    #[test]
    fn an_empty_stage_has_bounds_and_an_aspect() {
        let stage = Stage::default();
        assert!(stage.bounds().is_empty());
        assert_eq!(stage.aspect([300, 100]), 3.0);
        assert_eq!(stage.aspect([0, 0]), 1.0);
    }
}
