//! EXT_meshopt_compression: the bytes of compressed buffer views, by the extension's description of its bitstream (version 0 of attributes,
//! 0 and 1 of indices) and of its filters. What a view claims grows only with the bytes that are there.

use serde::Deserialize;

/// What a view says of its compression.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Compression {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: String,
    #[serde(default = "no_filter")]
    filter: String,
}

impl Compression {
    /// Fails where its numbers are not those of its mode.
    pub fn check(&self) -> Result<(), String> {
        let Self { byte_stride: stride, count, .. } = *self;
        match self.mode.as_str() {
            "ATTRIBUTES" if stride % 4 != 0 || !(4..=256).contains(&stride) => {
                Err(format!("its byteStride is {stride}, and must be a multiple of 4 up to 256"))
            }
            "TRIANGLES" | "INDICES" if stride != 2 && stride != 4 => {
                Err(format!("its byteStride is {stride}, and must be 2 or 4 for indices"))
            }
            "TRIANGLES" if count % 3 != 0 => {
                Err(format!("its count is {count}, and triangles have three indices each"))
            }
            _ => Ok(()),
        }
    }

    /// Bytes of what is decompressed.
    pub fn bytes(&self) -> u64 {
        (self.count as u64).saturating_mul(self.byte_stride as u64)
    }
}

fn no_filter() -> String {
    String::from("NONE")
}

const TOO_SHORT: &str = "the compressed data end too early";

/// The decompressed bytes; the message says what is wrong.
pub(super) fn decompress(compression: &Compression, bytes: &[u8]) -> Result<Vec<u8>, String> {
    let Compression { byte_stride: stride, count, .. } = *compression;
    let mut data = match compression.mode.as_str() {
        "ATTRIBUTES" => attributes(bytes, count, stride)?,
        "TRIANGLES" => packed(&triangles(bytes, count)?, stride),
        "INDICES" => packed(&sequence(bytes, count)?, stride),
        _ => return Err(String::from("its mode is unknown: valid are ATTRIBUTES, TRIANGLES and INDICES")),
    };
    match (compression.filter.as_str(), stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => octahedral::<1>(&mut data),
        ("OCTAHEDRAL", 8) => octahedral::<2>(&mut data),
        ("QUATERNION", 8) => quaternion(&mut data),
        ("EXPONENTIAL", _) => exponential(&mut data),
        ("OCTAHEDRAL" | "QUATERNION", _) => return Err(format!("its filter is not for a byteStride of {stride}")),
        _ => return Err(String::from("its filter is unknown: valid are NONE, OCTAHEDRAL, QUATERNION and EXPONENTIAL")),
    }
    Ok(data)
}

/// Bytes that are taken from the front.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let (head, rest) = self.0.split_at_checked(count).ok_or(TOO_SHORT)?;
        self.0 = rest;
        Ok(head)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// An integer of seven bits a byte, the lowest first.
    fn variable(&mut self) -> Result<u32, String> {
        let mut value = 0u32;
        for group in 0..5 {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << (7 * group);
            if byte < 0x80 {
                break;
            }
        }
        Ok(value)
    }

    /// An index as its difference to another one.
    fn index(&mut self, last: u32) -> Result<u32, String> {
        let value = self.variable()?;
        Ok(last.wrapping_add((value >> 1) ^ (value & 1).wrapping_neg()))
    }
}

/// Elements of a group, whose differences have one number of bits.
const GROUP: usize = 16;

fn attributes(bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    let (header, bytes) = bytes.split_first().ok_or(TOO_SHORT)?;
    if *header != 0xa0 {
        return Err(format!("its attributes begin with {header:#04x}, and version 0, 0xa0, is read"));
    }
    let tail = stride.max(32);
    let (body, tail) = bytes.split_at_checked(bytes.len().wrapping_sub(tail)).ok_or(TOO_SHORT)?;
    // What the first element is a difference to.
    let mut last = tail[tail.len() - stride..].to_vec();
    let mut body = Bytes(body);
    let block = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut data = Vec::new();
    let mut deltas = [0u8; GROUP];
    while data.len() < count.saturating_mul(stride) {
        let elements = block.min(count - data.len() / stride);
        let first = data.len();
        let groups = elements.div_ceil(GROUP);
        let mut column = Vec::with_capacity(groups * GROUP * stride);
        for last in &mut last {
            let modes = body.take(groups.div_ceil(4))?;
            for group in 0..groups {
                let mode = modes[group / 4] >> (2 * (group % 4)) & 3;
                read_group(&mut body, mode, &mut deltas)?;
                for delta in deltas.iter().take(elements - group * GROUP) {
                    *last = last.wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
                    column.push(*last);
                }
            }
        }
        data.resize(first + elements * stride, 0);
        for (byte, values) in column.chunks_exact(elements).enumerate() {
            for (element, value) in values.iter().enumerate() {
                data[first + element * stride + byte] = *value;
            }
        }
    }
    Ok(data)
}

