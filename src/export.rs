//! A result as a file: a table of nodes (`.csv`) or a mesh with fields (`.vtu`, read by ParaView).

use std::fmt::Write as _;
use std::path::Path;

use thiserror::Error;

use crate::simulation::{Field, Simulation};

/// Why a result was not written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The file name asks for a format there is not.
    #[error("{0}: expected a file name ending in .csv or .vtu")]
    UnknownFormat(String),
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A row a node: rest and current position, displacement.
    Csv,
    /// VTK unstructured grid, XML, ASCII.
    Vtu,
}

impl Format {
    /// The format a file name asks for.
    ///
    /// # Errors
    /// [`ExportError::UnknownFormat`].
    pub fn of(path: &Path) -> Result<Self, ExportError> {
        match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("csv") => Ok(Self::Csv),
            Some("vtu") => Ok(Self::Vtu),
            _ => Err(ExportError::UnknownFormat(path.display().to_string())),
        }
    }
}

/// Writes the current state in the format its file name asks for.
///
/// # Errors
/// [`ExportError`].
pub fn write(simulation: &Simulation, path: &Path) -> Result<(), ExportError> {
    let text = match Format::of(path)? {
        Format::Csv => csv(simulation),
        Format::Vtu => vtu(simulation),
    };
    write_text(path, &text)
}

/// Writes a file, naming it where that fails.
///
/// # Errors
/// [`ExportError::Write`].
pub fn write_text(path: &Path, text: &str) -> Result<(), ExportError> {
    std::fs::write(path, text).map_err(|source| ExportError::Write { path: path.display().to_string(), source })
}

fn csv(simulation: &Simulation) -> String {
    let mut text = String::from("node,rest_x,rest_y,x,y,u_x,u_y\n");
    let nodes = simulation.system().mesh().nodes().iter().zip(simulation.displacement());
    for (i, (rest, u)) in nodes.enumerate() {
        let x = rest + u;
        let _ = writeln!(text, "{i},{},{},{},{},{},{}", rest.x, rest.y, x.x, x.y, u.x, u.y);
    }
    text
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
    let _ = writeln!(text, r#"<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">"#);
    for x in mesh.nodes() {
        let _ = writeln!(text, "{} {} 0", x.x, x.y);
    }
    let _ = writeln!(text, "</DataArray></Points>\n<Cells>");
    let _ = writeln!(text, r#"<DataArray type="Int32" Name="connectivity" format="ascii">"#);
    for nodes in mesh.elements() {
        let _ = writeln!(text, "{}", nodes.iter().map(u32::to_string).collect::<Vec<_>>().join(" "));
    }
    let _ = writeln!(text, "</DataArray>\n<DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">");
    for cell in 1..=cells {
        let _ = writeln!(text, "{}", cell * entry.nodes.len());
    }
    let _ = writeln!(text, "</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">");
    for _ in 0..cells {
        let _ = writeln!(text, "{}", entry.vtk_type);
    }
    let _ = writeln!(text, "</DataArray>\n</Cells>\n<PointData Vectors=\"displacement\">");
    let _ = writeln!(text, r#"<DataArray type="Float64" Name="displacement" NumberOfComponents="3" format="ascii">"#);
    for u in simulation.displacement() {
        let _ = writeln!(text, "{} {} 0", u.x, u.y);
    }
    let _ = writeln!(text, "</DataArray>\n</PointData>\n<CellData>");
    let mut values = Vec::new();
    for field in Field::ALL {
        simulation.field(field, &mut values);
        // VTK has no word for a value that is absent: a field that lacks one is left out.
        let Some(values) = values.iter().copied().collect::<Option<Vec<f64>>>() else { continue };
        let unit = if field.unit().is_empty() { String::new() } else { format!(" [{}]", field.unit()) };
        let _ = writeln!(text, r#"<DataArray type="Float64" Name="{}{unit}" format="ascii">"#, field.name());
        for element in values.chunks_exact(per_element) {
            let _ = writeln!(text, "{}", element.iter().sum::<f64>() / element.len() as f64);
        }
        let _ = writeln!(text, "</DataArray>");
    }
    text.push_str("</CellData>\n</Piece></UnstructuredGrid>\n</VTKFile>\n");
    text
}
