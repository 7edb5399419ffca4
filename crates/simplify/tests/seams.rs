//! Seams, borders of materials and corners of charts, which stay where they are worth it and give way
//! where they are not.

mod common;

use std::collections::{BTreeMap, HashMap};

use meshlod_fixtures::shape::volume;
use meshlod_fixtures::{charted, in_materials};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_samples as samples;
use meshlod_simplify::{
    History, Method, Options, Progressive, Simplifier, Target, Topology, contract_to,
};

use crate::common::kernel_methods;

/// A mesh of quads in a lattice, each vertex once, each chart with wedges of its own.
#[derive(Default)]
struct Lattice {
    mesh: Mesh,
    vertices: HashMap<[i32; 3], VertexId>,
    corners: Vec<[WedgeId; 3]>,
    uvs: Vec<f32>,
    normals: Vec<f32>,
    materials: Vec<u32>,
}

impl Lattice {
    /// Adds a square wall of `n` by `n` quads with a chart of its own. `axis` points out of it, or
    /// into it if `is_near`.
    fn wall(&mut self, low: [i32; 3], (axis, is_near): (usize, bool), n: i32) {
        let steps = if is_near { [2, 1] } else { [1, 2] };
        let [u, v] = steps.map(|step| (axis + step) % 3);
        let chart = self.materials.iter().max().map_or(0, |last| last + 1);
        let mut normal = [0.0; 3];
        normal[axis] = if is_near { -1.0 } else { 1.0 };
        let first = self.uvs.len() / 2;
        let mut vertices = Vec::new();
        for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
            let mut at = low;
            at[axis] += if is_near { 0 } else { n };
            (at[u], at[v]) = (at[u] + i, at[v] + j);
            vertices.push(self.vertex(at));
            self.uvs.extend([i, j].map(|x| chart as f32 + x as f32 / n as f32));
            self.normals.extend(normal);
        }
        let at = |i: i32, j: i32| (i * (n + 1) + j) as usize;
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            for triangle in [[a, b, c], [a, c, d]] {
                self.mesh.faces.push(triangle.map(|k| vertices[k]));
                self.corners.push(triangle.map(|k| WedgeId::new(first + k)));
                self.materials.push(chart);
            }
        }
    }

    fn vertex(&mut self, at: [i32; 3]) -> VertexId {
        let positions = &mut self.mesh.positions;
        *self.vertices.entry(at).or_insert_with(|| {
            positions.push(at.map(f64::from));
            VertexId::new(positions.len() - 1)
        })
    }

    /// Returns the mesh with uvs, and with flat normals or a material per chart.
    fn finish(self, with_normals: bool, with_materials: bool) -> Mesh {
        let layer = |kind, width, values| Layer { kind, name: String::new(), width, values };
        let mut layers = vec![layer(LayerKind::Uv(0), 2, self.uvs)];
        if with_normals {
            layers.push(layer(LayerKind::Normal, 3, self.normals));
        }
        let wedge_count = layers[0].values.len() / 2;
        let attributes = Attributes { corners: self.corners, wedge_count, layers };
        let names = (0..=self.materials.iter().copied().max().unwrap_or(0)).map(|i| i.to_string());
        let materials = Labels { names: names.collect(), of_face: self.materials };
        let materials = with_materials.then_some(materials);
        let mesh = Mesh { attributes: Some(attributes), materials, ..self.mesh };
        mesh.validate().unwrap();
        mesh
    }
}

/// Boxes of `n` by `n` quads per wall, each wall with its own chart.
fn boxes(n: i32, count: i32) -> Lattice {
    let mut lattice = Lattice::default();
    for (i, wall) in (0..count).flat_map(|i| (0..6).map(move |wall| (i, wall))) {
        lattice.wall([2 * n * i, n * (i % 3), 0], (wall / 2, wall % 2 == 1), n);
    }
    lattice
}

