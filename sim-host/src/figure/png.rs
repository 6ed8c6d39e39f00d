//! From SVG to PNG, with the font on board: the same picture on a machine without fonts.

use super::FigureError;
use resvg::{tiny_skia, usvg};

/// Pixels per unit of the SVG: sharp at twice the size on screen, 200 dpi on a page.
const SCALE: f32 = 2.0;

/// Renders an SVG.
///
/// # Errors
/// An SVG that cannot be read or is empty.
pub fn png(svg: &str) -> Result<Vec<u8>, FigureError> {
    let mut options = usvg::Options {
        font_family: "DejaVu Sans".to_owned(),
        ..usvg::Options::default()
    };
    let fonts = options.fontdb_mut();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.load_font_data(dejavu::sans::bold().to_vec());
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size();
    let pixels = |length: f32| (length * SCALE).ceil() as u32;
    let mut map = tiny_skia::Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or(FigureError::Empty)?;
    let scale = tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut map.as_mut());
    map.encode_png()
        .map_err(|error| FigureError::Png(error.to_string()))
}
