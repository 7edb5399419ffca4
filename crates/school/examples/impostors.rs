//! Prints the image error of impostors beside that of levels, at several sizes on the screen: the
//! figures of docs/notes/flock-impostors.md.
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{
    ChainOptions, Impostor, ImpostorOptions, LevelTable, Look, ModelAxes,
};
use meshlod::flock::select::InstanceLevel;
use meshlod::flock::{Flock, FlockCamera};
use meshlod::mesh::{Attributes, LayerKind, Mesh, VertexId, WedgeId};
use meshlod::picture::{
    Antialiasing, Background, Lighting, Materials, Paint, PaintMaterial, Picture, Style, Texture,
    bleed, render,
};
use meshlod_school::evaluate::{Reference, triangles_for};
use meshlod_school::simulation::{SchoolOptions, Simulation, SimulationOptions};

/// Pixels of a body length.
const SIZES_PX: [f32; 5] = [4.0, 8.0, 16.0, 32.0, 64.0];

/// Views per side and pixels per view.
const ATLASES: [(usize, u32); 6] = [(8, 64), (12, 64), (16, 64), (24, 64), (12, 32), (16, 128)];

/// Distance of the eye, in body lengths: all members are of nearly the same size.
const DISTANCE: f32 = 100.0;

/// Directions of the eye from the school.
const EYES: [[f32; 3]; 6] = [
    [0.9, 0.2, 0.4],
    [0.1, 0.15, 1.0],
    [-0.5, 0.4, -0.8],
    [0.2, 0.9, 0.3],
    [0.7, -0.5, -0.5],
    [-1.0, 0.05, 0.1],
];

/// Way to draw all members.
struct Arm {
    name: String,
    level: InstanceLevel,
    impostor: Option<Arc<Impostor>>,
    /// Mean triangles of a member, and without those that face away.
    triangles: [f64; 2],
}

fn main() -> Result<(), Box<dyn Error>> {
    let (fish, look) = textured_fish()?;
    let options = ChainOptions { axes: ModelAxes::FISH, ..ChainOptions::default() };
    let table = LevelTable::new(&fish, &look, &options)?;
    let arms = arms(&table, &look)?;
    let flock = school()?;
    let mut painter = FlockPainter::new(&table, &look, &[]);
    painter.background = Background::Plain([128; 3]);
    println!(
        "{:>34} {}",
        "pixels of a body length:",
        SIZES_PX.map(|px| format!("{px:>8}")).concat()
    );
    let mut errors = vec![Vec::new(); arms.len() + 1];
    for px in SIZES_PX {
        for (arm, errors) in flips(&mut painter, &flock, &arms, px)?.into_iter().zip(&mut errors) {
            errors.push(arm);
        }
    }
    for (arm, errors) in arms.iter().zip(&errors) {
        let [all, facing] = arm.triangles;
        let row: String = errors.iter().map(|flip| format!("{flip:>8.4}")).collect();
        println!("{:>14} {all:>8.0} {facing:>8.1}   {row}", arm.name);
    }
    let floor: String = errors[arms.len()].iter().map(|flip| format!("{flip:>8.4}")).collect();
    println!("{:>34}{floor}", "full detail, samples shifted");
    println!("triangles of a level with the error of impostors, and without those that face away:");
    let levels = || arms.iter().zip(&errors).filter(|(arm, _)| arm.impostor.is_none()).rev();
    for (arm, own) in arms.iter().zip(&errors).filter(|(arm, _)| arm.impostor.is_some()) {
        print!("{:>34}", arm.name);
        for (i, &flip) in own.iter().enumerate() {
            let equal = [0, 1].map(|kind| {
                let points: Vec<[f64; 2]> =
                    levels().map(|(arm, errors)| [arm.triangles[kind], errors[i]]).collect();
                triangles_for(&points, flip).map_or("-".into(), |t| format!("{t:.0}"))
            });
            print!("  {}/{}", equal[0], equal[1]);
        }
        println!();
    }
    Ok(())
}

/// Returns levels of up to 400 triangles, and full detail, and impostors.
fn arms(table: &LevelTable, look: &Look) -> Result<Vec<Arm>, Box<dyn Error>> {
    let mut arms = Vec::new();
    for level in table.chains[0].levels.clone().filter(|&i| table.triangle_count(i) <= 1500) {
        let grid = &table.facing[level].directions;
        let facing = (0..grid.len())
            .map(|cell| table.triangle_count(table.facing_level(level, grid.axis(cell))));
        let mean = facing.sum::<usize>() as f64 / grid.len() as f64;
        arms.push(Arm {
            name: "level".into(),
            level: InstanceLevel::drawn(level),
            impostor: None,
            triangles: [table.triangle_count(level) as f64, mean],
        });
    }
    for (views_per_side, side_px) in ATLASES {
        let options = ImpostorOptions { views_per_side, side_px, ..ImpostorOptions::default() };
        let start = Instant::now();
        let impostor = Impostor::draw(table, look, &options)?;
        let name = format!("{views_per_side}² of {side_px} px");
        println!("{name}: drawn in {:.0} ms", start.elapsed().as_secs_f64() * 1e3);
        arms.push(Arm {
            name,
            level: InstanceLevel::IMPOSTOR,
            impostor: Some(Arc::new(impostor)),
            triangles: [2.0; 2],
        });
    }
    Ok(arms)
}

