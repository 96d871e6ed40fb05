//! Panel section of the material and the mesh.

use crate::app::session::has_mesh_of;
use egui::Ui;

use crate::app::language::{count, fill, joined, tr};
use crate::app::panel::{Action, NumberRow, PanelState, number_rows};
use crate::app::readout::Readout;
use crate::app::widgets::buttons::option_button;
use crate::app::widgets::number_field::{NumberField, SliderScale, show_message};
use crate::format::{engineering, number, three_digits};
use crate::scene::{Beam, Material, Plane, Scene, limits};

/// Named material.
struct MaterialPreset {
    name: &'static str,
    /// Young's modulus, Pa, and the `range` of moduli that are still given this name.
    young: f64,
    range: std::ops::RangeInclusive<f64>,
    poisson: f64,
    /// Density, kg/m³.
    density: f64,
}

const PRESETS: [MaterialPreset; 4] = [
    MaterialPreset { name: "Rubber", young: 1e6, range: 1e5..=5e7, poisson: 0.49, density: 1100.0 },
    MaterialPreset { name: "Wood", young: 1.1e10, range: 8e9..=1.5e10, poisson: 0.35, density: 600.0 },
    MaterialPreset { name: "Aluminium", young: 7e10, range: 6.5e10..=7.5e10, poisson: 0.33, density: 2700.0 },
    MaterialPreset { name: "Steel", young: 2.1e11, range: 1.9e11..=2.2e11, poisson: 0.3, density: 7850.0 },
];

/// Returns the rows of the material. The limit of Poisson's ratio differs between plane stress and plane strain.
fn material_rows(plane: Plane) -> [NumberRow; 4] {
    [
        NumberRow {
            field: NumberField {
                label: "Young E",
                tooltip: "Young's modulus, Pa: stiffness of the material. Rubber 1e6, wood 1e10, steel 2e11.",
                limit: limits::YOUNG,
                slider: 1e3..=1e12,
                scale: SliderScale::Logarithmic(1e3),
                whole: false,
            },
            get: |s| s.material.young,
            set: |s, v| s.material.young = v,
        },
        NumberRow {
            field: NumberField {
                label: "Poisson ν",
                tooltip: "Poisson's ratio: lateral contraction over extension. 0.5 keeps the volume; plane strain \
                          needs less than 0.5.",
                limit: plane.poisson_limit(),
                slider: -0.5..=0.499,
                scale: SliderScale::Linear,
                whole: false,
            },
            get: |s| s.material.poisson,
            set: |s, v| s.material.poisson = v,
        },
        NumberRow {
            field: NumberField {
                label: "Density",
                tooltip: "Density, kg/m³: sets the weight, and the inertia in motion.",
                limit: limits::DENSITY,
                slider: 0.0..=20_000.0,
                scale: SliderScale::Logarithmic(1.0),
                whole: false,
            },
            get: |s| s.material.density,
            set: |s, v| s.material.density = v,
        },
        NumberRow {
            field: NumberField {
                label: "Thickness t",
                tooltip: "Thickness out of the plane, m: stiffness and weight are proportional to it.",
                limit: limits::THICKNESS,
                slider: 1e-3..=10.0,
                scale: SliderScale::Logarithmic(1e-3),
                whole: false,
            },
            get: |s| s.material.thickness,
            set: |s, v| s.material.thickness = v,
        },
    ]
}

/// Returns a summary of the material, such as `rubber, 1 MPa`.
pub(super) fn material_summary(scene: &Scene) -> String {
    let Material { young, density, .. } = scene.material;
    let is_like =
        |preset: &&MaterialPreset| preset.range.contains(&young) && (0.5..=2.0).contains(&(density / preset.density));
    let name = PRESETS.iter().find(is_like).map(|preset| tr(preset.name).to_lowercase());
    joined(name.into_iter().chain([engineering(young, "Pa")]))
}

/// Returns length and height of a beam, such as `3 m × 1 m`.
pub(super) fn size_summary(beam: &Beam) -> String {
    format!("{} × {}", engineering(beam.length, "m"), engineering(beam.height, "m"))
}

/// Numbers of cells that follow the size of a beam, so that the size of a cell stays about the same; in a much smaller
/// beam, whose size has been typed in other units, the number stays.
#[derive(Debug, Default)]
pub(super) struct CellsThatFollow {
    /// Length or height, m, and number of cells that new numbers are computed from.
    references: [Option<(f64, u32)>; 2],
}

impl CellsThatFollow {
    /// Returns the number of cells of a side that is now `new` m long, and was `old` m long with `cells` cells. All
    /// calls use the same reference, so that small steps do not add up rounding errors, until the number of cells is
    /// set otherwise.
    fn count(&mut self, axis: usize, [old, new]: [f64; 2], cells: u32) -> u32 {
        /// Ratio of the new size to that of the reference below which the number of cells stays.
        const SMALLER: f64 = 0.2;
        let Some(reference) = self.references.get_mut(axis) else { return cells };
        let at = |(size, cells): (f64, u32), now: f64| {
            if now < SMALLER * size {
                return cells;
            }
            (f64::from(cells) * now / size).round().clamp(limits::CELLS.min, limits::CELLS.max) as u32
        };
        let from = reference.filter(|&from| at(from, old) == cells).unwrap_or((old, cells));
        *reference = Some(from);
        at(from, new)
    }
}

