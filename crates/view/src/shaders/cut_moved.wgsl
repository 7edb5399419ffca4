// Writes vertices that have moved to their places among those of all levels.

// Nine words a vertex: its number, three of position, five of attributes.
@group(0) @binding(0) var<storage, read> moved: array<u32>;
@group(0) @binding(1) var<storage, read_write> positions: array<u32>;
@group(0) @binding(2) var<storage, read_write> attributes: array<u32>;

@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = 9u * (id.x + 64u * groups.x * id.y);
    if at >= arrayLength(&moved) {
        return;
    }
    let vertex = moved[at];
    for (var k = 0u; k < 3u; k++) {
        positions[3u * vertex + k] = moved[at + 1u + k];
    }
    for (var k = 0u; k < 5u; k++) {
        attributes[5u * vertex + k] = moved[at + 4u + k];
    }
}
