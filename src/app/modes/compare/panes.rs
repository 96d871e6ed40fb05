//! Panes of a comparison: their displays, their common camera, and the pointer over them.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Rect, Sense, Ui, UiBuilder, vec2};
use nalgebra::Vector2;

use super::grid::{self, Grid};
use super::setting::{PANES, PaneSetting};
use crate::app::diagnosis::{Errors, equilibrium_text};
use crate::app::language::{fill, tr};
use crate::app::session::compared_solve::Equations;
use crate::app::session::playback::Playback;
use crate::app::view_options::ViewOptions;
use crate::app::viewport::arrow::ForceArrows;
use crate::app::viewport::body_mesh::BodyMesh;
use crate::app::viewport::camera_controller::CameraController;
use crate::app::viewport::overlay::{self, Overlay};
use crate::app::viewport::pointer::{CameraMove, HitTargets, Interaction, Interactivity, Pointer};
use crate::app::viewport::projection::{Projection, viewport};
use crate::app::widgets::load_scale::OpeningLoads;
use crate::app::widgets::palette::{BODY, Palette};
use crate::assembly::System;
use crate::render::display_geometry::DisplayGeometry;
use crate::render::{Camera, View};
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::study::Reference;

/// Common input of the comparisons of equilibria and of motions.
pub(crate) struct PaneInput<'a> {
    pub scene: &'a Scene,
    pub view: &'a ViewOptions,
    /// Direction of the arrow of a zero force, degrees.
    pub direction: f64,
    /// Loads that the scene opens with.
    pub opening: OpeningLoads,
    /// `true` if camera movements are animated.
    pub eases: bool,
    /// Body that the panel describes in place of a search that has found no equilibrium.
    pub last: Option<&'a Simulation>,
    /// Equations of the body in Explore, which panes share if their mesh is the same.
    pub own: Equations,
}

/// Displayed body of a pane, and the pointer over it.
#[derive(Debug, Default)]
pub(super) struct PaneDisplay {
    /// Equations of the displayed body.
    pub system: Option<Arc<System>>,
    geometry: Arc<DisplayGeometry>,
    pub body_mesh: BodyMesh,
    /// Colour range of this pane alone; all panes are drawn with a common range that contains it.
    pub range: Option<[f64; 2]>,
    /// Area in which the body is drawn.
    pub place: Option<Rect>,
    pub pointer: Pointer,
}

impl PaneDisplay {
    /// Displays the state of a simulation, whose reference solution may be known, with `magnification` times its
    /// displacement; `played` is the playing time of a motion, s. The display geometry is taken from `known` if it is there.
    pub(super) fn update(
        &mut self,
        simulation: &Simulation,
        shown: (&ViewOptions, Option<&Reference>),
        magnification: f64,
        played: Option<f64>,
        known: &[Equations],
    ) {
        let system = simulation.system();
        if self.system.as_ref().is_none_or(|displayed| !Arc::ptr_eq(displayed, system)) {
            let shared = Equations::geometry_of(known, system);
            self.geometry = shared.unwrap_or_else(|| Arc::new(DisplayGeometry::new(system.mesh())));
            (self.body_mesh, self.range) = (BodyMesh::default(), None);
            self.system = Some(system.clone());
        }
        self.body_mesh.update(simulation, &self.geometry, shown, magnification, played);
        self.range = Some(self.body_mesh.range);
    }

    /// Returns the equations of a scene on the displayed mesh.
    pub(super) fn equations(&self, scene: &Scene) -> Option<Equations> {
        Some(Equations::new(scene, self.system.as_ref()?, Some(self.geometry.clone())))
    }

    /// Returns the loads of the displayed body at a simulated time, s.
    pub(super) fn forces<'a>(&'a self, scene: &'a Scene, time: f64, input: &PaneInput<'_>) -> Option<ForceArrows<'a>> {
        let (system, positions) = (self.system.as_ref()?, &self.body_mesh.nodes);
        Some(ForceArrows { scene, system, positions, time, direction: input.direction, opening: input.opening })
    }
}

