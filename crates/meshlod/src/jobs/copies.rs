//! Scenes that show meshes many times: each mesh is measured once, in its own place, and lengths are
//! scaled. A mesh is then compared with its own level alone, not with what other nodes show there.

use glam::{DMat3, DMat4, DVec3};
use meshlod_io::{MeshInstance, Scene};
use meshlod_measure::{
    Bracket, CertifiedDistance, CertifiedOptions, Distance, DistanceOptions, MeasureError,
    OneSidedDistance, Place, PreparedSurface, certified_surface_distance, surface_distance,
};
use meshlod_mesh::{FaceId, Mesh};
use rayon::prelude::*;

/// Number of times that a scene shows the faces of its meshes, on average, from which each mesh is
/// measured once.
const MANY: usize = 4;

/// Largest difference between the scales along axes, as a part of them, and cosine between axes of a
/// similarity.
const SIMILAR: f64 = 1e-6;

/// Least number of samples of a mesh.
const LEAST_SAMPLES: usize = 1000;

/// The instances of a scene that shows its meshes many times, in similar shapes.
pub(super) struct Copies<'s> {
    scene: &'s Scene,
    instances: Vec<MeshInstance>,
    /// By mesh: its instances; `None` if it is not shown or has no faces.
    of_meshes: Vec<Option<CopiesOfMesh>>,
}

/// The instances of a mesh.
#[derive(Clone, Copy)]
struct CopiesOfMesh {
    /// Sums of the second, third and fourth powers of their scales.
    powers: [f64; 3],
    /// The largest, by its place in the list of instances, and its scale.
    largest: usize,
    scale: f64,
}

/// Prepared surfaces of the meshes that are shown.
pub(super) type Surfaces<'m> = Vec<Option<PreparedSurface<'m>>>;

impl<'s> Copies<'s> {
    /// Returns the instances of a scene; `None` if each mesh is shown a few times, or some in another
    /// shape.
    pub fn of(scene: &'s Scene) -> Option<Self> {
        let instances = scene.instances();
        let mut of_meshes: Vec<Option<CopiesOfMesh>> = vec![None; scene.meshes.len()];
        let (mut shown, mut own) = (0, 0);
        for (i, instance) in instances.iter().enumerate() {
            let faces = scene.meshes[instance.mesh].mesh.faces.len();
            if faces == 0 {
                continue;
            }
            let scale = similarity(instance)?;
            shown += faces;
            let copies = of_meshes[instance.mesh].get_or_insert_with(|| {
                own += faces;
                CopiesOfMesh { powers: [0.0; 3], largest: i, scale }
            });
            for (power, sum) in (2..).zip(&mut copies.powers) {
                *sum += scale.powi(power);
            }
            if scale > copies.scale {
                (copies.largest, copies.scale) = (i, scale);
            }
        }
        (own > 0 && shown >= MANY * own).then_some(Self { scene, instances, of_meshes })
    }

    /// Returns true if another scene shows as many meshes in the same places.
    pub fn are_those_of(&self, other: &Scene) -> bool {
        self.scene.meshes.len() == other.meshes.len() && self.instances == other.instances()
    }

