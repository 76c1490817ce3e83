//! MFEM NURBS meshes.
//!
//! A patch is an element of a coarse mesh; every edge of that mesh has a knot vector, which opposite edges share. Control points are
//! stored either with every patch (`patches`) or once for the whole mesh, numbered as described in `cells`.

use super::super::budget::Budget;
use super::super::text::{Words, broken, check_knots, check_weights, shown, unsupported};
use super::super::{CellShape, FileError, Format, KnotUse, SplineFile, SplinePatch};
use super::cells::{self, Cell, Skeleton, Starts, tensor_unknown};
use super::patch_sides::{joints_of, labels_of, sides_of};
use super::{Field, dimension, end};
use std::collections::{BTreeMap, HashMap};

/// An edge of the file: its knot vector and its two vertices, along the knots.
pub(super) struct Edge {
    vector: usize,
    from: u32,
    to: u32,
    line: usize,
}

/// Degree and knots.
type Knots = (usize, Vec<f64>);

/// Reads the file after its first line; `spacing`: the version has formulas for later refinement.
///
/// # Errors
/// [`FileError`] with the line.
pub(super) fn parse(mut words: Words<'_>, spacing: bool, budget: &mut Budget) -> Result<SplineFile, FileError> {
    let words = &mut words;
    let dimension = dimension(words)?;
    words.expect("elements")?;
    let patches = cells::read(words, "elements", budget)?;
    words.expect("boundary")?;
    let boundary = cells::read(words, "boundary elements", budget)?;
    words.expect("edges")?;
    let edges = read_edges(words, budget)?;
    words.expect("vertices")?;
    let line = words.line();
    let num_vertices = words.index("the number of vertices")?;
    if num_vertices > patches.len() << dimension {
        return Err(broken(line, format!("{num_vertices} vertices are more than {} patches have", patches.len())));
    }
    if patches.is_empty() {
        return Err(broken(line, "the mesh has no patch"));
    }
    cells::check_vertices(&patches, num_vertices)?;
    cells::check_vertices(&boundary, num_vertices)?;
    let shape = [CellShape::Line, CellShape::Quadrilateral, CellShape::Hexahedron][dimension - 1];
    if let Some(cell) = patches.iter().find(|c| c.shape != shape) {
        return Err(broken(cell.line, format!("a patch of dimension {dimension} is a {shape:?}, found a {:?}", cell.shape)));
    }
    let mut notes = Vec::new();
    let mut listed = HashMap::new();
    for (k, edge) in edges.iter().enumerate() {
        if listed.insert([edge.from.min(edge.to), edge.from.max(edge.to)], k).is_some() {
            return Err(broken(edge.line, format!("the edge from {} to {} stands twice", edge.from, edge.to)));
        }
    }
    let skeleton = Skeleton::new(&patches, listed, budget)?;
    let uses = knot_uses(&patches, dimension, &edges, &skeleton, &mut notes, budget)?;
    let at = words.line();
    let mut file = match words.word("\"knotvectors\" or \"patches\"")? {
        b"patches" => patch_layout(words, dimension, patches.len(), budget)?,
        b"knotvectors" => global_layout(words, spacing, num_vertices, &patches, &uses, &skeleton, &mut notes, budget)?,
        other => return Err(broken(at, format!("expected \"knotvectors\" or \"patches\", found \"{}\"", shown(other)))),
    };
    end(words)?;
    for (k, patch) in file.iter_mut().enumerate() {
        patch.attribute = Some(patches[k].attribute);
        patch.uses.clone_from(&uses[k]);
    }
    let sides = sides_of(&patches, dimension, budget)?;
    let joints = joints_of(&patches, dimension, &sides);
    let labels = labels_of(&boundary, dimension, &sides)?;
    Ok(SplineFile { format: Format::Mfem, patches: file, joints, labels, notes })
}

