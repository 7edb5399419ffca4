//! Measures the size of `.mlz` files with normals and texture coordinates: positions in 12 bits,
//! normals in 8, texture coordinates in 10 and in 12.

use meshlod_codec::{Transport, TransportFile, TransportOptions, TransportQuantization};
use meshlod_fixtures::shared_mesh;
use meshlod_mesh::{AttributeBounds, LayerKind, Mesh, octahedral};

/// Meshes, and the bytes of Draco (npm draco3d 1.5.9, Edgebreaker, speed 3, that is
/// compression level 7) with the same bits, without random access.
const MESHES: [(&str, [f64; 2]); 4] = [
    ("flight-helmet/FlightHelmet.gltf", [169_340.0, 182_169.0]),
    ("duck.glb", [11_123.0, 12_173.0]),
    ("spot.obj", [11_426.0, 13_027.0]),
    ("fish-bream.obj", [11_201.0, 12_130.0]),
];
/// Bits of normals, and of texture coordinates in [0, 1].
const NORMAL_BITS: u32 = 8;
const UV_BITS: [u32; 2] = [10, 12];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| | uv bits | connectivity | positions | attributes | headers | layers | all | Draco | ratio |"
    );
    println!("|---|--:|--:|--:|--:|--:|---|--:|--:|--:|");
    for (k, bits) in UV_BITS.into_iter().enumerate() {
        let mut sum = 0.0;
        for (name, draco) in MESHES {
            let Some(path) = shared_mesh(name) else { continue };
            let mesh =
                with_normals_and_uvs(meshlod_io::read(&path, &Default::default())?.flatten());
            sum += row(&mesh, name, bits, draco[k])?;
        }
        println!("mean ratio {:.3}", sum / MESHES.len() as f64);
    }
    Ok(())
}

/// Removes all that Draco was not given.
fn with_normals_and_uvs(mut mesh: Mesh) -> Mesh {
    let kept = [LayerKind::Normal, LayerKind::Uv(0)];
    let attributes = mesh.attributes.iter_mut();
    attributes.for_each(|of| of.layers.retain(|layer| kept.contains(&layer.kind)));
    (mesh.materials, mesh.objects) = (None, None);
    mesh
}

/// Prints the row of a mesh and returns its ratio.
fn row(mesh: &Mesh, name: &str, bits: u32, draco: f64) -> Result<f64, Box<dyn std::error::Error>> {
    let attributes = AttributeBounds {
        direction_rad: octahedral::max_error_rad(NORMAL_BITS),
        uv: 0.5 / f64::from(1 << bits),
        ..AttributeBounds::default()
    };
    let quantization = TransportQuantization::Bits(12);
    let options = TransportOptions { quantization, attributes, ..TransportOptions::default() };
    let encoded = Transport::encode(mesh, &options)?;
    TransportFile::open(&encoded.bytes)?.decode()?;
    let ratio = encoded.bytes.len() as f64 / draco;
    let sizes = encoded.sizes;
    let layers: Vec<_> =
        encoded.layers.iter().map(|of| format!("{:?} {}", of.kind, of.bytes)).collect();
    println!(
        "| {name} | {bits} | {:.0} | {:.0} | {:.0} | {:.0} | {} | {} | {draco:.0} | {ratio:.3} |",
        sizes.connectivity,
        sizes.positions,
        sizes.attributes,
        sizes.headers,
        layers.join(", "),
        encoded.bytes.len(),
    );
    Ok(ratio)
}
