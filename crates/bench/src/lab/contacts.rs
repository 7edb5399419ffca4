//! Measures pixels that show through where components meet, and edges that open, for meshlod and
//! meshoptimizer.

mod fish_in_parts;
mod open;
pub mod policies;
mod ways;

use anyhow::Result;
use meshlod::mesh::Mesh;
use meshlod::picture::{LabelledMesh, ReferenceVisibility, SeeThroughCounts, SeeThroughOptions};
use meshlod::simplify::Target;

use crate::lab::table::Table;
use ways::{Level, Way, by_component};

const FILES: [&str; 5] =
    ["fish-clown.obj", "fish-bream.obj", "city.glb", "sponza.obj", "skyscraper.obj"];
const RATIOS: [f64; 3] = [0.5, 0.25, 0.1];
/// Target ratio of see-through pixels to those of the other methods.
const GOAL: f64 = 0.1;

/// A level and its see-through pixels.
struct Figures {
    way: Way,
    level: Level,
    see_through: SeeThroughCounts,
}

/// Returns a table of see-through pixels and new open edges by mesh, ratio and way of
/// simplification.
pub fn section() -> Result<String> {
    let mut table = Table::new([
        "mesh, ratio, way",
        "faces",
        "background + hidden",
        "÷ `qem`",
        "÷ meshoptimizer",
        "new open edges",
    ]);
    let (mut met, mut missing) = (Vec::new(), Vec::new());
    for file in FILES {
        let Some(mesh) = crate::read(file)? else {
            missing.push(file);
            continue;
        };
        let mesh = by_component(mesh);
        for (ratio, figures) in RATIOS.into_iter().zip(figures(&mesh)?) {
            let what = format!("{file}, {:.0} %", ratio * 100.0);
            add_rows(&mut table, &what, &figures);
            let ways: Vec<String> = meeting(&figures).into_iter().map(Way::name).collect();
            if !ways.is_empty() {
                met.push(format!("{what}: {}", ways.join(" / ")));
            }
        }
    }
    Ok(format!("{}\n\n{}{}", text(&met), skipped(&missing), table.markdown()))
}

fn text(met: &[String]) -> String {
    let met = if met.is_empty() { "nowhere".to_owned() } else { met.join("; ") };
    format!(
        "Levels of meshes whose components touch and cross, in 24 views of 1024 by 1024. A pixel counts \
         if the level shows the background or a component there that the original does not show \
         within 4 pixels, unless a silhouette moved there, by at most 32 pixels \
         (`picture::ReferenceVisibility`). Ratios are of the sums, relative to plain `qem` with the \
         same attributes and to meshoptimizer's simplify with its border lock, which sees positions \
         only; `bare` is without attributes and materials. `locked` is what `--lock-contacts` does, \
         `fused` the result of `check::fuse`, both with components as objects. Targets are \
         fractions of the input's faces, before fusing; (*) marks levels that stopped above. An edge \
         is open if no face of any component has the opposite side between the same two positions, \
         and new if no open edge of the input became it. To reproduce: `cargo xtask results \
         contacts`.\n\n\
         A tenth of both or less, on target and with no new open edge: {met}. Nowhere else. The reasons \
         are in [docs/notes/contacts.md](notes/contacts.md#effect)."
    )
}

fn skipped(missing: &[&str]) -> String {
    if missing.is_empty() {
        return String::new();
    }
    format!("Not available: {}.\n\n", missing.join(", "))
}

/// Measures all ways at each ratio.
fn figures(mesh: &Mesh) -> Result<Vec<Vec<Figures>>> {
    let targets = RATIOS.map(|ratio| Target::Ratio(ratio).faces_of(mesh.faces.len()));
    let reference = ReferenceVisibility::new(labelled(mesh), SeeThroughOptions::default())?;
    let mut of_ratios: Vec<Vec<Figures>> = RATIOS.map(|_| Vec::new()).into();
    for way in Way::ALL {
        for (level, figures) in way.levels(mesh, &targets)?.into_iter().zip(&mut of_ratios) {
            let see_through = reference.see_through_counts(labelled(&level.mesh))?;
            figures.push(Figures { way, level, see_through });
        }
    }
    Ok(of_ratios)
}

/// By its objects.
fn labelled(mesh: &Mesh) -> LabelledMesh<'_> {
    let label_of_face = mesh.objects.as_ref().map_or(&[][..], |objects| &objects.of_face);
    LabelledMesh { mesh, label_of_face }
}

fn add_rows(table: &mut Table, what: &str, all: &[Figures]) {
    for own in all {
        let [plain, peer] = own.others(all).map(|other| match other {
            Some(other) if other.sum() > 0 => {
                format!("{:.3}", own.sum() as f64 / other.sum() as f64)
            }
            _ => "–".to_owned(),
        });
        let miss = if own.level.reached { "" } else { "*" };
        let SeeThroughCounts { background, hidden, .. } = own.see_through;
        table.row([
            format!("{what}, {}", own.way.name()),
            format!("{}{miss}", own.level.mesh.faces.len()),
            format!("{background} + {hidden}"),
            plain,
            peer,
            own.level.newly_open.to_string(),
        ]);
    }
}

/// Lists the ways that reach the goal against both baselines.
fn meeting(all: &[Figures]) -> Vec<Way> {
    let is_met = |own: &&Figures| {
        let is_below = |other: Option<&Figures>| {
            other.is_some_and(|other| own.sum() as f64 <= GOAL * other.sum() as f64)
        };
        own.level.reached && own.level.newly_open == 0 && own.others(all).into_iter().all(is_below)
    };
    all.iter().filter(is_met).map(|own| own.way).collect()
}

impl Figures {
    fn sum(&self) -> usize {
        self.see_through.background + self.see_through.hidden
    }

    /// Returns the figures of plain `qem` and of meshoptimizer; `None` for the baseline itself.
    fn others<'a>(&self, all: &'a [Self]) -> [Option<&'a Self>; 2] {
        [Way::Plain(self.way.values()), Way::Peer]
            .map(|other| all.iter().find(|figures| figures.way == other && figures.way != self.way))
    }
}

#[cfg(test)]
mod tests {
    use meshlod::mesh::Mesh;

    use super::*;
    use ways::Values;

    #[test]
    fn a_goal_is_met_against_both_on_target_with_nothing_open() {
        let figures = |way, hidden| {
            let level = Level { mesh: Mesh::default(), reached: true, newly_open: 0 };
            Figures {
                way,
                level,
                see_through: SeeThroughCounts { hidden, ..SeeThroughCounts::default() },
            }
        };
        let with = |locked: Figures| {
            let plain = figures(Way::Plain(Values::Kept), 300);
            meeting(&[plain, figures(Way::Peer, 200), locked])
        };
        let locked = Way::Locked(Values::Kept);
        assert_eq!(with(figures(locked, 20)), [locked]);
        assert!(with(figures(locked, 21)).is_empty());
        let mut open = figures(locked, 20);
        open.level.newly_open = 1;
        assert!(with(open).is_empty());
        let mut above = figures(locked, 20);
        above.level.reached = false;
        assert!(with(above).is_empty());
    }
}