fn read_edges(words: &mut Words<'_>, budget: &mut Budget) -> Result<Vec<Edge>, FileError> {
    let count = words.count("edges", 3)?;
    budget.items(count, size_of::<Edge>() + 4 * size_of::<([u32; 2], usize)>())?;
    let mut edges = Vec::with_capacity(count);
    for _ in 0..count {
        let line = words.line();
        let vector = words.index("a knot vector")?;
        let mut vertex = || {
            let v = words.index("a vertex")?;
            u32::try_from(v).map_err(|_| broken(line, format!("vertex {v} is too large a number")))
        };
        let (from, to) = (vertex()?, vertex()?);
        if from == to {
            return Err(broken(line, format!("an edge from the vertex {from} to itself")));
        }
        edges.push(Edge { vector, from, to, line });
    }
    Ok(edges)
}

/// Edges of a patch along direction d: vertices from the lower to the upper end.
pub(super) fn along(patch: &Cell, dimension: usize, d: usize) -> impl Iterator<Item = (u32, u32)> {
    (0..1usize << dimension).filter(move |bits| bits & (1 << d) == 0).map(move |bits| (patch.corner(bits), patch.corner(bits | 1 << d)))
}

/// Classes of edges that share a knot vector, with directions: a union-find forest whose links store whether two edges are opposed.
struct Classes {
    above: Vec<(usize, bool)>,
}

impl Classes {
    /// Root of an edge, and whether the edge runs against it.
    fn root(&mut self, edge: usize) -> (usize, bool) {
        let mut at = edge;
        let mut against = false;
        while self.above[at].0 != at {
            // Halving the path keeps it short.
            let (up, turn) = self.above[at];
            let (top, more) = self.above[up];
            if up != top {
                self.above[at] = (top, turn ^ more);
            }
            against ^= self.above[at].1;
            at = self.above[at].0;
        }
        (at, against)
    }

    /// Joins two edges; returns false if they are already joined with the opposite direction.
    fn join(&mut self, a: usize, b: usize, against: bool) -> bool {
        let ((a, x), (b, y)) = (self.root(a), self.root(b));
        if a == b {
            return x ^ y == against;
        }
        // The lower number stays the root.
        self.above[a.max(b)] = (a.min(b), x ^ y ^ against);
        true
    }
}

/// Returns the knot vector of every direction of every patch.
pub(super) fn knot_uses(
    patches: &[Cell],
    dimension: usize,
    edges: &[Edge],
    skeleton: &Skeleton,
    notes: &mut Vec<String>,
    budget: &mut Budget,
) -> Result<Vec<Vec<KnotUse>>, FileError> {
    let count = skeleton.num_edges();
    budget.items(count, 4 * size_of::<usize>())?;
    budget.items(patches.len(), size_of::<Vec<KnotUse>>() + dimension * size_of::<KnotUse>())?;
    let mut classes = Classes { above: (0..count).map(|k| (k, false)).collect() };
    let number = |(a, b): (u32, u32)| skeleton.edge(a, b).expect("every edge of a patch has a number");
    for patch in patches {
        for d in 0..dimension {
            let mut all = along(patch, dimension, d);
            let first = all.next().expect("a patch has edges in every direction");
            for other in all {
                // An edge by itself runs from its lower vertex to the higher one.
                let against = (first.0 < first.1) != (other.0 < other.1);
                if !classes.join(number(first), number(other), against) {
                    return Err(broken(patch.line, "the directions of the patches turn around along a closed chain"));
                }
            }
        }
    }
    // The first edge of a class defines its knot vector and its direction.
    let mut known: BTreeMap<usize, (usize, bool)> = BTreeMap::new();
    let mut turned = 0;
    for (k, edge) in edges.iter().enumerate() {
        let (root, against) = classes.root(k);
        let falls = (edge.from > edge.to) ^ against;
        let (vector, direction) = *known.entry(root).or_insert((edge.vector, falls));
        if vector != edge.vector {
            return Err(broken(edge.line, format!("an edge has the knot vector {}, the edge opposite to it {vector}", edge.vector)));
        }
        turned += usize::from(direction != falls);
    }
    if turned > 0 {
        notes.push(format!("{turned} edges run against the first edge of their knot vector, whose direction is taken"));
    }
    let listed = !edges.is_empty();
    let mut uses = Vec::with_capacity(patches.len());
    for patch in patches {
        let mut of_patch = Vec::with_capacity(dimension);
        for d in 0..dimension {
            let first = along(patch, dimension, d).next().expect("a patch has edges in every direction");
            let (root, against) = classes.root(number(first));
            let next = known.len();
            let (vector, falls) = match known.get(&root) {
                Some(known) => *known,
                None if listed => return Err(broken(patch.line, "an edge of a patch is not listed")),
                None => *known.entry(root).or_insert((next, false)),
            };
            of_patch.push(KnotUse { vector, reversed: falls ^ against ^ (first.0 > first.1) });
        }
        uses.push(of_patch);
    }
    Ok(uses)
}

