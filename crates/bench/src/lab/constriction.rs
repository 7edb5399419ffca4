//! The tables of the face constriction paper [LJ05], with measurements of meshlod beside them.

use anyhow::Result;
use meshlod::mesh::Mesh;
use meshlod::simplify::{Method, Options, Report, Target, contract_to};

use crate::lab::table::Table;
use crate::{Ratio, alternate, one_core};

const ROUNDS: usize = 9;

/// A row of the paper's tables 1 and 2: number of faces; volume errors and seconds of Wu, Lee &
/// Jang, and Kim & Jang.
const PAPER: [(usize, [f64; 3], [f64; 3]); 5] = [
    (40_000, [2.989e-5, -1.575e-22, -2.967e-21], [0.668, 0.606, 0.681]),
    (20_000, [7.550e-5, 4.872e-22, -3.801e-21], [0.987, 1.012, 1.054]),
    (10_000, [1.387e-4, -2.217e-22, -4.984e-21], [1.118, 1.140, 1.232]),
    (5_000, [2.237e-4, -3.327e-21, -3.384e-21], [1.236, 1.292, 1.276]),
    (1_000, [5.432e-4, -4.035e-21, -8.088e-21], [1.308, 1.758, 1.342]),
];

const METHODS: [Method; 3] = [Method::Wu, Method::LeeJang, Method::KimJang];

/// Returns tables of volume errors and times at the paper's five sizes of the bunny.
pub fn section() -> Result<String> {
    let Some(mesh) = crate::read("bunny.ply")? else {
        return Ok("bunny.ply is not available.\n".to_owned());
    };
    Ok(format!(
        "bunny.ply, 69,451 faces, open at the base. The paper's bunny was scaled, so compare \
         signs, growth and orders of magnitude.\n\n\
         Volume before minus volume after, summed over the contractions with a closed ring:\n\n{}\
         Time of `lee-jang` and `kim-jang`: CPU time on one core, medians of {ROUNDS} alternating \
         rounds, connectivity included; the paper leaves out what both have in common:\n\n{}",
        volumes(&mesh)?.markdown(),
        times(&mesh)?.markdown(),
    ))
}

fn volumes(mesh: &Mesh) -> Result<Table> {
    let mut table = Table::new(vec![
        "faces",
        "wu",
        "lee-jang",
        "kim-jang",
        "Wu (paper)",
        "Lee & Jang (paper)",
        "Kim & Jang (paper)",
    ]);
    for (faces, paper, _) in PAPER {
        let mut row = vec![faces.to_string()];
        for method in METHODS {
            row.push(format!("{:+.3e}", run(mesh, method, faces)?.volume.running_sum));
        }
        row.extend(paper.map(|error| format!("{error:+.3e}")));
        table.row(row);
    }
    Ok(table)
}

fn times(mesh: &Mesh) -> Result<Table> {
    let mut table = Table::new(vec![
        "faces",
        "lee-jang, s",
        "kim-jang, s",
        "lee-jang ÷ kim-jang",
        "lee-jang ÷ kim-jang (paper)",
    ]);
    for (faces, _, [_, lee_jang, kim_jang]) in PAPER {
        let Ratio { ours, theirs, ratio } = one_core(|| {
            let run = |method| run(mesh, method, faces);
            alternate(ROUNDS, || run(Method::LeeJang), || run(Method::KimJang))
        });
        let paper = lee_jang / kim_jang;
        let figures = [ours, theirs, 1.0 / ratio, paper].map(|x| format!("{x:.3}"));
        table.row([faces.to_string()].into_iter().chain(figures).collect::<Vec<_>>());
    }
    Ok(table)
}

fn run(mesh: &Mesh, method: Method, faces: usize) -> Result<Report> {
    let options = Options { method, ..Options::default() };
    Ok(contract_to(mesh, Target::Faces(faces), &options)?.1)
}