/// The surface of a figure of unit cubes, each wall of a cube with its own chart: legs, a body and
/// a head, `n` cubes wide.
fn figure(n: i32) -> Lattice {
    let is_solid = |[x, y, z]: [i32; 3]| match z.div_euclid(n) {
        0 => (0..n).contains(&y) && ((0..n).contains(&x) || (2 * n..3 * n).contains(&x)),
        1 => (0..n).contains(&y) && (0..3 * n).contains(&x),
        2 => (0..n).contains(&y) && (n..2 * n).contains(&x),
        _ => false,
    };
    let mut lattice = Lattice::default();
    let cells =
        (0..3 * n).flat_map(|x| (0..n).flat_map(move |y| (0..3 * n).map(move |z| [x, y, z])));
    for cell in cells.filter(|&cell| is_solid(cell)) {
        for axis in 0..3 {
            for (is_near, step) in [(true, -1), (false, 1)] {
                let mut beside = cell;
                beside[axis] += step;
                if !is_solid(beside) {
                    lattice.wall(cell, (axis, is_near), 1);
                }
            }
        }
    }
    lattice
}

fn all_meshes() -> Vec<(&'static str, Mesh)> {
    vec![
        ("box", boxes(8, 1).finish(false, false)),
        ("box with normals", boxes(6, 1).finish(true, false)),
        ("box with materials", boxes(6, 1).finish(false, true)),
        ("boxes", boxes(1, 60).finish(true, false)),
        ("figure", figure(4).finish(false, false)),
        ("figure with normals and materials", figure(3).finish(true, true)),
    ]
}

fn options(method: Method, topology: Topology) -> Options {
    Options { method, topology, ..Options::default() }
}

/// The faces of a mesh: for each corner its position and its values in all layers.
fn drawn(mesh: &Mesh) -> Vec<[(Vec<u64>, Vec<u32>); 3]> {
    let all = mesh.attributes.as_ref().unwrap();
    let values = |w: WedgeId| all.layers.iter().flat_map(move |layer| layer.of(w));
    let faces = mesh.faces.iter().zip(&all.corners);
    let drawn = faces.map(|(face, wedges)| {
        [0, 1, 2].map(|k| {
            let place = mesh.positions[face[k].index()].map(f64::to_bits).to_vec();
            (place, values(wedges[k]).map(|x| x.to_bits()).collect())
        })
    });
    drawn.collect()
}

#[test]
fn a_box_with_a_texture_a_side_goes_down_to_its_twelve_faces() {
    let mesh = boxes(5, 1).finish(false, false);
    let kept = Method::ALL.map(|method| (method, Topology::Keep, 0, 1e-12));
    let free = kernel_methods().map(|method| (method, Topology::Free, 12, 1e-3));
    for (method, topology, faces, most) in kept.into_iter().chain(free) {
        let target = Target::Faces(faces);
        let (level, _) = contract_to(&mesh, target, &options(method, topology)).unwrap();
        assert_eq!(level.faces.len(), 12, "{}", method.name());
        // Corners of the box stay at corners, and so do those of its charts.
        assert!(level.positions.as_flattened().iter().all(|x| (x - x.round()).abs() < most));
        let all = level.attributes.unwrap();
        let mut uvs = all.corners.iter().flatten().flat_map(|&w| all.layers[0].of(w));
        assert!(uvs.all(|uv| f64::from((uv - uv.round()).abs()) < most));
    }
}

#[test]
fn charts_give_way_to_few_faces() {
    for method in kernel_methods() {
        for (name, mesh) in all_meshes() {
            let components = if name == "boxes" { 60 } else { 1 };
            let few = 4 * components;
            for faces in [mesh.faces.len() / 4, 6 * components, few].map(|faces| faces.max(few)) {
                let target = Target::Faces(faces);
                let (level, report) =
                    contract_to(&mesh, target, &options(method, Topology::Free)).unwrap();
                assert!(report.reached, "{name} by {}: {report:?}", method.name());
                level.validate().unwrap();
                let all = level.attributes.as_ref().unwrap();
                assert!(all.layers.iter().flat_map(|layer| &layer.values).all(|x| x.is_finite()));
                // An error bound does not see charts: they stay.
                let options =
                    Options { vanish_below: Some(0.0), ..options(method, Topology::Free) };
                let (kept, _) = contract_to(&mesh, Target::Error(1e9), &options).unwrap();
                assert!(kept.faces.len() >= 2 * few, "{name}: {}", kept.faces.len());
            }
        }
    }
}