/// A knot vector: degree, number of functions, knots.
fn read_knots(words: &mut Words<'_>, budget: &mut Budget) -> Result<Knots, FileError> {
    let line = words.line();
    let degree = words.index("the degree of a knot vector")?;
    let functions = words.index("the number of functions of a knot vector")?;
    if functions <= degree {
        return Err(broken(line, format!("{functions} functions of degree {degree}; there are more than the degree")));
    }
    let count = functions.saturating_add(degree).saturating_add(1);
    words.room(count, 1, "knots", line)?;
    let knots = words.numbers(count, &format!("knots of {functions} functions of degree {degree}"), budget)?;
    check_knots(degree, &knots, line)?;
    Ok((degree, knots))
}

/// The weights if they vary; `None` if they are equal.
fn varying(weights: Vec<f64>) -> Option<Vec<f64>> {
    weights.iter().any(|w| *w != 1.0).then_some(weights)
}

/// Control points with every patch.
fn patch_layout(words: &mut Words<'_>, dimension: usize, count: usize, budget: &mut Budget) -> Result<Vec<SplinePatch>, FileError> {
    budget.items(count, size_of::<SplinePatch>())?;
    let mut patches = Vec::with_capacity(count.min(words.left()));
    for _ in 0..count {
        words.expect("knotvectors")?;
        let line = words.line();
        let directions = words.index("the number of knot vectors")?;
        if directions != dimension {
            return Err(broken(line, format!("a patch of {directions} knot vectors in a mesh of dimension {dimension}")));
        }
        let mut axes = Vec::with_capacity(dimension);
        for _ in 0..dimension {
            axes.push(read_knots(words, budget)?);
        }
        words.expect("dimension")?;
        let line = words.line();
        let world = words.index("the dimension")?;
        if !(dimension..=3).contains(&world) {
            return Err(broken(line, format!("control points of {world} coordinates in a mesh of dimension {dimension}")));
        }
        let line = words.line();
        let homogeneous = match words.word("\"controlpoints\"")? {
            b"controlpoints" | b"controlpoints_homogeneous" => true,
            b"controlpoints_cartesian" => false,
            other => {
                return Err(broken(line, format!("expected \"controlpoints\" or \"controlpoints_cartesian\", found \"{}\"", shown(other))));
            }
        };
        let line = words.line();
        let (degree, knots): (Vec<usize>, Vec<Vec<f64>>) = axes.into_iter().unzip();
        let functions = degree.iter().zip(&knots).fold(1usize, |n, (p, k)| n.saturating_mul(k.len() - p - 1));
        let numbers = words.numbers(
            functions.saturating_mul(world + 1),
            &format!("coordinates and weights of {functions} control points"),
            budget,
        )?;
        budget.items(functions, size_of::<[f64; 4]>())?;
        let weights: Vec<f64> = numbers.chunks_exact(world + 1).map(|c| c[world]).collect();
        check_weights(&weights, line)?;
        let point = |c: &[f64]| {
            let scale = if homogeneous { c[world] } else { 1.0 };
            std::array::from_fn(|k| if k < world { c[k] / scale } else { 0.0 })
        };
        let points: Vec<[f64; 3]> = numbers.chunks_exact(world + 1).map(point).collect();
        if let Some(k) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(broken(line, format!("control point {k} divided by its weight {} is not finite", weights[k])));
        }
        patches.push(SplinePatch { degree, knots, points, weights: varying(weights), world, ..SplinePatch::default() });
    }
    Ok(patches)
}

