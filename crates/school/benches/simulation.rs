//! Steps of schools of 1,000 to 1,000,000 members, each looking at its neighbours in every step. Run
//! as a test, small schools alone.
//!
//! A table of members per millisecond and mean neighbours goes to stderr. Set `RAYON_NUM_THREADS`
//! to 1 for the figures of one thread; CPU time is that of all threads, where Linux tells it.

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use meshlod::flock::Flock;
use meshlod_school::simulation::{
    Obstacle, SchoolOptions, Simulation, SimulationOptions, SteerEvery,
};

/// Numbers of members.
const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Number of these sizes that are run as a test.
const TESTED: usize = 2;
/// Steps before measuring, in which members spread out evenly.
const WARM_UP: usize = 60;

/// Returns a default school; in a small one, where most members are at the border, they see farther
/// so that they have 20 neighbours, too.
fn school(members: usize) -> SimulationOptions {
    let mut options =
        SimulationOptions { schools: vec![SchoolOptions::of(members)], ..Default::default() };
    if members <= 1_000 {
        options.behaviour.neighbour_radius = 2.5;
    }
    options
}

fn warm(options: &SimulationOptions) -> Simulation {
    let mut simulation = Simulation::new(options).unwrap();
    (0..WARM_UP).for_each(|_| simulation.step());
    simulation
}

/// Returns user and system time of all threads of this process, where Linux tells it.
fn cpu_time() -> Option<Duration> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks: u64 = fields.get(11)?.parse::<u64>().ok()? + fields.get(12)?.parse::<u64>().ok()?;
    Some(Duration::from_millis(10 * ticks))
}

/// Prints wall and CPU time of steps, for about a second.
fn report(name: &str, simulation: &mut Simulation) {
    let (begin, cpu) = (Instant::now(), cpu_time());
    let (mut steps, mut members, mut neighbours) = (0_u64, 0, 0);
    while begin.elapsed() < Duration::from_millis(1500) || steps < 8 {
        simulation.step();
        steps += 1;
        let looks = simulation.looks();
        members += looks.members;
        neighbours += looks.neighbours;
    }
    let moved = (steps * simulation.len() as u64) as f64;
    let wall_ms = begin.elapsed().as_secs_f64() * 1e3;
    let cpu_ns = cpu.zip(cpu_time()).map(|(a, b)| (b - a).as_secs_f64() * 1e9 / moved);
    eprintln!(
        "{name:>32}: {:8.0} members/ms, {:6.0} ns of CPU a member, {:5.1} neighbours, {:5.1} % looked",
        moved / wall_ms,
        cpu_ns.unwrap_or(f64::NAN),
        neighbours as f64 / members as f64,
        100.0 * members as f64 / moved,
    );
}

fn tables() {
    for size in SIZES {
        report(&format!("{size} members"), &mut warm(&school(size)));
    }
    let mut options = school(100_000);
    let center = Vec3::new(250.0, 0.0, 0.0);
    options.obstacles = vec![Obstacle::Sphere { center, radius: 30.0 }];
    report("100000, an obstacle amid them", &mut warm(&options));
    for (k, distances) in [(2, [0.0, 1e6, 1e6]), (4, [0.0, 0.0, 1e6]), (8, [0.0; 3])] {
        let mut options = school(100_000);
        options.steer_every = Some(SteerEvery { eye: Vec3::ZERO, distances });
        report(&format!("100000, every {k}th step"), &mut warm(&options));
    }
}

fn steps(criterion: &mut Criterion) {
    let is_measured = std::env::args().any(|argument| argument == "--bench");
    let sizes = if is_measured { &SIZES[..] } else { &SIZES[..TESTED] };
    if is_measured {
        tables();
    }
    let mut group = criterion.benchmark_group("step");
    group.sample_size(10);
    for &size in sizes {
        let mut simulation = warm(&school(size));
        group.throughput(Throughput::Elements(size as u64));
        group.bench_function(BenchmarkId::from_parameter(size), |b| b.iter(|| simulation.step()));
    }
    group.finish();
    let mut group = criterion.benchmark_group("snapshot");
    group.sample_size(10);
    let size = sizes[sizes.len() - 1].min(100_000);
    let (simulation, mut flock) = (warm(&school(size)), Flock::default());
    group.throughput(Throughput::Elements(size as u64));
    group.bench_function(BenchmarkId::from_parameter(size), |b| {
        b.iter(|| simulation.snapshot(0.5, &mut flock))
    });
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
