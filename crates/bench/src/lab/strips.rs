//! Measures triangle strips at every level: vertices saved by filters and repair, starting from
//! three kinds of strips.

mod drawn;
mod sent;
mod whole;

use anyhow::{Context, Result};
use meshlod::Target;
use meshlod::strip::{LevelStrips, MergeTree, StripEffort};

use self::sent::{BASES, Base, Levels, Model};
use crate::lab::folders::root;
use crate::lab::table::Table;
use crate::{least_seconds, one_core};

/// Models of [KY05].
const MODELS: [&str; 4] = ["bishop.obj", "eight.off", "femur.off", "triceratops.off"];

pub fn section() -> Result<String> {
    let mut models = Vec::new();
    for file in MODELS {
        let Some(mesh) = crate::read(file)? else { continue };
        models.push(Model::new(file, MergeTree::record(&mesh, Target::Ratio(0.1))?));
    }
    if models.len() < MODELS.len() {
        return Ok("The paper's models are not available.\n".to_owned());
    }
    let mut saved = Table::new([
        "strips of the mesh, model",
        "vertices per triangle of the full mesh",
        "DTFF saves, %",
        "repair, quick",
        "repair",
        "rebuilt",
        "maximum vertices per triangle: STSS",
        "DTFF",
        "repair, quick",
        "repair",
    ]);
    let mut fast = Vec::new();
    for base in BASES {
        let all: Vec<_> = models.iter().map(|model| Levels::of(model, base)).collect();
        all.iter().for_each(|levels| saved.row(row(base, levels)));
        saved.row(mean(base, &all));
        if base == Base::Fast {
            fast = all;
        }
    }
    let drawings = [
        ("figure-5.svg", Some(drawn::figure_5(&fast))),
        ("table-2.svg", Some(drawn::table_2(&fast[1]))),
        ("cache.svg", whole::trade_off()?),
    ];
    let folder = root().join("docs/notes/strips");
    std::fs::create_dir_all(&folder)?;
    for (name, drawing) in drawings {
        if let Some(drawing) = drawing {
            std::fs::write(folder.join(name), drawing).context(name)?;
        }
    }
    Ok(format!(
        "The paper's models at 10, 20, … 100 % of their faces, by `qem-endpoint`. Savings are relative to \
         STSS on the same strips, averaged over the ten levels; the last saves nothing. Repair starts \
         from the same strips, with 100 moves per triangle; quick repair makes 4 passes. `best`, and \
         strips rebuilt at each level: 100 moves per face. Plotted in docs/notes/strips.md. To \
         reproduce: `cargo xtask results strips`.\n\n{}{}{}{}",
        whole::table()?,
        saved.markdown(),
        by_level(&fast),
        sweep()?
    ))
}

fn row(base: Base, levels: &Levels) -> Vec<String> {
    let mut row =
        vec![format!("{}, {}", base.name(), levels.model()), format!("{:.3}", levels.of_mesh())];
    row.extend(levels.saved().map(|saved| format!("{saved:.1}")));
    row.extend(levels.most().map(|most| format!("{most:.3}")));
    row
}

fn mean(base: Base, all: &[Levels]) -> Vec<String> {
    let mut row = vec![format!("**{}, mean and maximum**", base.name())];
    let mean = |of: &dyn Fn(&Levels) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    row.push(format!("{:.3}", mean(&Levels::of_mesh)));
    row.extend((0..4).map(|way| format!("**{:.1}**", mean(&|levels| levels.saved()[way]))));
    let most = |way: usize| all.iter().map(|levels| levels.most()[way]).fold(0.0, f64::max);
    row.extend((0..4).map(|way| format!("**{:.3}**", most(way))));
    row
}

/// Tables vertices per triangle by level, starting from `fast` strips.
fn by_level(all: &[Levels]) -> String {
    let mut text = String::new();
    for levels in all {
        let title = format!("{} on `fast` strips", levels.model());
        let mut table = Table::new([
            title.as_str(),
            "triangles",
            "STSS",
            "DTFF",
            "repair, quick",
            "repair",
            "rebuilt",
            "DTFF over independent triangles, %",
            "repair",
            "DTFF, odd starts free",
        ]);
        levels.rows().for_each(|row| table.row(row));
        text += &table.markdown();
    }
    text
}

/// Follows the horse from all faces to a tenth and back in steps of a hundredth.
fn sweep() -> Result<String> {
    const ROUNDS: usize = 3;
    let Some(mesh) = crate::read("horse.ply")? else { return Ok(String::new()) };
    let tree = MergeTree::record(&mesh, Target::Ratio(0.1))?;
    let mut table = Table::new([
        "the horse to a tenth and back in steps of a hundredth, quick repair",
        "vertices per triangle at the start",
        "mean",
        "maximum",
        "at the end",
        "triangles changed",
        "µs each",
    ]);
    for base in BASES {
        let strips = base.strips(tree.faces());
        let each = |strips: &LevelStrips| {
            strips.strips().vertices().len() as f64 / tree.faces_left(strips.level()) as f64
        };
        let way = (10..100).rev().chain(11..=100);
        let to: Vec<usize> =
            way.map(|percent| tree.contractions_to(mesh.faces.len() * percent / 100)).collect();
        let start = LevelStrips::new(tree.clone(), &strips, StripEffort::Quick);
        let mut live = start.clone();
        let (mut changed, mut all) = (0, Vec::new());
        for &level in &to {
            changed += live.set_level(level);
            all.push(each(&live));
        }
        let seconds = (0..ROUNDS).map(|_| {
            let mut live = start.clone();
            one_core(|| {
                least_seconds(1, || to.iter().map(|&level| live.set_level(level)).sum::<usize>())
            })
        });
        let seconds = seconds.fold(f64::INFINITY, f64::min);
        table.row([
            base.name().to_owned(),
            format!("{:.3}", each(&start)),
            format!("{:.3}", all.iter().sum::<f64>() / all.len() as f64),
            format!("{:.3}", all.iter().copied().fold(0.0, f64::max)),
            format!("{:.3}", all.last().copied().unwrap_or(0.0)),
            changed.to_string(),
            format!("{:.2}", seconds / changed as f64 * 1e6),
        ]);
    }
    Ok(table.markdown())
}