/// Control points once for the whole mesh.
fn global_layout(
    words: &mut Words<'_>,
    spacing: bool,
    num_vertices: usize,
    patches: &[Cell],
    uses: &[Vec<KnotUse>],
    skeleton: &Skeleton,
    notes: &mut Vec<String>,
    budget: &mut Budget,
) -> Result<Vec<SplinePatch>, FileError> {
    let count = words.count("knot vectors", 4)?;
    budget.items(count, size_of::<Knots>())?;
    let mut vectors = Vec::with_capacity(count);
    for _ in 0..count {
        vectors.push(read_knots(words, budget)?);
    }
    for (k, uses) in uses.iter().enumerate() {
        if let Some(u) = uses.iter().find(|u| u.vector >= count) {
            return Err(broken(patches[k].line, format!("patch {k} has the knot vector {}; there are {count}, counted from 0", u.vector)));
        }
    }
    if spacing {
        skip_spacing(words, notes)?;
    }
    let dimension = uses[0].len();
    let starts = starts(num_vertices, patches, uses, &vectors, skeleton, budget)?;
    let line = words.line();
    let head = words.word("\"weights\"")?;
    let weights = match head {
        b"weights" => {
            let line = words.line();
            let weights = words.numbers(starts.total, &format!("weights of {} control points", starts.total), budget)?;
            check_weights(&weights, line)?;
            Some(weights)
        }
        b"unitweights" | b"autoweights" => None,
        b"periodic" => return Err(unsupported(line, "a periodic MFEM NURBS mesh")),
        b"mesh_elements" => return Err(unsupported(line, "a MFEM NURBS mesh of which only some elements are used (mesh_elements)")),
        other => return Err(broken(line, format!("expected \"weights\", found \"{}\"", shown(other)))),
    };
    let field = Field::read(words)?;
    if !field.collection.starts_with("NURBS") {
        return Err(broken(field.line, format!("the points of a NURBS mesh are a field of NURBS, found {}", field.collection)));
    }
    if field.world < dimension {
        return Err(broken(field.line, format!("VDim is {} in a mesh of dimension {dimension}", field.world)));
    }
    let line = words.line();
    if words.accept("NURBS_patches") {
        return Err(unsupported(line, "a field of points patch by patch (NURBS_patches)"));
    }
    let points = field.points(words, starts.total, budget)?;
    let mut all = Vec::with_capacity(patches.len());
    for (k, patch) in patches.iter().enumerate() {
        let axes: Vec<Knots> = uses[k].iter().map(|u| oriented(&vectors[u.vector], u.reversed)).collect();
        budget.items(axes.iter().map(|(_, knots)| knots.len()).sum(), size_of::<f64>())?;
        let counts: Vec<usize> = axes.iter().map(|(p, knots)| knots.len() - p - 1).collect();
        let total: usize = counts.iter().product();
        budget.items(total, size_of::<[f64; 4]>() + size_of::<usize>())?;
        let at = |i: usize| {
            let mut rest = i;
            let mut index: [usize; 3] = std::array::from_fn(|d| {
                let n = counts.get(d).copied().unwrap_or(1);
                let i = rest % n;
                rest /= n;
                i
            });
            // The interior of a curve runs backwards: MFEM takes the orientation of a patch, which is zero, as that of an edge.
            if dimension == 1 && index[0] > 0 && index[0] + 1 < counts[0] {
                index[0] = counts[0] - 1 - index[0];
            }
            tensor_unknown(patch, &counts, &index, skeleton, &starts, Some(starts.cells[k])).expect("the skeleton is that of the patches")
        };
        let places: Vec<usize> = (0..total).map(at).collect();
        let weights = weights.as_ref().and_then(|w| varying(places.iter().map(|i| w[*i]).collect()));
        let (degree, knots) = axes.into_iter().unzip();
        let points = places.iter().map(|i| points[*i]).collect();
        all.push(SplinePatch { degree, knots, points, weights, world: field.world, ..SplinePatch::default() });
    }
    Ok(all)
}

