//! A panel: axes, what is drawn between them, a legend; and panels on a sheet.

use super::axis::Axis;
use super::corner::Corner;
use super::drawing::{Anchor, Color, Drawing, Point, Shape, Stroke, Text};
use super::font;
use super::legend::{Entry, FRAME, GAP, LINE, Marker, OFF, PAD, SAMPLE, legend_size};
use super::style::{
    AXIS, GREY, GRID, LABEL_SIZE, LEGEND_EDGE, PAPER, SMALL_SIZE, SPACING, TITLE_SIZE,
};

/// Something between the axes, in their units.
#[derive(Clone, Debug)]
pub(super) enum Item {
    Line(Vec<Point>, Stroke),
    Mark(Point, Marker, f64, Color),
    /// From a point to an x, with an end.
    Bar(Point, f64, Color),
}

/// Where a legend is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    Inside(Corner),
    /// Right of the axes.
    Beside,
}

/// A line across all of a panel's height, and what is written beside its upper end.
#[derive(Clone, Debug)]
pub(super) struct Upright {
    pub at: f64,
    pub dashes: &'static [f32],
    pub label: &'static str,
}

#[derive(Clone, Debug)]
pub(super) struct Chart {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// One scale for both axes.
    pub equal: bool,
    pub items: Vec<Item>,
    pub legend: Vec<Entry>,
    pub place: Place,
    pub uprights: Vec<Upright>,
    /// Words, and what they are above the middle of.
    pub words: Vec<(String, Point)>,
}

