//! Writes MFEM NURBS meshes with control points per patch.

use super::super::budget::Budget;
use super::super::handed::{exchange, left_handed_patches};
use super::super::sides::{knots_agree, lie, side_corner, side_number, touch};
use super::super::{CellShape, FileError, KnotUse, Limits, SplineFile, Written};
use super::cells::{CORNERS, Cell, NONE, Skeleton};
use super::nurbs::{along, knot_uses};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write;

/// Writes an "MFEM NURBS mesh v1.0" in the layout `patches`; numbers read back to the same bits.
///
/// Patches are right-handed: of those that are not, the first two directions are exchanged, which a comment records and
/// [`parse`](super::parse) undoes, so that sides keep their names. Patches share corners if the file lists a common side of them and the
/// knots there agree. Ids and names are lost.
///
/// # Errors
/// [`FileError::Unsupported`] for patches of several dimensions; [`FileError::Broken`] for knots, points and weights that do not fit.
pub fn write(file: &SplineFile) -> Result<Written, FileError> {
    let left = left_handed_patches(file)?;
    let mut written = if left.is_empty() {
        written(file, "")
    } else {
        let mut file = file.clone();
        exchange(&mut file, &left);
        let list: Vec<String> = left.iter().map(usize::to_string).collect();
        written(&file, &format!("{EXCHANGED} {}\n", list.join(" ")))
    }?;
    if !left.is_empty() {
        let names: Vec<String> = left.iter().map(|k| file.patches[*k].name.clone().unwrap_or_else(|| k.to_string())).collect();
        written.lost.push(format!(
            "the order of the first two directions of left-handed patches, which are exchanged (a comment keeps it for this program): {}",
            names.join(", ")
        ));
    }
    Ok(written)
}

/// Prefix of the comment that lists the patches whose first two directions are exchanged, counted from 0.
pub(super) const EXCHANGED: &str = "# faying: left-handed patches, first two directions exchanged:";

/// Patches that a file lists after [`EXCHANGED`], before its first section.
pub(super) fn exchanged(bytes: &[u8]) -> Vec<usize> {
    let ahead = bytes.split(|b| *b == b'\n').skip(1).take_while(|line| line.trim_ascii().is_empty() || line.starts_with(b"#"));
    let lists = ahead.filter_map(|line| line.strip_prefix(EXCHANGED.as_bytes()));
    let numbers =
        lists.flat_map(|list| String::from_utf8_lossy(list).split_whitespace().filter_map(|w| w.parse().ok()).collect::<Vec<_>>());
    numbers.collect::<BTreeSet<usize>>().into_iter().collect()
}

fn written(file: &SplineFile, comment: &str) -> Result<Written, FileError> {
    let unsupported = |what: &str| FileError::Unsupported { what: what.to_string(), spot: None };
    let Some(d) = file.patches.first().map(|p| p.dimension()) else {
        return Err(unsupported("an MFEM mesh without patches"));
    };
    if file.patches.iter().any(|p| p.dimension() != d) {
        return Err(unsupported("an MFEM mesh of patches of several dimensions"));
    }
    let mut lost = Vec::new();
    let (cells, num_vertices) = topology(file, d, &mut lost);
    let mut budget = Budget::new(&Limits::default(), 0);
    let skeleton = Skeleton::new(&cells, HashMap::new(), &mut budget)?;
    let numbered = file.patches.iter().all(|p| p.uses.len() == d);
    let uses: Vec<Vec<KnotUse>> = if numbered {
        file.patches.iter().map(|p| p.uses.clone()).collect()
    } else {
        knot_uses(&cells, d, &[], &skeleton, &mut lost, &mut budget)?
    };
    let mut out = format!("MFEM NURBS mesh v1.0\n{comment}\ndimension\n{d}\n\nelements\n{}\n", cells.len());
    for cell in &cells {
        element(&mut out, cell.attribute, cell.shape, cell.corners());
    }
    boundary(&mut out, file, d, &cells, &mut lost);
    let mut edges: BTreeMap<usize, (usize, u32, u32)> = BTreeMap::new();
    for (cell, uses) in cells.iter().zip(&uses) {
        for (k, used) in uses.iter().enumerate() {
            for (a, b) in along(cell, d, k) {
                let number = skeleton.edge(a, b).expect("every edge of a patch has a number");
                edges.entry(number).or_insert(if used.reversed { (used.vector, b, a) } else { (used.vector, a, b) });
            }
        }
    }
    write!(out, "\nedges\n{}\n", edges.len()).expect(TEXT);
    for (vector, a, b) in edges.values() {
        writeln!(out, "{vector} {a} {b}").expect(TEXT);
    }
    write!(out, "\nvertices\n{num_vertices}\n\npatches\n").expect(TEXT);
    let world = file.patches.iter().map(|p| p.world).max().unwrap_or(d).max(d);
    for patch in &file.patches {
        write!(out, "\nknotvectors\n{d}\n").expect(TEXT);
        for (p, knots) in patch.degree.iter().zip(&patch.knots) {
            write!(out, "{p} {}", knots.len() - p - 1).expect(TEXT);
            for t in knots {
                write!(out, " {t:?}").expect(TEXT);
            }
            out.push('\n');
        }
        write!(out, "dimension\n{world}\ncontrolpoints_cartesian\n").expect(TEXT);
        for (k, point) in patch.points.iter().enumerate() {
            for x in &point[..world] {
                write!(out, "{x:?} ").expect(TEXT);
            }
            writeln!(out, "{:?}", patch.weights.as_ref().map_or(1.0, |w| w[k])).expect(TEXT);
        }
    }
    if file.patches.iter().any(|p| p.id.is_some()) {
        lost.push("ids of patches".to_string());
    }
    if file.patches.iter().any(|p| p.name.is_some()) {
        lost.push("names of patches".to_string());
    }
    Ok(Written { text: out, lost })
}

