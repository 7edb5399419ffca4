//! Flocks on the GPU against those of `flock`: pictures, and the choice of levels.

mod common;
#[path = "common/school.rs"]
mod school;

use std::sync::OnceLock;

use common::{difference, gpu};
use glam::Vec3;
use meshlod::Mesh;
use meshlod::flock::draw::{FlockPainter, WATER};
use meshlod::flock::levels::{ChainOptions, LevelTable, Look};
use meshlod::flock::select::{Budget, InstanceLevel, PolicyName, Selector};
use meshlod::flock::{Flock, FlockCamera};
use meshlod::picture::{Lighting, Materials, PaintMaterial, Picture};
use meshlod_school::scene::{ScenarioName, SceneObstacle};
use meshlod_view::{
    Canvas, Gpu, GpuFlock, GpuObstacles, GpuSelection, HiZ, Renderer, Shade, TargetFormat,
    ViewError,
};
use school::{SampleSchool, frame};

const SIZE: [u32; 2] = [480, 270];

fn sample() -> &'static SampleSchool {
    static SCHOOL: OnceLock<SampleSchool> = OnceLock::new();
    SCHOOL.get_or_init(|| SampleSchool::new(2_000, 6))
}

fn shade() -> Shade {
    Shade { lighting: Lighting::Headlight, ..Shade::default() }
}

/// Draws a frame of levels that were chosen on the CPU.
fn picture_of(
    renderer: &Renderer,
    drawn: &GpuFlock,
    obstacles: &[Mesh],
    camera: &FlockCamera,
) -> Picture {
    let canvas = Canvas::new(renderer.gpu(), camera.size()).unwrap();
    let obstacles = GpuObstacles::new(renderer, obstacles).unwrap();
    obstacles.set(camera, camera.size(), &shade());
    let placement = renderer.placement();
    placement.set(&camera.for_picture(), camera.size(), drawn.origin(), &shade());
    let water = renderer.backdrop(WATER).unwrap();
    canvas.draw(|pass| {
        obstacles.draw(renderer, pass);
        drawn.draw(renderer, pass, &placement);
        renderer.draw_backdrop(pass, &water);
    });
    canvas.read().unwrap()
}

fn keep(name: &str, pictures: [&Picture; 2]) {
    if let Some(folder) = std::env::var_os("MESHLOD_PICTURES") {
        let folder = std::path::PathBuf::from(folder);
        for (picture, by) in pictures.into_iter().zip(["gpu", "cpu"]) {
            std::fs::write(folder.join(format!("flock-{name}-{by}.png")), picture.png()).unwrap();
        }
    }
}

/// Returns the means of five by five pixels. Where the samples of a pixel are differs, and small fish
/// are all edges; their means agree.
fn soft(picture: &Picture) -> Picture {
    let (width, height) = (picture.width() / 5, picture.height() / 5);
    let mean = |x: u32, y: u32| {
        let block = (0..25).map(|i| picture.pixel(5 * x + i % 5, 5 * y + i / 5));
        let mut sum = [0u32; 4];
        block.for_each(|pixel| sum.iter_mut().zip(pixel).for_each(|(s, x)| *s += u32::from(x)));
        sum.map(|sum| (sum / 25) as u8)
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| mean(x, y)));
    Picture::new(width, height, pixels.flatten().collect()).unwrap()
}

/// Asserts that the GPU draws a scene as `FlockPainter` does, to a share of its soft pixels that are
/// far off and a mean difference in 255ths.
fn assert_like_painter(name: ScenarioName, impostors_below_px: Option<f32>, most: (f64, f64)) {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, impostor } = sample();
    let (flock, camera, obstacles) = frame(name, 200, SIZE, 4);
    let mut selector = Selector::new(PolicyName::Ours, table.clone());
    let budget = Budget { triangles: 60_000, impostors_below_px, ..Budget::default() };
    let levels = selector.select(&flock, &camera, &budget);
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut drawn =
        GpuFlock::new(&renderer, table, look).unwrap().with_impostor(&renderer, impostor).unwrap();
    drawn.set(&flock, levels, &camera).unwrap();
    let found = picture_of(&renderer, &drawn, &obstacles, &camera);
    let mut painter = FlockPainter::new(table, look, &obstacles);
    painter.impostor = Some(impostor.clone());
    let expected = painter.draw(&flock, levels, &camera).unwrap();
    keep(&format!("{}-{impostors_below_px:?}", name.name()), [&found, &expected]);
    let (far, mean) = difference(&soft(&found), &soft(&expected), 24);
    let impostors = levels.iter().filter(|level| level.is_impostor()).count();
    let name = name.name();
    println!("{name}, {impostors} impostors: {:.3} % far, mean {mean:.3}", 100.0 * far);
    assert_eq!(impostors > 20, impostors_below_px.is_some());
    let triangles: usize = levels.iter().map(|level| level.triangles(table)).sum();
    assert_eq!(drawn.triangles(), triangles as u64);
    assert!(far < most.0 && mean < most.1, "{name}: {far} {mean}");
}

