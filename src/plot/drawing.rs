//! Lines, shapes and texts on white paper, written as SVG.

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

/// A picture of one page or of several, one below the other. Places are in pixels from the upper left corner of the last
/// page.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// Size of all pages together.
    size: [f64; 2],
    /// Upper edge of the last page.
    top: f64,
    /// Elements of the SVG document.
    elements: Vec<String>,
}

/// Width and dashes of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub width: f64,
    /// Lengths of dashes and gaps; none for a solid line.
    pub dashes: &'static [f64],
}

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

impl Drawing {
    /// Adds white paper.
    pub(super) fn page(&mut self, size: [f64; 2]) {
        self.top = self.size[1];
        self.size = [self.size[0].max(size[0]), self.top + size[1]];
        self.rect([[0.0; 2], size], WHITE);
    }

    pub(super) fn line(&mut self, points: &[[f64; 2]], color: Color, stroke: Stroke) {
        let line = match *points {
            [from, to] => {
                let ([x1, y1], [x2, y2]) = (self.place(from), self.place(to));
                format!("line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"")
            }
            _ => format!("polyline points=\"{}\" stroke-linejoin=\"round\"", self.list(points)),
        };
        self.elements.push(format!("<{line}{}/>", stroked(color, stroke)));
    }

    /// Fills a polygon, with a text that viewers show beside the pointer; it may be empty.
    pub(super) fn polygon(&mut self, points: &[[f64; 2]], color: Color, opacity: f64, title: &str) {
        let mut polygon = format!("polygon points=\"{}\" fill=\"{}\"", self.list(points), hex(color));
        if opacity < 1.0 {
            let _ = write!(polygon, " opacity=\"{opacity}\"");
        }
        self.elements.push(match title {
            "" => format!("<{polygon}/>"),
            _ => format!("<{polygon}><title>{}</title></polygon>", escape(title)),
        });
    }

    /// Fills a circle, or draws its outline.
    pub(super) fn circle(&mut self, middle: [f64; 2], radius: f64, color: Color, outline: Option<Stroke>) {
        let ([x, y], radius) = (self.place(middle), short(radius));
        let paint = outline.map_or_else(|| format!(" fill=\"{}\"", hex(color)), |stroke| stroked(color, stroke));
        self.elements.push(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{paint}/>"));
    }

    pub(super) fn rect(&mut self, corner_and_size: [[f64; 2]; 2], color: Color) {
        let rect = self.rect_attributes(corner_and_size);
        self.elements.push(format!("<rect{rect} fill=\"{}\"/>", hex(color)));
    }

    pub(super) fn text(&mut self, at: [f64; 2], anchor: Anchor, text: impl Into<String>) {
        self.put(Text::new(at, anchor, text));
    }

    pub(super) fn put(&mut self, Text { at, anchor, size, color, is_upright, text }: Text) {
        let [x, y] = self.place(at);
        let mut attributes = if is_upright {
            format!(" transform=\"translate({x} {y}) rotate(-90)\"")
        } else {
            format!(" x=\"{x}\" y=\"{y}\"")
        };
        attributes += match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        if size != TEXT {
            let _ = write!(attributes, " font-size=\"{size}\"");
        }
        if color != BLACK {
            let _ = write!(attributes, " fill=\"{}\"", hex(color));
        }
        self.elements.push(format!("<text{attributes}>{}</text>", escape(&text)));
    }

    /// Draws what `draw` adds in a rectangle only.
    pub(super) fn clipped(&mut self, corner_and_size: [[f64; 2]; 2], draw: impl FnOnce(&mut Self)) {
        let (number, rect) = (self.elements.len(), self.rect_attributes(corner_and_size));
        let clip = format!("<clipPath id=\"clip{number}\"><rect{rect}/></clipPath>");
        self.elements.push(format!("{clip}\n<g clip-path=\"url(#clip{number})\">"));
        draw(self);
        self.elements.push("</g>".to_owned());
    }

    /// Returns the drawing as an SVG document.
    pub fn svg(&self) -> String {
        let ([width, height], elements) = (self.size, self.elements.join("\n"));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Ubuntu, sans-serif\" font-size=\"{TEXT}\">\n{elements}\n</svg>\n"
        )
    }

    /// Returns a place of the last page in the document.
    fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [short(x), short(y + self.top)]
    }

    fn list(&self, points: &[[f64; 2]]) -> String {
        let places = points.iter().map(|point| self.place(*point));
        places.map(|[x, y]| format!("{x},{y}")).collect::<Vec<_>>().join(" ")
    }

    fn rect_attributes(&self, [corner, size]: [[f64; 2]; 2]) -> String {
        let ([x, y], [width, height]) = (self.place(corner), size.map(short));
        format!(" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
    }
}

fn stroked(color: Color, Stroke { width, dashes }: Stroke) -> String {
    let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
    let dashes = match &dashes[..] {
        [] => String::new(),
        dashes => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
    };
    format!(" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dashes}", hex(color))
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
