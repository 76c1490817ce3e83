//! G+Smo XML: B-spline and NURBS geometries and their MultiPatch.
//!
//! Sides are numbered from 1 in the order u0, u1, v0, v1, w0, w1; an interface is `patch side patch side` with a map of the directions and
//! their orientations, which also follow from the geometry. Control points are not multiplied by their weights.
//! Source: G+Smo, `src/gsIO/gsXmlUtils.hpp` and the files in `filedata`.

use super::budget::Budget;
use super::sides::SIDES;
use super::text::{Words, broken, check_knots, check_weights, shown, unsupported};
use super::xml::{self, XmlElement};
use super::{FileError, Format, Label, Limits, PatchSide, SplineFile, SplinePatch};
use std::collections::BTreeMap;

pub use super::gismo_write::write;

/// Reads a file.
///
/// # Errors
/// [`FileError::Unsupported`] for geometries that are no tensor products, [`FileError::Broken`], [`FileError::Memory`].
pub fn parse(bytes: &[u8], limits: &Limits) -> Result<SplineFile, FileError> {
    let mut budget = Budget::new(limits, bytes.len());
    let root = xml::parse(bytes, &mut budget)?;
    match root.name.as_str() {
        "xml" => {}
        "VTKFile" => return Err(unsupported(root.line, "a VTK file as a geometry")),
        other => return Err(unsupported(root.line, format!("XML with the root <{}>; G+Smo files have <xml>", shown(other.as_bytes())))),
    }
    let mut all = Vec::new();
    for node in root.named("Geometry") {
        budget.items(2, size_of::<SplinePatch>())?;
        all.push((patch(node, &mut budget)?, node.line));
    }
    let mut file = SplineFile { format: Format::Gismo, patches: Vec::new(), joints: Vec::new(), labels: Vec::new(), notes: Vec::new() };
    let mut multi = root.named("MultiPatch");
    match multi.next() {
        Some(first) => multipatch(first, all, &mut file, &mut budget)?,
        None => file.patches = all.into_iter().map(|(patch, _)| patch).collect(),
    }
    if file.patches.is_empty() {
        return Err(nothing(&root));
    }
    for other in multi {
        file.notes.push(format!("only the first MultiPatch is read; another one stands in line {}", other.line));
    }
    let mut others: BTreeMap<&str, usize> = BTreeMap::new();
    for node in root.children.iter().filter(|n| n.name != "Geometry" && n.name != "MultiPatch") {
        *others.entry(&node.name).or_default() += 1;
    }
    for (name, count) in others {
        let (blocks, are) = if count == 1 { ("block", "is") } else { ("blocks", "are") };
        file.notes.push(format!("{count} {blocks} <{}> {are} not read", shown(name.as_bytes())));
    }
    Ok(file)
}

/// Error for a file without geometry.
fn nothing(root: &XmlElement<'_>) -> FileError {
    match root.named("Basis").next() {
        Some(basis) => match basis.attribute("type") {
            Some(kind) if hierarchical(kind) => unsupported(basis.line, format!("a THB-spline basis ({})", shown(kind.as_bytes()))),
            _ => broken(basis.line, "the file holds a basis and no geometry"),
        },
        None => broken(root.line, "the file holds no geometry"),
    }
}

fn hierarchical(kind: &str) -> bool {
    kind.starts_with("THB") || kind.starts_with("HB") || kind.starts_with("gsTHB") || kind.starts_with("gsHB")
}

/// A whole number in an attribute.
fn whole(node: &XmlElement<'_>, name: &str) -> Result<Option<i64>, FileError> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let value = text.trim().parse();
    value.map(Some).map_err(|_| broken(node.line, format!("{name} must be a whole number, found \"{}\"", shown(text.as_bytes()))))
}

fn natural(node: &XmlElement<'_>, name: &str) -> Result<Option<usize>, FileError> {
    let value = whole(node, name)?;
    value.map(|v| usize::try_from(v).map_err(|_| broken(node.line, format!("{name} must not be negative, found {v}")))).transpose()
}

/// Degree and knots of the univariate basis.
fn univariate(basis: &XmlElement<'_>, budget: &mut Budget) -> Result<(usize, Vec<f64>), FileError> {
    let vector = basis.only("KnotVector")?;
    if let Some(format) = vector.attribute("format").filter(|f| !f.eq_ignore_ascii_case("ASCII")) {
        return Err(unsupported(vector.line, format!("the format {} of numbers", shown(format.as_bytes()))));
    }
    let degree = natural(vector, "degree")?.ok_or_else(|| broken(vector.line, "<KnotVector> has no degree"))?;
    let (text, line) = vector.words()?;
    let mut words = Words::new(&text, line);
    budget.items(text.len() / 2 + 1, 3 * size_of::<f64>())?;
    let mut knots = Vec::new();
    while !words.done() {
        knots.push(words.number("a knot")?);
    }
    check_knots(degree, &knots, vector.line)?;
    Ok((degree, knots))
}

