//! Case files: TOML with places into a typed [`Case`], with every default filled in and every error listed.
//!
//! Stages of reading: parse (E005), apply `--set`, type every block, compare the blocks with each other, reject features
//! that are not implemented (E019). After an error of any stage reading continues if possible, so that several errors are
//! reported together.

mod boundary;
mod changes;
mod family;
mod files;
mod from_file;
mod key;
mod keys;
mod mesh_part;
mod model;
mod names;
mod not_yet;
mod nurbs;
mod obstacle;
mod opened;
mod part;
mod patch;
mod reader;
mod relations;
mod reports;
mod schema;
mod schema_keys;
mod set;
mod sides;
mod tie;
mod tree;
mod types;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

use self::reader::{Block, Reader};
use self::tree::{Node, Table, Value};
use super::errors::{Diagnostic, Diagnostics, Source, nearest};
use super::formula::Constants;
use super::place::{Lines, Located, Place};

pub use changes::Changes;
pub use files::FileRead;
pub use key::{Given, Key, KeyKind};
pub use names::{EntryKeys, MethodEntry, Names};
pub(crate) use names::{built_in_couplings, built_in_methods};
pub use opened::sha256;
pub use part::{FilePart, MeshPart};
pub(crate) use schema::is_key;
pub use schema::schema;
pub(crate) use sides::{alias, canonical, quoted};
pub use types::*;

/// The schema that this version writes and reads.
pub const SCHEMA: usize = 1;

/// Options of reading a case, beside its file.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Texts `a.b=v` of the options `--set`, in their order.
    pub sets: Vec<String>,
    /// `--backend`: replaces the backend of every patch.
    pub backend: Option<String>,
    /// Changes by a row of a study, applied after all other options.
    pub changes: Changes,
    /// Known names of backends, couplings, multipliers and constraint solvers.
    pub names: Names,
    /// The folder that paths in the case are relative to; `None`: that of the case file, or the current one for a text.
    pub folder: Option<PathBuf>,
    /// Most bytes that reading a geometry file may take; `None`: no limit.
    pub memory: Option<u64>,
}

impl Case {
    /// Reads a case file without options.
    ///
    /// # Errors
    /// Every error that was found, located; see [`crate::codes`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, Diagnostics> {
        Self::read_with(path, &ReadOptions::default())
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// E003 if there is no such file, else as [`Case::parse`].
    pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self, Diagnostics> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|e| Diagnostics::from(not_found(path, &e)))?;
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            let start = String::from_utf8_lossy(&e.as_bytes()[..at]).into_owned();
            let source = Source { name: name.clone(), lines: Lines::new(&start), sets: Vec::new() };
            let place = source.lines.place(start.len()..start.len());
            let message = format!("the file is not valid TOML: byte {at} is not UTF-8");
            Diagnostics::from(Diagnostic::error("E005", message).with_help("save the file as UTF-8 text").at(&source, place))
        })?;
        let folder = options.folder.clone().or_else(|| path.parent().map(Path::to_owned));
        Self::parse(&name, &text, &ReadOptions { folder, ..options.clone() })
    }

    /// Reads the text of a case; `name` is its name in messages.
    ///
    /// # Errors
    /// Every error that was found, located, in the order of the file.
    pub fn parse(name: &str, text: &str, options: &ReadOptions) -> Result<Self, Diagnostics> {
        // editors of Windows put a mark in front
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source { name: name.to_owned(), lines: Lines::new(text), sets: options.sets.clone() };
        let mut root = tree::parse(&source)?;
        let mut reader = Reader {
            source,
            found: Diagnostics::new(),
            constants: Constants::default(),
            names: Vec::new(),
            known: options.names.clone(),
            dimension: 2,
            components: 1,
            broken: BTreeSet::new(),
            density_broken: false,
            folder: options.folder.clone().unwrap_or_default(),
            memory: options.memory,
            files: Vec::new(),
            opened: Vec::new(),
            from_files: Vec::new(),
            families: Vec::new(),
            joints: Vec::new(),
            meetings: Vec::new(),
        };
        for (k, option) in options.sets.iter().enumerate() {
            if let Err(d) = set::apply(&mut root, option, k) {
                reader.found.push(*d);
            }
        }
        if let Some(backend) = &options.backend {
            changes::apply(&mut root, &Changes { backend: Some(backend.clone()), ..Changes::default() }, &options.names);
        }
        changes::apply(&mut root, &options.changes, &options.names);
        let case = reader.case(root, options);
        let mut found = reader.found;
        found.sort();
        if found.has_errors() {
            return Err(found);
        }
        Ok(Self { warnings: found, source: reader.source, ..case })
    }

    /// The case with every default written out, as a case file that reads back to the same case.
    pub fn effective_toml(&self) -> &str {
        &self.effective
    }

    /// Components of the unknown: 1 for Poisson, the dimension for elasticity.
    pub fn components(&self) -> usize {
        self.model.components()
    }

    /// Whether the case has `[steps]`; without it there is one step at t = 1.
    pub fn has_steps(&self) -> bool {
        self.steps.at != Place::NONE
    }

    /// The position of a patch by its name.
    pub fn patch_index(&self, name: &str) -> Option<usize> {
        self.patches.iter().position(|p| p.name.value == name)
    }

    /// `lower.v0`: the name of a side in results.
    pub fn side_name(&self, side: &SideRef) -> String {
        sides::show(side, &self.patches)
    }

    /// The sides of a patch, without collapsed edges.
    pub fn sides(&self, patch: usize) -> Vec<&str> {
        self.patches.get(patch).map_or(Vec::new(), |p| sides::sides_of(&p.geometry.shape, self.model.dimension.value))
    }

    /// The sides named by a text: `lower.top`, `bracket."top face"`, or a name that a file gives to several; empty if there is no
    /// such side.
    pub fn find_sides(&self, text: &str) -> Vec<SideRef> {
        sides::find(text, &self.patches, &self.families, self.model.dimension.value).unwrap_or_default()
    }

    /// The patches of a name: one, or all patches of a file.
    pub fn find_patches(&self, name: &str) -> Vec<usize> {
        if let Some(k) = self.patch_index(name) {
            return vec![k];
        }
        self.families.iter().find(|f| f.name == name).map_or(Vec::new(), |f| f.patches.clone().collect())
    }

    /// The patches of every file whose touching sides are glued, with the place of their block.
    pub fn glued_files(&self) -> Vec<(Range<usize>, Place)> {
        let glued = self.families.iter().filter(|f| f.patches.len() > 1 && self.patches[f.patches.start].glue.value);
        glued.map(|f| (f.patches.clone(), self.patches[f.patches.start].geometry.at)).collect()
    }

    /// A diagnostic at a place of this case.
    pub fn diagnostic(&self, diagnostic: Diagnostic, at: Place) -> Diagnostic {
        diagnostic.at(&self.source, at)
    }
}

