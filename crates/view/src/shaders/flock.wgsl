// What all shaders of flocks share: frames of members and grids of directions, as in meshlod::flock.

// Left, up and heading of a member that swims along a unit vector, as columns.
fn frame_of(heading: vec3f) -> mat3x3f {
    let flat = vec3f(heading.z, 0.0, -heading.x);
    let long = length(flat);
    let left = select(vec3f(1.0, 0.0, 0.0), flat / long, long > 1e-6);
    return mat3x3f(left, cross(heading, left), heading);
}

// a with the sign of b, where 0 is positive.
fn with_sign(a: f32, b: f32) -> f32 {
    return select(a, -a, b < 0.0);
}

// Column and row of a direction in an octahedral map of side by side cells.
fn cell_of(direction: vec3f, side: f32) -> vec2f {
    let p = direction / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    let folded = vec2f(with_sign(1.0 - abs(p.y), p.x), with_sign(1.0 - abs(p.x), p.y));
    let at = select(p.xy, folded, p.z < 0.0) * (0.5 * side) + 0.5 * side;
    // Not floor: a border belongs to the same cell as on the CPU.
    return round(clamp(at - 0.5, vec2f(0.0), vec2f(side - 1.0)));
}

// Unit vector along the axis of a cell.
fn axis_of(cell: vec2f, side: f32) -> vec3f {
    let p = 2.0 * (cell + 0.5) / side - 1.0;
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = vec2f(with_sign(1.0 - abs(p.y), p.x), with_sign(1.0 - abs(p.x), p.y));
    return normalize(vec3f(select(p, folded, z < 0.0), z));
}