/// A knot vector, reversed if `reversed`: t becomes first + last - t.
fn oriented((degree, knots): &Knots, reversed: bool) -> Knots {
    if !reversed {
        return (*degree, knots.clone());
    }
    let sum = knots[0] + knots[knots.len() - 1];
    let ends = [knots[0], knots[knots.len() - 1]];
    // The ends keep their exact values in spite of the rounding of the sum.
    let turn = |t: &f64| {
        if *t == ends[0] {
            ends[1]
        } else if *t == ends[1] {
            ends[0]
        } else {
            sum - t
        }
    };
    (*degree, knots.iter().rev().map(turn).collect())
}

/// First control point of every edge, face and patch.
fn starts(
    num_vertices: usize,
    patches: &[Cell],
    uses: &[Vec<KnotUse>],
    vectors: &[Knots],
    skeleton: &Skeleton,
    budget: &mut Budget,
) -> Result<Starts, FileError> {
    let dimension = uses[0].len();
    let num_faces = skeleton.face_corners.len();
    budget.items(skeleton.num_edges() + num_faces + patches.len(), size_of::<usize>())?;
    let mut edges = vec![0; if dimension > 1 { skeleton.num_edges() } else { 0 }];
    let mut faces = vec![0; num_faces];
    let mut inner = vec![0; patches.len()];
    let interior = |u: &KnotUse| {
        let (degree, knots) = &vectors[u.vector];
        // An open knot vector has a function at either end; those of degree 0 have one for both.
        (knots.len() - degree - 1).saturating_sub(2)
    };
    for (k, patch) in patches.iter().enumerate() {
        if let Some(u) = uses[k].iter().find(|u| vectors[u.vector].0 == 0) {
            return Err(unsupported(patch.line, format!("degree 0 of the knot vector {}", u.vector)));
        }
        let n: Vec<usize> = uses[k].iter().map(interior).collect();
        inner[k] = n.iter().fold(1usize, |m, n| m.saturating_mul(*n));
        if dimension > 1 {
            for (d, n) in n.iter().enumerate() {
                for (a, b) in along(patch, dimension, d) {
                    edges[skeleton.edge(a, b).expect("every edge of a patch has a number")] = *n;
                }
            }
        }
        if dimension == 3 {
            for d in 0..3 {
                let count = n[(d + 1) % 3].saturating_mul(n[(d + 2) % 3]);
                for end in 0..2 {
                    faces[skeleton.face(face_vertices(patch, d, end)).expect("every face of a patch has a number").number] = count;
                }
            }
        }
    }
    let mut total = num_vertices;
    for count in edges.iter_mut().chain(&mut faces).chain(&mut inner) {
        let start = total;
        total = total.saturating_add(*count);
        *count = start;
    }
    Ok(Starts { edges, faces, cells: inner, total })
}

/// Vertices of the face at an end of direction d.
fn face_vertices(patch: &Cell, d: usize, end: usize) -> [u32; 4] {
    let (e, f) = ((d + 1) % 3, (d + 2) % 3);
    std::array::from_fn(|k| patch.corner(end << d | (k & 1) << e | (k >> 1) << f))
}

/// Skips formulas that MFEM uses when it refines.
fn skip_spacing(words: &mut Words<'_>, notes: &mut Vec<String>) -> Result<(), FileError> {
    while !words.accept("spacing") {
        match words.peek() {
            Some(b"refinements" | b"knotvector_refinements") => {
                words.next();
                while words.peek().is_some_and(|w| w[0].is_ascii_digit()) {
                    words.index("a refinement")?;
                }
            }
            _ => return words.expect("spacing"),
        }
    }
    let count = words.count("spacing formulas", 4)?;
    for _ in 0..count {
        let line = words.line();
        words.index("a knot vector")?;
        words.int("a kind of spacing")?;
        let (whole, real) = (words.index("a number of parameters")?, words.index("a number of parameters")?);
        words.room(whole.saturating_add(real), 1, "parameters", line)?;
        for _ in 0..whole {
            words.int("a parameter")?;
        }
        for _ in 0..real {
            words.number("a parameter")?;
        }
    }
    if count > 0 {
        notes.push(format!("{count} spacing formulas are not read; the elements are those of the knots"));
    }
    Ok(())
}
