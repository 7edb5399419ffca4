//! School as a window shows it: policies, split pictures, obstacles that move, and figures.

mod common;
#[path = "common/school.rs"]
mod school;

use common::{difference, gpu};
use glam::Vec3;
use meshlod::flock::select::{Budget, PolicyName};
use meshlod::picture::Picture;
use meshlod_school::scene::{Scenario, ScenarioName, ScenarioOptions};
use meshlod_view::{Canvas, Renderer, SchoolShow, TargetFormat};
use school::SampleSchool;

const SIZE: [u32; 2] = [320, 180];

#[test]
fn a_school_is_shown_with_levels_beside_full_detail() {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, impostor } = SampleSchool::new(1_000, 4);
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let options = ScenarioOptions { members: 60, size: SIZE, ..ScenarioOptions::default() };
    let scenario = Scenario::named(ScenarioName::Obstacles, &options).unwrap();
    let mut show = SchoolShow::new(&renderer, scenario, &table, &look, Some(&impostor)).unwrap();
    let picture = |show: &mut SchoolShow| -> Picture {
        show.advance().unwrap();
        let canvas = Canvas::new(gpu, SIZE).unwrap();
        canvas.draw(|pass| show.draw(&renderer, pass));
        canvas.read().unwrap()
    };
    show.set_policy(PolicyName::ScreenError);
    show.budget = Budget { detail: 0.3, ..Budget::default() };
    let with_levels = picture(&mut show);
    show.is_paused = true;
    show.split = Some(0.5);
    let split = picture(&mut show);
    show.set_policy(PolicyName::None);
    let in_full = picture(&mut show);
    let half = |a: &Picture, b: &Picture, columns: std::ops::Range<u32>| {
        let differs = |&(x, y): &(u32, u32)| a.pixel(x, y) != b.pixel(x, y);
        (0..SIZE[1]).flat_map(|y| columns.clone().map(move |x| (x, y))).filter(differs).count()
    };
    // Drivers differ in the samples that a scissor cuts at its rim.
    let middle = SIZE[0] / 2;
    assert_eq!(half(&split, &with_levels, 0..middle - 2), 0, "levels on the left");
    assert_eq!(half(&split, &in_full, middle + 2..SIZE[0]), 0, "full detail on the right");
    assert!(half(&split, &with_levels, middle..SIZE[0]) > 100);

    let frames: Vec<_> = show.history().frames().copied().collect();
    assert!(frames[0].triangles * 4 < frames[0].full_triangles);
    assert_eq!(frames[2].triangles, frames[2].full_triangles);
    assert!(frames[2].agreement > 0.5 && (0.5..2.0).contains(&frames[2].relative_speed));

    let far = Vec3::new(0.0, 1_000.0, 0.0);
    for obstacle in 0..show.scenario().obstacles.len() {
        show.move_obstacle(obstacle, far).unwrap();
    }
    assert!(difference(&picture(&mut show), &in_full, 24).0 > 0.01, "the obstacles have gone");
    assert!(show.move_obstacle(1_000, far).is_err());

    show.is_paused = false;
    show.resize([200, 300]);
    show.advance().unwrap();
    assert_eq!(show.frame().unwrap().1.size(), [200, 300]);
}
