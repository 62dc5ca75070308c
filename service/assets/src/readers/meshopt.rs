//! The three codings of EXT_meshopt_compression, and the filter that positions may have.
//!
//! What it is not for: the octahedral and quaternion filters, which only normals, tangents and animations have: nothing
//! of these is kept.

/// Decodes attributes (mode ATTRIBUTES): `count` items of `stride` bytes.
///
/// # Errors
///
/// What is wrong with the bytes.
pub fn attributes(data: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return Err(format!("a stride of {stride} bytes is not allowed"));
    }
    match data.first() {
        Some(0xa0) => {}
        Some(0xa1) => return Err("is of version 1, which EXT_meshopt_compression does not have".into()),
        _ => return Err("does not begin as meshopt attributes do".into()),
    }
    let mut last: Vec<u8> = data.len().checked_sub(stride).and_then(|at| data.get(at..)).ok_or(CUT)?.to_vec();
    let block = ((8192 / stride) & !15).min(256);
    let mut out = vec![0u8; count.checked_mul(stride).ok_or(CUT)?];
    let mut reader = Bytes { data, at: 1 };
    let mut column = [0u8; 256];
    for begin in (0..count).step_by(block) {
        let length = block.min(count - begin);
        for (k, last) in last.iter_mut().enumerate() {
            column_of(&mut reader, &mut column[..(length + 15) & !15])?;
            for (i, delta) in column[..length].iter().enumerate() {
                *last = last.wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
                out[(begin + i) * stride + k] = *last;
            }
        }
    }
    Ok(out)
}

const CUT: &str = "is cut off";

struct Bytes<'a> {
    data: &'a [u8],
    at: usize,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count).ok_or(CUT)?;
        let bytes = self.data.get(self.at..end).ok_or(CUT)?;
        self.at = end;
        Ok(bytes)
    }

    fn byte(&mut self) -> Result<u8, String> {
        Ok(self.take(1)?[0])
    }

    /// A number of seven bits a byte.
    fn number(&mut self) -> Result<u32, String> {
        let mut value = 0u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 127) << shift;
            if byte < 128 {
                break;
            }
        }
        Ok(value)
    }

    fn index(&mut self, last: u32) -> Result<u32, String> {
        let value = self.number()?;
        Ok(last.wrapping_add((value >> 1) ^ (value & 1).wrapping_neg()))
    }
}

/// Decodes one byte of every item of a block: groups of 16 with 0, 2, 4 or 8 bits each.
fn column_of(reader: &mut Bytes, column: &mut [u8]) -> Result<(), String> {
    let header = reader.take((column.len() / 16).div_ceil(4))?;
    for (group, out) in column.chunks_exact_mut(16).enumerate() {
        let bits = header[group / 4] >> (group % 4 * 2) & 3;
        match bits {
            0 => out.fill(0),
            3 => out.copy_from_slice(reader.take(16)?),
            _ => {
                let bits = u32::from(bits) * 2;
                let packed = reader.take(2 * bits as usize)?;
                let all = (1u8 << bits) - 1;
                let per_byte = 8 / bits as usize;
                for (i, value) in out.iter_mut().enumerate() {
                    let shift = 8 - bits * (i % per_byte + 1) as u32;
                    let small = packed[i / per_byte] >> shift & all;
                    *value = if small == all { reader.byte()? } else { small };
                }
            }
        }
    }
    Ok(())
}

