//! Numbers out of buffers: views, strides, kinds of components, sparse changes and meshopt compression.

use std::collections::BTreeMap;

use base64::Engine;

use super::document::{Accessor, Document, Image, Meshopt};
use crate::readers::builder::MAX_POINTS;
use crate::readers::facts::Refusal;
use crate::readers::folder::{Folder, MAX_FILE_BYTES};
use crate::readers::meshopt;

/// The most bytes of a compressed view when unpacked.
const MAX_UNPACKED: usize = 256 << 20;

/// The buffers of a document, read when they are needed.
pub struct Buffers<'a> {
    document: &'a Document,
    binary: Option<&'a [u8]>,
    folder: &'a Folder,
    loaded: BTreeMap<usize, Vec<u8>>,
    unpacked: BTreeMap<usize, Vec<u8>>,
}

/// Returns what a normalized integer is divided by.
pub fn full_scale(component: u32) -> f64 {
    match component {
        5120 => 127.0,
        5121 => 255.0,
        5122 => 32767.0,
        5123 => 65535.0,
        _ => 1.0,
    }
}

fn size_of(component: u32) -> Option<usize> {
    match component {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        5130 => Some(8),
        _ => None,
    }
}

fn number(bytes: &[u8], component: u32) -> f64 {
    match (component, bytes) {
        (5120, &[a, ..]) => f64::from(a as i8),
        (5121, &[a, ..]) => f64::from(a),
        (5122, &[a, b, ..]) => f64::from(i16::from_le_bytes([a, b])),
        (5123, &[a, b, ..]) => f64::from(u16::from_le_bytes([a, b])),
        (5125, &[a, b, c, d, ..]) => f64::from(u32::from_le_bytes([a, b, c, d])),
        (5126, &[a, b, c, d, ..]) => f64::from(f32::from_le_bytes([a, b, c, d])),
        (5130, bytes) => bytes.try_into().map_or(f64::NAN, f64::from_le_bytes),
        _ => f64::NAN,
    }
}

impl<'a> Buffers<'a> {
    /// Returns the buffers of a document, of which the first may be the binary chunk of a GLB.
    pub fn new(document: &'a Document, binary: Option<&'a [u8]>, folder: &'a Folder) -> Self {
        Self { document, binary, folder, loaded: BTreeMap::new(), unpacked: BTreeMap::new() }
    }