#[test]
fn schools_look_as_the_painter_draws_them() {
    assert_like_painter(ScenarioName::Ring, None, (0.005, 2.0));
}

#[test]
fn obstacles_look_as_the_painter_draws_them() {
    assert_like_painter(ScenarioName::Obstacles, None, (0.005, 2.0));
}

#[test]
fn impostors_look_as_the_painter_draws_them() {
    // The painter blends, and the GPU cuts out at half opacity; softened, they agree.
    assert_like_painter(ScenarioName::Far, Some(40.0), (0.005, 1.0));
}

#[test]
fn impostors_of_a_pixel_do_not_vanish() {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, impostor } = sample();
    let mut flock = Flock::default();
    for i in 0..2_000 {
        let (x, y) = ((i % 50) as f32, (i / 50) as f32);
        flock.members.push([2.0 * x - 50.0, 2.0 * y - 40.0, 0.0], [1.0, 0.0, 0.0]);
    }
    let camera = FlockCamera::look_at([0.0, 0.0, 270.0], [0.0; 3], 0.5, SIZE).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let drawn = GpuFlock::new(&renderer, table, look).unwrap();
    let mut drawn = drawn.with_impostor(&renderer, impostor).unwrap();
    let mut painter = FlockPainter::new(table, look, &[]);
    painter.impostor = Some(impostor.clone());
    let levels = vec![InstanceLevel::IMPOSTOR; 2_000];
    drawn.set(&flock, &levels, &camera).unwrap();
    let found = picture_of(&renderer, &drawn, &[], &camera);
    let expected = painter.draw(&flock, &levels, &camera).unwrap();
    let water = painter.draw(&Flock::default(), &[], &camera).unwrap();
    keep("pixels", [&found, &expected]);
    let [(_, mean), (_, shown)] =
        [&expected, &water].map(|other| difference(&soft(&found), &soft(other), 24));
    println!("mean {mean:.3} of {shown:.3}");
    assert!(3.5 * mean < shown, "{mean} of {shown}");
}

#[test]
fn every_face_has_its_material() {
    let Some(gpu) = gpu() else { return };
    let mut ball = meshlod::samples::sphere(800);
    ball.attributes = None;
    let of_face = ball.faces.iter().map(|f| u32::from(ball.positions[f[0].index()][1] > 0.0));
    let names = vec!["red".into(), "blue".into()];
    ball.materials = Some(meshlod::mesh::Labels { of_face: of_face.collect(), names });
    let [red, blue] = [[0.8, 0.1, 0.1], [0.1, 0.1, 0.8]]
        .map(|base_color| PaintMaterial { base_color, texture: None });
    let materials = Materials { materials: vec![red, blue], ..Materials::default() };
    let look = Look { materials: Some(materials) };
    let options = ChainOptions { directions: 4, ..ChainOptions::default() };
    let table = LevelTable::new(&ball, &look, &options).unwrap();
    let mut flock = Flock::default();
    for i in 0..12 {
        let x = (i % 4) as f32 * 1.3 - 2.0;
        flock.members.push([x, (i / 4) as f32 * 1.2 - 1.2, 0.0], [0.0, 0.6, 0.8]);
    }
    let levels: Vec<_> = (0..12).map(|i| InstanceLevel::drawn(i % table.depth())).collect();
    let camera = FlockCamera::look_at([0.0, 0.0, 6.0], [0.0; 3], 0.7, SIZE).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut drawn = GpuFlock::new(&renderer, &table, &look).unwrap();
    drawn.set(&flock, &levels, &camera).unwrap();
    let found = picture_of(&renderer, &drawn, &[], &camera);
    let expected = FlockPainter::new(&table, &look, &[]).draw(&flock, &levels, &camera).unwrap();
    keep("materials", [&found, &expected]);
    let (far, mean) = difference(&soft(&found), &soft(&expected), 24);
    assert!(far < 0.005 && mean < 1.0, "{far} {mean}");
}

