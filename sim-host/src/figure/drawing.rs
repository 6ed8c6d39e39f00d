//! A picture as lines, areas and words: written as SVG, or drawn as PNG.
//!
//! Ours, because size decides: with a plotting library and one that renders SVG the wheel for Python had 3.7 MB instead of 2.1.

use crate::plain_text::written_out;
use std::fmt::Write as _;

/// A place, or a size \[px\].
pub(super) type Point = (f64, f64);

/// `#rrggbb`.
pub(super) type Color = &'static str;

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub color: Color,
    pub width: f64,
    /// Lengths drawn and left out, in turn; none for a line without gaps.
    pub dashes: &'static [f32],
}

/// Which part of a text its place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text. `e_x` is an e with a lowered, smaller x.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub text: String,
    /// On the base line.
    pub at: Point,
    pub size: f64,
    pub anchor: Anchor,
    pub bold: bool,
    /// From below upwards.
    pub upward: bool,
}

#[derive(Clone, Debug)]
pub(super) enum Shape {
    Line(Vec<Point>, Stroke),
    Area(Vec<Point>, Color),
    Disc(Point, f64, Color),
    Text(Text),
}

/// A picture.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub(super) size: Point,
    pub(super) shapes: Vec<Shape>,
}

/// A subscript, in terms of the text that it belongs to.
pub(super) const LOWERED_SIZE: f64 = 0.72;
pub(super) const LOWERED_BY: f64 = 0.216;

/// The parts of a text, and whether they are subscripts: letters and digits after a `_`.
pub(super) fn parts(text: &str) -> Vec<(&str, bool)> {
    let mut parts = Vec::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('_') {
        let length = after
            .find(|c: char| !c.is_alphanumeric())
            .unwrap_or(after.len());
        let (lowered, next) = after.split_at(length);
        parts.extend([(before, false), (lowered, true)]);
        rest = next;
    }
    parts.push((rest, false));
    parts.retain(|(part, _)| !part.is_empty());
    parts
}

impl Drawing {
    /// As SVG.
    pub fn svg(&self) -> String {
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" \
             font-family=\"DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif\">\
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
            short(self.size.0),
            short(self.size.1)
        );
        for shape in &self.shapes {
            // Writing to a string cannot fail.
            let _ = write_shape(&mut out, shape);
            out.push('\n');
        }
        out.push_str("</svg>\n");
        out
    }
}

/// To a hundredth of a pixel.
fn short(length: f64) -> f64 {
    (1.0e2 * length).round() / 1.0e2
}

fn write_shape(out: &mut String, shape: &Shape) -> std::fmt::Result {
    match shape {
        Shape::Line(points, stroke) => {
            let (color, width) = (stroke.color, stroke.width);
            out.push_str("<path d=\"");
            write_points(out, points)?;
            write!(
                out,
                "\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\""
            )?;
            if let [on, off] = stroke.dashes {
                write!(out, " stroke-dasharray=\"{on} {off}\"")?;
            }
            out.push_str("/>");
        }
        Shape::Area(points, color) => {
            out.push_str("<path d=\"");
            write_points(out, points)?;
            write!(out, "Z\" fill=\"{color}\"/>")?;
        }
        Shape::Disc((x, y), radius, color) => write!(
            out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" fill=\"{color}\"/>",
            short(*x),
            short(*y)
        )?,
        Shape::Text(text) => {
            let (x, y) = (short(text.at.0), short(text.at.1));
            write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", text.size)?;
            out.push_str(match text.anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            });
            if text.bold {
                out.push_str(" font-weight=\"bold\"");
            }
            if text.upward {
                write!(out, " transform=\"rotate(-90,{x},{y})\"")?;
            }
            out.push('>');
            write_parts(out, &text.text)?;
            out.push_str("</text>");
        }
    }
    Ok(())
}

fn write_points(out: &mut String, points: &[Point]) -> std::fmt::Result {
    for (n, (x, y)) in points.iter().enumerate() {
        let letter = if n == 0 { 'M' } else { 'L' };
        write!(out, "{letter}{} {}", short(*x), short(*y))?;
    }
    Ok(())
}

/// As text of XML: with one sign that XML cannot have no viewer shows the figure.
fn escaped(text: &str) -> String {
    written_out(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace("]]>", "]]&gt;")
}

/// A shift is a `dy`, which every viewer understands, unlike `baseline-shift`, in terms of the part's own size; it holds for all
/// that follows.
fn write_parts(out: &mut String, text: &str) -> std::fmt::Result {
    let mut was_lowered = false;
    for (part, lowered) in parts(text) {
        let part = escaped(part);
        match (was_lowered, lowered) {
            (false, false) => out.push_str(&part),
            (_, true) => {
                let percent = 100.0 * LOWERED_SIZE;
                let by = if was_lowered {
                    0.0
                } else {
                    short(LOWERED_BY / LOWERED_SIZE)
                };
                write!(
                    out,
                    "<tspan dy=\"{by}em\" font-size=\"{percent}%\">{part}</tspan>"
                )?;
            }
            (true, false) => write!(out, "<tspan dy=\"{}em\">{part}</tspan>", -LOWERED_BY)?,
        }
        was_lowered = lowered;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Anchor, Drawing, Shape, Text, parts};

    #[test]
    fn letters_after_a_line_below_are_subscripts() {
        assert_eq!(parts("plain"), [("plain", false)]);
        let expected = [("e", false), ("x", true), (", e", false), ("θ", true)];
        assert_eq!(parts("e_x, e_θ"), expected);
        assert_eq!(
            parts("v_c [m]_"),
            [("v", false), ("c", true), (" [m]", false)]
        );
        assert_eq!(parts(""), []);
    }

    fn svg(text: &str) -> String {
        let drawing = Drawing {
            size: (10.0, 10.0),
            shapes: vec![Shape::Text(Text {
                text: text.to_owned(),
                at: (1.0, 2.0 / 3.0),
                size: 13.0,
                anchor: Anchor::Start,
                bold: false,
                upward: false,
            })],
        };
        drawing.svg()
    }

    #[test]
    fn a_name_with_signs_of_xml_stays_a_name() {
        let svg = svg("a <&> b_1 c");
        assert!(svg.contains(
            "y=\"0.67\" font-size=\"13\">a &lt;&amp;> b<tspan dy=\"0.3em\" font-size=\"72%\">1</tspan><tspan dy=\"-0.216em\"> c</tspan></text>"
        ), "{svg}");
    }
    /// Signs that XML 1.0 has no way to write, and the end of a section that it forbids in text.
    #[test]
    fn what_xml_cannot_have_is_written_out() {
        for (text, written) in [
            ("a\u{0}b\u{1b}c", r">a\u0000b\u001Bc<"),
            ("\u{7f}\u{85}\u{ffff}é", r">\u007F\u0085\uFFFFé<"),
            ("one\ttwo\nthree", ">one\ttwo\nthree<"),
            ("a]]>b", ">a]]&gt;b<"),
        ] {
            let svg = svg(text);
            assert!(svg.contains(written), "{svg}");
        }
    }
}
