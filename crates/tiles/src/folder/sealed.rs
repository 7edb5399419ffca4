//! JSON files with a checksum, which tells one that was cut off or changed from what was written.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Bytes that sealed files begin with.
pub const SEAL: &[u8] = b"{\"crc32\":\"";
const BODY: &[u8] = b"\",\"value\":";

/// Returns a value as JSON in an object that has its checksum, too.
pub fn seal(value: &impl Serialize) -> Vec<u8> {
    let value = serde_json::to_vec(value).expect("plans and records are plain data");
    let sum = format!("{:08x}", crc32fast::hash(&value));
    [SEAL, sum.as_bytes(), BODY, &value, b"}"].concat()
}

/// Returns the value of a sealed file.
///
/// # Errors
/// The fault of the file.
pub fn unseal<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let value = body(bytes).ok_or("is cut off or changed")?;
    serde_json::from_slice(value).map_err(|error| error.to_string())
}

fn body(bytes: &[u8]) -> Option<&[u8]> {
    let (sum, rest) = bytes.strip_prefix(SEAL)?.split_at_checked(8)?;
    let value = rest.strip_prefix(BODY)?.strip_suffix(b"}")?;
    let sum = u32::from_str_radix(std::str::from_utf8(sum).ok()?, 16).ok()?;
    (crc32fast::hash(value) == sum).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_cut_off_or_changed_does_not_open() {
        let sealed = seal(&[1, 20, 300]);
        assert_eq!(unseal::<Vec<u32>>(&sealed).unwrap(), [1, 20, 300]);
        assert!(serde_json::from_slice::<serde_json::Value>(&sealed).is_ok(), "it is JSON");
        for end in 0..sealed.len() {
            assert!(unseal::<Vec<u32>>(&sealed[..end]).is_err(), "{end}");
        }
        for at in 0..sealed.len() {
            let mut changed = sealed.clone();
            changed[at] ^= 1;
            // Two letters of different case are one hexadecimal digit; no bit apart here.
            assert!(unseal::<Vec<u32>>(&changed).is_err(), "{at}");
        }
    }
}
