//! View of the body of Explore and Learn: its camera, menu, pinned point, and overlays.

use crate::app::interface::*;
use crate::app::session::has_mesh_of;
use crate::app::viewport::arrow::LoadArrow;
use crate::app::viewport::bars;
use crate::app::viewport::base::CLOSE;
use crate::app::viewport::body_view::BodyView;
use crate::app::viewport::camera_controller::{ARROW_ROOM, Box2, CameraController, grow, grow_to_linear};
use crate::app::viewport::objects;
use crate::app::viewport::overlay::{self, Overlay};
use crate::app::viewport::pointer::{HitTargets, Interaction, Interactivity};
use crate::app::viewport::probe::{self, CardChoice};
use crate::app::viewport::projection::{DrawnBody, Projection};
use crate::state::largest;

/// Largest margins around the body when the camera is fitted, points, and their largest part of the view: room for the
/// load arrow, the line key above and the colour bar below.
const FIT_MARGINS: Margins = Margins { sides: 76.0, top: 84.0, bottom: 92.0 };
const FIT_SHARE: f64 = 0.16;

#[derive(Clone, Copy)]
pub(crate) struct Content<'a> {
    pub session: &'a Session,
    pub options: &'a ViewOptions,
    /// Direction of a force of zero, degrees.
    pub direction: f64,
    /// Card of Learn below the view.
    pub card: Option<CardContent<'a>>,
}

/// Content of a card of Learn.
#[derive(Clone, Copy)]
pub(crate) struct CardContent<'a> {
    /// `true` if the elements are drawn apart from each other: they cannot be grabbed then, and show no loads.
    pub is_apart: bool,
    /// Largest body that the card's slider reaches.
    pub reach: Option<&'a Simulation>,
}

impl<'a> Content<'a> {
    fn simulation(&self) -> &'a Simulation {
        self.session.simulation()
    }

    fn mesh(&self) -> &'a Mesh {
        self.simulation().system().mesh()
    }

    fn is_apart(&self) -> bool {
        self.card.is_some_and(|card| card.is_apart)
    }

    /// Returns the largest body that the card's slider reaches, if it has the displayed mesh.
    fn reach(&self) -> Option<&'a Simulation> {
        self.card?.reach.filter(|reach| has_mesh_of(reach.scene(), self.simulation().scene()))
    }

    /// Returns the reference solution of the scene if it is known; one that follows a load may be of the load before.
    fn reference(&self) -> Option<&'a Reference> {
        let session = self.session;
        let is_ended = !session.iterates() || session.fallback().is_some();
        let is_at_rest = !session.is_motion() && is_ended && session.simulation().mouse_spring().is_none();
        session.known_reference().filter(|_| is_at_rest)
    }

    /// Returns the displacement of the linear solution, m, if it is drawn; not while the drawn body has another load.
    fn ghost(&self) -> Option<&'a [Vector2<f64>]> {
        let is_wanted = self.options.lines.ghost && self.simulation().scene().solver.method != MethodKind::Linear;
        // Linear theory does not have the force of the mouse spring.
        let is_of_drawn = self.session.fallback().is_none() && self.simulation().mouse_spring().is_none();
        self.session.linear().map(Simulation::displacement).filter(|_| is_wanted && is_of_drawn)
    }
}

/// State of the checks for self-intersections of the outline.
#[derive(Debug, Default)]
struct Crossing {
    is_reported: bool,
    /// Time of the last check, s.
    checked: f64,
    /// Revision number of the body mesh at the last check.
    stamp: u64,
}

#[derive(Debug)]
pub(crate) struct MainView {
    pub view: BodyView,
    pub camera: CameraController,
    margins: Margins,
    /// `true` if camera movements are animated, as in a window, and not in images.
    pub eases: bool,
    /// Pinned material point, whose values are shown.
    pub probe: Option<MaterialPoint>,
    card_choice: CardChoice,
    /// Rest position of the point whose menu was opened, m.
    menu: Option<Vector2<f64>>,
    /// Choice of the factor of the drawn displacement at the last update.
    choice: Magnification,
    /// Largest displacement of a motion so far, m.
    largest_displacement: f64,
    /// Bounding box of all states of a body in motion so far, m.
    swept: Option<Box2>,
    crossing: Crossing,
}

