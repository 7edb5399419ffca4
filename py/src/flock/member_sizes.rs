//! Members of different sizes in one picture.

use meshlod::flock::Members;
use meshlod::flock::draw::FrameMesh;
use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::InstanceLevel;

/// Replaces impostors of members that are not one body length long by their coarsest level: all
/// impostors have one size.
pub fn replace_impostors(levels: &mut [InstanceLevel], scales: &[f32], table: &LevelTable) {
    let coarsest = InstanceLevel::drawn(table.chains[0].levels.end - 1);
    for (level, &scale) in levels.iter_mut().zip(scales) {
        if level.is_impostor() && scale != 1.0 {
            *level = coarsest;
        }
    }
}

/// Gives the members in a frame their sizes: `scales` has the length of each in body lengths.
pub fn give_sizes(frame: &mut FrameMesh, members: &Members, scales: &[f32]) {
    let ends = frame.members.iter().skip(1).map(|&(first, _)| first as usize);
    for (&(first, member), end) in frame.members.iter().zip(ends.chain([frame.member_faces])) {
        let (member, scale) = (member as usize, f64::from(scales[member as usize]));
        let corners = frame.mesh.faces[first as usize..end].as_flattened();
        // Members have vertices of their own, one after the other.
        let used = corners.iter().map(|v| v.index());
        let Some((least, most)) = used.clone().min().zip(used.max()) else { continue };
        let middle = members.position(member).as_dvec3().to_array();
        for position in &mut frame.mesh.positions[least..=most] {
            for (x, middle) in position.iter_mut().zip(middle) {
                *x = middle + (*x - middle) * scale;
            }
        }
    }
}
