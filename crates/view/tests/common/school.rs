//! School for tests and examples: the sample fish with its colours in a texture, its levels, and
//! frames of scenes.
#![allow(dead_code)]

use std::sync::Arc;

use meshlod::flock::levels::{
    ChainOptions, Impostor, ImpostorOptions, LevelTable, Look, ModelAxes,
};
use meshlod::flock::{Flock, FlockCamera};
use meshlod::mesh::{Attributes, LayerKind, VertexId, WedgeId};
use meshlod::picture::{
    Antialiasing, Background, Camera, Lighting, Materials, Paint, PaintMaterial, Style, Texture,
    render,
};
use meshlod::{Mesh, samples};
use meshlod_school::scene::{Film, Scenario, ScenarioName, ScenarioOptions};

/// Fish of a number of faces, its materials, and its levels.
pub struct SampleSchool {
    pub table: Arc<LevelTable>,
    pub look: Look,
    pub impostor: Arc<Impostor>,
}

impl SampleSchool {
    /// Builds the levels of the fish; `directions` are those of its facing chains.
    pub fn new(faces: usize, directions: usize) -> Self {
        let (fish, look) = textured_fish(faces);
        let options = ChainOptions { axes: ModelAxes::FISH, directions, ..ChainOptions::default() };
        let table = Arc::new(LevelTable::new(&fish, &look, &options).unwrap());
        let impostor = Impostor::draw(&table, &look, &ImpostorOptions::default()).unwrap();
        Self { table, look, impostor: Arc::new(impostor) }
    }
}

/// Returns a frame of a scene: the flock, its camera and its obstacles.
pub fn frame(
    name: ScenarioName,
    members: usize,
    size: [u32; 2],
    frames: usize,
) -> (Flock, FlockCamera, Vec<Mesh>) {
    let options = ScenarioOptions { members, size, frame_s: 0.1, ..ScenarioOptions::default() };
    let scenario = Scenario::named(name, &options).unwrap();
    let obstacles = scenario.obstacle_meshes();
    let mut film = Film::new(scenario).unwrap();
    for _ in 1..frames {
        film.next_frame().unwrap();
    }
    let (flock, camera) = film.next_frame().unwrap();
    (flock.clone(), camera, obstacles)
}

/// Returns the sample fish with its vertex colours painted into a texture.
pub fn textured_fish(faces: usize) -> (Mesh, Look) {
    let mut fish = samples::fish(faces);
    if let Some(attributes) = &mut fish.attributes {
        attributes.layers.retain(|layer| !matches!(layer.kind, LayerKind::Color(_)));
    }
    let texture = painted(&samples::fish(100_000));
    let material = PaintMaterial { base_color: [1.0; 3], texture: Some(0) };
    let materials = Materials { materials: vec![material], textures: vec![texture] };
    (fish, Look { materials: Some(materials) })
}

/// Draws the vertex colours of a mesh over its texture coordinates, in which no faces overlap.
fn painted(mesh: &Mesh) -> Texture {
    const SIDE: u32 = 512;
    let attributes = mesh.attributes.as_ref().unwrap();
    let uv = attributes.layer(LayerKind::Uv(0)).unwrap();
    let place = |wedge: usize| {
        let [u, v] = [0, 1].map(|axis| f64::from(uv.of(WedgeId(wedge as u32))[axis]));
        [u, v, 0.0]
    };
    let positions = (0..attributes.wedge_count).map(place).collect();
    let faces = attributes.corners.iter().map(|face| face.map(|w| VertexId(w.0))).collect();
    let colors = attributes.layer(LayerKind::Color(0)).unwrap().clone();
    let attributes = Attributes { layers: vec![colors], ..attributes.clone() };
    let flat = Mesh { attributes: Some(attributes), ..Mesh::new(positions, faces) };
    let fov = 2.0 * 0.05f64.atan();
    let camera = Camera::look_at([0.5, 0.5, 10.0], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], fov);
    let style = Style {
        size: [SIDE; 2],
        paint: Paint::Colors,
        lighting: Lighting::Unlit,
        background: Background::Transparent,
        antialiasing: Antialiasing::Four,
        ..Style::default()
    };
    let picture = render(&flat, &camera, &style).unwrap();
    let filled = meshlod::picture::bleed(&picture, SIDE).unwrap();
    Texture::new(SIDE, SIDE, filled.rgba()).unwrap()
}
