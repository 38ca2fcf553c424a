//! The lines of OBJ and MTL files, as both formats have them: ended by LF, CR LF or CR, continued behind a backslash, with comments
//! behind a `#`.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

use crate::error::Result;
use crate::files::open;

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// Reads lines, and counts them.
pub(super) struct Lines {
    inner: BufReader<File>,
    /// What was read up to the last LF, and how much of it was handed on.
    chunk: Vec<u8>,
    at: usize,
    /// It holds a CR.
    has_returns: bool,
    /// Lines of the file so far.
    read: u32,
    /// The line of the file that the last one began at, from 1.
    pub number: u32,
}

impl Lines {
    /// Opens a file.
    pub fn open(path: &Path) -> Result<Self> {
        let inner = BufReader::new(open(path)?);
        Ok(Self { inner, chunk: Vec::new(), at: 0, has_returns: false, read: 0, number: 0 })
    }

    /// Puts the next line into `line`, without its end and the space around it, and with the lines that continue it; false at the end.
    pub fn next(&mut self, line: &mut Vec<u8>) -> io::Result<bool> {
        line.clear();
        if !self.append(line)? {
            return Ok(false);
        }
        self.number = self.read;
        // So much of the line has no comment: each part is searched once, however many there are.
        let mut searched = 0;
        while line.last() == Some(&b'\\') && !line[searched..].contains(&b'#') {
            line.pop();
            line.push(b' ');
            searched = line.len();
            if !self.append(line)? {
                break;
            }
        }
        Ok(true)
    }

    /// Appends a line of the file.
    fn append(&mut self, line: &mut Vec<u8>) -> io::Result<bool> {
        if self.at == self.chunk.len() {
            self.chunk.clear();
            self.at = 0;
            if self.inner.read_until(b'\n', &mut self.chunk)? == 0 {
                return Ok(false);
            }
            self.has_returns = self.chunk.contains(&b'\r');
            if self.read == 0 && self.chunk.starts_with(BYTE_ORDER_MARK) {
                self.at = BYTE_ORDER_MARK.len();
            }
        }
        self.read = self.read.saturating_add(1);
        let rest = &self.chunk[self.at..];
        let end = match self.has_returns {
            true => rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len()),
            false => rest.len() - usize::from(rest.ends_with(b"\n")),
        };
        line.extend_from_slice(rest[..end].trim_ascii());
        self.at += end + if rest[end..].starts_with(b"\r\n") { 2 } else { rest.len().min(end + 1) - end };
        Ok(true)
    }
}

/// Reads from what is read in chunks.
pub(super) fn read_from(chunks: &mut impl BufRead, out: &mut [u8]) -> io::Result<usize> {
    let available = chunks.fill_buf()?;
    let count = available.len().min(out.len());
    out[..count].copy_from_slice(&available[..count]);
    chunks.consume(count);
    Ok(count)
}

/// What stands before a comment.
pub(super) fn without_comment(text: &str) -> &str {
    text.split_once('#').map_or(text, |(before, _)| before)
}

/// The first word of a line, and what follows it.
pub(super) fn keyword(line: &str) -> (&str, &str) {
    match line.split_once(|c: char| c.is_ascii_whitespace()) {
        Some((word, rest)) => (word, rest.trim_ascii()),
        None => (line, ""),
    }
}
