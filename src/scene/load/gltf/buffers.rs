//! Buffers and the parts of them that accessors and images name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::document::Document;
use super::meshopt::{self, Compression};
use super::uri::{Resource, resolve};
use crate::error::Result;
use crate::files::{FILE_BYTES, read_bytes};

/// The bytes of all buffers.
#[derive(Debug)]
pub(super) struct Buffers {
    /// Index into `data`, and the bytes that count, of each buffer; nothing where the file has no data for it.
    buffers: Vec<Option<(usize, usize)>>,
    data: Vec<Vec<u8>>,
    /// The bytes of views that were compressed.
    decompressed: HashMap<usize, Vec<u8>>,
}

const MESHOPT: &str = "EXT_meshopt_compression";

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
        let mut all = Self { buffers: Vec::new(), data: Vec::new(), decompressed: HashMap::new() };
        for (index, buffer) in document.buffers.iter().enumerate() {
            let element = format!("buffers[{index}]");
            let place = match &buffer.uri {
                Some(uri) => match resolve(folder, uri).map_err(|message| document.wrong(&element, message))? {
                    Resource::Data(encoded) => {
                        all.push(encoded.decode().map_err(|message| document.wrong(&element, message))?)
                    }
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
                    // Nothing need refer to it: the views of such a buffer may have their data elsewhere, compressed.
                    None => {
                        all.buffers.push(None);
                        continue;
                    }
                },
            };
            let (claimed, given) = (buffer.byte_length.0, all.data[place].len());
            if claimed > given as u64 {
                return Err(
                    document.wrong(&element, format!("byteLength is {claimed}, and its data has {given} bytes"))
                );
            }
            all.buffers.push(Some((place, claimed as usize)));
        }
        all.decompress(document)?;
        Ok(all)
    }

    /// Decompresses the views that are compressed.
    fn decompress(&mut self, document: &Document) -> Result<()> {
        let mut total = 0;
        for (index, view) in document.buffer_views.iter().enumerate() {
            let Some(extensions) = &view.extensions else { continue };
            let place = format!("bufferViews[{index}]");
            let found: Option<Compression> = document.extension(&extensions.others, MESHOPT, &place)?;
            let Some(compression) = found else { continue };
            let bytes =
                self.bytes(document, compression.buffer, (compression.byte_offset, compression.byte_length), &place)?;
            let wrong = |message: String| document.wrong(&place, format!("extensions.{MESHOPT}: {message}"));
            compression.check().map_err(wrong)?;
            // Before it is decompressed: a byte stands for up to 64.
            let (found, claimed) = (compression.bytes(), view.byte_length.0);
            if found != claimed {
                return Err(document
                    .wrong(&place, format!("it has {found} bytes decompressed, and its byteLength is {claimed}")));
            }
            total += found;
            if total > FILE_BYTES {
                return Err(document.wrong(
                    &place,
                    format!("more than {FILE_BYTES} bytes are compressed by here, and no more are read"),
                ));
            }
            let data = meshopt::decompress(&compression, bytes).map_err(wrong)?;
            self.decompressed.insert(index, data);
        }
        Ok(())
    }

    fn push(&mut self, bytes: Vec<u8>) -> usize {
        self.data.push(bytes);
        self.data.len() - 1
    }

    /// A buffer view, for the element that refers to it.
    pub fn view(&self, document: &Document, index: usize, element: &str) -> Result<View<'_>> {
        let view = document.get(&document.buffer_views, "bufferViews", index, element)?;
        let stride = view.byte_stride.map(|stride| stride.0);
        if let Some(bytes) = self.decompressed.get(&index) {
            return Ok(View { bytes, stride });
        }
        let range = (view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0);
        Ok(View { bytes: self.bytes(document, view.buffer.value(), range, &format!("bufferViews[{index}]"))?, stride })
    }

    /// So many bytes of a buffer from a byte on, for the view of that name.
    fn bytes(&self, document: &Document, buffer: usize, (offset, size): (u64, u64), place: &str) -> Result<&[u8]> {
        let Some((data, length)) = *document.get(&self.buffers, "buffers", buffer, place)? else {
            let message = "has no uri, and the file has no binary part for it";
            return Err(document.wrong(&format!("buffers[{buffer}]"), message));
        };
        if offset.checked_add(size).is_none_or(|end| end > length as u64) {
            return Err(document.wrong(
                place,
                format!("{size} bytes from byte {offset} do not lie in buffers[{buffer}], which has {length}"),
            ));
        }
        let offset = offset as usize;
        Ok(&self.data[data][offset..offset + size as usize])
    }
}
