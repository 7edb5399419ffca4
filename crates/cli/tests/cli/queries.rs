//! Queries that hit: points off the surface, lines and windows over the ground, truncated fields.

use meshlod::{Mesh, ReadOptions, Scene, WriteOptions, samples};
use serde_json::Value;

use crate::run::Run;

fn read(run: &Run, name: &str) -> Mesh {
    meshlod::read(run.path(name), &ReadOptions::default()).unwrap().into_mesh()
}

fn build(run: &Run, mesh: Mesh, options: &[&str]) {
    meshlod::write(run.path("in.ply"), &Scene::from_mesh("", mesh), &WriteOptions::default())
        .unwrap();
    run.json(&[&["build", "in.ply", "in.mlod"], options].concat());
}

fn extract(run: &Run, options: &[&str]) -> (Value, Mesh) {
    let json =
        run.json(&[&["extract", "in.mlod", "out.ply", "--precision", "f64"], options].concat());
    (json, read(run, "out.ply"))
}

/// Returns the distance of a point from a triangle, by samples of it.
fn distance(point: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    const STEPS: i32 = 60;
    let inner = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |k| [i, k]));
    let far = inner.map(|[i, k]| {
        let [u, v] = [i, k].map(|x| f64::from(x) / f64::from(STEPS));
        let at = |n: usize| a[n] + u * (b[n] - a[n]) + v * (c[n] - a[n]);
        (0..3).map(|n| (at(n) - point[n]).powi(2)).sum::<f64>().sqrt()
    });
    far.fold(f64::INFINITY, f64::min)
}

fn distances(mesh: &Mesh, point: [f64; 3]) -> Vec<f64> {
    let corners = |f: &[meshlod::mesh::VertexId; 3]| f.map(|v| mesh.positions[v.index()]);
    mesh.faces.iter().map(|face| distance(point, corners(face))).collect()
}

#[test]
fn a_point_off_the_surface_has_nearest_faces() {
    for (mesh, options) in [
        (samples::torus(3000), &[][..]),
        (samples::terrain(2000), &["--model", "right-triangles"][..]),
    ] {
        let run = Run::new();
        build(&run, mesh, options);
        let (_, finest) = extract(&run, &["--error", "0"]);
        for point in [[0.3, 0.1, 0.2], [0.9, 0.4, 0.1], [30.0, 20.0, -10.0], [0.0, 0.0, 0.0]] {
            let focus = format!("point={},{},{}", point[0], point[1], point[2]);
            let near = ["--error", "0", "--focus", &focus, "--only"];
            let (_, found) = extract(&run, &near);
            let least = distances(&finest, point).into_iter().fold(f64::INFINITY, f64::min);
            assert!((1..20).contains(&found.faces.len()), "{focus}: {}", found.faces.len());
            for far in distances(&found, point) {
                assert!(far < least + 0.02, "{focus}: {far}, {least}");
            }
            // Coarse levels and budgets have nearest faces too.
            for target in [["--error", "1%"], ["--faces", "900"], ["--error", "100%"]] {
                let (_, found) = extract(&run, &[&target[..], &near[2..]].concat());
                assert!((1..40).contains(&found.faces.len()), "{focus}: {target:?}");
            }
            // The rest is coarse.
            let (_, whole) = extract(&run, &near[..4]);
            assert!(2 * whole.faces.len() < finest.faces.len(), "{focus}: {}", whole.faces.len());
        }
    }
}

