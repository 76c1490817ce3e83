//! All quantities of the language with their meaning, for `faying explain QUANTITY` and the reference.

use super::grammar::Quantity;

/// A quantity, or a family of them: words in capitals stand for a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuantityRow {
    /// As it is written: `contact.NAME.force.x`.
    pub pattern: &'static str,
    /// Meaning, sign.
    pub text: &'static str,
    /// Unit; empty for numbers.
    pub unit: &'static str,
    /// An example.
    pub example: &'static str,
}

const fn row(pattern: &'static str, text: &'static str, unit: &'static str, example: &'static str) -> QuantityRow {
    QuantityRow { pattern, text, unit, example }
}

/// Quantities of this version.
pub const QUANTITIES: &[QuantityRow] = &[
    row(
        "u",
        "the unknown of Poisson's equation at a point, or an extreme (.min, .max over the closed elements; .max.gauss at points of integration)",
        "",
        "u at [0.5, 0.5]",
    ),
    row(
        "u.x",
        "a component of the displacement at a point, or an extreme; `displacement` is another name",
        "length",
        "u.y at [1.0, 0.5] in upper",
    ),
    row("u.norm", "the length of the displacement at a point, or an extreme", "length", "u.norm.max"),
    row(
        "u.r",
        "radial (r) or tangential (t, anticlockwise) displacement about a centre in the plane of x and y",
        "length",
        "u.r about [0, 0] at [1, 0]",
    ),
    row("flux.x", "a component of k grad u (Poisson) at a point, or an extreme", "unit of u/length", "flux.x at [0.5, 0.5]"),
    row("stress.xx", "a component of the stress at a point, or an extreme; tension is positive", "force/area", "stress.yy.max in lower"),
    row(
        "stress.rr",
        "radial (rr), tangential (tt) or shear stress (rt) about a centre, in space about the axis along z through it, in axisymmetric models in the plane of radius and axis (the hoop stress is stress.zz); strain.rr alike",
        "force/area",
        "stress.tt about [0, 0] at [1, 0] in ring",
    ),
    row("principal.1", "a principal stress, the largest first, at a point, or an extreme", "force/area", "principal.1.max"),
    row(
        "strain.xx",
        "a component of the strain at a point, or an extreme; strain.xy is (du_x/dy + du_y/dx) / 2, half the angle of shear",
        "",
        "strain.xx at [0.5, 0.5]",
    ),
    row("von_mises", "the equivalent stress of von Mises at a point, or an extreme", "force/area", "von_mises.max"),
    row("energy", "1/2 a(u, u): stored energy of all bodies, springs and foundations", "force length", "energy"),
    row("unknowns", "number of unknowns, `unknowns.primal` and `unknowns.multipliers`", "", "unknowns.primal"),
    row(
        "error.u.L2",
        "norm of the error against `exact` or `reference`, with the points of the integrals; with .rel over the norm of the exact solution. The error of Lagrange elements nearly vanishes at many of these points, so their norm is low, by tens of percent (sin(3 x) exp(y) on 8 x 8 elements of degree 1, 2, 3: 35, 17, 21 %; rates are not), and right with `extra_points` = 1 or 2 in [discretization]",
        "",
        "error.u.L2.rel",
    ),
    row("error.u.H1", "semi-norm of the error of the gradient; with .rel relative", "", "error.u.H1"),
    row("error.u.energy", "energy norm of the error; with .rel relative", "", "error.u.energy"),
    row("error.lambda.L2", "L2 norm of the error of all multipliers over the slave sides; with .rel relative", "", "error.lambda.L2"),
    row("error.NAME.lambda.L2", "L2 norm of the error of the multiplier of one interface or contact", "", "error.arc.lambda.L2"),
    row(
        "reaction.SIDE.x",
        "force of the supports of a side on its body, along x, y or z (reactions.SIDE in result.json is a list of all). Unknowns in a corner or an edge of two supported sides count at one of them: force.PATCH.SIDE.x has no such share",
        "force",
        "reaction.lower.bottom.y",
    ),
    row("loads.NAME.force.x", "resultant of a load as the rules of the case integrate it", "force", "loads.boundary-0.force.y"),
    row(
        "force.PATCH.SIDE.x",
        "force of the stresses on a side, ∫ sigma n ds, n out of the patch: it converges with the mesh; force.PATCH.SIDE is the flux in Poisson's equation",
        "force",
        "force.lower.top.y",
    ),
    row(
        "force.x cut",
        "force of the stresses over a straight cut of the plane, ∫ sigma n ds, n to the right of the way from the first point to the second: what the part there does to the other",
        "force",
        "force.x cut [0.5, 0] to [0.5, 1] in lower",
    ),
    row("moment cut", "moment of these stresses about the origin, ∫ x × sigma n ds", "force length", "moment cut [0.5, 0] to [0.5, 1]"),
    row("flux cut", "flux over a cut in Poisson's equation, ∫ k du/dn ds", "", "flux cut [0.5, 0] to [0.5, 1]"),
    row(
        "balance.force.x",
        "sum of all external forces and reactions, balance.moment that of their moments: zero up to rounding where both sides of ties and contacts are integrated on the same pieces; integration = \"mixed\" and moments on mapping = \"exact\" leave what falls with the mesh",
        "force",
        "balance.force.y",
    ),
    row(
        "area.PATCH",
        "area of a patch in the plane, volume.PATCH in space; of bodies of revolution the whole volume",
        "length^2, length^3",
        "area.lower",
    ),
    row(
        "length.PATCH.SIDE",
        "length of a side in the plane, area.PATCH.SIDE in space; of bodies of revolution the whole area",
        "length, length^2",
        "length.lower.top",
    ),
    row(
        "interface.NAME.lambda",
        "multiplier of a tie at a point of the slave side: minus the slave's traction (k du/dn in Poisson's equation)",
        "force/area",
        "interface.arc.lambda at [0, 1]",
    ),
    row(
        "interface.NAME.force.x",
        "force of the master on the slave, .moment about the origin; interface.NAME.force.0 is the flux in Poisson's equation",
        "force",
        "interface.arc.force.y",
    ),
    row("interface.NAME.jump.L2", "L2 norm of the jump of u over an interface", "", "interface.arc.jump.L2"),
    row(
        "interface.NAME.segments.count",
        "number of segments of integration, .segments.measure their length, in space their area; between surfaces .segments.outside is how far points lie outside of their element, .segments.lost the elements that pieces do not tile",
        "",
        "interface.arc.segments.count",
    ),
    row("interface.NAME.distance", "largest distance of the two sides", "length", "interface.arc.distance"),
    row("contact.NAME.force.x", "force of the master on the slave", "force", "contact.pad.force.y"),
    row(
        "contact.NAME.moment",
        "its moment about the origin: a number in the plane, .x, .y, .z in three dimensions",
        "force length",
        "contact.pad.moment",
    ),
    row(
        "contact.NAME.pressure",
        "pressure at a point of the slave side, positive in compression; .pressure.min and .pressure.max are extremes at the points of integration",
        "force/area",
        "contact.pad.pressure.max",
    ),
    row(
        "contact.NAME.gap.min",
        "least lumped gap of the rows; .gap.least over points; positive when open",
        "length",
        "contact.pad.gap.min",
    ),
    row("contact.NAME.active", "number of closed rows", "", "contact.pad.active"),
    row("contact.NAME.area", "measure of the zone, integrated on segments: a length, in space an area", "length", "contact.pad.area"),
    row(
        "contact.NAME.half_width",
        "half the extent of the zone along the slave, in the plane (all of it with symmetry = true, and where it ends on the axis of revolution); null with a reason where the pressure near its end does not allow it, or where it ends at an end of the side that does not move along it and not at a corner at its other end, too",
        "length",
        "contact.pad.half_width",
    ),
    row("infsup.PAIRING.beta", "inf-sup constant of a multiplier, by `faying infsup`", "", "infsup.p/p-2.beta"),
    row("rate.Q", "rate of any quantity Q over the levels, by `faying convergence`", "", "rate.error.u.L2"),
];