/// Message of `expect` for writing into a String, which cannot fail.
pub(super) const TEXT: &str = "a String takes every text";

/// A line of an element.
pub(super) fn element(out: &mut String, attribute: i64, shape: CellShape, vertices: &[u32]) {
    let kind = match shape {
        CellShape::Point => 0,
        CellShape::Line => 1,
        CellShape::Triangle => 2,
        CellShape::Quadrilateral => 3,
        CellShape::Tetrahedron => 4,
        CellShape::Hexahedron => 5,
        CellShape::Prism => 6,
        CellShape::Pyramid => 7,
    };
    write!(out, "{attribute} {kind}").expect(TEXT);
    for v in vertices {
        write!(out, " {v}").expect(TEXT);
    }
    out.push('\n');
}

/// Patches as cells with shared corners, and the number of corners.
fn topology(file: &SplineFile, d: usize, lost: &mut Vec<String>) -> (Vec<Cell>, usize) {
    let corners = 1usize << d;
    let mut above: Vec<usize> = (0..file.patches.len() * corners).collect();
    fn root(above: &mut [usize], mut at: usize) -> usize {
        while above[at] != at {
            above[at] = above[above[at]];
            at = above[at];
        }
        at
    }
    for [one, other] in &file.joints {
        let (Some(s), Some(t)) = (side_number(&one.side), side_number(&other.side)) else { continue };
        let (a, b) = ((&file.patches[one.patch], s), (&file.patches[other.patch], t));
        let lie = lie(a, b);
        if one.patch == other.patch {
            lost.push(format!("that patch {} closes on itself: in MFEM its corners must differ", one.patch));
            continue;
        }
        if !touch(a, b, lie) {
            lost.push(format!("that patches {} and {} have a side in common: the corners lie apart", one.patch, other.patch));
            continue;
        }
        if !knots_agree(a, b, lie) {
            lost.push(format!(
                "that patches {} and {} have a side in common: their knots differ there, in MFEM they must agree",
                one.patch, other.patch
            ));
            continue;
        }
        for bits in 0..1 << (d - 1) {
            let x = one.patch * corners + side_corner(d, s, bits);
            let y = other.patch * corners + side_corner(d, t, lie.corner(bits, d - 1));
            let (x, y) = (root(&mut above, x), root(&mut above, y));
            above[x.max(y)] = x.min(y);
        }
    }
    let mut numbers: BTreeMap<usize, u32> = BTreeMap::new();
    let shape = [CellShape::Line, CellShape::Quadrilateral, CellShape::Hexahedron][d - 1];
    let mut cells = Vec::new();
    for (k, patch) in file.patches.iter().enumerate() {
        let mut vertices = [NONE; 8];
        for (bits, place) in CORNERS.iter().enumerate().take(corners) {
            let next = numbers.len() as u32;
            vertices[*place] = *numbers.entry(root(&mut above, k * corners + bits)).or_insert(next);
        }
        cells.push(Cell { attribute: patch.attribute.unwrap_or(1), shape, vertices, line: 0 });
    }
    (cells, numbers.len())
}

/// Sides with numbers: a name that is no number gets the next free one.
fn boundary(out: &mut String, file: &SplineFile, d: usize, cells: &[Cell], lost: &mut Vec<String>) {
    let number = |name: &str| name.parse::<i64>().ok().filter(|n| *n > 0 && n.to_string() == name);
    let mut next = file.labels.iter().filter_map(|l| number(&l.name)).max().unwrap_or(0);
    let mut lines = String::new();
    let mut count = 0;
    for label in &file.labels {
        let attribute = number(&label.name).unwrap_or_else(|| {
            next += 1;
            lost.push(format!("the name of the side \"{}\": it has the number {next}", label.name));
            next
        });
        let mut seen = BTreeSet::new();
        for side in &label.sides {
            let Some(s) = side_number(&side.side) else { continue };
            let cell = &cells[side.patch];
            // Cycles of a side of one, two or three dimensions.
            let cycle: &[usize] = [&[0][..], &[0, 1], &[0, 1, 3, 2]][d - 1];
            let vertices: Vec<u32> = cycle.iter().map(|bits| cell.corner(side_corner(d, s, *bits))).collect();
            let mut key = vertices.clone();
            key.sort_unstable();
            if seen.insert(key) {
                let shape = [CellShape::Point, CellShape::Line, CellShape::Quadrilateral][d - 1];
                element(&mut lines, attribute, shape, &vertices);
                count += 1;
            }
        }
    }
    write!(out, "\nboundary\n{count}\n{lines}").expect(TEXT);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sides::corner_point;
    use crate::{Format, PatchSide, SplinePatch};

    fn square(x: f64) -> SplinePatch {
        let knots = vec![vec![0.0, 0.0, 1.0, 1.0]; 2];
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|p| [p[0] + x, p[1], 0.0]).to_vec();
        SplinePatch { degree: vec![1, 1], knots, points, world: 2, ..SplinePatch::default() }
    }

    #[test]
    fn squares_with_a_common_side_share_two_vertices() {
        let side = |patch, side: &str| PatchSide { patch, side: side.to_string() };
        let joints = vec![[side(0, "u1"), side(1, "u0")]];
        let file = SplineFile { format: Format::Gismo, patches: vec![square(0.0), square(1.0)], joints, labels: vec![], notes: vec![] };
        let (cells, count) = topology(&file, 2, &mut Vec::new());
        assert_eq!((count, cells[1].corner(0), cells[1].corner(2)), (6, cells[0].corner(1), cells[0].corner(3)));
        assert_eq!(corner_point(&file.patches[1], 1), [2.0, 0.0, 0.0]);
    }
}
