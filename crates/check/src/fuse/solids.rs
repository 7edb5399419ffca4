//! Decides which parts of a mesh are inside closed shells.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::{Bounds, FaceId, Mesh};

use super::patches::Patch;
use crate::check::shells::Shells;

/// Closed, opaque shells of a mesh, for tests of whether points are inside.
pub struct Solids {
    solids: Vec<Solid>,
    /// Face tests that remain.
    budget: usize,
}

struct Solid {
    component: u32,
    bounds: Bounds,
    triangles: Vec<[DVec3; 3]>,
}

/// A point of a face with its normal.
#[derive(Clone, Copy)]
struct Sample {
    point: DVec3,
    normal: DVec3,
}

/// Number of samples of a patch, which must all agree: its largest faces, and others spread over
/// it.
const SAMPLES: [usize; 2] = [16, 48];

/// Offset of the test points on both sides of a face, relative to the size of the solid.
const OFFSET: f64 = 1e-7;

impl Solids {
    pub fn of(mesh: &Mesh, component: &[u32], solid: impl Fn(FaceId) -> bool) -> Self {
        let shells = Shells::of_mesh(mesh);
        let closed = shells.all.iter().map(|shell| {
            let component = component[shell.first.index()];
            let empty = Solid { component, bounds: Bounds::EMPTY, triangles: Vec::new() };
            // An inside-out shell has no well-defined inside.
            shell.volume().filter(|&volume| volume > 0.0).map(|_| empty)
        });
        let mut slots: Vec<Option<Solid>> = closed.collect();
        for (f, &shell) in shells.of_face.iter().enumerate() {
            let Some(slot) = slots.get_mut(shell as usize) else { continue };
            if !solid(FaceId::new(f)) {
                *slot = None;
            } else if let Some(solid) = slot {
                mesh.faces[f].iter().for_each(|v| solid.bounds.add(mesh.positions[v.index()]));
                solid.triangles.push(mesh.triangle(mesh.faces[f]));
            }
        }
        Self { solids: slots.into_iter().flatten().collect(), budget: 1 << 28 }
    }

    /// Returns a flag per component, true if it consists of closed shells that face outwards, opaque
    /// or not.
    pub fn closed_components(mesh: &Mesh, component: &[u32], count: usize) -> Vec<bool> {
        let shells = Shells::of_mesh(mesh);
        let is_closed: Vec<bool> = shells
            .all
            .iter()
            .map(|shell| shell.volume().is_some_and(|volume| volume > 0.0))
            .collect();
        let mut closed = vec![true; count];
        for (&shell, &component) in shells.of_face.iter().zip(component) {
            // Faces of no shell are degenerate and bound nothing.
            closed[component as usize] &= is_closed.get(shell as usize).is_none_or(|&is| is);
        }
        closed
    }

    /// Returns a flag per component, true if it consists of closed opaque shells only.
    pub fn components(&self, component: &[u32]) -> Vec<bool> {
        let count = component.iter().max().map_or(0, |&most| most as usize + 1);
        let mut faces = vec![0; count];
        component.iter().for_each(|&own| faces[own as usize] += 1);
        for solid in &self.solids {
            faces[solid.component as usize] -= solid.triangles.len();
        }
        faces.iter().map(|&others| others == 0).collect()
    }

    /// Returns true if a patch of `component` is hidden inside a shell of another component; false
    /// if the tests allowed for the mesh are used up.
    pub fn hide(&mut self, mesh: &Mesh, patch: &Patch, component: u32) -> bool {
        let samples = samples(mesh, patch);
        let Self { solids, budget } = self;
        solids
            .iter()
            .filter(|solid| solid.component != component)
            .any(|solid| samples.iter().all(|sample| solid.hides(sample, component, budget)))
    }
}

impl Solid {
    /// Returns true if the solid hides a face of `component` at a sample point.
    ///
    /// The face is hidden if it is inside. Of two coincident faces of equal orientation, that of
    /// the first component is visible; of opposite orientation, neither is.
    fn hides(&self, sample: &Sample, component: u32, budget: &mut usize) -> bool {
        let tests = 2 * self.triangles.len();
        if !contains(&self.bounds, sample.point) || *budget < tests {
            return false;
        }
        *budget -= tests;
        let offset = sample.normal * (OFFSET * self.bounds.diagonal());
        let is_inside = |point: DVec3| self.winding(point).abs() > 0.5;
        let before = self.component < component;
        is_inside(sample.point + offset) || (before && is_inside(sample.point - offset))
    }

    /// Returns the winding number of the surface around a point.
    ///
    /// # References
    /// [VOS83]: the solid angle of a triangle with a single arctangent.
    fn winding(&self, point: DVec3) -> f64 {
        let angle = |triangle: &[DVec3; 3]| {
            let [a, b, c] = triangle.map(|corner| corner - point);
            let [x, y, z] = [a, b, c].map(|way| way.length());
            let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
            a.dot(b.cross(c)).atan2(below)
        };
        self.triangles.iter().map(angle).sum::<f64>() / TAU
    }
}

/// Samples the centres of the largest faces of a patch, and of others spread over it.
fn samples(mesh: &Mesh, patch: &Patch) -> Vec<Sample> {
    let mut faces: Vec<(Sample, f64)> = patch
        .faces
        .iter()
        .filter_map(|face| {
            let [a, b, c] = mesh.triangle(mesh.faces[face.index()]);
            let across = (b - a).cross(c - a);
            let sample = Sample { point: (a + b + c) / 3.0, normal: across.try_normalize()? };
            Some((sample, across.length_squared()))
        })
        .collect();
    faces.sort_by(|a, b| b.1.total_cmp(&a.1));
    let [largest, others] = SAMPLES;
    let step = faces.len().div_ceil(others).max(1);
    let chosen = faces.iter().enumerate().filter(|(i, _)| *i < largest || i % step == 0);
    chosen.map(|(_, (sample, _))| *sample).collect()
}

fn contains(bounds: &Bounds, point: DVec3) -> bool {
    let [min, max] = [bounds.min, bounds.max].map(DVec3::from);
    point.cmpge(min).all() && point.cmple(max).all()
}