    /// Returns the document.
    pub fn document(&self) -> &'a Document {
        self.document
    }

    /// Tells whether a file is there and may be read.
    pub fn is_there(&self, uri: &str) -> bool {
        self.folder.resolve(&decoded(uri)).is_some()
    }

    /// Returns the content of a picture, when it is there and has at most so many bytes.
    pub fn image(&mut self, image: &Image, most: u64) -> Option<Vec<u8>> {
        match (&image.uri, image.buffer_view) {
            (_, Some(view)) => {
                let length = self.document.buffer_views.get(view)?.byte_length;
                (length as u64 <= most).then(|| self.view(view).ok().map(<[u8]>::to_vec))?
            }
            (Some(uri), None) if uri.starts_with("data:") => data(uri).ok(),
            (Some(uri), None) => self.folder.read(&decoded(uri), most).ok(),
            (None, None) => None,
        }
    }

    /// Returns a part of a buffer.
    fn part(&mut self, index: usize, offset: usize, length: usize) -> Result<&[u8], Refusal> {
        let buffer =
            self.document.buffers.get(index).ok_or_else(|| format!("names buffer {index}, which is not there"))?;
        if let (Some(uri), false) = (&buffer.uri, self.loaded.contains_key(&index)) {
            let bytes = if uri.starts_with("data:") {
                data(uri).map_err(|e| format!("buffer {index} in its text {e}"))?
            } else {
                self.folder.read(&decoded(uri), MAX_FILE_BYTES)?
            };
            self.loaded.insert(index, bytes);
        }
        let bytes = match self.loaded.get(&index) {
            Some(bytes) => bytes.as_slice(),
            None if index == 0 => self.binary.ok_or("has no binary chunk, which its first buffer should be")?,
            None => return Err(format!("buffer {index} has no content").into()),
        };
        let end = bytes.len().min(buffer.byte_length);
        let part = offset.checked_add(length).filter(|e| *e <= end).and_then(|e| bytes.get(offset..e));
        part.ok_or_else(|| format!("reads {length} bytes at {offset} of buffer {index}, which has {end}").into())
    }

    /// Returns the content of a view, unpacked.
    fn view(&mut self, index: usize) -> Result<&[u8], Refusal> {
        let view = self
            .document
            .buffer_views
            .get(index)
            .ok_or_else(|| format!("names buffer view {index}, which is not there"))?;
        let Some(packed) = &view.extensions.meshopt else {
            return self.part(view.buffer, view.byte_offset, view.byte_length);
        };
        if !self.unpacked.contains_key(&index) {
            let bytes = self.part(packed.buffer, packed.byte_offset, packed.byte_length)?;
            let bytes = unpack(packed, bytes).map_err(|e| format!("its compressed buffer view {index} {e}"))?;
            self.unpacked.insert(index, bytes);
        }
        Ok(self.unpacked.get(&index).map_or(&[], Vec::as_slice))
    }

    /// Reads `count` items of `width` numbers each.
    fn items(
        &mut self,
        (view, offset): (usize, usize),
        component: u32,
        (count, width): (usize, usize),
        mut each: impl FnMut(usize, &[u8], usize),
    ) -> Result<(), Refusal> {
        let size = size_of(component).ok_or_else(|| format!("has components of the unknown type {component}"))?;
        let stride = self.document.buffer_views.get(view).map(|v| match &v.extensions.meshopt {
            Some(packed) => packed.byte_stride,
            None => v.byte_stride.unwrap_or(0),
        });
        let stride = stride.filter(|s| *s > 0).unwrap_or(size * width);
        let bytes = self.view(view)?;
        let needed =
            count.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(offset)?.checked_add(size * width));
        if count > 0 && needed.is_none_or(|n| n > bytes.len()) {
            return Err(format!("reads {count} items past the end of buffer view {view}").into());
        }
        for item in 0..count {
            let at = offset + item * stride;
            each(item, bytes.get(at..at + size * width).unwrap_or_default(), size);
        }
        Ok(())
    }

    /// Returns the numbers of an accessor of vectors of `N`.
    ///
    /// # Errors
    ///
    /// When it reads past its buffer, is of another shape, or has too many items.
    pub fn floats<const N: usize>(&mut self, index: usize) -> Result<Vec<[f32; N]>, Refusal> {
        let accessor = self.accessor(index)?;
        let shape = ["SCALAR", "VEC2", "VEC3", "VEC4"].get(N - 1);
        if shape != Some(&accessor.shape.as_str()) {
            let found = crate::readers::folder::shortened(&accessor.shape);
            return Err(format!("accessor {index} is {found}, should be {}", shape.unwrap_or(&"")).into());
        }
        let mut out = vec![[0f32; N]; accessor.count];
        let full = if accessor.normalized { full_scale(accessor.component_type) } else { 1.0 };
        let read = |bytes: &[u8], size: usize| -> [f32; N] {
            std::array::from_fn(|i| {
                let value = number(bytes.get(i * size..(i + 1) * size).unwrap_or_default(), accessor.component_type);
                if accessor.normalized { (value / full).max(-1.0) as f32 } else { value as f32 }
            })
        };
        if let Some(view) = accessor.buffer_view {
            let from = (view, accessor.byte_offset);
            self.items(from, accessor.component_type, (accessor.count, N), |i, bytes, size| {
                out[i] = read(bytes, size)
            })?;
        }
        if let Some(sparse) = &accessor.sparse {
            let count = sparse.count.min(accessor.count);
            let mut places = vec![0usize; count];
            let from = (sparse.indices.buffer_view, sparse.indices.byte_offset);
            let component = sparse.indices.component_type;
            self.items(from, component, (count, 1), |i, bytes, _| places[i] = number(bytes, component) as usize)?;
            let from = (sparse.values.buffer_view, sparse.values.byte_offset);
            self.items(from, accessor.component_type, (count, N), |i, bytes, size| {
                if let Some(place) = out.get_mut(places[i]) {
                    *place = read(bytes, size);
                }
            })?;
        }
        Ok(out)
    }

    /// Returns the indices of an accessor.
    ///
    /// # Errors
    ///
    /// As of [`Buffers::floats`].
    pub fn indices(&mut self, index: usize) -> Result<Vec<u32>, Refusal> {
        let accessor = self.accessor(index)?;
        let Some(view) = accessor.buffer_view else { return Ok(vec![0; accessor.count]) };
        let mut out = vec![0u32; accessor.count];
        let component = accessor.component_type;
        let from = (view, accessor.byte_offset);
        self.items(from, component, (accessor.count, 1), |i, bytes, _| out[i] = number(bytes, component) as u32)?;
        Ok(out)
    }

    /// Returns an accessor whose items fit into its buffer view.
    ///
    /// # Errors
    ///
    /// When it is not there, or says that it has more items than there can be.
    pub fn accessor(&self, index: usize) -> Result<&'a Accessor, Refusal> {
        let accessor = self.document.accessors.get(index);
        let accessor = accessor.ok_or_else(|| format!("names accessor {index}, which is not there"))?;
        // Without a view all is 0, so that a short text could ask for any amount of memory.
        if accessor.count > 3 * MAX_POINTS || accessor.buffer_view.is_none() && accessor.count > MAX_POINTS / 8 {
            return Err(format!("accessor {index} says that it has {} items", accessor.count).into());
        }
        // Before memory is taken: so many items must fit into the view.
        let view = accessor.buffer_view.map(|v| self.document.buffer_views.get(v));
        match view {
            Some(None) => Err(format!("accessor {index} names a buffer view that is not there").into()),
            Some(Some(view)) if view.extensions.meshopt.is_none() && view.byte_length < accessor.count => {
                Err(format!("accessor {index} reads past the end of its buffer view").into())
            }
            _ => Ok(accessor),
        }
    }
}

