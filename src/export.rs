//! Export of the current state to a file: a table of nodes (`.csv`), or the mesh with its fields (`.vtu`, read by
//! ParaView). `warpbeam solve --out` also writes the course of a motion.

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt::{Display, Write as _};
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use nalgebra::Vector2;
use thiserror::Error;

use crate::dynamics::Ledger;
use crate::simulation::{Field, Simulation};

/// Reason why a result was not written.
///
/// See [`write()`].
#[derive(Debug, Error)]
pub enum ExportError {
    /// The file name has an unknown extension.
    #[error("{0}: expected a file name ending in .csv or .vtu, or in .pvd for a scene in motion")]
    UnknownFormat(String),
    /// A series of states was requested for a static scene.
    #[error(
        "{0}: expected a scene in motion (analysis = \"dynamic\") for a series of states; .vtu has the equilibrium"
    )]
    NotInMotion(String),
    /// The file cannot be written.
    #[error("{path}: {source}")]
    Write {
        /// The file.
        path: String,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// A file format.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Equilibrium: one row per node with rest and current position and displacement. Motion: one row per time step
    /// with probes and energies.
    Csv,
    /// VTK unstructured grid, XML, ASCII.
    Vtu,
    /// ParaView collection: a file that lists a series of `.vtu` files with their times.
    Pvd,
}

impl Format {
    /// Returns the format for a file name's extension.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`].
    pub fn of(path: &Path) -> Result<Self, ExportError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("vtu") => Ok(Self::Vtu),
            Some("pvd") => Ok(Self::Pvd),
            _ => Err(ExportError::UnknownFormat(path.display().to_string())),
        }
    }
}

/// Writes the current state in the format given by the file name: a table (`.csv`) or the mesh with its fields
/// (`.vtu`).
///
/// Columns of `.csv`: `node`; `rest_x`, `rest_y`, `x`, `y`, `u_x`, `u_y` (m); `rotation_deg`; `strain_xx`, `_yy`,
/// `_zz`, `_xy`; `stress_xx` and so on (Cauchy, Pa); `von_mises` (Pa); `file_node` for a mesh from a file. An undefined
/// value is an empty field.
///
/// ```no_run
/// use warpbeam::{Scene, Simulation, export};
///
/// let mut beam = Simulation::new(&Scene::beam(10.0, 1.0).clamp("left").force("right", [0.0, -500.0]))?;
/// beam.solve();
/// export::write(&beam, "beam.vtu".as_ref())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExportError`].
pub fn write(simulation: &Simulation, path: &Path) -> Result<(), ExportError> {
    let text = match Format::of(path)? {
        Format::Csv => csv(simulation),
        Format::Vtu => vtu(simulation),
        Format::Pvd => return Err(ExportError::NotInMotion(path.display().to_string())),
    };
    write_text(path, &text)
}

/// Approximate upper limit of the number of states in a series; more would fill the disk.
pub const MAX_STATES: u64 = 300;

/// Writer of a motion, step by step. The file is valid whenever [`Self::finish`] is called.
///
/// - `.csv`: one row per time step, and one for the start. Columns: `t` (s); for every probe NAME its mean position
///   `NAME_x`, `NAME_y` and displacement `NAME_u_x`, `NAME_u_y` (m), and velocity `NAME_v_x`, `NAME_v_y` (m/s); then
///   the energies of the [`Ledger`](crate::dynamics::Ledger), J: `kinetic`, `elastic`, `potential`, `dissipated`,
///   `integrator`, `pulses`, `mouse_spring` (work of it). In every row kinetic + elastic + potential + dissipated +
///   integrator − pulses − mouse_spring is the same.
/// - `.pvd`: a collection of the files `NAME_0000.vtu`, `NAME_0001.vtu`, … in the same folder: the first and the last
///   state, and every n-th step, with the smallest n that gives at most [`MAX_STATES`] states.
/// - `.vtu`: the last state.
#[doc(hidden)]
#[derive(Debug)]
pub struct MotionWriter {
    path: PathBuf,
    format: Format,
    /// File of a table.
    table: Option<BufWriter<File>>,
    /// Steps between written states, and steps since the last one.
    stride: u64,
    steps: u64,
    /// Times, s, and file names of the states written so far.
    states: Vec<(f64, String)>,
}

