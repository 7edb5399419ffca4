//! Measures the size of positions on lattices of 11 bits and slightly more.

use meshlod_codec::{Lattice, LatticeBlocks};
use meshlod_fixtures::compression_meshes;
use meshlod_mesh::Bounds;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| | cells along the longest side | bytes per vertex | reduction, % |");
    println!("|---|--:|--:|--:|");
    for (name, path) in compression_meshes() {
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
