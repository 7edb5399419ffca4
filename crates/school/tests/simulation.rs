//! Schools that look like schools, and that never break, whatever they are given.

use std::sync::Arc;

use glam::Vec3;
use meshlod::flock::Flock;
use meshlod::samples;
use meshlod_school::simulation::*;
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

fn warm(options: &SimulationOptions, seconds: f64) -> Simulation {
    let mut simulation = Simulation::new(options).unwrap();
    simulation.advance(seconds).unwrap();
    simulation
}

fn positions(flock: &Flock) -> Vec<Vec3> {
    (0..flock.members.len()).map(|i| flock.members.position(i)).collect()
}

/// Least distance of a member from an obstacle.
fn least_distance(simulation: &Simulation, flock: &Flock) -> f32 {
    let obstacles = &simulation.options().obstacles;
    let to = |&at: &Vec3| obstacles.iter().map(move |obstacle| obstacle.distance(at).distance);
    positions(flock).iter().flat_map(to).fold(f32::MAX, f32::min)
}

/// Checks what must hold at every moment.
fn check(simulation: &Simulation, flock: &Flock) {
    assert_eq!(flock.members.len(), simulation.len());
    for i in 0..flock.members.len() {
        let (position, heading) = (flock.members.position(i), flock.members.heading(i));
        assert!(position.is_finite(), "member {i} is at {position}");
        assert!((heading.length() - 1.0).abs() < 1e-4, "member {i} heads along {heading}");
    }
    for school in &flock.schools {
        assert!(school.leader.is_finite() && (school.heading.length() - 1.0).abs() < 1e-4);
    }
    assert!(least_distance(simulation, flock) >= 0.0, "a member is inside an obstacle");
}

#[test]
fn members_on_a_straight_leg_are_aligned_and_evenly_spaced() {
    for members in [150, 2000] {
        let schools = vec![straight(members)];
        let simulation = warm(&SimulationOptions { schools, ..Default::default() }, 15.0);
        let order = order(&flock_of(&simulation));
        assert!(order.polarisation > 0.99, "{order:?}");
        let [mean, least, low] = order.nearest;
        assert!((1.1..1.3).contains(&mean) && low > 0.9 && least > 0.7, "{order:?}");
        assert!(order.unevenness < 0.12, "{order:?}");
        // As in a full ellipsoid, whose mean square is 3/5.
        assert!(order.within == 1.0 && (0.7..0.95).contains(&order.spread), "{order:?}");
    }
}

#[test]
fn the_school_follows_its_leader_through_turns_without_jitter() {
    let mut simulation = warm(&SimulationOptions::default(), 5.0);
    let (mut before, mut flock) = (flock_of(&simulation), Flock::default());
    for _ in 0..1200 {
        simulation.step();
        simulation.snapshot(1.0, &mut flock);
        let turn = |i: usize| before.members.heading(i).angle_between(flock.members.heading(i));
        let turns = (0..150).map(turn);
        let (sum, most) =
            turns.fold((0.0, 0.0_f32), |(sum, most), turn| (sum + turn, turn.max(most)));
        // The leader turns by 0.0012 a step.
        assert!(sum / 150.0 < 0.008 && most < 0.05, "{} {most}", sum / 150.0);
        std::mem::swap(&mut before, &mut flock);
    }
    let order = order(&before);
    assert!(order.polarisation > 0.97 && order.within == 1.0, "{order:?}");
}