/// Condition of a displayed state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Condition {
    /// The state is a result for its load.
    Result,
    /// The solve has not ended.
    Unfinished,
    /// The state belongs to an earlier load.
    Outdated,
    /// The state is no result: it is dimmed.
    Failed,
}

/// Pane of a comparison.
pub(super) trait ComparedPane {
    fn new(setting: PaneSetting) -> Self;
    fn own_setting(&self) -> PaneSetting;
    /// Returns the colour of the pane's method or integrator.
    fn color(&self, scene: &Scene, palette: &Palette) -> Color32;
    /// Changes the setting, and restarts.
    fn change_setting(&mut self, setting: PaneSetting);
    fn display(&self) -> &PaneDisplay;
    fn condition(&self) -> Condition;

    /// Returns the displayed scene and its simulated time, s, if there is one; and the display.
    fn parts(&mut self) -> (Option<(&Scene, f64)>, &mut PaneDisplay);

    /// Returns the scene whose state diverges, if an equilibrium is displayed in its place.
    fn unreached(&self) -> Option<&Scene> {
        None
    }

    fn display_mut(&mut self) -> &mut PaneDisplay {
        self.parts().1
    }
}

/// Change of a pane by its header: its new setting; `None` closes the pane.
pub(super) type PaneChange = Option<Option<PaneSetting>>;

/// Panes side by side.
#[derive(Debug)]
pub(super) struct Panes<P> {
    pub list: Vec<P>,
    /// Camera of all panes; `None` before the first frame.
    pub controller: Option<CameraController>,
    /// Factor of the drawn displacement in all panes.
    pub magnification: f64,
    /// Empty playback: the past of a motion is not drawn.
    still: Playback,
}

impl<P: ComparedPane> Panes<P> {
    /// Creates panes with these settings, at most four.
    pub(super) fn new(settings: &[PaneSetting]) -> Self {
        let mut panes = Self { list: Vec::new(), controller: None, magnification: 1.0, still: Playback::default() };
        panes.set(settings);
        panes
    }

    /// Replaces all panes by panes with these settings, at most four.
    pub(super) fn set(&mut self, settings: &[PaneSetting]) {
        self.list = settings.iter().take(*PANES.end()).map(|&setting| P::new(setting)).collect();
        self.fit();
    }

    /// Adds a pane.
    pub(super) fn add(&mut self, setting: PaneSetting) {
        self.list.push(P::new(setting));
        self.fit();
    }

    pub(super) fn settings(&self) -> Vec<PaneSetting> {
        self.list.iter().map(P::own_setting).collect()
    }

    /// Fits the camera to all bodies.
    pub(super) fn fit(&mut self) {
        self.controller.iter_mut().for_each(CameraController::fit);
    }

    /// Returns `true` if the user has moved the camera.
    pub(super) fn is_moved(&self) -> bool {
        self.controller.as_ref().is_some_and(CameraController::is_moved)
    }

    /// Returns the camera of all panes.
    pub(super) fn camera(&self) -> Camera {
        self.controller.as_ref().map_or(Camera { center: Vector2::zeros(), scale: 1.0 }, CameraController::camera)
    }

    /// Returns `true` if a load handle of a pane is grabbed; the view must not move then.
    pub(super) fn holds(&self) -> bool {
        self.list.iter().any(|pane| pane.display().pointer.holds())
    }