/// The univariate bases of a tensor product (or of a curve) in the order of their directions.
fn directions(basis: &XmlElement<'_>, budget: &mut Budget) -> Result<Vec<(usize, Vec<f64>)>, FileError> {
    let kind = basis.attribute("type").unwrap_or_default();
    if kind == "BSplineBasis" {
        return Ok(vec![univariate(basis, budget)?]);
    }
    let Some(dimension) = kind.strip_prefix("TensorBSplineBasis").and_then(|d| d.parse::<usize>().ok()).filter(|d| (1..=3).contains(d))
    else {
        let kind = shown(kind.as_bytes());
        return Err(unsupported(
            basis.line,
            if hierarchical(&kind) { format!("a THB-spline basis ({kind})") } else { format!("a basis of type \"{kind}\"") },
        ));
    };
    let mut found: [Option<(usize, Vec<f64>)>; 3] = [None, None, None];
    for (place, child) in basis.named("Basis").enumerate() {
        let index = natural(child, "index")?.unwrap_or(place);
        if index >= dimension || found[index].is_some() {
            return Err(broken(child.line, format!("direction {index} of a basis of {dimension} directions stands twice or is not there")));
        }
        found[index] = Some(univariate(child, budget)?);
    }
    let count = found.iter().flatten().count();
    if count < dimension {
        return Err(broken(basis.line, format!("{kind} has {count} univariate bases")));
    }
    Ok(found.into_iter().flatten().collect())
}

/// A geometry.
fn patch(node: &XmlElement<'_>, budget: &mut Budget) -> Result<SplinePatch, FileError> {
    let kind = node.attribute("type").unwrap_or_default();
    if hierarchical(kind) {
        return Err(unsupported(node.line, format!("a THB-spline ({})", shown(kind.as_bytes()))));
    }
    let (parameters, rational) = match kind {
        "BSpline" | "TensorBSpline1" => (1, false),
        "Nurbs" | "TensorNurbs1" => (1, true),
        "TensorBSpline2" => (2, false),
        "TensorBSpline3" => (3, false),
        "TensorNurbs2" => (2, true),
        "TensorNurbs3" => (3, true),
        other => return Err(unsupported(node.line, format!("a geometry of type \"{}\"", shown(other.as_bytes())))),
    };
    let basis = node.only("Basis")?;
    let polynomial = if rational { basis.only("Basis")? } else { basis };
    let axes = directions(polynomial, budget)?;
    if axes.len() != parameters {
        return Err(broken(polynomial.line, format!("{kind} has a basis of {} directions", axes.len())));
    }
    let count = axes.iter().fold(1usize, |n, (degree, knots)| n.saturating_mul(knots.len() - degree - 1));
    let coefficients = node.only("coefs")?;
    for numbers in [Some(coefficients), basis.named("weights").next()].into_iter().flatten() {
        if let Some(format) = numbers.attribute("format").filter(|f| !f.eq_ignore_ascii_case("ASCII")) {
            return Err(unsupported(numbers.line, format!("the format {} of numbers", shown(format.as_bytes()))));
        }
    }
    let world = natural(coefficients, "geoDim")?.ok_or_else(|| broken(coefficients.line, "<coefs> has no geoDim"))?;
    if !(1..=3).contains(&world) {
        return Err(broken(coefficients.line, format!("geoDim is {world}; there are 1 to 3 coordinates")));
    }
    if world < parameters {
        return Err(broken(coefficients.line, format!("geoDim is {world} for {parameters} parameters")));
    }
    let numbers = coefficients.numbers(count.saturating_mul(world), &format!("coordinates of {count} control points"), budget)?;
    budget.items(count, size_of::<[f64; 3]>())?;
    let point = |c: &[f64]| std::array::from_fn(|k| c.get(k).copied().unwrap_or(0.0));
    let weights = if rational {
        let node = basis.only("weights")?;
        let weights = node.numbers(count, &format!("weights of {count} control points"), budget)?;
        check_weights(&weights, node.line)?;
        Some(weights)
    } else {
        None
    };
    let (degree, knots) = axes.into_iter().unzip();
    Ok(SplinePatch {
        id: whole(node, "id")?,
        name: node.attribute("label").map(str::to_string),
        degree,
        knots,
        points: numbers.chunks_exact(world).map(point).collect(),
        weights,
        world,
        ..SplinePatch::default()
    })
}

