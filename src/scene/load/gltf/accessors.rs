//! Numbers in buffers: of any component type, interleaved, normalised or sparse.

use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;

use super::buffers::Buffers;
use super::document::Document;
use crate::error::Result;
use crate::scene::load::limits::ZEROS;

/// Vertices beyond this would not survive single precision's arithmetic.
const MAX_VALUE: f32 = 1e18;

/// Reads accessors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Accessors<'a> {
    pub document: &'a Document,
    pub buffers: &'a Buffers,
}

/// Equally spaced elements of one size.
struct Run<'a> {
    bytes: &'a [u8],
    offset: usize,
    stride: usize,
    size: usize,
}

impl Run<'_> {
    fn element(&self, index: usize) -> &[u8] {
        let first = self.offset + index * self.stride;
        &self.bytes[first..first + self.size]
    }
}

fn bytes_of(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn name_of(kind: Type) -> &'static str {
    match kind {
        Type::Scalar => "SCALAR",
        Type::Vec2 => "VEC2",
        Type::Vec3 => "VEC3",
        Type::Vec4 => "VEC4",
        Type::Mat2 => "MAT2",
        Type::Mat3 => "MAT3",
        Type::Mat4 => "MAT4",
    }
}

/// One component as a number; normalised integers as glTF 2.0, section 3.6.2.2, says.
fn number(component: ComponentType, normalised: bool, bytes: &[u8]) -> f32 {
    let low = |index: usize| bytes.get(index).copied().unwrap_or_default();
    let (value, one) = match component {
        ComponentType::I8 => (f32::from(low(0) as i8), 127.0),
        ComponentType::U8 => (f32::from(low(0)), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes([low(0), low(1)])), 32767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes([low(0), low(1)])), 65535.0),
        ComponentType::U32 => (u32::from_le_bytes([low(0), low(1), low(2), low(3)]) as f32, 4_294_967_295.0),
        ComponentType::F32 => return f32::from_le_bytes([low(0), low(1), low(2), low(3)]),
    };
    if normalised { (value / one).max(-1.0) } else { value }
}

fn index_of(component: ComponentType, bytes: &[u8]) -> u32 {
    let low = |index: usize| bytes.get(index).copied().unwrap_or_default();
    match component {
        ComponentType::U8 => u32::from(low(0)),
        ComponentType::U16 => u32::from(u16::from_le_bytes([low(0), low(1)])),
        _ => u32::from_le_bytes([low(0), low(1), low(2), low(3)]),
    }
}

impl<'a> Accessors<'a> {
    fn get(&self, index: usize, element: &str) -> Result<(&'a Accessor, Type, ComponentType)> {
        let accessor = self.document.get(&self.document.accessors, "accessors", index, element)?;
        let (Checked::Valid(kind), Checked::Valid(component)) = (&accessor.type_, &accessor.component_type) else {
            return Err(self.document.wrong(&format!("accessors[{index}]"), "its type or componentType is unknown"));
        };
        Ok((accessor, *kind, component.0))
    }

