// Choice of a level for every member of a flock. Follows flock.wgsl.
// Three dispatches: choose and count, plan the draws, and scatter the members to their levels.

struct View {
    eye: vec3f,
    members: u32,
    right: vec3f,
    // Radius of a member, in body lengths.
    radius: f32,
    up: vec3f,
    levels: u32,
    forward: vec3f,
    flags: u32,
    // Tangents of half the fields of view, and the radius over their cosines.
    tangents: vec2f,
    margins: vec2f,
    // Squares of the distances beyond which a member becomes an impostor, and stays one.
    impostors: vec2f,
    draws: u32,
    pad: u32,
}

// Camera that saw the depths of the pyramid.
struct Seen {
    eye: vec3f,
    near: f32,
    right: vec3f,
    // Levels of the pyramid; 0 if there is none yet.
    depth: u32,
    up: vec3f,
    pad: u32,
    forward: vec3f,
    pad2: u32,
    tangents: vec2f,
    size: vec2f,
}

const FACING = 1u;

// Members that are not drawn.
const HIDDEN = 65535u;

@group(0) @binding(0) var<uniform> view: View;
// Position and heading of each member.
@group(0) @binding(1) var<storage, read> members: array<f32>;
// Slot of each member, its level or that of impostors after all levels; and its rank in the slot.
@group(0) @binding(2) var<storage, read_write> chosen: array<vec2u>;
// Members of each slot, then the first instance of each.
@group(0) @binding(3) var<storage, read_write> slots: array<atomic<u32>>;

// Level for each distance, and then for each depth the side of its grid of directions and its first
// facing level.
@group(1) @binding(0) var<storage, read> rule: array<u32>;
@group(1) @binding(1) var<uniform> seen: Seen;
@group(1) @binding(2) var<storage, read> pyramid: array<f32>;

fn is_number(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7fffffffu) < 0x7f800000u;
}

fn three(values: u32) -> vec3f {
    return vec3f(members[values], members[values + 1u], members[values + 2u]);
}

@compute @workgroup_size(256)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.members {
        return;
    }
    let level = level_of(id.x, chosen[id.x].x == view.levels);
    var rank = 0u;
    if level != HIDDEN {
        rank = atomicAdd(&slots[level], 1u);
    }
    chosen[id.x] = vec2u(level, rank);
}

fn level_of(member: u32, was_impostor: bool) -> u32 {
    let position = three(6u * member);
    if !(is_number(position.x) && is_number(position.y) && is_number(position.z)) {
        return HIDDEN;
    }
    let offset = position - view.eye;
    if !in_frustum(offset) || is_occluded(position) {
        return HIDDEN;
    }
    let squared = dot(offset, offset);
    if squared > select(view.impostors.x, view.impostors.y, was_impostor) {
        return view.levels;
    }
    // Entries as in flock::select::ChainLevels.
    let bits = bitcast<u32>(clamp(squared, LEAST, MOST)) >> DROPPED_BITS;
    let level = rule[bits - (bitcast<u32>(LEAST) >> DROPPED_BITS)];
    if (view.flags & FACING) == 0u || squared < NEAREST_FACING * NEAREST_FACING {
        return level;
    }
    let side = rule[ENTRIES + 2u * level];
    if side == 0u {
        return level;
    }
    let frame = frame_of(three(6u * member + 3u));
    let cell = cell_of(-offset * frame, f32(side));
    return rule[ENTRIES + 2u * level + 1u] + u32(cell.y) * side + u32(cell.x);
}

fn in_frustum(offset: vec3f) -> bool {
    let depth = dot(offset, view.forward);
    let across = vec2f(dot(offset, view.right), dot(offset, view.up));
    return depth > -view.radius && all(abs(across) <= depth * view.tangents + view.margins);
}

// True if every pixel that the ball around a member could touch showed something nearer. What the
// earlier camera did not see whole counts as visible.
fn is_occluded(position: vec3f) -> bool {
    if seen.depth == 0u {
        return false;
    }
    let offset = position - seen.eye;
    let depth = dot(offset, seen.forward);
    let nearest = depth - view.radius;
    if !(nearest > seen.near) {
        return false;
    }
    let x = span(dot(offset, seen.right), depth) / seen.tangents.x;
    let y = span(dot(offset, seen.up), depth) / seen.tangents.y;
    if x.x < -1.0 || x.y > 1.0 || y.x < -1.0 || y.y > 1.0 {
        return false;
    }
    // Pixels, y downwards.
    let low = (0.5 + 0.5 * vec2f(x.x, -y.y)) * seen.size;
    let high = (0.5 + 0.5 * vec2f(x.y, -y.x)) * seen.size;
    return is_nearer_everywhere(low, high, seen.near / nearest);
}