/// Fills the file with the patches of a MultiPatch, its interfaces and its named boundaries.
fn multipatch(node: &XmlElement<'_>, all: Vec<(SplinePatch, usize)>, file: &mut SplineFile, budget: &mut Budget) -> Result<(), FileError> {
    let mut geometries: BTreeMap<i64, (SplinePatch, usize)> = BTreeMap::new();
    let mut without = 0;
    for (patch, line) in all {
        let Some(id) = patch.id else {
            without += 1;
            continue;
        };
        if let Some((_, first)) = geometries.get(&id) {
            return Err(broken(line, format!("geometry {id} stands already in line {first}")));
        }
        geometries.insert(id, (patch, line));
    }
    let list = node.only("patches")?;
    let (text, line) = list.words()?;
    let mut words = Words::new(&text, line);
    let mut place: BTreeMap<i64, usize> = BTreeMap::new();
    let mut take = |id: i64, line: usize, file: &mut SplineFile| match geometries.remove(&id) {
        Some((patch, _)) => {
            place.insert(id, file.patches.len());
            file.patches.push(patch);
            Ok(())
        }
        None if place.contains_key(&id) => Err(broken(line, format!("the MultiPatch names geometry {id} twice"))),
        None => Err(broken(line, format!("the MultiPatch names geometry {id}, which is not in the file"))),
    };
    match list.attribute("type").unwrap_or_default() {
        "id_range" => {
            let (first, last) = (words.int("the first patch")?, words.int("the last patch")?);
            for id in first..=last {
                take(id, line, file)?;
            }
        }
        "id_index" => {
            while !words.done() {
                let line = words.line();
                take(words.int("the id of a patch")?, line, file)?;
            }
        }
        other => return Err(unsupported(list.line, format!("<patches> of type \"{}\"", shown(other.as_bytes())))),
    }
    if !words.done() {
        return Err(broken(words.line(), "more than two numbers as a range of patches"));
    }
    let left: Vec<String> = geometries.keys().map(i64::to_string).collect();
    if !left.is_empty() {
        file.notes.push(format!("the MultiPatch is read; geometries outside of it are not: {}", left.join(", ")));
    }
    if without > 0 {
        file.notes.push(format!("{without} geometries without id are in no MultiPatch and not read"));
    }
    let dimension = file.patches.first().map_or(0, SplinePatch::dimension);
    if let Some(k) = file.patches.iter().position(|p| p.dimension() != dimension) {
        return Err(broken(
            node.line,
            format!("patch {k} of the MultiPatch has {} parameters, patch 0 has {dimension}", file.patches[k].dimension()),
        ));
    }
    for interfaces in node.named("interfaces") {
        let (text, line) = interfaces.words()?;
        let mut words = Words::new(&text, line);
        while !words.done() {
            budget.items(3, size_of::<[PatchSide; 2]>())?;
            let pair = [side(&mut words, dimension, &place)?, side(&mut words, dimension, &place)?];
            for _ in 0..2 * dimension {
                words.int("a direction or orientation of an interface")?;
            }
            file.joints.push(pair);
        }
    }
    named_boundaries(node, dimension, &place, file, budget)
}

/// Adds the named lists of boundary sides of a MultiPatch to the labels of the file.
fn named_boundaries(
    node: &XmlElement<'_>,
    dimension: usize,
    place: &BTreeMap<i64, usize>,
    file: &mut SplineFile,
    budget: &mut Budget,
) -> Result<(), FileError> {
    let mut named: BTreeMap<String, usize> = BTreeMap::new();
    for boundary in node.named("boundary") {
        let (text, line) = boundary.words()?;
        let mut words = Words::new(&text, line);
        let mut sides = Vec::new();
        while !words.done() {
            budget.items(3, size_of::<PatchSide>())?;
            sides.push(side(&mut words, dimension, place)?);
        }
        // Without a name the list only repeats which sides are outer ones.
        let Some(name) = boundary.attribute("name").or(boundary.attribute("label")) else { continue };
        let at = *named.entry(name.to_string()).or_insert(file.labels.len());
        match file.labels.get_mut(at) {
            Some(label) => label.sides.extend(sides),
            None => file.labels.push(Label { name: name.to_string(), sides }),
        }
    }
    Ok(())
}

/// A patch and one of its sides.
fn side(words: &mut Words<'_>, dimension: usize, place: &BTreeMap<i64, usize>) -> Result<PatchSide, FileError> {
    let line = words.line();
    let (id, number) = (words.int("a patch")?, words.int("a side")?);
    let patch = *place.get(&id).ok_or_else(|| broken(line, format!("there is no patch {id} in the MultiPatch")))?;
    let known = &SIDES[..2 * dimension];
    let name = usize::try_from(number).ok().and_then(|n| n.checked_sub(1)).and_then(|n| known.get(n));
    let name = name.ok_or_else(|| broken(line, format!("side {number} of patch {id}; sides are 1 to {}", known.len())))?;
    Ok(PatchSide { patch, side: (*name).to_string() })
}
