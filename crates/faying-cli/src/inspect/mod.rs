//! Contents of a mesh or geometry file: parts, sides, sizes, quality.

mod grid;
mod group_place;
mod look;
mod meshes;
mod picture;
mod side_place;
mod splines;

pub use grid::{FieldReport, add_fields, mesh_of};
pub use look::{Location, Soundness};
pub use meshes::{CellsReport, GroupReport};
pub use picture::picture;
pub use side_place::SidePlace;
pub use splines::{LabelReport, PatchReport, face, faces, map_of, name_of};

use crate::table::{Table, short};
pub use faying_files::CellMap;
use faying_files::{CellShape, Contents, FileError, Format, MeshFile, SplineFile, SplinePatch};
use serde::Serialize;
use std::fmt::Write as _;

/// Contents of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// The format, in words.
    pub format: String,
    /// "patches" or "mesh".
    pub kind: String,
    /// Dimension of the bodies: parameters of the patches, of the cells.
    pub dimension: usize,
    /// Length, area or volume of everything of that dimension.
    pub measure: f64,
    /// Spline patches.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub patches: Vec<PatchReport>,
    /// Pairs of sides that the file declares as common.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<[String; 2]>,
    /// Named sides of patches.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<LabelReport>,
    /// Points of a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<usize>,
    /// Kinds of cells of a mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<CellsReport>,
    /// Physical groups of a mesh.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<GroupReport>,
    /// Fields of a VTU.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fields: Vec<FieldReport>,
    /// Quality of the elements.
    pub quality: Soundness,
    /// Remarks: data that were not read, and problems.
    pub notes: Vec<String>,
}

/// Name of a format.
fn word(format: Format) -> &'static str {
    match format {
        Format::Gismo => "G+Smo XML",
        Format::Mfem => "MFEM mesh",
        Format::Gmsh => "Gmsh MSH",
        Format::Vtu => "VTK unstructured grid",
        Format::Abaqus => "Abaqus input file",
    }
}

/// Bytes per element while its quality is measured.
const PER_ELEMENT: u64 = 250;

/// Estimate of the bytes that [`inspect`] takes beside `contents`.
pub fn memory(contents: &Contents) -> u64 {
    let elements: usize = match contents {
        Contents::Mesh(mesh) => mesh.blocks.iter().map(|b| b.ids.len()).sum(),
        Contents::Patches(file) => file.patches.iter().map(|p| p.points.len()).sum(),
    };
    PER_ELEMENT * elements as u64
}

/// Inspects the contents of a file.
///
/// # Errors
/// [`FileError`] where knots, points and weights do not fit.
pub fn inspect(contents: &Contents) -> Result<Inspection, FileError> {
    match contents {
        Contents::Patches(file) => of_splines(file),
        Contents::Mesh(mesh) => Ok(of_mesh(mesh)),
    }
}

fn of_splines(file: &SplineFile) -> Result<Inspection, FileError> {
    let mut quality = Soundness::default();
    let mut patches = Vec::with_capacity(file.patches.len());
    for (k, p) in file.patches.iter().enumerate() {
        let (report, sound) = splines::patch(name_of(file, k), p)?;
        patches.push(report);
        quality = quality.and(sound);
    }
    let shown = |s: &faying_files::PatchSide| format!("{}.{}", name_of(file, s.patch), s.side);
    let mut notes = file.notes.clone();
    let of_patch = |(k, p): (usize, &SplinePatch)| p.collapsed_sides().into_iter().map(move |side| format!("{}.{side}", name_of(file, k)));
    let collapsed: Vec<String> = file.patches.iter().enumerate().flat_map(of_patch).collect();
    if !collapsed.is_empty() {
        notes.push(format!("collapsed, so no sides: {}", collapsed.join(", ")));
    }
    add_inverted(&quality, &mut notes);
    let dimension = file.patches.iter().map(|p| p.dimension()).max().unwrap_or(0);
    Ok(Inspection {
        format: word(file.format).into(),
        kind: "patches".into(),
        dimension,
        measure: patches.iter().filter(|p| p.degree.len() == dimension).map(|p| p.measure).sum(),
        joints: file.joints.iter().map(|[a, b]| [shown(a), shown(b)]).collect(),
        labels: splines::labels(file, &patches),
        patches,
        points: None,
        cells: Vec::new(),
        groups: Vec::new(),
        fields: Vec::new(),
        quality,
        notes,
    })
}

fn of_mesh(mesh: &MeshFile) -> Inspection {
    let sizes: Vec<Option<f64>> = mesh.blocks.iter().map(|b| meshes::size(b, &mesh.points)).collect();
    let dimension = mesh.dimension();
    let top = mesh.blocks.iter().zip(&sizes).filter(|(b, _)| b.shape.dimension() == dimension);
    let quality = meshes::soundness(mesh);
    let mut notes = mesh.notes.clone();
    if top.clone().any(|(b, _)| matches!(b.shape, CellShape::Prism | CellShape::Pyramid)) {
        let measured = if top.clone().any(|(_, s)| s.is_none()) { "; those of order 2 are counted, not measured" } else { "" };
        notes.push(format!("no body is made of prisms and pyramids, and their quality is not looked at{measured}"));
    }
    add_inverted(&quality, &mut notes);
    notes.extend(meshes::unshared(mesh));
    Inspection {
        format: word(mesh.format).into(),
        kind: "mesh".into(),
        dimension,
        measure: top.filter_map(|(_, s)| *s).sum(),
        patches: Vec::new(),
        joints: Vec::new(),
        labels: Vec::new(),
        points: Some(mesh.points.len()),
        cells: meshes::cells(mesh),
        groups: meshes::groups(mesh, &sizes),
        fields: Vec::new(),
        quality,
        notes,
    }
}

