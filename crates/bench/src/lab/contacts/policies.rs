//! Figures 10 and 11 of [CC05] remade: fish of several parts without treatment and by each policy
//! for contacts.

use anyhow::Result;
use meshlod::check::{ContactPolicy, LockOptions, locks};
use meshlod::io::write_file;
use meshlod::measure::{DistanceOptions, distance};
use meshlod::mesh::{Lock, Locks, Mesh};
use meshlod::picture::{
    Camera, Picture, ReferenceVisibility, SeeThroughOptions, Style, View, Wireframe, grid, render,
};
use meshlod::simplify::Target;

use super::fish_in_parts::fish_in_parts;
use super::labelled;
use super::open::open_sides;
use super::ways::{Level, Values, by_component, ours};
use crate::lab::folders::root;
use crate::lab::table::Table;

const RATIOS: [f64; 2] = [0.25, 0.1];
/// Folder of the pictures and of the table.
const FOLDER: &str = "docs/notes/contacts";
/// Width and height of one picture.
const SIZE: [u32; 2] = [360, 225];

/// Treatments of contacts, none first.
const TREATMENTS: [Option<ContactPolicy>; 4] =
    [None, Some(ContactPolicy::Tie), Some(ContactPolicy::Protect), Some(ContactPolicy::Exclude)];

/// Draws and measures the fish, and writes pictures and a table.
///
/// # Errors
/// A shared mesh that cannot be read, and errors of the file system. A mesh that is missing is left
/// out.
pub fn run() -> Result<()> {
    let folder = root().join(FOLDER);
    std::fs::create_dir_all(&folder)?;
    let mut table = Table::new([
        "fish, ratio, policy",
        "faces",
        "mean",
        "max",
        "background + hidden",
        "new open edges",
    ]);
    let mut fish = vec![("sample fish in parts", fish_in_parts())];
    for file in ["fish-clown.obj", "fish-bream.obj"] {
        match crate::read(file)? {
            Some(mesh) => fish.push((file, Mesh::new(mesh.positions, mesh.faces))),
            None => eprintln!("not available: {file}"),
        }
    }
    for (index, (name, mesh)) in fish.into_iter().enumerate() {
        eprintln!("{name} …");
        let mesh = by_component(mesh);
        let of_policies = levels(&mesh)?;
        add_rows(&mut table, name, &mesh, &of_policies)?;
        // Only the sample is ours to show.
        if index == 0 {
            write_file(&folder.join("policies.png"), &picture(&mesh, &of_policies)?.png())?;
        }
    }
    let text = format!("Made by `cargo xtask policies`.\n\n{}", table.markdown());
    write_file(&folder.join("policies.md"), text.as_bytes())?;
    Ok(())
}

/// Returns the levels by treatment and ratio.
fn levels(mesh: &Mesh) -> Result<Vec<Vec<Level>>> {
    let targets = RATIOS.map(|ratio| Target::Ratio(ratio).faces_of(mesh.faces.len()));
    let of = |contacts: Option<ContactPolicy>| {
        // The paper excludes open edges as well.
        let is_paper = contacts == Some(ContactPolicy::Exclude);
        let boundary = if is_paper { Lock::Locked } else { Lock::Free };
        let held = contacts.map_or_else(Locks::default, |_| {
            locks(mesh, &LockOptions { contacts, boundary }).locks
        });
        ours(mesh, Values::Dropped, held, open_sides(mesh), &targets)
    };
    TREATMENTS.into_iter().map(of).collect()
}

fn add_rows(table: &mut Table, name: &str, mesh: &Mesh, of_policies: &[Vec<Level>]) -> Result<()> {
    let reference = ReferenceVisibility::new(labelled(mesh), SeeThroughOptions::default())?;
    for (at, ratio) in RATIOS.into_iter().enumerate() {
        for (policy, levels) in TREATMENTS.into_iter().zip(of_policies) {
            let level = &levels[at];
            let far = distance(mesh, &level.mesh, &DistanceOptions::default())?;
            let seen = reference.see_through_counts(labelled(&level.mesh))?;
            let policy = policy.map_or("none", ContactPolicy::name);
            let miss = if level.reached { "" } else { "*" };
            table.row([
                format!("{name}, {:.0} %, {policy}", 100.0 * ratio),
                format!("{}{miss}", level.mesh.faces.len()),
                format!("{:.3}", far.percent(far.mean())),
                format!("{:.2}", far.percent(far.max())),
                format!("{} + {}", seen.background, seen.hidden),
                level.newly_open.to_string(),
            ]);
        }
    }
    Ok(())
}

/// Draws a mesh and its levels with their faces: a row for each ratio, the original first, then the
/// levels in the order of [`TREATMENTS`].
fn picture(original: &Mesh, of_policies: &[Vec<Level>]) -> Result<Picture> {
    let [width, height] = SIZE.map(f64::from);
    let direction = [0.15, -0.2, -1.0];
    let view = View { direction, aspect: width / height, fill: 0.95, ..View::default() };
    let camera = Camera::fit_mesh(original, &view);
    let style = Style { size: SIZE, wireframe: Some(Wireframe::default()), ..Style::default() };
    let rows = (0..RATIOS.len()).flat_map(|at| {
        let levels = of_policies.iter().map(move |levels| &levels[at].mesh);
        std::iter::once(original).chain(levels)
    });
    let pictures: Vec<Picture> =
        rows.map(|mesh| render(mesh, &camera, &style)).collect::<Result<_, _>>()?;
    Ok(grid(&pictures, 1 + TREATMENTS.len())?)
}