/// A panel of a sheet: its width, and a letter.
pub(super) type Cell = (f64, Option<&'static str>, Chart);

/// Around all panels, and above them for the title.
const EDGE: f64 = 10.0;
const HEAD: f64 = 40.0;
/// What is left of the axes besides their numbers, without and with a label; right of them, below and above, without and with a title.
const LEFT: (f64, f64) = (22.0, 44.0);
const RIGHT: f64 = 15.0;
const BELOW: f64 = 53.0;
const ABOVE: (f64, f64) = (10.0, 44.0);
/// Length of ticks, and from the axis to its numbers.
const TICK: f64 = 5.0;
const NUMBERS: f64 = 8.0;
/// From the middle of letters to their base line, as a share of their size.
const MIDDLE: f64 = 0.364;

/// Rows of panels, each with its height, below a title.
pub(super) fn sheet(title: &str, rows: Vec<(f64, Vec<Cell>)>) -> Drawing {
    let (mut shapes, mut width, mut y) = (Vec::new(), 0.0_f64, HEAD);
    for (height, cells) in rows {
        let mut x = EDGE;
        for (wide, letter, chart) in cells {
            chart.draw((x, y), (wide, height), &mut shapes);
            if let Some(letter) = letter {
                let at = (x + 8.0, y + 16.0);
                let mut text = words(letter, at, LABEL_SIZE, Anchor::Start);
                text.bold = true;
                shapes.push(Shape::Text(text));
            }
            x += wide + SPACING;
        }
        width = width.max(x - SPACING + EDGE);
        y += height + SPACING;
    }
    let at = (0.5 * width, 21.0);
    shapes.push(Shape::Text(words(title, at, TITLE_SIZE, Anchor::Middle)));
    Drawing {
        size: (width, y - SPACING + EDGE),
        shapes,
    }
}

fn words(text: &str, at: Point, size: f64, anchor: Anchor) -> Text {
    Text {
        text: text.to_owned(),
        at,
        size,
        anchor,
        bold: false,
        upward: false,
    }
}

/// Left, top, right, bottom.
type Area = (f64, f64, f64, f64);

impl Chart {
    /// Without a title, a legend and words.
    pub const fn new(x: Axis, y: Axis, items: Vec<Item>) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            equal: false,
            items,
            legend: Vec::new(),
            place: Place::Beside,
            uprights: Vec::new(),
            words: Vec::new(),
        }
    }

    /// Draws it into a cell.
    fn draw(mut self, origin: Point, size: Point, shapes: &mut Vec<Shape>) {
        let mut area = self.area(origin, size);
        if self.equal {
            self.equalise(area);
            // Other numbers may be on the axis now.
            area = self.area(origin, size);
            self.equalise(area);
        }
        self.axes(area, origin, size, shapes);
        let at = |point: Point| self.place(area, point);
        for item in &self.items {
            self.item(area, item, shapes);
        }
        for (text, place) in &self.words {
            let (x, y) = at(*place);
            let place = (x, y - 6.0);
            shapes.push(Shape::Text(words(text, place, SMALL_SIZE, Anchor::Middle)));
        }
        if !self.legend.is_empty() {
            self.draw_legend(area, shapes);
        }
    }

    /// What is between the axes.
    fn area(&self, origin: Point, size: Point) -> Area {
        let numbers = self.y.marks();
        let widths = numbers
            .iter()
            .map(|(_, text)| font::width(text, SMALL_SIZE));
        let labelled = if self.y.label.is_empty() {
            LEFT.0
        } else {
            LEFT.1
        };
        let above = if self.title.is_empty() {
            ABOVE.0
        } else {
            ABOVE.1
        };
        let beside = match self.place {
            Place::Beside if !self.legend.is_empty() => legend_size(&self.legend).0 + OFF,
            _ => 0.0,
        };
        // Between pixels, so that a line of one is one.
        let sharp = |length: f64| length.floor() + 0.5;
        (
            sharp(origin.0 + labelled + widths.fold(0.0, f64::max)),
            sharp(origin.1 + above),
            sharp(origin.0 + size.0 - RIGHT - beside),
            sharp(origin.1 + size.1 - BELOW),
        )
    }

    /// Widens one range, so that a unit is as long across as up.
    fn equalise(&mut self, (left, top, right, bottom): Area) {
        let (x, y) = (self.x.range, self.y.range);
        let unit = ((x.1 - x.0) / (right - left)).max((y.1 - y.0) / (bottom - top));
        let widened = |range: (f64, f64), pixels: f64| {
            let (middle, half) = (0.5 * (range.0 + range.1), 0.5 * unit * pixels);
            (middle - half, middle + half)
        };
        self.x.range = widened(x, right - left);
        self.y.range = widened(y, bottom - top);
    }

    fn place(&self, (left, top, right, bottom): Area, (x, y): Point) -> Point {
        (
            left + self.x.share(x) * (right - left),
            bottom - self.y.share(y) * (bottom - top),
        )
    }

    /// Grid, frame, ticks, numbers, labels and the lines across.
    fn axes(&self, area: Area, origin: Point, size: Point, shapes: &mut Vec<Shape>) {
        let (left, top, right, bottom) = area;
        let line = |from, to, color| Shape::Line(vec![from, to], hair(color, &[]));
        let across = self.x.marks().into_iter().map(|(value, text)| {
            let x = self.place(area, (value, self.y.range.0)).0;
            (x, text)
        });
        let up = self.y.marks().into_iter().map(|(value, text)| {
            let y = self.place(area, (self.x.range.0, value)).1;
            (y, text)
        });
        let (across, up): (Vec<_>, Vec<_>) = (across.collect(), up.collect());
        for (x, _) in &across {
            shapes.push(line((*x, top), (*x, bottom), GRID));
        }
        if self.y.names.is_empty() {
            for (y, _) in &up {
                shapes.push(line((left, *y), (right, *y), GRID));
            }
        }
        // Between names.
        for pair in up.windows(2).filter(|_| !self.y.names.is_empty()) {
            let y = 0.5 * (pair[0].0 + pair[1].0);
            shapes.push(line((left, y), (right, y), GRID));
        }
        for upright in &self.uprights {
            let x = self.place(area, (upright.at, self.y.range.0)).0;
            let stroke = hair(GREY, upright.dashes);
            shapes.push(Shape::Line(vec![(x, top), (x, bottom)], stroke));
            let place = (x + 4.0, top + SMALL_SIZE);
            let text = words(upright.label, place, SMALL_SIZE, Anchor::Start);
            shapes.push(Shape::Text(text));
        }
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        // Half a pixel further, so that the corner is closed.
        let closed = [&corners[..], &[(left, top - 0.5)]].concat();
        shapes.push(Shape::Line(closed, hair(AXIS, &[])));
        for (x, text) in across {
            shapes.push(line((x, bottom), (x, bottom + TICK), AXIS));
            let place = (x, bottom + NUMBERS + 0.73 * SMALL_SIZE);
            shapes.push(Shape::Text(words(&text, place, SMALL_SIZE, Anchor::Middle)));
        }
        for (y, text) in up {
            shapes.push(line((left - TICK, y), (left, y), AXIS));
            let place = (left - NUMBERS, y + MIDDLE * SMALL_SIZE);
            shapes.push(Shape::Text(words(&text, place, SMALL_SIZE, Anchor::End)));
        }
        let (middle_x, middle_y) = (0.5 * (left + right), 0.5 * (top + bottom));
        let title = (middle_x, origin.1 + 27.5);
        let below = (middle_x, origin.1 + size.1 - 8.0);
        let mut beside = words(
            &self.y.label,
            (origin.0 + 18.0, middle_y),
            LABEL_SIZE,
            Anchor::Middle,
        );
        beside.upward = true;
        shapes.extend([
            Shape::Text(words(&self.title, title, LABEL_SIZE, Anchor::Middle)),
            Shape::Text(words(&self.x.label, below, LABEL_SIZE, Anchor::Middle)),
            Shape::Text(beside),
        ]);
        shapes.retain(|shape| !matches!(shape, Shape::Text(text) if text.text.is_empty()));
    }

    fn item(&self, area: Area, item: &Item, shapes: &mut Vec<Shape>) {
        match item {
            Item::Line(points, stroke) => {
                let points = points.iter().map(|point| self.place(area, *point));
                let pieces = clipped(points, area);
                shapes.extend(pieces.into_iter().map(|piece| Shape::Line(piece, *stroke)));
            }
            Item::Mark(point, marker, size, color) => {
                let at = self.place(area, *point);
                if clipped([at, at].into_iter(), area).len() == 1 {
                    mark(at, *marker, *size, color, shapes);
                }
            }
            Item::Bar(from, to, color) => {
                let (from, to) = (self.place(area, *from), self.place(area, (*to, from.1)));
                let end = [(to.0, to.1 - 4.0), (to.0, to.1 + 4.0)];
                for line in [[from, to], end] {
                    for piece in clipped(line.into_iter(), area) {
                        shapes.push(Shape::Line(piece, hair(color, &[])));
                    }
                }
            }
        }
    }

    fn draw_legend(&self, (left, top, right, bottom): Area, shapes: &mut Vec<Shape>) {
        let (wide, high) = legend_size(&self.legend);
        let (x, y) = match self.place {
            Place::Beside => (right + OFF, top),
            Place::Inside(corner) => (
                if corner.right {
                    right - OFF - wide
                } else {
                    left + OFF
                },
                if corner.top {
                    top + OFF
                } else {
                    bottom - OFF - high
                },
            ),
        };
        let box_ = [(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)];
        let closed = [&box_[..], &[(x, y - 0.5)]].concat();
        shapes.push(Shape::Area(box_.to_vec(), PAPER));
        shapes.push(Shape::Line(closed, hair(LEGEND_EDGE, &[])));
        for (n, entry) in self.legend.iter().enumerate() {
            let middle = y + 0.5 * FRAME + LINE * (n as f64 + 0.5);
            let (from, to) = (x + PAD, x + PAD + SAMPLE);
            match entry.marker {
                Some(marker) => {
                    let at = (0.5 * (from + to), middle);
                    mark(at, marker, 5.0, entry.color, shapes);
                }
                None => shapes.push(Shape::Line(
                    vec![(from, middle), (to, middle)],
                    Stroke {
                        color: entry.color,
                        width: 2.0,
                        dashes: entry.dashes,
                    },
                )),
            }
            let place = (to + GAP, middle + MIDDLE * SMALL_SIZE);
            let text = words(&entry.label, place, SMALL_SIZE, Anchor::Start);
            shapes.push(Shape::Text(text));
        }
    }
}

