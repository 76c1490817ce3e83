//! `geometry = { kind = "file" }`: the parts of the file that make a patch, and the patches of a file as patches of the case.

use std::path::PathBuf;
use std::sync::Arc;

use super::family::{Family, Label};
use super::mesh_part::{mesh_part, met, shared};
use super::part::{FilePart, MeshPart};
use super::reader::{Block, Reader};
use super::tree::{Node, Value};
use super::types::*;
use crate::errors::Diagnostic;
use crate::place::{Located, Origin, Place};
use faying::basis::Cell;
use faying_files::{self, Contents, FileError, MeshFile, SplineFile, SplinePatch};

/// Data of a `[[patch]]` read from a file, beside its parts, until it is expanded.
#[derive(Debug, Default)]
pub(super) struct FromFile {
    /// Source of its cells, for meshes: patches of equal sources share their common facets and points.
    mesh: Option<MeshSource>,
    /// Sides by their names in the file, as indices into the list of parts.
    labels: Vec<(String, Vec<(usize, String)>)>,
}

/// A mesh file and the transformation of its points.
#[derive(Clone, Debug, PartialEq)]
struct MeshSource {
    path: PathBuf,
    scale: Option<f64>,
    rotate_deg: Option<f64>,
    axis: Option<Vec<f64>>,
    translate: Option<Vec<f64>>,
}

