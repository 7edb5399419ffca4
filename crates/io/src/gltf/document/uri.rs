//! URIs of glTF buffers and images: embedded data or a file name.

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

/// Parsed URI.
#[derive(Debug, PartialEq)]
pub(crate) enum Uri {
    /// Bytes of a `data:` URI.
    Data(Vec<u8>),
    /// File name relative to the document, percent-decoded.
    File(String),
}

/// Parses a `data:` URI or a relative file name; absolute URLs such as `https:` are errors.
pub(crate) fn parse(uri: &str) -> Result<Uri, String> {
    if let Some(data) = strip_scheme(uri, "data:") {
        return data_bytes(data).map(Uri::Data);
    }
    if let Some(scheme) =
        ["http:", "https:", "ftp:"].iter().find(|s| strip_scheme(uri, s).is_some())
    {
        return Err(format!("{scheme} URIs are not downloaded; put the file next to the document"));
    }
    let name = percent_decode_str(uri).decode_utf8().map_err(|_| "its URI is not UTF-8")?;
    Ok(Uri::File(name.into_owned()))
}

/// Encodes a file name as a URI.
pub(crate) fn of_file(name: &str) -> String {
    const KEPT: &AsciiSet =
        &NON_ALPHANUMERIC.remove(b'-').remove(b'_').remove(b'.').remove(b'~').remove(b'/');
    utf8_percent_encode(name, KEPT).to_string()
}

fn strip_scheme<'a>(uri: &'a str, scheme: &str) -> Option<&'a str> {
    let head = uri.get(..scheme.len())?;
    head.eq_ignore_ascii_case(scheme).then(|| &uri[scheme.len()..])
}

fn data_bytes(data: &str) -> Result<Vec<u8>, String> {
    const LENIENT: GeneralPurposeConfig = GeneralPurposeConfig::new()
        .with_decode_allow_trailing_bits(true)
        .with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let Some((kind, body)) = data.split_once(',') else {
        return Err("its data URI has no comma".to_owned());
    };
    if !kind.ends_with(";base64") {
        return Ok(percent_decode_str(body).collect());
    }
    let engine = GeneralPurpose::new(&STANDARD, LENIENT);
    engine.decode(body.trim()).map_err(|error| format!("its data URI is not base64: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_comes_with_and_without_base64_and_padding() {
        for uri in [
            "data:application/octet-stream;base64,AQID/w==",
            "DATA:;base64,AQID/w",
            "data:,%01%02%03%FF",
        ] {
            assert_eq!(parse(uri), Ok(Uri::Data(vec![1, 2, 3, 255])), "{uri}");
        }
    }

    #[test]
    fn file_names_survive_both_ways() {
        for name in ["a b/ü%.png", "plain-1_2.bin"] {
            assert_eq!(parse(&of_file(name)), Ok(Uri::File(name.to_owned())));
        }
    }

    #[test]
    fn what_cannot_be_had_is_an_error() {
        for uri in ["https://x.org/a.bin", "data:text", "data:;base64,*", "%ff.bin"] {
            parse(uri).unwrap_err();
        }
    }
}
