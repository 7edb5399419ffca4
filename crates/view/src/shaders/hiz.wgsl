// Pyramid of depths. Follows `alias Depth` and `const SAMPLES`.
// Depth is 1 at the near plane and 0 at infinity, so the farthest of several is the least.

struct Step {
    // Blocks of the level that is made, and of what it is made from.
    size: vec2u,
    from_size: vec2u,
    // First entries of both in the pyramid.
    at: u32,
    first: u32,
}

@group(0) @binding(0) var<uniform> step: Step;
@group(0) @binding(1) var<storage, read_write> pyramid: array<f32>;
@group(1) @binding(0) var depth: Depth;

// Farthest of all samples in two by two pixels.
@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= step.size) {
        return;
    }
    var farthest = 1.0;
    for (var i = 0u; i < 4u; i++) {
        let at = min(2u * id.xy + vec2u(i & 1u, i >> 1u), step.from_size - 1u);
        for (var sample = 0u; sample < SAMPLES; sample++) {
            farthest = min(farthest, textureLoad(depth, at, i32(sample)));
        }
    }
    pyramid[step.at + id.y * step.size.x + id.x] = farthest;
}

@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= step.size) {
        return;
    }
    var farthest = 1.0;
    for (var i = 0u; i < 4u; i++) {
        let at = min(2u * id.xy + vec2u(i & 1u, i >> 1u), step.from_size - 1u);
        farthest = min(farthest, pyramid[step.first + at.y * step.from_size.x + at.x]);
    }
    pyramid[step.at + id.y * step.size.x + id.x] = farthest;
}
