//! Prints the levels of the sample fish.
use meshlod_flock::levels::{ChainKind, ChainOptions, LevelTable, Look, ModelAxes};
use meshlod_simplify::Method;

fn main() {
    let fish = meshlod_samples::fish(4_000);
    for method in [Method::QemEndpoint, Method::LindstromTurk] {
        let start = std::time::Instant::now();
        let options = ChainOptions { axes: ModelAxes::FISH, method, ..ChainOptions::default() };
        let table = LevelTable::new(&fish, &Look::default(), &options).unwrap();
        println!(
            "{method:?} {:?}: {} vertices {} triangles radius {} half {:?}",
            start.elapsed(),
            table.positions.len(),
            table.triangles.len(),
            table.radius,
            table.half_extent
        );
        let cell = table.directions.cell(glam::Vec3::X);
        let view = table.differences.directions().cell(glam::Vec3::X);
        for chain in 0..3 {
            for level in table.chains[chain].levels.clone() {
                print!("{}:{:.4} ", table.triangle_count(level), table.levels[level].error);
            }
            println!();
        }
        for (i, level) in table.chain(ChainKind::Facing(cell)).levels.clone().enumerate() {
            let d = [100.0, 50.0, 25.0, 12.0, 6.0]
                .map(|px| format!("{:.5}", table.differences.area(view, i, px)));
            println!("{} {:?}", table.triangle_count(level), d);
        }
        println!("silhouette {}", table.differences.silhouette(view));
    }
}