impl MotionWriter {
    /// Creates the file in the format given by its name and writes the start of a motion.
    ///
    /// # Errors
    /// [`ExportError`].
    pub fn create(simulation: &Simulation, path: &Path) -> Result<Self, ExportError> {
        let (format, mut table, mut stride) = (Format::of(path)?, None, 1);
        match format {
            Format::Csv => {
                let mut file = BufWriter::new(File::create(path).map_err(failed(path))?);
                file.write_all(table_header(simulation).as_bytes()).map_err(failed(path))?;
                table = Some(file);
            }
            Format::Vtu => {
                // Opens the file now, so that a missing folder is reported before the simulation runs.
                File::options().write(true).create(true).truncate(false).open(path).map_err(failed(path))?;
            }
            Format::Pvd => {
                let settings = &simulation.scene().dynamics;
                let steps = (settings.duration / settings.time_step).ceil() as u64;
                stride = steps.div_ceil(MAX_STATES).max(1);
            }
        }
        let mut writer = Self { path: path.to_owned(), format, table, stride, steps: 0, states: Vec::new() };
        writer.write(simulation)?;
        Ok(writer)
    }

    /// Adds the state after a time step.
    ///
    /// # Errors
    /// [`ExportError::Write`].
    pub fn add(&mut self, simulation: &Simulation) -> Result<(), ExportError> {
        self.steps += 1;
        if self.steps == self.stride { self.write(simulation) } else { Ok(()) }
    }

    /// Completes the file with the last state.
    ///
    /// # Errors
    /// [`ExportError::Write`].
    pub fn finish(mut self, simulation: &Simulation) -> Result<(), ExportError> {
        if self.steps > 0 {
            self.write(simulation)?;
        }
        match (self.format, self.table) {
            (Format::Pvd, _) => write_text(&self.path, &collection(&self.states)),
            (_, Some(mut table)) => table.flush().map_err(failed(&self.path)),
            (_, None) => write_text(&self.path, &vtu(simulation)),
        }
    }

    /// Writes a row of the table, or a file of the series.
    fn write(&mut self, simulation: &Simulation) -> Result<(), ExportError> {
        self.steps = 0;
        if let Some(table) = &mut self.table {
            return table.write_all(table_row(simulation).as_bytes()).map_err(failed(&self.path));
        }
        if self.format == Format::Pvd {
            // Lossy conversion: the collection lists the file names as XML text.
            let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
            let name = format!("{stem}_{:04}.vtu", self.states.len());
            write_text(&self.path.with_file_name(&name), &vtu(simulation))?;
            self.states.push((simulation.state().time(), name));
        }
        Ok(())
    }
}

pub(crate) fn failed(path: &Path) -> impl Fn(std::io::Error) -> ExportError {
    |source| ExportError::Write { path: path.display().to_string(), source }
}

fn collection(states: &[(f64, String)]) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (time, name) in states {
        let _ = writeln!(text, r#"<DataSet timestep="{time}" part="0" file="{}"/>"#, xml_attribute(name));
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

/// Escapes a text for an XML attribute.
fn xml_attribute(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Quotes a text as a field of a CSV file where necessary.
pub(crate) fn csv_field(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\"")).into()
    } else {
        text.into()
    }
}

/// Returns the columns `NAME_PART` of probes and supports, which are given by name, number and parts. A column that would
/// stand twice has the number, too: `NAME.NUMBER_PART`.
pub(crate) fn columns(of: &[(String, usize, &[&str])]) -> Vec<String> {
    let parts = of.iter().flat_map(|(name, number, parts)| parts.iter().map(move |part| (name.clone(), number, part)));
    let mut parts: Vec<_> = parts.collect();
    loop {
        let columns: Vec<String> = parts.iter().map(|(name, _, part)| format!("{name}_{part}")).collect();
        let mut counts: HashMap<&str, usize> = HashMap::new();
        columns.iter().for_each(|column| *counts.entry(column).or_default() += 1);
        if counts.len() == columns.len() {
            return columns;
        }
        for ((name, number, _), column) in parts.iter_mut().zip(&columns) {
            if counts.get(column.as_str()).is_some_and(|count| *count > 1) {
                let _ = write!(name, ".{number}");
            }
        }
    }
}

