//! Distance by which levels reach outside the bounding box of their input.

use std::path::Path;

use anyhow::Result;
use meshlod::mesh::{Bounds, Mesh};

use super::inputs::read;
use super::{Tools, name_of};
use crate::lab::table::Table;

const PERCENTS: [usize; 4] = [50, 10, 3, 1];
/// A level may reach outside by the larger of this many percent of the diagonal, and this many
/// times the distance of `qem`.
const FREE: f64 = 0.5;
const TIMES: f64 = 1.25;

/// Returns the number of levels that reach too far outside, and a table of these.
pub fn table(tools: &Tools) -> Result<String> {
    let mut table = Table::new(["mesh, ratio", "faces wanted", "faces", "outside", "`qem`"]);
    let (mut count, mut beyond, mut failed) = (0, 0, 0);
    let [mut most, mut most_by_qem] = [0.0f64; 2];
    for path in crate::shared_meshes() {
        let mesh = read(&path)?;
        eprintln!("  {}: {} faces …", name_of(&path), mesh.faces.len());
        for percent in PERCENTS {
            count += 1;
            let wanted = mesh.faces.len() * percent / 100;
            let Some((faces, [ours, qem])) = compare(tools, &path, &mesh, wanted)? else {
                failed += 1;
                continue;
            };
            (most, most_by_qem) = (most.max(ours), most_by_qem.max(qem));
            if ours <= FREE.max(TIMES * qem) {
                continue;
            }
            beyond += 1;
            let figures = [ours, qem].map(|outside| format!("{outside:.2}"));
            let numbers = [wanted, faces].map(|faces| faces.to_string());
            let what = format!("{}, {percent} %", name_of(&path));
            table.row([vec![what], numbers.to_vec(), figures.to_vec()].concat());
        }
    }
    Ok(format!(
        "{beyond} of {count} levels reach outside by more than {FREE} % and more than {TIMES} times as \
         far as `qem`; {failed} could not be made. The farthest of all is {most:.2} %, by `qem` \
         {most_by_qem:.2} %.\n\n{}",
        table.markdown()
    ))
}

/// Returns the faces of our level, and how far it and the one by `qem` reach outside; `None` if one
/// cannot be made.
fn compare(
    tools: &Tools,
    path: &Path,
    mesh: &Mesh,
    wanted: usize,
) -> Result<Option<(usize, [f64; 2])>> {
    let folder = tempfile::tempdir()?;
    let output = folder.path().join("out.ply");
    let Some(ours) = tools.simplify(path, &output, wanted, &[]) else { return Ok(None) };
    let faces = ours.faces.len();
    let Some(qem) = tools.simplify(path, &output, faces, &["--method", "qem"]) else {
        return Ok(None);
    };
    Ok(Some((faces, [ours, qem].map(|level| outside(&mesh.bounds(), &level.bounds())))))
}

/// Returns how far a box reaches outside another, in percent of the other's diagonal.
fn outside(input: &Bounds, level: &Bounds) -> f64 {
    let by =
        |axis: usize| (input.min[axis] - level.min[axis]).max(level.max[axis] - input.max[axis]);
    100.0 * (0..3).map(by).fold(0.0, f64::max) / input.diagonal()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_farthest_side_counts() {
        let input = Bounds { min: [0.0; 3], max: [0.0, 3.0, 4.0] };
        let level = Bounds { min: [-0.5, 1.0, 1.0], max: [0.0, 2.0, 4.1] };
        assert_eq!(outside(&input, &level), 10.0);
        assert_eq!(outside(&input, &input), 0.0);
    }
}
