//! Letters set one after another, with the pairs of the font's `kern` table closer: all that labels need. No script that joins its
//! letters is in the fonts, and marks are on their letters.

use super::drawing::{LOWERED_BY, LOWERED_SIZE, parts};
use std::sync::LazyLock;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Without what no label needs: see `build.rs`.
pub(super) const FILE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/font.ttf"));

/// The font.
pub(super) fn face() -> &'static Face<'static> {
    static FACE: LazyLock<Face<'static>> =
        LazyLock::new(|| Face::parse(FILE, 0).expect("a font: every test of figures reads it"));
    &FACE
}

/// A letter in its place.
pub(super) struct Letter {
    pub glyph: GlyphId,
    /// From the start of the text, and below its base line.
    pub across: f64,
    pub below: f64,
    pub size: f64,
}

/// The letters of a text, and how long it is.
pub(super) fn set(face: &Face<'_>, text: &str, size: f64) -> (Vec<Letter>, f64) {
    let (mut letters, mut across) = (Vec::new(), 0.0);
    for (part, lowered) in parts(text) {
        let (size, below) = if lowered {
            (LOWERED_SIZE * size, LOWERED_BY * size)
        } else {
            (size, 0.0)
        };
        let unit = size / f64::from(face.units_per_em());
        let mut before = None;
        for letter in part.chars() {
            let glyph = face.glyph_index(letter).unwrap_or_default();
            let kern = before.and_then(|before| kern(face, before, glyph));
            across += unit * f64::from(kern.unwrap_or(0));
            letters.push(Letter {
                glyph,
                across,
                below,
                size,
            });
            across += unit * f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
            before = Some(glyph);
        }
    }
    (letters, across)
}

/// How long a text is.
pub(super) fn width(text: &str, size: f64) -> f64 {
    set(face(), text, size).1
}

fn kern(face: &Face<'_>, left: GlyphId, right: GlyphId) -> Option<i16> {
    let tables = face.tables().kern?;
    let mut across = (tables.subtables.into_iter()).filter(|table| table.horizontal);
    across.find_map(|table| table.glyphs_kerning(left, right))
}

/// An outline as a path, moved and scaled.
pub(super) struct Pen<'a> {
    pub path: &'a mut tiny_skia::PathBuilder,
    pub origin: (f32, f32),
    pub unit: f32,
}

impl Pen<'_> {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.origin.0 + self.unit * x, self.origin.1 - self.unit * y)
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2)) = (self.place(x1, y1), self.place(x2, y2));
        let (x, y) = self.place(x, y);
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