/// Differences of no bits, two, four or eight; where a smaller number has all bits set, a byte of its own follows the group.
fn read_group(body: &mut Bytes, mode: u8, deltas: &mut [u8; GROUP]) -> Result<(), String> {
    match mode {
        0 => *deltas = [0; GROUP],
        3 => deltas.copy_from_slice(body.take(GROUP)?),
        _ => {
            let bits = 2 * usize::from(mode);
            let escape = (1u8 << bits) - 1;
            let packed = body.take(GROUP * bits / 8)?;
            for (index, delta) in deltas.iter_mut().enumerate() {
                let at = index * bits;
                *delta = packed[at / 8] >> (8 - bits - at % 8) & escape;
                if *delta == escape {
                    *delta = body.byte()?;
                }
            }
        }
    }
    Ok(())
}

/// The last sixteen of something.
struct Recent<T> {
    ring: [T; 16],
    next: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { ring: [T::default(); 16], next: 0 }
    }

    fn push(&mut self, value: T) {
        self.ring[self.next] = value;
        self.next = (self.next + 1) % 16;
    }

    /// That of so many pushes ago, 1 is the last one.
    fn ago(&self, pushes: u8) -> T {
        self.ring[(self.next + 16 - usize::from(pushes)) % 16]
    }
}

/// Vertices that are new, recent, or told by a difference.
struct Vertices {
    next: u32,
    last: u32,
    recent: Recent<u32>,
}

impl Vertices {
    fn new_one(&mut self) -> u32 {
        self.next = self.next.wrapping_add(1);
        self.next.wrapping_sub(1)
    }
}

fn triangles(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let (header, bytes) = bytes.split_first().ok_or(TOO_SHORT)?;
    if header & 0xf0 != 0xe0 || header & 0x0f > 1 {
        return Err(format!("its triangles begin with {header:#04x}, and 0xe0 and 0xe1 are read"));
    }
    // Codes beyond it stand for a neighbour of the last index.
    let recent_codes = if header & 0x0f == 1 { 13 } else { 15 };
    let (codes, bytes) = bytes.split_at_checked(count / 3).ok_or(TOO_SHORT)?;
    let (data, table) = bytes.split_at_checked(bytes.len().wrapping_sub(16)).ok_or(TOO_SHORT)?;
    let mut data = Bytes(data);
    let mut vertices = Vertices { next: 0, last: 0, recent: Recent::new() };
    let mut edges: Recent<(u32, u32)> = Recent::new();
    let mut indices = Vec::with_capacity(count);
    for code in codes {
        let (high, low) = (code >> 4, code & 0x0f);
        if high < 0x0f {
            // A recent edge and a vertex.
            let (a, b) = edges.ago(high + 1);
            let is_recent = low != 0 && low < recent_codes;
            let c = match low {
                0 => vertices.new_one(),
                _ if is_recent => vertices.recent.ago(low + 1),
                15 => data.index(vertices.last)?,
                13 => vertices.last.wrapping_sub(1),
                _ => vertices.last.wrapping_add(1),
            };
            if low >= recent_codes {
                vertices.last = c;
            }
            if !is_recent {
                vertices.recent.push(c);
            }
            edges.push((c, b));
            edges.push((a, c));
            indices.extend([a, b, c]);
            continue;
        }
        // Three vertices: the first is new, or told; the others are new, recent or told.
        let is_short = low < 14;
        let pair = if is_short { table[usize::from(low)] } else { data.byte()? };
        if !is_short && pair == 0 {
            vertices.next = 0;
        }
        let kinds = [if low == 15 { 15 } else { 0 }, pair >> 4, pair & 0x0f];
        let mut corners = [0; 3];
        for (corner, kind) in corners.iter_mut().zip(kinds) {
            *corner = match kind {
                0 => vertices.new_one(),
                15 => 0,
                ago => vertices.recent.ago(ago),
            };
        }
        for (corner, kind) in corners.iter_mut().zip(kinds) {
            if kind == 15 {
                *corner = data.index(vertices.last)?;
                vertices.last = *corner;
            }
        }
        for (corner, kind) in corners.into_iter().zip(kinds) {
            if kind == 0 || kind == 15 {
                vertices.recent.push(corner);
            }
        }
        let [a, b, c] = corners;
        edges.push((b, a));
        edges.push((c, b));
        edges.push((a, c));
        indices.extend(corners);
    }
    Ok(indices)
}

