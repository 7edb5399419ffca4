//! Properties of a material, read from its MTL statements.

use std::borrow::Cow;

use super::statement;
use super::statement::MapOption;
use crate::error::ParseError;
use crate::scene::Image;
use crate::scene::image_file::has_colors;
use crate::scene::material::{Material, MtlStatement, Shading};
use crate::text::cursor::TextCursor;

/// Properties that MTL statements set.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Meaning {
    pub base_color: [f32; 4],
    pub base_color_image: Option<usize>,
    pub shading: Shading,
}

/// Values set by the statements so far.
#[derive(Clone, Debug, Default)]
pub(super) struct StatedValues {
    color: Option<[f32; 3]>,
    opacity: Option<f32>,
    /// Used only without an opacity: exporters that write both disagree about it.
    transparency: f32,
    specular: [f32; 3],
    exponent: f32,
    has_no_highlight: bool,
    roughness: Option<f32>,
    metallic: Option<f32>,
    emission: Option<[f32; 3]>,
    color_image: Option<usize>,
    emission_image: Option<usize>,
    opacity_image: Option<usize>,
    roughness_image: Option<usize>,
    metallic_image: Option<usize>,
    normal: Option<(usize, f32)>,
    relief: Option<(usize, f32)>,
}

/// Returns the properties set by the statements of a material. Unknown and malformed statements are
/// skipped.
pub(super) fn meaning(statements: &[MtlStatement], images: &[Image]) -> Meaning {
    let mut said = StatedValues::default();
    for line in statements {
        // The library has noted what is refused.
        let _ = said.add(&without_name(line), line.map.as_ref().map(|map| map.image));
    }
    said.meaning(images)
}

/// Returns a statement without the name of its image, since options may follow the name.
fn without_name(line: &MtlStatement) -> Cow<'_, str> {
    match &line.map {
        Some(map) if !map.rest.is_empty() => Cow::Owned(format!("{}{}", line.text, map.rest)),
        _ => Cow::Borrowed(&line.text),
    }
}

impl StatedValues {
    /// Adds a statement, and the image that it names.
    ///
    /// # Errors
    /// A colour or a number that cannot be read; the statement is then ignored.
    pub fn add(&mut self, line: &str, image: Option<usize>) -> Result<(), ParseError> {
        let word = statement::word_of(line);
        match (&*word, image) {
            ("map_kd", Some(_)) => self.color_image = image,
            ("map_ke", Some(_)) => self.emission_image = image,
            ("map_d", Some(_)) => self.opacity_image = image,
            ("map_pr", Some(_)) if channel(line).is_none_or(|c| c == "g") => {
                self.roughness_image = image;
            }
            ("map_pm", Some(_)) if channel(line).is_none_or(|c| c == "b") => {
                self.metallic_image = image;
            }
            ("norm", Some(image)) => self.normal = Some((image, multiplier(line))),
            ("bump" | "map_bump", Some(image)) => self.relief = Some((image, multiplier(line))),
            ("kd", _) => self.color = color(line)?.or(self.color),
            ("d", _) => {
                let values = line.replacen("-halo", "", 1);
                self.opacity = Some(number(&values, "d needs an opacity")?);
            }
            ("tr", _) => self.transparency = number(line, "Tr needs a transparency")?,
            ("ks", _) => self.specular = color(line)?.unwrap_or_default(),
            ("ke", _) => self.emission = color(line)?.or(self.emission),
            ("ns", _) => self.exponent = number(line, "Ns needs an exponent")?,
            ("pr", _) => self.roughness = Some(number(line, "Pr needs a roughness")?),
            ("pm", _) => self.metallic = Some(number(line, "Pm needs a metalness")?),
            ("illum", _) => self.has_no_highlight = number(line, "illum needs a number")? < 2.0,
            _ => {}
        }
        Ok(())
    }

    fn meaning(&self, images: &[Image]) -> Meaning {
        // Default grey of the format for a material without Kd.
        let [r, g, b] = self.color.unwrap_or([0.8; 3]);
        let whole = |image: Option<usize>| if image.is_some() { 1.0 } else { 0.0 };
        let is_normals = |&(image, _): &(usize, f32)| {
            images.get(image).is_some_and(|image| has_colors(&image.bytes))
        };
        let normal = self.normal.or(self.relief.filter(is_normals));
        let guess = || if self.roughness_image.is_some() { 1.0 } else { self.guessed_roughness() };
        Meaning {
            base_color: [r, g, b, self.opacity.unwrap_or(1.0 - self.transparency)],
            base_color_image: self.color_image,
            shading: Shading {
                metallic: self.metallic.unwrap_or(whole(self.metallic_image)),
                metallic_image: self.metallic_image,
                roughness: self.roughness.unwrap_or_else(guess),
                roughness_image: self.roughness_image,
                normal_image: normal.map(|(image, _)| image),
                normal_scale: normal.map_or(1.0, |(_, scale)| scale),
                emission: self.emission.unwrap_or([whole(self.emission_image); 3]),
                emission_image: self.emission_image,
                opacity_image: self.opacity_image,
            },
        }
    }