#[test]
fn a_ball_parts_the_school_and_it_closes_again() {
    let center = Vec3::Z * 40.0;
    let options = SimulationOptions {
        schools: vec![straight(300)],
        obstacles: vec![Obstacle::Sphere { center, radius: 5.0 }],
        ..Default::default()
    };
    let mut simulation = warm(&options, 10.0);
    let place = |flock: &Flock, i| flock.members.position(i) - flock.schools[0].leader;
    let first = flock_of(&simulation);
    let away = |flock: &Flock| {
        (0..300).map(|i| place(flock, i).distance(place(&first, i))).sum::<f32>() / 300.0
    };
    let (mut farthest, mut closest, mut most_sides) = (0.0_f32, f32::MAX, [0; 4]);
    let mut flock = Flock::default();
    for _ in 0..1500 {
        simulation.step();
        for alpha in [0.5, 1.0] {
            simulation.snapshot(alpha, &mut flock);
            check(&simulation, &flock);
        }
        farthest = farthest.max(away(&flock));
        closest = closest.min(order(&flock).nearest[1]);
        // Members beside the ball, by the quarter in which they pass it.
        let mut sides = [0; 4];
        for at in positions(&flock).into_iter().filter(|at| (at.z - center.z).abs() < 2.0) {
            sides[usize::from(at.x > 0.0) + 2 * usize::from(at.y > 0.0)] += 1;
        }
        most_sides = std::array::from_fn(|k| most_sides[k].max(sides[k]));
    }
    let end = order(&flock);
    let back = away(&flock);
    println!(
        "from their places: {farthest} at most, {back} at the end, {most_sides:?} {closest} {end:?}"
    );
    assert!(
        farthest > 1.5 && most_sides.iter().all(|&side| side > 15),
        "{farthest} {most_sides:?}"
    );
    assert!(closest > 0.3, "{closest}");
    assert!(back < 0.6 && end.polarisation > 0.99 && end.within == 1.0, "{back} {end:?}");
}

#[test]
fn nobody_swims_into_a_terrain_or_a_mesh() {
    // Coordinates of the samples are of the order of one: made 40 times as large.
    let grown = |mut mesh: meshlod::mesh::Mesh| {
        let bounds = mesh.bounds();
        let widest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        let center = bounds.center();
        for at in &mut mesh.positions {
            *at = std::array::from_fn(|k| (at[k] - center[k]) * 40.0 / widest);
        }
        mesh
    };
    for mesh in [samples::terrain(2000), samples::knot(4000)] {
        let field = Arc::new(DistanceField::new(&grown(mesh), 48).unwrap());
        let leader = Leader::Line { from: Vec3::new(-30.0, 0.0, 1.0), direction: Vec3::X };
        let options = SimulationOptions {
            schools: vec![SchoolOptions { leader, ..SchoolOptions::of(200) }],
            obstacles: vec![Obstacle::Solid(field)],
            ..Default::default()
        };
        let mut simulation = Simulation::new(&options).unwrap();
        let mut flock = Flock::default();
        for _ in 0..1200 {
            simulation.step();
            simulation.snapshot(0.5, &mut flock);
            check(&simulation, &flock);
        }
    }
}

/// Returns options with everything in them: two schools that meet, and obstacles on the way.
fn rich() -> SimulationOptions {
    let across = Leader::Line { from: Vec3::new(-30.0, 0.0, 30.0), direction: Vec3::X };
    let capsule = [Vec3::new(2.0, -9.0, 20.0), Vec3::new(2.0, 9.0, 20.0)];
    SimulationOptions {
        schools: vec![straight(3000), SchoolOptions { leader: across, ..SchoolOptions::of(2000) }],
        obstacles: vec![Obstacle::Capsule { ends: capsule, radius: 2.0 }],
        steer_every: Some(SteerEvery { eye: Vec3::ZERO, distances: [10.0, 20.0, 30.0] }),
        ..Default::default()
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let simulation = warm(&rich(), 4.0);
            (flock_of(&simulation), simulation.looks())
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(5));
}

#[test]
fn looking_less_often_changes_little() {
    let ball = Obstacle::Sphere { center: Vec3::Z * 30.0, radius: 6.0 };
    let open = [(1, 0.01), (2, 0.02), (3, 0.04)].map(|(level, bound)| (level, bound, vec![]));
    let parted = [(1, 1.0), (2, 1.0), (3, 1.0)].map(|(level, b)| (level, b, vec![ball.clone()]));
    for (level, bound, obstacles) in open.into_iter().chain(parted) {
        let schools = vec![straight(2000)];
        let all = SimulationOptions { schools, obstacles, ..Default::default() };
        let distances = std::array::from_fn(|k| if k < level { 0.0 } else { 1e6 });
        let steer_every = Some(SteerEvery { eye: Vec3::splat(-1e3), distances });
        let few = SimulationOptions { steer_every, ..all.clone() };
        let (all, few) = (warm(&all, 10.0), warm(&few, 10.0));
        let share = few.looks().members as f64 / 2000.0;
        assert!((share - 0.5_f64.powi(level as i32)).abs() < 0.01, "{share}");
        let [all, few] = [&all, &few].map(|s| positions(&flock_of(s)));
        let squared: f32 = all.iter().zip(&few).map(|(a, b)| a.distance_squared(*b)).sum();
        let rms = (squared / 2000.0).sqrt();
        println!("every {}th step: {rms} body lengths after 10 s", 1 << level);
        assert!(rms < bound, "{rms}");
    }
}

