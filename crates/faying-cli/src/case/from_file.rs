//! `geometry = { kind = "file" }`: the parts of the file that make a patch.

use super::family::{FromFile, MeshSource};
use super::mesh_part::mesh_part;
use super::part::FilePart;
use super::reader::{Block, Reader};
use super::tree::{Node, Value};
use super::types::*;
use crate::errors::Diagnostic;
use crate::place::{Located, Origin, SourceSpan};
use faying::basis::Cell;
use faying_files::{Contents, FileError, MeshFile, SplineFile, SplinePatch};
use std::sync::Arc;

impl Reader {
    /// Reads the keys of the kind `file`; the file itself is not opened here.
    pub fn file_shape(&mut self, b: &mut Block) -> Shape {
        let file = self.required(b, "file").and_then(|n| self.text_of(&n, "file"));
        let mut word = |key: &str| -> Option<Located<String>> {
            let node = b.node(key).cloned()?;
            match &node.value {
                Value::Text(s) => Some(Located::new(s.clone(), node.at)),
                Value::Integer(n) => Some(Located::new(n.to_string(), node.at)),
                _ => {
                    self.wrong_type(&node, key, "a number or a name in quotes", "");
                    None
                }
            }
        };
        let (id, group) = (word("id"), word("group"));
        if let (Some(_), Some(g)) = (&id, &group) {
            self.fault("E015", g.at, "`group` does not stand beside `id`", "`id` selects a spline patch, `group` the cells of a mesh");
        }
        let refinement = b.node("refinement").cloned().and_then(|n| self.text_of(&n, "refinement"));
        for key in ["file", "refinement"] {
            self.absolute(b, key);
        }
        Shape::File { file: file.unwrap_or_default(), id, group, refinement, parts: Vec::new() }
    }

    // absolute path: the effective case is stored in another folder
    pub(super) fn absolute(&mut self, b: &mut Block, key: &str) {
        let Some(Value::Text(name)) = b.node(key).map(|n| &n.value) else { return };
        let absolute = std::path::absolute(self.path_of(name)).ok().and_then(|p| p.to_str().map(str::to_owned));
        if let (Some(path), Some(e)) = (absolute, b.table.get_mut(key)) {
            e.node.value = Value::Text(path);
        }
    }

    /// Reads the file of a patch and fills in its parts. `outlines`: curves in the plane and surfaces in space are accepted.
    pub fn parts(&mut self, geometry: &mut Geometry, outlines: bool) -> Option<FromFile> {
        let at = geometry.shape.at;
        let Shape::File { file, id, group, refinement, .. } = &geometry.shape.value else { return None };
        let (file, id, group, refinement) = (file.clone(), id.clone(), group.clone(), refinement.clone());
        if file.value.is_empty() {
            return None;
        }
        let contents = self.open(&file)?;
        let (found, from) = match &*contents {
            Contents::Patches(spline) => {
                if let Some(g) = &group {
                    let message = format!("`group` selects cells of a mesh, {} holds spline patches", file.value);
                    self.fault("E015", g.at, message, "write id to select a patch");
                    return None;
                }
                let made_of = (geometry.extrude.is_some(), outlines);
                self.spline_parts(&file, spline, id.as_ref(), refinement.as_ref(), made_of)?
            }
            Contents::Mesh(mesh) => {
                let wrong = [("id", id.as_ref()), ("refinement", refinement.as_ref())].into_iter().find_map(|(k, v)| Some((k, v?.at)));
                if let Some((key, at)) = wrong {
                    let help = if key == "id" { "write group to select cells" } else { "write refine = 1 to halve every element" };
                    self.fault("E015", at, format!("`{key}` belongs to files of spline patches, {} holds a mesh", file.value), help);
                    return None;
                }
                if let Some(h) = &geometry.extrude {
                    let message = format!("`extrude` makes bodies of plane spline patches, {} holds a mesh", file.value);
                    self.fault("E015", h.at, message, "extrude the mesh where it was made");
                    return None;
                }
                let part = self.mesh_parts(&file, mesh, group.as_ref())?;
                let mesh = MeshSource {
                    path: std::fs::canonicalize(self.path_of(&file.value)).ok()?,
                    scale: geometry.scale.as_ref().map(|v| v.value),
                    rotate_deg: geometry.rotate_deg.as_ref().map(|v| v.value),
                    axis: geometry.axis.as_ref().map(|v| v.value.clone()),
                    translate: geometry.translate.as_ref().map(|v| v.value.clone()),
                };
                (vec![Arc::new(part)], FromFile { mesh: Some(mesh), ..FromFile::default() })
            }
            #[allow(unreachable_patterns)] // the enum may grow
            _ => {
                self.fault("E043", at, format!("{} holds nothing that bodies are made of", file.value), "");
                return None;
            }
        };
        if let Shape::File { parts, .. } = &mut geometry.shape.value {
            *parts = found;
        }
        Some(from)
    }

