//! Places that the shaders decode, against those of the codec.

use meshlod::codec::{CompressionTarget, Reconstruction, Scheme, compress};
use meshlod::mesh::AttributeBounds;
use meshlod::samples;
use wgpu::{BufferDescriptor, ShaderStages};

use super::*;
use crate::TargetFormat;
use crate::renderer::{buffer_binding, layout, storage, uniform};

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

/// Decodes all places. Of parts, `fetched` has the fetched word and the part of each vertex.
fn places(
    renderer: &Renderer,
    data: &SchemeData<'_>,
    fetched: &[[u32; 2]],
    count: usize,
) -> Vec<[f32; 3]> {
    let gpu = renderer.gpu();
    let device = &gpu.device;
    let place = match data.shader {
        SchemeShader::Parts => "placed(unpack4xU8(fetched[2u * id.x]), fetched[2u * id.x + 1u])",
        _ => "decoded(id.x)",
    };
    let module =
        renderer.shader("decode", data.shader.source() + &DECODE_ALL.replace("PLACE", place));
    let stage = ShaderStages::COMPUTE;
    let written = buffer_binding(wgpu::BufferBindingType::Storage { read_only: false });
    let none = layout(device, &[]);
    let scheme = layout(device, &[(stage, uniform()), (stage, storage()), (stage, storage())]);
    let test = layout(device, &[(stage, written), (stage, storage())]);
    let layouts = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(&none), Some(&scheme), Some(&none), Some(&test)],
        immediate_size: 0,
    });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: Some(&layouts),
        module: &module,
        entry_point: Some("decode_all"),
        compilation_options: Default::default(),
        cache: None,
    });
    let uniforms = SchemeUniforms { scale: data.scale.map(|x| x as f32), padding: 0 };
    let uniforms = buffer_of(gpu, "scheme", bytemuck::bytes_of(&uniforms), BufferUsages::UNIFORM);
    let of = |bytes: &[u8]| storage_of(gpu, bytes, BufferUsages::empty());
    let storages = data.storages.each_ref().map(|bytes| of(bytes));
    let fetched = of(bytemuck::cast_slice(fetched));
    let size = 12 * count as u64;
    let buffer = |usage| {
        device.create_buffer(&BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    };
    let out = buffer(BufferUsages::STORAGE | BufferUsages::COPY_SRC);
    let read = buffer(BufferUsages::COPY_DST | BufferUsages::MAP_READ);
    let bindings = [&uniforms, &storages[0], &storages[1]].map(Buffer::as_entire_binding);
    let scheme = bind_group(device, &scheme, bindings);
    let test = bind_group(device, &test, [&out, &fetched].map(Buffer::as_entire_binding));
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(1, &scheme, &[]);
        pass.set_bind_group(3, &test, &[]);
        pass.set_bind_group(0, &bind_group(device, &none, []), &[]);
        pass.set_bind_group(2, &bind_group(device, &none, []), &[]);
        pass.dispatch_workgroups(count.div_ceil(64) as u32, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&out, 0, &read, 0, size);
    gpu.queue.submit([encoder.finish()]);
    read.map_async(wgpu::MapMode::Read, .., |done| done.unwrap());
    gpu.wait().unwrap();
    let bytes = read.get_mapped_range(..).unwrap();
    bytemuck::pod_collect_to_vec(&bytes[..])
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
