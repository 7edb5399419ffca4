//! Report page of a mesh check, in HTML.

use std::path::Path;

use maud::{Markup, html};
use meshlod::Mesh;
use meshlod::io::write_file;
use meshlod::picture::Camera;

use crate::check::drawing::{Drawing, Part, SIZE, views};
use crate::check::findings::findings;
use crate::check::inspection::Inspection;
use crate::check::marks::{Mark, Marks};
use crate::check::places::short;
use crate::check::sites::Sites;
use crate::check::text;
use crate::page::document::{Document, document};
use crate::page::figures::{figure, whole};
use crate::page::inline_picture::InlinePicture;
use crate::page::renderer::view_from;
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, plural, value};
use meshlod::jobs::{CONTACT_KINDS, ObjectPair};

/// Limit of object pairs in the table; the JSON has more.
const MOST_PAIRS: usize = 60;

/// Writes the report page to an existing folder and returns its path.
pub fn write(
    folder: &Path,
    name: &str,
    inspection: &Inspection,
    sites: &Sites,
) -> Result<String, Failure> {
    let path = folder.join("index.html");
    let page = page(name, inspection, sites)?.into_string();
    write_file(&path, page.as_bytes())?;
    Ok(files::name(&path))
}

fn page(name: &str, inspection: &Inspection, sites: &Sites) -> Result<Markup, Failure> {
    let title = Path::new(name).file_name().map(|name| name.to_string_lossy().into_owned());
    let title = title.unwrap_or_else(|| name.to_owned());
    let pictures = match &inspection.drawn {
        Some(drawn) if !drawn.mesh.faces.is_empty() => pictures(&title, &drawn.mesh, &drawn.marks)?,
        _ => html! {},
    };
    let contacts = !inspection.report.contacts.is_empty();
    let links = [("findings", "Findings"), ("contacts", "Contacts")];
    let links = links.into_iter().filter(|(id, _)| contacts || *id != "contacts");
    Ok(document(Document {
        title: &format!("meshlod check: {title}"),
        links: links.map(|(id, name)| (id.to_owned(), name.to_owned())).collect(),
        header: html! {
            h1 id="top" { (title) }
            p.lead { (lead(inspection)) }
        },
        main: html! {
            (pictures)
            (findings(inspection, sites))
            @if contacts { (contact_table(inspection)) }
        },
    }))
}

fn lead(inspection: &Inspection) -> String {
    let objects = inspection.report.owners.objects.names.len();
    let of = format!("{} object{}", count(objects), plural(objects));
    match inspection.report.summary.total() {
        0 => format!("No findings in {of}."),
        _ => format!("{of}: {}.", text::verdict(inspection)),
    }
}

/// Draws the mesh from all sides, and below it the marked parts only.
fn pictures(title: &str, mesh: &Mesh, marks: &Marks) -> Result<Markup, Failure> {
    let used = marks.used();
    let parts: &[(Part, &str)] = match used[..] {
        [] => &[(Part::Whole, "the whole mesh")],
        _ => &[(Part::Whole, "the whole mesh"), (Part::Marked, "the marked parts only")],
    };
    let drawings: Vec<(Drawing, &str)> =
        parts.iter().map(|&(part, about)| (Drawing::new(mesh, marks, part), about)).collect();
    let mut figures = Vec::new();
    for (side, direction) in views() {
        let camera = Camera::fit_mesh(mesh, &view_from(direction, SIZE));
        let images = drawings.iter().map(|(drawing, about)| {
            let picture = drawing.picture(&camera).map_err(Failure::new)?;
            Ok(InlinePicture::new(&picture, format!("{title} {side}, {about}")))
        });
        figures.push((side, images.collect::<Result<Vec<_>, Failure>>()?));
    }
    // What is said above the pictures is a row, too.
    let rows = 1 + parts.len();
    Ok(html! {
        section id="pictures" {
            h2 { "Pictures" }
            @if parts.len() > 1 {
                p { "Above: the whole mesh. Below: the marked parts only, so that those inside show too." }
            }
            (legend(&used))
            div.strip.wrap style=(format!("--columns: 4; --rows: {rows}")) tabindex="0" role="region" aria-label=(title) {
                @for (side, images) in figures {
                    figure {
                        figcaption { b { (side) } }
                        @for image in images { (image.zoomable()) }
                    }
                }
            }
        }
    })
}

/// Explains the colours, those of defects before those of what may be meant.
fn legend(used: &[Mark]) -> Markup {
    let (meant, defects): (Vec<Mark>, _) = used.iter().partition(|mark| mark.may_be_meant());
    let row = |name: &str, marks: &[Mark]| {
        html! {
            @if !marks.is_empty() {
                ul.swatches {
                    li { b { (name) } }
                    @for mark in marks {
                        @let [r, g, b] = mark.color();
                        li { span style=(format!("background: rgb({r} {g} {b})")) {} (mark.about()) }
                    }
                }
            }
        }
    };
    html! { (row("To look at", &defects)) (row("May be meant", &meant)) }
}

/// Says whether two objects touch or pass through each other.
fn meeting(pair: &ObjectPair) -> Markup {
    match pair.only_touches() {
        true => html! { span.chip.touch { "touch" } },
        false => html! { span.chip.warning { "cross" } },
    }
}

fn contact_table(inspection: &Inspection) -> Markup {
    let pairs = inspection.report.contacts.by_size();
    let more = pairs.len().saturating_sub(MOST_PAIRS);
    let number = |number: usize| html! { @if number > 0 { (whole(number)) } @else { "–" } };
    html! {
        section id="contacts" {
            h2 { "Contacts" }
            p {
                (text::meetings(inspection)) ". Depth is the least distance, in model "
                "units, that a face would have to move until it only touches the other."
            }
            div.scroll tabindex="0" role="region" aria-label="Contacts" { table {
                thead { tr {
                    th scope="col" { "Objects" } th scope="col" { "face pairs" }
                    @for (_, name) in CONTACT_KINDS { th scope="col" { (name) } }
                    th scope="col" { "deepest" }
                } }
                tbody { @for (objects, pair) in pairs.iter().take(MOST_PAIRS) { tr {
                    th scope="row" {
                        (short(inspection.report.name(objects[0]))) " – " (short(inspection.report.name(objects[1])))
                        " " (meeting(pair))
                    }
                    td { (number(pair.faces())) }
                    @for touches in pair.counts { td { (number(touches)) } }
                    td { (figure(pair.deepest.depth, &value(pair.deepest.depth))) }
                } } }
            } }
            @if more > 0 { p.about { "And " (count(more)) " more." } }
        }
    }
}
