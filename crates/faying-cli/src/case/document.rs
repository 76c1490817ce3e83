//! The whole document, block by block, and what is compared between blocks.

use super::boundary::Read;
use super::reader::{Block, Reader, Sign};
use super::tree::{Node, Table, Value};
use super::types::*;
use super::{SCHEMA, rows};
use crate::errors::{CaseText, Diagnostics};
use crate::formula::Constants;
use crate::place::{Located, SourceSpan};
use faying::basis::Cell;

/// Longest name of a unit, in letters.
const LONGEST_UNIT: usize = 12;

impl Reader {
    pub(super) fn case(&mut self, root: Table) -> Case {
        let root = Node::new(Value::Table(root), SourceSpan::NONE);
        let mut root = self.block(&root, "", rows::ROOT).expect("the document is a table");
        let schema = self.schema(&mut root);
        let mut case = Case::empty(schema);
        if schema.value > SCHEMA {
            return case;
        }
        let title = self.title(&mut root);
        let units = root.has("units").then(|| self.section(&mut root, "units", rows::UNITS, false, Self::units));
        let units = units.flatten().unwrap_or_default();
        let output = root.has("output").then(|| self.section(&mut root, "output", rows::OUTPUT, false, Self::output));
        let (deformed, shown) = output.flatten().unwrap_or_default();
        self.constants(root.node("let").cloned().as_ref());
        self.names = name_list(&root);
        let model = self.section(&mut root, "model", rows::MODEL, true, Self::model).unwrap_or(case.model);
        self.dimension = model.dimension.value;
        self.components = model.components();
        let discretization = self
            .section(&mut root, "discretization", rows::DISCRETIZATION, false, |r, b| r.discretization(b, None))
            .unwrap_or(case.discretization);
        self.backend = Some(discretization.backend.clone());
        let materials = self.materials(&mut root, &model);
        let mut patches = self.patches(&mut root, &model, &discretization, &materials);
        let read = self.list(&mut root, "boundary", rows::BOUNDARY, |r, b, k| r.boundary(b, k, &model, &patches));
        let [of_ties, of_contacts] = [rows::INTERFACE, rows::CONTACT].map(|keys| self.known.extended(keys));
        let interfaces = self.list(&mut root, "interface", &of_ties, |r, b, k| r.interface(b, k, &model, &patches));
        let contacts = self.list(&mut root, "contact", &of_contacts, |r, b, k| r.contact(b, k, &model, &patches));
        let written = root.has("steps").then(|| self.section(&mut root, "steps", rows::STEPS, false, |r, b| r.steps(Some(b))));
        let steps = written.flatten().unwrap_or_else(|| self.steps(None));
        let solver = self.section(&mut root, "solver", rows::SOLVER, false, Self::solver).unwrap_or(case.solver);
        let probes = self.list(&mut root, "probe", rows::PROBE, Self::probe);
        let lines = self.list(&mut root, "line", rows::LINE, Self::line);
        let checks = self.list(&mut root, "check", rows::CHECK, Self::check);
        let studies = self.studies(root.node("study").cloned().as_ref());

        self.names_once(&read, (&interfaces, &contacts), (&probes, &lines, &checks));
        let [joints, parted] = self.kept_joints(&interfaces, &contacts, &patches);
        let meetings = self.kept_meetings(&interfaces, &contacts, &patches);
        // joints separated by a list of `between` are tied again and are no outer sides
        let inner: Vec<Joint> = joints.iter().chain(&parted).cloned().collect();
        let boundaries = self.outer(read, &interfaces, &contacts, &inner, &mut patches);
        self.slaves(&interfaces, &contacts, &patches);
        self.iterations(&contacts);
        self.conditions(&boundaries, &patches, model.components());
        self.exact_data(&boundaries, &model, &patches);
        self.weight(&model, &materials, &patches);

        case = Case {
            source: CaseText::default(),
            warnings: Diagnostics::new(),
            schema,
            title,
            units,
            deformed,
            fields: Vec::new(),
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
            lines,
            checks,
            studies,
            effective: String::new(),
        };
        self.pressed_obstacles(&case);
        case.fields = self.shown_fields(&shown, &case);
        case.effective = self.effective(root);
        case
    }

