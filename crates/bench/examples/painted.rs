//! The kernel on meshes with attributes against meshoptimizer's simplify with attributes: speed on
//! one core in alternating rounds, on the model tiled to a million faces, and the image error of
//! the model itself.
//!
//! ```text
//! cargo run --release -p meshlod-bench --example painted -- 3 512 igea.ply pirate.obj
//! ```
//! Takes a number of rounds (0 for none), the side of the pictures in pixels (0 for none), and
//! names of shared models. Models without attributes get smooth normals.

use anyhow::{Context, Result};
use meshlod::mesh::{Attributes, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod::picture::{ReferenceImages, Style};
use meshlod::scene::{materials_of, single_sided_materials};
use meshlod::simplify::{Method, Options, Target, contract_to};
use meshlod_bench::peer::{GpuMesh, Settings, SimplifyOptions, Update, simplify_with_attributes};
use meshlod_bench::{alternate, one_core, read_scene};

/// Number of faces up to which a model is tiled.
const FACES: usize = 1_000_000;

/// The best settings of meshoptimizer, see docs/notes/image-error.md.
const PEER: Settings = Settings {
    normal_weight: 0.1,
    uv_weight: 2.0,
    options: SimplifyOptions::Permissive,
    update: Update::Nothing,
};

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let rounds: usize = args.next().context("give a number of rounds")?.parse()?;
    let side: u32 = args.next().context("give the side of the pictures")?.parse()?;
    println!("mesh ratio faces | speed M/s ours theirs ratio | FLIP ours theirs qem");
    for name in args {
        let scene = read_scene(&name)?.with_context(|| format!("{name} is not available"))?;
        let (materials, _) = materials_of(&scene);
        let mut mesh = scene.flatten();
        if mesh.attributes.is_none() {
            mesh.attributes = Some(smooth_normals(&mesh));
        }
        let single_sided = single_sided_materials(&scene);
        let style = Style::comparison_of(&mesh, &materials, &single_sided);
        let style = Style { size: [side; 2], ..style };
        let portrait = (side > 0).then(|| ReferenceImages::with_style(&mesh, style)).transpose()?;
        for ratio in [0.25, 0.1, 0.01] {
            print!("{name} {ratio}");
            if rounds > 0 {
                speed(&tiled(&mesh), ratio, rounds);
            }
            if let Some(portrait) = &portrait {
                looks(&mesh, ratio, portrait)?;
            }
            println!();
        }
    }
    Ok(())
}

fn options(method: Method) -> Options {
    Options { method, ..Options::default() }
}

fn speed(mesh: &Mesh, ratio: f64, rounds: usize) {
    let torn = GpuMesh::new(mesh);
    let faces = (mesh.faces.len() as f64 * ratio) as usize;
    let options = options(Method::LindstromTurk);
    let ours =
        || contract_to(mesh, Target::Faces(faces), &options).expect("the mesh can be simplified");
    let theirs = || torn.faces_left(faces, &PEER);
    print!(" {} {} of {} |", ours().1.output_faces, theirs(), mesh.faces.len());
    let took = one_core(|| alternate(rounds, ours, theirs));
    let rate = |seconds: f64| mesh.faces.len() as f64 / seconds * 1e-6;
    print!(" {:.2} {:.2} {:.2} |", rate(took.ours), rate(took.theirs), took.ratio);
}

fn looks(mesh: &Mesh, ratio: f64, portrait: &ReferenceImages<'_>) -> Result<()> {
    let faces = (mesh.faces.len() as f64 * ratio) as usize;
    let theirs = simplify_with_attributes(mesh, faces, &PEER);
    let target = Target::Faces(theirs.faces.len());
    let (ours, report) = contract_to(mesh, target, &options(Method::LindstromTurk))?;
    ours.validate()?;
    let qem = contract_to(mesh, target, &options(Method::Qem))?.0;
    print!(" {} {} {} |", theirs.faces.len(), ours.faces.len(), qem.faces.len());
    for level in [&ours, &theirs, &qem] {
        print!(" {:.4}", portrait.error_of(level)?.flip);
    }
    print!(" | {}", report.refusals);
    Ok(())
}

/// Tiles a mesh in a square.
fn tiled(mesh: &Mesh) -> Mesh {
    let times = FACES.div_ceil(mesh.faces.len());
    let side = (times as f64).sqrt().ceil() as usize;
    let step = mesh.bounds().diagonal();
    let mut all = mesh.clone();
    for i in 1..times {
        let by = [(i % side) as f64 * step, (i / side) as f64 * step, 0.0];
        let first = (i * mesh.positions.len()) as u32;
        let moved = mesh.positions.iter().map(|p| [0, 1, 2].map(|axis| p[axis] + by[axis]));
        all.positions.extend(moved);
        all.faces.extend(mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0 + first))));
        if let (Some(own), Some(all)) = (&mesh.attributes, &mut all.attributes) {
            let first = (i * own.wedge_count) as u32;
            all.corners.extend(own.corners.iter().map(|face| face.map(|w| WedgeId(w.0 + first))));
            all.wedge_count += own.wedge_count;
            for (layer, own) in all.layers.iter_mut().zip(&own.layers) {
                layer.values.extend_from_slice(&own.values);
            }
        }
        for (own, all) in [(&mesh.materials, &mut all.materials), (&mesh.objects, &mut all.objects)]
        {
            if let (Some(own), Some(all)) = (own, all) {
                all.of_face.extend_from_slice(&own.of_face);
            }
        }
    }
    all
}

fn smooth_normals(mesh: &Mesh) -> Attributes {
    let mut sums = vec![[0.0; 3]; mesh.positions.len()];
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).to_array();
        for v in face {
            let sum = &mut sums[v.index()];
            *sum = [0, 1, 2].map(|axis| sum[axis] + normal[axis]);
        }
    }
    let unit = |sum: [f64; 3]| {
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        sum.map(|x| (x / length) as f32)
    };
    let values = sums.into_iter().flat_map(unit).collect();
    Attributes {
        corners: mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect(),
        wedge_count: mesh.positions.len(),
        layers: vec![Layer { kind: LayerKind::Normal, name: String::new(), width: 3, values }],
    }
}
