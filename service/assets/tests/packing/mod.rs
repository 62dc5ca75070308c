//! Models in the packings of their formats, for tests.

#![allow(dead_code, reason = "each test uses some of it")]

/// Returns JSON as a GLB without a binary chunk.
pub fn glb(json: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |v: usize| (v as u32).to_le_bytes();
    [b"glTF".as_slice(), &word(2), &word(json.len() + 20), &word(json.len()), b"JSON", &json].concat()
}

/// Returns files, the root layer first, as a USDZ package: stored, each at a multiple of 64 bytes.
pub fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut out, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in files {
        let mut crc = flate2::Crc::new();
        crc.update(content);
        let (crc, size) = (crc.sum().to_le_bytes(), (content.len() as u32).to_le_bytes());
        let length = (name.len() as u16).to_le_bytes();
        let start = out.len();
        let pad = 64 + (64 - (start + 30 + name.len()) % 64) % 64;
        let common = [[0, 0, 0, 0].as_slice(), &[0, 0, 33, 0], &crc, &size, &size, &length].concat();
        let head = [b"PK\x03\x04\x14\0".as_slice(), &common, &(pad as u16).to_le_bytes(), name.as_bytes()].concat();
        out.extend(head);
        out.resize(out.len() + pad, 0);
        out.extend(*content);
        let place = (start as u32).to_le_bytes();
        let entry = [b"PK\x01\x02\x14\0\x14\0".as_slice(), &common, &[0; 12], &place, name.as_bytes()].concat();
        directory.extend(entry);
    }
    let count = (files.len() as u16).to_le_bytes();
    let (size, start) = ((directory.len() as u32).to_le_bytes(), (out.len() as u32).to_le_bytes());
    let end = [b"PK\x05\x06\0\0\0\0".as_slice(), &count, &count, &size, &start, &[0, 0]].concat();
    [out, directory, end].concat()
}
