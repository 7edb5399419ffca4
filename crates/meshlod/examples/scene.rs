//! A glTF scene of several meshes, simplified under one budget: detail stays where the scene shows
//! it.
//!
//! `cargo run --release -p meshlod --example scene [IN.glb [OUT.glb]]`

use std::error::Error;
use std::path::PathBuf;

use meshlod::io::{Node, SceneMesh};
use meshlod::jobs::{Aim, SimplifyRequest, simplify};
use meshlod::{ReadOptions, Scene, WriteOptions, read, samples, write};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(PathBuf::from);
    let folder = tempfile::tempdir()?;
    let input = match arguments.next() {
        Some(path) => path,
        None => sample(folder.path().join("scene.glb"))?,
    };
    let output = arguments.next().unwrap_or_else(|| folder.path().join("small.glb"));

    let scene = read(&input, &ReadOptions::default())?;
    let before = faces(&scene);
    let request = SimplifyRequest { target: Aim::Ratio(0.1), ..SimplifyRequest::default() };
    let (scene, report) = simplify(scene, &request, &())?;
    write(&output, &scene, &WriteOptions::default())?;

    for (mesh, (before, after)) in scene.meshes.iter().zip(before.iter().zip(faces(&scene))) {
        println!("{}: {before} faces, now {after}", mesh.name);
    }
    let bytes = [&input, &output].map(|path| std::fs::metadata(path).map_or(0, |file| file.len()));
    println!("{} faces shown, now {}", report.run.input_faces, report.run.output_faces);
    println!("{} bytes, now {}", bytes[0], bytes[1]);
    Ok(())
}

/// Writes a scene of a large fish and a small torus with as many faces.
fn sample(path: PathBuf) -> Result<PathBuf, Box<dyn Error>> {
    let mut scene = Scene::from_mesh("fish", samples::fish(10_000));
    let torus =
        SceneMesh { name: "torus".into(), mesh: samples::torus(10_000), ..Default::default() };
    scene.meshes.push(torus);
    let mut node = Node { mesh: Some(1), ..Node::default() };
    (0..3).for_each(|axis| node.transform[axis][axis] = 0.05);
    scene.roots.push(scene.nodes.len());
    scene.nodes.push(node);
    write(&path, &scene, &WriteOptions::default())?;
    Ok(path)
}

fn faces(scene: &Scene) -> Vec<usize> {
    scene.meshes.iter().map(|mesh| mesh.mesh.faces.len()).collect()
}
