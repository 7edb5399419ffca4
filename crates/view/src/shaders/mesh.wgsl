// Meshes with materials: vertices fetched by the input assembler, or pulled from storage where every
// corner needs to know its face.

struct Material {
    base_color: vec4f,
    has_texture: u32,
    is_single_sided: u32,
}

@group(1) @binding(0) var<uniform> material: Material;
@group(1) @binding(1) var image: texture_2d<f32>;
@group(1) @binding(2) var image_sampler: sampler;

@group(2) @binding(0) var<storage, read> all_positions: array<f32>;
@group(2) @binding(1) var<storage, read> all_attributes: array<u32>;
@group(2) @binding(2) var<storage, read> all_indices: array<u32>;
@group(2) @binding(3) var<storage, read> face_colors: array<u32>;

struct Fragment {
    @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) corner: vec3f,
}

@vertex
fn fetched(
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) color: vec4f,
    @location(3) uv: vec2f,
) -> Fragment {
    let clip = draw.clip_from_local * vec4f(position, 1.0);
    return Fragment(clip, position, normal.xyz, uv, color, vec3f(1.0));
}

@vertex
fn pulled(@builtin(vertex_index) at: u32) -> Fragment {
    let v = all_indices[at];
    let position = vec3f(all_positions[3u * v], all_positions[3u * v + 1u], all_positions[3u * v + 2u]);
    let a = 5u * v;
    let normal = vec3f(unpack2x16snorm(all_attributes[a]), unpack2x16snorm(all_attributes[a + 1u]).x);
    var color = unpack4x8unorm(all_attributes[a + 2u]);
    if has(FACE_COLORS) {
        color = unpack4x8unorm(face_colors[at / 3u]);
    }
    let uv = bitcast<vec2f>(vec2u(all_attributes[a + 3u], all_attributes[a + 4u]));
    let k = at % 3u;
    let corner = select(vec3f(0.0), vec3f(1.0), vec3u(0u, 1u, 2u) == vec3u(k));
    let clip = draw.clip_from_local * vec4f(position, 1.0);
    return Fragment(clip, position, normal, uv, color, corner);
}

@fragment
fn shaded(in: Fragment, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return surface(in, front);
}

fn surface(in: Fragment, front: bool) -> vec4f {
    dissolve(in.clip);
    // Backs that are tinted are there to be seen.
    if material.is_single_sided != 0u && !front && !has(TINT_BACK) {
        discard;
    }
    let to_eye = normalize(draw.eye - in.place);
    let normal = seen_normal(in.normal, in.place, to_eye, front);
    let color_of_corner = decode_srgb(in.color.rgb);
    var color = material.base_color.rgb * draw.tint * color_of_corner;
    if material.has_texture != 0u {
        color *= textureSample(image, image_sampler, vec2f(in.uv.x, 1.0 - in.uv.y)).rgb;
    }
    let squares = checker(in.uv);
    if has(TINT_ONLY) {
        color = draw.tint * select(vec3f(1.0), color_of_corner, has(FACE_COLORS));
        color *= select(vec3f(1.0), squares, has(CHECKER));
    }
    if has(TINT_BACK) && !front {
        color = draw.back;
    }
    let light = lit(color, normal, to_eye);
    let line = wire(in.corner);
    if has(WIREFRAME) {
        return vec4f(mix(min(light, vec3f(1.0)), draw.wire.rgb, line * draw.wire.a), 1.0);
    }
    return vec4f(light, 1.0);
}

// Checkerboard in texture coordinates, light and dark, with hues that tell u from v; squares smaller
// than a pixel blend to grey.
fn checker(uv: vec2f) -> vec3f {
    let at = uv * 16.0;
    let wave = abs(fract(at * 0.5) - 0.5) * 4.0 - 1.0;
    let width = max(fwidth(at), vec2f(1e-6));
    let edge = clamp(wave / (2.0 * width), vec2f(-1.0), vec2f(1.0));
    let light = mix(0.19, 0.83, 0.5 + 0.5 * edge.x * edge.y);
    let place = fract(uv);
    return light * vec3f(0.6 + 0.4 * place.x, 0.6 + 0.4 * place.y, 0.78);
}

// How much of a fragment the lines along the edges cover. Lines that would hide most of their face
// fade, so that dense meshes become darker, not black.
fn wire(corner: vec3f) -> f32 {
    let dx = dpdx(corner);
    let dy = dpdy(corner);
    let slope = sqrt(dx * dx + dy * dy);
    let distance = corner / max(slope, vec3f(1e-12));
    let near = min(distance.x, min(distance.y, distance.z));
    let steepest = max(slope.x, max(slope.y, slope.z));
    let narrowest = 1.0 / max(steepest, 1e-12);
    let covered = clamp(0.5 * draw.wire_width + 0.5 - near, 0.0, 1.0);
    return covered * min(narrowest / (5.0 * max(draw.wire_width, 0.1)), 1.0);
}
