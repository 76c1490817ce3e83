//! Lines of an input file: keywords with their parameters, and data.

use super::Include;
use super::kinds::ElementKind;
use super::sets::{At, Range, Sets};
use crate::budget::Budget;
use crate::text::{broken, shown, unsupported};
use crate::{FileError, Limits};
use std::collections::BTreeSet;

/// Most files inside each other.
const DEPTH: usize = 8;

/// Most keywords that a note lists.
const LISTED: usize = 16;

/// Keywords that make nodes or elements of others.
const GENERATORS: [&str; 8] = ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBMODEL"];

/// Keywords that need no note although they are not read.
const SILENT: [&str; 7] = ["HEADING", "PART", "END PART", "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE"];

/// An element as it stands in the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element {
    pub id: u64,
    pub kind: ElementKind,
    /// The first of its nodes in [`Found::nodes`].
    pub first: usize,
    pub at: At,
}

/// Faces of a surface: of a set of elements, or of one element.
#[derive(Clone, Debug)]
pub(super) struct Faces {
    pub set: Option<usize>,
    pub element: u64,
    pub face: usize,
    pub at: At,
}

/// Contents of the files.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub points: Vec<[f64; 3]>,
    /// Number and place of every point.
    pub ids: Vec<u64>,
    pub point_at: Vec<At>,
    pub elements: Vec<Element>,
    /// Numbers of the nodes of all elements.
    pub nodes: Vec<u64>,
    pub node_sets: Sets,
    pub element_sets: Sets,
    /// Names of surfaces with their faces.
    pub surfaces: Vec<(String, Vec<Faces>)>,
    /// Names of the included files, from 1.
    pub included: Vec<String>,
    pub notes: Vec<String>,
}

/// Meaning of the data lines that follow.
#[derive(Clone, Debug)]
enum Block {
    Skip,
    Nodes { set: Option<usize> },
    Elements { kind: ElementKind, set: Option<usize> },
    Set { of_nodes: bool, set: usize, generate: bool },
    NodeSurface { set: usize },
    Surface { place: usize },
    Instance,
}

pub(super) struct Reader<'a, 'b> {
    found: Found,
    pub(super) budget: Budget,
    include: &'a mut Include<'b>,
    block: Block,
    /// Numbers of an element that goes on in the next line.
    pending: Vec<u64>,
    at: At,
    depth: usize,
    parts: [usize; 2],
    /// Name of the instance of the part.
    instance: String,
    assembly: bool,
    skipped: BTreeSet<String>,
}

/// An error with the name of the file, if that is an included one.
pub(super) fn in_file(error: FileError, at: At, included: &[String]) -> FileError {
    let Some(name) = at.file.checked_sub(1).and_then(|k| included.get(k as usize)) else { return error };
    let add = |what: String| format!("\"{name}\": {what}");
    match error {
        FileError::Broken { what, spot } => FileError::Broken { what: add(what), spot },
        FileError::Unsupported { what, spot } => FileError::Unsupported { what: add(what), spot },
        other => other,
    }
}

/// A keyword and its parameters, in upper case but for their values.
struct Keyword {
    name: String,
    parameters: Vec<(String, String)>,
}

impl Keyword {
    fn new(line: &str) -> Self {
        let mut words = line.trim_start_matches('*').split(',').map(str::trim);
        let upper = |word: &str| word.split_ascii_whitespace().collect::<Vec<_>>().join(" ").to_ascii_uppercase();
        let name = upper(words.next().unwrap_or_default());
        let parameters = words
            .filter(|w| !w.is_empty())
            .map(|w| {
                let (key, value) = w.split_once('=').unwrap_or((w, ""));
                (upper(key), value.trim().trim_matches('"').to_owned())
            })
            .collect();
        Self { name, parameters }
    }

    fn value(&self, key: &str) -> Option<&str> {
        self.parameters.iter().find(|p| p.0 == key).map(|p| p.1.as_str())
    }
}

impl<'a, 'b> Reader<'a, 'b> {
    pub fn new(bytes: usize, limits: &Limits, include: &'a mut Include<'b>) -> Self {
        Self {
            found: Found::default(),
            budget: Budget::new(limits, bytes),
            include,
            block: Block::Skip,
            pending: Vec::new(),
            at: At::default(),
            depth: 0,
            parts: [0, 0],
            instance: String::new(),
            assembly: false,
            skipped: BTreeSet::new(),
        }
    }

    fn broken(&self, what: impl Into<String>) -> FileError {
        in_file(broken(self.at.line as usize, what), self.at, &self.found.included)
    }

    fn unsupported(&self, what: impl Into<String>) -> FileError {
        in_file(unsupported(self.at.line as usize, what), self.at, &self.found.included)
    }

