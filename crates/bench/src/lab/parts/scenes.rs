//! Random scenes, beside removing their smallest pieces whole.

use anyhow::Result;
use meshlod::measure::PreparedSurface;
use meshlod::mesh::{Bounds, Mesh, face_components};

use super::Tools;
use super::cache::Cache;
use super::deviation::{Deviation, is_at_most, ratio};
use super::inputs::{bare, write};
use crate::fixtures::scene;
use crate::lab::table::Table;

const SCENES: u64 = 100;
const PERCENTS: [usize; 3] = [50, 25, 10];

/// Returns the numbers of levels that are farther off than removing pieces, and a table of these.
pub fn table(tools: &Tools) -> Result<String> {
    let mut table =
        Table::new(["seed, ratio", "faces wanted", "ours", "pieces removed", "short of"]);
    let mut counts = [0; 3];
    for seed in 0..SCENES {
        if seed % 10 == 0 {
            eprintln!("  scenes {seed} to {} …", seed + 9);
        }
        for level in levels_of(tools, seed)? {
            let faults = level.faults();
            for (count, fault) in counts.iter_mut().zip(&faults) {
                *count += usize::from(fault.is_some());
            }
            if faults.iter().any(Option::is_some) {
                table.row(level.row(seed, faults));
            }
        }
    }
    let [unreached, mean, max] = counts;
    let all = SCENES as usize * PERCENTS.len();
    Ok(format!(
        "Of {all} levels, {unreached} did not reach the number of faces, {mean} are farther off in the \
         mean, {max} in the maximum. All these:\n\n{}",
        table.markdown()
    ))
}

/// A level of a scene by us, and by removing pieces.
struct SceneLevel {
    percent: usize,
    wanted: usize,
    ours: Option<Deviation>,
    removed: Option<Deviation>,
}

fn levels_of(tools: &Tools, seed: u64) -> Result<Vec<SceneLevel>> {
    let mesh = bare(scene(seed));
    let folder = tempfile::tempdir()?;
    let [input, output] = ["in.ply", "out.ply"].map(|file| folder.path().join(file));
    write(&input, &mesh)?;
    let surface = PreparedSurface::new(&mesh)?;
    let mut cache = Cache::open([&std::fs::read(&input)?[..]])?;
    let level = |percent: usize| -> Result<SceneLevel> {
        let wanted = mesh.faces.len() * percent / 100;
        let level = tools.simplify(&input, &output, wanted, &[]);
        let ours = level.map(|level| Deviation::of(&surface, &level)).transpose()?.flatten();
        let name = format!("removed-{wanted}");
        if cache.get(&name).is_none() {
            let removed = Deviation::of(&surface, &without_smallest(&mesh, wanted))?;
            cache.set(name.clone(), removed.map(Deviation::to_json).into())?;
        }
        let removed = cache.get(&name).and_then(Deviation::from_json);
        Ok(SceneLevel { percent, wanted, ours, removed })
    };
    PERCENTS.into_iter().map(level).collect()
}

/// Removes whole pieces, those with the smallest bounding boxes first, until at most `wanted` faces
/// or one piece is left.
fn without_smallest(mesh: &Mesh, wanted: usize) -> Mesh {
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let mut bounds = vec![Bounds::EMPTY; count];
    let mut faces = vec![0; count];
    for (face, &piece) in mesh.faces.iter().zip(&of_face) {
        face.iter().for_each(|v| bounds[piece as usize].add(mesh.positions[v.index()]));
        faces[piece as usize] += 1;
    }
    let mut order: Vec<_> = (0..count).collect();
    order.sort_by(|&a, &b| bounds[a].diagonal().total_cmp(&bounds[b].diagonal()));
    let mut left = mesh.faces.len();
    let mut is_gone = vec![false; count];
    for &piece in order.iter().take(count.saturating_sub(1)) {
        if left <= wanted {
            break;
        }
        left -= faces[piece];
        is_gone[piece] = true;
    }
    let kept = mesh.faces.iter().zip(&of_face).filter(|(_, piece)| !is_gone[**piece as usize]);
    let mut rest = Mesh::new(mesh.positions.clone(), kept.map(|(&face, _)| face).collect());
    rest.compact();
    rest
}

impl SceneLevel {
    /// Returns what the level falls short of: its number of faces, the mean, the maximum.
    fn faults(&self) -> [Option<String>; 3] {
        let Some(ours) = self.ours.filter(|level| level.faces <= self.wanted) else {
            return [Some("not reached".to_owned()), None, None];
        };
        let Some(removed) = self.removed else { return [None, None, None] };
        let fault = |name: &str, ours: f64, theirs: f64| {
            let is_short = !is_at_most(ours, 1.0, theirs);
            is_short.then(|| format!("{name} {}", ratio(ours, theirs)))
        };
        [None, fault("mean", ours.mean, removed.mean), fault("max", ours.max, removed.max)]
    }

    fn row(&self, seed: u64, faults: [Option<String>; 3]) -> Vec<String> {
        let cell = |level: Option<Deviation>| {
            level.map_or("–".to_owned(), |level| {
                format!("{} faces: {}", level.faces, level.distances())
            })
        };
        vec![
            format!("{seed}, {} %", self.percent),
            self.wanted.to_string(),
            cell(self.ours),
            cell(self.removed),
            faults.into_iter().flatten().collect::<Vec<_>>().join(", "),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_pieces_go_first_and_one_stays() {
        let mut mesh = crate::fixtures::two_objects();
        mesh.objects = None;
        for p in &mut mesh.positions[4..] {
            *p = p.map(|x| 2.0 * x);
        }
        let rest = without_smallest(&mesh, 5);
        assert_eq!((rest.faces.len(), rest.positions[0]), (4, mesh.positions[4]));
        assert_eq!(without_smallest(&mesh, 0), rest);
        assert_eq!(without_smallest(&mesh, 8).faces, mesh.faces);
    }
}
