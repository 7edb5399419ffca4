//! Resources of a scene by number, wherever they are stored.

use meshlod_multires::{Archive, FileError, Resource, Source, pack_resource, unpack_resource};

/// Numbered resources of a scene: the head first, and then its parts.
pub(super) trait Resources {
    /// Returns the number of resources; a truncated file lacks the last ones.
    fn count(&self) -> usize;

    /// Returns true if there is a resource of this number, and all of it.
    fn has(&self, index: usize) -> Result<bool, FileError>;

    /// Reads a resource; `None` if the file lacks it.
    fn read(&self, index: usize) -> Result<Option<Vec<u8>>, FileError>;
}

impl<S: Source> Resources for Archive<S> {
    fn count(&self) -> usize {
        self.resource_count()
    }

    fn has(&self, index: usize) -> Result<bool, FileError> {
        self.has_resource(index)
    }

    fn read(&self, index: usize) -> Result<Option<Vec<u8>>, FileError> {
        self.resource(index)
    }
}

/// Resources one after the other, as compressed files have them: before each its length, `u32`.
#[derive(Clone, Debug)]
pub(super) struct JoinedResources<'b>(Vec<&'b [u8]>);

/// Bytes of the length of a resource.
const LENGTH_LEN: usize = 4;

impl<'b> JoinedResources<'b> {
    /// Finds the resources in what [`join_resources`] returned; `None` if that is damaged.
    pub fn split(mut bytes: &'b [u8]) -> Option<Self> {
        let mut all = Vec::new();
        while !bytes.is_empty() {
            let (&length, rest) = bytes.split_first_chunk::<LENGTH_LEN>()?;
            let (one, rest) = rest.split_at_checked(u32::from_le_bytes(length) as usize)?;
            all.push(one);
            bytes = rest;
        }
        Some(Self(all))
    }
}

impl Resources for JoinedResources<'_> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn has(&self, index: usize) -> Result<bool, FileError> {
        Ok(index < self.0.len())
    }

    fn read(&self, index: usize) -> Result<Option<Vec<u8>>, FileError> {
        let section = || format!("resource {index}");
        let damaged = || FileError::Section { section: section(), why: "it is damaged".into() };
        let one = self.0.get(index);
        one.map(|bytes| unpack_resource(bytes).ok_or_else(damaged)).transpose()
    }
}

/// Encodes resources one after the other, each compressed if that makes it smaller.
///
/// # Errors
/// A resource of 4 GiB or more.
pub(super) fn join_resources(resources: &[Resource]) -> Result<Vec<u8>, FileError> {
    let mut joined = Vec::new();
    for Resource { bytes, .. } in resources {
        let packed = pack_resource(bytes)?;
        let length = u32::try_from(packed.len()).map_err(|_| FileError::ResourcesTooLarge)?;
        joined.extend(length.to_le_bytes());
        joined.extend(packed);
    }
    Ok(joined)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_resources_come_back_and_parts_of_them_are_refused() {
        let resource = |bytes: Vec<u8>| Resource { bytes, after_chunks: 0 };
        let all = [resource(vec![7; 1000]), resource(Vec::new()), resource(vec![1, 2, 3])];
        let joined = join_resources(&all).unwrap();
        assert!(joined.len() < 100);
        let split = JoinedResources::split(&joined).unwrap();
        assert_eq!(split.count(), 3);
        for (index, resource) in all.iter().enumerate() {
            assert_eq!(split.read(index).unwrap().as_ref(), Some(&resource.bytes));
        }
        assert!(split.read(3).unwrap().is_none() && !split.has(3).unwrap());
        let ends: Vec<usize> = (0..=joined.len())
            .filter(|&end| JoinedResources::split(&joined[..end]).is_some())
            .collect();
        assert_eq!(ends.len(), 4, "only whole resources: {ends:?}");
        let damaged = [&1u32.to_le_bytes()[..], &[9]].concat();
        let error = JoinedResources::split(&damaged).unwrap().read(0).unwrap_err();
        assert!(error.to_string().contains("resource 0"), "{error}");
    }
}