/// Decodes indices of triangles (mode TRIANGLES).
///
/// # Errors
///
/// What is wrong with the bytes.
pub fn triangles(data: &[u8], count: usize) -> Result<Vec<u32>, String> {
    let version = match data.first() {
        Some(byte @ (0xe0 | 0xe1)) => byte & 15,
        _ => return Err("does not begin as meshopt triangles do".into()),
    };
    if !count.is_multiple_of(3) {
        return Err(format!("{count} indices are no whole triangles"));
    }
    let codes = data.get(1..1 + count / 3).ok_or(CUT)?;
    let table_at = data.len().checked_sub(16).filter(|at| *at > count / 3).ok_or(CUT)?;
    let (body, table) = data.split_at(table_at);
    let mut reader = Bytes { data: body, at: 1 + count / 3 };
    let most = if version >= 1 { 13 } else { 15 };
    let mut state = Triangles::default();
    let mut out = Vec::with_capacity(count);
    for code in codes {
        let triangle = if *code < 0xf0 {
            state.along_edge(*code, most, &mut reader)?
        } else if *code < 0xfe {
            state.by_table(table[usize::from(code & 15)])
        } else {
            state.free(*code, &mut reader)?
        };
        out.extend(triangle);
    }
    Ok(out)
}

#[derive(Default)]
struct Triangles {
    edges: [[u32; 2]; 16],
    edge_at: usize,
    vertices: [u32; 16],
    vertex_at: usize,
    next: u32,
    last: u32,
}

impl Triangles {
    fn push_edge(&mut self, a: u32, b: u32) {
        self.edges[self.edge_at] = [a, b];
        self.edge_at = (self.edge_at + 1) & 15;
    }

    fn push_vertex(&mut self, v: u32, keep: bool) {
        self.vertices[self.vertex_at] = v;
        self.vertex_at = (self.vertex_at + usize::from(keep)) & 15;
    }

    fn vertex(&self, back: u8) -> u32 {
        self.vertices[self.vertex_at.wrapping_sub(usize::from(back)) & 15]
    }

    fn fresh(&mut self) -> u32 {
        let v = self.next;
        self.next = self.next.wrapping_add(1);
        v
    }

    fn along_edge(&mut self, code: u8, most: u8, reader: &mut Bytes) -> Result<[u32; 3], String> {
        let [a, b] = self.edges[self.edge_at.wrapping_sub(1 + usize::from(code >> 4)) & 15];
        let third = code & 15;
        let c = match third {
            0 => {
                let c = self.fresh();
                self.push_vertex(c, true);
                c
            }
            // Written again without a step, which changes nothing that is read.
            t if t < most => {
                let c = self.vertex(1 + t);
                self.push_vertex(c, false);
                c
            }
            t => {
                let c = match t {
                    15 => reader.index(self.last)?,
                    13 => self.last.wrapping_sub(1),
                    _ => self.last.wrapping_add(1),
                };
                self.last = c;
                self.push_vertex(c, true);
                c
            }
        };
        self.push_edge(c, b);
        self.push_edge(a, c);
        Ok([a, b, c])
    }

    fn by_table(&mut self, code: u8) -> [u32; 3] {
        let (second, third) = (code >> 4, code & 15);
        let (old_b, old_c) = (self.vertex(second), self.vertex(third));
        let a = self.fresh();
        let b = if second == 0 { self.fresh() } else { old_b };
        let c = if third == 0 { self.fresh() } else { old_c };
        self.done(a, (b, second == 0), (c, third == 0))
    }

    fn free(&mut self, code: u8, reader: &mut Bytes) -> Result<[u32; 3], String> {
        let more = reader.byte()?;
        let (second, third) = (more >> 4, more & 15);
        let (old_b, old_c) = (self.vertex(second), self.vertex(third));
        if more == 0 {
            self.next = 0;
        }
        let mut a = if code == 0xfe { self.fresh() } else { 0 };
        let mut b = if second == 0 { self.fresh() } else { old_b };
        let mut c = if third == 0 { self.fresh() } else { old_c };
        for (corner, explicit) in [(&mut a, code == 0xff), (&mut b, second == 15), (&mut c, third == 15)] {
            if explicit {
                *corner = reader.index(self.last)?;
                self.last = *corner;
            }
        }
        Ok(self.done(a, (b, matches!(second, 0 | 15)), (c, matches!(third, 0 | 15))))
    }