/// Returns the mean FLIP of every arm over all eyes, on the pixels that show members; and last that
/// of full detail whose samples are shifted by a quarter of a pixel each way.
fn flips(
    painter: &mut FlockPainter<'_>,
    flock: &Flock,
    arms: &[Arm],
    px: f32,
) -> Result<Vec<f64>, Box<dyn Error>> {
    let leader = flock.schools[0].leader;
    let reach = (0..flock.members.len()).map(|i| flock.members.position(i).distance(leader));
    let side = (2.0 * (reach.fold(0.0, f32::max) + 1.0) * px).ceil();
    let fov = 2.0 * (0.5 * side / (DISTANCE * px)).atan();
    let mut sums = vec![0.0; arms.len() + 1];
    for eye in EYES {
        let eye = leader + Vec3::from(eye).normalize() * DISTANCE;
        let camera = FlockCamera::look_at(eye.into(), leader.into(), fov, [side as u32; 2])?;
        let reference = Reference::new(painter, flock, &camera)?;
        let full = painter.frame(flock, &vec![InstanceLevel::drawn(0); flock.members.len()]);
        let [right, up, _] = camera.axes();
        let target = (leader + (right + up) * 0.25 / px).as_dvec3();
        let shifted = meshlod::picture::Camera::look_at(
            eye.as_dvec3().into(),
            target.into(),
            up.as_dvec3().into(),
            fov.into(),
        );
        let picture = painter.render(&full, &camera, &shifted)?;
        sums[arms.len()] += reference.score(&full, &camera, &picture)?.flip / EYES.len() as f64;
        for (arm, sum) in arms.iter().zip(&mut sums) {
            painter.impostor.clone_from(&arm.impostor);
            let frame = painter.frame(flock, &vec![arm.level; flock.members.len()]);
            let picture = painter.render(&frame, &camera, &camera.for_picture())?;
            *sum += reference.score(&frame, &camera, &picture)?.flip / EYES.len() as f64;
        }
    }
    Ok(sums)
}

/// Returns a school of 150 that has taken shape.
fn school() -> Result<Flock, Box<dyn Error>> {
    let mut options = SimulationOptions::default();
    options.schools[0] = SchoolOptions::of(150);
    let mut simulation = Simulation::new(&options)?;
    simulation.advance(5.0)?;
    let mut flock = Flock::default();
    simulation.snapshot(1.0, &mut flock);
    Ok(flock)
}

/// Returns the sample fish of 4,000 faces with the colours of a fine one as its texture.
fn textured_fish() -> Result<(Mesh, Look), Box<dyn Error>> {
    let mut fish = meshlod::samples::fish(4_000);
    let layers = &mut fish.attributes.as_mut().ok_or("the fish has attributes")?.layers;
    layers.retain(|layer| layer.kind != LayerKind::Color(0));
    let fine = meshlod::samples::fish(400_000);
    let attributes = fine.attributes.as_ref().ok_or("the fish has attributes")?;
    let uv = attributes.layer(LayerKind::Uv(0)).ok_or("the fish has uvs")?;
    let color = attributes.layer(LayerKind::Color(0)).ok_or("the fish has colours")?;
    let place = |wedge: usize| {
        let uv = uv.of(WedgeId(wedge as u32));
        [f64::from(uv[0]), f64::from(uv[1]), 0.0]
    };
    let positions = (0..attributes.wedge_count).map(place).collect();
    let faces = attributes.corners.iter().map(|c| c.map(|w| VertexId(w.0))).collect();
    let mut flat = Mesh::new(positions, faces);
    flat.attributes = Some(Attributes { layers: vec![color.clone()], ..attributes.clone() });
    let eye = [0.5, 0.5, 10.0];
    let fov = 2.0 * 0.05f64.atan();
    let camera = meshlod::picture::Camera::look_at(eye, [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], fov);
    let style = Style {
        size: [1024; 2],
        paint: Paint::Colors,
        lighting: Lighting::Unlit,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    let picture: Picture = bleed(&render(&flat, &camera, &style)?, 1024)?;
    let texture = Texture::new(1024, 1024, picture.rgba())?;
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials = Materials { materials: vec![material], textures: vec![texture] };
    Ok((fish, Look { materials: Some(materials) }))
}