impl MainView {
    /// Creates a view of a body at rest.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self {
            view: BodyView::default(),
            camera: CameraController::new(mesh.bounds().into()),
            margins: FIT_MARGINS,
            eases: false,
            probe: None,
            card_choice: CardChoice::default(),
            menu: None,
            choice: Magnification::None,
            largest_displacement: 0.0,
            swept: None,
            crossing: Crossing::default(),
        }
    }

    /// Changes to the body of another document.
    pub(crate) fn start(&mut self, mesh: &Mesh) {
        self.camera = CameraController::new(mesh.bounds().into());
        self.probe = None;
        self.crossing = Crossing::default();
    }

    /// Resets the bounding box of the motion and its largest displacement.
    pub(crate) fn clear_swept(&mut self) {
        self.swept = None;
        self.largest_displacement = 0.0;
    }

    /// Returns the projection of the last [`Self::fit_camera`].
    pub(crate) fn projection(&self) -> Projection {
        self.view.projection(&self.camera)
    }

    pub(crate) fn interact(&mut self, ui: &mut Ui, content: &Content<'_>) -> (Response, Interaction) {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let arrows = self.arrows(content);
        let bases = self.editable_body(content).map_or_else(Vec::new, |body| body.bases());
        self.view.rect = rect;
        // A magnified body is not where the pointer would pull it.
        let is_fixed = content.session.is_in_background() || self.view.body.magnification != 1.0;
        let interactivity = match is_fixed {
            _ if content.is_apart() => Interactivity::Absent,
            true => Interactivity::Visible,
            false => Interactivity::Grabbable,
        };
        let BodyView { pointer, body, .. } = &mut self.view;
        let (camera, arrows, bases) = (&self.camera, &arrows, &bases);
        let targets = HitTargets { response: &response, camera, body, interactivity, arrows, bases };
        let interaction = pointer.process(ui, &targets);
        (response, interaction)
    }

    /// Updates the drawn mesh to the current state.
    pub(crate) fn update(&mut self, visuals: &Visuals, content: &Content<'_>) {
        let simulation = content.session.drawn();
        // A colour range that changed with every frame would hide the motion.
        let played = self.swept.is_some().then_some(content.session.playback.played);
        if std::mem::replace(&mut self.choice, content.options.magnification) != content.options.magnification {
            self.swept = None;
        }
        let magnification = self.magnification_of(simulation, content);
        let is_of_drawn = content.session.live().is_none() && content.session.fallback().is_none();
        let shown = (content.options, content.reference().filter(|_| is_of_drawn));
        self.view.body.update(simulation, &content.session.model.geometry, shown, magnification, played);
        self.view.body.palette = Palette::new(visuals);
    }

    /// Returns the factor of the drawn displacement: 1 under a card of Learn and while the body is grabbed.
    fn magnification_of(&mut self, simulation: &Simulation, content: &Content<'_>) -> f64 {
        let is_grabbed = content.session.simulation().mouse_spring().is_some();
        if content.card.is_some() || is_grabbed {
            return 1.0;
        }
        let (choice, moves) = (content.options.magnification, content.session.is_motion());
        if moves || choice == Magnification::Automatic {
            // A factor that followed a motion would hide it.
            let before = if moves { self.largest_displacement } else { 0.0 };
            self.largest_displacement = before.max(largest(simulation.displacement()));
        }
        choice.factor(simulation.system().size(), self.largest_displacement)
    }

    /// Returns the drawn positions of a body's nodes, m.
    fn drawn_positions<'b>(&self, body: &'b Simulation) -> impl Iterator<Item = Vector2<f64>> + 'b {
        let magnification = self.view.body.magnification;
        body.system().mesh().nodes().iter().zip(body.displacement()).map(move |(x, u)| x + u * magnification)
    }

    /// Returns the drawn outline of the reference solution under the load that was asked for, m.
    fn exact(&self, content: &Content<'_>) -> Vec<Vec<Vector2<f64>>> {
        let reference = content.reference().filter(|_| content.options.lines.exact);
        reference.map_or_else(Vec::new, |reference| reference.outline(self.view.body.magnification))
    }

    /// Moves the camera by the pointer, and pins or unpins the material point that was clicked.
    pub(crate) fn take(&mut self, interaction: &Interaction, response: &Response, content: &Content<'_>) {
        /// Distance within which a click hits a pinned point, points.
        const NEAR: f32 = 9.0;
        self.camera.follow(interaction.camera);
        // On a card of Learn a click selects a triangle.
        let clicked = interaction.clicked.filter(|_| content.card.is_none());
        if let (Some(point), Some(click)) = (clicked, response.interact_pointer_pos()) {
            let kept = self.probe.and_then(|kept| self.in_view(content, kept));
            let is_unpinned = kept.is_some_and(|kept| kept.distance(click) <= NEAR);
            self.probe = (!is_unpinned).then_some(rounded(content, point));
        }
    }

    /// Returns `true` if the user has moved the view so that it does not have the whole body.
    pub(crate) fn misses_body(&self) -> bool {
        let projection = self.projection();
        let is_out = |point: &Vector2<f64>| !self.view.rect.contains(projection.point(*point));
        self.camera.own.is_some() && self.view.body.points.iter().any(is_out)
    }

    /// Returns the body whose objects can be moved along it: none in Learn, and no large one, which is solved in the
    /// background.
    fn editable_body<'a>(&'a self, content: &Content<'a>) -> Option<DrawnBody<'a>> {
        let is_fixed = content.card.is_some() || content.session.is_in_background();
        let body = self.drawn_body(content).filter(|_| !is_fixed)?;
        Some(DrawnBody { scene: content.session.scene(), ..body })
    }

    /// Returns the edit by a base that was dropped at another place.
    pub(crate) fn drop_base(&self, interaction: &Interaction, content: &Content<'_>) -> Option<Action> {
        let (object, at) = interaction.dropped?;
        let moved = self.editable_body(content)?.moved(object, at).filter(|moved| moved != content.session.scene());
        moved.map(|moved| Action::Edit(objects::EDIT, Box::new(moved)))
    }

    /// Shows the menu of the material point that was clicked with the secondary button; returns the edit that was
    /// chosen.
    pub(crate) fn show_menu(&mut self, response: &Response, content: &Content<'_>) -> Option<Action> {
        /// Distance within which the menu removes an object, points.
        const NEAR: f64 = 14.0;
        let (scene, system) = (content.session.scene(), content.simulation().system());
        let (mesh, outline) = (system.mesh(), &content.session.model.geometry.boundary);
        if content.card.is_some() || content.session.is_in_background() {
            self.menu = None;
        } else if response.secondary_clicked() {
            // The tip of a short arrow covers the point where its force acts.
            let of_arrow = self.view.pointer.hot_arrow().and_then(|grip| match scene.loads.get(grip.arrow.load)? {
                Load::Force { place: Place::At(at), .. } => mesh.locate((*at).into()),
                _ => None,
            });
            // The marks of supports are beside the body.
            let beside = || {
                let at = self.projection().place(response.interact_pointer_pos()?);
                mesh.pick(&self.view.body.nodes, outline, at, NEAR / self.camera.shown.scale)
            };
            let clicked = self.view.pointer.over_body().map(|(point, _)| point).or(of_arrow).or_else(beside);
            let at = clicked.and_then(|point| probe::place(mesh, mesh.nodes(), point));
            self.menu = at.map(|at| objects::snapped(system, outline, at, CLOSE / self.camera.shown.scale));
        }
        objects::show_menu(response, (scene, system), (self.menu?, NEAR / self.camera.shown.scale))
    }

    /// Returns the body of the last frame, with the loads of its arrows.
    fn drawn_body<'a>(&'a self, content: &Content<'a>) -> Option<DrawnBody<'a>> {
        let simulation = content.simulation();
        let scene = (simulation.scene(), simulation.state().time());
        self.view.drawn_body(self.projection(), scene, (content.session, content.direction))
    }

    /// Returns the arrows of the loads, as of the last frame.
    pub(crate) fn arrows(&self, content: &Content<'_>) -> Vec<LoadArrow> {
        let body = self.drawn_body(content).filter(|_| !content.is_apart());
        body.map_or_else(Vec::new, |body| body.arrows())
    }

    /// Returns the window position of a material point.
    fn in_view(&self, content: &Content<'_>, point: MaterialPoint) -> Option<Pos2> {
        let place = probe::place(content.mesh(), &self.view.body.nodes, point)?;
        Some(self.projection().point(place))
    }

    /// Shows the values at the pointer and at the pinned point; returns the edit that keeps a probe.
    pub(crate) fn show_values(&mut self, ui: &Ui, painter: &Painter, content: &Content<'_>) -> Option<Action> {
        if content.is_apart() {
            return None;
        }
        let shown = content.session.drawn();
        if let Some((point, at)) = self.view.pointer.over_body()
            && !egui::Popup::is_any_open(ui.ctx())
            && let point = rounded(content, point)
            && self.probe != Some(point)
        {
            self.view.show_value(ui, shown, point, at);
        }
        let point = self.probe?;
        let state = shown.point_state(point, content.options.point_values())?;
        let at = self.in_view(content, point)?;
        let (scene, system) = (content.session.scene(), content.simulation().system());
        let place = Place::At(objects::rounded(system, state.rest).into());
        // An edit of a large body would solve it again.
        let is_kept = content.session.is_in_background() || scene.probes.iter().any(|probe| probe.place == place);
        let (view, choice) = (self.view.rect, &mut self.card_choice);
        let keeps = probe::show_card(painter, ui.visuals(), view, (&state, at, is_kept), choice);
        self.probe = self.probe.filter(|_| keeps.is_some());
        (keeps == Some(true))
            .then(|| Action::edit(objects::EDIT, scene, |scene| objects::add_probe(scene, system, state.rest)))
    }

    /// Fits the camera to the body at rest and in its current state, unless the user has moved it. States that have not
    /// converged are not followed, because they may be anywhere. While an arrow is dragged, it moves away, never nearer.
    pub(crate) fn fit_camera(&mut self, ui: &Ui, content: &Content<'_>) {
        let drags = self.view.pointer.drags_tip();
        // Moving the camera would also move the point that the pointer has grabbed.
        if self.view.pointer.holds() && !drags {
            return;
        }
        let size = self.size();
        let (session, is_motion) = (content.session, content.session.is_motion());
        let status = session.drawn().status();
        let is_sound = if is_motion { !matches!(status, Status::Stopped(_)) } else { status.is_success() };
        let is_stepped = !is_motion && (session.frame.is_slow || !session.is_running());
        if is_sound || (is_stepped || drags) && self.is_of_usual_size(content, if drags { 2.0 } else { 10.0 }) {
            let before = if drags { Some(self.camera.whole) } else { self.swept.filter(|_| is_motion) };
            let exact = self.exact(content);
            let points = before.iter().flatten().chain(&self.view.body.points).chain(exact.iter().flatten()).copied();
            let points = points.chain(content.reach().into_iter().flat_map(|reach| self.drawn_positions(reach)));
            let whole = points.fold(content.mesh().bounds().into(), |whole, point| grow(whole, &point));
            self.swept = Some(whole).filter(|_| is_motion);
            self.camera.set_whole(whole);
            self.margins = self.with_room_for_arrows(content, whole);
        }
        let fitted = self.fitted(content, self.camera.whole, size);
        self.camera.turn_to(ui, fitted, self.eases, drags);
    }

    /// Returns `true` if the drawn body is at most `times` as large as at rest; a diverging iterate may be larger.
    fn is_of_usual_size(&self, content: &Content<'_>, times: f64) -> bool {
        let (low, high) = content.mesh().bounds();
        let [from, to] = self.view.body.points.iter().fold([low, high], grow);
        (to - from).norm() < times * (high - low).norm()
    }

    /// Leaves room for a beam that is going to bend, and for its arrow.
    pub(crate) fn expect_bending(&mut self, content: &Content<'_>) {
        let (low, high) = content.mesh().bounds();
        let low = low - Vector2::new(0.3, 1.15) * (high.x - low.x);
        self.camera.set_whole([low, high]);
        let least = least_margins(self.size());
        let arrow = f64::from(0.25 * self.view.rect.height()).clamp(30.0, 120.0);
        self.margins = Margins { bottom: least.bottom + arrow, ..least };
    }

    /// Returns width and height, points.
    fn size(&self) -> [f64; 2] {
        [self.view.rect.width(), self.view.rect.height()].map(f64::from)
    }

    /// Returns the camera that shows a box, m, and the linear solution, in a view of size `view`, points.
    pub(crate) fn fitted(&self, content: &Content<'_>, whole: Box2, view: [f64; 2]) -> Camera {
        let linear = content.session.linear().filter(|_| content.ghost().is_some());
        let points = linear.into_iter().flat_map(|linear| self.drawn_positions(linear));
        let [low, high] = grow_to_linear(whole, points);
        Camera::fit(low, high, view, self.margins)
    }

    /// Returns the margins around a box, m: the least ones, enlarged by the room that the arrows need, points.
    fn with_room_for_arrows(&self, content: &Content<'_>, [low, high]: Box2) -> Margins {
        /// Space beyond a tip for the label of its force, points.
        const BEYOND: f32 = 36.0;
        let (view, size) = (self.size(), self.view.rect.size());
        let least = least_margins(view);
        if content.is_apart() || bars::is_tiny(content.options, size) {
            return least;
        }
        let Some(own) = self.drawn_body(content) else { return least };
        let camera = Camera::fit(low, high, view, least);
        let projection = Projection { camera, rect: Rect::from_min_size(Pos2::ZERO, size) };
        let own = DrawnBody { projection, ..own };
        let mut arrows = own.whole_arrows();
        if let Some(reach) = content.reach() {
            let positions: Vec<_> = self.drawn_positions(reach).collect();
            let body = DrawnBody { scene: reach.scene(), system: reach.system(), positions: &positions, ..own };
            arrows.extend(body.whole_arrows());
        }
        let forces = arrows.iter().filter(|arrow| arrow.vector() != Vec2::ZERO);
        forces.fold(least, |margins, arrow| {
            let tip = arrow.tip();
            // A tip must not cover the colour bar.
            let is_right = tip.x > size.x - bars::LEGEND_WIDTH;
            let below = if is_right { bars::LEGEND_HEIGHT } else { 0.0 };
            let beyond = |outside: f32, view: f64| f64::from((outside + BEYOND).max(0.0)).min(ARROW_ROOM * view);
            Margins {
                sides: margins.sides.max(least.sides + beyond((-tip.x).max(tip.x - size.x), view[0])),
                top: margins.top.max(least.top + beyond(-tip.y, view[1])),
                bottom: margins.bottom.max(least.bottom + beyond(tip.y - size.y + below, view[1])),
            }
        })
    }

    /// Paints the overlays; `note` is a text over the body.
    pub(crate) fn paint(&self, painter: &Painter, visuals: &Visuals, content: &Content<'_>, note: Option<&str>) {
        let Some(body) = self.drawn_body(content) else { return };
        let session = content.session;
        let overlay = Overlay {
            view: &self.view,
            body: DrawnBody { scene: session.drawn().scene(), ..body },
            wanted: session.fallback().map(|_| session.simulation().scene()),
            options: content.options,
            apart: content.is_apart(),
            exact: &self.exact(content),
            note,
            session: Some(session),
            ghost: content.ghost(),
        };
        overlay::paint(painter, &overlay, visuals);
        if let Some((hot, body)) = self.view.pointer.hot_base().zip(self.editable_body(content)) {
            body.paint_base(painter, hot, visuals, Palette::new(visuals).load);
        }
    }

    /// Checks a converged state or a motion for self-intersections of the outline at `now`, s; returns `true` for the
    /// first one of a document.
    pub(crate) fn finds_crossing(&mut self, content: &Content<'_>, now: f64) -> bool {
        /// Time between two checks of a body in motion, s.
        const EVERY: f64 = 0.1;
        let session = content.session;
        let is_due = !session.iterates() || now - self.crossing.checked >= EVERY;
        let is_sound = match session.simulation().status() {
            Status::Converged | Status::Accepted => true,
            Status::Running | Status::Finished => session.is_motion(),
            _ => false,
        };
        let is_another = self.crossing.stamp != self.view.body.stamp;
        if self.view.body.magnification != 1.0 || self.crossing.is_reported || !(is_due && is_sound && is_another) {
            return false;
        }
        (self.crossing.checked, self.crossing.stamp) = (now, self.view.body.stamp);
        self.crossing.is_reported =
            content.mesh().passes_through_itself(&session.model.geometry.boundary, &self.view.body.nodes);
        self.crossing.is_reported
    }
}

/// Returns the point with rounded coordinates near a point of the body, so that a probe that is kept there has the values
/// that are shown; the point itself if the rounded one is in another element.
fn rounded(content: &Content<'_>, point: MaterialPoint) -> MaterialPoint {
    let system = content.simulation().system();
    let mesh = system.mesh();
    let near = probe::place(mesh, mesh.nodes(), point).and_then(|rest| mesh.locate(objects::rounded(system, rest)));
    near.filter(|near| near.element == point.element).unwrap_or(point)
}

/// Returns the margins around a box that do not depend on the loads, in a view of this size, points.
fn least_margins(size: [f64; 2]) -> Margins {
    let Margins { sides, top, bottom } = FIT_MARGINS;
    let [width, height] = size.map(|side| FIT_SHARE * side);
    let has_bar = bars::has_legend(egui::vec2(size[0] as f32, size[1] as f32));
    let bar = if has_bar { f64::from(bars::LEGEND_HEIGHT) } else { 0.0 };
    Margins { sides: sides.min(width), top: top.min(height), bottom: bottom.min(height.max(bar)) }
}
