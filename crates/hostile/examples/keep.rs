//! `cargo run -p meshlod-hostile --example keep -- TARGET…` keeps the corpora of targets, after
//! `cargo fuzz cmin`.

fn main() -> std::io::Result<()> {
    for target in std::env::args().skip(1) {
        println!("{target}: {} inputs kept", meshlod_hostile::keep(&target)?);
    }
    Ok(())
}