fn table_header(simulation: &Simulation) -> String {
    let mut text = String::from("t");
    let parts: &[&str] = &["x", "y", "u_x", "u_y", "v_x", "v_y"];
    let probes = simulation.problem().probes().iter().enumerate();
    let probes: Vec<_> = probes.map(|(i, probe)| (probe.name.clone(), i, parts)).collect();
    for column in columns(&probes) {
        let _ = write!(text, ",{}", csv_field(&column));
    }
    text.push_str(",kinetic,elastic,potential,dissipated,integrator,pulses,mouse_spring\n");
    text
}

fn table_row(simulation: &Simulation) -> String {
    let state = simulation.state();
    let nodes = simulation.system().mesh().nodes();
    let mut text = state.time().to_string();
    for probe in simulation.problem().probes() {
        let (u, v) = (probe.mean(state.displacement()), probe.mean(state.velocity()));
        let x = probe.mean(nodes) + u;
        let _ = write!(text, ",{},{},{},{},{},{}", x.x, x.y, u.x, u.y, v.x, v.y);
    }
    let Ledger { kinetic, elastic, potential, dissipated, integrator, pulses, mouse_spring, .. } =
        simulation.motion().map(|motion| *motion.ledger()).unwrap_or_default();
    let _ = writeln!(text, ",{kinetic},{elastic},{potential},{dissipated},{integrator},{pulses},{mouse_spring}");
    text
}

/// Writes a file; an error contains its path.
///
/// # Errors
/// [`ExportError::Write`].
#[doc(hidden)]
pub fn write_text(path: &Path, text: &str) -> Result<(), ExportError> {
    std::fs::write(path, text).map_err(failed(path))
}

fn csv(simulation: &Simulation) -> String {
    let mut text = String::from("node,rest_x,rest_y,x,y,u_x,u_y,rotation_deg");
    for name in ["strain", "stress"] {
        let _ = write!(text, ",{name}_xx,{name}_yy,{name}_zz,{name}_xy");
    }
    text.push_str(",von_mises");
    let mesh = simulation.system().mesh();
    let has_file = mesh.is_from_file();
    text.push_str(if has_file { ",file_node\n" } else { "\n" });
    let nodal = simulation.nodal_stress();
    let nodes = mesh.nodes().iter().zip(simulation.displacement());
    for (node, ((rest, u), (local, stress))) in (0..).zip(nodes.zip(nodal.nodes().iter().zip(nodal.cauchy()))) {
        let x = rest + u;
        let _ = write!(text, "{node},{},{},{},{},{},{}", rest.x, rest.y, x.x, x.y, u.x, u.y);
        let strain = local.strain(nodal.material()).components().map(Some);
        let stresses = stress.map_or([None; 4], |s| s.components().map(Some));
        let others = strain.into_iter().chain(stresses).chain([stress.map(|s| s.von_mises())]);
        let rotation = local.frame(nodal.kinematics()).angle().to_degrees();
        for value in std::iter::once(Some(rotation)).chain(others) {
            // Unknown values are written as empty fields.
            let value = value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string());
            let _ = write!(text, ",{value}");
        }
        if has_file {
            let tag = mesh.node_name(node).map_or_else(String::new, |tag| tag.to_string());
            let _ = write!(text, ",{tag}");
        }
        text.push('\n');
    }
    text
}