    /// Reads the lines of a file.
    pub fn file(&mut self, bytes: &[u8]) -> Result<(), FileError> {
        let file = self.found.included.len() as u32;
        let mut lines = bytes.split(|b| *b == b'\n').zip(1u32..);
        while let Some((line, number)) = lines.next() {
            self.at = At { file, line: number };
            let line = line.trim_ascii();
            if line.is_empty() || line.starts_with(b"**") {
                continue;
            }
            let Ok(text) = std::str::from_utf8(line) else {
                // names of other letters stand in comments and in what is not read
                if line[0] != b'*' && matches!(self.block, Block::Skip) {
                    continue;
                }
                return Err(self.broken(format!("the line is no UTF-8 text: \"{}\"", shown(line))));
            };
            if !text.starts_with('*') {
                self.data(text)?;
                continue;
            }
            self.ended()?;
            let mut whole = text.to_owned();
            while whole.ends_with(',') {
                let Some((more, _)) = lines.next() else { break };
                self.budget.take(more.len() as u64)?;
                whole.push_str(&String::from_utf8_lossy(more.trim_ascii()));
            }
            self.keyword(&Keyword::new(&whole))?;
            self.at = At { file, line: number };
        }
        self.at = At { file, line: bytes.split(|b| *b == b'\n').count() as u32 };
        self.ended()
    }

    /// Checks that no element goes on.
    fn ended(&mut self) -> Result<(), FileError> {
        if self.pending.is_empty() {
            return Ok(());
        }
        let Block::Elements { kind, .. } = self.block else { return Ok(()) };
        Err(self.broken(format!("element {} has {} of its {} nodes", self.pending[0], self.pending.len() - 1, kind.nodes)))
    }

    fn keyword(&mut self, word: &Keyword) -> Result<(), FileError> {
        self.block = Block::Skip;
        match word.name.as_str() {
            "NODE" => {
                if word.value("SYSTEM").is_some_and(|s| !s.eq_ignore_ascii_case("R")) {
                    return Err(self.unsupported("*NODE with SYSTEM (Cartesian coordinates are read)"));
                }
                if self.assembly {
                    return Err(self.unsupported("a node of an assembly (write reference points in no part, or leave them out)"));
                }
                let set = self.set_named(true, word.value("NSET"))?;
                self.block = Block::Nodes { set };
            }
            "ELEMENT" => {
                let Some(kind) = word.value("TYPE") else { return Err(self.broken("*ELEMENT without TYPE")) };
                let kind = ElementKind::of_name(&kind.to_ascii_uppercase()).map_err(|what| self.unsupported(what))?;
                let set = self.set_named(false, word.value("ELSET"))?;
                self.block = Block::Elements { kind, set };
            }
            key @ ("NSET" | "ELSET") => {
                let of_nodes = key == "NSET";
                let Some(set) = self.set_named(of_nodes, word.value(key))? else {
                    return Err(self.broken(format!("*{key} without the name of the set, {key}=")));
                };
                if let Some(elements) = word.value("ELSET").filter(|_| of_nodes) {
                    let of = self.found.element_sets.find(elements);
                    let of = of.ok_or_else(|| self.broken(format!("there is no set of elements \"{elements}\" before this line")))?;
                    self.budget.take(16)?;
                    self.found.node_sets.list[set].of_elements.push(of);
                }
                self.block = Block::Set { of_nodes, set, generate: word.value("GENERATE").is_some() };
            }
            "SURFACE" => self.surface(word)?,
            "INCLUDE" => {
                let Some(file) = word.value("INPUT") else { return Err(self.broken("*INCLUDE without INPUT")) };
                return self.included(file);
            }
            "PART" | "INSTANCE" => {
                let of = usize::from(word.name == "INSTANCE");
                self.parts[of] += 1;
                if self.parts[of] > 1 {
                    let what = ["parts", "instances of parts"][of];
                    return Err(self.unsupported(format!("a file of several {what} (write it without parts and assemblies)")));
                }
                if of == 1 {
                    word.value("NAME").unwrap_or_default().clone_into(&mut self.instance);
                    self.block = Block::Instance;
                }
            }
            "ASSEMBLY" => self.assembly = true,
            name if GENERATORS.contains(&name) => return Err(self.unsupported(format!("*{name} (nodes and elements are read as a list)"))),
            _ => {}
        }
        if matches!(self.block, Block::Skip) && !SILENT.contains(&word.name.as_str()) && self.skipped.len() <= LISTED {
            self.budget.take(128)?;
            self.skipped.insert(format!("*{}", shown(word.name.as_bytes())));
        }
        if let Some(file) = word.value("INPUT").filter(|_| !matches!(self.block, Block::Skip)) {
            self.included(file)?;
        }
        Ok(())
    }