fn unpack(packed: &Meshopt, bytes: &[u8]) -> Result<Vec<u8>, String> {
    // The best case of the coding is about one byte for 64 of attributes, and one for a triangle.
    let length = packed.count.checked_mul(packed.byte_stride).filter(|l| *l <= MAX_UNPACKED);
    length.filter(|l| l / 64 <= bytes.len()).ok_or("says that it has more than can be packed into it")?;
    let words = |values: Vec<u32>| -> Vec<u8> {
        match packed.byte_stride {
            2 => values.into_iter().flat_map(|v| (v as u16).to_le_bytes()).collect(),
            _ => values.into_iter().flat_map(u32::to_le_bytes).collect(),
        }
    };
    match packed.mode.as_str() {
        "ATTRIBUTES" => {
            let mut out = meshopt::attributes(bytes, packed.count, packed.byte_stride)?;
            if packed.filter.as_deref() == Some("EXPONENTIAL") {
                meshopt::exponential(&mut out);
            }
            Ok(out)
        }
        "TRIANGLES" => meshopt::triangles(bytes, packed.count).map(words),
        "INDICES" => meshopt::indices(bytes, packed.count).map(words),
        other => Err(format!("has the unknown mode {}", crate::readers::folder::shortened(other))),
    }
}

/// Returns the content of a `data:` address.
fn data(uri: &str) -> Result<Vec<u8>, String> {
    let (kind, content) = uri.split_once(',').ok_or("has no comma")?;
    if !kind.ends_with(";base64") {
        return Ok(percent_decoded(content));
    }
    let engine = base64::engine::general_purpose::GeneralPurpose::new(
        &base64::alphabet::STANDARD,
        base64::engine::general_purpose::GeneralPurposeConfig::new()
            .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent),
    );
    engine.decode(content).map_err(|e| format!("is no base64: {e}"))
}

/// Returns a path as it is on disk: `%20` is a blank.
pub fn decoded(uri: &str) -> String {
    String::from_utf8_lossy(&percent_decoded(uri)).into_owned()
}

fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while let Some(&byte) = bytes.get(at) {
        let code =
            (byte == b'%').then(|| text.get(at + 1..at + 3)).flatten().and_then(|c| u8::from_str_radix(c, 16).ok());
        out.push(code.unwrap_or(byte));
        at += if code.is_some() { 3 } else { 1 };
    }
    out
}
