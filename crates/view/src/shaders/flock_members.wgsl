// Members of a flock, each with its level. Follows draw.wgsl, mesh.wgsl and flock.wgsl.

struct Swimmer {
    @builtin(position) clip: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) color: vec3f,
}

@vertex
fn member(
    @location(0) position: vec3f,
    @location(1) normal: vec4f,
    @location(2) color: vec4f,
    @location(3) uv: vec2f,
    @location(4) at: vec3f,
    @location(5) heading: vec3f,
) -> Swimmer {
    let frame = frame_of(heading);
    let place = at + frame * position;
    let clip = draw.clip_from_local * vec4f(place, 1.0);
    return Swimmer(clip, place, frame * normal.xyz, uv, color.rgb);
}

// Shorter than `shaded`: levels always have normals, and no lines along their edges.
@fragment
fn swimming(in: Swimmer, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let to_eye = normalize(draw.eye - in.place);
    let normal = normalize(select(-in.normal, in.normal, front));
    var color = material.base_color.rgb * draw.tint;
    if material.has_texture != 0u {
        color *= textureSample(image, image_sampler, vec2f(in.uv.x, 1.0 - in.uv.y)).rgb;
    } else {
        color *= decode_srgb(in.color);
    }
    return vec4f(lit(color, normal, to_eye), 1.0);
}
