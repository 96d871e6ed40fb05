//! Lines, shapes and texts, written as SVG on white paper; the window paints them in the colours of its theme.

use crate::study::figure::Ink;

/// Width and dashes of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stroke {
    pub width: f64,
    /// Lengths of dashes and gaps; none for a solid line.
    pub dashes: &'static [f64],
}

pub(crate) fn solid(width: f64) -> Stroke {
    Stroke { width, dashes: &[] }
}

/// Point of a text that lies at the given position.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Text<'a> {
    pub at: [f64; 2],
    pub anchor: Anchor,
    pub size: f64,
    pub ink: Ink,
    /// `true` if it is read from below.
    pub is_upright: bool,
    pub text: &'a str,
}

impl<'a> Text<'a> {
    /// Usual height, pixels.
    pub const SIZE: f64 = 13.0;

    pub fn new(at: [f64; 2], anchor: Anchor, text: &'a str) -> Self {
        Self { at, anchor, size: Self::SIZE, ink: Ink::Text, is_upright: false, text }
    }
}

/// Target on which charts are drawn: a file, or the window. Places are in pixels from its upper left corner.
pub(crate) trait DrawTarget {
    fn line(&mut self, points: &[[f64; 2]], ink: Ink, stroke: Stroke);

    /// Fills a polygon, with a text that viewers of a file show beside the pointer; it may be empty.
    fn polygon(&mut self, points: &[[f64; 2]], ink: Ink, opacity: f64, title: &str);

    /// Fills a circle, or draws its outline.
    fn circle(&mut self, middle: [f64; 2], radius: f64, ink: Ink, outline: Option<Stroke>);

    /// Fills a rectangle, which is given by its upper left corner and its size.
    fn rect(&mut self, corner_and_size: [[f64; 2]; 2], ink: Ink, opacity: f64);

    fn put(&mut self, text: Text<'_>);

    /// Draws what follows in a rectangle only, until it is called with `None`.
    fn clip(&mut self, corner_and_size: Option<[[f64; 2]; 2]>);

    fn text(&mut self, at: [f64; 2], anchor: Anchor, text: &str) {
        self.put(Text::new(at, anchor, text));
    }
}

/// A file of one page or of several, one below the other. Places are those on the last page.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// Size of all pages together.
    size: [f64; 2],
    /// Upper edge of the last page.
    top: f64,
    /// Elements of the SVG document.
    elements: Vec<String>,
}

impl DrawTarget for Drawing {
    fn line(&mut self, points: &[[f64; 2]], ink: Ink, stroke: Stroke) {
        let line = match points.iter().map(|point| self.place(*point)).collect::<Vec<_>>()[..] {
            [[x1, y1], [x2, y2]] => format!("line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\""),
            _ => format!("polyline points=\"{}\" stroke-linejoin=\"round\"", self.list(points)),
        };
        self.elements.push(format!("<{line}{}/>", stroked(ink, stroke)));
    }

    fn polygon(&mut self, points: &[[f64; 2]], ink: Ink, opacity: f64, title: &str) {
        let polygon = format!("polygon points=\"{}\"{}", self.list(points), filled(ink, opacity));
        self.elements.push(match title {
            "" => format!("<{polygon}/>"),
            _ => format!("<{polygon}><title>{}</title></polygon>", escape(title)),
        });
    }

    fn circle(&mut self, middle: [f64; 2], radius: f64, ink: Ink, outline: Option<Stroke>) {
        let ([x, y], radius) = (self.place(middle), short(radius));
        let paint = outline.map_or_else(|| filled(ink, 1.0), |stroke| stroked(ink, stroke));
        self.elements.push(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{paint}/>"));
    }

    fn rect(&mut self, corner_and_size: [[f64; 2]; 2], ink: Ink, opacity: f64) {
        let rect = self.rect_attributes(corner_and_size);
        self.elements.push(format!("<rect{rect}{}/>", filled(ink, opacity)));
    }

    fn put(&mut self, Text { at, anchor, size, ink, is_upright, text }: Text<'_>) {
        let [x, y] = self.place(at);
        let place = match is_upright {
            true => format!(" transform=\"translate({x} {y}) rotate(-90)\""),
            false => format!(" x=\"{x}\" y=\"{y}\""),
        };
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let size = if size == Text::SIZE { String::new() } else { format!(" font-size=\"{size}\"") };
        let fill = if ink == Ink::Text { String::new() } else { format!(" fill=\"{}\"", hex(ink)) };
        self.elements.push(format!("<text{place}{anchor}{size}{fill}>{}</text>", escape(text)));
    }

    fn clip(&mut self, corner_and_size: Option<[[f64; 2]; 2]>) {
        let number = self.elements.len();
        let start = corner_and_size.map(|rect| {
            let clip = format!("<clipPath id=\"clip{number}\"><rect{}/></clipPath>", self.rect_attributes(rect));
            format!("{clip}\n<g clip-path=\"url(#clip{number})\">")
        });
        self.elements.push(start.unwrap_or_else(|| "</g>".to_owned()));
    }
}

impl Drawing {
    /// Adds white paper.
    pub(super) fn page(&mut self, size: [f64; 2]) {
        self.top = self.size[1];
        self.size = [self.size[0].max(size[0]), self.top + size[1]];
        self.rect([[0.0; 2], size], Ink::Paper, 1.0);
    }

    /// Returns the drawing as an SVG document.
    pub fn svg(&self) -> String {
        let ([width, height], text, elements) = (self.size, Text::SIZE, self.elements.join("\n"));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Ubuntu, sans-serif\" font-size=\"{text}\">\n{elements}\n</svg>\n"
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

fn filled(ink: Ink, opacity: f64) -> String {
    let opacity = if opacity < 1.0 { format!(" opacity=\"{opacity}\"") } else { String::new() };
    format!(" fill=\"{}\"{opacity}", hex(ink))
}

fn stroked(ink: Ink, Stroke { width, dashes }: Stroke) -> String {
    let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
    let dashes = if dashes.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", dashes.join(" ")) };
    format!(" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dashes}", hex(ink))
}

/// Rounds to hundredths of a pixel.
fn short(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

/// Returns a colour on white paper.
fn hex(ink: Ink) -> String {
    let [r, g, b] = match ink {
        Ink::Paper => [0xff; 3],
        Ink::Text => [0; 3],
        Ink::Grid => [0xdd; 3],
        Ink::Curve | Ink::Load | Ink::Reference => [0x33; 3],
        Ink::Limit => [0x55; 3],
        Ink::Solution([light, _]) => light,
        Ink::Unstable => [0xbe, 0x14, 0x1e],
        Ink::BeamTheory | Ink::Scene => [0x1c, 0x21, 0x28],
        Ink::Fixed(color) => color,
    };
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
