// Parts: a byte per axis, and one for the part within its run of 256 parts, which is an instance.
// Integers are added before anything rounds, so a vertex is at the same bits in all of its parts.

@group(1) @binding(1) var<storage, read> offsets: array<vec4i>;
// A matrix from local cells to clip space for each part, if the paper is to be followed literally.
@group(2) @binding(0) var<storage, read> matrices: array<mat4x4f>;

fn part_of(position: vec4u, run: u32) -> u32 {
    return (run << 8u) + position.w;
}

fn placed(position: vec4u, part: u32) -> vec3f {
    return vec3f(offsets[part].xyz + vec3i(position.xyz)) * scheme.scale;
}

@vertex
fn bare(@location(0) position: vec4u, @builtin(instance_index) run: u32) -> Fragment {
    let part = part_of(position, run);
    return seen_at(placed(position, part), vec3f(0.0), part);
}

@vertex
fn with_normals(
    @location(0) position: vec4u,
    @location(1) normal: vec2f,
    @builtin(instance_index) run: u32,
) -> Fragment {
    let part = part_of(position, run);
    return seen_at(placed(position, part), unfolded(normal), part);
}

@vertex
fn by_matrix(@location(0) position: vec4u, @builtin(instance_index) run: u32) -> Fragment {
    let part = part_of(position, run);
    let clip = matrices[part] * vec4f(vec3f(position.xyz), 1.0);
    return Fragment(clip, placed(position, part), vec3f(0.0), part);
}
