//! Lines, shapes and texts on white paper, and their SVG.

use std::fmt::Write as _;

/// Red, green and blue.
pub(super) type Color = [u8; 3];

pub(super) const WHITE: Color = [0xff; 3];
pub(super) const BLACK: Color = [0; 3];
/// Lines of a grid.
pub(super) const GRID: Color = [0xdd; 3];
/// Lines of a chart that belong to no series.
pub(super) const INK: Color = [0x33; 3];

/// Height of a text, pixels.
const TEXT: f64 = 13.0;

/// A picture as a list of shapes, in pixels from the upper left corner.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub(super) size: [f64; 2],
    pub(super) items: Vec<DrawingItem>,
}

#[derive(Clone, Debug)]
pub(super) enum DrawingItem {
    Shape(Shape),
    Text(Text),
    /// The shapes up to [`DrawingItem::EndClip`] are seen in this rectangle only: its corner and its size.
    Clip([[f64; 2]; 2]),
    EndClip,
}

#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub outline: Outline,
    pub color: Color,
    /// Width and dashes of a line; `None` fills the outline.
    pub stroke: Option<Stroke>,
    pub opacity: f64,
    /// Text that viewers show beside the pointer; may be empty.
    pub title: String,
}

#[derive(Clone, Debug)]
pub(super) enum Outline {
    /// Points joined by lines.
    Line(Vec<[f64; 2]>),
    Polygon(Vec<[f64; 2]>),
    /// Corner and size.
    Rect([[f64; 2]; 2]),
    /// Centre and radius.
    Circle([f64; 2], f64),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub width: f64,
    /// Lengths of dashes and gaps; none for a solid line.
    pub dashes: &'static [f64],
}

/// A solid line.
pub(super) fn solid(width: f64) -> Stroke {
    Stroke { width, dashes: &[] }
}

/// Point of a text that lies at the given position.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Clone, Debug)]
pub(super) struct Text {
    pub at: [f64; 2],
    pub anchor: Anchor,
    pub size: f64,
    pub color: Color,
    /// `true` if it is read from below.
    pub is_upright: bool,
    pub text: String,
}

impl Text {
    pub fn new(at: [f64; 2], anchor: Anchor, text: impl Into<String>) -> Self {
        Self { at, anchor, size: TEXT, color: BLACK, is_upright: false, text: text.into() }
    }
}

impl Shape {
    pub fn filled(outline: Outline, color: Color) -> Self {
        Self { outline, color, stroke: None, opacity: 1.0, title: String::new() }
    }

    pub fn stroked(outline: Outline, color: Color, stroke: Stroke) -> Self {
        Self { stroke: Some(stroke), ..Self::filled(outline, color) }
    }
}

impl DrawingItem {
    /// Moves the item down.
    fn lower(&mut self, by: f64) {
        match self {
            Self::Shape(Shape { outline: Outline::Line(points) | Outline::Polygon(points), .. }) => {
                points.iter_mut().for_each(|point| point[1] += by);
            }
            Self::Shape(Shape { outline: Outline::Rect([at, _]) | Outline::Circle(at, _), .. })
            | Self::Text(Text { at, .. })
            | Self::Clip([at, _]) => at[1] += by,
            Self::EndClip => {}
        }
    }
}

impl Drawing {
    /// White paper.
    pub(super) fn new(size: [f64; 2]) -> Self {
        let mut drawing = Self { size, items: Vec::new() };
        drawing.rect([[0.0; 2], size], WHITE);
        drawing
    }

    /// Returns drawings one below the other.
    pub fn stacked(drawings: impl IntoIterator<Item = Self>) -> Self {
        let mut stack = Self { size: [0.0; 2], items: Vec::new() };
        for mut drawing in drawings {
            let by = stack.size[1];
            drawing.items.iter_mut().for_each(|item| item.lower(by));
            stack.items.append(&mut drawing.items);
            stack.size = [stack.size[0].max(drawing.size[0]), by + drawing.size[1]];
        }
        stack
    }

    pub(super) fn add(&mut self, shape: Shape) {
        self.items.push(DrawingItem::Shape(shape));
    }

