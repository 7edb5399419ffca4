//! Writes scenes as plain and as compressed glTF, for another program to compare.
//!
//! `cargo run --release -p meshlod-io --example small_gltf -- DIR [FILE …]` puts `NAME.plain.glb`
//! and `NAME.*.glb` into DIR, for samples and for each file; every vertex has a number in
//! `_NUMBER` by which it is found again. Bytes per triangle go to the terminal.

use std::error::Error;
use std::path::{Path, PathBuf};

use meshlod_io::gltf::{
    Bytes, Compression, QuantizedPart, write_compressed_glb, write_glb, write_parts_glb,
};
use meshlod_io::{Node, Scene, SceneMesh};
use meshlod_mesh::{Attributes, Layer, LayerKind, Mesh, WedgeId};
use meshlod_samples as samples;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let folder = arguments.next().ok_or("which folder to write to?")?;
    std::fs::create_dir_all(&folder)?;
    for name in ["torus", "knot"] {
        let mesh = samples::by_name(name, Some(20_000)).ok_or("a sample of that name")?;
        write_both(&folder, name, dressed(mesh))?;
    }
    write_parts(&folder, &samples::by_name("gyroid", Some(5000)).ok_or("a sample of that name")?)?;
    for path in arguments {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        write_both(&folder, &name, meshlod_io::read(&path, &Default::default())?)?;
    }
    Ok(())
}

/// Mesh with normals, colours, and texture coordinates inside and outside the unit square.
fn dressed(mut mesh: Mesh) -> Scene {
    let radius = mesh.bounds().diagonal();
    let layer = |kind, width, value: &dyn Fn([f64; 3]) -> Vec<f64>| Layer {
        kind,
        name: String::new(),
        width,
        values: mesh.positions.iter().flat_map(|&p| value(p)).map(|x| x as f32).collect(),
    };
    let layers = vec![
        layer(LayerKind::Normal, 3, &|p| {
            let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
            p.map(|x| x / length).to_vec()
        }),
        layer(LayerKind::Uv(0), 2, &|[x, y, _]| {
            vec![0.5 + x / radius / 2.0, 0.5 + y / radius / 2.0]
        }),
        layer(LayerKind::Uv(1), 2, &|[x, _, z]| vec![5.0 * x / radius, 3.0 + z / radius]),
        layer(LayerKind::Color(0), 3, &|p| p.map(|x| 0.5 + x / radius / 2.0).to_vec()),
    ];
    let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
    let wedge_count = mesh.positions.len();
    mesh.attributes = Some(Attributes { corners, wedge_count, layers });
    Scene::from_mesh("dressed", mesh)
}

fn write_both(folder: &Path, name: &str, mut scene: Scene) -> Result<(), Box<dyn Error>> {
    let quantized = Compression { meshopt: false, ..Compression::default() };
    for (kind, how) in [("quantized", quantized), ("packed", Compression::default())] {
        let (_, report) = write_compressed_glb(&scene, &[], &how)?;
        let faces: usize = scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).sum();
        let per_face = |bytes: Bytes| bytes.stored as f64 / faces as f64;
        println!(
            "{name}, {kind}: {:.3} + {:.3} + {:.3} bytes a triangle for positions, connectivity, \
             attributes; moved by {:.2e} at most{}",
            per_face(report.positions),
            per_face(report.connectivity),
            per_face(report.attributes),
            report.max_position_error,
            report.kept.iter().map(|kept| format!("\n  {kept}")).collect::<String>(),
        );
    }
    number(&mut scene);
    std::fs::write(folder.join(format!("{name}.plain.glb")), write_glb(&scene, &[])?)?;
    for (kind, how) in [("quantized", quantized), ("packed", Compression::default())] {
        let (glb, _) = write_compressed_glb(&scene, &[], &how)?;
        std::fs::write(folder.join(format!("{name}.{kind}.glb")), glb)?;
    }
    Ok(())
}

/// Numbers all wedges of all meshes.
fn number(scene: &mut Scene) {
    let mut first = 0;
    for mesh in scene.meshes.iter_mut().map(|mesh| &mut mesh.mesh) {
        let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let wedge_count = mesh.positions.len();
        let bare = Attributes { corners, wedge_count, layers: Vec::new() };
        let attributes = mesh.attributes.get_or_insert(bare);
        let numbers = first..first + attributes.wedge_count;
        first = numbers.end;
        let values = numbers.map(|number| number as f32).collect();
        let name = "_NUMBER".to_owned();
        attributes.layers.push(Layer { kind: LayerKind::Other, name, width: 1, values });
    }
}

/// Splits a mesh into runs of faces, each quantized to 256 cells along its longest side, and in
/// floats for comparison.
fn write_parts(folder: &Path, mesh: &Mesh) -> Result<(), Box<dyn Error>> {
    let mut plain = Scene::default();
    let mut parts = Vec::new();
    for faces in mesh.faces.chunks(500) {
        let mut run = Mesh::new(mesh.positions.clone(), faces.to_vec());
        run.compact();
        let bounds = run.bounds();
        let side = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f64::max);
        let cell = side / 255.0;
        let row = |axis: usize| {
            let mut row = [0.0; 4];
            row[axis] = cell as f32;
            row[3] = bounds.min[axis] as f32;
            row
        };
        let cell_of = |p: &[f64; 3]| {
            std::array::from_fn(|axis| ((p[axis] - bounds.min[axis]) / cell).round() as u8)
        };
        parts.push(QuantizedPart {
            matrix: [row(0), row(1), row(2)],
            positions: run.positions.iter().map(cell_of).collect(),
            faces: run.faces.iter().map(|face| face.map(|v| v.0)).collect(),
        });
        plain.nodes.push(Node { mesh: Some(plain.meshes.len()), ..Node::default() });
        plain.roots.push(plain.meshes.len());
        plain.meshes.push(SceneMesh { mesh: run, materials: vec![None], ..SceneMesh::default() });
    }
    std::fs::write(folder.join("parts.plain.glb"), write_glb(&plain, &[])?)?;
    std::fs::write(folder.join("parts.quantized.glb"), write_parts_glb(&parts)?)?;
    Ok(())
}