/// E003 for a file that cannot be read, with similar names in its folder.
pub fn not_found(path: &Path, error: &std::io::Error) -> Diagnostic {
    let name = path.display().to_string();
    if error.kind() != std::io::ErrorKind::NotFound {
        return Diagnostic::error("E003", format!("cannot read {name}: {error}")).in_file(name);
    }
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let wanted = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let mut names: Vec<String> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        .unwrap_or_default();
    names.sort();
    let stem = wanted.trim_end_matches(".toml").to_lowercase();
    let mut similar: Vec<String> = nearest(&wanted, names.iter().map(String::as_str)).map(str::to_owned).into_iter().collect();
    for n in &names {
        let close = !stem.is_empty() && n.ends_with(".toml") && n.to_lowercase().contains(&stem);
        if close && !similar.contains(n) && similar.len() < 5 {
            similar.push(n.clone());
        }
    }
    let help = if !folder.is_dir() {
        format!("there is no folder {}", folder.display())
    } else if similar.is_empty() {
        let cases: Vec<&str> = names.iter().map(String::as_str).filter(|n| n.ends_with(".toml")).take(8).collect();
        if cases.is_empty() {
            "no case file is in that folder; `faying new --list` shows samples".to_owned()
        } else {
            format!("case files there: {}", cases.join(", "))
        }
    } else {
        format!("similar names there: {}", similar.join(", "))
    };
    Diagnostic::error("E003", format!("there is no file {name}")).in_file(name).with_help(help)
}