/// Shows length and height of the beam.
pub(super) fn size(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let (Some(beam), Some(original)) = (&input.scene.beam, &input.original.beam) else { return };
    let sides = [
        (
            "Length",
            "Length of the beam, m. The number of cells along it adapts; points with loads or supports move with it.",
            limits::LENGTH,
            [beam.length, original.length],
        ),
        (
            "Height",
            "Height of the beam, m. The number of cells across it adapts; points with loads or supports move with it.",
            limits::HEIGHT,
            [beam.height, original.height],
        ),
    ];
    for (axis, (label, tooltip, limit, [present, original])) in sides.into_iter().enumerate() {
        const SPAN: f64 = 10.0;
        let field = NumberField {
            label,
            tooltip,
            limit,
            slider: original / SPAN..=original * SPAN,
            scale: SliderScale::Logarithmic(original / SPAN),
            whole: false,
        };
        let Some(new) = field.show_with_original(ui, &mut state.messages, present, Some(original)) else { continue };
        let mut scene = Box::new(input.scene.clone());
        let (length, height) = if axis == 0 { (new, beam.height) } else { (beam.length, new) };
        scene.resize_beam(length, height);
        if let Some(cells) = scene.beam.as_mut().and_then(|beam| beam.cells.get_mut(axis)) {
            *cells = state.cells.count(axis, [present, new], *cells);
        }
        actions.push(Action::Edit(label, scene));
    }
    let slenderness = number(three_digits(beam.length / beam.height));
    ui.label(fill!("Slenderness, length over height: %{slenderness}", slenderness = slenderness));
}

/// Returns a summary of the mesh, such as `5 × 1, 24 unknowns`.
pub(super) fn mesh_summary(input: &Readout<'_>) -> String {
    let cells = input
        .scene
        .beam
        .as_ref()
        .map_or_else(|| tr("from a file").to_owned(), |beam| format!("{} × {}", beam.cells[0], beam.cells[1]));
    let made = input.simulation.scene();
    if !has_mesh_of(made, input.scene) {
        return cells;
    }
    joined([cells, count(input.simulation.system().dofs() as u64, "unknown")])
}

pub(super) fn material(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        for MaterialPreset { name, young, poisson, density, .. } in PRESETS {
            let preset = Material { young, poisson, density, ..scene.material };
            let tip = format!("E {}, ν {poisson}, {}", engineering(young, "Pa"), engineering(density, "kg/m³"));
            let chosen = preset == scene.material;
            if ui.add(option_button(chosen, tr(name))).on_hover_text(tip).clicked() && !chosen {
                actions.push(Action::Edit("Young E", Box::new(Scene { material: preset, ..scene.clone() })));
            }
        }
    });
    number_rows(ui, input, state, actions, material_rows(scene.material.plane));
    let m = &scene.material;
    ui.horizontal(|ui| {
        ui.label(tr("Plane"));
        for (plane, word, tip) in [
            (Plane::Stress, "stress", "Plane stress: no stress out of the plane, as in a thin plate."),
            (Plane::Strain, "strain", "Plane strain: no strain out of the plane, as in a slice of a long body."),
        ] {
            if ui.radio(m.plane == plane, tr(word)).on_hover_text(tr(tip)).clicked() && m.plane != plane {
                let mut scene = Box::new(scene.clone());
                scene.material.plane = plane;
                actions.push(Action::Edit("Plane", scene));
            }
        }
    });
    show_message(ui, &state.messages, "Plane");
}

pub(super) fn mesh(ui: &mut Ui, input: &Readout<'_>, state: &mut PanelState, actions: &mut Vec<Action>) {
    let scene = input.scene;
    for (axis, label, tooltip, most) in [
        (0, "Cells along", "Cells along the beam; each is two triangles or a quadrilateral.", 400.0),
        (1, "Cells across", "Cells across the beam; each is two triangles or a quadrilateral.", 40.0),
    ] {
        let field = NumberField {
            label,
            tooltip,
            limit: limits::CELLS,
            slider: 1.0..=most,
            scale: SliderScale::Logarithmic(1.0),
            whole: true,
        };
        let Some(beam) = &scene.beam else { continue };
        let original = input.original.beam.as_ref().map(|beam| f64::from(beam.cells[axis]));
        if let Some(new) = field.show_with_original(ui, &mut state.messages, f64::from(beam.cells[axis]), original) {
            let mut scene = Box::new(scene.clone());
            if let Some(beam) = &mut scene.beam {
                beam.cells[axis] = new as u32;
            }
            actions.push(Action::Edit(label, scene));
        }
    }
}