fn sequence(bytes: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let (header, bytes) = bytes.split_first().ok_or(TOO_SHORT)?;
    if header & 0xf0 != 0xd0 || header & 0x0f > 1 {
        return Err(format!("its indices begin with {header:#04x}, and 0xd0 and 0xd1 are read"));
    }
    let mut data = Bytes(bytes);
    let mut last = [0u32; 2];
    let mut indices = Vec::new();
    for _ in 0..count {
        let value = data.variable()?;
        let (which, value) = ((value & 1) as usize, value >> 1);
        last[which] = last[which].wrapping_add((value >> 1) ^ (value & 1).wrapping_neg());
        indices.push(last[which]);
    }
    Ok(indices)
}

/// Indices as little-endian integers of two or four bytes.
fn packed(indices: &[u32], stride: usize) -> Vec<u8> {
    indices.iter().flat_map(|index| index.to_le_bytes().into_iter().take(stride)).collect()
}

/// Signed integers of `N` bytes.
fn component<const N: usize>(bytes: &[u8]) -> i32 {
    if N == 1 { i32::from(bytes[0] as i8) } else { i32::from(i16::from_le_bytes([bytes[0], bytes[1]])) }
}

/// Unit vectors in octahedral coordinates; the fourth component is kept.
fn octahedral<const N: usize>(data: &mut [u8]) {
    let most = if N == 1 { 127.0f32 } else { 32767.0 };
    for element in data.chunks_exact_mut(4 * N) {
        let at = |index: usize| component::<N>(&element[N * index..]) as f32;
        let one = at(2).max(1.0);
        let (mut x, mut y) = (at(0) / one, at(1) / one);
        let z = 1.0 - x.abs() - y.abs();
        let fold = z.min(0.0);
        x += if x >= 0.0 { fold } else { -fold };
        y += if y >= 0.0 { fold } else { -fold };
        let scale = most / (x * x + y * y + z * z).sqrt().max(f32::MIN_POSITIVE);
        for (index, value) in [x, y, z].into_iter().enumerate() {
            let value = (value * scale).round() as i32;
            element[N * index..N * (index + 1)].copy_from_slice(&value.to_le_bytes()[..N]);
        }
    }
}

/// Unit quaternions without their largest component, whose index is in the lowest bits of the fourth.
fn quaternion(data: &mut [u8]) {
    for element in data.chunks_exact_mut(8) {
        let at = |index: usize| component::<2>(&element[2 * index..]);
        let largest = (at(3) & 3) as usize;
        let scale = std::f32::consts::FRAC_1_SQRT_2 / (at(3) | 3) as f32;
        let rest = [0, 1, 2].map(|index| at(index) as f32 * scale);
        let square: f32 = rest.iter().map(|value| value * value).sum();
        for (turn, value) in [(1.0 - square).max(0.0).sqrt(), rest[0], rest[1], rest[2]].into_iter().enumerate() {
            let index = (largest + turn) % 4;
            let value = (value * 32767.0).round() as i16;
            element[2 * index..2 * index + 2].copy_from_slice(&value.to_le_bytes());
        }
    }
}