fn hair(color: Color, dashes: &'static [f32]) -> Stroke {
    Stroke {
        color,
        width: 1.0,
        dashes,
    }
}

fn mark((x, y): Point, marker: Marker, size: f64, color: Color, shapes: &mut Vec<Shape>) {
    let polygon = |corners: &[Point]| {
        let corners = corners
            .iter()
            .map(|(dx, dy)| (x + size * dx, y + size * dy));
        corners.collect::<Vec<_>>()
    };
    let area = |corners: &[Point]| Shape::Area(polygon(corners), color);
    let shape = match marker {
        Marker::Circle => Shape::Disc((x, y), size, color),
        Marker::Square => area(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]),
        Marker::Triangle => area(&[(0.0, -1.1), (-1.1, 0.8), (1.1, 0.8)]),
        Marker::TriangleDown => area(&[(0.0, 1.1), (-1.1, -0.8), (1.1, -0.8)]),
        Marker::Diamond => area(&[(0.0, -1.35), (1.35, 0.0), (0.0, 1.35), (-1.35, 0.0)]),
        Marker::Star => {
            let corners: Vec<Point> = (0..10)
                .map(|n| {
                    let (sin, cos) = (f64::from(n) * std::f64::consts::PI / 5.0).sin_cos();
                    let radius = if n % 2 == 0 { 1.4 } else { 0.56 };
                    (radius * sin, -radius * cos)
                })
                .collect();
            area(&corners)
        }
        Marker::Cross => {
            let stroke = Stroke {
                width: 1.5,
                ..hair(color, &[])
            };
            let [one, other] = [-0.9, 0.9].map(|end| polygon(&[(-0.9, end), (0.9, -end)]));
            shapes.push(Shape::Line(one, stroke));
            Shape::Line(other, stroke)
        }
    };
    shapes.push(shape);
}