    /// Returns the bodies of the panes for the render pass.
    pub(super) fn views(&self, wireframe: bool, pixels_per_point: f32) -> Vec<View<'_>> {
        let camera = self.camera();
        let displays = self.list.iter().map(P::display);
        let seen = displays.filter_map(|PaneDisplay { place, body_mesh, geometry, .. }| {
            let viewport = viewport((*place)?, pixels_per_point);
            Some(View { viewport, frame: body_mesh.frame(geometry, wireframe), camera })
        });
        seen.collect()
    }

    /// Gives all panes the common colour range of the panes that `counts` selects, and returns it.
    pub(super) fn share_colors(&mut self, view: &ViewOptions, counts: impl Fn(&P) -> bool) -> [f64; 2] {
        let counted = self.list.iter().filter(|pane| counts(pane)).filter_map(|pane| pane.display().range);
        let range = view.fixed_range.unwrap_or(grid::common_range(counted));
        self.list.iter_mut().for_each(|pane| pane.display_mut().body_mesh.range = range);
        range
    }

    /// Divides the available area among the panes, whose headers have lines for `probes` probes.
    pub(super) fn lay_out(&mut self, ui: &Ui, probes: usize) -> Grid {
        let grid = Grid::new(ui.available_rect_before_wrap(), self.list.len(), probes);
        for (pane, cell) in self.list.iter_mut().zip(&grid.cells) {
            pane.display_mut().place = Some(grid.body_place(*cell));
        }
        grid
    }

    /// Returns the width and height, points, that the areas of all bodies have in common.
    pub(super) fn common_size(&self) -> Option<[f64; 2]> {
        grid::common_size(self.list.iter().filter_map(|pane| pane.display().place))
    }

    /// Animates the camera towards the bounding box that it fits.
    pub(super) fn aim(&mut self, ui: &Ui, fit: impl FnOnce([Vector2<f64>; 2]) -> Camera, eases: bool) {
        let dt = f64::from(ui.input(|i| i.stable_dt));
        if let Some(controller) = &mut self.controller
            && controller.aim(fit(controller.whole()), eases.then_some(dt))
        {
            ui.ctx().request_repaint();
        }
    }

    /// Shows the headers and the bodies, with the outline `exact` of the reference solution, m; returns the pointer's
    /// interaction with the load of a pane.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        grid: &Grid,
        (input, exact): (&PaneInput<'_>, &[Vec<Vector2<f64>>]),
        show_header: impl Fn(&Self, &mut Ui, usize) -> PaneChange,
    ) -> Interaction {
        let (mut changes, mut interaction) = (Vec::new(), Interaction::default());
        for (number, &cell) in grid.cells.iter().enumerate() {
            let place = grid.body_place(cell);
            let header = Rect::from_min_max(cell.min, place.right_top());
            let inner = UiBuilder::new().max_rect(header.shrink2(vec2(8.0, 3.0))).id_salt(("pane", number));
            let shown = ui.scope_builder(inner, |ui| {
                ui.set_clip_rect(header.intersect(ui.clip_rect()));
                ui.spacing_mut().item_spacing = vec2(6.0, 2.0);
                show_header(self, ui, number)
            });
            changes.extend(shown.inner.map(|change| (number, change)));
            let own = self.show_body(ui, (number, place), (input, number == 0), exact);
            if own.load.is_some() || own.restore.is_some() {
                interaction = own;
            }
        }
        for (number, change) in changes {
            ui.ctx().request_repaint();
            match change {
                Some(setting) => self.list.get_mut(number).into_iter().for_each(|pane| pane.change_setting(setting)),
                None if self.list.len() > *PANES.start() => {
                    self.list.remove(number);
                    self.fit();
                }
                None => {}
            }
        }
        interaction
    }

    /// Shows the pickers of a pane behind a mark of its colour, and the button that closes it. `shares` are the widths
    /// of the pickers as fractions of the row, and `widest` is the largest width, points.
    pub(super) fn show_pickers(
        &self,
        ui: &mut Ui,
        (number, color): (usize, Color32),
        input: &PaneInput<'_>,
        (shares, widest): ([f32; 3], f32),
        pick: impl FnOnce(&mut Ui, &str, [f32; 3], &mut PaneSetting),
    ) -> PaneChange {
        let before = self.list.get(number)?.own_setting();
        let (mut setting, mut is_closed) = (before, false);
        ui.horizontal(|ui| {
            let (bar, _) = ui.allocate_exact_size(vec2(10.0, 18.0), Sense::hover());
            ui.painter().rect_filled(bar, 3.0, color);
            let close = self.list.len() > *PANES.start() && input.view.bars;
            let room = ui.available_width() - if close { 34.0 } else { 0.0 } - 12.0;
            pick(ui, &pane_name(number), shares.map(|share| (share * room).clamp(30.0, widest)), &mut setting);
            is_closed = close && grid::close_button(ui, number);
        });
        if is_closed { Some(None) } else { (setting != before).then_some(Some(setting)) }
    }

    /// Shows the overlays of a pane's body, and the scale bar in the first visible one. Moving the view moves it in all
    /// panes.
    fn show_body(
        &mut self,
        ui: &Ui,
        (number, place): (usize, Rect),
        (input, is_first): (&PaneInput<'_>, bool),
        exact: &[Vec<Vector2<f64>>],
    ) -> Interaction {
        let (Some(controller), Some(pane)) = (&mut self.controller, self.list.get_mut(number)) else {
            return Interaction::default();
        };
        let (condition, wanted) = (pane.condition(), pane.unreached().cloned());
        let (model, display) = pane.parts();
        let projection = Projection { camera: controller.camera(), rect: place };
        let forces = model.and_then(|(scene, time)| display.forces(wanted.as_ref().unwrap_or(scene), time, input));
        let handles = forces.map_or_else(Vec::new, |forces| forces.handles(&projection));
        let system = display.system.as_deref();
        let targets = HitTargets {
            // States that are no result show no values.
            mesh: system.filter(|_| condition == Condition::Result).map(System::mesh),
            camera: projection.camera,
            positions: &display.body_mesh.nodes,
            outline: &display.geometry.boundary,
            handles: &handles,
            bases: &[],
            scales: controller.scales([place.width(), place.height()].map(f64::from)),
        };
        let response = ui.interact(place, ui.scope_id().with(("body", number)), Sense::click_and_drag());
        let interaction = display.pointer.process(ui, &response, &targets, Interactivity::None);
        match interaction.camera {
            CameraMove::None => {}
            CameraMove::To(camera) => {
                controller.set_camera(camera);
                ui.ctx().request_repaint();
            }
            CameraMove::Fit => controller.fit(),
        }
        let camera = controller.camera();
        let (palette, painter) = (Palette::new(ui.visuals()), ui.painter_at(place));
        if let Some(((scene, time), system)) = model.zip(system) {
            let note = wanted.as_ref().map(|wanted| equilibrium_text(scene, wanted));
            let overlay = Overlay {
                sections: &[],
                apart: false,
                scene,
                wanted: wanted.as_ref(),
                system,
                geometry: &display.geometry,
                options: input.view,
                camera,
                positions: &display.body_mesh.nodes,
                magnification: self.magnification,
                ghost: None,
                exact: if wanted.is_some() { &[] } else { exact },
                errors: Errors::default(),
                live: None,
                areas: [None; 2],
                time,
                direction: input.direction,
                opening: input.opening,
                hot: display.pointer.hot_handle(),
                mouse_spring: None,
                reactions: &[],
                playback: &self.still,
                color_range: display.body_mesh.range,
                has_values: display.body_mesh.has_values(),
                note: note.as_deref().map(|note| (note, palette.text)),
            };
            overlay::body(&painter, place, &overlay, ui.visuals());
        }
        if is_first {
            overlay::scale_bar(&painter, place, &camera, &palette);
        }
        match condition {
            Condition::Result | Condition::Unfinished => {}
            // An equilibrium in its place is dimmed already.
            Condition::Failed if wanted.is_some() => {}
            Condition::Failed => overlay::dim(&painter, place, &palette),
            Condition::Outdated => {
                overlay::dim(&painter, place, &palette);
                let font = FontId::proportional(BODY);
                painter.text(place.center(), Align2::CENTER_CENTER, tr("solving…"), font, palette.text);
            }
        }
        interaction
    }
}

/// Returns the name of a pane in the window.
pub(super) fn pane_name(number: usize) -> String {
    fill!("Pane %{n}", n = number + 1)
}
