//! Scenes that show meshes many times: each mesh is measured once, in its own place, and lengths are
//! scaled. A mesh is then compared with its own level alone, not with what other nodes show there.

use glam::DMat4;
use meshlod_io::{MeshInstance, Scene};
use meshlod_measure::{
    Distance, DistanceOptions, MeasureError, OneSidedDistance, Place, PreparedSurface, area,
    surface_distance,
};
use meshlod_mesh::{FaceId, Mesh};

use crate::scene::place::{similarity, world_bounds};

/// Number of times that a scene shows the faces of its meshes, on average, from which each mesh is
/// measured once.
const MANY: usize = 4;

/// Least number of samples of a mesh, if there are as many for all.
const LEAST_SAMPLES: usize = 1000;

/// The instances of a scene that shows its meshes many times, in similar shapes.
pub(super) struct Copies {
    instances: Vec<MeshInstance>,
    /// By mesh: its instances; `None` if it is not shown or has no faces.
    of_meshes: Vec<Option<CopiesOfMesh>>,
    /// Largest scale, in which the others are given.
    unit: f64,
    /// Diagonal of the bounding box of all instances.
    diagonal: f64,
}

/// The instances of a mesh.
#[derive(Clone, Copy, Default)]
struct CopiesOfMesh {
    /// Sums of the second, third and fourth powers of their scales.
    powers: [f64; 3],
    /// Scale of the largest, and its place in the list of instances.
    scale: f64,
    largest: usize,
}

/// Prepared surfaces of the meshes that are shown.
pub(super) type Surfaces<'m> = Vec<Option<PreparedSurface<'m>>>;

impl Copies {
    /// Returns the instances of a scene; `None` if each mesh is shown a few times, or some in another
    /// shape.
    pub fn of(scene: &Scene) -> Option<Self> {
        let faces = |mesh: usize| scene.meshes[mesh].mesh.faces.len();
        let instances = scene.instances();
        let shown = || instances.iter().enumerate().filter(|(_, shown)| faces(shown.mesh) > 0);
        let mut of_meshes: Vec<Option<CopiesOfMesh>> = vec![None; scene.meshes.len()];
        shown().for_each(|(_, shown)| of_meshes[shown.mesh] = Some(CopiesOfMesh::default()));
        let once =
            (0..of_meshes.len()).filter(|&i| of_meshes[i].is_some()).map(faces).sum::<usize>();
        let all: usize = shown().map(|(_, shown)| faces(shown.mesh)).sum();
        if once == 0 || all < MANY * once {
            return None;
        }
        let scales: Option<Vec<f64>> = shown().map(|(_, shown)| similarity(shown)).collect();
        let scales = scales?;
        let unit = scales.iter().fold(0.0, |most: f64, scale| most.max(*scale));
        for ((i, shown), scale) in shown().zip(scales) {
            let copies = of_meshes[shown.mesh].as_mut().expect("it is shown");
            copies.add(i, scale / unit);
        }
        let diagonal = world_bounds(scene).diagonal();
        Some(Self { instances, of_meshes, unit, diagonal })
    }

    /// Returns the largest instance of each mesh that is shown.
    #[cfg(feature = "strip")]
    pub fn largest(&self) -> impl Iterator<Item = MeshInstance> {
        self.of_meshes.iter().flatten().map(|copies| self.instances[copies.largest])
    }

    /// Returns the mesh of another scene in the place of each mesh; `None` unless that shows as many,
    /// in the same places.
    #[cfg(feature = "multires")]
    pub fn counterparts(&self, other: &Scene) -> Option<Vec<usize>> {
        let theirs = other.instances();
        let mut found: Vec<Option<usize>> = vec![None; self.of_meshes.len()];
        let is_same = |(a, b): (&MeshInstance, &MeshInstance)| {
            let has_faces = !other.meshes[b.mesh].mesh.faces.is_empty();
            a.transform == b.transform
                && has_faces == self.of_meshes[a.mesh].is_some()
                && *found[a.mesh].get_or_insert(b.mesh) == b.mesh
        };
        let are_same =
            theirs.len() == self.instances.len() && self.instances.iter().zip(&theirs).all(is_same);
        are_same.then(|| found.into_iter().map(|mesh| mesh.unwrap_or(0)).collect())
    }