    /// `count` elements of `size` bytes from `offset` of a buffer view.
    fn run(&self, view: usize, offset: u64, count: u64, size: usize, element: &str) -> Result<Run<'a>> {
        let index = view;
        let view = self.buffers.view(self.document, view, element)?;
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            return Err(self.document.wrong(
                element,
                format!("bufferViews[{index}] has a byteStride of {stride}, and an element takes {size} bytes"),
            ));
        }
        let end = match count {
            0 => Some(0),
            _ => (count - 1)
                .checked_mul(stride as u64)
                .and_then(|bytes| bytes.checked_add(size as u64))
                .and_then(|bytes| bytes.checked_add(offset)),
        };
        if end.is_none_or(|end| end > view.bytes.len() as u64) {
            return Err(self.document.wrong(
                element,
                format!(
                    "{count} elements of {size} bytes, {stride} apart from byte {offset}, do not lie in bufferViews[{index}], which has {} bytes",
                    view.bytes.len()
                ),
            ));
        }
        Ok(Run { bytes: view.bytes, offset: offset as usize, stride, size })
    }

    /// The number of elements, and where they lie; nothing where they are zeros to be replaced sparsely.
    fn dense(&self, accessor: &Accessor, element: &str, size: usize) -> Result<(usize, Option<Run<'a>>)> {
        let count = accessor.count.0;
        match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let run = self.run(view.value(), offset, count, size, element)?;
                Ok((count as usize, Some(run)))
            }
            None if count <= ZEROS => Ok((count as usize, None)),
            None => Err(self.document.wrong(
                element,
                format!("has {count} elements and no bufferView: of those, {ZEROS} are the most that are read"),
            )),
        }
    }

    /// Calls `replace` with the index and the bytes of each element that a sparse accessor replaces.
    fn replaced(
        &self,
        accessor: &Accessor,
        element: &str,
        size: usize,
        mut replace: impl FnMut(usize, &[u8]),
    ) -> Result<()> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let Checked::Valid(component) = &sparse.indices.component_type else {
            return Err(self.document.wrong(element, "sparse.indices.componentType is unknown"));
        };
        let (component, count) = (component.0, sparse.count.0);
        if count > accessor.count.0 {
            return Err(self.document.wrong(
                element,
                format!("sparse.count is {count}, and the accessor has {} elements", accessor.count.0),
            ));
        }
        let indices = &sparse.indices;
        let places = self.run(
            indices.buffer_view.value(),
            indices.byte_offset.0,
            count,
            bytes_of(component),
            &format!("{element}: sparse.indices"),
        )?;
        let values = &sparse.values;
        let values = self.run(
            values.buffer_view.value(),
            values.byte_offset.0,
            count,
            size,
            &format!("{element}: sparse.values"),
        )?;
        for index in 0..count as usize {
            let place = index_of(component, places.element(index));
            if u64::from(place) >= accessor.count.0 {
                return Err(self.document.wrong(
                    element,
                    format!("sparse.indices replaces element {place}, and there are {}", accessor.count.0),
                ));
            }
            replace(place as usize, values.element(index));
        }
        Ok(())
    }

    /// The elements as vectors. `kinds` says which types and `components` which component types are allowed; a type with
    /// fewer components than `N` leaves the last at `rest`. `element` is what refers to it.
    pub fn vectors<const N: usize>(
        &self,
        index: usize,
        element: &str,
        kinds: &[Type],
        components: &[ComponentType],
        rest: f32,
    ) -> Result<Vec<[f32; N]>> {
        let (accessor, kind, component) = self.get(index, element)?;
        let element = format!("{element}: accessor {index}");
        if !kinds.contains(&kind) || !components.contains(&component) {
            let wanted: Vec<&str> = kinds.iter().map(|kind| name_of(*kind)).collect();
            return Err(self.document.wrong(
                &element,
                format!(
                    "is a {} of {component:?}, and must be {} of {}",
                    name_of(kind),
                    crate::error::one_of(wanted),
                    crate::error::one_of(components.iter().map(|component| format!("{component:?}")))
                ),
            ));
        }
        let (width, per) = (kind.multiplicity().min(N), bytes_of(component));
        let size = kind.multiplicity() * per;
        let decode = |bytes: &[u8]| {
            let mut vector = [rest; N];
            for (value, bytes) in vector.iter_mut().zip(bytes.chunks_exact(per)).take(width) {
                *value = number(component, accessor.normalized, bytes);
            }
            vector
        };
        let (count, run) = self.dense(accessor, &element, size)?;
        let zero = vec![0; size];
        let mut vectors: Vec<[f32; N]> = match run {
            Some(run) => (0..count).map(|index| decode(run.element(index))).collect(),
            None => vec![decode(&zero); count],
        };
        self.replaced(accessor, &element, size, |index, bytes| vectors[index] = decode(bytes))?;
        let bad =
            vectors.iter().position(|vector| vector.iter().any(|value| value.is_nan() || value.abs() > MAX_VALUE));
        if let Some(bad) = bad {
            return Err(self.document.wrong(
                &element,
                format!("element {bad} is {:?}: numbers must be finite and at most {MAX_VALUE:e}", vectors[bad]),
            ));
        }
        Ok(vectors)
    }

    /// The elements as indices of vertices.
    pub fn indices(&self, index: usize, element: &str) -> Result<Vec<u32>> {
        let (accessor, kind, component) = self.get(index, element)?;
        let element = format!("{element}: accessor {index}");
        let allowed = [ComponentType::U8, ComponentType::U16, ComponentType::U32];
        if kind != Type::Scalar || !allowed.contains(&component) {
            return Err(self.document.wrong(
                &element,
                format!("is a {} of {component:?}, and indices are a SCALAR of U8, U16 or U32", name_of(kind)),
            ));
        }
        let size = bytes_of(component);
        let (count, run) = self.dense(accessor, &element, size)?;
        let mut indices = match run {
            Some(run) => (0..count).map(|index| index_of(component, run.element(index))).collect(),
            None => vec![0; count],
        };
        self.replaced(accessor, &element, size, |place, bytes| indices[place] = index_of(component, bytes))?;
        Ok(indices)
    }
}