    fn set_named(&mut self, of_nodes: bool, name: Option<&str>) -> Result<Option<usize>, FileError> {
        let Some(name) = name else { return Ok(None) };
        if name.is_empty() {
            return Err(self.broken("a set without a name"));
        }
        let sets = if of_nodes { &mut self.found.node_sets } else { &mut self.found.element_sets };
        sets.place(name, &mut self.budget).map(Some)
    }

    fn surface(&mut self, word: &Keyword) -> Result<(), FileError> {
        let Some(name) = word.value("NAME").filter(|n| !n.is_empty()) else { return Err(self.broken("*SURFACE without NAME")) };
        if word.value("COMBINE").is_some() {
            return Err(self.unsupported("*SURFACE with COMBINE (list its faces)"));
        }
        match word.value("TYPE").map(str::to_ascii_uppercase).as_deref() {
            None | Some("ELEMENT") => {
                self.budget.take(256 + 4 * name.len() as u64)?;
                self.found.surfaces.push((name.to_owned(), Vec::new()));
                self.block = Block::Surface { place: self.found.surfaces.len() - 1 };
            }
            Some("NODE") => {
                let set = self.found.node_sets.place(name, &mut self.budget)?;
                self.block = Block::NodeSurface { set };
            }
            Some(other) => return Err(self.unsupported(format!("*SURFACE of TYPE={}", shown(other.as_bytes())))),
        }
        Ok(())
    }

    /// Reads another file in the middle of this one.
    fn included(&mut self, file: &str) -> Result<(), FileError> {
        if self.depth == DEPTH {
            return Err(self.unsupported(format!("more than {DEPTH} files that include each other")));
        }
        let bytes = match (self.include)(file) {
            Ok(bytes) => bytes,
            Err(FileError::System { message, .. }) => {
                return Err(self.broken(format!("cannot read the included file \"{file}\": {message}")));
            }
            Err(other) => return Err(other),
        };
        self.budget.take(bytes.len() as u64)?;
        let before = self.at;
        self.found.included.push(file.to_owned());
        self.depth += 1;
        self.file(&bytes)?;
        self.depth -= 1;
        self.at = before;
        self.block = Block::Skip;
        self.budget.give(bytes.len() as u64);
        Ok(())
    }

    fn data(&mut self, line: &str) -> Result<(), FileError> {
        match self.block.clone() {
            Block::Skip => Ok(()),
            Block::Instance => Err(self.unsupported("an instance that is moved (move the part itself)")),
            Block::Nodes { set } => self.node(line, set),
            Block::Elements { kind, set } => self.element(line, kind, set),
            Block::Set { of_nodes, set, generate } => self.members(line, of_nodes, set, generate),
            // a weight may follow
            Block::NodeSurface { set } => self.members(line.split(',').next().unwrap_or_default(), true, set, false),
            Block::Surface { place } => self.faces(line, place),
        }
    }

    fn number(&self, word: &str, what: &str) -> Result<u64, FileError> {
        let number = word.parse::<u64>().ok().filter(|n| *n > 0);
        number.ok_or_else(|| self.broken(format!("{what} must be a whole number from 1, found \"{}\"", shown(word.as_bytes()))))
    }

    fn node(&mut self, line: &str, set: Option<usize>) -> Result<(), FileError> {
        let mut words = line.split(',').map(str::trim);
        let id = self.number(words.next().unwrap_or_default(), "the number of a node")?;
        let mut x = [0.0; 3];
        for (x, word) in x.iter_mut().zip(words.by_ref()).filter(|(_, word)| !word.is_empty()) {
            // Fortran writes exponents with D
            let value = word.replace(['d', 'D'], "e").parse::<f64>().ok().filter(|v| v.is_finite());
            *x = value.ok_or_else(|| self.broken(format!("a coordinate must be a finite number, found \"{}\"", shown(word.as_bytes()))))?;
        }
        if self.found.ids.len() >= u32::MAX as usize / 2 {
            return Err(self.unsupported("a mesh of more than 2^31 nodes"));
        }
        self.budget.room(&mut self.found.points, 1)?;
        self.budget.room(&mut self.found.ids, 1)?;
        self.budget.room(&mut self.found.point_at, 1)?;
        self.found.points.push(x);
        self.found.ids.push(id);
        self.found.point_at.push(self.at);
        match set {
            Some(set) => self.found.node_sets.add(set, Range { first: id, last: id, step: 1, at: self.at }, &mut self.budget),
            None => Ok(()),
        }
    }

