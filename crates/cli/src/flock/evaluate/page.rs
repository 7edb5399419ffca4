//! Page of an evaluation, in HTML.

use maud::{Markup, html};

use crate::flock::evaluate::chart::{Curve, CurveChart, chart};
use crate::flock::evaluate::pictures::Pictures;
use crate::flock::evaluate::summary::{PAIRS, arms, needed_share, ratio_text, share_text};
use crate::flock::evaluate::{
    BUDGET, FLIPS, OURS, OURS_VISIBLE, Report, SCREEN_ERROR, SHOWN_SHARE,
};
use crate::page::document::{Document, document};
use crate::text::numbers::count;

/// Builds the whole page.
pub fn page(report: &Report<'_>) -> Markup {
    let scenes = report.evaluation.full_triangles.iter().map(|(scene, _)| scene);
    let links =
        [("needed", "Triangles needed"), ("shares", "At equal triangles"), ("paper", "Over time")]
            .map(|(a, b)| (a.into(), b.into()))
            .into_iter()
            .chain(scenes.clone().map(|scene| (scene.clone(), scene.clone())))
            .collect();
    document(Document {
        title: "meshlod flock: triangles against image error",
        links,
        header: header(report),
        main: html! {
            (needed(report))
            (shares(report))
            (over_time(report))
            @for scene in scenes { (section(report, scene)) }
        },
    })
}

fn header(report: &Report<'_>) -> Markup {
    let [width, height] = report.size;
    html! {
        h1 id="top" { "Flocks: triangles against image error" }
        p.lead {
            (count(report.members)) " members of " (report.model.name) " (" (count(report.model.faces))
            " faces) in five scenes, " (width) " by " (height) " pixels. Every arm chooses from the same "
            "levels for the same recorded frames, and is drawn by the same rasteriser with four samples "
            "a pixel. Errors are means over the pixels that show the flock, against full detail: "
            "FLIP at 67 pixels per degree (0 is equal) and SSIM (1 is equal)."
        }
        @if report.is_quick {
            p { "This is the quick version: two pairs of frames a scene, small pictures. Without "
                code { "--quick" } " it is " code { "meshlod flock --evaluate --out DIR" } "." }
        }
    }
}

fn needed(report: &Report<'_>) -> Markup {
    html! {
        section id="needed" {
            h2 { "Triangles needed for an image error" }
            p { "Mean share of the triangles of full detail in view, over the scenes; – where the error "
                "is not reached in every scene." }
            div.scroll { table {
                thead { tr {
                    th scope="col" { "arm" }
                    @for flip in FLIPS { th scope="col" { "FLIP " (flip) } }
                } }
                tbody { @for arm in arms(report) {
                    tr {
                        th scope="row" { (arm) }
                        @for flip in FLIPS { td { (share_text(needed_share(report, &arm, flip))) } }
                    }
                } }
            } }
            h3 { "Ratios at equal image error" }
            p { "Geometric means over the scenes, with the interval of nine tenths of 500 resamples of "
                "scenes and frames." }
            div.scroll { table {
                thead { tr {
                    th scope="col" { "arm over other" }
                    @for flip in FLIPS { th scope="col" { "FLIP " (flip) } }
                } }
                tbody { @for [arm, other] in PAIRS {
                    tr {
                        th scope="row" { (arm) " over " (other) }
                        @for flip in FLIPS {
                            td { (ratio_text(report.evaluation.ratio(arm, other, flip))) }
                        }
                    }
                } }
            } }
        }
    }
}

/// Shares of the triangles for which figures are shown.
const SHARES: [f64; 4] = [0.01, 0.02, 0.05, 0.1];