#[test]
fn every_face_keeps_its_material_and_its_own_texture() {
    for method in kernel_methods() {
        let mesh = boxes(6, 1).finish(true, true);
        let (level, _) =
            contract_to(&mesh, Target::Faces(8), &options(method, Topology::Free)).unwrap();
        let (all, materials) = (level.attributes.unwrap(), level.materials.unwrap());
        let mut areas = BTreeMap::new();
        for (corners, &material) in all.corners.iter().zip(&materials.of_face) {
            // The walls' charts are unit squares along the diagonal; a normal is one of six.
            let [a, b, c] = corners.map(|w| [0, 1].map(|k| all.layers[0].of(w)[k]));
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            *areas.entry(material).or_insert(0.0) += 0.5 * twice;
            let [mut low, mut high] = [f32::INFINITY, f32::NEG_INFINITY];
            for x in [a, b, c].as_flattened() {
                (low, high) = (low.min(*x), high.max(*x));
            }
            let chart = materials.names[material as usize].parse::<f32>().unwrap();
            assert!(low < chart + 1.0 && high > chart, "{material}: {low} to {high}");
            for w in corners {
                let length = all.layers[1].of(*w).iter().map(|x| x * x).sum::<f32>();
                assert!((length - 1.0).abs() < 1e-4);
            }
        }
        assert!(areas.len() >= 4, "{areas:?}");
    }
}

#[test]
fn observers_see_the_same_wedges() {
    for method in kernel_methods() {
        for (name, mesh) in all_meshes() {
            let options = options(method, Topology::Free);
            let mut simplifier = Simplifier::new(&mesh, &options).unwrap();
            let mut history = History::default();
            let mut levels = Vec::new();
            for part in [3, 8, 20, 1000] {
                let target = Target::Faces((mesh.faces.len() / part).max(4));
                simplifier.run(target, &mut history).unwrap();
                levels.push(drawn(&simplifier.level()));
            }
            let mut progressive = Progressive::new(simplifier, history).unwrap();
            for level in levels.iter().rev() {
                progressive.go_to(level.len());
                assert_eq!(drawn(&progressive.level()), *level, "{name} by {}", method.name());
            }
            progressive.go_to(mesh.faces.len());
            assert_eq!(drawn(&progressive.level()), drawn(&mesh), "{name} by {}", method.name());
        }
    }
}

#[test]
fn runs_and_steps_do_the_same_where_seams_give_way() {
    for method in kernel_methods() {
        for (name, mesh) in all_meshes() {
            let options = options(method, Topology::Free);
            let mut by_steps = Simplifier::new(&mesh, &options).unwrap();
            let mut by_runs = Simplifier::new(&mesh, &options).unwrap();
            for part in [4, 10, 30] {
                by_runs.run(Target::Faces(mesh.faces.len() / part), &mut ()).unwrap();
                while by_steps.live_faces() > by_runs.live_faces() {
                    let cost = by_steps.next_cost().unwrap();
                    by_steps.step(cost, &mut ());
                }
                assert_eq!(drawn(&by_steps.level()), drawn(&by_runs.level()), "{name}");
            }
        }
    }
}

#[test]
fn volume_is_conserved_across_seams() {
    let bare = [samples::knot(4000), samples::torus(4000), samples::gyroid(4000)];
    for mesh in bare.iter().flat_map(|mesh| [charted(mesh), in_materials(mesh)]) {
        for method in Method::ALL.into_iter().filter(|method| method.conserves_volume()) {
            let rounding = if method.runs_in_kernel() { 1e-6 } else { 1e-12 };
            let ways = [Topology::Keep, Topology::Free].map(|topology| options(method, topology));
            for (ratio, options) in
                [0.5, 0.1, 0.02].into_iter().flat_map(|r| ways.iter().map(move |o| (r, o)))
            {
                let (level, report) = contract_to(&mesh, Target::Ratio(ratio), options).unwrap();
                let change = volume(&level) / volume(&mesh) - 1.0;
                let loss = report.volume;
                assert!(
                    change.abs() < rounding,
                    "{} to {ratio}: {change:e}, {} faces, {loss:?}",
                    method.name(),
                    mesh.faces.len()
                );
            }
        }
    }
}