    /// Estimates the roughness from the highlight: 1 without one, else the roughness whose
    /// microfacets are as spread out as a Phong lobe with the exponent `Ns`, with a width α of √(2
    /// / (`Ns` + 2)), the square of glTF's roughness.
    ///
    /// # References
    /// [WMLT07] section 5.2, solved for the width; [Khr21] appendix B for the square.
    fn guessed_roughness(&self) -> f32 {
        if self.has_no_highlight || self.specular.iter().all(|&x| x <= 0.0) {
            return 1.0;
        }
        (2.0 / (self.exponent.max(0.0) + 2.0)).powf(0.25)
    }
}

/// Reads a colour; `None` if it is missing or given in another colour space, as in `Kd spectral`.
fn color(line: &str) -> Result<Option<[f32; 3]>, ParseError> {
    let mut text = values(line)?;
    if !text.more() || text.comes(b's') || text.comes(b'x') {
        return Ok(None);
    }
    let red = text.attribute("")?;
    let green = if text.more() { text.attribute("")? } else { red };
    let blue = if text.more() { text.attribute("")? } else { red };
    finite(&text, Some([red, green, blue]))
}

fn number(line: &str, need: &str) -> Result<f32, ParseError> {
    let mut text = values(line)?;
    let number = text.attribute(need)?;
    finite(&text, number)
}

/// Returns the value of a line, unless the line has a number that is not finite.
fn finite<T>(text: &TextCursor, value: T) -> Result<T, ParseError> {
    match text.not_finite() {
        0 => Ok(value),
        _ => Err(text.error("a number is not finite")),
    }
}

/// Returns a cursor after the first word of a line.
fn values(line: &str) -> Result<TextCursor<'_>, ParseError> {
    let mut text = TextCursor::new(line.as_bytes())?;
    text.word();
    Ok(text)
}

/// Returns the image channel selected by a statement.
fn channel(line: &str) -> Option<&str> {
    let (options, _) = statement::options(line);
    options.into_iter().find(|option| option.name == "-imfchan").map(|option| option.values)
}

/// Returns the bump multiplier of a statement; 1 by default.
fn multiplier(line: &str) -> f32 {
    let (options, _) = statement::options(line);
    let given = options.into_iter().find(|option| option.name == "-bm");
    given
        .and_then(|option| option.values.parse().ok())
        .filter(|x: &f32| x.is_finite())
        .unwrap_or(1.0)
}

/// Statements of a material that a glTF document cannot hold, and statements that it converts.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct MtlLosses {
    pub left_out: Vec<String>,
    pub changed: Vec<String>,
    /// Number of separate roughness and metalness maps, which glTF stores in one image.
    pub apart: usize,
}

/// Lists the statements of a material that a new glTF document loses or converts.
pub(crate) fn mtl_losses(material: &Material, images: &[Image]) -> MtlLosses {
    let meaning = meaning(&material.mtl, images);
    let surface = &meaning.shading;
    let combined = surface.metallic_roughness_image();
    let says_roughness = material.mtl.iter().any(|line| statement::word_of(&line.text) == "pr");
    let mut losses = MtlLosses::default();
    for line in &material.mtl {
        let word = statement::word_of(&line.text);
        let image = line.map.as_ref().map(|map| map.image);
        let is = |used: Option<usize>| image.is_some() && image == used;
        let is_other_space = ["kd", "ks", "ke"].contains(&&*word)
            && color(&line.text).is_ok_and(|color| color.is_none());
        let arrives = match &*word {
            _ if is_other_space => false,
            "" | "kd" | "d" | "tr" | "pr" | "pm" | "ke" => true,
            "map_kd" => is(meaning.base_color_image),
            "map_ke" => is(surface.emission_image),
            "map_d" => is(meaning.base_color_image),
            "map_pr" => is(surface.roughness_image) && is(combined),
            "map_pm" => is(surface.metallic_image) && is(combined),
            "norm" | "bump" | "map_bump" => is(surface.normal_image),
            _ => false,
        };
        let is_guess = !says_roughness
            && !is_other_space
            && ["ks", "ns"].contains(&&*word)
            && surface.roughness < 1.0;
        let written = statement::split_word(line.text.trim_start()).0.to_owned();
        match arrives {
            false if ["map_pr", "map_pm"].contains(&&*word) && combined.is_none() => {
                losses.apart += 1;
            }
            _ if is_guess || arrives && word.ends_with("bump") => losses.changed.push(written),
            false => losses.left_out.push(written),
            true => {
                let text = without_name(line);
                let lost = lost_options(&text, &word).into_iter();
                losses.left_out.extend(lost.map(|option| format!("{written} {}", option.name)));
            }
        }
    }
    losses
}

/// Lists the options of an image statement that glTF lacks.
fn lost_options<'a>(line: &'a str, word: &str) -> Vec<MapOption<'a>> {
    if !statement::names_image(word) {
        return Vec::new();
    }
    let kept = |option: &MapOption| {
        option.name == "-imfchan" || option.name == "-bm" && word.ends_with("norm")
    };
    statement::options(line).0.into_iter().filter(|option| !kept(option)).collect()
}