/// School, its choice on the GPU, and where both are drawn.
struct Chooser<'a> {
    gpu: &'a Gpu,
    renderer: Renderer,
    choice: GpuSelection,
    canvas: Canvas,
}

impl<'a> Chooser<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        let SampleSchool { table, look, impostor } = sample();
        let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
        let drawn = GpuFlock::new(&renderer, table, look).unwrap();
        let drawn = drawn.with_impostor(&renderer, impostor).unwrap();
        let choice = GpuSelection::new(&renderer, &drawn, table).unwrap();
        let mut canvas = Canvas::new(gpu, SIZE).unwrap();
        canvas.keeps_depth = true;
        Self { gpu, renderer, choice, canvas }
    }

    /// Chooses and draws a frame, and lets the depths be known to the next one.
    fn draw(
        &mut self,
        camera: &FlockCamera,
        budget: &Budget,
        obstacles: &[Mesh],
        depths: Option<&HiZ>,
    ) -> Picture {
        let Self { gpu, renderer, choice, canvas } = self;
        let obstacles = GpuObstacles::new(renderer, obstacles).unwrap();
        obstacles.set(camera, SIZE, &shade());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        choice.choose(&mut encoder, camera, budget, depths);
        let placement = renderer.placement();
        placement.set(&camera.for_picture(), SIZE, choice.origin(), &shade());
        let water = renderer.backdrop(WATER).unwrap();
        let mut pass = canvas.pass(&mut encoder);
        obstacles.draw(renderer, &mut pass);
        choice.draw(renderer, &mut pass, &placement);
        renderer.draw_backdrop(&mut pass, &water);
        drop(pass);
        if let Some(depths) = depths {
            depths.build(&mut encoder, canvas.depth(), camera);
        }
        gpu.queue.submit([encoder.finish()]);
        canvas.read().unwrap()
    }

    fn levels(&self) -> Vec<InstanceLevel> {
        self.choice.levels().unwrap()
    }
}

fn drawn(levels: &[InstanceLevel]) -> usize {
    levels.iter().filter(|level| **level != InstanceLevel::HIDDEN).count()
}

#[test]
fn the_gpu_chooses_as_the_cpu_does() {
    let Some(gpu) = gpu() else { return };
    let mut chooser = Chooser::new(gpu);
    chooser.choice.facing = false;
    let table = &sample().table;
    for (scene, members, px) in [
        (ScenarioName::Ring, 20_000, Some(9.0)),
        (ScenarioName::Inside, 3_000, None),
        (ScenarioName::Far, 150, Some(20.0)),
    ] {
        let mut selector = Selector::new(PolicyName::ScreenError, table.clone());
        // The second frame has impostors that stay.
        for (frames, detail) in [(1, 0.5), (3, 0.5), (1, 3.0)] {
            let (flock, camera, _) = frame(scene, members, SIZE, frames);
            let budget = Budget { detail, impostors_below_px: px, ..Budget::default() };
            let expected = selector.select(&flock, &camera, &budget).to_vec();
            chooser.choice.upload(&flock).unwrap();
            chooser.draw(&camera, &budget, &[], None);
            let found = chooser.levels();
            let same = found.iter().zip(&expected).filter(|(a, b)| a == b).count();
            assert!(same * 1_000 >= members * 999, "{}: {same} of {members}", scene.name());
            for (found, expected) in found.iter().zip(&expected) {
                if let (Some(found), Some(expected)) = (found.level(), expected.level()) {
                    assert!(found.abs_diff(expected) <= 1, "{found} {expected}");
                }
            }
            println!("{}: {same} of {members}, {} drawn", scene.name(), drawn(&found));
        }
    }
}