    /// Prepares the meshes that are shown, or others in their places; `None` if one has no area.
    pub fn prepare<'m>(&self, meshes: impl Fn(usize) -> &'m Mesh) -> Option<Surfaces<'m>> {
        let prepared = self.of_meshes.iter().enumerate().map(|(i, copies)| match copies {
            Some(_) => PreparedSurface::new(meshes(i)).ok().map(Some),
            None => Some(None),
        });
        prepared.collect()
    }

    /// Returns the sum of a size of the meshes over all instances, a power of a length.
    pub fn sum(&self, size: impl Fn(usize) -> f64, power: usize) -> f64 {
        let shown = self.of_meshes.iter().enumerate();
        shown.filter_map(|(i, copies)| Some(size(i) * copies.as_ref()?.powers[power - 2])).sum()
    }

    /// Returns true if something holds of all meshes that are shown.
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
        let [areas, areas_b] = [a, b].map(|of| self.areas(of));
        let all: f64 = areas.iter().sum();
        let mut forward = Merged::new(self.faces_before(b));
        let mut backward = Merged::new(self.faces_before(a));
        for (i, copies) in self.of_meshes.iter().enumerate() {
            let (Some(copies), Some(a), Some(b)) = (copies, &a[i], &b[i]) else { continue };
            let share = (options.samples as f64 * areas[i] / all) as usize;
            let samples = share.clamp(LEAST_SAMPLES.min(options.samples), options.samples);
            let found = surface_distance(a, b, &DistanceOptions { samples, ..*options })?;
            forward.add(&found.forward, areas[i], copies);
            backward.add(&found.backward, areas_b[i], copies);
        }
        let [forward, backward] = [forward, backward].map(|merged| merged.finish(&self.instances));
        Ok(Distance { forward, backward, diagonal: self.diagonal() })
    }

    /// Encloses the greatest distance between the scene and one with other meshes in their places.
    pub fn certified(&self, [a, b]: [&Surfaces<'_>; 2]) -> Option<CertifiedDistance> {
        let before = [b, a].map(|of| self.faces_before(of));
        let mut all: Option<CertifiedDistance> = None;
        for (i, copies) in self.of_meshes.iter().enumerate() {
            let (Some(copies), Some(a), Some(b)) = (copies, &a[i], &b[i]) else { continue };
            let found = certified_surface_distance(a, b, &CertifiedOptions::default());
            let placed = |bracket: Bracket, before: &[usize]| Bracket {
                lower: copies.scale * bracket.lower,
                upper: copies.scale * bracket.upper,
                place: placed(
                    &bracket.place,
                    &self.instances[copies.largest],
                    before[copies.largest],
                ),
                ..bracket
            };
            let found = CertifiedDistance {
                forward: placed(found.forward, &before[0]),
                backward: placed(found.backward, &before[1]),
                ..found
            };
            all = Some(all.map_or(found, |all| CertifiedDistance {
                forward: enclosing(all.forward, found.forward),
                backward: enclosing(all.backward, found.backward),
                ..all
            }));
        }
        all.map(|all| CertifiedDistance { diagonal: self.diagonal(), ..all })
    }

    /// Returns the area of each mesh over all its instances, in units of its own.
    fn areas(&self, of: &Surfaces<'_>) -> Vec<f64> {
        let area = |(i, copies): (usize, &Option<CopiesOfMesh>)| {
            let area = of[i].as_ref().map(|surface| meshlod_measure::area(surface.mesh()));
            copies.zip(area).map_or(0.0, |(copies, area)| area * copies.powers[0])
        };
        self.of_meshes.iter().enumerate().map(area).collect()
    }

    /// Returns for each instance the number of faces of those before it.
    fn faces_before(&self, of: &Surfaces<'_>) -> Vec<usize> {
        let faces = |mesh: usize| of[mesh].as_ref().map_or(0, |surface| surface.mesh().faces.len());
        let count = |sum: &mut usize, instance: &MeshInstance| {
            Some(std::mem::replace(sum, *sum + faces(instance.mesh)))
        };
        self.instances.iter().scan(0, count).collect()
    }

    /// Returns the diagonal of the bounding box of all instances.
    fn diagonal(&self) -> f64 {
        let nothing = || [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let both = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| [a.min(c), b.max(d)];
        let of_instance = |instance: &MeshInstance| {
            let to_world = DMat4::from_cols_array_2d(&instance.transform);
            let mesh = &self.scene.meshes[instance.mesh].mesh;
            let used = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]);
            used.map(|at| to_world.transform_point3(at.into()))
                .fold(nothing(), |bounds, at| both(bounds, [at, at]))
        };
        let [min, max] = self.instances.par_iter().map(of_instance).reduce(nothing, both);
        min.distance(max)
    }
}

/// Returns the scale of an instance; `None` unless its transform is a similarity, maybe mirrored.
fn similarity(instance: &MeshInstance) -> Option<f64> {
    let linear = DMat3::from_mat4(DMat4::from_cols_array_2d(&instance.transform));
    let axes = [linear.x_axis, linear.y_axis, linear.z_axis];
    let scale = linear.determinant().abs().cbrt();
    let is_unit = |axis: &DVec3| (axis.length() / scale - 1.0).abs() <= SIMILAR;
    let are_square =
        (0..3).all(|k| axes[k].dot(axes[(k + 1) % 3]).abs() <= SIMILAR * scale * scale);
    (scale > 0.0 && scale.is_finite() && axes.iter().all(is_unit) && are_square).then_some(scale)
}

/// Returns a place on a mesh and its level as an instance has it.
fn placed(place: &Place, instance: &MeshInstance, faces_before: usize) -> Place {
    let to_world = DMat4::from_cols_array_2d(&instance.transform);
    let [from, to] =
        [place.from, place.to].map(|at| to_world.transform_point3(at.into()).to_array());
    Place { from, to, face: FaceId::new(faces_before + place.face.index()) }
}

fn enclosing(a: Bracket, b: Bracket) -> Bracket {
    let Bracket { lower, place, .. } = if b.lower > a.lower { b } else { a };
    let (reached, splits) = (a.reached && b.reached, a.splits + b.splits);
    Bracket { lower, upper: a.upper.max(b.upper), place, reached, splits }
}

/// One direction of a distance, over all instances.
struct Merged {
    /// Sums over the area: itself, and times the distance and its square.
    sums: [f64; 3],
    /// Greatest distance, its place on the mesh, and its instance.
    worst: Option<(f64, Place, usize)>,
    /// By instance: the faces before it on the other surface.
    faces_before: Vec<usize>,
}

impl Merged {
    fn new(faces_before: Vec<usize>) -> Self {
        Self { sums: [0.0; 3], worst: None, faces_before }
    }

    /// Adds a mesh of this area over all its instances.
    fn add(&mut self, found: &OneSidedDistance, area: f64, copies: &CopiesOfMesh) {
        let [squares, cubes, fourths] = copies.powers;
        let own = area / squares;
        let terms = [area, own * found.mean * cubes, own * found.rms.powi(2) * fourths];
        self.sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += term);
        let max = copies.scale * found.max;
        if self.worst.is_none_or(|(worst, ..)| max > worst) {
            self.worst = Some((max, found.place, copies.largest));
        }
    }

    fn finish(self, instances: &[MeshInstance]) -> OneSidedDistance {
        let [area, sum, squares] = self.sums;
        let (max, place, instance) = self.worst.expect("a mesh is shown");
        let place = placed(&place, &instances[instance], self.faces_before[instance]);
        OneSidedDistance { mean: sum / area, rms: (squares / area).sqrt(), max, place }
    }
}