    pub(super) fn line(&mut self, points: Vec<[f64; 2]>, color: Color, stroke: Stroke) {
        self.add(Shape::stroked(Outline::Line(points), color, stroke));
    }

    pub(super) fn rect(&mut self, corner_and_size: [[f64; 2]; 2], color: Color) {
        self.add(Shape::filled(Outline::Rect(corner_and_size), color));
    }

    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, text: impl Into<String>) {
        self.put(Text::new(at, anchor, text));
    }

    pub(super) fn put(&mut self, text: Text) {
        self.items.push(DrawingItem::Text(text));
    }

    /// Draws what `draw` adds in a rectangle only.
    pub(super) fn clipped(&mut self, corner_and_size: [[f64; 2]; 2], draw: impl FnOnce(&mut Self)) {
        self.items.push(DrawingItem::Clip(corner_and_size));
        draw(self);
        self.items.push(DrawingItem::EndClip);
    }

    /// Returns the drawing as an SVG document.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Ubuntu, sans-serif\" font-size=\"{TEXT}\">\n"
        );
        for (number, item) in self.items.iter().enumerate() {
            let line = match item {
                DrawingItem::Shape(shape) => shape.svg(),
                DrawingItem::Text(text) => text.svg(),
                DrawingItem::Clip(rect) => format!(
                    "<clipPath id=\"clip{number}\"><rect{}/></clipPath>\n<g clip-path=\"url(#clip{number})\">",
                    rect_attributes(*rect)
                ),
                DrawingItem::EndClip => "</g>".to_owned(),
            };
            svg.push_str(&line);
            svg.push('\n');
        }
        svg.push_str("</svg>\n");
        svg
    }
}

impl Shape {
    fn svg(&self) -> String {
        let list = |points: &[[f64; 2]]| {
            let points: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", short(*x), short(*y))).collect();
            points.join(" ")
        };
        let (tag, mut attributes) = match &self.outline {
            Outline::Line(points) if let [[x1, y1], [x2, y2]] = points[..] => {
                let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(short);
                ("line", format!(" x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\""))
            }
            Outline::Line(points) => ("polyline", format!(" points=\"{}\" stroke-linejoin=\"round\"", list(points))),
            Outline::Polygon(points) => ("polygon", format!(" points=\"{}\"", list(points))),
            Outline::Rect(rect) => ("rect", rect_attributes(*rect)),
            Outline::Circle([x, y], radius) => {
                ("circle", format!(" cx=\"{}\" cy=\"{}\" r=\"{}\"", short(*x), short(*y), short(*radius)))
            }
        };
        let color = hex(self.color);
        attributes += &match self.stroke {
            None => format!(" fill=\"{color}\""),
            Some(Stroke { width, dashes }) => {
                let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
                let dashes = match &dashes[..] {
                    [] => String::new(),
                    dashes => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
                };
                format!(" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}")
            }
        };
        if self.opacity < 1.0 {
            let _ = write!(attributes, " opacity=\"{}\"", self.opacity);
        }
        if self.title.is_empty() {
            format!("<{tag}{attributes}/>")
        } else {
            format!("<{tag}{attributes}><title>{}</title></{tag}>", escape(&self.title))
        }
    }
}

impl Text {
    fn svg(&self) -> String {
        let [x, y] = self.at.map(short);
        let mut attributes = if self.is_upright {
            format!(" transform=\"translate({x} {y}) rotate(-90)\"")
        } else {
            format!(" x=\"{x}\" y=\"{y}\"")
        };
        attributes += match self.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        if self.size != TEXT {
            let _ = write!(attributes, " font-size=\"{}\"", self.size);
        }
        if self.color != BLACK {
            let _ = write!(attributes, " fill=\"{}\"", hex(self.color));
        }
        format!("<text{attributes}>{}</text>", escape(&self.text))
    }
}

fn rect_attributes([corner, size]: [[f64; 2]; 2]) -> String {
    let ([x, y], [width, height]) = (corner.map(short), size.map(short));
    format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
}

/// Rounds to hundredths of a pixel.
fn short(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
