//! Resources attached to a `.mlod` file, and read from it.

use super::FileError;
use super::archive::Archive;
use super::header::{Header, Section};
use super::resources::{self, Resource, ResourceEntry};
use super::source::Source;

impl Archive<Vec<u8>> {
    /// Attaches resources, such as materials and images, which mean nothing to the model itself.
    /// Each lies after as many chunks as it says, so that a truncated file has those at its start; of
    /// equal ones the first comes first.
    ///
    /// What was attached before is replaced. Cost: linear; resources are compressed where that
    /// helps.
    /// # Errors
    /// A resource of 4 GiB or more.
    pub fn with_resources(self, resources: &[Resource]) -> Result<Self, FileError> {
        let all = self.header.chunks.len();
        let mut packed = Vec::with_capacity(resources.len());
        for resource in resources {
            let bytes = resources::pack_resource(&resource.bytes)?;
            let after = resource.after_chunks.min(all) as u32;
            packed.push((ResourceEntry { stored: Section::of(&bytes), after }, bytes));
        }
        packed.sort_by_key(|(entry, _)| entry.after);
        let base = &self.source[self.header.len() as usize..self.layout.base_end as usize];
        let entries = packed.iter().map(|(entry, _)| *entry).collect();
        let header = Header { resources: entries, has_old_resources: false, ..self.header.clone() };
        let mut out = [&header.to_bytes(), base].concat();
        let mut rest = packed.iter().peekable();
        for before in 0..=all {
            while let Some((_, bytes)) = rest.next_if(|(entry, _)| entry.after as usize <= before) {
                out.extend(bytes);
            }
            if let Some(&start) = self.layout.chunks.get(before) {
                let length = self.header.chunks[before].stored.bytes as usize;
                out.extend(&self.source[start as usize..][..length]);
            }
        }
        Self::open(out)
    }
}

impl<S: Source> Archive<S> {
    /// Returns the number of resources [attached](Archive::with_resources) to the file, including any
    /// that are cut off.
    pub fn resource_count(&self) -> usize {
        if self.header.has_old_resources { 0 } else { self.header.resources.len() }
    }

    /// Returns true if the file has materials in a form that only earlier versions read.
    pub fn has_old_resources(&self) -> bool {
        self.header.has_old_resources
    }

    /// Returns true if there is a resource of this number and the file does not end before it does.
    /// # Errors
    /// The length of the file cannot be read.
    pub fn has_resource(&self, index: usize) -> Result<bool, FileError> {
        if index >= self.resource_count() {
            return Ok(false);
        }
        let end =
            self.layout.resources[index] + u64::from(self.header.resources[index].stored.bytes);
        Ok(end <= self.source.length()?)
    }

    /// Reads a resource by its place in the file; `None` if there is no such resource or the file
    /// ends before it does.
    /// # Errors
    /// A file that is damaged.
    pub fn resource(&self, index: usize) -> Result<Option<Vec<u8>>, FileError> {
        if !self.has_resource(index)? {
            return Ok(None);
        }
        let (entry, start) = (self.header.resources[index], self.layout.resources[index]);
        let name = || format!("resource {index}");
        let bytes = resources::unpack_resource(&self.read_section(start, entry.stored, name)?);
        let damaged = || FileError::Section { section: name(), why: "it is damaged".into() };
        bytes.ok_or_else(damaged).map(Some)
    }
}
