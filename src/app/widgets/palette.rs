//! All colours and font sizes of the window, for both themes. Tests check the contrasts that WCAG 2.1 requires.

use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Theme, Visuals};

use crate::app::prelude::*;
use crate::render::colormap::ColorMap;
use crate::study::Setting;
use crate::study::figure::Ink;

/// Size of body text, points.
pub(crate) const BODY: f32 = 14.0;
/// Size of small text, points.
pub(crate) const SMALL: f32 = 12.0;
/// Size of the numbers in the status bar, points.
pub(crate) const HEADLINE: f32 = 18.0;

/// Declares the colours of a theme, each on dark and on light.
macro_rules! palette {
    ($($(#[$about:meta])* $name:ident: $dark:literal, $light:literal;)*) => {
        /// Colours of a theme.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(crate) struct Palette {
            dark: bool,
            $($(#[$about])* pub $name: Color32,)*
            /// Element sides over the colours of the body, with straight (not premultiplied) alpha.
            pub wire: [u8; 4],
        }

        impl Palette {
            const fn of(dark: bool) -> Self {
                let wire = if dark { [12, 20, 32, 120] } else { [255, 255, 255, 110] };
                Self { dark, $($name: rgb(if dark { $dark } else { $light }),)* wire }
            }
        }
    };
}

palette! {
    /// Background of the body.
    canvas: 0x1E2228, 0xF6F7F9;
    /// Background of the panels.
    panel: 0x262B33, 0xEAEDF1;
    /// Background of buttons; `hovered` is the one under the pointer.
    control: 0x363D48, 0xD8DDE4;
    hovered: 0x454E5C, 0xC8CFD9;
    /// Separator lines.
    line: 0x3A414C, 0xC9CFD8;
    text: 0xE6E9EF, 0x1C2128;
    secondary: 0xA9B1BD, 0x4A5360;
    /// Selected controls, and the control with the keyboard focus.
    accent: 0x6CB6FF, 0x0B5CAD;
    /// Background of selected controls.
    chosen: 0x2F4A6B, 0xBFDAF5;
    good: 0x7CDB9A, 0x0B6B35;
    warning: 0xF2C14E, 0x7A5000;
    error: 0xFF8A80, 0xA31B1B;
    /// An error above 5 %, as in How far; `error` is a failure.
    large: 0xFF9F5A, 0x9A3F00;
    /// Background of error messages.
    error_chip: 0x44282C, 0xFBE3E1;
    /// Outline of the reference solution (`exact`), and of the body at rest (`rest`).
    exact: 0x4FD1C5, 0x007D73;
    rest: 0x6E7784, 0x7E8793;
    support: 0xB4BBC6, 0x464E5A;
    load: 0xFF6B61, 0xC0242B;
    mouse_spring: 0x78DC82, 0x0A7828;
    /// Colour of bodies without values of the field.
    absent: 0x7C8088, 0x7C8088;
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const DARK: Palette = Palette::of(true);
const LIGHT: Palette = Palette::of(false);

impl Default for Palette {
    fn default() -> Self {
        DARK
    }
}

impl Palette {
    /// Returns the palette that matches `visuals`.
    pub(crate) fn new(visuals: &Visuals) -> Self {
        if visuals.dark_mode { DARK } else { LIGHT }
    }

    /// Returns the colour of a line or a text of a chart.
    pub(crate) fn ink(&self, ink: Ink) -> Color32 {
        let fixed = |[r, g, b]: [u8; 3]| Color32::from_rgb(r, g, b);
        match ink {
            Ink::Paper => self.canvas,
            Ink::Text | Ink::Scene => self.text,
            Ink::Grid => self.line,
            Ink::Reference => self.exact,
            Ink::Limit => self.secondary,
            Ink::Load => self.load,
            Ink::Solution(colors) => fixed(colors[usize::from(self.dark)]),
            Ink::Unstable => self.error,
            Ink::Fixed(color) => fixed(color),
        }
    }

    /// Returns the colour of a scene's method, or of its integrator for a motion.
    pub(crate) fn solution(&self, scene: &Scene) -> Color32 {
        self.ink(Ink::of(&Setting::of(scene)))
    }

    /// Returns the colours of the kinds of energy: kinetic, elastic, potential, dissipated, lost, put in.
    pub(crate) fn energies(&self) -> [Color32; 6] {
        if self.dark {
            [0x6EAAFF, 0xFFB450, 0x78D282, 0xAAAAB4, 0xFF7878, 0xC896FF].map(rgb)
        } else {
            [0x145AC8, 0x9A5000, 0x147832, 0x62626C, 0xC81E28, 0x7832BE].map(rgb)
        }
    }

    /// Returns the colour map of a field: diverging about zero if its sign matters.
    pub(crate) fn map(&self, field: Field) -> ColorMap {
        match (field.has_sign(), self.dark) {
            (false, true) => ColorMap::SequentialOnDark,
            (false, false) => ColorMap::SequentialOnLight,
            (true, true) => ColorMap::DivergingOnDark,
            (true, false) => ColorMap::DivergingOnLight,
        }
    }

    fn visuals(&self) -> Visuals {
        let mut visuals = if self.dark { Visuals::dark() } else { Visuals::light() };
        let round = CornerRadius::same(5);
        visuals.panel_fill = self.panel;
        visuals.window_fill = self.panel;
        visuals.window_stroke = Stroke::new(1.0, self.line);
        visuals.extreme_bg_color = self.canvas;
        visuals.faint_bg_color = self.canvas;
        visuals.weak_text_color = Some(self.secondary);
        visuals.warn_fg_color = self.warning;
        visuals.error_fg_color = self.error;
        visuals.hyperlink_color = self.accent;
        visuals.selection.bg_fill = self.chosen;
        visuals.selection.stroke = Stroke::new(1.0, self.text);
        visuals.slider_trailing_fill = true;
        let widgets = &mut visuals.widgets;
        for (widget, fill, edge) in [
            (&mut widgets.noninteractive, self.panel, self.line),
            (&mut widgets.inactive, self.control, Color32::TRANSPARENT),
            (&mut widgets.hovered, self.hovered, Color32::TRANSPARENT),
            (&mut widgets.active, self.hovered, self.accent),
            (&mut widgets.open, self.hovered, Color32::TRANSPARENT),
        ] {
            widget.bg_fill = fill;
            widget.weak_bg_fill = fill;
            widget.bg_stroke = Stroke::new(if edge == Color32::TRANSPARENT { 0.0 } else { 1.0 }, edge);
            widget.fg_stroke = Stroke::new(1.0, self.text);
            widget.corner_radius = round;
            widget.expansion = 0.0;
        }
        visuals
    }
}

/// Installs the colours and font sizes of both themes, once per context.
pub(crate) fn install(ctx: &egui::Context) {
    let installed = egui::Id::unique("palette");
    if ctx.data(|data| data.get_temp::<bool>(installed)).is_some() {
        return;
    }
    ctx.data_mut(|data| data.insert_temp(installed, true));
    add_font(ctx);
    for (theme, palette) in [(Theme::Dark, DARK), (Theme::Light, LIGHT)] {
        ctx.style_mut_of(theme, |style| {
            style.visuals = palette.visuals();
            style.text_styles.extend([
                (TextStyle::Body, FontId::proportional(BODY)),
                (TextStyle::Button, FontId::proportional(BODY)),
                (TextStyle::Monospace, FontId::monospace(13.0)),
                (TextStyle::Small, FontId::proportional(SMALL)),
                (TextStyle::Heading, FontId::proportional(HEADLINE)),
            ]);
            style.spacing.item_spacing = egui::vec2(8.0, 6.0);
            style.spacing.button_padding = egui::vec2(8.0, 3.0);
            style.spacing.interact_size.y = 24.0;
            style.spacing.slider_rail_height = 5.0;
            // Long lists may be as high as their content.
            style.spacing.default_area_size.y = 4000.0;
        });
    }
}

/// Adds the font for the characters that egui's own fonts lack.
fn add_font(ctx: &egui::Context) {
    let data = egui::FontData::from_static(crate::image::CHINESE_FONT);
    let place = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
    let families = vec![place(FontFamily::Proportional), place(FontFamily::Monospace)];
    ctx.add_font(FontInsert::new("Noto Sans SC", data, families));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::INTEGRATORS;
    use crate::method::METHODS;

    /// Returns the relative luminance of WCAG 2.1.
    fn luminance(color: Color32) -> f64 {
        let linear = [color.r(), color.g(), color.b()].map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    /// Returns the contrast ratio of WCAG 2.1.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn contrast_is_that_of_wcag() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        assert!((contrast(rgb(0x777777), Color32::WHITE) - 4.478).abs() < 1e-3);
    }

    /// Text has a contrast of 4.5:1 on every background that it is used on.
    #[test]
    fn text_can_be_read() {
        for p in [DARK, LIGHT] {
            for (name, text) in [("text", p.text), ("secondary", p.secondary)] {
                for ground in [p.canvas, p.panel, p.control] {
                    assert!(contrast(text, ground) >= 4.5, "{name} on {ground:?}: {}", contrast(text, ground));
                }
            }
            for ground in [p.hovered, p.chosen, p.error_chip] {
                assert!(contrast(p.text, ground) >= 4.5, "text on {ground:?}: {}", contrast(p.text, ground));
            }
            for (name, color) in [
                ("good", p.good),
                ("warning", p.warning),
                ("error", p.error),
                ("large", p.large),
                ("accent", p.accent),
                ("load", p.load),
                ("hand", p.mouse_spring),
            ] {
                for ground in [p.canvas, p.panel] {
                    assert!(contrast(color, ground) >= 4.5, "{name} on {ground:?}: {}", contrast(color, ground));
                }
            }
            assert!(contrast(p.error, p.error_chip) >= 4.5);
        }
    }

    /// Graphics have a contrast of 3:1: every colour of every map, and every line.
    #[test]
    fn the_body_and_its_lines_stand_out_from_the_canvas() {
        for p in [DARK, LIGHT] {
            for field in Field::ALL {
                for i in 0..=255 {
                    let [r, g, b] = p.map(field).color(f64::from(i) / 255.0);
                    let ratio = contrast(Color32::from_rgb(r, g, b), p.canvas);
                    assert!(ratio >= 3.0, "{field:?} at {i}/255 on {:?}: {ratio}", p.canvas);
                }
            }
            let methods = METHODS.iter().map(|m| p.ink(Ink::Solution(m.colors)));
            let integrators = INTEGRATORS.iter().map(|i| p.ink(Ink::Solution(i.colors)));
            let lines = [p.exact, p.rest, p.support, p.absent];
            for color in methods.chain(integrators).chain(lines).chain(p.energies()) {
                assert!(contrast(color, p.canvas) >= 3.0, "{color:?}: {}", contrast(color, p.canvas));
            }
        }
    }
}
