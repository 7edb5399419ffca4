//! A choice of levels allocates nothing once the flock has its size.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use meshlod_flock::levels::{ChainOptions, LevelTable, Look};
use meshlod_flock::select::{Budget, PolicyName, Selector};
use meshlod_flock::{Flock, FlockCamera};

/// Allocator that counts.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn choosing_levels_allocates_nothing() {
    let options = ChainOptions { directions: 2, ..ChainOptions::default() };
    let sphere = meshlod_samples::sphere(500);
    let table = Arc::new(LevelTable::new(&sphere, &Look::default(), &options).unwrap());
    let mut flock = Flock::default();
    for i in 0..500 {
        flock.members.push([(i % 20) as f32, (i / 20) as f32, 0.0], [0.0, 0.0, 1.0]);
    }
    let camera =
        FlockCamera::look_at([10.0, 12.0, 40.0], [10.0, 12.0, 0.0], 0.8, [640, 360]).unwrap();
    let budget = Budget { triangles: 30_000, detail: 1.0, ..Budget::default() };
    // A pool of one thread runs tasks where they are, without a queue.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        for policy in PolicyName::ALL {
            let mut selector = Selector::new(policy, table.clone());
            selector.select(&flock, &camera, &budget);
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            for _ in 0..3 {
                selector.select(&flock, &camera, &budget);
            }
            assert_eq!(ALLOCATIONS.load(Ordering::Relaxed), before, "{policy:?}");
        }
    });
}