impl Reader {
    fn case(&mut self, root: Table, options: &ReadOptions) -> Case {
        let names = &options.names;
        let root = Node::new(Value::Table(root), Place::NONE);
        let mut root = self.block(&root, "", keys::ROOT).expect("the document is a table");
        let schema = self.schema(&mut root);
        let mut case = Case::empty(schema);
        if schema.value > SCHEMA {
            return case;
        }
        let title = self.title(&mut root);
        self.constants(root.node("let").cloned().as_ref());
        self.names = name_list(&root);
        let model = self.section(&mut root, "model", keys::MODEL, true, Self::model).unwrap_or(case.model);
        self.dimension = model.dimension.value;
        self.components = model.components();
        let discretization = self
            .section(&mut root, "discretization", keys::DISCRETIZATION, false, |r, b| r.discretization(b, None, names))
            .unwrap_or(case.discretization);
        // before the patches, which refer to them
        let materials = self.materials(&mut root, &model);
        let mut patches = self.patches(&mut root, &model, &discretization, &materials, names);
        let read = self.list(&mut root, "boundary", keys::BOUNDARY, |r, b, k| r.boundary(b, k, &model, &patches));
        let [of_ties, of_contacts] = names.couple_keys();
        let interfaces = self.list(&mut root, "interface", &of_ties, |r, b, k| r.interface(b, k, &model, &patches, names));
        let contacts = self.list(&mut root, "contact", &of_contacts, |r, b, k| r.contact(b, k, &model, &patches, names));
        let written = root.has("steps").then(|| self.section(&mut root, "steps", keys::STEPS, false, |r, b| r.steps(Some(b))));
        let steps = written.flatten().unwrap_or_else(|| self.steps(None));
        let solver = self.section(&mut root, "solver", keys::SOLVER, false, |r, b| r.solver(b, names)).unwrap_or(case.solver);
        let probes = self.list(&mut root, "probe", keys::PROBE, Self::probe);
        let checks = self.list(&mut root, "check", keys::CHECK, |r, b, k| r.check(b, k, names));
        let studies = self.studies(root.node("study").cloned().as_ref());

        self.unique("boundary", &read.iter().map(|b| b.boundary.name.clone()).collect::<Vec<_>>());
        let couples = interfaces.iter().map(|t| t.name.clone()).chain(contacts.iter().map(|c| c.name.clone()));
        self.unique("interface or contact", &couples.collect::<Vec<_>>());
        self.unique("probe", &probes.iter().map(|p| p.name.clone()).collect::<Vec<_>>());
        self.unique("check", &checks.iter().map(|c| c.name.clone()).collect::<Vec<_>>());
        let [joints, parted] = self.kept_joints(&interfaces, &contacts, &patches);
        let meetings = self.kept_meetings(&interfaces, &contacts, &patches);
        // joints separated by a list of `between` are tied again and are no outer sides
        let inner: Vec<Joint> = joints.iter().chain(&parted).cloned().collect();
        let boundaries = self.outer(read, &interfaces, &contacts, &inner, &mut patches);
        self.slaves(&interfaces, &contacts, &patches);
        self.iterations(&contacts);
        self.conditions(&boundaries, &patches, model.components());
        self.exact_data(&boundaries, &model);
        self.weight(&model, &materials, &patches);

        case = Case {
            source: Source::default(),
            warnings: Diagnostics::new(),
            schema,
            title,
            constants: self.constants.clone(),
            model,
            discretization,
            materials,
            patches,
            joints,
            meetings,
            files: std::mem::take(&mut self.files),
            families: std::mem::take(&mut self.families),
            boundaries,
            interfaces,
            contacts,
            steps,
            solver,
            probes,
            checks,
            studies,
            effective: String::new(),
        };
        self.not_in_this_version(&case);
        case.effective = format!(
            "# {} with every default written out by faying {}\n{}",
            super::errors::one_line(&self.source.name),
            env!("CARGO_PKG_VERSION"),
            root.finish().to_document()
        );
        case
    }

    // title: none by default
    fn title(&mut self, root: &mut Block) -> Located<String> {
        match root.node("title").cloned() {
            Some(node) => self.text_of(&node, "title").unwrap_or_default(),
            None => Located::new(String::new(), root.default("title", Value::Text(String::new()))),
        }
    }

    fn schema(&mut self, root: &mut Block) -> Located<usize> {
        let Some(node) = root.node("schema").cloned() else {
            return Located::new(SCHEMA, root.default("schema", Value::Integer(SCHEMA as i64)));
        };
        if let Value::Integer(n) = node.value
            && n > SCHEMA as i64
        {
            let message = format!("the case has schema {n}, this program reads schema {SCHEMA}");
            self.fault("E001", node.at, message, "install a newer faying, or write the case for schema 1");
            return Located::new(usize::MAX, node.at);
        }
        Located::new(self.whole_of(&node, "schema", 1, SCHEMA as i64).unwrap_or(SCHEMA), node.at)
    }

