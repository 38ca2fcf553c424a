//! What was rendered of a reference so far, in a file beside it: an interrupted one goes on from there.
//!
//! A magic number, the length of a header in JSON, the header, the images as floats, a CRC-32 of all before it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::pilot::Tried;
use super::series::Series;
use crate::error::Result;
use crate::files::replace_file;

/// What each begins with; the digit counts up whenever what follows is laid out differently.
const MAGIC: &[u8; 8] = b"lumbreR1";

/// What was rendered so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Parts {
    /// Seconds that all of it may take.
    pub budget: f64,
    /// Seconds that were spent.
    pub spent: f64,
    /// Of these, on trying techniques.
    pub pilot_seconds: f64,
    /// The techniques that were tried, in the order of the candidates.
    pub tried: Vec<Tried>,
    /// Series by the index of the technique.
    pub series: Vec<(usize, Series)>,
}

/// The header.
#[derive(Serialize, Deserialize)]
struct Header {
    key: u64,
    spent: f64,
    budget: f64,
    pilot_seconds: f64,
    tried: Vec<Tried>,
    series: Vec<SeriesHeader>,
}

#[derive(Serialize, Deserialize)]
struct SeriesHeader {
    technique: usize,
    width: u32,
    height: u32,
    samples: Vec<f64>,
    seconds: f64,
    renderings: u32,
    is_blurred: bool,
}

/// The file of the parts of a reference.
pub(super) fn path(reference: &Path) -> PathBuf {
    let mut name = reference.as_os_str().to_owned();
    name.push(".parts");
    name.into()
}

impl Parts {
    /// The series of a technique, if it has one.
    pub fn series(&self, technique: usize) -> Option<&Series> {
        self.series.iter().find(|(index, _)| *index == technique).map(|(_, series)| series)
    }

    /// Puts a series in the place of the one that the technique has.
    pub fn put(&mut self, technique: usize, series: Series) {
        self.series.retain(|(index, _)| *index != technique);
        self.series.push((technique, series));
    }

    /// Writes them; `key` stands for what they depend on.
    pub fn write(&self, path: &Path, key: u64) -> Result<()> {
        let header = |(technique, series): &(usize, Series)| SeriesHeader {
            technique: *technique,
            width: series.width,
            height: series.height,
            samples: series.samples.clone(),
            seconds: series.seconds,
            renderings: series.renderings,
            is_blurred: series.is_blurred,
        };
        let header = Header {
            key,
            spent: self.spent,
            budget: self.budget,
            pilot_seconds: self.pilot_seconds,
            tried: self.tried.clone(),
            series: self.series.iter().map(header).collect(),
        };
        replace_file(path, |file| {
            let text = serde_json::to_vec(&header).map_err(|error| error.to_string())?;
            let mut sum = crc32fast::Hasher::new();
            let mut put = |bytes: &[u8]| {
                sum.update(bytes);
                file.write_all(bytes).map_err(|error| error.to_string())
            };
            put(MAGIC)?;
            put(&(text.len() as u32).to_le_bytes())?;
            put(&text)?;
            for image in self.series.iter().flat_map(|(_, series)| &series.images) {
                put(bytemuck::cast_slice(image))?;
            }
            let sum = sum.finalize();
            file.write_all(&sum.to_le_bytes()).map_err(|error| error.to_string())
        })
    }

    /// Reads them back; nothing where there are none, where they belong to something else, or where the file is damaged.
    pub fn read(path: &Path, key: u64) -> Option<Self> {
        let bytes = std::fs::read(path).ok()?;
        let (body, sum) = bytes.split_at(bytes.len().checked_sub(4)?);
        if crc32fast::hash(body).to_le_bytes() != sum || body.get(..8)? != MAGIC {
            return None;
        }
        let length = u32::from_le_bytes(body.get(8..12)?.try_into().ok()?) as usize;
        let header: Header = serde_json::from_slice(body.get(12..12 + length)?).ok()?;
        if header.key != key {
            return None;
        }
        let mut rest = body.get(12 + length..)?;
        let mut series = Vec::new();
        for own in header.series {
            let bytes = own.width as usize * own.height as usize * size_of::<[f32; 3]>();
            let mut images = Vec::new();
            for samples in &own.samples {
                let (image, more) = rest.split_at_checked(if *samples > 0.0 { bytes } else { 0 })?;
                rest = more;
                images.push(bytemuck::pod_collect_to_vec(image));
            }
            series.push((
                own.technique,
                Series {
                    width: own.width,
                    height: own.height,
                    images,
                    samples: own.samples,
                    seconds: own.seconds,
                    renderings: own.renderings,
                    is_blurred: own.is_blurred,
                },
            ));
        }
        Some(Self {
            spent: header.spent,
            budget: header.budget,
            pilot_seconds: header.pilot_seconds,
            tried: header.tried,
            series,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;

    #[test]
    fn they_come_back_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = path(&folder.path().join("a.exr"));
        let mut parts = Parts { spent: 3.0, pilot_seconds: 1.0, ..Parts::default() };
        let mut series = Series::new(2, 1, 4, true);
        series.add(1, &Image { width: 2, height: 1, pixels: vec![[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]] }, 8.0);
        series.renderings = 1;
        parts.put(2, series.clone());
        parts.write(&path, 77).unwrap();
        let read = Parts::read(&path, 77).unwrap();
        let back = read.series(2).unwrap();
        assert_eq!((&back.images, &back.samples, back.renderings), (&series.images, &series.samples, 1));
        assert!(back.is_blurred && read.spent == 3.0 && read.series(0).is_none());
        assert!(Parts::read(&path, 78).is_none(), "of something else");
        let mut bytes = std::fs::read(&path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        assert!(Parts::read(&path, 77).is_none(), "damaged");
    }
}
