// Impostors of a flock: quads that show a view of an atlas. Follows `const SAMPLES`, draw.wgsl and
// flock.wgsl.

struct Atlas {
    // Half of the width that a view shows, in body lengths.
    half_width: f32,
    // Views along a side of the atlas.
    views: f32,
    // Pixels along a side of a view.
    side_px: f32,
}

@group(1) @binding(0) var<uniform> atlas: Atlas;
@group(1) @binding(1) var image: texture_2d<f32>;
@group(1) @binding(2) var image_sampler: sampler;

struct Card {
    @builtin(position) clip: vec4f,
    // Column and row of the view, and which sample is covered first from afar.
    @location(0) @interpolate(flat) cell: vec3f,
    // Place in the view, (0, 0) at the upper left.
    @location(1) at: vec2f,
}

@vertex
fn corner(
    @builtin(vertex_index) i: u32,
    @builtin(instance_index) member: u32,
    @location(0) position: vec3f,
    @location(1) heading: vec3f,
) -> Card {
    let frame = frame_of(heading);
    let cell = cell_of((draw.eye - position) * frame, atlas.views);
    let axis = axis_of(cell, atlas.views);
    let flat = vec3f(axis.z, 0.0, -axis.x);
    let right = select(vec3f(1.0, 0.0, 0.0), normalize(flat), dot(flat, flat) > 0.0);
    let up = cross(axis, right);
    // Upper left, lower left, lower right, and again upper left, lower right, upper right.
    let x = select(-1.0, 1.0, i == 2u || i >= 4u);
    let y = select(-1.0, 1.0, i == 0u || i == 3u || i == 5u);
    let place = position + frame * (right * x + up * y) * atlas.half_width;
    let clip = draw.clip_from_local * vec4f(place, 1.0);
    return Card(clip, vec3f(cell, f32(member & 3u)), vec2f(0.5 + 0.5 * x, 0.5 - 0.5 * y));
}

struct Covered {
    @location(0) color: vec4f,
    @builtin(sample_mask) samples: u32,
}

// Places of four samples within a pixel, as Vulkan, Metal and Direct3D have them.
const PLACES = array(
    vec2f(-0.125, -0.375),
    vec2f(0.375, -0.125),
    vec2f(-0.375, 0.125),
    vec2f(0.125, 0.375),
);

// Every sample takes its own quarter of the pixel and is covered where the view is at least half
// opaque, as a surface would cover it; so nothing needs to be sorted. Where a view has but a few
// texels, which are nowhere half opaque, as many samples are covered as it is opaque.
@fragment
fn card(in: Card) -> Covered {
    let dx = dpdx(in.at);
    let dy = dpdy(in.at);
    let share = select(1.0, 0.5, SAMPLES == 4u);
    let footprint = max(length(dx), length(dy)) * share * atlas.side_px;
    let level = clamp(log2(footprint), 0.0, log2(atlas.side_px));
    // Half a texel of the coarser of two mipmaps, so that filters keep within the view.
    let rim = 0.5 * exp2(ceil(level)) / atlas.side_px;
    let few = clamp(level - log2(atlas.side_px) + 3.0, 0.0, 1.0);
    var sum = vec4f(0.0);
    var mask = 0u;
    for (var i = 0u; i < SAMPLES; i++) {
        let place = select(vec2f(0.0), PLACES[i & 3u], SAMPLES == 4u);
        let at = clamp(in.at + place.x * dx + place.y * dy, vec2f(rim), vec2f(1.0 - rim));
        let texel = textureSampleLevel(image, image_sampler, (in.cell.xy + at) / atlas.views, level);
        sum += vec4f(texel.rgb * texel.a, texel.a);
        let order = f32((i + u32(in.cell.z)) % SAMPLES);
        let least = mix(0.5, (order + 0.5) / f32(SAMPLES), few);
        mask |= select(0u, 1u << i, texel.a >= least);
    }
    if mask == 0u {
        discard;
    }
    return Covered(vec4f(draw.tint * sum.rgb / max(sum.a, 1e-6), 1.0), mask);
}