    // [key]: an absent section is an empty one, unless it is required
    fn section<T>(
        &mut self,
        root: &mut Block,
        key: &str,
        known: &[&'static str],
        required: bool,
        read: impl FnOnce(&mut Self, &mut Block) -> T,
    ) -> Option<T> {
        let node = match root.node(key).cloned() {
            Some(node) if matches!(node.value, Value::Table(_)) => node,
            Some(node) => {
                self.fault("E014", node.at, format!("`{key}` must be a table, found {}", node.describe()), format!("write [{key}]"));
                return None;
            }
            None if required => {
                self.fault(
                    "E013",
                    self.source.lines.place(0..0),
                    format!("[{key}] is missing in the case"),
                    format!("keys of [{key}]: {}", known.join(", ")),
                );
                return None;
            }
            None => {
                let at = root.default(key, Value::Table(Table::default()));
                Node::new(Value::Table(Table::default()), at)
            }
        };
        let mut b = self.block(&node, &format!("[{key}]"), known)?;
        let value = read(self, &mut b);
        root.replace(key, b.finish());
        Some(value)
    }

    // [[key]]
    fn list<T>(
        &mut self,
        root: &mut Block,
        key: &str,
        known: &[&'static str],
        mut read: impl FnMut(&mut Self, &mut Block, usize) -> T,
    ) -> Vec<T> {
        if root.meant.contains(&key) {
            self.broken.insert(key.to_owned());
        }
        let Some(node) = root.node(key).cloned() else { return Vec::new() };
        let wrong = |r: &mut Self, node: &Node| {
            r.broken.insert(key.to_owned());
            r.fault("E014", node.at, format!("`{key}` must be a list of tables, found {}", node.describe()), format!("write [[{key}]]"));
        };
        let Value::List(items) = &node.value else {
            wrong(self, &node);
            return Vec::new();
        };
        let mut out = Vec::new();
        let mut tables = Vec::new();
        for (k, item) in items.iter().enumerate() {
            if !matches!(item.value, Value::Table(_)) {
                wrong(self, item);
                continue;
            }
            let named = matches!(&item.value, Value::Table(t) if t.get("name").is_some());
            let what = if named { key.to_owned() } else { format!("{key} {k}") };
            let Some(mut b) = self.block(item, &what, known) else { continue };
            out.push(read(self, &mut b, k));
            tables.push(Node { value: Value::Table(b.finish()), ..item.clone() });
        }
        if let Some(e) = root.table.get_mut(key) {
            e.node.value = Value::List(tables);
        }
        out
    }
}

// names that quantities may hold
fn name_list(root: &Block) -> Vec<String> {
    let mut out = Vec::new();
    for key in ["patch", "interface", "contact", "boundary", "probe"] {
        let Some(Value::List(items)) = root.node(key).map(|n| &n.value) else { continue };
        for (k, item) in items.iter().enumerate() {
            let Value::Table(t) = &item.value else { continue };
            match t.get("name").map(|e| &e.node.value) {
                Some(Value::Text(name)) => out.push(name.clone()),
                _ => out.push(format!("{key}-{k}")),
            }
        }
    }
    out
}

impl Case {
    // placeholder for blocks that could not be read; never returned
    fn empty(schema: Located<usize>) -> Self {
        fn none<T>(value: T) -> Located<T> {
            Located::new(value, Place::NONE)
        }
        Self {
            source: Source::default(),
            warnings: Diagnostics::new(),
            schema,
            title: Located::default(),
            constants: Constants::default(),
            model: Model {
                head: none(()),
                physics: none(Physics::Elasticity),
                dimension: none(2),
                assumption: none(Assumption::PlaneStrain),
                exact: None,
                source: None,
                gravity: None,
                reference: None,
                stored: None,
            },
            discretization: Discretization {
                backend: none("iga".to_owned()),
                degree: none(vec![2; 2]),
                continuity: none(None),
                basis: none(BasisKind::Auto),
                cells: none(Cell::Tensor),
                mapping: none(Mapping::Isoparametric),
                extra_points: none(0),
            },
            materials: Vec::new(),
            patches: Vec::new(),
            joints: Vec::new(),
            meetings: Vec::new(),
            files: Vec::new(),
            families: Vec::new(),
            boundaries: Vec::new(),
            interfaces: Vec::new(),
            contacts: Vec::new(),
            steps: none(vec![1.0]),
            solver: Solver {
                constraint: none("auto".to_owned()),
                linear: none(Linear::Auto),
                tolerance: none(1e-10),
                max_iterations: None,
            },
            probes: Vec::new(),
            checks: Vec::new(),
            studies: Vec::new(),
            effective: String::new(),
        }
    }
}