// Tangents of the angles between which the ball around a member is seen, along one axis.
fn span(across: f32, depth: f32) -> vec2f {
    let r = view.radius;
    let long = sqrt(across * across + depth * depth - r * r);
    let low = (across * long - r * depth) / (depth * long + r * across);
    let high = (across * long + r * depth) / (depth * long - r * across);
    return vec2f(low, high);
}

// True if all of a rectangle of pixels shows what is nearer than a depth. Looks at three blocks a
// side at most.
fn is_nearer_everywhere(low: vec2f, high: vec2f, depth: f32) -> bool {
    let wide = max(high.x - low.x, high.y - low.y);
    // Blocks of the finest level are two pixels wide.
    let level = min(u32(ceil(log2(max(0.25 * wide, 1.0)))), seen.depth - 1u);
    var size = (vec2u(seen.size) + 1u) / 2u;
    var start = 0u;
    for (var i = 0u; i < level; i++) {
        start += size.x * size.y;
        size = (size + 1u) / 2u;
    }
    let block = f32(2u << level);
    let first = min(vec2u(max(low, vec2f(0.0)) / block), size - 1u);
    let last = min(vec2u(max(high, vec2f(0.0)) / block), size - 1u);
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            if pyramid[start + y * size.x + x] <= depth {
                return false;
            }
        }
    }
    return true;
}

// Level, first index and number of indices of each draw.
@group(1) @binding(0) var<storage, read> draws: array<u32>;
// Arguments of the indexed draws, and of the one that draws impostors.
@group(1) @binding(1) var<storage, read_write> arguments: array<u32>;

var<workgroup> sums: array<u32, 256>;

// Finds the first instance of every slot, and fills in the arguments of all draws.
@compute @workgroup_size(256)
fn plan(@builtin(local_invocation_index) thread: u32) {
    let count = view.levels + 1u;
    let share = (count + 255u) / 256u;
    let begin = min(thread * share, count);
    let end = min(begin + share, count);
    var sum = 0u;
    for (var slot = begin; slot < end; slot++) {
        sum += atomicLoad(&slots[slot]);
    }
    sums[thread] = sum;
    workgroupBarrier();
    var start = 0u;
    for (var i = 0u; i < thread; i++) {
        start += sums[i];
    }
    for (var slot = begin; slot < end; slot++) {
        atomicStore(&slots[count + slot], start);
        start += atomicLoad(&slots[slot]);
    }
    storageBarrier();
    for (var i = thread; i < view.draws; i += 256u) {
        let slot = draws[3u * i];
        let to = 5u * i;
        arguments[to] = draws[3u * i + 2u];
        arguments[to + 1u] = atomicLoad(&slots[slot]);
        arguments[to + 2u] = draws[3u * i + 1u];
        arguments[to + 3u] = 0u;
        arguments[to + 4u] = atomicLoad(&slots[count + slot]);
    }
    if thread == 0u {
        let to = 5u * view.draws;
        arguments[to] = 6u;
        arguments[to + 1u] = atomicLoad(&slots[view.levels]);
        arguments[to + 2u] = 0u;
        arguments[to + 3u] = atomicLoad(&slots[count + view.levels]);
    }
}

@group(1) @binding(0) var<storage, read_write> instances: array<f32>;

// Writes every member among the instances of its slot, relative to the eye.
@compute @workgroup_size(256)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.members || chosen[id.x].x == HIDDEN {
        return;
    }
    let place = chosen[id.x];
    let to = 6u * (atomicLoad(&slots[view.levels + 1u + place.x]) + place.y);
    let position = three(6u * id.x) - view.eye;
    let heading = three(6u * id.x + 3u);
    for (var k = 0u; k < 3u; k++) {
        instances[to + k] = position[k];
        instances[to + 3u + k] = heading[k];
    }
}
