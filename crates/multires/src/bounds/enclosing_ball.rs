//! Balls, and the smallest around others.

use glam::DVec3;

/// A ball that holds the points of the finest mesh that are paired with a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EnclosingBall {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl EnclosingBall {
    /// Of a point of the finest mesh: itself.
    pub(super) fn point(point: DVec3) -> Self {
        Self { center: point, radius: 0.0 }
    }

    /// How far anything in it can be from a point.
    pub(super) fn reach(&self, from: DVec3) -> f64 {
        self.center.distance(from) + self.radius
    }
}

/// How often the ball around others is made smaller. Faces of the bunny's and the horse's cut to 1 % of
/// the diagonal for 8, 16 and 32: 2553, 2501, 2443 and 2434, 2132, 2082; 32 takes half as long again.
const STEPS: usize = 16;

/// A small ball that holds all these: none is much smaller. Radii may be negative; then the ball's
/// surface may pass nearer to their centers by so much.
///
/// # References
/// [BC03]: from step to step a shorter way to the one that is farthest.
pub(super) fn enclosing_ball(balls: &[EnclosingBall]) -> EnclosingBall {
    let mut center = balls.iter().map(|ball| ball.center).sum::<DVec3>() / balls.len() as f64;
    let mut best = EnclosingBall { center, radius: f64::INFINITY };
    for step in 1..=STEPS {
        let by_reach = |ball: &EnclosingBall| (ball.reach(center), ball.center);
        let reaches = balls.iter().map(by_reach);
        let farther = |a: (f64, DVec3), b: (f64, DVec3)| if b.0 > a.0 { b } else { a };
        let (radius, farthest) = reaches.fold((0.0, center), farther);
        if radius < best.radius {
            best = EnclosingBall { center, radius };
        }
        let way = farthest - center;
        let share = radius / (way.length() * (step as f64 + 1.0));
        if !share.is_finite() {
            break;
        }
        center += way * share.min(1.0);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_balls_are_held_and_the_ball_is_small() {
        let ball =
            |x: f64, y: f64, radius: f64| EnclosingBall { center: DVec3::new(x, y, 0.0), radius };
        let apart = [ball(-1.0, 0.0, 0.5), ball(3.0, 0.0, 0.0), ball(0.0, 1.0, -0.5)];
        let around = enclosing_ball(&apart);
        for one in &apart {
            assert!(one.reach(around.center) <= around.radius * (1.0 + 1e-15));
        }
        assert!((2.25..2.4).contains(&around.radius), "{around:?}");
        assert_eq!(enclosing_ball(&[ball(2.0, 1.0, 0.25)]), ball(2.0, 1.0, 0.25));
        let inside = [ball(0.0, 0.0, 2.0), ball(0.5, 0.0, 0.1)];
        assert!(enclosing_ball(&inside).radius < 2.1, "{:?}", enclosing_ball(&inside));
    }
}
