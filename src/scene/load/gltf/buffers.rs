//! Buffers and the parts of them that accessors and images name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::document::Document;
use super::uri::{Resource, resolve};
use crate::error::Result;
use crate::files::{FILE_BYTES, read_bytes};

/// The bytes of all buffers.
#[derive(Debug)]
pub(super) struct Buffers {
    /// Index into `data`, and the bytes that count, of each buffer.
    buffers: Vec<(usize, usize)>,
    data: Vec<Vec<u8>>,
}

/// A part of a buffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct View<'a> {
    /// Its bytes.
    pub bytes: &'a [u8],
    /// Bytes from one element to the next, where the file says so.
    pub stride: Option<usize>,
}

impl Buffers {
    /// Reads them all; a file that several name is read once.
    pub fn read(document: &Document) -> Result<Self> {
        let folder = document.path.parent().unwrap_or(Path::new(""));
        let mut files: HashMap<PathBuf, usize> = HashMap::new();
        let mut all = Self { buffers: Vec::new(), data: Vec::new() };
        for (index, buffer) in document.buffers.iter().enumerate() {
            let element = format!("buffers[{index}]");
            let place = match &buffer.uri {
                Some(uri) => match resolve(folder, uri).map_err(|message| document.wrong(&element, message))? {
                    Resource::Data(bytes) => all.push(bytes),
                    Resource::File(path) => match files.get(&path) {
                        Some(place) => *place,
                        None => {
                            let place = all.push(read_bytes(&path, FILE_BYTES)?);
                            files.insert(path, place);
                            place
                        }
                    },
                },
                None => match document.binary.as_ref().filter(|_| index == 0) {
                    Some(bytes) => all.push(bytes.clone()),
                    None => return Err(document.wrong(&element, "has no uri, and the file has no binary part for it")),
                },
            };
            let (claimed, given) = (buffer.byte_length.0, all.data[place].len());
            if claimed > given as u64 {
                return Err(
                    document.wrong(&element, format!("byteLength is {claimed}, and its data has {given} bytes"))
                );
            }
            all.buffers.push((place, claimed as usize));
        }
        Ok(all)
    }

    fn push(&mut self, bytes: Vec<u8>) -> usize {
        self.data.push(bytes);
        self.data.len() - 1
    }

    /// A buffer view, for the element that refers to it.
    pub fn view(&self, document: &Document, index: usize, element: &str) -> Result<View<'_>> {
        let view = document.get(&document.buffer_views, "bufferViews", index, element)?;
        let place = format!("bufferViews[{index}]");
        let (data, length) = *document.get(&self.buffers, "buffers", view.buffer.value(), &place)?;
        let offset = view.byte_offset.map_or(0, |offset| offset.0);
        let size = view.byte_length.0;
        if offset.checked_add(size).is_none_or(|end| end > length as u64) {
            let buffer = view.buffer.value();
            return Err(document.wrong(
                &place,
                format!("{size} bytes from byte {offset} do not lie in buffers[{buffer}], which has {length}"),
            ));
        }
        let offset = offset as usize;
        Ok(View {
            bytes: &self.data[data][offset..offset + size as usize],
            stride: view.byte_stride.map(|stride| stride.0),
        })
    }
}
