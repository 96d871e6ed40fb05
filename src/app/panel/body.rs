//! Panel section of the material and the mesh.

use super::*;
use crate::app::session::has_mesh_of;
use crate::scene::Plane;

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
        NumberField::new("Young E", const { keys::range("material.young") }, 1e3..=1e12)
            .logarithmic(1e3)
            .tip("Young's modulus, Pa: stiffness of the material. Rubber 1e6, wood 1e10, steel 2e11.")
            .row(|s| s.material.young, |s, v| s.material.young = v),
        NumberField::new("Poisson ν", plane.poisson_limit(), -0.5..=0.499)
            .tip(
                "Poisson's ratio: lateral contraction over extension. 0.5 keeps the volume; plane strain needs less \
                 than 0.5.",
            )
            .row(|s| s.material.poisson, |s, v| s.material.poisson = v),
        NumberField::new("Density", const { keys::range("material.density") }, 0.0..=20_000.0)
            .logarithmic(1.0)
            .tip("Density, kg/m³: sets the weight, and the inertia in motion.")
            .row(|s| s.material.density, |s, v| s.material.density = v),
        NumberField::new("Thickness t", const { keys::range("material.thickness") }, 1e-3..=10.0)
            .logarithmic(1e-3)
            .tip("Thickness out of the plane, m: stiffness and weight are proportional to it.")
            .row(|s| s.material.thickness, |s, v| s.material.thickness = v),
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

const CELLS: limits::Limit = keys::range("beam.cells");

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
            (f64::from(cells) * now / size).round().clamp(CELLS.min, CELLS.max) as u32
        };
        let from = reference.filter(|&from| at(from, old) == cells).unwrap_or((old, cells));
        *reference = Some(from);
        at(from, new)
    }
}

pub(super) fn size(ui: &mut Ui, panel: &mut Panel<'_>, beam: &Beam) {
    const SPAN: f64 = 10.0;
    let Some(original) = &panel.session.document().original.beam else { return };
    const LENGTH: &str =
        "Length of the beam, m. The number of cells along it adapts; points with loads or supports move with it.";
    const HEIGHT: &str =
        "Height of the beam, m. The number of cells across it adapts; points with loads or supports move with it.";
    let sides = [
        ("Length", const { keys::range("beam.length") }, LENGTH),
        ("Height", const { keys::range("beam.height") }, HEIGHT),
    ];
    for (axis, (label, limit, tip)) in sides.into_iter().enumerate() {
        let [present, original] = [beam, original].map(|beam| [beam.length, beam.height][axis]);
        let field = NumberField::new(label, limit, original / SPAN..=original * SPAN);
        let field = field.logarithmic(original / SPAN).tip(tip);
        let Some(new) = panel.number(ui, &field, present, Some(original)) else { continue };
        let cells = panel.state.cells.count(axis, [present, new], beam.cells[axis]);
        panel.edit(field.label, |scene| {
            let (length, height) = if axis == 0 { (new, beam.height) } else { (beam.length, new) };
            scene.resize_beam(length, height);
            scene.beam.iter_mut().for_each(|beam| beam.cells[axis] = cells);
        });
    }
    let slenderness = number(three_digits(beam.length / beam.height));
    ui.label(fill!("Slenderness, length over height: %{slenderness}", slenderness));
}

/// Returns a summary of the mesh, such as `5 × 1, 24 unknowns`.
pub(super) fn mesh_summary(session: &Session) -> String {
    let beam = session.scene().beam.as_ref();
    let cells =
        beam.map_or_else(|| tr("from a file").to_owned(), |beam| format!("{} × {}", beam.cells[0], beam.cells[1]));
    let simulation = session.simulation();
    let unknowns = || count(simulation.system().dofs() as u64, "unknown");
    joined([cells].into_iter().chain(has_mesh_of(simulation.scene(), session.scene()).then(unknowns)))
}

pub(super) fn material(ui: &mut Ui, panel: &mut Panel<'_>) {
    let present = panel.scene.material;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let presets = PRESETS.map(|MaterialPreset { name, young, poisson, density, .. }| {
            let tip = format!("E {}, ν {poisson}, {}", engineering(young, "Pa"), engineering(density, "kg/m³"));
            (Material { young, poisson, density, ..present }, name, tip)
        });
        if let Some(preset) = options(ui, presets, Some(present)).filter(|preset| *preset != present) {
            panel.edit("Young E", |scene| scene.material = preset);
        }
    });
    panel.rows(ui, material_rows(present.plane));
    ui.horizontal(|ui| {
        ui.label(tr("Plane"));
        for (plane, word, tip) in [
            (Plane::Stress, "stress", "Plane stress: no stress out of the plane, as in a thin plate."),
            (Plane::Strain, "strain", "Plane strain: no strain out of the plane, as in a slice of a long body."),
        ] {
            let chosen = present.plane == plane;
            if ui.radio(chosen, tr(word)).on_hover_text(tr(tip)).clicked() && !chosen {
                panel.edit("Plane", |scene| scene.material.plane = plane);
            }
        }
    });
    show_message(ui, &panel.state.messages, "Plane");
}

pub(super) fn mesh(ui: &mut Ui, panel: &mut Panel<'_>) {
    for (axis, label, tip, most) in [
        (0, "Cells along", "Cells along the beam; each is two triangles or a quadrilateral.", 400.0),
        (1, "Cells across", "Cells across the beam; each is two triangles or a quadrilateral.", 40.0),
    ] {
        let field = NumberField::new(label, CELLS, 1.0..=most).logarithmic(1.0).whole().tip(tip);
        let cells = |scene: &Scene| scene.beam.as_ref().map(|beam| f64::from(beam.cells[axis]));
        panel.field(ui, &field, cells, |scene, new| {
            scene.beam.iter_mut().for_each(|beam| beam.cells[axis] = new as u32);
        });
    }
}
