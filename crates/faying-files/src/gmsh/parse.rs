//! Sections of an MSH file.

use super::collect::{Bucket, Entities, Keys, finish};
use super::kinds::ElementType;
use super::nodes::Lookup;
use super::scan::{Ascii, Binary, Source, line_of};
use crate::budget::Budget;
use crate::{FileError, Format, Limits, MeshFile, Spot};
use std::collections::BTreeMap;

/// Version of the format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Version {
    V2,
    V4,
}

/// Version and encoding of numbers of the file.
#[derive(Clone, Copy, Debug)]
struct Header {
    version: Version,
    binary: bool,
    big_endian: bool,
}

/// Reads an MSH file.
///
/// # Errors
/// As [`super::parse`].
pub(super) fn parse(bytes: &[u8], limits: &Limits) -> Result<MeshFile, FileError> {
    let mut reader = Reader {
        bytes,
        at: 0,
        budget: Budget::new(limits, bytes.len()),
        header: None,
        names: BTreeMap::new(),
        entities: Entities::default(),
        points: Vec::new(),
        ids: Vec::new(),
        lookup: None,
        buckets: Vec::new(),
        elements: false,
        notes: Vec::new(),
    };
    reader.sections()?;
    reader.finish()
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    budget: Budget,
    header: Option<Header>,
    names: BTreeMap<(usize, i64), String>,
    entities: Entities,
    points: Vec<[f64; 3]>,
    ids: Vec<u64>,
    lookup: Option<Lookup>,
    buckets: Vec<Bucket>,
    elements: bool,
    notes: Vec<String>,
}

impl<'a> Reader<'a> {
    fn line(&self) -> Spot {
        line_of(self.bytes, self.at)
    }

    fn broken(&self, what: impl Into<String>) -> FileError {
        FileError::Broken { what: what.into(), spot: Some(self.line()) }
    }

    fn unsupported(&self, what: impl Into<String>) -> FileError {
        FileError::Unsupported { what: what.into(), spot: Some(self.line()) }
    }

    /// The reader at `start`, for errors about what begins there.
    fn back_at(&mut self, start: usize) -> &Self {
        self.at = start;
        self
    }

    fn skip_white(&mut self) {
        while self.bytes.get(self.at).is_some_and(|b| *b <= b' ' && *b != 0) {
            self.at += 1;
        }
    }