    fn done(&mut self, a: u32, (b, keep_b): (u32, bool), (c, keep_c): (u32, bool)) -> [u32; 3] {
        self.push_vertex(a, true);
        self.push_vertex(b, keep_b);
        self.push_vertex(c, keep_c);
        self.push_edge(b, a);
        self.push_edge(c, b);
        self.push_edge(a, c);
        [a, b, c]
    }
}

/// Decodes other indices (mode INDICES).
///
/// # Errors
///
/// What is wrong with the bytes.
pub fn indices(data: &[u8], count: usize) -> Result<Vec<u32>, String> {
    if !matches!(data.first(), Some(0xd0 | 0xd1)) {
        return Err("does not begin as meshopt indices do".into());
    }
    if count > data.len() {
        return Err(CUT.into());
    }
    let mut reader = Bytes { data, at: 1 };
    let mut last = [0u32; 2];
    let mut out = Vec::with_capacity(count);
    for _ in 0..count {
        let value = reader.number()?;
        let (line, value) = ((value & 1) as usize, value >> 1);
        last[line] = last[line].wrapping_add((value >> 1) ^ (value & 1).wrapping_neg());
        out.push(last[line]);
    }
    Ok(out)
}

/// Turns numbers of the exponential filter, 24 bits of mantissa below 8 of exponent, into 32-bit floats in place.
pub fn exponential(data: &mut [u8]) {
    for word in data.chunks_exact_mut(4) {
        let value = i32::from_le_bytes([word[0], word[1], word[2], word[3]]);
        let number = f64::from(value << 8 >> 8) * f64::from(value >> 24).exp2();
        word.copy_from_slice(&(number as f32).to_le_bytes());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_codec_s_own_tests_decode() {
        // Of meshoptimizer's tests (MIT): four corners of 12 bytes; two strips of triangles; a sequence.
        let column = |code: [u8; 2], more: &[u8]| [&code[..], &[0, 0, 0], more].concat();
        let half = |low: u8, next: u8| {
            let columns = [column([1, 0x3f], &[low, next, low]), column([1, 0x26], &[])];
            [columns.concat(), column([1, 0x0c], &[low]), column([1, 0x08], &[])].concat()
        };
        let vertices = [vec![0xa0], half(0x58, 0x57), vec![0; 4], half(0x17, 0x18), vec![0; 32]].concat();
        let decoded = attributes(&vertices, 4, 12).unwrap();
        let words: Vec<u16> = decoded.chunks(2).map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
        let expected = [[0; 6], [300, 0, 0, 0, 500, 0], [0, 300, 0, 0, 0, 500], [300, 300, 0, 0, 500, 500]];
        assert_eq!(words, expected.concat());
        let coded = [
            0xe0, 0xf0, 0x10, 0xfe, 0xff, 0xf0, 0x0c, 0xff, 0x02, 0x02, 0x02, 0x00, 0x76, 0x87, 0x56, 0x67, 0x78, 0xa9,
            0x86, 0x65, 0x89, 0x68, 0x98, 0x01, 0x69, 0x00, 0x00,
        ];
        assert_eq!(triangles(&coded, 12).unwrap(), [0, 1, 2, 2, 1, 3, 4, 6, 5, 7, 8, 9]);
        let sequence = [0xd1, 0x00, 0x04, 0xcd, 0x01, 0x04, 0x07, 0x98, 0x1f, 0x00, 0x00, 0x00, 0x00];
        assert_eq!(indices(&sequence, 6).unwrap(), [0, 1, 51, 2, 49, 1000]);
        for end in 0..coded.len() {
            let _ = triangles(&coded[..end], 12);
        }
        // All but the tail, which is only room to read in.
        for end in 0..vertices.len() - 32 {
            assert!(attributes(&vertices[..end], 4, 12).is_err(), "{end}");
        }
        let mut number = (((-2i32) << 24) | 6).to_le_bytes();
        exponential(&mut number);
        assert_eq!(f32::from_le_bytes(number), 1.5);
    }
}