#[test]
fn a_snapshot_is_between_the_steps_and_allocates_once() {
    let mut simulation = warm(&rich(), 1.0);
    let mut flock = flock_of(&simulation);
    let [before, at] = [positions(&flock), {
        simulation.step();
        positions(&flock_of(&simulation))
    }];
    let address = flock.members.position[0].as_ptr();
    simulation.snapshot(0.25, &mut flock);
    assert_eq!(address, flock.members.position[0].as_ptr());
    for ((from, to), middle) in before.iter().zip(&at).zip(positions(&flock)) {
        assert!(middle.distance(from.lerp(*to, 0.25)) < 1e-4);
    }
    assert_eq!(
        (flock.schools[0].members.clone(), flock.schools[1].members.clone()),
        (0..3000, 3000..5000)
    );
    simulation.snapshot(f32::NAN, &mut flock);
    assert_eq!(positions(&flock), at);
}

#[test]
fn time_is_made_of_steps() {
    let mut simulation = Simulation::new(&SimulationOptions::default()).unwrap();
    let steps: usize = (0..100).map(|_| simulation.advance(0.01).unwrap()).sum();
    assert!(steps == 60 && (simulation.time_s() - 1.0).abs() < 1e-5);
    assert_eq!(simulation.advance(0.01), Ok(0));
    assert!((simulation.alpha() - 0.6).abs() < 0.01, "{}", simulation.alpha());
    for time in [-1.0, f64::NAN, 1e9] {
        assert!(matches!(simulation.advance(time), Err(SimulationError::Time(_))));
    }
}

#[test]
fn a_slot_does_not_depend_on_the_number_of_members() {
    let with = |members| {
        let school = SchoolOptions { members, ..straight(100) };
        let options = SimulationOptions { schools: vec![school], ..Default::default() };
        positions(&flock_of(&Simulation::new(&options).unwrap()))
    };
    assert_eq!(with(40), with(90)[..40]);
}

#[test]
fn degenerate_schools_and_obstacles_hold() {
    let with = |members, radii, obstacles: &[Obstacle]| {
        let school = SchoolOptions { radii, ..straight(members) };
        let schools = vec![school.clone(), school];
        let obstacles = obstacles.to_vec();
        let mut simulation =
            Simulation::new(&SimulationOptions { schools, obstacles, ..Default::default() })
                .unwrap();
        let mut flock = Flock::default();
        for _ in 0..240 {
            simulation.snapshot(0.5, &mut flock);
            check(&simulation, &flock);
            simulation.step();
        }
    };
    let ball = |z: f32, radius| Obstacle::Sphere { center: Vec3::Z * z, radius };
    let around_the_leader = [ball(0.0, 6.0), ball(5.0, 4.0), ball(-5.0, 4.0)];
    for members in [0, 1, 2, 400] {
        for radii in [Vec3::ZERO, Vec3::splat(3.0), Vec3::splat(1e6), Vec3::new(0.0, 1e5, 2.0)] {
            with(members, radii, &[]);
            with(members, radii, &around_the_leader);
        }
    }
    let empty = SimulationOptions { schools: Vec::new(), ..Default::default() };
    check(&warm(&empty, 1.0), &flock_of(&warm(&empty, 1.0)));
}

