// Cuts of a model, of which a scene may show each mesh at several places. Follows draw.wgsl and mesh.wgsl.

// Place of a mesh: rows of the matrix to the space of the scene, and of the one for normals; the last
// of these numbers is -1 where the place mirrors.
struct Place {
    @location(4) x: vec4f,
    @location(5) y: vec4f,
    @location(6) z: vec4f,
    @location(7) normal_x: vec4f,
    @location(8) normal_y: vec4f,
    @location(9) normal_z: vec4f,
}

struct Placed {
    @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec4f,
    @location(4) corner: vec3f,
    @location(5) side: f32,
}

fn placed(at: Place, local: vec3f, normal: vec3f, uv: vec2f, color: vec4f, corner: vec3f) -> Placed {
    let p = vec4f(local, 1.0);
    let place = vec3f(dot(at.x, p), dot(at.y, p), dot(at.z, p));
    let turned =
        vec3f(dot(at.normal_x.xyz, normal), dot(at.normal_y.xyz, normal), dot(at.normal_z.xyz, normal));
    let long = dot(turned, turned);
    let unit = select(vec3f(0.0), turned * inverseSqrt(long), long > 1e-12);
    let clip = draw.clip_from_local * vec4f(place, 1.0);
    return Placed(clip, place, unit, uv, color, corner, at.normal_z.w);
}

@vertex
fn fetched_at(
    at: Place,
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) color: vec4f,
    @location(3) uv: vec2f,
) -> Placed {
    return placed(at, position, normal.xyz, uv, color, vec3f(1.0));
}

@vertex
fn pulled_at(at: Place, @builtin(vertex_index) index: u32) -> Placed {
    let v = all_indices[index];
    let position = vec3f(all_positions[3u * v], all_positions[3u * v + 1u], all_positions[3u * v + 2u]);
    let a = 5u * v;
    let normal = vec3f(unpack2x16snorm(all_attributes[a]), unpack2x16snorm(all_attributes[a + 1u]).x);
    let color = unpack4x8unorm(all_attributes[a + 2u]);
    let uv = bitcast<vec2f>(vec2u(all_attributes[a + 3u], all_attributes[a + 4u]));
    let corner = select(vec3f(0.0), vec3f(1.0), vec3u(0u, 1u, 2u) == vec3u(index % 3u));
    return placed(at, position, normal, uv, color, corner);
}

@fragment
fn shaded_at(in: Placed, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let seen = Fragment(in.clip, in.place, in.normal, in.uv, in.color, in.corner);
    return surface(seen, front == (in.side > 0.0));
}
