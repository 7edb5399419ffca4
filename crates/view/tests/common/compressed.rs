//! Compressed meshes, and how tests draw them.

use meshlod::codec::{Compressed, CompressionTarget, Reconstruction, Scheme, compress};
use meshlod::jobs::{self, CompressRequest, CompressTarget, Packing, PositionScheme};
use meshlod::mesh::AttributeBounds;
use meshlod::picture::{Camera, Normals, Paint, Picture};
use meshlod::strip::StripQuality;
use meshlod::{Mesh, Scene};
use meshlod_view::{
    Canvas, CompressedOptions, Gpu, GpuCompressed, GpuMesh, Renderer, Shade, TargetFormat,
};

/// Colour of compressed geometry.
const CLAY: Paint<'static> = Paint::Plain([226, 208, 186]);

/// Returns a mesh by all schemes, with cells of about a number of bits for the whole mesh.
pub fn by_schemes(mesh: &Mesh, bits: u32) -> Vec<(&'static str, Compressed)> {
    let by = |scheme| {
        let target = CompressionTarget::Bits(bits);
        compress(mesh, scheme, target, &AttributeBounds::default()).unwrap().compressed
    };
    let parts = by(Scheme::Parts(Reconstruction::Centred));
    vec![
        ("strips of parts", in_strips(mesh, bits)),
        ("parts", parts),
        ("truncated parts", by(Scheme::Parts(Reconstruction::Truncated))),
        ("blocks", by(Scheme::Blocks)),
        ("lattice", by(Scheme::Lattice)),
    ]
}

/// Returns a mesh in parts, with strips for faces.
fn in_strips(mesh: &Mesh, bits: u32) -> Compressed {
    let packing = Packing::Resident {
        scheme: Some(PositionScheme::Parts { strips: Some(StripQuality::Fast) }),
        attributes: AttributeBounds::default(),
    };
    let target = CompressTarget::Bits(bits);
    let request = CompressRequest { packing, target, ..CompressRequest::default() };
    let (bytes, _) = jobs::compress(Scene::from_mesh("", mesh.clone()), &request, &()).unwrap();
    Compressed::from_bytes(&bytes).unwrap()
}

/// How a test draws.
pub struct Stage<'g> {
    pub renderer: Renderer,
    pub canvas: Canvas,
    pub gpu: &'g Gpu,
}

impl<'g> Stage<'g> {
    pub fn new(gpu: &'g Gpu, side: u32) -> Self {
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        Self { renderer, canvas: Canvas::new(gpu, [side; 2]).unwrap(), gpu }
    }

    pub fn compressed(&self, compressed: &Compressed) -> GpuCompressed {
        GpuCompressed::new(&self.renderer, compressed).unwrap()
    }

    pub fn draw(
        &self,
        drawn: &GpuCompressed,
        camera: &Camera,
        shade: &Shade,
        options: &CompressedOptions<'_>,
    ) -> Picture {
        let placement = self.renderer.placement();
        placement.set(camera, self.canvas.size(), drawn.origin(), shade);
        if let Some(matrices) = options.part_matrices {
            matrices.set(camera, self.canvas.size());
        }
        self.canvas.draw(|pass| drawn.draw_with(&self.renderer, pass, &placement, options));
        self.canvas.read().unwrap()
    }

    /// Draws a mesh by the pipelines of meshes.
    pub fn draw_mesh(&self, mesh: &Mesh, normals: Normals, camera: &Camera) -> Picture {
        let drawn = GpuMesh::new(&self.renderer, mesh, &CLAY, normals).unwrap();
        let placement = self.renderer.placement();
        placement.set(camera, self.canvas.size(), drawn.origin(), &Shade::default());
        self.canvas.draw(|pass| drawn.draw(&self.renderer, pass, &placement));
        self.canvas.read().unwrap()
    }
}
