//! Measures the size of positions on lattices of 11 bits and slightly more.

use meshlod_codec::{Lattice, LatticeBlocks};
use meshlod_fixtures::shared_mesh;
use meshlod_mesh::Bounds;

const MESHES: [&str; 10] = [
    "squirrel-20k.obj",
    "fandisk-32k.ply",
    "bunny.ply",
    "horse.ply",
    "feline.ply",
    "nefertiti.ply",
    "dragon-100k.ply",
    "horse-97k.ply",
    "armadillo-173k.ply",
    "igea.ply",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| | cells along the longest side | bytes per vertex | reduction, % |");
    println!("|---|--:|--:|--:|");
    for name in MESHES {
        let Some(path) = shared_mesh(name) else { continue };
        let mesh = meshlod_io::read(&path, &Default::default())?.flatten();
        let bounds = Bounds::of(&mesh.positions);
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        let lattice = Lattice::within(longest / 2047.0)?;
        let blocks = LatticeBlocks::new(&mesh, lattice)?;
        println!(
            "| {name} | {:.0} | {:.3} | {:.1} |",
            longest / lattice.cell(),
            blocks.bytes() as f64 / blocks.vertices().len() as f64,
            100.0 * blocks.reduction(),
        );
    }
    Ok(())
}
