//! Small connected components, which may be removed as a whole where that costs less than
//! contracting them further.
//!
//! Components that share a position count as one here: what looks like one surface is removed or
//! kept as one, even if its vertices are split.

use meshlod_mesh::{Bounds, FaceId, VertexId, face_components, first_near};

use crate::method::{CostUnit, Method};
use crate::surface::{Flags, Surface};

/// A connected component that may be removed as a whole.
pub(crate) struct VanishingComponent {
    /// Cost of removing the component, comparable to the costs of contractions.
    pub(crate) cost: f64,
    /// Bounding-box diagonal of the component in the input, in model units. It counts as the
    /// distance moved, as if the component shrank to a point.
    pub(crate) size: f64,
    /// Faces of the component in the input.
    pub(crate) faces: Vec<FaceId>,
}

/// Connected components that may still be removed as a whole.
#[derive(Default)]
pub(crate) struct Vanishing {
    /// Candidates for removal, the cheapest last.
    waiting: Vec<VanishingComponent>,
    /// Components larger than the error bound.
    refused: Vec<VanishingComponent>,
}

impl Vanishing {
    /// Finds the components of an unchanged surface whose bounding-box diagonal is less than
    /// `below` and that contain no locked or tied vertex.
    ///
    /// Cost: linear, plus O(n log n), n = components that may vanish.
    pub(crate) fn new(surface: &Surface, method: Method, below: Option<f64>) -> Self {
        let Some(below) = below else { return Self::default() };
        let alive = (0..surface.face_count()).map(FaceId::new).filter(|&f| surface.is_alive(f));
        let alive: Vec<FaceId> = alive.collect();
        let corners: Vec<_> = alive.iter().map(|&face| surface.face(face)).collect();
        let (of_face, count) = components(surface, &corners);
        let mut boxes = vec![(Bounds::EMPTY, false); count];
        for (corners, &component) in corners.iter().zip(&of_face) {
            let (bounds, is_held) = &mut boxes[component as usize];
            corners.iter().for_each(|&v| bounds.add(surface.position(v).into()));
            *is_held |= corners.iter().any(|&v| surface.flags(v).any(Flags::HELD));
        }
        let small = |(bounds, is_held): (Bounds, bool)| {
            let size = bounds.diagonal();
            let component = VanishingComponent { cost: 0.0, size, faces: Vec::new() };
            (size < below && !is_held).then_some(component)
        };
        let mut waiting: Vec<Option<VanishingComponent>> = boxes.into_iter().map(small).collect();
        for (face, component) in alive.into_iter().zip(of_face) {
            if let Some(component) = &mut waiting[component as usize] {
                component.faces.push(face);
            }
        }
        let mut this = Self { waiting: waiting.into_iter().flatten().collect(), ..Self::default() };
        for component in &mut this.waiting {
            component.cost = cost_on(surface, method, component);
        }
        this.sort();
        this
    }

    /// Takes the cheapest component out of the list if removing it costs at most `cost`.
    #[inline]
    pub(crate) fn take_up_to(&mut self, cost: f64) -> Option<VanishingComponent> {
        self.waiting.pop_if(|component| component.cost <= cost)
    }

    /// Returns the cost of removing the cheapest component.
    #[inline]
    pub(crate) fn next_cost(&self) -> Option<f64> {
        self.waiting.last().map(|component| component.cost)
    }

    /// Sets aside a component that is larger than the error bound, until the bound grows.
    pub(crate) fn refuse(&mut self, component: VanishingComponent) {
        self.refused.push(component);
    }

    /// Makes the components that were set aside candidates for removal again.
    pub(crate) fn wake_all(&mut self) {
        if !self.refused.is_empty() {
            self.waiting.append(&mut self.refused);
            self.sort();
        }
    }

    fn sort(&mut self) {
        let first = |component: &VanishingComponent| component.faces.first().copied();
        self.waiting
            .sort_by(|a, b| b.cost.total_cmp(&a.cost).then_with(|| first(b).cmp(&first(a))));
    }
}

/// Returns the component of every face by the positions of its corners, and the number of
/// components.
fn components(surface: &Surface, corners: &[[VertexId; 3]]) -> (Vec<u32>, usize) {
    let vertices = (0..surface.vertex_count()).map(VertexId::new);
    let places: Vec<[f64; 3]> = vertices.map(|v| surface.position(v).to_array()).collect();
    let first = first_near(&places, 0.0);
    let at_place = |v: VertexId| VertexId(first[v.index()]);
    let corners: Vec<_> = corners.iter().map(|face| face.map(at_place)).collect();
    face_components(&corners, places.len())
}

/// Fraction of its size by which a vanishing component counts as moved: about the mean distance
/// from its centre. Mean error in % of the diagonal, sponza at 25 % with `qem` and
/// `lindstrom-turk`, components below 5 % of the diagonal free to vanish: 0.1 .0022, .0071; 0.3
/// .0023, .0020; 1 .0033, .0023; 3 .0041, .0037. The maximum with `qem`: .99, .73, .42, .58.
const SHRINKAGE: f64 = 0.3;

/// Returns the cost of removing a component, in the unit of a method's costs: as if all of it
/// moved by a fraction of its size.
fn cost(method: Method, size: f64, area: f64, faces: usize) -> f64 {
    let cost = match method.cost_unit() {
        CostUnit::Distance => size,
        CostUnit::SquaredDistance => size * size,
        CostUnit::SampledSquaredDistance => faces as f64 * size * size,
        CostUnit::WeightedSquaredDistance => area * size * size,
        // Only the kernel divides by the root of an area.
        CostUnit::SquaredVolume | CostUnit::SquaredVolumePerLength => (area * size).powi(2),
    };
    cost * SHRINKAGE.powi(method.cost_power())
}

/// Returns the cost of a component of a surface, raised if a vertex of it is protected.
fn cost_on(surface: &Surface, method: Method, component: &VanishingComponent) -> f64 {
    let VanishingComponent { size, faces, .. } = component;
    let area = 0.5 * faces.iter().map(|&f| surface.area_normal(f).length()).sum::<f64>();
    let cost = cost(method, *size, area, faces.len());
    let is_protected =
        |f: &FaceId| surface.face(*f).iter().any(|&v| surface.flags(v).any(Flags::PROTECTED));
    if faces.iter().any(is_protected) { cost * surface.protection } else { cost }
}