impl Reader {
    /// Reads the keys of the kind `file`; the file itself is not opened here.
    pub fn file_shape(&mut self, b: &mut Block) -> Shape {
        let file = self.required(b, "file", "file = \"part.xml\"").and_then(|n| self.text_of(&n, "file"));
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

    /// Reads the file of a patch and fills in its parts. `curves`: spline patches of one parameter are accepted.
    pub fn parts(&mut self, geometry: &mut Geometry, curves: bool) -> Option<FromFile> {
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
                let made_of = (geometry.extrude.is_some(), curves);
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

    /// Reads the file of an obstacle: areas, or curves in the plane; `None` if the file has an error.
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
        (extruded, curves): (bool, bool),
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
                (2, false) if curves && patch.dimension() == 1 => patch.net::<1, 2>().map(|_| ()),
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
            let at = Place { origin: Origin::Default, ..b.at };
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

    /// Expands a patch of a file with several patches into NAME.0, NAME.1, ..; records the facets that groups of one mesh share.
    pub fn expand(&mut self, patches: Vec<Patch>) -> Vec<Patch> {
        let all = std::mem::take(&mut self.from_files);
        let mut out: Vec<Patch> = Vec::with_capacity(patches.len());
        let mut meshes: Vec<(usize, MeshSource)> = Vec::new();
        for (mut patch, from) in patches.into_iter().zip(all) {
            let Some(from) = from else {
                out.push(patch);
                continue;
            };
            let first = out.len();
            let parts = match &mut patch.geometry.value.shape.value {
                Shape::File { parts, .. } => std::mem::take(parts),
                _ => Vec::new(),
            };
            let name = patch.name.clone();
            let single = parts.len() == 1;
            for (k, part) in parts.into_iter().enumerate() {
                let mut one = patch.clone();
                if let Shape::File { parts, .. } = &mut one.geometry.value.shape.value {
                    parts.push(part);
                }
                if !single {
                    one.name = Located::new(format!("{}.{k}", name.value), name.at);
                }
                out.push(one);
            }
            let labels = from.labels.into_iter().map(|(name, sides)| Label {
                name,
                sides: sides.into_iter().map(|(k, side)| SideRef { patch: first + k, side }).collect(),
            });
            self.families.push(Family { name: name.value.clone(), patches: first..out.len(), labels: labels.collect() });
            if let Some(source) = from.mesh {
                meshes.push((first, source));
            }
        }
        self.mesh_joints(&mut out, meshes);
        out
    }

    // groups of one mesh share the facets that have the same points in the file
    fn mesh_joints(&mut self, patches: &mut [Patch], mut meshes: Vec<(usize, MeshSource)>) {
        while let Some((first, source)) = meshes.first().cloned() {
            let (same, others): (Vec<_>, Vec<_>) = meshes.into_iter().partition(|(_, s)| *s == source);
            meshes = others;
            let members: Vec<usize> = same.into_iter().map(|(k, _)| k).collect();
            if members.len() < 2 {
                continue;
            }
            self.overlap(patches, &members);
            match patches[first].geometry.shape.part() {
                Some(FilePart::Plane(_)) => self.join(patches, &members, plane, plane_mut),
                Some(FilePart::Space(_)) => self.join(patches, &members, space, space_mut),
                _ => {}
            }
        }
    }

    // reports a cell that is in two patches (E015)
    fn overlap(&mut self, patches: &[Patch], members: &[usize]) {
        let mut owner: std::collections::BTreeMap<u64, usize> = std::collections::BTreeMap::new();
        for &k in members {
            let ids = match patches[k].geometry.shape.part() {
                Some(FilePart::Plane(p)) => &p.ids,
                Some(FilePart::Space(p)) => &p.ids,
                _ => continue,
            };
            let twice = ids.iter().find_map(|id| Some((*id, owner.insert(*id, k).filter(|o| *o != k)?)));
            if let Some((id, other)) = twice {
                let message =
                    format!("cell {id} of the file is in patches {:?} and {:?}", patches[other].name.value, patches[k].name.value);
                self.fault("E015", patches[k].geometry.at, message, "patches of one mesh take different groups, which share no cell");
                return;
            }
        }
    }

    fn join<const N: usize>(&mut self, patches: &mut [Patch], members: &[usize], get: Get<N>, get_mut: GetMut<N>) {
        let parts: Vec<&MeshPart<N>> = members.iter().filter_map(|k| get(&patches[*k])).collect();
        if parts.len() < members.len() {
            return;
        }
        let common = shared(&parts);
        let met = met(&parts, &common);
        for ([a, b], facets) in common {
            let (a, b) = (members[a], members[b]);
            let names = [a, b].map(|k| patches[k].name.value.clone());
            let mut add = |k: usize, other: &str| {
                let facets = facets.clone();
                let side = get_mut(&mut patches[k]).map_or(String::new(), |p| p.add_side(&format!("joint with {other}"), facets));
                SideRef { patch: k, side }
            };
            let sides = [add(a, &names[1]), add(b, &names[0])];
            self.joints.push(Joint { sides, at: patches[b].geometry.at });
        }
        for (point, places) in met {
            let patches_there: Vec<usize> = places.iter().map(|k| members[*k]).collect();
            let at = patches[*patches_there.last().expect("points are met by two")].geometry.at;
            self.meetings.push(Meeting { patches: patches_there, point, at });
        }
    }

    /// Joints of patches that no interface or contact names as a pair: those that are kept, and those separated by a list of `between`.
    pub fn kept_joints(&mut self, interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> [Vec<Joint>; 2] {
        let parted = Parted::of(interfaces, contacts, patches);
        let joints = std::mem::take(&mut self.joints);
        let pair = |j: &Joint| [j.sides[0].patch, j.sides[1].patch];
        let (kept, parted) = joints.into_iter().filter(|j| !parted.named(pair(j))).partition(|j| !parted.listed(pair(j)));
        [kept, parted]
    }

    /// Shared points of patches of which no two are separated: an interface that meets others in a point keeps its ends.
    pub fn kept_meetings(&mut self, interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> Vec<Meeting> {
        let parted = Parted::of(interfaces, contacts, patches);
        let mut meetings = std::mem::take(&mut self.meetings);
        meetings.retain(|m| {
            let pairs = m.patches.iter().enumerate().flat_map(|(k, a)| m.patches[..k].iter().map(move |b| [*a, *b]));
            !pairs.into_iter().any(|pair| parted.named(pair) || parted.listed(pair))
        });
        // inner nodes of an edge are not points of the file
        let mut seen: std::collections::BTreeSet<&[usize]> = std::collections::BTreeSet::new();
        let inner = |k: &usize| patches[*k].refine.value > 0 || patches[*k].discretization.degree.value.iter().any(|p| *p > 1);
        let edge = meetings.iter().find(|m| self.dimension == 3 && !seen.insert(&m.patches) && m.patches.iter().any(inner)).cloned();
        if let Some(m) = edge {
            let names: Vec<String> = m.patches.iter().map(|k| format!("{:?}", patches[*k].name.value)).collect();
            let message = format!(
                "patches {} of one mesh meet in an edge without a common facet there, which is joined in this version at degree 1 without `refine` alone",
                names.join(", ")
            );
            self.fault("E019", m.at, message, "read them as one group, or name the pair in an interface");
        }
        meetings
    }
}

/// Pairs of patches that interfaces and contacts separate.
struct Parted {
    named: std::collections::BTreeSet<[usize; 2]>,
    lists: Vec<std::collections::BTreeSet<usize>>,
}

impl Parted {
    fn of(interfaces: &[Tie], contacts: &[Contact], patches: &[Patch]) -> Self {
        let mut named = std::collections::BTreeSet::new();
        let mut pair = |slave: &[Located<SideRef>], master: &[Located<SideRef>]| {
            for s in slave {
                for m in master {
                    named.insert([s.patch.min(m.patch), s.patch.max(m.patch)]);
                }
            }
        };
        for t in interfaces {
            pair(&t.slave, &t.master);
        }
        for c in contacts {
            if let Master::Sides(master) = &c.master {
                pair(&c.slave, master);
            }
        }
        let number = |name: &String| patches.iter().position(|p| p.name.value == *name);
        let lists = interfaces.iter().filter_map(|t| t.between.as_ref()).map(|b| b.value.iter().filter_map(number).collect()).collect();
        Self { named, lists }
    }

    /// Whether an interface or a contact names sides of both.
    fn named(&self, [a, b]: [usize; 2]) -> bool {
        self.named.contains(&[a.min(b), a.max(b)])
    }

    /// Whether a list of `between` holds both.
    fn listed(&self, [a, b]: [usize; 2]) -> bool {
        self.lists.iter().any(|l| l.contains(&a) && l.contains(&b))
    }
}

type Get<const N: usize> = fn(&Patch) -> Option<&MeshPart<N>>;
type GetMut<const N: usize> = fn(&mut Patch) -> Option<&mut MeshPart<N>>;

fn plane(patch: &Patch) -> Option<&MeshPart<2>> {
    match patch.geometry.shape.part() {
        Some(FilePart::Plane(p)) => Some(p),
        _ => None,
    }
}

fn space(patch: &Patch) -> Option<&MeshPart<3>> {
    match patch.geometry.shape.part() {
        Some(FilePart::Space(p)) => Some(p),
        _ => None,
    }
}

fn plane_mut(patch: &mut Patch) -> Option<&mut MeshPart<2>> {
    match patch.geometry.value.shape.value.part_mut()? {
        FilePart::Plane(p) => Some(p),
        _ => None,
    }
}

fn space_mut(patch: &mut Patch) -> Option<&mut MeshPart<3>> {
    match patch.geometry.value.shape.value.part_mut()? {
        FilePart::Space(p) => Some(p),
        _ => None,
    }
}

/// The sides that cover the boundary of a patch of mesh cells, except `used` ones.
pub(super) fn outer_of(patch: &mut Patch, used: &[&str]) -> Vec<String> {
    match patch.geometry.value.shape.value.part_mut() {
        Some(FilePart::Plane(p)) => p.outer(used),
        Some(FilePart::Space(p)) => p.outer(used),
        _ => Vec::new(),
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
