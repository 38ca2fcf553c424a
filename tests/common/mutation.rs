//! Small changes to files, by a generator of our own, so that a failure comes again.

/// Numbers at the edges of what formats can say.
const EXTREMES: [&str; 16] = [
    "0",
    "-1",
    "1",
    "3",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "1e39",
    "-1e308",
    "1e-320",
    "nan",
];

/// Changes bytes; the same seed gives the same changes.
pub struct Mutator {
    state: u64,
}

impl Mutator {
    pub fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// SplitMix64 (Steele, Lea and Flood 2014).
    pub fn next(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`, which is 1 at least.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// One of these files with one change, or a few. The first `sound` of them come more often: a change to what is broken already
    /// does not reach far.
    pub fn mutated(&mut self, files: &[Vec<u8>], sound: usize) -> Vec<u8> {
        let among = if self.below(4) == 0 { files.len() } else { sound };
        let mut bytes = files[self.below(among)].clone();
        for _ in 0..1 + self.below(3) {
            if bytes.is_empty() {
                bytes.push(self.next() as u8);
            }
            let other = self.below(files.len());
            self.change(&mut bytes, &files[other]);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>, other: &[u8]) {
        let at = self.below(bytes.len());
        match self.below(10) {
            0 => bytes[at] ^= 1 << self.below(8),
            1 => bytes[at] = self.next() as u8,
            2 => bytes.truncate(at),
            3 => {
                let from = self.below(other.len());
                bytes.truncate(at);
                bytes.extend(&other[from.min(other.len())..]);
            }
            4 | 5 => self.number(bytes, at),
            6 => {
                // A word at a time, as counts and offsets are.
                let value = [0, 1, 0x7fff_ffff, 0x8000_0000, u64::from(u32::MAX), u64::MAX][self.below(6)];
                let size = [1, 2, 4, 8][self.below(4)].min(bytes.len() - at);
                bytes[at..at + size].copy_from_slice(&value.to_le_bytes()[..size]);
            }
            7 => {
                let line = line_at(bytes, at);
                bytes.drain(line);
            }
            8 => {
                let line = line_at(bytes, at);
                let text = bytes[line.clone()].repeat(1 + self.below(3));
                bytes.splice(line.end..line.end, text);
            }
            _ => {
                let end = (at + 1 + self.below(16)).min(bytes.len());
                bytes.drain(at..end);
            }
        }
    }

    /// Replaces the next number in the text by an extreme one.
    fn number(&mut self, bytes: &mut Vec<u8>, at: usize) {
        let Some(start) = bytes[at..].iter().position(u8::is_ascii_digit).map(|found| at + found) else { return };
        let end =
            bytes[start..].iter().position(|byte| !byte.is_ascii_digit()).map_or(bytes.len(), |found| start + found);
        let value = EXTREMES[self.below(EXTREMES.len())];
        bytes.splice(start..end, value.bytes());
    }
}

/// The line around a byte, with its end.
fn line_at(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |found| found + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |found| at + found + 1);
    start..end
}

/// An XML scene whose files are those that lie beside every input.
pub fn retargeted(text: &[u8]) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(text) else { return text.to_vec() };
    let names = [
        (".ply", "mesh.ply"),
        (".obj", "mesh.obj"),
        (".serialized", "mesh.serialized"),
        (".png", "image.png"),
        (".exr", "image.png"),
        (".xml", "part.xml"),
    ];
    let parts = text.split('"').map(|part| {
        let found = names.iter().find(|(extension, _)| part.ends_with(extension));
        found.map_or(part, |(_, name)| name)
    });
    parts.collect::<Vec<_>>().join("\"").into_bytes()
}