#[test]
fn lines_and_windows_over_the_ground_are_unbounded_in_height() {
    for options in [&[][..], &["--model", "right-triangles"]] {
        let run = Run::new();
        let mut mesh = samples::terrain(2000);
        // Heights far from those of any window.
        mesh.positions.iter_mut().for_each(|p| p[1] += 50.0);
        build(&run, mesh, options);
        let (_, finest) = extract(&run, &["--error", "0"]);
        let on_ground = |mesh: &Mesh| -> Vec<[[f64; 2]; 3]> {
            let place = |v: &meshlod::mesh::VertexId| {
                let [x, _, z] = mesh.positions[v.index()];
                [x, z]
            };
            mesh.faces.iter().map(|face| [0, 1, 2].map(|k| place(&face[k]))).collect()
        };
        let least = |of: &[[f64; 2]; 3], k: usize| of.iter().map(|p| p[k]).fold(9.0, f64::min);
        let most = |of: &[[f64; 2]; 3], k: usize| of.iter().map(|p| p[k]).fold(-9.0, f64::max);
        let meets = |of: &[[f64; 2]; 3], [x0, z0, x1, z1]: [f64; 4]| {
            least(of, 0) <= x1 && most(of, 0) >= x0 && least(of, 1) <= z1 && most(of, 1) >= z0
        };
        let only = |focus: &str| extract(&run, &["--error", "0", "--focus", focus, "--only"]).1;
        // Boxes around right triangles meet more than the triangles do.
        let window = only("ground-box=-0.21,0.12,0.33,0.41");
        let all = on_ground(&finest);
        let near = |box_of: [f64; 4]| all.iter().filter(|of| meets(of, box_of)).count();
        let (inner, outer) = ([-0.19, 0.14, 0.31, 0.39], [-0.21, 0.12, 0.33, 0.41]);
        let count = window.faces.len();
        assert!(count <= near(outer) && 10 * count >= 8 * near(inner), "{count}");
        assert!(on_ground(&window).iter().all(|of| meets(of, outer)));
        // Along x the line meets exactly the faces on both sides of it.
        let line = only("ground-line=-0.5,0.111,0.5,0.111");
        let along = near([-0.5, 0.111, 0.5, 0.111]);
        assert!(line.faces.len() <= along && 10 * line.faces.len() >= 8 * along, "{along}");
        assert!(on_ground(&line).iter().all(|of| meets(of, [-0.5, 0.111, 0.5, 0.111])));
        // Of the line's whole level, faces off the line are coarse.
        let (_, whole) =
            extract(&run, &["--error", "0", "--focus", "ground-line=-0.5,0.1,0.5,0.1"]);
        assert!(whole.faces.len() < finest.faces.len());
    }
}

#[test]
fn the_vertical_axis_is_that_of_the_heights() {
    let run = Run::new();
    build(&run, samples::terrain(1000), &["--model", "right-triangles"]);
    let base = ["extract", "in.mlod", "out.ply", "--error", "0", "--focus", "ground-line=0,0,1,1"];
    let done = run.run(&[&base[..], &["--up", "z"]].concat());
    assert_eq!(done.code, 2, "{done:?}");
    assert!(done.only_line().contains("along y"), "{done:?}");
    assert_eq!(run.run(&[&base[..], &["--up", "y"]].concat()).code, 0);
    for bad in ["ground-box=1,1,0,0", "ground-line=0,0,1", "ground-line=0,0,nan,1"] {
        let done = run.run(&["extract", "in.mlod", "out.ply", "--error", "0", "--focus", bad]);
        assert_eq!(done.code, 2, "{bad}: {done:?}");
    }
}

#[test]
fn the_start_of_a_height_field_has_its_coarse_levels() {
    let run = Run::new();
    build(&run, samples::terrain(5000), &["--model", "right-triangles"]);
    let whole = std::fs::read(run.path("in.mlod")).unwrap();
    let (_, finest) = extract(&run, &["--error", "0.2%"]);
    let bounds = finest.bounds();
    let mut last = 0;
    for percent in [30, 60, 90] {
        std::fs::write(run.path("in.mlod"), &whole[..whole.len() * percent / 100]).unwrap();
        let done = run.run(&["extract", "in.mlod", "out.ply", "--error", "0.2%", "--json"]);
        assert_eq!(done.code, 0, "{done:?}");
        assert!(done.only_line().contains("the file is truncated"), "{done:?}");
        let json = done.json();
        assert!(json["chunks_there"].as_u64() < json["chunks"].as_u64());
        let level = read(&run, "out.ply");
        // The rectangle of the field is covered in every level.
        for k in [0, 2] {
            assert!((level.bounds().min[k] - bounds.min[k]).abs() < 1e-6);
            assert!((level.bounds().max[k] - bounds.max[k]).abs() < 1e-6);
        }
        assert!(level.faces.len() > last, "{percent}: {} of {last}", level.faces.len());
        last = level.faces.len();
    }
    assert!(last < finest.faces.len());
    // A byte that is wrong is found in what is there.
    let mut damaged = whole[..whole.len() / 2].to_vec();
    let at = damaged.len() / 2;
    damaged[at] ^= 0x40;
    std::fs::write(run.path("in.mlod"), &damaged).unwrap();
    let done = run.run(&["extract", "in.mlod", "out.ply", "--error", "0"]);
    assert_eq!(done.code, 1, "{done:?}");
}
