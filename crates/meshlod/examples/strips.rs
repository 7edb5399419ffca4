//! One set of triangle strips that is drawn at every level.
//!
//! `cargo run --release -p meshlod --example strips`

use std::error::Error;

use meshlod::strip::{
    Difference, MergeTree, SkipStrip, StripEffort, StripOptions, difference, stripify,
};
use meshlod::{Target, samples};

fn main() -> Result<(), Box<dyn Error>> {
    let fish = samples::fish(8_000);
    let tree = MergeTree::record(&fish, Target::Ratio(0.02))?;
    let strips = stripify(tree.faces(), &StripOptions::default());
    let mut skip = SkipStrip::new(tree, strips);

    println!("{:>7}  {:>7}  vertices a triangle", "faces", "sent");
    for faces in [8_000, 4_000, 1_000, 200] {
        let contractions = skip.tree().contractions_to(faces);
        skip.set_level(contractions);
        let strips = skip.repaired(StripEffort::Quick);
        let level = skip.tree().level(skip.level());
        assert_eq!(difference(&strips, &level), Difference::default(), "they draw the level");
        let sent = strips.vertices().len();
        println!("{:>7}  {sent:>7}  {:.3}", level.len(), sent as f64 / level.len() as f64);
    }
    Ok(())
}
