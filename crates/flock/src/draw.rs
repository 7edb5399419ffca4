//! Pictures of a flock, every member with its level.

use glam::{Mat3, Vec3};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};
use meshlod_picture::{
    Antialiasing, Background, Lighting, Materials, Normals, Paint, PaintMaterial, Picture,
    PictureError, Style, render,
};

use crate::camera::FlockCamera;
use crate::flock::Flock;
use crate::levels::{LevelTable, Look};
use crate::select::InstanceLevel;

/// Draws flocks of one model, and the obstacles that they swim round.
pub struct FlockPainter<'a> {
    table: &'a LevelTable,
    obstacles: &'a [Mesh],
    paint: OwnedPaint,
    /// Layers of the table that pictures need.
    layers: Vec<&'a Layer>,
    /// Vertices and triangles of each level, for those that have been drawn.
    shapes: Vec<Option<LevelShape>>,
    /// Lighting of members and obstacles.
    pub lighting: Lighting,
    /// Background of the pictures.
    pub background: Background,
}

/// Colours of members and obstacles.
enum OwnedPaint {
    /// Vertex colours.
    Colors,
    /// Materials of the model, and one for obstacles after them.
    Materials(Materials),
}

/// Level with only the vertices that it uses.
struct LevelShape {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// One mesh of all that a frame shows, and the member of each of its faces.
pub struct FrameMesh {
    /// Members, in their order, and then the obstacles.
    pub mesh: Mesh,
    /// First face of every drawn member, with the member, in ascending order.
    pub members: Vec<(u32, u32)>,
    /// Number of faces of members; those of obstacles follow.
    pub member_faces: usize,
}

/// Colour of obstacles, sRGB.
const STONE: [f32; 3] = [0.47, 0.45, 0.42];

/// Colour of members without colours of their own, linear.
const PLAIN: [f32; 3] = [0.75, 0.62, 0.48];

/// Water from the surface down.
const WATER: Background = Background::Gradient { top: [126, 186, 206], bottom: [16, 52, 84] };

impl<'a> FlockPainter<'a> {
    /// Creates a painter; obstacles are in the coordinates of the flock.
    pub fn new(table: &'a LevelTable, look: &'a Look, obstacles: &'a [Mesh]) -> Self {
        let has_colors = table.layers.iter().any(|layer| is_color(layer));
        let paint = match &look.materials {
            Some(materials) => OwnedPaint::Materials(with_stone(materials.clone())),
            None if has_colors => OwnedPaint::Colors,
            None => {
                let plain = PaintMaterial { base_color: PLAIN, texture: None };
                let materials = Materials { materials: vec![plain], ..Materials::default() };
                OwnedPaint::Materials(with_stone(materials))
            }
        };
        let needed = |layer: &&Layer| match (layer.kind, &paint) {
            (LayerKind::Normal, _) => true,
            (LayerKind::Uv(0), OwnedPaint::Materials(_)) => true,
            (_, OwnedPaint::Colors) => is_color(layer),
            _ => false,
        };
        let layers = table.layers.iter().filter(needed).collect();
        let shapes = table.levels.iter().map(|_| None).collect();
        let (lighting, background) = (Lighting::Headlight, WATER);
        Self { table, obstacles, paint, layers, shapes, lighting, background }
    }

    /// Draws a frame: `levels` has an entry for every member of the flock.
    ///
    /// Cost: that of [`render`] for all triangles drawn.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn draw(
        &mut self,
        flock: &Flock,
        levels: &[InstanceLevel],
        camera: &FlockCamera,
    ) -> Result<Picture, PictureError> {
        let frame = self.frame(flock, levels);
        self.render(&frame, camera, &camera.for_picture())
    }

    /// Draws a frame that [`FlockPainter::frame`] made, by any camera of the same size.
    ///
    /// # Errors
    /// A size that pictures cannot have.
    pub fn render(
        &self,
        frame: &FrameMesh,
        camera: &FlockCamera,
        seen_by: &meshlod_picture::Camera,
    ) -> Result<Picture, PictureError> {
        let paint = match &self.paint {
            OwnedPaint::Colors => Paint::Colors,
            OwnedPaint::Materials(materials) => Paint::Materials(materials),
        };
        let style = Style {
            size: camera.size(),
            paint,
            normals: Normals::FromMesh,
            lighting: self.lighting,
            background: self.background,
            antialiasing: Antialiasing::Four,
            ..Style::default()
        };
        render(&frame.mesh, seen_by, &style)
    }

    /// Puts all members that are drawn, and the obstacles, into one mesh.
    pub fn frame(&mut self, flock: &Flock, levels: &[InstanceLevel]) -> FrameMesh {
        let mut members = Vec::new();
        let mut merged = Merged::new(&self.layers);
        for (member, level) in levels.iter().enumerate() {
            let Some(level) = level.level() else { continue };
            members.push((merged.faces.len() as u32, member as u32));
            let shape =
                self.shapes[level].get_or_insert_with(|| LevelShape::new(self.table, level));
            let place = (flock.members.frame(member), flock.members.position(member));
            merged.add_member(self.table, &self.layers, shape, level, place);
        }
        let member_faces = merged.faces.len();
        let stone = match &self.paint {
            OwnedPaint::Colors => 0,
            OwnedPaint::Materials(materials) => materials.materials.len() as u32 - 1,
        };
        for obstacle in self.obstacles {
            merged.add_obstacle(obstacle, stone);
        }
        FrameMesh { mesh: merged.into_mesh(&self.paint), members, member_faces }
    }
}

