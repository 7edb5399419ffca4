//! Places that the shaders decode, against those of the codec.

use meshlod::codec::{CompressionTarget, Reconstruction, Scheme, compress};
use meshlod::mesh::AttributeBounds;
use meshlod::samples;
use wgpu::{BindGroupLayout, ComputePipeline, ShaderStages};

use super::*;
use crate::gpu::bindings::{STORAGE, UNIFORM, WRITTEN, layout_for};
use crate::gpu::buffers::blank_buffer;
use crate::gpu::read::map;
use crate::gpu::shaders::compute_pipeline;
use crate::{Gpu, TargetFormat};

/// Compute shader that writes the place of every vertex.
const DECODE_ALL: &str = "
@group(3) @binding(0) var<storage, read_write> places: array<f32>;
@group(3) @binding(1) var<storage, read> fetched: array<u32>;

@compute @workgroup_size(64)
fn decode_all(@builtin(global_invocation_id) id: vec3u) {
    if 3u * id.x < arrayLength(&places) {
        let place = PLACE;
        for (var k = 0u; k < 3u; k++) {
            places[3u * id.x + k] = place[k];
        }
    }
}
";

/// Decodes all places. For parts, `fetched` has the fetched word and the part of each vertex.
fn places(
    renderer: &Renderer,
    data: &SchemeData<'_>,
    fetched: &[[u32; 2]],
    count: usize,
) -> Vec<[f32; 3]> {
    let gpu = renderer.gpu();
    let bound = TestBindings::new(gpu, data, fetched, count);
    let pipeline = decode_pipeline(gpu, data.shader, &bound);
    let size = bound.places.size();
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let read = blank_buffer(gpu, "read", size, usage);
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        for (at, group) in (0..).zip(&bound.groups) {
            pass.set_bind_group(at, group, &[]);
        }
        pass.dispatch_workgroups(count.div_ceil(64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&bound.places, 0, &read, 0, size);
    gpu.queue.submit([encoder.finish()]);
    bytemuck::pod_collect_to_vec(&map(gpu, &read).unwrap())
}

/// Bindings of the decoding shader: groups 1 and 3 have those of the scheme and of the test.
struct TestBindings {
    layouts: [BindGroupLayout; 4],
    groups: [BindGroup; 4],
    places: Buffer,
}

impl TestBindings {
    fn new(gpu: &Gpu, data: &SchemeData<'_>, fetched: &[[u32; 2]], count: usize) -> Self {
        let layout = |types: &[_]| layout_for(gpu, ShaderStages::COMPUTE, types);
        let scheme = layout(&[UNIFORM, STORAGE, STORAGE]);
        let layouts = [layout(&[]), scheme, layout(&[]), layout(&[WRITTEN, STORAGE])];
        let uniforms = SchemeUniforms { scale: data.scale.map(|x| x as f32), padding: 0 };
        let uniforms = uniform_of(gpu, "scheme", &uniforms);
        let of = |bytes: &[u8]| storage_of(gpu, bytes, BufferUsages::empty());
        let [words, headers] = data.storages.each_ref().map(|bytes| of(bytes));
        let fetched = of(bytemuck::cast_slice(fetched));
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let places = blank_buffer(gpu, "places", 12 * count as u64, usage);
        let bound: [&[&Buffer]; 4] =
            [&[], &[&uniforms, &words, &headers], &[], &[&places, &fetched]];
        let groups = [0, 1, 2, 3].map(|at| bind_buffers(gpu, &layouts[at], bound[at]));
        Self { layouts, groups, places }
    }
}

/// Compiles the shader that writes the places of a scheme.
fn decode_pipeline(gpu: &Gpu, shader: SchemeShader, bound: &TestBindings) -> ComputePipeline {
    let place = match shader {
        SchemeShader::Parts => "placed(unpack4xU8(fetched[2u * id.x]), fetched[2u * id.x + 1u])",
        _ => "decoded(id.x)",
    };
    let source = shader.source() + &DECODE_ALL.replace("PLACE", place);
    compute_pipeline(gpu, "decode", &source, "decode_all", &bound.layouts.each_ref())
}

/// Compares all places of a mesh, and returns the shader and the largest distance relative to the
/// diagonal.
fn compare(renderer: &Renderer, mesh: &Mesh, scheme: Scheme, bits: u32) -> (SchemeShader, f64) {
    let target = CompressionTarget::Bits(bits);
    let done = compress(mesh, scheme, target, &AttributeBounds::default()).unwrap();
    let stored = done.compressed.stored().unwrap();
    let data = match &stored.positions {
        StoredPositions::Parts(parts) => parts::data(parts, &stored).unwrap(),
        StoredPositions::Blocks(blocks) => blocks::data(blocks, 0),
        StoredPositions::Lattice(lattice) => lattice::data(lattice, 0),
    };
    let mut fetched = Vec::new();
    if let (StoredPositions::Parts(parts), Some(bytes)) = (&stored.positions, &data.fetched) {
        let (words, _) = bytes.as_chunks();
        for (number, part) in (0..).zip(&parts.parts) {
            let words = &words[part.nodes.start as usize..part.nodes.end as usize];
            assert!(words.iter().all(|word| word[3] == number as u8));
            fetched.extend(words.iter().map(|&word| [u32::from_le_bytes(word), number]));
        }
    }
    let count = 1 + stored.position_of.iter().max().map_or(0, |&most| most as usize);
    let found = places(renderer, &data, &fetched, count);
    let decoded = done.compressed.decode().unwrap();
    let diagonal = decoded.bounds().diagonal();
    let mut far: f64 = 0.0;
    for (face, is) in stored.faces.iter().zip(&decoded.faces) {
        for (&node, vertex) in face.iter().zip(is) {
            let place = found[stored.position_of[node as usize] as usize];
            let expected = decoded.positions[vertex.index()];
            for k in 0..3 {
                let away = f64::from(place[k]) + data.origin[k] - expected[k];
                far = far.max(away.abs() / diagonal);
            }
        }
    }
    (data.shader, far)
}

#[test]
fn shaders_decode_the_places_of_the_codec() {
    let Ok(gpu) = Gpu::headless() else {
        eprintln!("skipped: no GPU; apt-get install mesa-vulkan-drivers gives a software one");
        return;
    };
    let renderer = Renderer::new(&gpu, TargetFormat::CANVAS);
    let mut far = samples::knot(3_000);
    far.attributes = None;
    far.positions.iter_mut().for_each(|p| *p = [p[0] + 4.5e6, p[1] - 3.2e6, p[2] + 1e6]);
    let fine = [samples::sphere(300), samples::terrain(1_000), samples::gyroid(3_000)];
    let meshes = [samples::torus(5_000), samples::fish(3_000), far].into_iter().chain(fine);
    let parts = Scheme::Parts(Reconstruction::Centred);
    let mut shaders = Vec::new();
    for (number, mesh) in meshes.enumerate() {
        for bits in [6, 8, 11, 14, 18] {
            let mut schemes = vec![Scheme::Blocks, Scheme::Lattice];
            if bits == 8 {
                schemes.extend([parts, Scheme::Parts(Reconstruction::Truncated)]);
            }
            for scheme in schemes {
                let (shader, away) = compare(&renderer, &mesh, scheme, bits);
                println!("{number} {scheme:?} {bits} bits: {shader:?}, {away:.1e} of the diagonal");
                let allowed = if scheme == Scheme::Lattice { 1e-15 } else { 3e-7 };
                assert!(away <= allowed, "{number} {scheme:?} {bits}: {away}");
                shaders.push(shader);
            }
        }
        let (shader, away) = compare(&renderer, &mesh, Scheme::Blocks, 23);
        println!("{number} blocks 23 bits: {shader:?}, {away:.1e} of the diagonal");
        assert!(away < 3e-7, "{number} {away}");
        shaders.push(shader);
    }
    for path in [
        SchemeShader::Blocks { is_wide: false },
        SchemeShader::Blocks { is_wide: true },
        SchemeShader::Lattice { has_three_words: false },
        SchemeShader::Lattice { has_three_words: true },
        SchemeShader::WideLattice,
    ] {
        assert!(shaders.contains(&path), "{path:?} is not tested");
    }
}