    /// Reads the file of an obstacle: areas or curves in the plane, solids or surfaces in space; `None` if the file has an error.
    pub(super) fn obstacle_parts(&mut self, geometry: &mut Geometry) -> Option<()> {
        let Shape::File { file, .. } = &geometry.shape.value else { return Some(()) };
        if file.value.is_empty() {
            return None;
        }
        self.parts(geometry, true).map(|_| ())
    }

    fn spline_parts(
        &mut self,
        file: &Located<String>,
        spline: &SplineFile,
        id: Option<&Located<String>>,
        refinement: Option<&Located<String>>,
        (extruded, outlines): (bool, bool),
    ) -> Option<(Vec<Arc<FilePart>>, FromFile)> {
        let chosen: Vec<usize> = match id {
            None => (0..spline.patches.len()).collect(),
            Some(id) => match patch_of(spline, &id.value) {
                Ok(k) => vec![k],
                Err(e) => {
                    self.file_fault(&file.value, id.at, &e);
                    return None;
                }
            },
        };
        if chosen.is_empty() {
            self.file_fault(&file.value, file.at, &FileError::Broken { what: "there is no patch in it".to_owned(), spot: None });
            return None;
        }
        let n = self.dimension;
        for &k in &chosen {
            let patch = &spline.patches[k];
            let checked = match (n, extruded) {
                (2, false) if outlines && patch.dimension() == 1 => patch.net::<1, 2>().map(|_| ()),
                (3, false) if outlines && patch.dimension() == 2 => patch.net::<2, 3>().map(|_| ()),
                (2, _) | (3, true) => patch.net::<2, 2>().map(|_| ()),
                _ => patch.net::<3, 3>().map(|_| ()),
            };
            if let Err(e) = checked {
                let e = match (e, chosen.len()) {
                    (FileError::Dimension { what, spot }, m) if m > 1 => FileError::Dimension { what: format!("patch {k}: {what}"), spot },
                    (FileError::Broken { what, spot }, m) if m > 1 => FileError::Broken { what: format!("patch {k}: {what}"), spot },
                    (e, _) => e,
                };
                self.file_fault(&file.value, file.at, &e);
                return None;
            }
        }
        let refined;
        let spline = match refinement {
            None => spline,
            Some(list) => {
                refined = self.refined(list, spline)?;
                &refined
            }
        };
        let place = |k: usize| chosen.iter().position(|c| *c == k);
        let labels = spline.labels.iter().map(|l| {
            let sides = l.sides.iter().filter_map(|s| Some((place(s.patch)?, s.side.clone())));
            (l.name.clone(), sides.collect::<Vec<_>>())
        });
        let from = FromFile { mesh: None, labels: labels.filter(|(_, sides)| !sides.is_empty()).collect() };
        Some((chosen.iter().map(|k| Arc::new(FilePart::Spline(spline.patches[*k].clone()))).collect(), from))
    }

    fn refined(&mut self, list: &Located<String>, spline: &SplineFile) -> Option<SplineFile> {
        let bytes = self.open_list(list)?;
        match faying_files::mfem::refinement_list(&bytes).and_then(|knots| spline.refined(&knots)) {
            Ok(refined) => Some(refined),
            Err(e) => {
                self.file_fault(&list.value, list.at, &e);
                None
            }
        }
    }

