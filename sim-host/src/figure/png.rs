//! From SVG to PNG, with the font on board: the same picture on a machine without fonts.

use super::FigureError;
use resvg::{tiny_skia, usvg};

/// Pixels per unit of the SVG: sharp at twice the size on screen, 200 dpi on a page.
const SCALE: f32 = 2.0;

/// The regular and the bold font, without what no label needs: see `build.rs`.
const FONTS: [&[u8]; 2] = [
    include_bytes!(concat!(env!("OUT_DIR"), "/regular.ttf")),
    include_bytes!(concat!(env!("OUT_DIR"), "/bold.ttf")),
];

/// Renders an SVG.
///
/// # Errors
/// An SVG that cannot be read or is empty.
pub fn png(svg: &str) -> Result<Vec<u8>, FigureError> {
    with_fonts(svg, FONTS)
}

fn with_fonts(svg: &str, files: [&[u8]; 2]) -> Result<Vec<u8>, FigureError> {
    let mut options = usvg::Options {
        font_family: "DejaVu Sans".to_owned(),
        ..usvg::Options::default()
    };
    let fonts = options.fontdb_mut();
    for file in files {
        fonts.load_font_data(file.to_vec());
    }
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

#[cfg(test)]
mod tests {
    use super::{FONTS, png, with_fonts};
    use crate::figure::lean_font::KEPT;

    #[test]
    fn labels_look_as_with_the_whole_fonts() {
        // Kerning, ligatures, composed letters, subscripts, signs; then every letter that is kept, 64 in a row.
        let mut lines = vec![
            "AVATAR To fi ffl \u{e4}\u{1ec7} i\u{307} e\u{301} q\u{323}".to_owned(),
            "θ_ref [rad], ω² ≤ 1·10⁻³ − ½ → ∞ ‰ Δs ± σ № Ђж".to_owned(),
        ];
        let kept = KEPT.into_iter().flatten().filter_map(char::from_u32);
        let letters: Vec<char> = kept
            .filter(|c| !c.is_control() && !"<&>".contains(*c))
            .collect();
        lines.extend(letters.chunks(64).map(|row| row.iter().collect()));
        let texts: String = (lines.iter().enumerate())
            .map(|(n, line)| {
                let (y, weight) = (20 * n + 20, ["normal", "bold"][n % 2]);
                format!("<text x=\"5\" y=\"{y}\" font-size=\"14\" font-weight=\"{weight}\">{line}</text>")
            })
            .collect();
        let height = 20 * lines.len() + 20;
        let svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1000\" height=\"{height}\">{texts}</svg>"
        );
        let whole = [dejavu::sans::regular(), dejavu::sans::bold()];
        assert!(png(&svg).expect("a picture") == with_fonts(&svg, whole).expect("a picture"));
        for (lean, whole) in FONTS.iter().zip(whole) {
            assert!(
                10 * lean.len() < 6 * whole.len(),
                "{} bytes of {}",
                lean.len(),
                whole.len()
            );
        }
    }
}
