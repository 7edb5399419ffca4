//! Measures the speed of simplification against meshoptimizer, in alternating rounds on one core,
//! and what a second core gives.

use std::time::Instant;

use anyhow::Result;
use meshlod::mesh::Mesh;
use meshlod::samples;
use meshlod::simplify::{Method, Options, Target, contract_to};

use crate::lab::table::Table;
use crate::lab::textured;
use crate::peer::{GpuMesh, Indexed, Settings, Update, simplify_with_update};
use crate::{Ratio, alternate, one_core};

const ROUNDS: usize = 5;
const TO: f64 = 0.1;
const SCANS: [&str; 7] = [
    "bunny.ply",
    "horse-97k.ply",
    "igea.ply",
    "dragon.ply",
    "armadillo-173k.ply",
    "xyzrgb-dragon-28k.ply",
    "lucy-100k.ply",
];
const OTHERS: [Method; 4] =
    [Method::QemEndpoint, Method::LindstromTurkFaces, Method::LeeJang, Method::KimJang];

/// Returns tables of seconds and speed ratios: of scans, of the slower methods, of models with
/// attributes, and of two threads.
pub fn section() -> Result<String> {
    Ok(format!(
        "CPU time on one core, medians of {ROUNDS} alternating rounds; above 1 ours is faster. File input \
         and output are excluded; connectivity and the output mesh are included. meshoptimizer runs simplify \
         with update. To reproduce: `cargo xtask results speed`.\n\n{}Models with charts and materials, \
         with all attributes; meshoptimizer has normals and texture coordinates, and runs simplify with \
         update on a mesh that is ready for it.\n\n{}Clock time of one thread by that of two, least of {ROUNDS} \
         rounds by turns.\n\n{}",
        scans()?.markdown(),
        with_attributes()?.markdown(),
        threads()?.markdown()
    ))
}

fn scans() -> Result<Table> {
    let mut table = ratios("mesh to 10 %, method");
    let plain = |method| (method, Options { method, ..Options::default() });
    for file in SCANS {
        let Some(mesh) = crate::read(file)? else { continue };
        let mut all = [Method::LindstromTurk, Method::Qem].map(plain).to_vec();
        if file == SCANS[1] {
            all.extend(OTHERS.map(plain));
        }
        let polish = Options { polish: true, ..Options::default() };
        let named = all.into_iter().map(|(method, options)| (method.name().to_owned(), options));
        let polished = (format!("{} --polish", Method::LindstromTurk.name()), polish);
        let indexed = Indexed::from(&mesh);
        for (name, options) in named.chain([polished]) {
            let ratio = one_core(|| {
                alternate(
                    ROUNDS,
                    || contract_to(&mesh, Target::Ratio(TO), &options),
                    || simplify_with_update(&indexed, Target::Ratio(TO).faces_of(mesh.faces.len())),
                )
            });
            table.row(row(&format!("{file}, {name}"), &mesh, ratio));
        }
    }
    Ok(table)
}

fn with_attributes() -> Result<Table> {
    let mut table = ratios("model to 10 %");
    let settings = Settings { update: Update::All, ..textured::PEER };
    for model in textured::MODELS {
        let Some(scene) = crate::read_scene(model)? else { continue };
        let mesh = scene.flatten();
        let ready = GpuMesh::new(&mesh);
        let faces = Target::Ratio(TO).faces_of(mesh.faces.len());
        let ratio = one_core(|| {
            alternate(
                ROUNDS,
                || contract_to(&mesh, Target::Ratio(TO), &Options::default()),
                || ready.faces_left(faces, &settings),
            )
        });
        table.row(row(model, &mesh, ratio));
    }
    Ok(table)
}

fn threads() -> Result<Table> {
    let mut table = Table::new(["mesh to 10 %", "faces", "one thread, s", "two, s", "ratio"]);
    let mut all = vec![
        ("terrain with colours".to_owned(), samples::terrain(500_000)),
        ("fish with charts".to_owned(), samples::fish(500_000)),
    ];
    for file in SCANS {
        all.extend(crate::read(file)?.map(|mesh| (file.to_owned(), mesh)));
    }
    for (name, mesh) in all {
        let [mut one, mut two] = [f64::INFINITY; 2];
        for _ in 0..ROUNDS {
            one = one.min(clock(1, &mesh));
            two = two.min(clock(2, &mesh));
        }
        let figures = [one, two].map(|seconds| format!("{seconds:.3}"));
        let [first, second] = figures;
        table.row([name, mesh.faces.len().to_string(), first, second, format!("{:.2}", one / two)]);
    }
    Ok(table)
}

/// Returns a table for [`row`]s of what the first column names.
fn ratios(what: &str) -> Table {
    Table::new([what, "ours, s", "million faces/s", "meshoptimizer, s", "speed ratio"])
}

fn row(what: &str, mesh: &Mesh, Ratio { ours, theirs, ratio }: Ratio) -> Vec<String> {
    let rate = mesh.faces.len() as f64 / ours / 1e6;
    let figures = [format!("{ours:.4}"), format!("{rate:.2}"), format!("{theirs:.4}")];
    let [ours, rate, theirs] = figures;
    vec![what.to_owned(), ours, rate, theirs, format!("{ratio:.2}")]
}

/// Returns the seconds on the clock that this many threads take to simplify a mesh.
fn clock(threads: usize, mesh: &Mesh) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a pool of a few threads can be built").install(|| {
        let start = Instant::now();
        std::hint::black_box(contract_to(mesh, Target::Ratio(TO), &Options::default()).is_ok());
        start.elapsed().as_secs_f64()
    })
}