/// Numbers as an exponent of eight bits and a mantissa of 24, both signed.
fn exponential(data: &mut [u8]) {
    for element in data.chunks_exact_mut(4) {
        let bits = i32::from_le_bytes([element[0], element[1], element[2], element[3]]);
        let (exponent, mantissa) = (bits >> 24, (bits << 8) >> 8);
        let value = f64::from(mantissa) * f64::from(exponent).exp2();
        element.copy_from_slice(&(value as f32).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;
    use serde_json::Value;

    use super::*;

    /// A grid and some triangles across it, as meshoptimizer 0.22 encodes them, and filtered numbers with what its decoder makes of them.
    const ENCODED: &str = include_str!("../../../../tests/inputs/meshopt.json");
    const SIDE: usize = 17;

    fn compression(mode: &str, count: usize, byte_stride: usize, filter: &str) -> Compression {
        let (mode, filter) = (mode.to_owned(), filter.to_owned());
        Compression { buffer: 0, byte_offset: 0, byte_length: 0, byte_stride, count, mode, filter }
    }

    fn encoded(name: &[&str]) -> Vec<u8> {
        let all: Value = serde_json::from_str(ENCODED).unwrap();
        let value = name.iter().fold(&all, |value, name| &value[*name]);
        STANDARD.decode(value.as_str().unwrap()).unwrap()
    }

    fn grid() -> (Vec<u8>, Vec<u32>) {
        let vertex = |at: usize| {
            let (x, y) = (at % SIDE, at / SIDE);
            [x as f32 / 4.0, y as f32 / 4.0, ((x * 7 + y * 13) % 11) as f32 / 16.0]
        };
        let positions = (0..SIDE * SIDE).flat_map(vertex).flat_map(f32::to_le_bytes).collect();
        let mut indices = Vec::new();
        for (y, x) in (0..SIDE as u32 - 1).flat_map(|y| (0..SIDE as u32 - 1).map(move |x| (y, x))) {
            let (a, n) = (y * SIDE as u32 + x, SIDE as u32);
            indices.extend([a, a + 1, a + n + 1, a, a + n + 1, a + n]);
        }
        indices.extend([0, 288, 200, 5, 250, 288, 17, 280, 42]);
        (positions, indices)
    }

    #[test]
    fn vertices_and_indices_come_back() {
        let (positions, indices) = grid();
        let count = SIDE * SIDE;
        let found = decompress(&compression("ATTRIBUTES", count, 12, "NONE"), &encoded(&["positions"])).unwrap();
        assert!(found == positions);
        let sequence = compression("INDICES", indices.len(), 4, "NONE");
        assert!(decompress(&sequence, &encoded(&["sequence"])).unwrap() == packed(&indices, 4));
        // The corners of a triangle may be turned.
        let normal = |indices: Vec<u32>| -> Vec<[u32; 3]> {
            let turned = |t: &[u32]| {
                let least = (0..3).min_by_key(|corner| t[*corner]).unwrap();
                [t[least], t[(least + 1) % 3], t[(least + 2) % 3]]
            };
            indices.chunks_exact(3).map(turned).collect()
        };
        for stride in [2, 4] {
            let bytes = decompress(&compression("TRIANGLES", indices.len(), stride, "NONE"), &encoded(&["triangles"]));
            let word = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
            let found: Vec<u32> = bytes.unwrap().chunks_exact(stride).map(word).collect();
            assert!(normal(found) == normal(indices.clone()), "{stride}");
        }
    }

    #[test]
    fn filters_give_what_meshoptimizer_does() {
        for name in ["oct8", "oct16", "quat", "exp"] {
            let all: Value = serde_json::from_str(ENCODED).unwrap();
            let (filter, stride) = (all[name]["filter"].as_str().unwrap(), all[name]["stride"].as_u64().unwrap());
            let found = decompress(&compression("ATTRIBUTES", 6, stride as usize, filter), &encoded(&[name, "enc"]));
            assert_eq!(found.unwrap(), encoded(&[name, "out"]), "{name}");
        }
    }

    /// Cut short anywhere, or with any byte changed, they end without a panic; and a claim of many elements takes no more than the bytes
    /// that are there.
    #[test]
    fn broken_data_are_refused_or_read() {
        for (mode, name, count, stride) in [
            ("ATTRIBUTES", "positions", 289, 12),
            ("TRIANGLES", "triangles", 1545, 4),
            ("INDICES", "sequence", 1545, 2),
        ] {
            let bytes = encoded(&[name]);
            let claims = compression(mode, count, stride, "NONE");
            for length in 0..40 {
                assert!(decompress(&claims, &bytes[..length]).is_err(), "{mode} {length}");
            }
            for at in 0..bytes.len() {
                let mut bytes = bytes.clone();
                bytes[at] ^= 0x55;
                let _ = decompress(&claims, &bytes);
            }
            let too_many = compression(mode, usize::MAX / 12 * 3, stride, "NONE");
            assert!(decompress(&too_many, &bytes).is_err(), "{mode}");
        }
    }
}
