//! Impostors for members that are small on the screen, whatever the policy.

use crate::select::{InstanceLevel, View};

/// Turns small members into impostors after the policy has chosen their levels.
#[derive(Default)]
pub(super) struct ImpostorTier {
    /// Whether each member was an impostor in the frame before.
    were: Vec<bool>,
}

/// Factor by which an impostor must be larger than the limit before it gets a level again.
const HYSTERESIS: f32 = 1.1;

impl ImpostorTier {
    /// Applies [`Budget::impostors_below_px`](crate::select::Budget::impostors_below_px) to members
    /// that are drawn.
    pub(super) fn apply(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        let below_px = view.budget.impostors_below_px.filter(|px| *px > 0.0);
        let Some(below_px) = below_px else {
            self.were.clear();
            return;
        };
        self.were.resize(levels.len(), false);
        let beyond = |px: f32| (view.camera.pixels_at_one() / px).powi(2);
        let (becomes, stays) = (beyond(below_px), beyond(below_px * HYSTERESIS));
        let were = &self.were;
        view.assign(levels, |first, lanes, chosen| {
            for (lane, level) in chosen.iter_mut().enumerate() {
                // The last eight of a flock may be fewer.
                let was = were.get(first + lane).copied().unwrap_or(false);
                let is_far = lanes.distance_squared[lane] > if was { stays } else { becomes };
                if is_far && *level != InstanceLevel::HIDDEN {
                    *level = InstanceLevel::IMPOSTOR;
                }
            }
        });
        for (was, level) in self.were.iter_mut().zip(levels) {
            *was = level.is_impostor();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::camera::FlockCamera;
    use crate::flock::Flock;
    use crate::levels::{ChainOptions, LevelTable, Look};
    use crate::select::{Budget, InstanceLevel, PolicyName, Selector};

    fn table() -> Arc<LevelTable> {
        let options = ChainOptions { directions: 2, step: 0.2, ..ChainOptions::default() };
        let ball = meshlod_samples::sphere(300);
        Arc::new(LevelTable::new(&ball, &Look::default(), &options).unwrap())
    }

    /// Camera that sees a body length at this distance from the origin as 1000 / distance pixels.
    fn camera(distance: f32) -> FlockCamera {
        let fov = 2.0 * 0.05f32.atan();
        FlockCamera::look_at([0.0, 0.0, distance], [0.0; 3], fov, [100, 100]).unwrap()
    }

    #[test]
    fn small_members_are_impostors_with_any_policy() {
        let table = table();
        let mut flock = Flock::default();
        flock.members.push([0.0; 3], [0.0, 0.0, 1.0]);
        flock.members.push([0.0, 0.0, -100.0], [0.0, 0.0, 1.0]);
        flock.members.push([500.0, 0.0, -100.0], [0.0, 0.0, 1.0]);
        let budget = Budget { impostors_below_px: Some(8.0), ..Budget::default() };
        for policy in PolicyName::ALL {
            let mut selector = Selector::new(policy, table.clone());
            let levels = selector.select(&flock, &camera(100.0), &budget).to_vec();
            let name = policy.name();
            assert!(levels[0].level().is_some() && levels[1].is_impostor(), "{name}");
            assert_eq!(levels[2], InstanceLevel::HIDDEN, "{name}");
            let near = levels[0].triangles(&table);
            assert_eq!(selector.triangles(), near + 2, "{name}");
            let visible = [true, false, true];
            let seen =
                selector.select_visible(&flock, &camera(100.0), &budget, Some(&visible)).to_vec();
            assert_eq!(seen[1], InstanceLevel::HIDDEN, "{name}");
            let never = selector.select(&flock, &camera(100.0), &Budget::default());
            assert!(never[1].level().is_some(), "{name}");
        }
    }

    #[test]
    fn an_impostor_stays_one_until_it_is_a_tenth_larger() {
        let mut selector = Selector::new(PolicyName::Distance, table());
        let mut flock = Flock::default();
        flock.members.push([0.0; 3], [0.0, 0.0, 1.0]);
        let budget = Budget { impostors_below_px: Some(10.0), ..Budget::default() };
        let mut is_impostor =
            |px: f32| selector.select(&flock, &camera(1000.0 / px), &budget)[0].is_impostor();
        let found = [10.5, 9.9, 10.5, 11.1, 10.5].map(&mut is_impostor);
        assert_eq!(found, [false, true, true, false, false]);
    }

    #[test]
    fn odd_limits_mean_never() {
        let mut selector = Selector::new(PolicyName::Ours, table());
        let mut flock = Flock::default();
        flock.members.push([f32::NAN; 3], [0.0, 0.0, 1.0]);
        flock.members.push([0.0; 3], [0.0, 0.0, 1.0]);
        for px in [f32::NAN, 0.0, -1.0, f32::NEG_INFINITY] {
            let budget = Budget { impostors_below_px: Some(px), ..Budget::default() };
            let levels = selector.select(&flock, &camera(1e6), &budget);
            assert!(levels.iter().all(|level| !level.is_impostor()), "{px}");
        }
    }
}