    /// Checks that names are unique within their kind, interfaces and contacts together (E016).
    fn names_once(&mut self, read: &[Read], (ties, contacts): (&[Tie], &[Contact]), asked: (&[Probe], &[Line], &[Check])) {
        let (probes, lines, checks) = asked;
        self.unique("boundary", &read.iter().map(|b| b.boundary.name.clone()).collect::<Vec<_>>());
        let couples = ties.iter().map(|t| t.name.clone()).chain(contacts.iter().map(|c| c.name.clone()));
        self.unique("interface or contact", &couples.collect::<Vec<_>>());
        self.unique("probe", &probes.iter().map(|p| p.name.clone()).collect::<Vec<_>>());
        self.unique("line", &lines.iter().map(|l| l.name.clone()).collect::<Vec<_>>());
        self.unique("check", &checks.iter().map(|c| c.name.clone()).collect::<Vec<_>>());
    }

    /// The text of the case with every default written out.
    fn effective(&self, root: Block) -> String {
        format!(
            "# {} with every default written out by faying {}\n{}",
            crate::errors::one_line(&self.source.name),
            env!("CARGO_PKG_VERSION"),
            root.finish().to_document()
        )
    }

    /// `units`: names, which are short.
    fn units(&mut self, b: &mut Block) -> Units {
        let [length, force] = ["length", "force"].map(|key| {
            let node = b.node(key).cloned()?;
            let name = self.text_of(&node, key)?;
            let short = (1..=LONGEST_UNIT).contains(&name.chars().count()) && !name.chars().any(char::is_control);
            if !short {
                self.fault(
                    "E015",
                    node.at,
                    format!("`{key}` must be a unit of 1 to {LONGEST_UNIT} letters"),
                    "write length = \"mm\", force = \"N\"",
                );
            }
            Some(name.value)
        });
        Units { length: length.unwrap_or_default(), force: force.unwrap_or_default() }
    }

    /// `[output]`.
    fn output(&mut self, b: &mut Block) -> (Deformed, Vec<Located<String>>) {
        let node = self.value_of(b, "deformed");
        let deformed = match &node.value {
            Value::Bool(false) => Deformed::Factor(0.0),
            Value::Text(word) if word == "auto" => Deformed::Auto,
            Value::Integer(_) | Value::Float(_) => match self.number_of(&node, "deformed", Sign::Any).filter(|v| *v >= 0.0) {
                Some(factor) => Deformed::Factor(factor),
                None => {
                    self.fault("E015", node.at, "`deformed` must not be negative", "write deformed = 20, \"auto\", or false");
                    Deformed::Auto
                }
            },
            _ => {
                self.wrong_type(&node, "deformed", "\"auto\", a number, or false", "write deformed = 20");
                Deformed::Auto
            }
        };
        (deformed, self.words_of_fields(b))
    }

    // title: none by default
    fn title(&mut self, root: &mut Block) -> Located<String> {
        let node = self.value_of(root, "title");
        self.text_of(&node, "title").unwrap_or_default()
    }

    fn schema(&mut self, root: &mut Block) -> Located<usize> {
        let node = self.value_of(root, "schema");
        if let Value::Integer(n) = node.value
            && n > SCHEMA as i64
        {
            let message = format!("the case has schema {n}, this program reads schema {SCHEMA}");
            self.fault("E001", node.at, message, "install a newer faying, or write the case for schema 1");
            return Located::new(usize::MAX, node.at);
        }
        Located::new(self.whole_of(&node, "schema", 1, SCHEMA as i64).unwrap_or(SCHEMA), node.at)
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
            Located::new(value, SourceSpan::NONE)
        }
        Self {
            source: CaseText::default(),
            warnings: Diagnostics::new(),
            schema,
            title: Located::default(),
            units: Units::default(),
            deformed: Deformed::default(),
            fields: Vec::new(),
            constants: Constants::default(),
            model: Model {
                head: none(()),
                physics: none(Physics::Elasticity),
                dimension: none(2),
                assumption: none(Assumption::PlaneStrain),
                exact: None,
                source: None,
                gravity: None,
                foundation: Vec::new(),
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
            lines: Vec::new(),
            checks: Vec::new(),
            studies: Vec::new(),
            effective: String::new(),
        }
    }
}
