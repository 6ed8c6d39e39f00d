//! A TrueType font without hints, without tables that nothing reads here, and without the outlines of scripts that no label has.
//!
//! Numbers of glyphs, widths and the closer pairs of `kern` stay as they are, so what is left is set and drawn bit for bit as with the
//! whole font. The build script runs this.

use std::ops::RangeInclusive;

/// Letters that keep their outlines: Latin, Greek, Cyrillic with all their accents, punctuation, signs of mathematics, arrows, shapes.
pub const KEPT: [RangeInclusive<u32>; 3] = [0x0000..=0x052f, 0x1e00..=0x1fff, 0x2000..=0x27bf];

/// Tables that setting letter after letter and drawing without hints read.
const TABLES: [&[u8; 4]; 8] = [
    b"cmap", b"glyf", b"head", b"hhea", b"hmtx", b"kern", b"loca", b"maxp",
];

/// The font without what is not needed; nothing if it is not as expected.
pub fn lean(font: &[u8]) -> Option<Vec<u8>> {
    let table = |name: &[u8; 4]| {
        let count = usize::from(half(font, 4)?);
        let entry = (0..count)
            .map(|n| 12 + 16 * n)
            .find(|&at| font.get(at..at + 4) == Some(name.as_slice()))?;
        let (from, length) = (word(font, entry + 8)?, word(font, entry + 12)?);
        font.get(from as usize..(from + length) as usize)
    };
    // Short ones, which hold half of a place, would do for smaller fonts.
    let long = half(table(b"head")?, 50)? == 1;
    let count = usize::from(half(table(b"maxp")?, 4)?);
    let places = (0..=count)
        .map(|n| word(table(b"loca")?, 4 * n).map(|at| at as usize))
        .collect::<Option<Vec<_>>>()?;
    if !long {
        return None;
    }
    let outlines = places
        .windows(2)
        .map(|ends| table(b"glyf")?.get(ends[0]..ends[1]))
        .collect::<Option<Vec<_>>>()?;

    let kept = kept(table(b"cmap")?, &outlines)?;
    let (mut glyf, mut loca) = (Vec::new(), Vec::new());
    for (outline, kept) in outlines.iter().zip(kept) {
        loca.extend((glyf.len() as u32).to_be_bytes());
        if kept {
            glyf.extend(unhinted(outline)?);
            glyf.resize(glyf.len().next_multiple_of(4), 0);
        }
    }
    loca.extend((glyf.len() as u32).to_be_bytes());

    let mut out = font.get(..4)?.to_vec();
    out.extend((TABLES.len() as u16).to_be_bytes());
    // Three hints for a binary search.
    let power = TABLES.len().ilog2();
    let range = 16_u16 << power;
    for number in [range, power as u16, 16 * TABLES.len() as u16 - range] {
        out.extend(number.to_be_bytes());
    }
    let mut data = Vec::new();
    for name in TABLES {
        let bytes = match name {
            b"glyf" => &glyf,
            b"loca" => &loca,
            _ => table(name)?,
        };
        out.extend(name);
        // A sum of all words, which nobody checks.
        out.extend([0; 4]);
        let from = 12 + 16 * TABLES.len() + data.len();
        out.extend((from as u32).to_be_bytes());
        out.extend((bytes.len() as u32).to_be_bytes());
        data.extend(bytes);
        data.resize(data.len().next_multiple_of(4), 0);
    }
    out.extend(data);
    Some(out)
}

/// Which glyphs keep their outlines: the box for letters that are missing, those of letters that are kept, and what they are composed of.
fn kept(cmap: &[u8], outlines: &[&[u8]]) -> Option<Vec<bool>> {
    let mut kept = vec![false; outlines.len()];
    *kept.first_mut()? = true;
    for (letter, glyph) in letters(cmap)? {
        if KEPT.iter().any(|range| range.contains(&letter)) {
            *kept.get_mut(glyph)? = true;
        }
    }
    // Parts may have parts of their own.
    let mut left: Vec<usize> = (0..kept.len()).filter(|&glyph| kept[glyph]).collect();
    while let Some(glyph) = left.pop() {
        for part in parts(outlines[glyph])?.0 {
            if !std::mem::replace(kept.get_mut(part)?, true) {
                left.push(part);
            }
        }
    }
    Some(kept)
}

/// All letters of a font with their glyphs, by the table for all of Unicode (format 12).
fn letters(cmap: &[u8]) -> Option<Vec<(u32, usize)>> {
    let at = (0..usize::from(half(cmap, 2)?))
        .filter_map(|n| word(cmap, 4 + 8 * n + 4))
        .map(|at| at as usize)
        .find(|&at| half(cmap, at) == Some(12))?;
    let mut letters = Vec::new();
    for n in 0..word(cmap, at + 12)? as usize {
        let group = at + 16 + 12 * n;
        let (first, last) = (word(cmap, group)?, word(cmap, group + 4)?);
        let glyph = word(cmap, group + 8)?;
        letters.extend((first..=last).map(|letter| (letter, (glyph + letter - first) as usize)));
    }
    Some(letters)
}

/// Glyphs that one is composed of; where its last one ends, and whether hints follow.
fn parts(outline: &[u8]) -> Option<(Vec<usize>, usize, bool)> {
    const WORDS: u16 = 0x1;
    const SCALE: u16 = 0x8;
    const MORE: u16 = 0x20;
    const TWO_SCALES: u16 = 0x40;
    const MATRIX: u16 = 0x80;
    const HINTS: u16 = 0x100;
    let (mut parts, mut at) = (Vec::new(), 10);
    // The number of contours is negative.
    if outline.first().is_none_or(|first| first & 0x80 == 0) {
        return Some((parts, at, false));
    }
    loop {
        let flags = half(outline, at)?;
        parts.push(usize::from(half(outline, at + 2)?));
        at += if flags & WORDS == 0 { 6 } else { 8 };
        at += match flags & (SCALE | TWO_SCALES | MATRIX) {
            0 => 0,
            SCALE => 2,
            TWO_SCALES => 4,
            _ => 8,
        };
        if flags & MORE == 0 {
            return Some((parts, at, flags & HINTS != 0));
        }
    }
}

/// An outline without its hints.
fn unhinted(outline: &[u8]) -> Option<Vec<u8>> {
    if outline.is_empty() {
        return Some(Vec::new());
    }
    let (parts, end, hints) = parts(outline)?;
    if parts.is_empty() {
        let length = 10 + 2 * usize::from(half(outline, 0)?);
        let program = usize::from(half(outline, length)?);
        let mut out = outline.get(..length)?.to_vec();
        out.extend([0; 2]);
        out.extend(outline.get(length + 2 + program..)?);
        return Some(out);
    }
    // Without hints, a reader goes by the flag, not by the length.
    Some(if hints {
        let mut out = outline.get(..end)?.to_vec();
        out.extend([0; 2]);
        out
    } else {
        outline.to_vec()
    })
}

fn half(bytes: &[u8], at: usize) -> Option<u16> {
    let bytes = bytes.get(at..at + 2)?;
    Some(u16::from_be_bytes(bytes.try_into().ok()?))
}

fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let bytes = bytes.get(at..at + 4)?;
    Some(u32::from_be_bytes(bytes.try_into().ok()?))
}