#[test]
fn what_was_chosen_on_the_gpu_is_drawn_like_the_choice_of_the_cpu() {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, impostor } = sample();
    let (flock, camera, _) = frame(ScenarioName::Ring, 400, SIZE, 2);
    let budget = Budget { impostors_below_px: Some(10.0), ..Budget::default() };
    let mut selector = Selector::new(PolicyName::ScreenError, table.clone());
    let whole = selector.select(&flock, &camera, &budget);
    let mut chooser = Chooser::new(gpu);
    let drawn = GpuFlock::new(&chooser.renderer, table, look).unwrap();
    let mut drawn = drawn.with_impostor(&chooser.renderer, impostor).unwrap();
    chooser.choice.upload(&flock).unwrap();
    for facing in [false, true] {
        chooser.choice.facing = facing;
        let found = chooser.draw(&camera, &budget, &[], None);
        let levels = chooser.levels();
        drawn.set(&flock, &levels, &camera).unwrap();
        let expected = picture_of(&chooser.renderer, &drawn, &[], &camera);
        keep(&format!("chosen-{facing}"), [&found, &expected]);
        assert!(difference(&found, &expected, 8).0 < 1e-4, "facing {facing}");
        let to_eye = |i: usize| {
            flock.members.frame(i).transpose() * (camera.eye() - flock.members.position(i))
        };
        let expected = |i: usize| match whole[i].level() {
            Some(depth) if facing => InstanceLevel::drawn(table.facing_level(depth, to_eye(i))),
            _ => whole[i],
        };
        let same = (0..levels.len()).filter(|&i| levels[i] == expected(i)).count();
        assert!(same + 1 >= levels.len(), "facing {facing}: {same} of {}", levels.len());
    }
}

#[test]
fn a_wall_hides_members_and_the_picture_stays() {
    let Some(gpu) = gpu() else { return };
    let mut chooser = Chooser::new(gpu);
    let mut flock = Flock::default();
    for i in 0..3_000 {
        let [x, y, z] = [i % 20, i / 20 % 10, i / 200].map(|k| k as f32);
        flock.members.push([x - 9.5, y - 4.5, -8.0 - z], [1.0, 0.0, 0.0]);
    }
    // Some in front of it, and some beside it.
    for i in 0..20 {
        flock.members.push([i as f32 - 9.5, 0.0, 8.0], [1.0, 0.0, 0.0]);
        flock.members.push([36.0 + 0.5 * i as f32, 0.0, -20.0], [1.0, 0.0, 0.0]);
    }
    let behind = 3_000;
    let ends = [Vec3::new(-30.0, 0.0, -1.0), Vec3::new(12.0, 0.0, -1.0)];
    let wall = [SceneObstacle::Capsule { ends, radius: 6.5 }.mesh()];
    let camera = FlockCamera::look_at([0.0, 0.0, 25.0], [0.0; 3], 1.0, SIZE).unwrap();
    let budget = Budget::default();
    chooser.choice.upload(&flock).unwrap();
    let expected = chooser.draw(&camera, &budget, &wall, None);
    let all = chooser.levels();
    let depths = HiZ::new(gpu, SIZE, TargetFormat::CANVAS.samples).unwrap();
    let first = chooser.draw(&camera, &budget, &wall, Some(&depths));
    assert_eq!(chooser.levels(), all, "nothing is known of the first frame");
    for _ in 0..2 {
        let found = chooser.draw(&camera, &budget, &wall, Some(&depths));
        let levels = chooser.levels();
        let [before, after] = [&all, &levels].map(|levels| drawn(&levels[..behind]));
        println!("{after} of {before} members behind the wall are drawn");
        assert!(after * 10 <= before, "{after} of {before}");
        assert_eq!(drawn(&levels[behind..]), drawn(&all[behind..]));
        for (picture, name) in [(&first, "first"), (&found, "culled")] {
            keep(&format!("wall-{name}"), [picture, &expected]);
            assert_eq!(difference(picture, &expected, 2).0, 0.0, "{name}");
        }
    }
    // The wall goes: a frame later, all are there.
    chooser.draw(&camera, &budget, &[], Some(&depths));
    let found = chooser.draw(&camera, &budget, &[], Some(&depths));
    let open = chooser.draw(&camera, &budget, &[], None);
    let (far, _) = difference(&found, &open, 2);
    assert!(far < 1e-3, "{far}");
}

#[test]
fn depths_hide_nothing_of_a_moving_school() {
    let Some(gpu) = gpu() else { return };
    let mut chooser = Chooser::new(gpu);
    let depths = HiZ::new(gpu, SIZE, TargetFormat::CANVAS.samples).unwrap();
    let budget = Budget { detail: 2.0, ..Budget::default() };
    for frames in 1..5 {
        let (flock, camera, _) = frame(ScenarioName::Ring, 2_000, SIZE, frames);
        chooser.choice.upload(&flock).unwrap();
        let expected = chooser.draw(&camera, &budget, &[], None);
        let all = drawn(&chooser.levels());
        let found = chooser.draw(&camera, &budget, &[], Some(&depths));
        let left = drawn(&chooser.levels());
        let (far, _) = difference(&found, &expected, 8);
        println!("{left} of {all} members are drawn, {:.3} % far", 100.0 * far);
        // A frame takes a tenth of a second.
        assert!(far < 0.01, "{far}");
    }
}