    /// Prepares the meshes that are shown, or others in their places; `None` if one has no area.
    pub fn prepare<'m>(&self, meshes: impl Fn(usize) -> &'m Mesh) -> Option<Surfaces<'m>> {
        let prepared = self.of_meshes.iter().enumerate().map(|(i, copies)| match copies {
            Some(_) => PreparedSurface::new(meshes(i)).ok().map(Some),
            None => Some(None),
        });
        prepared.collect()
    }

    /// Returns the sum of a size of the meshes over all instances, the second or third power of a
    /// length.
    pub fn sum(&self, size: impl Fn(usize) -> f64, power: usize) -> f64 {
        let shown = self.of_meshes.iter().enumerate();
        let own =
            shown.filter_map(|(i, copies)| Some(size(i) * copies.as_ref()?.powers[power - 2]));
        own.sum::<f64>() * self.unit.powi(power as i32)
    }

    /// Returns true if something holds of all meshes that are shown.
    #[cfg(feature = "multires")]
    pub fn all(&self, holds: impl Fn(usize) -> bool) -> bool {
        (0..self.of_meshes.len()).filter(|&i| self.of_meshes[i].is_some()).all(holds)
    }

    /// Measures the distance between the scene and one with other meshes in their places.
    ///
    /// # Errors
    /// No samples.
    pub fn apart(
        &self,
        [a, b]: [&Surfaces<'_>; 2],
        options: &DistanceOptions,
    ) -> Result<Distance, MeasureError> {
        let areas = |of: &Surfaces<'_>| -> Vec<f64> {
            of.iter().map(|of| of.as_ref().map_or(0.0, |surface| area(surface.mesh()))).collect()
        };
        let [areas_a, areas_b] = [a, b].map(areas);
        let all = self.sum(|i| areas_a[i], 2) / self.unit.powi(2);
        let least = LEAST_SAMPLES.min(options.samples / a.iter().flatten().count().max(1)).max(1);
        let [mut forward, mut backward] = [Merged::default(), Merged::default()];
        for (i, copies) in self.of_meshes.iter().enumerate() {
            let (Some(copies), Some(a), Some(b)) = (copies, &a[i], &b[i]) else { continue };
            let share = options.samples as f64 * areas_a[i] * copies.powers[0] / all;
            let samples = (share as usize).clamp(least.min(options.samples), options.samples);
            let found = surface_distance(a, b, &DistanceOptions { samples, ..*options })?;
            forward.add(&found.forward, areas_a[i], copies);
            backward.add(&found.backward, areas_b[i], copies);
        }
        let [forward, backward] = [(forward, b), (backward, a)].map(|(merged, to)| {
            let place = merged.worst.map(|(_, place, largest)| self.placed(&place, largest, to));
            merged.finish(place.expect("a mesh is shown"), self.unit)
        });
        Ok(Distance { forward, backward, diagonal: self.diagonal })
    }

    /// Returns a place on a mesh and its level as an instance has it, with the face among all that the
    /// other surface shows.
    fn placed(&self, place: &Place, largest: usize, to: &Surfaces<'_>) -> Place {
        let faces = |shown: &MeshInstance| {
            to[shown.mesh].as_ref().map_or(0, |surface| surface.mesh().faces.len())
        };
        let before: usize = self.instances[..largest].iter().map(faces).sum();
        let to_world = DMat4::from_cols_array_2d(&self.instances[largest].transform);
        let [from, to] =
            [place.from, place.to].map(|at| to_world.transform_point3(at.into()).to_array());
        Place { from, to, face: FaceId::new(before + place.face.index()) }
    }
}

impl CopiesOfMesh {
    fn add(&mut self, instance: usize, scale: f64) {
        (2..).zip(&mut self.powers).for_each(|(power, sum)| *sum += scale.powi(power));
        if scale > self.scale {
            (self.scale, self.largest) = (scale, instance);
        }
    }
}