    /// Reads the rest of the line, without the line end.
    fn take_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        rest[..end].trim_ascii()
    }

    fn sections(&mut self) -> Result<(), FileError> {
        loop {
            self.skip_white();
            if self.at == self.bytes.len() {
                return Ok(());
            }
            let start = self.at;
            let name = self.take_line();
            match name {
                b"$MeshFormat" => self.format()?,
                b"$NOD" | b"$ELM" => return Err(self.back_at(start).unsupported("MSH version 1 (2.2 and 4.1 are read)")),
                b"$PhysicalNames" => self.physical_names()?,
                b"$Entities" | b"$Nodes" | b"$Elements" => {
                    let Some(header) = self.header else {
                        return Err(self.back_at(start).broken("a section of data stands before $MeshFormat"));
                    };
                    if header.binary {
                        let mut source = Binary::new(self.bytes, self.at, header.big_endian);
                        self.data(name, start, header, &mut source)?;
                    } else {
                        let mut source = Ascii::new(self.bytes, self.at);
                        self.data(name, start, header, &mut source)?;
                    }
                    self.end(&name[1..])?;
                }
                b"$ParametricNodes" => {
                    return Err(self.back_at(start).unsupported("$ParametricNodes (save without parametric coordinates)"));
                }
                [b'$', rest @ ..]
                    if !rest.is_empty() && rest.len() <= 64 && rest.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_') =>
                {
                    self.skip_section(rest, start)?;
                }
                _ => {
                    let text = String::from_utf8_lossy(&name[..name.len().min(24)]).into_owned();
                    return Err(self.back_at(start).broken(format!("expected the $Name of a section, found `{text}`")));
                }
            }
        }
    }

    /// The closing line of a section.
    fn end(&mut self, name: &[u8]) -> Result<(), FileError> {
        self.skip_white();
        let start = self.at;
        let line = self.take_line();
        if line.strip_prefix(b"$End") == Some(name) {
            return Ok(());
        }
        let (name, text) = (String::from_utf8_lossy(name), String::from_utf8_lossy(&line[..line.len().min(24)]));
        if line.is_empty() {
            return Err(self.back_at(start).broken(format!("the file ends inside ${name}")));
        }
        Err(self.back_at(start).broken(format!("expected $End{name}, found `{text}`")))
    }

    fn skip_section(&mut self, name: &[u8], start: usize) -> Result<(), FileError> {
        let end = [b"$End", name].concat();
        let text = String::from_utf8_lossy(name).into_owned();
        let mut at = self.at;
        while let Some(dollar) = self.bytes[at..].iter().position(|b| *b == b'$') {
            at += dollar;
            if self.bytes[at..].starts_with(&end) {
                self.at = at + end.len();
                // a file may have thousands of sections of results
                let note = format!("section ${text} is not read");
                if text != "Comments" && self.notes.len() < 64 && !self.notes.contains(&note) {
                    self.notes.push(note);
                }
                return Ok(());
            }
            at += 1;
        }
        self.at = start;
        Err(self.broken(format!("section ${text} has no end")))
    }

    fn format(&mut self) -> Result<(), FileError> {
        let start = self.at;
        let line = String::from_utf8_lossy(self.take_line()).into_owned();
        let words: Vec<&str> = line.split_ascii_whitespace().take(4).collect();
        let after = std::mem::replace(&mut self.at, start);
        let [version, kind, size] = words[..] else {
            return Err(self.broken("expected version, file type and data size in $MeshFormat"));
        };
        let version = match version {
            "2.2" => Version::V2,
            "4.1" => Version::V4,
            other => {
                let shown: String = other.chars().take(12).collect();
                return Err(self.unsupported(format!("MSH version {shown} (2.2 and 4.1 are read; save with -format msh41)")));
            }
        };
        let binary = match kind {
            "0" => false,
            "1" => true,
            _ => return Err(self.broken("the file type in $MeshFormat is neither 0 (text) nor 1 (binary)")),
        };
        if size != "8" {
            return Err(self.unsupported(format!("data size {}", size.chars().take(12).collect::<String>())));
        }
        if self.header.is_some() {
            return Err(self.broken("a second $MeshFormat"));
        }
        self.at = after;
        let mut big_endian = false;
        if binary {
            let Some(one) = self.bytes[self.at..].first_chunk::<4>() else {
                return Err(self.broken("the file ends inside $MeshFormat"));
            };
            big_endian = match one {
                [1, 0, 0, 0] => false,
                [0, 0, 0, 1] => true,
                _ => {
                    let what = "the binary one in $MeshFormat is no one in either order of bytes".into();
                    return Err(FileError::Broken { what, spot: Some(Spot::Byte(self.at)) });
                }
            };
            self.at += 4;
        }
        self.header = Some(Header { version, binary, big_endian });
        self.end(b"MeshFormat")
    }

    fn physical_names(&mut self) -> Result<(), FileError> {
        let mut source = Ascii::new(self.bytes, self.at);
        let count = source.size()?;
        for _ in 0..count {
            let (dimension, number) = (source.size()?, source.int()?);
            self.at = source.at();
            if dimension > 3 {
                return Err(self.broken(format!("a group has the dimension {dimension}")));
            }
            let line = self.take_line();
            let spot = line_of(self.bytes, self.at.saturating_sub(1));
            let broken = |what: String| FileError::Broken { what, spot: Some(spot) };
            let [b'"', name @ .., b'"'] = line else {
                return Err(broken("expected the name of the group between quotes".into()));
            };
            // map, list of groups and text
            self.budget.take(192 + 4 * name.len() as u64)?;
            let name = String::from_utf8_lossy(name).into_owned();
            if let Some(old) = self.names.insert((dimension as usize, number), name.clone())
                && old != name
            {
                return Err(broken(format!("group {number} of dimension {dimension} has two names")));
            }
            source = Ascii::new(self.bytes, self.at);
        }
        self.at = source.at();
        self.end(b"PhysicalNames")
    }

    fn data<S: Source>(&mut self, name: &[u8], start: usize, header: Header, source: &mut S) -> Result<(), FileError> {
        let done = match name {
            b"$Entities" if header.version == Version::V4 => self.entities(source),
            b"$Entities" => Err(self.broken("$Entities in a file of version 2.2")),
            b"$Nodes" => {
                if self.lookup.is_some() {
                    return Err(self.back_at(start).broken("a second $Nodes"));
                }
                match header.version {
                    Version::V2 => self.nodes_v2(header, source),
                    Version::V4 => self.nodes_v4(source),
                }?;
                match Lookup::new(&self.ids, &mut self.budget)? {
                    Ok(lookup) => self.lookup = Some(lookup),
                    Err(id) => {
                        self.at = start;
                        return Err(self.broken(format!("node {id} stands twice in $Nodes")));
                    }
                }
                Ok(())
            }
            _ => {
                self.at = if self.elements || self.lookup.is_none() { start } else { self.at };
                if self.elements {
                    return Err(self.broken("a second $Elements"));
                }
                let Some(lookup) = self.lookup.take() else { return Err(self.broken("$Elements stands before $Nodes")) };
                self.elements = true;
                let done = match header.version {
                    Version::V2 => self.elements_v2(header, &lookup, source),
                    Version::V4 => self.elements_v4(&lookup, source),
                };
                self.lookup = Some(lookup);
                done
            }
        };
        done?;
        self.at = source.at();
        Ok(())
    }

    /// The count at the head of a section of version 2.2, text in binary files too.
    fn count_v2<S: Source>(&mut self, header: Header, source: &mut S) -> Result<u64, FileError> {
        if !header.binary {
            return source.size();
        }
        let mut text = Ascii::new(self.bytes, self.at);
        let count = text.size()?;
        self.at = text.at();
        if !self.take_line().is_empty() {
            return Err(self.broken("expected the end of the line after a count"));
        }
        source.go_to(self.at);
        Ok(count)
    }

    fn entities<S: Source>(&mut self, source: &mut S) -> Result<(), FileError> {
        if !self.entities.list.is_empty() || self.elements {
            return Err(self.broken("a second $Entities, or one after $Elements"));
        }
        self.entities.read(source, &mut self.budget)
    }

    #[inline]
    fn point<S: Source>(&mut self, source: &mut S) -> Result<(), FileError> {
        let x = [source.real()?, source.real()?, source.real()?];
        if !x.iter().all(|x| x.is_finite()) {
            return Err(source.broken(format!("a node at {x:?}")));
        }
        self.budget.room(&mut self.points, 1)?;
        self.points.push(x);
        Ok(())
    }

    fn id<S: Source>(&mut self, source: &mut S, wide: bool) -> Result<(), FileError> {
        let id = source.tag(wide)?;
        if self.ids.len() >= u32::MAX as usize - 1 {
            return Err(source.broken("more nodes than 32 bits can number"));
        }
        self.budget.room(&mut self.ids, 1)?;
        self.ids.push(id);
        Ok(())
    }

    fn nodes_v2<S: Source>(&mut self, header: Header, source: &mut S) -> Result<(), FileError> {
        for _ in 0..self.count_v2(header, source)? {
            self.id(source, false)?;
            self.point(source)?;
            source.end_record()?;
        }
        Ok(())
    }

    fn nodes_v4<S: Source>(&mut self, source: &mut S) -> Result<(), FileError> {
        let (blocks, total) = (source.size()?, source.size()?);
        source.size()?;
        source.size()?;
        for _ in 0..blocks {
            let dimension = source.int()?;
            source.int()?;
            let parametric = source.int()?;
            let count = source.size()?;
            if !(0..=3).contains(&dimension) || !(0..=1).contains(&parametric) {
                return Err(source.broken("a block of nodes has a dimension or a parametric flag that is none"));
            }
            let first = self.points.len();
            for _ in 0..count {
                self.id(source, true)?;
            }
            for _ in first..self.ids.len() {
                self.point(source)?;
                for _ in 0..dimension * parametric {
                    source.real()?;
                }
                source.end_record()?;
            }
        }
        if self.ids.len() as u64 != total {
            return Err(source.broken(format!("$Nodes declares {total} nodes, its blocks hold {}", self.ids.len())));
        }
        Ok(())
    }

    /// The elements of a type.
    fn bucket<S: Source>(&mut self, number: i64, source: &S) -> Result<usize, FileError> {
        if let Some(k) = self.buckets.iter().position(|b| b.number == number) {
            return Ok(k);
        }
        match ElementType::of_number(number) {
            Ok(kind) => {
                self.budget.take((kind.place.len() * 8 + 256) as u64)?;
                self.buckets.push(Bucket::new(number, kind));
                Ok(self.buckets.len() - 1)
            }
            Err(what) => Err(FileError::Unsupported { what, spot: Some(source.spot()) }),
        }
    }

    fn elements_v2<S: Source>(&mut self, header: Header, lookup: &Lookup, source: &mut S) -> Result<(), FileError> {
        let mut left = self.count_v2(header, source)?;
        let mut partitions = false;
        while left > 0 {
            // binary files give type and number of tags once for several elements
            let (mut number, mut same, mut tags) = (0, 1, 0);
            if header.binary {
                (number, same, tags) = (source.int()?, source.int()?, source.int()?);
            }
            let same = u64::try_from(same).ok().filter(|n| (1..=left).contains(n));
            let Some(same) = same else { return Err(source.broken("a block of elements is longer than $Elements, or empty")) };
            left -= same;
            for _ in 0..same {
                let id = source.tag(false)?;
                if !header.binary {
                    (number, tags) = (source.int()?, source.int()?);
                }
                let mut group = 0;
                for t in 0..tags {
                    let tag = source.int()?;
                    group = if t == 0 { tag } else { group };
                }
                partitions |= tags > 2;
                let k = self.bucket(number, source)?;
                // a negative group number means reversed elements of that group
                self.buckets[k].start_run(group.saturating_abs(), &mut self.budget)?;
                element(&mut self.buckets[k], &mut self.budget, id, lookup, source, false)?;
                source.end_record()?;
            }
        }
        if partitions {
            self.notes.push("partitions of elements are not read".into());
        }
        Ok(())
    }

    fn elements_v4<S: Source>(&mut self, lookup: &Lookup, source: &mut S) -> Result<(), FileError> {
        let (blocks, total) = (source.size()?, source.size()?);
        source.size()?;
        source.size()?;
        let mut read = 0u64;
        for _ in 0..blocks {
            let (dimension, entity, number, count) = (source.int()?, source.int()?, source.int()?, source.size()?);
            if count == 0 {
                continue;
            }
            let k = self.bucket(number, source)?;
            if dimension != self.buckets[k].kind.shape.dimension() as i64 {
                return Err(source.broken(format!("elements of type {number} on an entity of dimension {dimension}")));
            }
            let bucket = &mut self.buckets[k];
            bucket.start_run(entity, &mut self.budget)?;
            for _ in 0..count {
                let id = source.tag(true)?;
                element(bucket, &mut self.budget, id, lookup, source, true)?;
                source.end_record()?;
            }
            read += count;
        }
        if read != total {
            return Err(source.broken(format!("$Elements declares {total} elements, its blocks hold {read}")));
        }
        Ok(())
    }

    fn finish(self) -> Result<MeshFile, FileError> {
        let Self { bytes, mut budget, header, names, entities, points, ids, buckets, mut notes, .. } = self;
        let end = |what: &str| FileError::Broken { what: what.into(), spot: Some(line_of(bytes, bytes.len())) };
        let Some(header) = header else { return Err(end("the file has no $MeshFormat")) };
        if self.lookup.is_none() {
            return Err(end("the file has no $Nodes"));
        }
        if !self.elements {
            return Err(end("the file has no $Elements"));
        }
        let keys = match header.version {
            Version::V2 => Keys::Group,
            Version::V4 => Keys::Entity(&entities),
        };
        let (blocks, groups, twice) = finish(buckets, names, keys, &mut budget)?;
        if twice > 0 {
            notes.push(format!("{twice} elements stand twice in the same group; one of each is kept"));
        }
        Ok(MeshFile { format: Format::Gmsh, points, ids, blocks, groups, notes })
    }
}

#[inline]
fn element<S: Source>(
    bucket: &mut Bucket,
    budget: &mut Budget,
    id: u64,
    lookup: &Lookup,
    source: &mut S,
    wide: bool,
) -> Result<(), FileError> {
    let n = bucket.kind.place.len();
    budget.room(&mut bucket.nodes, n)?;
    budget.room(&mut bucket.ids, 1)?;
    let first = bucket.nodes.len();
    bucket.nodes.resize(first + n, 0);
    let own = &mut bucket.nodes[first..];
    for place in &bucket.kind.place {
        let tag = source.tag(wide)?;
        match lookup.place(tag) {
            Some(node) => own[*place] = node,
            None => return Err(source.broken(format!("element {id} refers to node {tag}, which is not in $Nodes"))),
        }
    }
    bucket.ids.push(id);
    Ok(())
}