/// Whether a part of a path is one of a pattern: capitals stand for any name, `x` for a coordinate, `xx` for two.
fn fits(pattern: &str, part: &str) -> bool {
    match pattern {
        "x" => matches!(part, "x" | "y" | "z"),
        "xx" => matches!(part, "xx" | "yy" | "zz" | "xy" | "yz" | "xz"),
        "r" => matches!(part, "r" | "t"),
        "rr" => matches!(part, "rr" | "tt" | "rt"),
        "1" => matches!(part, "1" | "2" | "3"),
        _ if pattern.chars().all(|c| c.is_ascii_uppercase()) => true,
        _ => pattern == part,
    }
}

/// Whether a word is a quantity, with a centre if it lacks one.
fn is_quantity(word: &str) -> bool {
    Quantity::parse(word).is_ok() || Quantity::parse(&format!("{word} about [0, 0]")).is_ok()
}

/// The quantities that a word names: one of the list, a quantity as a probe has it, or a part of a path such as `half_width`.
pub fn find(word: &str) -> Vec<&'static QuantityRow> {
    let same: Vec<&QuantityRow> = QUANTITIES.iter().filter(|k| k.pattern == word || k.example == word).collect();
    if !same.is_empty() {
        return same;
    }
    if let Some((sum, _)) = word.split_once(" cut") {
        let known = match sum.strip_prefix("force.") {
            Some("x" | "y") => "force.x cut".to_owned(),
            _ => format!("{sum} cut"),
        };
        return QUANTITIES.iter().filter(|k| k.pattern == known).collect();
    }
    let head = word.split([' ', '[']).next().unwrap_or_default().replace("displacement", "u").replace("reactions.", "reaction.");
    let head = head.trim_end_matches(".gauss").trim_end_matches(".rel");
    let whole: Vec<&QuantityRow> = QUANTITIES
        .iter()
        .filter(|k| {
            let (pattern, path): (Vec<&str>, Vec<&str>) = (k.pattern.split('.').collect(), head.split('.').collect());
            // extremes and components may follow
            path.len() >= pattern.len() && pattern.iter().zip(&path).all(|(p, w)| fits(p, w)) && is_quantity(word)
        })
        .collect();
    let longest = whole.iter().map(|k| k.pattern.split('.').count()).max();
    let whole: Vec<&QuantityRow> = whole.into_iter().filter(|k| Some(k.pattern.split('.').count()) == longest).collect();
    if !whole.is_empty() {
        return whole;
    }
    let parts: Vec<&str> = word.split('.').collect();
    QUANTITIES.iter().filter(|k| k.pattern.split('.').collect::<Vec<_>>().windows(parts.len()).any(|w| w == parts)).collect()
}

/// The quantities as a chapter of the reference, in Markdown.
pub fn page() -> String {
    let mut out = String::from(
        "\n## Quantities of probes and checks\n\nWords in capitals stand for names. Fields take `at [x, y]` or `at TAG`, `in PATCH`, and `.min`, `.max`; those with directions about a centre `about [x, y]`; any number of \
         result.json is a quantity by its path.\n\n| quantity | meaning | unit | example |\n| --- | --- | --- | --- |\n",
    );
    for row in QUANTITIES {
        out.push_str(&format!("| `{}` | {} | {} | `{}` |\n", row.pattern, row.text, row.unit, row.example));
    }
    out
}
