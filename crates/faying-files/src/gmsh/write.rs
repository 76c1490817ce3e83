//! Writer of MSH files of version 4.1.

use super::super::handed::right_handed;
use super::kinds::{number_of, places};
use crate::{FileError, MeshBlock, MeshFile};
use std::collections::BTreeMap;
use std::io::Write as _;

/// Output of numbers as text or as little-endian binary.
struct Sink {
    out: Vec<u8>,
    binary: bool,
}

impl Sink {
    fn text(&mut self, text: &str) {
        self.out.extend_from_slice(text.as_bytes());
    }

    fn put(&mut self, number: impl std::fmt::Display, bytes: &[u8]) {
        if self.binary {
            self.out.extend_from_slice(bytes);
        } else {
            write!(self.out, "{number} ").expect("a Vec takes every byte");
        }
    }

    fn int(&mut self, v: i32) {
        self.put(v, &v.to_le_bytes());
    }

    fn size(&mut self, v: u64) {
        self.put(v, &v.to_le_bytes());
    }

    fn real(&mut self, v: f64) {
        // the shortest text that reads back to the same bits
        self.put(format_args!("{v:?}"), &v.to_le_bytes());
    }

    /// The end of a line of text.
    fn end(&mut self) {
        if !self.binary {
            if self.out.last() == Some(&b' ') {
                self.out.pop();
            }
            self.out.push(b'\n');
        }
    }

    fn section(&mut self, name: &str, content: impl FnOnce(&mut Self)) {
        self.text(&format!("${name}\n"));
        content(self);
        if self.binary {
            self.out.push(b'\n');
        }
        self.text(&format!("$End{name}\n"));
    }
}

/// Numbers of entities by dimension and groups.
struct Entities<'a> {
    of: [BTreeMap<&'a [usize], i32>; 4],
}

impl<'a> Entities<'a> {
    fn new(mesh: &'a MeshFile) -> Self {
        let mut of: [BTreeMap<&[usize], i32>; 4] = Default::default();
        let mut add = |dimension: usize, groups| {
            let next = of[dimension].len() as i32 + 1;
            of[dimension].entry(groups).or_insert(next);
        };
        mesh.blocks.iter().for_each(|b| add(b.shape.dimension(), &b.groups[..]));
        if mesh.blocks.is_empty() {
            add(0, &[]);
        }
        Self { of }
    }

    fn number(&self, block: &MeshBlock) -> i32 {
        self.of[block.shape.dimension()][&block.groups[..]]
    }
}

/// The numbers if they are positive and unique, else 1, 2, ...
fn numbers(own: Vec<u64>, count: usize) -> Vec<u64> {
    let mut sorted = own.clone();
    sorted.sort_unstable();
    let good = own.len() == count && sorted.first().is_none_or(|f| *f > 0) && sorted.windows(2).all(|w| w[0] != w[1]);
    if good { own } else { (1..=count as u64).collect() }
}