fn shares(report: &Report<'_>) -> Markup {
    let evaluation = report.evaluation;
    let cell = |value: Option<f64>, digits: usize| {
        html! { td { @match value {
            Some(value) => data value=(value) { (format!("{value:.digits$}")) },
            None => "–",
        } } }
    };
    html! {
        section id="shares" {
            h2 { "At equal triangles" }
            p { "Means over the scenes. Temporal error, level switches and time are those at "
                (100.0 * SHOWN_SHARE) " % of the triangles: the change of the error from a frame to the "
                "next in parts of white, and the changes of level that a member shows in a second." }
            div.scroll { table {
                thead { tr {
                    th scope="col" { "arm" }
                    @for share in SHARES { th scope="col" { "FLIP at " (100.0 * share) " %" } }
                    @for share in SHARES { th scope="col" { "SSIM at " (100.0 * share) " %" } }
                    th scope="col" { "temporal" }
                    th scope="col" { "switches" }
                    th scope="col" { "ms a frame" }
                } }
                tbody { @for arm in arms(report) {
                    tr {
                        th scope="row" { (arm) }
                        @for share in SHARES { (cell(evaluation.mean(&arm, share, |r| r.flip()), 3)) }
                        @for share in SHARES { (cell(evaluation.mean(&arm, share, |r| r.ssim()), 3)) }
                        (cell(evaluation.mean(&arm, SHOWN_SHARE, |r| r.temporal_error), 4))
                        (cell(evaluation.mean(&arm, SHOWN_SHARE, |r| r.switches_per_second), 2))
                        (cell(evaluation.mean(&arm, SHOWN_SHARE, |r| 1e3 * r.selection_seconds), 3))
                    }
                } }
            } }
        }
    }
}

fn over_time(report: &Report<'_>) -> Markup {
    let frame_s = f64::from(report.frame_s);
    let triangles = report.tracks.iter().map(|track| Curve {
        name: track.arm.clone(),
        points: track
            .triangles
            .iter()
            .enumerate()
            .map(|(i, &t)| [i as f64 * frame_s, t as f64])
            .collect(),
    });
    let flips = report.tracks.iter().map(|track| Curve {
        name: track.arm.clone(),
        points: track.flips.iter().map(|&(i, flip)| [i as f64 * frame_s, flip]).collect(),
    });
    html! {
        section id="paper" {
            h2 { "Over time, with equal settings" }
            p { "The experiment of the paper: the camera follows and circles one school, and all arms "
                "have the same parameters. Their image errors differ, as the second chart shows." }
            div.charts {
                (chart(&CurveChart {
                    alt: "Triangles drawn over time",
                    caption: "Triangles drawn in each frame.".into(),
                    curves: triangles.collect(),
                    axes: ["seconds", "triangles"],
                    logarithmic: [false, false],
                }))
                (chart(&CurveChart {
                    alt: "Image error over time",
                    caption: "Mean FLIP against full detail.".into(),
                    curves: flips.collect(),
                    axes: ["seconds", "FLIP"],
                    logarithmic: [false, false],
                }))
            }
        }
    }
}

/// Arms whose curves are drawn.
const DRAWN: [&str; 7] =
    ["distance", "screen-error", SCREEN_ERROR, BUDGET, "paper", OURS, OURS_VISIBLE];

fn section(report: &Report<'_>, scene: &str) -> Markup {
    let curve = |arm: &str| {
        let rows = report.evaluation.rows.iter().filter(|r| r.scene == scene && r.arm == arm);
        let points = rows.map(|row| [row.mean_triangles(), row.flip()]).collect();
        Curve { name: arm.into(), points }
    };
    let floor = report.evaluation.floors.iter().find(|(of, _)| of == scene);
    let floor = floor.map_or(0.0, |(_, score)| score.flip);
    html! {
        section id=(scene) {
            h2 { (scene) }
            (chart(&CurveChart {
                alt: "FLIP against triangles",
                caption: format!("FLIP against triangles; both axes are logarithmic. Full detail with \
                    its samples shifted by a quarter of a pixel differs by {floor:.3} from itself."),
                curves: DRAWN.iter().map(|arm| curve(arm)).collect(),
                axes: ["triangles", "FLIP"],
                logarithmic: [true, true],
            }))
            div.pictures {
                @for (name, file) in report.pictures.of_scene(scene) {
                    figure {
                        a href=(file) { img src=(file) alt=(format!("{scene}: {name}")) loading="lazy"
                            style="max-width: 100%"; }
                        figcaption { (name) @if name != "full detail" { " at " (100.0 * SHOWN_SHARE) " %" } }
                    }
                }
            }
            figure {
                @let file = Pictures::strip_of(scene);
                a href=(file) { img src=(file) alt=(format!("{scene}: frames")) loading="lazy"
                    style="max-width: 100%"; }
                figcaption { "Frames in full detail, by budget and by ours with " (100.0 * SHOWN_SHARE)
                    " % of the triangles." }
            }
        }
    }
}
