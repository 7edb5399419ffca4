use std::ops::ControlFlow;

use meshlod_check::{
    CheckOptions, Finding, HoleLimits, Kind, Kinds, RepairOptions, RepairStep, Summary, check,
    findings, fuse, repair,
};
use meshlod_mesh::{Attributes, Labels, Layer, LayerKind, Mesh, VertexId, WedgeId};

use crate::accept::accept;

/// Faces over few vertices, where nearly everything is wrong. Byte 0 chooses the number of
/// vertices, byte 1 the attributes and whether holes are closed; coordinates and faces follow.
fn mesh(bytes: &[u8]) -> Option<(Mesh, RepairOptions)> {
    let (&[count, extras], rest) = bytes.split_first_chunk()?;
    let count = 3 + usize::from(count % 61);
    let (coordinates, faces) = rest.split_at_checked(count * 3)?;
    let (points, _) = coordinates.as_chunks::<3>();
    let (triples, _) = faces.as_chunks::<3>();
    let positions = points.iter().map(|p| p.map(coordinate)).collect();
    // One of the vertices that faces may name does not exist.
    let faces: Vec<_> =
        triples.iter().map(|t| t.map(|v| VertexId(u32::from(v) % (count as u32 + 1)))).collect();
    let mut mesh = Mesh::new(positions, faces);
    mesh.attributes = (extras & 1 != 0).then(|| attributes(&mesh, extras));
    mesh.objects = (extras & 2 != 0).then(|| objects(&mesh, extras));
    let holes = HoleLimits { edges: usize::from(extras >> 4), length: None };
    let holes = (extras & 4 != 0).then_some(holes);
    let weld = (extras & 8 != 0).then_some(0.0);
    Some((mesh, RepairOptions { weld, holes, ..RepairOptions::default() }))
}

/// Small integers, and a few difficult values.
fn coordinate(byte: u8) -> f64 {
    match byte as i8 {
        -128 => f64::NAN,
        -127 => f64::NEG_INFINITY,
        -126 => 1e300,
        -125 => -1e-300,
        x => f64::from(x),
    }
}

/// Wedges by vertex or by corner, sometimes one value short.
fn attributes(mesh: &Mesh, extras: u8) -> Attributes {
    let own = extras & 32 != 0;
    let wedge = |f: usize, k: usize| if own { (3 * f + k) as u32 } else { mesh.faces[f][k].0 };
    let corners = (0..mesh.faces.len()).map(|f| [0, 1, 2].map(|k| WedgeId(wedge(f, k)))).collect();
    let wedge_count = if own { 3 * mesh.faces.len() } else { mesh.positions.len() + 1 };
    let layer = |kind, width: usize| Layer {
        kind,
        name: String::new(),
        width,
        values: (0..(wedge_count * width).saturating_sub(usize::from(extras == 0xff)))
            .map(|i| (i % 5) as f32 - 2.0)
            .collect(),
    };
    let layers = vec![layer(LayerKind::Normal, 3), layer(LayerKind::Uv(0), 2)];
    Attributes { corners, wedge_count, layers }
}

/// Alternating objects, sometimes one label short.
fn objects(mesh: &Mesh, extras: u8) -> Labels {
    let labelled = mesh.faces.len().saturating_sub(usize::from(extras & 64 != 0));
    let of_face = (0..labelled).map(|f| (f / 3 % 2) as u32).collect();
    Labels { names: vec!["a".into(), "b".into()], of_face }
}

/// Errors of a repaired mesh that the report does not mention.
fn untold(mesh: &Mesh, one_sided: usize) -> Vec<Finding> {
    let kinds = match one_sided {
        0 => Kinds::errors(),
        _ => Kinds::errors().without(Kind::InconsistentEdge),
    };
    findings(mesh, &CheckOptions { kinds, ..CheckOptions::default() })
}

/// Finds, repairs and fuses few faces with nearly every defect.
pub fn run(bytes: &[u8]) {
    let Some((mesh, options)) = mesh(bytes) else { return };
    let mut summary = Summary::default();
    let _ = check(&mesh, &CheckOptions::default(), &mut |finding| {
        summary.add(finding);
        ControlFlow::Continue(())
    });
    let (mended, report) = repair(&mesh, &options);
    accept(&mended);
    let left = untold(&mended, report.count(RepairStep::NotOrientable));
    assert!(left.is_empty(), "{left:?} is left of {summary:?} after {report:?}");
    let (fused, _) = fuse(&mended, |face| face.index() % 5 != 4);
    accept(&fused);
    // Split vertices coincide, and welding joins them again. Borders that obstructed each other can
    // be stitched once the hole behind one of them is closed.
    if options.weld.is_none() && options.holes.is_none() {
        let (again, twice) = repair(&mended, &options);
        assert!(again == mended, "repaired twice: {report:?}, then {twice:?}");
    }
}
