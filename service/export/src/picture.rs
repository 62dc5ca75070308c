//! Gray pictures as PNG, for maps and masks.

use crate::error::Error;

/// Returns 8-bit gray pixels, row by row from the top, as PNG; `name` is for messages.
///
/// # Errors
/// `Picture` when the encoder refuses them: a bug of ours.
pub(crate) fn gray(name: &'static str, pixels: &[u8], width: usize, height: usize) -> Result<Vec<u8>, Error> {
    let refused = |e: png::EncodingError| Error::Picture { picture: name, reason: e.to_string() };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(refused)?;
    writer.write_image_data(pixels).map_err(refused)?;
    writer.finish().map_err(refused)?;
    Ok(bytes)
}
