//! Places where a scene shows the meshes of its levels, and how coarse they may be there.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DMat4, DVec3};
use meshlod::mesh::Bounds;
use meshlod::model::LevelInstance;
use meshlod::multires::ViewCamera;

use super::gpu_place::GpuPlace;

/// Places of all meshes, sorted by mesh; empty if each mesh is shown once, untransformed.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    instances: Vec<LevelInstance>,
    /// Box of each mesh, untransformed.
    boxes: BTreeMap<u32, Bounds>,
}

impl Places {
    pub(super) fn new(instances: &[LevelInstance], boxes: BTreeMap<u32, Bounds>) -> Self {
        let is_shown = |instance: &&LevelInstance| boxes.contains_key(&instance.mesh);
        let mut instances: Vec<LevelInstance> =
            instances.iter().filter(is_shown).copied().collect();
        instances.sort_by_key(|instance| instance.mesh);
        Self { instances, boxes }
    }

    /// Returns true if each mesh is shown once, untransformed.
    pub(super) fn is_own(&self) -> bool {
        self.instances.is_empty()
    }

    /// Returns the places for shaders, for positions relative to an origin.
    pub(super) fn for_gpu(&self, origin: DVec3) -> Vec<GpuPlace> {
        match self.is_own() {
            true => vec![GpuPlace::OWN],
            false => self.instances.iter().map(|at| GpuPlace::new(at, origin)).collect(),
        }
    }

    /// Returns the range of a mesh's places.
    pub(super) fn of(&self, mesh: u32) -> Range<u32> {
        if self.is_own() {
            return 0..1;
        }
        let before = |mesh: u32| self.instances.partition_point(|at| at.mesh < mesh) as u32;
        before(mesh)..before(mesh + 1)
    }

    /// Returns the box around all places.
    pub(super) fn bounds(&self) -> Bounds {
        let mut all = Bounds::EMPTY;
        for at in &self.instances {
            let transform = DMat4::from_cols_array_2d(&at.transform);
            all.merge(&moved(&self.boxes[&at.mesh], &transform));
        }
        all
    }

    /// Returns the least tolerance in a ball of the levels' space that keeps errors within a number
    /// of pixels wherever the ball's contents are shown.
    ///
    /// No place is larger than that of the levels, so neither is an error or a ball.
    pub(super) fn tolerance(
        &self,
        camera: &ViewCamera,
        pixels: f64,
    ) -> impl Fn([f64; 3], f64) -> f64 + use<> {
        let eye = DVec3::from(camera.eye);
        let slope = pixels * camera.pixel();
        let places: Vec<(DMat4, Bounds)> = self
            .instances
            .iter()
            .map(|at| (DMat4::from_cols_array_2d(&at.transform), self.boxes[&at.mesh]))
            .collect();
        move |center, radius| {
            let center = DVec3::from(center);
            let meets = |bounds: &Bounds| {
                let [low, high] = [bounds.min, bounds.max].map(DVec3::from);
                center.clamp(low, high).distance(center) <= radius
            };
            let shown = places.iter().filter(|(_, bounds)| meets(bounds));
            let distance = |(transform, _): &(DMat4, Bounds)| {
                transform.transform_point3(center).distance(eye) - radius
            };
            // What is in no box is nowhere to be seen, but a smaller ball must not be coarser.
            let least = shown.map(distance).fold(f64::INFINITY, f64::min);
            if least == f64::INFINITY { f64::MAX } else { (slope * least).max(0.0) }
        }
    }
}

/// Returns the box around a box that a matrix has moved.
fn moved(bounds: &Bounds, transform: &DMat4) -> Bounds {
    let corner = |i: usize| {
        let pick = |k: usize| if i >> k & 1 == 0 { bounds.min[k] } else { bounds.max[k] };
        transform.transform_point3(DVec3::new(pick(0), pick(1), pick(2))).to_array()
    };
    let corners: [[f64; 3]; 8] = std::array::from_fn(corner);
    Bounds::of(&corners)
}
