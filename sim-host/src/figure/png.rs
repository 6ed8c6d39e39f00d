//! Pixels, with the font on board: the same picture on a machine without fonts.

use super::FigureError;
use super::drawing::{Anchor, Drawing, Point, Shape, Stroke, Text};
use super::font::{self, Pen};
use tiny_skia::{
    Color, FillRule, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform,
};

/// Pixels per unit of the SVG: sharp at twice the size on screen, 200 dpi on a page.
const SCALE: f32 = 2.0;
/// Width of the line around a bold letter, as a share of its size.
const BOLDER: f32 = 0.06;

impl Drawing {
    /// As PNG.
    ///
    /// # Errors
    /// [`FigureError::Empty`] if it has no size.
    pub fn png(&self) -> Result<Vec<u8>, FigureError> {
        self.pixels()?
            .encode_png()
            .map_err(|error| FigureError::Png(error.to_string()))
    }

    fn pixels(&self) -> Result<Pixmap, FigureError> {
        let pixels = |length: f64| (length as f32 * SCALE).ceil() as u32;
        let mut map =
            Pixmap::new(pixels(self.size.0), pixels(self.size.1)).ok_or(FigureError::Empty)?;
        map.fill(Color::WHITE);
        for shape in &self.shapes {
            draw(&mut map, shape);
        }
        Ok(map)
    }
}

fn draw(map: &mut Pixmap, shape: &Shape) {
    let scale = Transform::from_scale(SCALE, SCALE);
    match shape {
        Shape::Line(points, stroke) => {
            if let Some(path) = path(points, false) {
                map.stroke_path(&path, &paint(stroke.color), &pen(stroke), scale, None);
            }
        }
        Shape::Area(points, color) => {
            if let Some(path) = path(points, true) {
                map.fill_path(&path, &paint(color), FillRule::Winding, scale, None);
            }
        }
        Shape::Disc((x, y), radius, color) => {
            if let Some(path) = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32) {
                map.fill_path(&path, &paint(color), FillRule::Winding, scale, None);
            }
        }
        Shape::Text(text) => {
            let (x, y) = (text.at.0 as f32, text.at.1 as f32);
            let turn = if text.upward { -90.0 } else { 0.0 };
            let place = scale.pre_translate(x, y).pre_rotate(turn);
            if let Some(path) = outlines(text) {
                let paint = paint("#000000");
                map.fill_path(&path, &paint, FillRule::Winding, place, None);
                if text.bold {
                    // A bold font would be as large as the regular one, for five letters.
                    let stroke = tiny_skia::Stroke {
                        width: BOLDER * text.size as f32,
                        ..tiny_skia::Stroke::default()
                    };
                    map.stroke_path(&path, &paint, &stroke, place, None);
                }
            }
        }
    }
}

/// The letters of a text, around the place that it is anchored at.
fn outlines(text: &Text) -> Option<Path> {
    let face = font::face();
    let (letters, width) = font::set(face, &text.text, text.size);
    let start = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => -0.5 * width,
        Anchor::End => -width,
    };
    let mut path = PathBuilder::new();
    for letter in letters {
        let mut pen = Pen {
            path: &mut path,
            origin: ((start + letter.across) as f32, letter.below as f32),
            unit: letter.size as f32 / f32::from(face.units_per_em()),
        };
        // A space has no outline.
        let _ = face.outline_glyph(letter.glyph, &mut pen);
    }
    path.finish()
}

fn path(points: &[Point], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (n, &(x, y)) in points.iter().enumerate() {
        let (x, y) = (x as f32, y as f32);
        if n == 0 {
            path.move_to(x, y);
        } else {
            path.line_to(x, y);
        }
    }
    if closed {
        path.close();
    }
    path.finish()
}

fn paint(color: &str) -> Paint<'static> {
    let number = u32::from_str_radix(color.trim_start_matches('#'), 16).unwrap_or(0);
    let [_, red, green, blue] = number.to_be_bytes();
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

fn pen(stroke: &Stroke) -> tiny_skia::Stroke {
    tiny_skia::Stroke {
        width: stroke.width as f32,
        line_join: LineJoin::Miter,
        dash: StrokeDash::new(stroke.dashes.to_vec(), 0.0),
        ..tiny_skia::Stroke::default()
    }
}

#[cfg(test)]
mod tests {
    use super::outlines;
    use crate::figure::drawing::{Anchor, Text};
    use crate::figure::font::{self, FILE, Pen};
    use crate::figure::lean_font::KEPT;
    use ttf_parser::Face;

    #[test]
    fn letters_look_as_in_the_whole_font() {
        let kept: Vec<char> = (KEPT.into_iter().flatten())
            .filter_map(char::from_u32)
            .collect();
        assert!(kept.contains(&'θ') && kept.contains(&'Ж') && kept.contains(&'−'));
        let whole = Face::parse(dejavu::sans::regular(), 0).expect("a font");
        let look = |face: &Face<'_>, letter| {
            let glyph = face.glyph_index(letter)?;
            let mut path = tiny_skia::PathBuilder::new();
            let mut pen = Pen {
                path: &mut path,
                origin: (0.0, 0.0),
                unit: 1.0,
            };
            face.outline_glyph(glyph, &mut pen);
            Some((path.finish(), face.glyph_hor_advance(glyph)))
        };
        for &letter in &kept {
            assert_eq!(look(font::face(), letter), look(&whole, letter), "{letter}");
        }
        // Pairs as well.
        let wide = |face| font::set(face, "AVATAR To, Ty", 100.0).1;
        assert_eq!(wide(font::face()), wide(&whole));
        assert!(2 * FILE.len() < dejavu::sans::regular().len());
    }

    #[test]
    fn a_text_is_where_its_anchor_is() {
        let text = |anchor| Text {
            text: "AV θ_ref".to_owned(),
            at: (0.0, 0.0),
            size: 15.0,
            anchor,
            bold: false,
            upward: false,
        };
        let bounds = |anchor| outlines(&text(anchor)).expect("letters").bounds();
        let (start, middle, end) = (
            bounds(Anchor::Start),
            bounds(Anchor::Middle),
            bounds(Anchor::End),
        );
        assert!(start.left() > -0.5 && end.right() < 0.5);
        assert!((middle.left() + middle.right()).abs() < 1.5);
        // The subscript is below the base line, and the pair A and V is closer than its letters are wide.
        assert!(start.bottom() > 2.0 && start.top() < -10.0);
        assert!(font::width("AV", 15.0) < font::width("A", 15.0) + font::width("V", 15.0) - 0.5);
    }
}
