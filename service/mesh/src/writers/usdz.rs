//! USDZ: a zip archive without compression whose files begin at multiples of 64 bytes.

use super::usd::usda;
use super::{ModelFile, picture_of, plain};
use crate::error::Error;
use crate::model3d::Model3d;

/// Where the content of each file begins.
const ALIGNMENT: usize = 64;
/// Header of the extra field that fills the gap, as Pixar's own packer names it.
const PADDING_ID: u16 = 0x1986;
/// First of January 1980, the earliest day a zip archive knows.
const DATE: u16 = (1 << 5) | 1;

/// Returns the package: the layer first, then its textures.
///
/// # Errors
/// `Model` when the model is broken.
pub fn usdz(model: &Model3d) -> Result<Vec<u8>, Error> {
    let mut files = vec![ModelFile { name: format!("{}.usda", model.name), bytes: usda(model)?.into_bytes() }];
    for material in &plain(&model.materials) {
        if let Some(picture) = picture_of(material, &model.textures)
            && files.iter().all(|f| f.name != picture.name)
        {
            files.push(ModelFile { name: picture.name, bytes: picture.bytes.to_vec() });
        }
    }
    Ok(pack(&files))
}

/// Returns files as one package, the layer that is opened first.
pub fn pack(files: &[ModelFile]) -> Vec<u8> {
    let mut out = Vec::with_capacity(files.iter().map(|f| f.bytes.len() + 256).sum());
    let mut directory = Vec::new();
    for file in files {
        let (start, sum) = (out.len(), crc32(&file.bytes));
        // 30 bytes of header, the name, 4 bytes of extra header, then padding.
        let fixed = start + 30 + file.name.len() + 4;
        let padding = fixed.next_multiple_of(ALIGNMENT) - fixed;
        let shared = |out: &mut Vec<u8>, extra: usize| {
            for v in [10, 0, 0, 0, DATE] {
                out.extend(v.to_le_bytes());
            }
            for v in [sum, file.bytes.len() as u32, file.bytes.len() as u32] {
                out.extend(v.to_le_bytes());
            }
            for v in [file.name.len() as u16, extra as u16] {
                out.extend(v.to_le_bytes());
            }
        };
        out.extend(0x0403_4b50_u32.to_le_bytes());
        shared(&mut out, padding + 4);
        out.extend(file.name.as_bytes());
        out.extend(PADDING_ID.to_le_bytes());
        out.extend((padding as u16).to_le_bytes());
        out.resize(out.len() + padding, 0);
        out.extend(&file.bytes);
        directory.extend(0x0201_4b50_u32.to_le_bytes());
        directory.extend(10_u16.to_le_bytes());
        shared(&mut directory, 0);
        // No comment, first disk, no attributes.
        directory.extend([0; 10]);
        directory.extend((start as u32).to_le_bytes());
        directory.extend(file.name.as_bytes());
    }
    let start = out.len() as u32;
    out.extend(&directory);
    out.extend(0x0605_4b50_u32.to_le_bytes());
    out.extend([0; 4]);
    for _ in 0..2 {
        out.extend((files.len() as u16).to_le_bytes());
    }
    out.extend((directory.len() as u32).to_le_bytes());
    out.extend(start.to_le_bytes());
    out.extend([0; 2]);
    out
}

/// Returns the checksum of zip archives.
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = {
        let mut table = [0; 256];
        let mut i = 0;
        while i < 256 {
            let (mut value, mut bit) = (i as u32, 0);
            while bit < 8 {
                value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
                bit += 1;
            }
            table[i] = value;
            i += 1;
        }
        table
    };
    !bytes.iter().fold(!0, |sum, b| TABLE[((sum ^ u32::from(*b)) & 255) as usize] ^ (sum >> 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_zip() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn contents_begin_at_multiples_of_64() {
        let file = |name: &str, bytes: &[u8]| ModelFile { name: name.into(), bytes: bytes.to_vec() };
        let files = [file("a.usda", b"#usda 1.0\n"), file("texture_0.png", &[7; 100]), file("x", &[])];
        let packed = pack(&files);
        let mut at = 0;
        for file in &files {
            let short = |i: usize| usize::from(u16::from_le_bytes([packed[i], packed[i + 1]]));
            assert_eq!(&packed[at..at + 4], b"PK\x03\x04");
            let content = at + 30 + short(at + 26) + short(at + 28);
            assert_eq!(content % 64, 0);
            assert_eq!(&packed[content..content + file.bytes.len()], &file.bytes[..]);
            at = content + file.bytes.len();
        }
        assert_eq!(&packed[at..at + 4], b"PK\x01\x02");
    }
}
