//! Header of a `.npy` file: a Python dictionary of three entries.

use crate::recording::npy::NpyError;

/// Header of an array.
#[derive(Debug, Default)]
pub struct Header {
    pub descr: String,
    pub fortran_order: bool,
    pub shape: Vec<usize>,
}

/// First bytes of a file, before the version.
const MAGIC: &[u8] = b"\x93NUMPY";

/// The header ends at a multiple of this many bytes.
const ALIGNMENT: usize = 64;

/// Greatest number of axes in NumPy.
const MOST_AXES: usize = 64;

impl Header {
    /// Returns the bytes before the values.
    pub fn bytes(descr: &str, shape: &[usize]) -> Vec<u8> {
        let sides: Vec<String> = shape.iter().map(usize::to_string).collect();
        let tuple = match &sides[..] {
            [one] => format!("({one},)"),
            all => format!("({})", all.join(", ")),
        };
        let mut text =
            format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {tuple}, }}");
        let fixed = MAGIC.len() + 4;
        let length = (fixed + text.len() + 1).next_multiple_of(ALIGNMENT) - fixed;
        text += &" ".repeat(length - 1 - text.len());
        text.push('\n');
        let length = u16::try_from(text.len()).expect("64 axes have a short header");
        [MAGIC, &[1, 0], &length.to_le_bytes(), text.as_bytes()].concat()
    }

    /// Reads the header, and returns it with the bytes of the values.
    pub fn read(bytes: &[u8]) -> Result<(Self, &[u8]), NpyError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(NpyError::NotNpy)?;
        let (version, rest) = rest.split_first_chunk::<2>().ok_or(NpyError::Cut)?;
        if *version != [1, 0] {
            return Err(NpyError::Version(version[0], version[1]));
        }
        let (length, rest) = rest.split_first_chunk::<2>().ok_or(NpyError::Cut)?;
        let length = usize::from(u16::from_le_bytes(*length));
        let (text, values) = rest.split_at_checked(length).ok_or(NpyError::Cut)?;
        let text = str::from_utf8(text).map_err(|_| NpyError::Header("it is not text"))?;
        Ok((Parser { rest: text }.header()?, values))
    }
}

/// Parser of the dictionary.
struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn header(&mut self) -> Result<Header, NpyError> {
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        self.expect("{", "it is not a dictionary")?;
        while !self.take("}") {
            let key = self.string("a key must be a string")?;
            self.expect(":", "a colon must follow a key")?;
            let is_new = match key {
                "descr" => descr.replace(self.string("`descr` must be a string")?).is_none(),
                "fortran_order" => fortran_order.replace(self.truth()?).is_none(),
                "shape" => shape.replace(self.tuple()?).is_none(),
                _ => return Err(NpyError::Header("it has a key that is not known")),
            };
            if !is_new {
                return Err(NpyError::Header("a key comes twice"));
            }
            if !self.take(",") {
                self.expect("}", "a comma or a brace must follow a value")?;
                break;
            }
        }
        match (descr, fortran_order, shape, self.rest.trim()) {
            (Some(descr), Some(fortran_order), Some(shape), "") => {
                Ok(Header { descr: descr.into(), fortran_order, shape })
            }
            (_, _, _, "") => {
                Err(NpyError::Header("`descr`, `fortran_order` or `shape` is missing"))
            }
            _ => Err(NpyError::Header("something follows the dictionary")),
        }
    }

    /// Skips spaces and takes a token if it is there.
    fn take(&mut self, token: &str) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(token) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, token: &str, otherwise: &'static str) -> Result<(), NpyError> {
        if self.take(token) { Ok(()) } else { Err(NpyError::Header(otherwise)) }
    }

    fn string(&mut self, otherwise: &'static str) -> Result<&'a str, NpyError> {
        let quote = ["'", "\""].into_iter().find(|quote| self.take(quote));
        let (text, rest) = quote
            .and_then(|quote| self.rest.split_once(quote))
            .filter(|(text, _)| !text.contains('\\'))
            .ok_or(NpyError::Header(otherwise))?;
        self.rest = rest;
        Ok(text)
    }

    fn truth(&mut self) -> Result<bool, NpyError> {
        if self.take("True") {
            return Ok(true);
        }
        self.expect("False", "`fortran_order` must be True or False").map(|()| false)
    }

    fn tuple(&mut self) -> Result<Vec<usize>, NpyError> {
        const WRONG: NpyError = NpyError::Header("`shape` must be a tuple of whole numbers");
        if !self.take("(") {
            return Err(WRONG);
        }
        let mut sides = Vec::new();
        while !self.take(")") {
            let digits = self.rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(self.rest.len());
            let (number, rest) = self.rest.split_at(digits);
            sides.push(number.parse().map_err(|_| WRONG)?);
            self.rest = rest;
            if !self.take(",") && !self.rest.starts_with(')') || sides.len() > MOST_AXES {
                return Err(WRONG);
            }
        }
        Ok(sides)
    }
}
