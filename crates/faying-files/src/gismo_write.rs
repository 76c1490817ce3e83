//! Writes spline patches as G+Smo XML.

use super::sides::{SIDES, lie, side_number, tangents};
use super::{PatchSide, SplineFile, SplinePatch, Written};
use quick_xml::escape::escape;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Writes the patches, their joints and labels; numbers read back to the same bits.
///
/// Patches keep their ids if these are unique; otherwise they are numbered from 0. Materials and shared knot vectors of an MFEM
/// mesh are lost.
pub fn write(file: &SplineFile) -> Written {
    let mut lost = Vec::new();
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<xml>\n");
    let own: BTreeSet<i64> = file.patches.iter().filter_map(|p| p.id).filter(|id| *id >= 0).collect();
    let keep = own.len() == file.patches.len();
    let ids: Vec<i64> = file.patches.iter().enumerate().map(|(k, p)| p.id.filter(|_| keep).unwrap_or(k as i64)).collect();
    for (patch, id) in file.patches.iter().zip(&ids) {
        geometry(&mut out, patch, *id);
    }
    let alike = file.patches.windows(2).all(|w| w[0].dimension() == w[1].dimension());
    if alike && (file.patches.len() > 1 || !file.labels.is_empty()) {
        multipatch(&mut out, file, &ids);
    } else if !file.joints.is_empty() || !file.labels.is_empty() {
        lost.push("patches of several dimensions make no MultiPatch: joints and names of sides".to_string());
    }
    out.push_str("</xml>\n");
    if file.patches.iter().any(|p| p.attribute.is_some_and(|a| a != 1)) {
        lost.push("numbers of materials (attributes)".to_string());
    }
    if file.patches.iter().any(|p| !p.uses.is_empty()) {
        lost.push("which patches share a knot vector".to_string());
    }
    Written { text: out, lost }
}

/// Numbers, `per` of them on a line.
fn numbers(out: &mut String, all: impl Iterator<Item = f64>, per: usize) {
    for (k, x) in all.enumerate() {
        // The shortest text that reads back to the same bits.
        write!(out, "{}{x:?}", if k == 0 || k % per != 0 { " " } else { "\n" }).expect("a String takes every text");
    }
}

fn geometry(out: &mut String, patch: &SplinePatch, id: i64) {
    let d = patch.dimension();
    let rational = patch.weights.is_some();
    let family = if rational { "Nurbs" } else { "BSpline" };
    let (kind, basis, inner) = if d == 1 {
        (family.to_string(), format!("{family}Basis"), "BSplineBasis".to_string())
    } else {
        (format!("Tensor{family}{d}"), format!("Tensor{family}Basis{d}"), format!("TensorBSplineBasis{d}"))
    };
    let label = patch.name.as_ref().map_or(String::new(), |n| format!(" label=\"{}\"", escape(n.as_str())));
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!(" <Geometry type=\"{kind}\" id=\"{id}\"{label}>"));
    if rational {
        line(format!("  <Basis type=\"{basis}\">"));
    }
    line(format!("  <Basis type=\"{inner}\">"));
    for k in 0..d {
        let mut text = String::new();
        numbers(&mut text, patch.knots[k].iter().copied(), usize::MAX);
        let vector = format!("<KnotVector degree=\"{}\">{text} </KnotVector>", patch.degree[k]);
        line(if d == 1 { vector } else { format!("   <Basis type=\"BSplineBasis\" index=\"{k}\">{vector}</Basis>") });
    }
    line("  </Basis>".to_string());
    if let Some(weights) = &patch.weights {
        let mut text = String::new();
        numbers(&mut text, weights.iter().copied(), 1);
        line(format!("  <weights>{text} </weights>"));
        line("  </Basis>".to_string());
    }
    let mut text = String::new();
    numbers(&mut text, patch.points.iter().flat_map(|p| p[..patch.world].iter().copied()), patch.world);
    line(format!("  <coefs geoDim=\"{}\">{text} </coefs>", patch.world));
    line(" </Geometry>".to_string());
}

/// Patch and side in the numbering of G+Smo.
fn numbered(side: &PatchSide, ids: &[i64]) -> String {
    format!("{} {}", ids[side.patch], side_number(&side.side).map_or(0, |s| s + 1))
}

fn multipatch(out: &mut String, file: &SplineFile, ids: &[i64]) {
    let d = file.patches[0].dimension();
    let free = (0..).find(|id| !ids.contains(id)).unwrap_or(-1);
    let mut line = |text: String| {
        out.push_str(&text);
        out.push('\n');
    };
    line(format!(" <MultiPatch parDim=\"{d}\" id=\"{free}\">"));
    if ids.windows(2).all(|w| w[0].checked_add(1) == Some(w[1])) {
        line(format!("  <patches type=\"id_range\">{} {}</patches>", ids[0], ids[ids.len() - 1]));
    } else {
        let all: Vec<String> = ids.iter().map(i64::to_string).collect();
        line(format!("  <patches type=\"id_index\">{}</patches>", all.join(" ")));
    }
    line("  <interfaces>".to_string());
    for [one, other] in &file.joints {
        line(format!("{} {} {}", numbered(one, ids), numbered(other, ids), map(file, one, other)));
    }
    line("  </interfaces>".to_string());
    let inner: BTreeSet<(usize, &str)> = file.joints.iter().flatten().map(|s| (s.patch, s.side.as_str())).collect();
    let mut open: BTreeSet<(usize, &str)> = (0..ids.len()).flat_map(|k| SIDES[..2 * d].iter().map(move |s| (k, *s))).collect();
    open.retain(|side| !inner.contains(side));
    for label in &file.labels {
        line(format!("  <boundary name=\"{}\">", escape(label.name.as_str())));
        for side in &label.sides {
            open.remove(&(side.patch, side.side.as_str()));
            line(numbered(side, ids));
        }
        line("  </boundary>".to_string());
    }
    line("  <boundary>".to_string());
    for (patch, side) in open {
        line(numbered(&PatchSide { patch, side: side.to_string() }, ids));
    }
    line("  </boundary>".to_string());
    line(" </MultiPatch>".to_string());
}

/// Directions of the second patch that correspond to those of the first, and whether they have the same sense.
fn map(file: &SplineFile, one: &PatchSide, other: &PatchSide) -> String {
    let (a, b) = (&file.patches[one.patch], &file.patches[other.patch]);
    let d = a.dimension();
    let (s, t) = (side_number(&one.side).unwrap_or(0), side_number(&other.side).unwrap_or(0));
    let lie = lie((a, s), (b, t));
    let mut to = vec![t / 2; d];
    let mut same = vec![s % 2 != t % 2; d];
    let second = tangents(d, t);
    for (i, direction) in tangents(d, s).into_iter().enumerate() {
        to[direction] = second[lie.direction(i)];
        same[direction] = !lie.flip[i];
    }
    let to = to.iter().map(usize::to_string);
    to.chain(same.iter().map(|s| u8::from(*s).to_string())).collect::<Vec<_>>().join(" ")
}