/// One direction of a distance, over all instances.
#[derive(Default)]
struct Merged {
    /// Sums over the area: itself, and times the distance and its square.
    sums: [f64; 3],
    /// Greatest distance, its place on the mesh, and its instance.
    worst: Option<(f64, Place, usize)>,
}

impl Merged {
    /// Adds a mesh, of an area in its own space, over all its instances.
    fn add(&mut self, found: &OneSidedDistance, area: f64, copies: &CopiesOfMesh) {
        let terms = [1.0, found.mean, found.rms.powi(2)].into_iter().zip(copies.powers);
        let sums = self.sums.iter_mut().zip(terms);
        sums.for_each(|(sum, (term, power))| *sum += area * term * power);
        let max = copies.scale * found.max;
        if self.worst.is_none_or(|(worst, ..)| max > worst) {
            self.worst = Some((max, found.place, copies.largest));
        }
    }

    fn finish(self, place: Place, unit: f64) -> OneSidedDistance {
        let [area, sum, squares] = self.sums;
        let max = self.worst.map_or(0.0, |(max, ..)| max);
        OneSidedDistance {
            mean: unit * sum / area,
            rms: unit * (squares / area).sqrt(),
            max: unit * max,
            place,
        }
    }
}

#[cfg(test)]
mod tests {
    use meshlod_samples as samples;

    use super::*;

    fn flock(transforms: &[[[f64; 4]; 4]]) -> Scene {
        let mut scene = Scene::from_mesh("torus", samples::torus(600));
        let node = scene.nodes[0].clone();
        scene.nodes = transforms
            .iter()
            .map(|&to| meshlod_io::Node { transform: to, ..node.clone() })
            .collect();
        scene.roots = (0..transforms.len()).collect();
        scene
    }

    fn scaled(x: f64, y: f64, z: f64) -> [[f64; 4]; 4] {
        DMat4::from_scale([x, y, z].into()).to_cols_array_2d()
    }

    #[test]
    fn only_similar_instances_are_copies() {
        assert!(Copies::of(&flock(&[scaled(1.0, 1.0, 1.0); 3])).is_none());
        let mirrored = [scaled(2.0, 2.0, 2.0), scaled(-3.0, 3.0, 3.0)];
        let copies = Copies::of(&flock(&mirrored.repeat(3))).unwrap();
        assert_eq!((copies.unit, copies.of_meshes[0].unwrap().largest), (3.0, 1));
        for other in [scaled(1.0, 1.0, 1.1), scaled(0.0, 0.0, 0.0)] {
            assert!(Copies::of(&flock(&[&mirrored.repeat(3)[..], &[other]].concat())).is_none());
        }
        // Powers of such scales are beyond the numbers.
        let huge = flock(&[scaled(1e100, 1e100, 1e100); 5]);
        let copies = Copies::of(&huge).unwrap();
        let surfaces = copies.prepare(|i| &huge.meshes[i].mesh).unwrap();
        let apart = copies.apart([&surfaces, &surfaces], &DistanceOptions::default()).unwrap();
        assert!(apart.mean().is_finite() && apart.rms().is_finite() && apart.max().is_finite());
    }

    #[cfg(feature = "multires")]
    #[test]
    fn a_mesh_where_there_was_none_is_no_counterpart() {
        let mut ours = flock(&[scaled(1.0, 1.0, 1.0); 6]);
        let mut theirs = ours.clone();
        for (scene, mesh) in [(&mut ours, Mesh::default()), (&mut theirs, samples::torus(60))] {
            scene.meshes.push(meshlod_io::SceneMesh { mesh, ..Default::default() });
            scene.nodes.push(meshlod_io::Node { mesh: Some(1), ..scene.nodes[0].clone() });
            scene.roots.push(6);
        }
        let copies = Copies::of(&ours).unwrap();
        assert!(copies.counterparts(&ours).is_some() && copies.counterparts(&theirs).is_none());
    }
}