/// The pieces of a line that are inside an area. Liang and Barsky (1984). What is no number is a gap.
fn clipped(
    points: impl Iterator<Item = Point>,
    (left, top, right, bottom): Area,
) -> Vec<Vec<Point>> {
    let points: Vec<Point> = points.collect();
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    // Whether the last piece ends where the next segment begins.
    let mut open = false;
    for pair in points.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let (dx, dy) = (to_x - x, to_y - y);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (toward, space) in [
            (-dx, x - left),
            (dx, right - x),
            (-dy, y - top),
            (dy, bottom - y),
        ] {
            if !toward.is_finite() || (toward == 0.0 && space < 0.0) {
                to = -1.0;
            } else if toward < 0.0 {
                from = from.max(space / toward);
            } else if toward > 0.0 {
                to = to.min(space / toward);
            }
        }
        if from > to {
            open = false;
            continue;
        }
        let at = |share: f64| (x + share * dx, y + share * dy);
        let end = if to < 1.0 { at(to) } else { (to_x, to_y) };
        match pieces.last_mut().filter(|_| open && from <= 0.0) {
            Some(piece) => piece.push(end),
            None => pieces.push(vec![if from > 0.0 { at(from) } else { (x, y) }, end]),
        }
        open = to >= 1.0;
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::clipped;

    #[test]
    fn a_line_is_drawn_where_it_is_inside() {
        let area = (0.0, 0.0, 10.0, 10.0);
        let clip = |points: &[(f64, f64)]| clipped(points.iter().copied(), area);
        let inside = [(1.0, 1.0), (2.0, 5.0), (9.0, 3.0)];
        assert_eq!(clip(&inside), [inside]);
        // Out at the top and back, through a corner of the outside.
        let out = [(2.0, 2.0), (2.0, -2.0), (6.0, -2.0), (6.0, 2.0)];
        let pieces = [[(2.0, 2.0), (2.0, 0.0)], [(6.0, 0.0), (6.0, 2.0)]];
        assert_eq!(clip(&out), pieces);
        // From far outside to far outside.
        assert_eq!(
            clip(&[(-1024.0, 5.0), (1024.0, 5.0)]),
            [[(0.0, 5.0), (10.0, 5.0)]]
        );
        assert!(clip(&[(-5.0, -1.0), (15.0, -1.0)]).is_empty());
        // What is no number breaks it.
        let broken = [
            (1.0, 1.0),
            (2.0, 2.0),
            (f64::NAN, 3.0),
            (4.0, f64::INFINITY),
            (5.0, 5.0),
            (6.0, 5.0),
        ];
        let pieces = [[(1.0, 1.0), (2.0, 2.0)], [(5.0, 5.0), (6.0, 5.0)]];
        assert_eq!(clip(&broken), pieces);
        // A point at the edge is inside.
        assert_eq!(clip(&[(10.0, 0.0), (10.0, 0.0)]).len(), 1);
    }
}