impl FrameMesh {
    /// Returns the member that a face belongs to; `None` for obstacles.
    pub fn member_of(&self, face: usize) -> Option<usize> {
        if face >= self.member_faces {
            return None;
        }
        let after = self.members.partition_point(|&(first, _)| first as usize <= face);
        Some(self.members[after - 1].1 as usize)
    }
}

fn is_color(layer: &Layer) -> bool {
    layer.kind == LayerKind::Color(0) && layer.width >= 3
}

/// Adds the material of obstacles after those of the model.
fn with_stone(mut materials: Materials) -> Materials {
    // Linear from sRGB, roughly: a shade of grey need not be exact.
    let base_color = STONE.map(|x| x.powf(2.2));
    materials.materials.push(PaintMaterial { base_color, texture: None });
    materials
}

impl LevelShape {
    fn new(table: &LevelTable, level: usize) -> Self {
        let mut local = vec![u32::MAX; table.positions.len()];
        let mut vertices = Vec::new();
        let mut index = |v: u32| {
            let slot = &mut local[v as usize];
            if *slot == u32::MAX {
                *slot = vertices.len() as u32;
                vertices.push(v);
            }
            *slot
        };
        let triangles = table.triangles[table.levels[level].triangles.clone()].iter();
        let triangles = triangles.map(|t| t.map(&mut index)).collect();
        Self { vertices, triangles }
    }
}

/// Mesh of a frame while it is put together.
struct Merged {
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
    layers: Vec<Layer>,
    labels: Vec<u32>,
}

impl Merged {
    fn new(layers: &[&Layer]) -> Self {
        let empty = |layer: &&Layer| Layer { values: Vec::new(), ..(*layer).clone() };
        Self {
            positions: Vec::new(),
            faces: Vec::new(),
            layers: layers.iter().map(empty).collect(),
            labels: Vec::new(),
        }
    }

    fn add_member(
        &mut self,
        table: &LevelTable,
        layers: &[&Layer],
        shape: &LevelShape,
        level: usize,
        (frame, position): (Mat3, Vec3),
    ) {
        let first = self.positions.len() as u32;
        let place = |&v: &u32| {
            let p = frame * Vec3::from(table.positions[v as usize]) + position;
            p.as_dvec3().to_array()
        };
        self.positions.extend(shape.vertices.iter().map(place));
        for (merged, layer) in self.layers.iter_mut().zip(layers) {
            for &v in &shape.vertices {
                let value = layer.of(WedgeId(v));
                if layer.kind == LayerKind::Normal {
                    merged.values.extend((frame * Vec3::from_slice(value)).to_array());
                } else {
                    merged.values.extend_from_slice(value);
                }
            }
        }
        self.faces.extend(shape.triangles.iter().map(|t| t.map(|v| VertexId(first + v))));
        let range = table.levels[level].triangles.clone();
        match &table.materials {
            Some(materials) => self.labels.extend_from_slice(&materials.of_face[range]),
            None => self.labels.resize(self.faces.len(), 0),
        }
    }

    /// Adds an obstacle with smooth normals.
    fn add_obstacle(&mut self, obstacle: &Mesh, material: u32) {
        let first = self.positions.len() as u32;
        let mut normals = vec![Vec3::ZERO; obstacle.positions.len()];
        for &face in &obstacle.faces {
            let [a, b, c] = obstacle.triangle(face);
            let normal = (b - a).cross(c - a).as_vec3();
            face.iter().for_each(|v| normals[v.index()] += normal);
        }
        self.positions.extend(&obstacle.positions);
        for layer in &mut self.layers {
            for normal in &normals {
                match layer.kind {
                    LayerKind::Normal => {
                        layer.values.extend(normal.normalize_or(Vec3::Y).to_array())
                    }
                    LayerKind::Color(_) => {
                        layer.values.extend(STONE.into_iter().chain([1.0]).take(layer.width))
                    }
                    _ => layer.values.extend(std::iter::repeat_n(0.0, layer.width)),
                }
            }
        }
        self.faces.extend(obstacle.faces.iter().map(|t| t.map(|v| VertexId(first + v.0))));
        self.labels.resize(self.faces.len(), material);
    }

    fn into_mesh(self, paint: &OwnedPaint) -> Mesh {
        let Self { positions, faces, layers, labels } = self;
        let corners = faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let attributes = Attributes { corners, wedge_count: positions.len(), layers };
        let materials = match paint {
            OwnedPaint::Colors => None,
            OwnedPaint::Materials(all) => {
                let names = (0..all.materials.len()).map(|i| i.to_string()).collect();
                Some(Labels { names, of_face: labels })
            }
        };
        Mesh { positions, faces, attributes: Some(attributes), materials, objects: None }
    }
}
