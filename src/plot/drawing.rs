//! Lines, shapes and texts, written as SVG on white paper; the window paints them in the colours of its theme.

use crate::study::figure::Ink;

/// Point of a text that lies at the given position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
    /// Middle of a text that is read from below.
    Upright,
}

/// Size of the boxes of a key.
pub(super) const KEY_BOX: f64 = 14.0;

/// Target on which charts are drawn: a file, or the window. Places are in pixels from its upper left corner.
pub(crate) trait DrawTarget {
    /// Draws a line through points. `dashes` are the lengths of its dashes and gaps, none for a solid line.
    fn line(&mut self, points: &[[f64; 2]], ink: Ink, width: f64, dashes: &[f64]);

    fn polygon(&mut self, points: &[[f64; 2]], ink: Ink, opacity: f64);

    /// Fills a circle, or draws its outline with a line of this width.
    fn circle(&mut self, middle: [f64; 2], radius: f64, ink: Ink, outline: Option<f64>);

    /// Fills a rectangle, which is given by its upper left corner and its size.
    fn rect(&mut self, corner_and_size: [[f64; 2]; 2], ink: Ink, opacity: f64);

    fn text(&mut self, at: [f64; 2], anchor: Anchor, ink: Ink, text: &str);

    /// Draws what follows in a rectangle only, until it is called with `None`.
    fn clip(&mut self, corner_and_size: Option<[[f64; 2]; 2]>);
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
    fn line(&mut self, points: &[[f64; 2]], ink: Ink, width: f64, dashes: &[f64]) {
        let dashes = dashes.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let dashes = if dashes.is_empty() { dashes } else { format!(" stroke-dasharray=\"{dashes}\"") };
        let (points, line) = (self.list(points), outlined(ink, width));
        self.elements.push(format!("<polyline points=\"{points}\"{line}{dashes}/>"));
    }

    fn polygon(&mut self, points: &[[f64; 2]], ink: Ink, opacity: f64) {
        self.elements.push(format!("<polygon points=\"{}\"{}/>", self.list(points), filled(ink, opacity)));
    }

    fn circle(&mut self, middle: [f64; 2], radius: f64, ink: Ink, outline: Option<f64>) {
        let ([x, y], radius) = (self.place(middle), short(radius));
        let paint = outline.map_or_else(|| filled(ink, 1.0), |width| outlined(ink, width));
        self.elements.push(format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{paint}/>"));
    }

    fn rect(&mut self, corner_and_size: [[f64; 2]; 2], ink: Ink, opacity: f64) {
        let rect = self.rect_attributes(corner_and_size);
        self.elements.push(format!("<rect{rect}{}/>", filled(ink, opacity)));
    }

    fn text(&mut self, at: [f64; 2], anchor: Anchor, ink: Ink, text: &str) {
        let ([x, y], color, text) = (self.place(at), hex(ink), escape(text));
        let place = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
            Anchor::Upright => &format!(" text-anchor=\"middle\" transform=\"rotate(-90 {x} {y})\""),
        };
        self.elements.push(format!("<text x=\"{x}\" y=\"{y}\"{place} fill=\"{color}\">{text}</text>"));
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
    /// Adds white paper with a title, which begins at `left`; it may be empty.
    pub(super) fn page(&mut self, size: [f64; 2], left: f64, title: &str) {
        self.top = self.size[1];
        self.size = [self.size[0].max(size[0]), self.top + size[1]];
        self.rect([[0.0; 2], size], Ink::Paper, 1.0);
        let ([x, y], title) = (self.place([left, 28.0]), escape(title));
        self.elements.push(format!("<text x=\"{x}\" y=\"{y}\" font-size=\"16\">{title}</text>"));
    }

    /// Draws an entry of a key, a box in its colour with its name; returns the left end of the next one.
    pub(super) fn key(&mut self, [x, y]: [f64; 2], (ink, name): (Ink, &str)) -> f64 {
        self.rect([[x, y], [KEY_BOX; 2]], ink, 1.0);
        self.text([x + KEY_BOX + 6.0, y + 12.0], Anchor::Start, Ink::Text, name);
        x + 46.0 + 7.4 * name.chars().count() as f64
    }

    /// Returns the drawing as an SVG document.
    pub fn svg(&self) -> String {
        let ([width, height], elements) = (self.size, self.elements.join("\n"));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             font-family=\"Ubuntu, sans-serif\" font-size=\"13\" stroke-linejoin=\"round\">\n{elements}\n</svg>\n"
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
    format!(" fill=\"{}\" opacity=\"{opacity}\"", hex(ink))
}

fn outlined(ink: Ink, width: f64) -> String {
    format!(" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"", hex(ink))
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
        Ink::Load | Ink::Reference => [0x33; 3],
        Ink::Limit => [0x55; 3],
        Ink::Solution([light, _]) => light,
        Ink::Unstable => [0xbe, 0x14, 0x1e],
        Ink::Scene => [0x1c, 0x21, 0x28],
        Ink::Fixed(color) => color,
    };
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