    fn mesh_parts(&mut self, file: &Located<String>, mesh: &MeshFile, group: Option<&Located<String>>) -> Option<FilePart> {
        let name = group.map(|g| g.value.as_str());
        let made = match self.dimension {
            2 => mesh_part::<2>(mesh, name).map(FilePart::Plane),
            _ => mesh_part::<3>(mesh, name).map(FilePart::Space),
        };
        match made {
            Ok(part) => Some(part),
            Err(e) => {
                let at = match (&e, group) {
                    (FileError::Missing { .. } | FileError::Dimension { .. }, Some(g)) => g.at,
                    _ => file.at,
                };
                self.file_fault(&file.value, at, &e);
                None
            }
        }
    }

    /// Adapts the discretization of a patch of mesh cells: the backend is fe, keys of parametrised patches are errors (E015).
    pub fn mesh_discretization(&mut self, b: &mut Block, geometry: &Geometry, d: &mut Discretization) {
        let Some(part) = geometry.shape.mesh_part() else { return };
        for (key, help) in [
            ("elements", "write refine = 1 to halve every element"),
            ("grade", "the sizes of a mesh are those of its file"),
            ("cells", "the cells of a mesh are those of its file"),
            ("closed", "a mesh is closed where its cells are"),
            ("glue", "groups of one mesh are tied or left apart by interfaces and contacts"),
        ] {
            if b.has(key) {
                self.fault("E015", b.key_at(key), format!("`{key}` is not a key of patches that are read from a mesh"), help);
                b.table.entries.retain(|e| e.key != key);
            }
        }
        if d.backend.value != "fe" && d.backend.at.origin != Origin::Default {
            let message = format!("{} is read from a Lagrange mesh and stays with backend \"fe\"", b.what);
            self.push(d.backend.at, Diagnostic::warning("E015", message));
        }
        if d.backend.value != "fe" {
            let at = SourceSpan { origin: Origin::Default, ..b.at };
            b.table.set("backend", at, Node::new(Value::Text("fe".to_owned()), at));
            d.backend = Located::new("fe".to_owned(), d.backend.at);
        }
        let simplex = match part {
            FilePart::Plane(p) => p.cells.blocks.iter().any(|c| c.cell == Cell::Simplex),
            FilePart::Space(p) => p.cells.blocks.iter().any(|c| c.cell == Cell::Simplex),
            FilePart::Spline(_) => false,
        };
        d.cells.value = if simplex { Cell::Simplex } else { Cell::Tensor };
        if let (Some(p), false) = (d.degree.iter().find(|p| **p != d.degree[0]), simplex) {
            let message = format!("the cells of a mesh have one degree for all directions, found {} and {p}", d.degree[0]);
            self.fault("E015", d.degree.at, message, format!("write degree = {}", d.degree[0]));
        }
    }
}

// by its number in the file, or by its index if the file has no numbers, else by name
fn patch_of(file: &SplineFile, wanted: &str) -> Result<usize, FileError> {
    let number = wanted.parse::<i64>().ok();
    let numbered = file.patches.iter().any(|p| p.id.is_some());
    let by_number = |p: &SplinePatch| number.is_some() && p.id == number;
    let place = || number.filter(|_| !numbered).and_then(|n| usize::try_from(n).ok()).filter(|k| *k < file.patches.len());
    let by_name = || file.patches.iter().position(|p| p.name.as_deref() == Some(wanted));
    file.patches.iter().position(by_number).or_else(place).or_else(by_name).ok_or_else(|| {
        let label = |(k, p): (usize, &SplinePatch)| p.id.map_or_else(|| k.to_string(), |id| id.to_string());
        let all: Vec<String> = file.patches.iter().enumerate().map(label).collect();
        let known = match all.len() {
            n if n > 20 => format!("{}, .. ({n} patches)", all[..20].join(", ")),
            _ => all.join(", "),
        };
        FileError::Missing { wanted: format!("patch {wanted:?}"), known: format!("patches {known}") }
    })
}