/// See [`super::write`].
pub(super) fn write(mesh: &MeshFile, binary: bool) -> Result<Vec<u8>, FileError> {
    let mesh = &*right_handed(mesh);
    let mut types = Vec::new();
    for block in &mesh.blocks {
        let Some(number) = number_of(block.shape, block.order) else {
            let what = format!("a {:?} of order {} in an MSH file", block.shape, block.order).to_lowercase();
            return Err(FileError::Unsupported { what, spot: None });
        };
        types.push((number as i32, places(block.shape, block.order)));
    }
    let counts: Vec<usize> = mesh.blocks.iter().zip(&types).map(|(b, t)| b.nodes.len() / t.1.len()).collect();
    let points = numbers(mesh.ids.clone(), mesh.points.len());
    let cells = numbers(mesh.blocks.iter().flat_map(|b| b.ids.iter().copied()).collect(), counts.iter().sum());
    let entities = Entities::new(mesh);
    let mut sink = Sink { out: Vec::new(), binary };
    sink.section("MeshFormat", |s| {
        s.text(if binary { "4.1 1 8\n" } else { "4.1 0 8\n" });
        if binary {
            s.int(1);
        }
    });
    write_names(&mut sink, mesh);
    sink.section("Entities", |s| write_entities(s, mesh, &entities));
    sink.section("Nodes", |s| write_nodes(s, mesh, &points));
    sink.section("Elements", |s| {
        let extremes = [cells.iter().min(), cells.iter().max()].map(|v| v.copied().unwrap_or(0));
        [mesh.blocks.len() as u64, cells.len() as u64, extremes[0], extremes[1]].iter().for_each(|v| s.size(*v));
        s.end();
        let mut ids = cells.iter();
        for ((block, (number, places)), count) in mesh.blocks.iter().zip(&types).zip(&counts) {
            [block.shape.dimension() as i32, entities.number(block), *number].iter().for_each(|v| s.int(*v));
            s.size(*count as u64);
            s.end();
            for (nodes, id) in block.nodes.chunks_exact(places.len()).zip(&mut ids) {
                s.size(*id);
                places.iter().for_each(|p| s.size(points[nodes[*p] as usize]));
                s.end();
            }
        }
    });
    Ok(sink.out)
}

/// Names are text in binary files too.
fn write_names(sink: &mut Sink, mesh: &MeshFile) {
    let named: Vec<_> = mesh.groups.iter().filter_map(|g| g.name.as_ref().map(|n| (g, n))).collect();
    if named.is_empty() {
        return;
    }
    sink.text(&format!("$PhysicalNames\n{}\n", named.len()));
    for (group, name) in named {
        sink.text(&format!("{} {} \"{}\"\n", group.dimension, group.number, name.replace(['\n', '\r'], " ")));
    }
    sink.text("$EndPhysicalNames\n");
}

fn write_entities(s: &mut Sink, mesh: &MeshFile, entities: &Entities<'_>) {
    entities.of.iter().for_each(|of| s.size(of.len() as u64));
    s.end();
    let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
    for (k, x) in mesh.points.iter().enumerate() {
        for i in 0..3 {
            low[i] = if k == 0 { x[i] } else { x[i].min(low[i]) };
            high[i] = if k == 0 { x[i] } else { x[i].max(high[i]) };
        }
    }
    for (dimension, of) in entities.of.iter().enumerate() {
        let mut sorted: Vec<_> = of.iter().map(|(groups, number)| (*number, *groups)).collect();
        sorted.sort_unstable();
        for (number, groups) in sorted {
            s.int(number);
            if dimension == 0 {
                let own = mesh.blocks.iter().find(|b| b.shape.dimension() == 0 && b.groups == groups).and_then(|b| b.nodes.first());
                own.map_or([0.0; 3], |n| mesh.points[*n as usize]).iter().for_each(|v| s.real(*v));
            } else {
                low.iter().chain(&high).for_each(|v| s.real(*v));
            }
            s.size(groups.len() as u64);
            groups.iter().for_each(|g| s.int(i32::try_from(mesh.groups[*g].number).unwrap_or(i32::MAX)));
            if dimension > 0 {
                s.size(0);
            }
            s.end();
        }
    }
}

fn write_nodes(s: &mut Sink, mesh: &MeshFile, ids: &[u64]) {
    let extremes = [ids.iter().min(), ids.iter().max()].map(|v| v.copied().unwrap_or(0));
    let blocks = u64::from(!ids.is_empty());
    [blocks, ids.len() as u64, extremes[0], extremes[1]].iter().for_each(|v| s.size(*v));
    s.end();
    if ids.is_empty() {
        return;
    }
    [mesh.dimension() as i32, 1, 0].iter().for_each(|v| s.int(*v));
    s.size(ids.len() as u64);
    s.end();
    for id in ids {
        s.size(*id);
        s.end();
    }
    for x in &mesh.points {
        x.iter().for_each(|v| s.real(*v));
        s.end();
    }
}