#[test]
fn options_out_of_range_are_refused() {
    type Change = fn(&mut SimulationOptions);
    let refused: [Change; 14] = [
        |o| o.step_s = f32::NAN,
        |o| o.step_s = 10.0,
        |o| o.step_s = 0.0,
        |o| o.behaviour.max_speed = f32::INFINITY,
        |o| o.behaviour.min_speed = 0.0,
        |o| o.behaviour.cohesion = f32::NAN,
        |o| o.behaviour.separation_radius = 9.0,
        |o| o.schools[0].radii.y = -1.0,
        |o| o.schools[0].speed = 100.0,
        |o| o.schools[0].leader = Leader::Line { from: Vec3::ZERO, direction: Vec3::ZERO },
        |o| o.obstacles = vec![Obstacle::Sphere { center: Vec3::X * f32::NAN, radius: 1.0 }],
        |o| {
            o.schools[0].leader =
                Leader::Line { from: Vec3::new(0.0, f32::NAN, 1.0), direction: Vec3::X }
        },
        |o| {
            let eye = Vec3::new(f32::NAN, 0.0, 1.0);
            o.steer_every = Some(SteerEvery { eye, distances: [1.0; 3] });
        },
        |o| o.steer_every = Some(SteerEvery { eye: Vec3::ZERO, distances: [2.0, 1.0, 3.0] }),
    ];
    for (i, change) in refused.iter().enumerate() {
        let mut options = SimulationOptions::default();
        change(&mut options);
        assert!(Simulation::new(&options).is_err(), "change {i}");
    }
    let mut options = SimulationOptions { step_s: 0.2, ..Default::default() };
    assert!(matches!(Simulation::new(&options), Err(SimulationError::StepTooLong { .. })));
    options.schools[0].members = usize::MAX;
    options.step_s = 0.01;
    assert_eq!(Simulation::new(&options).err(), Some(SimulationError::TooManyMembers(usize::MAX)));
}

fn any_point(most: f32) -> impl Strategy<Value = Vec3> {
    [-most..most, -most..most, -most..most].prop_map(Vec3::from)
}

fn any_obstacle() -> impl Strategy<Value = Obstacle> {
    prop_oneof![
        (any_point(12.0), 0.1_f32..9.0)
            .prop_map(|(center, radius)| Obstacle::Sphere { center, radius }),
        ([any_point(12.0), any_point(12.0)], 0.05_f32..4.0)
            .prop_map(|(ends, radius)| Obstacle::Capsule { ends, radius }),
    ]
}

prop_compose! {
    fn any_options()(
        members in 0_usize..200,
        seed in any::<u64>(),
        step_s in 0.002_f32..0.05,
        radii in [0.0_f32..9.0, 0.0_f32..9.0, 0.0_f32..9.0],
        weights in [0.0_f32..20.0, 0.0_f32..3.0, 0.0_f32..3.0, 0.0_f32..9.0],
        radius in 1.0_f32..5.0,
        turn_rad_s in 0.0_f32..300.0,
        waypoints in prop::collection::vec(any_point(20.0), 3..6),
        obstacles in prop::collection::vec(any_obstacle(), 0..5),
        near in 0.0_f32..20.0,
    ) -> SimulationOptions {
        let [separation, alignment, cohesion, keeping] = weights;
        let behaviour = Behaviour {
            separation, alignment, cohesion, keeping, turn_rad_s,
            neighbour_radius: radius, separation_radius: 0.7 * radius,
            ..Behaviour::default()
        };
        let leader = Leader::Path(LeaderPath::through(&waypoints).unwrap());
        let school = SchoolOptions { members, radii: radii.into(), leader, speed: 2.0 };
        let distances = [near, 2.0 * near, 3.0 * near];
        SimulationOptions {
            schools: vec![school.clone(), school],
            obstacles, seed, step_s, behaviour,
            steer_every: Some(SteerEvery { eye: Vec3::ZERO, distances }),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..Default::default() })]
    #[test]
    fn never_a_nan_nor_inside_an_obstacle_and_headings_are_unit(options in any_options()) {
        let mut simulation = Simulation::new(&options).unwrap();
        let mut flock = Flock::default();
        for step in 0..150 {
            simulation.snapshot((step % 4) as f32 * 0.25, &mut flock);
            check(&simulation, &flock);
            simulation.step();
        }
    }
}