fn add_inverted(quality: &Soundness, notes: &mut Vec<String>) {
    if let Some(first) = quality.inverted_at.first() {
        let [x, y, z] = first.at;
        let place = format!("element {} of {} at ({}, {}, {})", first.element, first.part, short(x, 5), short(y, 5), short(z, 5));
        notes.push(format!("{} inverted elements, the first is {place}; `run` refuses them (E041)", quality.inverted));
    }
}

/// "(1, 0.5)", or with z.
fn point([x, y, z]: &[f64; 3], flat: bool) -> String {
    let [x, y, z] = [x, y, z].map(|v| short(if v.abs() < 1e-12 { 0.0 } else { *v }, 5));
    if flat { format!("({x}, {y})") } else { format!("({x}, {y}, {z})") }
}

impl Inspection {
    /// "length", "area", "volume" of a dimension.
    fn size_word(dimension: usize) -> &'static str {
        ["", "length", "area", "volume"][dimension.min(3)]
    }

    /// Whether all sides lie in the plane z = 0.
    fn flat(&self) -> bool {
        self.dimension < 3 && self.patches.iter().flat_map(|p| p.places.values()).all(|place| place.middle[2] == 0.0)
    }

    /// The inspection as text and tables.
    pub fn text(&self, name: &str) -> String {
        let mut text = String::new();
        let size = Self::size_word(self.dimension);
        // a case of meshes alone has nothing that is measured here
        let is_measured = !self.patches.is_empty() || self.points.is_some();
        let measure = if is_measured { format!(", {size} {}", short(self.measure, 12)) } else { String::new() };
        // writing to a String cannot fail
        let _ = writeln!(text, "{name}: {}, {} of dimension {}{measure}", self.format, self.kind, self.dimension);
        if let Some(points) = self.points {
            let cells: Vec<String> = self.cells.iter().map(|c| format!("{} {} (order {})", c.count, c.shape, c.order)).collect();
            let _ = writeln!(text, "{points} points; {}", cells.join(", "));
        }
        let list = |v: &[usize]| v.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
        let mut patches = Table::new(["patch", "degree", "elements", "kind", "handed", size]);
        let mut sides = Table::new(["side", Self::size_word(self.dimension.saturating_sub(1)), "middle", "outward normal", "label"]);
        for p in &self.patches {
            let kind = if p.rational { "NURBS" } else { "B-spline" };
            patches.row([p.name.clone(), list(&p.degree), list(&p.elements), kind.into(), p.handedness.clone(), short(p.measure, 12)]);
            for (side, measure) in &p.sides {
                let place = p.places.get(side);
                let middle = place.map_or(String::new(), |place| point(&place.middle, self.flat()));
                let looks = match place {
                    Some(SidePlace { normal: Some(normal), .. }) => point(normal, self.flat()),
                    Some(SidePlace { closed_with: Some(other), .. }) => format!("lies on {other}"),
                    _ => "collapsed".to_owned(),
                };
                let side = format!("{}.{side}", p.name);
                let labels: Vec<&str> = self.labels.iter().filter(|l| l.sides.contains(&side)).map(|l| l.name.as_str()).collect();
                sides.row([side, short(*measure, 12), middle, looks, labels.join(" ")]);
            }
        }
        let mut labels = Table::new(["label", "sides", Self::size_word(self.dimension.saturating_sub(1))]);
        for l in &self.labels {
            labels.row([l.name.clone(), l.sides.join(" "), short(l.measure, 12)]);
        }
        let mut groups = Table::new(["group", "dimension", "number", "cells", "nodes", "measure", "middle", "outward normal"]);
        for g in &self.groups {
            let name = g.name.clone().unwrap_or_else(|| g.number.to_string());
            let measure = g.measure.map_or("-".to_owned(), |m| short(m, 12));
            let flat = self.dimension == 2;
            let [middle, normal] = g.place.as_ref().map_or([String::new(), String::new()], |place| {
                [point(&place.middle, flat), place.normal.map_or("all round".to_owned(), |normal| point(&normal, flat))]
            });
            let [dimension, cells, nodes] = [g.dimension, g.cells, g.nodes].map(|n| n.to_string());
            groups.row([name, dimension, g.number.to_string(), cells, nodes, measure, middle, normal]);
        }
        let fields = grid::table(&self.fields);
        for table in [patches, sides, labels, groups, fields].iter().filter(|t| !t.is_empty()) {
            let _ = write!(text, "\n{table}");
        }
        let q = &self.quality;
        if q.elements > 0 {
            let place = point(&q.worst.at, self.flat() && q.worst.at[2] == 0.0);
            let _ = writeln!(
                text,
                "\n{} elements; least Jacobian {}; least scaled Jacobian {} in element {} of {} at {place}",
                q.elements,
                short(q.least_jacobian, 5),
                short(q.least_scaled_jacobian, 5),
                q.worst.element,
                q.worst.part,
            );
            let _ = writeln!(
                text,
                "edges {} to {}; inverted {}, collapsed {}, left-handed {}",
                short(q.shortest_edge, 5),
                short(q.longest_edge, 5),
                q.inverted,
                q.collapsed,
                q.left_handed
            );
        }
        if !self.joints.is_empty() {
            let joints: Vec<String> = self.joints.iter().map(|[a, b]| format!("{a} = {b}")).collect();
            let _ = writeln!(text, "joined in the file: {}", joints.join(", "));
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        text
    }
}
