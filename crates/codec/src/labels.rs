//! Names of materials and objects in files.

use crate::bytes::{Malformed, Reader};

/// Appends an optional list of names.
pub(crate) fn store_names(names: Option<&[String]>, out: &mut Vec<u8>) {
    let count = names.map_or(0, |names| names.len() as u32 + 1);
    out.extend(count.to_le_bytes());
    for name in names.into_iter().flatten() {
        out.extend((name.len() as u32).to_le_bytes());
        out.extend(name.as_bytes());
    }
}

/// Returns the number of bytes that [`store_names`] appends.
pub(crate) fn names_bytes(names: Option<&[String]>) -> usize {
    4 + names.into_iter().flatten().map(|name| 4 + name.len()).sum::<usize>()
}

/// Reads what [`store_names`] wrote.
pub(crate) fn restore_names(reader: &mut Reader) -> Result<Option<Vec<String>>, Malformed> {
    let Some(count) = reader.u32()?.checked_sub(1) else { return Ok(None) };
    let mut names = Vec::new();
    for _ in 0..count {
        let length = reader.u32()? as usize;
        let name = String::from_utf8(reader.take(length)?.to_vec());
        names.push(name.map_err(|_| reader.wrong("a name is not UTF-8"))?);
    }
    Ok(Some(names))
}
