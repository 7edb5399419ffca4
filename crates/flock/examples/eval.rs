//! Quick evaluation for tuning.
use std::sync::Arc;

use meshlod_flock::evaluate::{Arm, EvaluationOptions, Footage, evaluate};
use meshlod_flock::levels::{ChainOptions, LevelTable, Look, ModelAxes};
use meshlod_flock::select::PolicyName;
use meshlod_flock::simulation::{Simulation, SimulationOptions};
use meshlod_flock::{Camera, Flock};

fn main() {
    let options = ChainOptions {
        axes: ModelAxes::FISH,
        directions: std::env::var("DIRS").map_or(24, |s| s.parse().unwrap()),
        step: std::env::var("STEP").map_or(0.7071, |s| s.parse().unwrap()),
        ..ChainOptions::default()
    };
    let textured = std::env::var("PLAIN").is_err();
    let mut fish = meshlod_samples::fish(4_000);
    let look = if textured {
        let texture = bake(&meshlod_samples::fish(400_000), 1024);
        fish.attributes
            .as_mut()
            .unwrap()
            .layers
            .retain(|l| l.kind != meshlod_mesh::LayerKind::Color(0));
        let material = meshlod_picture::PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
        Look {
            materials: Some(meshlod_picture::Materials {
                materials: vec![material],
                textures: vec![texture],
            }),
        }
    } else {
        Look::default()
    };
    let size: u32 = std::env::var("WIDTH").map_or(640, |s| s.parse().unwrap());
    let table = Arc::new(LevelTable::new(&fish, &look, &options).unwrap());
    let mut footage = Vec::new();
    for (name, members, radius, height) in
        [("ring", 150, 12.0f32, 3.0f32), ("inside", 300, 1.0, 0.5), ("far", 600, 40.0, 10.0)]
    {
        let mut options = SimulationOptions::default();
        options.schools[0] = meshlod_flock::simulation::SchoolOptions::of(members);
        let mut simulation = Simulation::new(&options).unwrap();
        simulation.advance(5.0).unwrap();
        let (mut flocks, mut cameras) = (Vec::new(), Vec::new());
        for frame in 0..60 {
            let mut flock = Flock::default();
            simulation.advance(1.0 / 30.0).unwrap();
            simulation.snapshot(simulation.alpha(), &mut flock);
            let leader = flock.schools[0].leader;
            let t = frame as f32 / 60.0 * 6.28;
            let eye = leader + glam::Vec3::new(radius * t.cos(), height, radius * t.sin());
            let target =
                if radius < 2.0 { leader + flock.schools[0].heading * 4.0 } else { leader };
            cameras.push(
                Camera::look_at(eye.into(), target.into(), 0.8, [size, size * 9 / 16]).unwrap(),
            );
            flocks.push(flock);
        }
        footage.push(Footage {
            name: name.into(),
            flocks,
            cameras,
            obstacles: Vec::new(),
            frame_s: 1.0 / 30.0,
        });
    }
    let arms: Vec<Arm> = if std::env::args().nth(1).is_some() {
        Arm::all()
    } else {
        vec![
            Arm::VisibleOnly(PolicyName::ScreenError),
            Arm::Policy(PolicyName::Budget),
            Arm::Policy(PolicyName::Ours),
            Arm::VisibleOnly(PolicyName::Ours),
        ]
    };
    let options = EvaluationOptions {
        arms: arms.clone(),
        pairs: 2,
        shares: vec![0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6],
        flips: vec![0.02, 0.05, 0.1],
    };
    let start = std::time::Instant::now();
    std::fs::create_dir_all("/tmp/stills").unwrap();
    let result = evaluate(&footage, &table, &look, &options, &mut |_, _| {}, &mut |still| {
        if still.share == 1.0 || still.share == 0.02 {
            let name = format!(
                "/tmp/stills/{}-{}.png",
                still.scene,
                still.arm.as_deref().unwrap_or("full")
            );
            std::fs::write(name, still.picture.png()).unwrap();
        }
    })
    .unwrap();
    println!("{:?}", start.elapsed());
    println!("{:?}", result.floors);
    println!("{:?}", result.full_triangles);
    for (scene, full) in &result.full_triangles {
        for arm in &arms {
            let arm = arm.name();
            print!("{scene:7} {arm:36}");
            for row in result.rows.iter().filter(|r| r.scene == *scene && r.arm == arm) {
                print!(" {:.4}@{:.4}", row.flip(), row.mean_triangles() / full);
            }
            let needed = result.needed.iter().filter(|n| n.scene == *scene && n.arm == arm);
            for n in needed {
                print!(" | {}: {}", n.flip, n.triangles.map_or("-".into(), |t| format!("{t:.0}")));
            }
            let last: Vec<_> =
                result.rows.iter().filter(|r| r.scene == *scene && r.arm == arm).collect();
            println!(
                " te {:.5} sw {:.2} {:.0}us",
                last[3].temporal_error,
                last[3].switches_per_second,
                last[3].selection_seconds * 1e6
            );
        }
    }
    for flip in [0.02, 0.05, 0.1, 0.15] {
        for arm in &arms {
            println!(
                "{flip} ours/{}: {:?}",
                arm.name(),
                result.ratio("ours", &arm.name(), flip).map(|i| (i.low, i.mean, i.high))
            );
        }
    }
}
/// Bakes vertex colours of a mesh with unique uvs into a texture.
fn bake(mesh: &meshlod_mesh::Mesh, side: u32) -> meshlod_picture::Texture {
    use meshlod_mesh::*;
    use meshlod_picture::*;
    let attributes = mesh.attributes.as_ref().unwrap();
    let uv = attributes.layer(LayerKind::Uv(0)).unwrap();
    let color = attributes.layer(LayerKind::Color(0)).unwrap();
    let positions = (0..attributes.wedge_count)
        .map(|w| {
            let v = uv.of(WedgeId(w as u32));
            [f64::from(v[0]), f64::from(v[1]), 0.0]
        })
        .collect();
    let faces: Vec<_> = attributes.corners.iter().map(|c| c.map(|w| VertexId(w.0))).collect();
    let mut flat = Mesh::new(positions, faces);
    flat.attributes = Some(Attributes {
        corners: attributes.corners.clone(),
        wedge_count: attributes.wedge_count,
        layers: vec![color.clone()],
    });
    let distance = 10.0f64;
    let camera = Camera::look_at(
        [0.5, 0.5, distance],
        [0.5, 0.5, 0.0],
        [0.0, 1.0, 0.0],
        2.0 * (0.5f64 / distance).atan(),
    );
    let style = Style {
        size: [side; 2],
        paint: Paint::Colors,
        lighting: Lighting::Unlit,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    let picture = render(&flat, &camera, &style).unwrap();
    let mut rgba = picture.rgba().to_vec();
    let n = side as usize;
    for _ in 0..16 {
        let old = rgba.clone();
        for i in 0..n * n {
            if old[4 * i + 3] != 0 {
                continue;
            }
            let (x, y) = (i % n, i / n);
            for (dx, dy) in [(0i32, 1i32), (1, 0), (0, -1), (-1, 0)] {
                let (a, b) = (x as i32 + dx, y as i32 + dy);
                if a < 0 || b < 0 || a >= n as i32 || b >= n as i32 {
                    continue;
                }
                let j = b as usize * n + a as usize;
                if old[4 * j + 3] != 0 {
                    let p: [u8; 4] = old[4 * j..4 * j + 4].try_into().unwrap();
                    rgba[4 * i..4 * i + 4].copy_from_slice(&[p[0], p[1], p[2], 255]);
                    break;
                }
            }
        }
    }
    for p in rgba.chunks_exact_mut(4) {
        if p[3] == 0 {
            p.copy_from_slice(&[90, 90, 90, 255]);
        }
        p[3] = 255;
    }
    Texture::new(side, side, &rgba).unwrap()
}