    fn element(&mut self, line: &str, kind: ElementKind, set: Option<usize>) -> Result<(), FileError> {
        for word in line.split(',').map(str::trim).filter(|w| !w.is_empty()) {
            let number = self.number(word, "the number of an element or of a node")?;
            if self.pending.len() > kind.nodes {
                return Err(self.broken(format!("element {} has more than {} nodes", self.pending[0], kind.nodes)));
            }
            self.pending.push(number);
        }
        if self.pending.len() <= kind.nodes {
            return Ok(());
        }
        let (id, first) = (self.pending[0], self.found.nodes.len());
        self.budget.room(&mut self.found.nodes, kind.nodes)?;
        self.budget.room(&mut self.found.elements, 1)?;
        self.found.nodes.extend_from_slice(&self.pending[1..]);
        self.found.elements.push(Element { id, kind, first, at: self.at });
        self.pending.clear();
        match set {
            Some(set) => self.found.element_sets.add(set, Range { first: id, last: id, step: 1, at: self.at }, &mut self.budget),
            None => Ok(()),
        }
    }

    /// A member of a set or a surface without the name of its instance, `Block-1.12`.
    fn member<'w>(&self, word: &'w str) -> &'w str {
        let n = self.instance.len();
        match word.split_at_checked(n) {
            Some((instance, own)) if n > 0 && instance.eq_ignore_ascii_case(&self.instance) => own.strip_prefix('.').unwrap_or(word),
            _ => word,
        }
    }

    fn members(&mut self, line: &str, of_nodes: bool, set: usize, generate: bool) -> Result<(), FileError> {
        let words: Vec<&str> = line.split(',').map(str::trim).filter(|w| !w.is_empty()).collect();
        let at = self.at;
        if generate {
            let numbers: Vec<u64> = words.iter().map(|w| self.number(w, "a number of GENERATE")).collect::<Result<_, _>>()?;
            let (first, last, step) = match numbers[..] {
                [first, last] => (first, last, 1),
                [first, last, step] => (first, last, step),
                _ => return Err(self.broken("GENERATE takes the first number, the last, and the step")),
            };
            if last < first {
                return Err(self.broken(format!("GENERATE from {first} to {last} is empty")));
            }
            let sets = if of_nodes { &mut self.found.node_sets } else { &mut self.found.element_sets };
            return sets.add(set, Range { first, last, step, at }, &mut self.budget);
        }
        for word in words {
            let word = self.member(word);
            let sets = if of_nodes { &mut self.found.node_sets } else { &mut self.found.element_sets };
            if word.bytes().all(|b| b.is_ascii_digit()) {
                let id = self.number(word, "a member of a set")?;
                let sets = if of_nodes { &mut self.found.node_sets } else { &mut self.found.element_sets };
                sets.add(set, Range { first: id, last: id, step: 1, at }, &mut self.budget)?;
                continue;
            }
            match sets.find(word.trim_matches('"')) {
                Some(other) => sets.add_set(set, other, &mut self.budget)?,
                None => {
                    let what = ["elements", "nodes"][usize::from(of_nodes)];
                    return Err(self.broken(format!("there is no set of {what} \"{}\" before this line", shown(word.as_bytes()))));
                }
            }
        }
        Ok(())
    }

    fn faces(&mut self, line: &str, place: usize) -> Result<(), FileError> {
        let words: Vec<&str> = line.split(',').map(str::trim).filter(|w| !w.is_empty()).collect();
        let [of, label] = words[..] else {
            return Err(self.broken("a line of a surface has an element or a set of elements, and a face: S1, S2, ..."));
        };
        let of = self.member(of);
        let face = label.strip_prefix(['S', 's']).and_then(|n| n.parse::<usize>().ok()).filter(|n| (1..=6).contains(n));
        let face = face.ok_or_else(|| self.unsupported(format!("face {} of a surface (S1 to S6 are read)", shown(label.as_bytes()))))?;
        let (set, element) = if of.bytes().all(|b| b.is_ascii_digit()) {
            (None, self.number(of, "an element")?)
        } else {
            let set = self.found.element_sets.find(of.trim_matches('"'));
            let unknown = || self.broken(format!("there is no set of elements \"{}\" before this line", shown(of.as_bytes())));
            (Some(set.ok_or_else(unknown)?), 0)
        };
        let list = &mut self.found.surfaces[place].1;
        self.budget.room(list, 1)?;
        list.push(Faces { set, element, face, at: self.at });
        Ok(())
    }

    /// Results; the budget goes on.
    pub fn finish(mut self) -> Result<(Found, Budget), FileError> {
        if self.found.elements.is_empty() {
            return Err(self.broken("the file has no *ELEMENT"));
        }
        if !self.skipped.is_empty() {
            let all: Vec<&str> = self.skipped.iter().take(LISTED).map(String::as_str).collect();
            let more = if self.skipped.len() > LISTED { " and others" } else { "" };
            self.found.notes.push(format!("not read: {}{more}", all.join(", ")));
        }
        Ok((self.found, self.budget))
    }
}
