//! Flats without an error: faces that are left, beside the fewest that their corners allow.

use std::path::Path;

use anyhow::{Context, Result};
use meshlod::mesh::{ConditionOptions, Locks, Mesh, condition};
use meshlod::samples;

use crate::lab::command::Program;
use crate::lab::table::Table;

/// Samples of about 50,000 faces, with their seeds.
const SHAPES: [(&str, u64); 9] = [
    ("cube", 0),
    ("prism", 0),
    ("boxes", 0),
    ("stairs", 0),
    ("tunnels", 1),
    ("voxels", 0),
    ("voxels", 1),
    ("voxels", 2),
    ("voxels", 3),
];
const FACES: usize = 50_000;

/// Least of this many rounds is the time of a command.
const ROUNDS: usize = 3;

/// Options of `sample`, and the error: as they are without one, or turned and rounded to 32 bits.
const WAYS: [(&str, &[&str], &str); 2] =
    [("", &[], "0"), (", turned", &["--turned", "--precision", "f32"], "0.00001%")];

/// Returns a table of samples as they are and turned.
pub fn table(program: &Program) -> Result<String> {
    let headings = ["shape", "faces", "fewest", "left", "left / fewest", "CPU, s"];
    let mut table = Table::new(headings);
    let folder = tempfile::tempdir()?;
    let [input, output] = ["in.ply", "out.ply"].map(|file| folder.path().join(file));
    for (name, seed) in SHAPES {
        let shape = samples::by_seed(name, Some(FACES), seed).context("a sample")?;
        let fewest = fewest(&shape);
        for (way, options, error) in WAYS {
            eprintln!("  {name} {seed}{way} …");
            let of = if name == "voxels" { format!(", seed {seed}") } else { String::new() };
            let [faces, seed] = [FACES as u64, seed].map(|number| number.to_string());
            let sample = ["sample", name, text(&input)?, "--faces", &faces, "--seed", &seed];
            program.answer(sample.iter().chain(options))?;
            let simplify = ["simplify", text(&input)?, text(&output)?, "--error", error];
            let report = program.answer(simplify)?;
            let left = report["output_faces"].as_u64().context("output_faces")?;
            table.row([
                format!("{name}{of}{way}"),
                shape.faces.len().to_string(),
                fewest.to_string(),
                left.to_string(),
                format!("{:.3}", left as f64 / fewest as f64),
                format!("{:.2}", seconds(program, [&input, &output], error)?),
            ]);
        }
    }
    Ok(format!(
        "`sample SHAPE --faces {FACES}`, then `simplify --error 0`; turned: in a random direction and \
         rounded to 32 bits, within .00001 %. *Fewest*: twice the corners less the Euler number, \
         with non-manifold vertices divided. Processor time of the whole command, least of \
         {ROUNDS}.\n\n{}",
        table.markdown()
    ))
}

/// Returns the least processor time of a run, in seconds.
fn seconds(program: &Program, files: [&Path; 2], error: &str) -> Result<f64> {
    let mut least = f64::INFINITY;
    for _ in 0..ROUNDS {
        let used = program.run(&["simplify", "--error", error], files)?;
        least = least.min((used.utime + used.stime).as_secs_f64());
    }
    Ok(least)
}

/// Returns the fewest faces that a closed shape has with its corners: vertices around which there are
/// faces in three planes or more.
fn fewest(shape: &Mesh) -> usize {
    let split = condition(shape, &Locks::default(), &ConditionOptions::default());
    let mesh = split.as_ref().map_or(shape, |split| &split.mesh);
    let mut planes = vec![Vec::new(); mesh.positions.len()];
    let mut edges = std::collections::HashSet::new();
    for &face in &mesh.faces {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).normalize();
        for v in face {
            let known: &mut Vec<_> = &mut planes[v.index()];
            if known.iter().all(|other| normal.distance(*other) > 1e-6) {
                known.push(normal);
            }
        }
        for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|k: usize| face[k])) {
            edges.insert([a.min(b), a.max(b)]);
        }
    }
    let used = planes.iter().filter(|planes| !planes.is_empty()).count();
    let corners = planes.iter().filter(|planes| planes.len() > 2).count();
    // Faces, edges and vertices of a surface with corners alone, of the same Euler number.
    2 * (corners + edges.len() - used - mesh.faces.len())
}

fn text(path: &Path) -> Result<&str> {
    path.to_str().context("a path that is no text")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fewest_faces_are_those_of_the_corners() {
        let of = |name| fewest(&samples::by_seed(name, Some(3_000), 0).unwrap());
        assert_eq!([of("cube"), of("prism"), of("boxes"), of("stairs")], [12, 396, 2_400, 100]);
    }
}