#[test]
fn odd_flocks_are_drawn() {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, .. } = sample();
    let camera = FlockCamera::look_at([0.0, 0.0, 5.0], [0.0; 3], 0.8, SIZE).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let mut on_cpu = GpuFlock::new(&renderer, table, look).unwrap();
    let mut chooser = Chooser::new(gpu);
    let budget = Budget::default();
    let mut show = |flock: &Flock| {
        let mut selector = Selector::new(PolicyName::ScreenError, table.clone());
        on_cpu.set(flock, selector.select(flock, &camera, &budget), &camera).unwrap();
        chooser.choice.upload(flock).unwrap();
        let pictures = [
            picture_of(&renderer, &on_cpu, &[], &camera),
            chooser.draw(&camera, &budget, &[], None),
        ];
        let drawn = [on_cpu.members(), drawn(&chooser.levels())];
        assert_eq!(drawn[0], drawn[1]);
        assert!(difference(&pictures[0], &pictures[1], 8).0 < 1e-3);
        (drawn[0], pictures[0].clone())
    };
    let mut flock = Flock::default();
    let (none, water) = show(&flock);
    assert_eq!(none, 0);
    flock.members.push([0.0; 3], [1.0, 0.0, 0.0]);
    let (one, fish) = show(&flock);
    assert_eq!(one, 1);
    assert!(difference(&water, &fish, 24).0 > 0.01);
    for odd in [[f32::NAN; 3], [0.0, f32::INFINITY, 0.0], [f32::MAX; 3]] {
        flock.members.push(odd, [1.0, 0.0, 0.0]);
    }
    flock.members.push([0.0; 3], [f32::NAN; 3]);
    let (_, odd) = show(&flock);
    assert!(difference(&odd, &fish, 8).0 < 1e-3);
}

#[test]
fn there_can_be_more_members_than_16_bits_count() {
    let Some(gpu) = gpu() else { return };
    let SampleSchool { table, look, impostor } = sample();
    let mut flock = Flock::default();
    for i in 0..70_000 {
        let (x, y) = ((i % 400) as f32, (i / 400) as f32);
        flock.members.push([x - 199.5, y - 87.0, 0.0], [1.0, 0.0, 0.0]);
    }
    let camera = FlockCamera::look_at([0.0, 0.0, 260.0], [0.0; 3], 0.8, SIZE).unwrap();
    let renderer = Renderer::new(gpu, TargetFormat::CANVAS);
    let flocks = GpuFlock::new(&renderer, table, look).unwrap();
    let mut flocks = flocks.with_impostor(&renderer, impostor).unwrap();
    for level in [InstanceLevel::drawn(table.depth() - 1), InstanceLevel::IMPOSTOR] {
        flocks.set(&flock, &vec![level; 70_000], &camera).unwrap();
        assert_eq!(flocks.members(), 70_000);
        let picture = picture_of(&renderer, &flocks, &[], &camera);
        // The last row is there as the first is.
        let water = picture_of(&renderer, &flocks.sharing(), &[], &camera);
        let row = |y: u32| {
            let differs = |x: &u32| picture.pixel(*x, y) != water.pixel(*x, y);
            (0..SIZE[0]).filter(differs).count()
        };
        let rows: Vec<u32> = (0..SIZE[1]).filter(|&y| row(y) > 100).collect();
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        assert!((first + last).abs_diff(SIZE[1]) < 8 && last - first > 150, "{first} {last}");
    }
}

#[test]
fn more_members_than_the_gpu_binds_are_refused() {
    let Some(gpu) = gpu() else { return };
    let limit = gpu.device.limits().max_storage_buffer_binding_size;
    if limit > 1 << 28 {
        eprintln!("skipped: this GPU binds {limit} bytes, too many to go beyond in a test");
        return;
    }
    let mut flock = Flock::default();
    flock.members.resize((limit / 24 + 1) as usize);
    let refused = Chooser::new(gpu).choice.upload(&flock);
    assert!(matches!(refused, Err(ViewError::TooLarge { .. })), "{refused:?}");
}