/// Writes a `DataArray`, one row per line; writes nothing if `rows` is `None`, because VTK cannot represent missing
/// values.
fn data_array<T: Display, const K: usize>(text: &mut String, kind: &str, name: &str, rows: Option<Vec<[T; K]>>) {
    let name = xml_attribute(name);
    if let Some(rows) = rows {
        array(text, format_args!(r#"type="{kind}" Name="{name}" NumberOfComponents="{K}""#), rows);
    }
}

/// Writes a `DataArray` with these attributes, one row per line.
fn array<T: Display>(text: &mut String, about: impl Display, rows: impl IntoIterator<Item: AsRef<[T]>>) {
    let _ = writeln!(text, r#"<DataArray {about} format="ascii">"#);
    for row in rows {
        let _ = writeln!(text, "{}", row.as_ref().iter().map(T::to_string).collect::<Vec<_>>().join(" "));
    }
    let _ = writeln!(text, "</DataArray>");
}

/// Writes the fields recovered at the nodes, tensors with nine components; the node numbers in the mesh file, −1 for
/// nodes that it lacks; and for every named edge 1 at its nodes and 0 elsewhere.
fn nodal_data(text: &mut String, simulation: &Simulation) {
    let (mesh, nodal) = (simulation.system().mesh(), simulation.nodal_stress());
    let strains = nodal.nodes().iter().map(|local| local.strain(nodal.material()));
    let strains: Option<Vec<_>> = strains.map(|s| s.is_finite().then(|| s.rows())).collect();
    data_array(text, "Float64", "strain (Biot)", strains);
    let stresses: Option<Vec<_>> = nodal.cauchy().collect();
    data_array(
        text,
        "Float64",
        "stress (Cauchy) [Pa]",
        stresses.as_ref().map(|s| s.iter().map(|s| s.rows()).collect()),
    );
    let von_mises = |local| Field::VonMises.of(local, nodal.material(), nodal.kinematics());
    let values = nodal.nodes().iter().map(|local| Some([von_mises(local)?])).collect();
    data_array(text, "Float64", &title(Field::VonMises), values);
    let numbers = (0..mesh.nodes().len() as u32).map(|n| mesh.node_name(n).map_or(-1, |tag| tag as i64));
    data_array(text, "Int64", "node", Some(numbers.map(|n| [n]).collect()));
    for name in mesh.edges().keys() {
        let mut on_edge = vec![[0]; mesh.nodes().len()];
        mesh.edge_nodes(name).unwrap_or_default().iter().for_each(|&n| on_edge[n as usize] = [1]);
        data_array(text, "UInt8", name, Some(on_edge));
    }
}

/// Returns the field's name with its unit.
fn title(field: Field) -> String {
    if field.unit().is_empty() { field.name().to_owned() } else { format!("{} [{}]", field.name(), field.unit()) }
}

fn vtu(simulation: &Simulation) -> String {
    let mesh = simulation.system().mesh();
    let (points, cells) = (mesh.nodes().len(), mesh.element_count());
    let entry = mesh.element().entry();
    let per_element = simulation.system().elements().points_per_element();
    let mut text = String::new();
    let _ = writeln!(text, r#"<?xml version="1.0"?>"#);
    let _ = writeln!(text, r#"<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">"#);
    let _ = writeln!(text, r#"<UnstructuredGrid><Piece NumberOfPoints="{points}" NumberOfCells="{cells}">"#);
    let _ = write!(text, "<Points>");
    let vectors = |of: &[Vector2<f64>]| of.iter().map(|v| [v.x, v.y, 0.0]).collect::<Vec<_>>();
    array(&mut text, r#"type="Float64" NumberOfComponents="3""#, vectors(mesh.nodes()));
    text.pop();
    let _ = writeln!(text, "</Points>\n<Cells>");
    array(&mut text, r#"type="Int32" Name="connectivity""#, mesh.elements());
    array(&mut text, r#"type="Int32" Name="offsets""#, (1..=cells).map(|cell| [cell * entry.nodes.len()]));
    array(&mut text, r#"type="UInt8" Name="types""#, vec![[entry.vtk_type]; cells]);
    let _ = writeln!(text, "</Cells>\n<PointData Vectors=\"displacement\">");
    data_array(&mut text, "Float64", "displacement", Some(vectors(simulation.displacement())));
    if simulation.motion().is_some() {
        data_array(&mut text, "Float64", "velocity", Some(vectors(simulation.state().velocity())));
    }
    nodal_data(&mut text, simulation);
    let _ = writeln!(text, "</PointData>\n<CellData>");
    let mut values = Vec::new();
    // Stresses are written at the nodes, because their mean over a cell is far below the maximum.
    for field in [Field::EnergyDensity, Field::LargestStrain, Field::RotationAngle, Field::MeshError] {
        simulation.field(field, &mut values);
        // VTK cannot represent missing values: a field that lacks one is left out.
        let Some(values) = values.iter().copied().collect::<Option<Vec<f64>>>() else { continue };
        let mean = |element: &[f64]| [element.iter().sum::<f64>() / element.len() as f64];
        let values = values.chunks_exact(per_element).map(mean).collect();
        data_array(&mut text, "Float64", &title(field), Some(values));
    }
    text.push_str("</CellData>\n</Piece></UnstructuredGrid>\n</VTKFile>\n");
    text
}
