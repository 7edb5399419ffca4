//! Schools that look like schools, and that never break, whatever they are given.

use std::sync::Arc;

use glam::Vec3;
use meshlod_flock::Flock;
use meshlod_flock::simulation::*;
use meshlod_samples as samples;
use proptest::prelude::*;

/// Order parameters of the first school of a flock.
#[derive(Debug)]
struct Order {
    /// Mean over members of the heading's dot product with the mean heading.
    polarisation: f32,
    /// Mean, least and 5th percentile of the distance to the nearest neighbour.
    nearest: [f32; 3],
    /// Coefficient of variation of that distance.
    unevenness: f32,
    /// Share of members within 1.5 times the ellipsoid.
    within: f32,
    /// Root mean square of the distance from the leader in units of the ellipsoid.
    spread: f32,
}

fn order(flock: &Flock) -> Order {
    let (members, school) = (&flock.members, &flock.schools[0]);
    let range = school.members.clone();
    let count = range.len() as f32;
    let mean: Vec3 = range.clone().map(|i| members.heading(i)).sum::<Vec3>().normalize();
    let polarisation = range.clone().map(|i| members.heading(i).dot(mean)).sum::<f32>() / count;
    let mut nearest: Vec<f32> = range
        .clone()
        .map(|i| {
            let to = |j: usize| members.position(i).distance(members.position(j));
            range.clone().filter(|&j| j != i).map(to).fold(f32::MAX, f32::min)
        })
        .collect();
    nearest.sort_by(f32::total_cmp);
    let average = nearest.iter().sum::<f32>() / count;
    let variance = nearest.iter().map(|d| (d - average).powi(2)).sum::<f32>() / count;
    let to_ball = school.to_unit_ball();
    let ball = |i: usize| (to_ball * (members.position(i) - school.leader)).length();
    let within = range.clone().filter(|&i| ball(i) <= 1.5).count() as f32 / count;
    Order {
        polarisation,
        nearest: [average, nearest[0], nearest[nearest.len() / 20]],
        unevenness: variance.sqrt() / average,
        within,
        spread: (range.map(|i| ball(i).powi(2)).sum::<f32>() / count).sqrt(),
    }
}

fn straight(members: usize) -> SchoolOptions {
    let leader = Leader::Line { from: Vec3::ZERO, direction: Vec3::Z };
    SchoolOptions { leader, ..SchoolOptions::of(members) }
}

fn flock_of(simulation: &Simulation) -> Flock {
    let mut flock = Flock::default();
    simulation.snapshot(1.0, &mut flock);
    flock
}

#[test]
#[ignore]
fn figures() {
    for (name, school) in [
        ("line", straight(150)),
        ("ring", SchoolOptions::of(150)),
        ("line2000", straight(2000)),
        ("ring2000", SchoolOptions::of(2000)),
    ] {
        let mut simulation =
            Simulation::new(&SimulationOptions { schools: vec![school], ..Default::default() })
                .unwrap();
        println!("{name} {:?}", simulation.options().schools[0].radii);
        for seconds in [0, 1, 4, 15] {
            simulation.advance(f64::from(seconds)).unwrap();
            let looks = simulation.looks();
            println!(
                "{name} {:.0} s: {:?} neighbours {}",
                simulation.time_s(),
                order(&flock_of(&simulation)),
                looks.neighbours as f64 / looks.members as f64
            );
        }
    }
    let mut options = SimulationOptions { schools: vec![straight(300)], ..Default::default() };
    options.obstacles = vec![Obstacle::Sphere { center: Vec3::Z * 30.0, radius: 5.0 }];
    let mut simulation = Simulation::new(&options).unwrap();
    for _ in 0..30 {
        simulation.advance(1.0).unwrap();
        let flock = flock_of(&simulation);
        let least = (0..300)
            .map(|i| options.obstacles[0].distance(flock.members.position(i)).distance)
            .fold(f32::MAX, f32::min);
        println!("leader {} least {least} {:?}", flock.schools[0].leader.z, order(&flock));
    }
    let _ = (Arc::new(0), samples::sphere(10));
}

proptest! {
    #[test]
    fn one(_x in 0..1) {}
}
