//! Preparation of quantities with the model, before anything is solved: names, components, points.

use super::cut::PreparedCut;
use super::fields::{FieldAbout, FieldName};
use super::grammar::{At, Quantity, QuantityKind, Reduce};
use super::locate::{Locators, Spot};
use super::path::{beside, known, look_up};
use crate::case::{Case, Multiplier};
use crate::errors::{Diagnostic, nearest};
use crate::formula::{Formula, Scope};
use crate::place::SourceSpan;
use crate::shapes::named_point;
use faying::linalg::Vector;
use faying::problem::{Contents, InterfaceId};
use serde_json::Value;

/// Distance from a body, as a fraction of an element, within which a point moves to the nearest point of the body.
pub(super) const OFF: f64 = 0.25;
/// Most numbers that a message lists.
const NAMED: usize = 12;
/// Distance from a body relative to the size of the model from which on a point counts as moved to it.
const MOVED: f64 = 1e-6;
/// Notation of a point, in the plane and in space.
const POINT: [&str; 2] = ["[x, y]", "[x, y, z]"];

/// Point on a slave side.
#[derive(Clone, Debug, PartialEq)]
pub struct SideSpot<const S: usize> {
    /// The interface or contact.
    pub of: InterfaceId,
    /// Number of its slave side.
    pub side: usize,
    /// The element.
    pub element: usize,
    /// Local coordinates.
    pub xi: Vector<S>,
}

/// A quantity ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Prepared<const S: usize, const N: usize> {
    /// A field at a place.
    At(FieldAbout<N>, Spot<N>),
    /// The least or largest value of a field, or both; in one patch or all.
    FunctionSpace(FieldAbout<N>, Vec<usize>, Reduce),
    /// The force of the stresses on sides (patch, name), one component.
    SideForce(Vec<(usize, String)>, usize),
    /// A sum over a straight cut.
    Cut(PreparedCut<N>),
    /// lambda of an interface at a place, one component.
    Lambda(SideSpot<S>, usize),
    /// Pressure (true) or lambda of a contact at a place.
    Pressure(SideSpot<S>, bool),
    /// A number known already.
    Number(f64),
    /// A number of the result.
    Path(Vec<String>),
    /// Known to studies only.
    Study,
}

/// Preparation of quantities for one model.
#[derive(Debug)]
pub struct Preparer<'a, const S: usize, const N: usize> {
    pub(super) case: &'a Case,
    pub(super) contents: Contents<'a, S, N>,
    pub(super) locators: &'a Locators<'a, S, N>,
    skeleton: &'a Value,
}

impl<'a, const S: usize, const N: usize> Preparer<'a, S, N> {
    /// Creates the preparer; `skeleton`: the JSON of a result before it is filled.
    pub fn new(case: &'a Case, locators: &'a Locators<'a, S, N>, skeleton: &'a Value) -> Self {
        Self { case, contents: locators.contents(), locators, skeleton }
    }

    pub(super) fn fault(&self, code: &'static str, message: String, at: SourceSpan) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(code, message).at(&self.case.source, at))
    }

    /// Prepares `text`, with source location `at`. With `both`, a field without a point means both extremes.
    ///
    /// # Errors
    /// E018 for what is no quantity here, E019 for what is not built, E021 for unknown names, E022 for points outside, E017 for
    /// coordinates.
    pub fn prepare(&self, text: &str, at: SourceSpan, both: bool) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let quantity = Quantity::parse(text).map_err(|e| {
            let fault = self.fault("E018", format!("`{text}` is no quantity: {e}"), at);
            Box::new(self.suggest(*fault, text))
        })?;
        match quantity.kind {
            QuantityKind::Beta(pairing) => self.beta(text, &pairing, at),
            QuantityKind::Rate(inner) => self.rate(&inner, at),
            QuantityKind::Later(path, _) if path[0] == "contact" && !self.contents.contacts().any(|c| c.name() == path[1]) => {
                self.path(text, path, at)
            }
            QuantityKind::Later(_, instead) => {
                Err(Box::new(self.fault("E019", format!("`{text}` is not in this version"), at).with_help(instead)))
            }
            QuantityKind::Path(path) => self.path(text, path, at),
            QuantityKind::SideMeasure(side) => self.side_measure(text, &side, at),
            QuantityKind::SideForce(side, component) => self.side_force(text, &side, component, at),
            QuantityKind::Cut(sum, ends, patch) => self.cut(text, (sum, ends), &self.bodies_of(patch.as_deref(), at)?, at),
            QuantityKind::Multiplier { pressure, name, component, at: place } => {
                if self.contents.ties().any(|t| t.name() == name) {
                    self.lambda(text, &name, component, &place, at)
                } else {
                    self.pressure(text, &name, pressure, &place, at)
                }
            }
            QuantityKind::Field { field, about, at: place, patch, reduce } => {
                self.field_exists(text, field, at)?;
                let field = FieldAbout { name: field, about: self.centre(text, about, at)? };
                let bodies = self.bodies_of(patch.as_deref(), at)?;
                match (&place, reduce, both) {
                    (At::Everywhere, Reduce::None, false) => Err(Box::new(
                        Diagnostic::error("E018", format!("`{text}` is a field; a quantity is one number"))
                            .at(&self.case.source, at)
                            .with_help(format!("add `at {}`, `.min` or `.max`; a check may say over = \"all\"", POINT[N - 2])),
                    )),
                    (At::Everywhere, ..) => Ok(Prepared::FunctionSpace(field, bodies, reduce)),
                    _ => {
                        let spot = self.spot(text, &place, &bodies, at)?;
                        Ok(Prepared::At(field, Spot { shared: spot.shared && patch.is_none(), ..spot }))
                    }
                }
            }
        }
    }

    fn field_exists(&self, text: &str, field: FieldName, at: SourceSpan) -> Result<(), Box<Diagnostic>> {
        let scalar = self.contents.components() == 1;
        let wrong = match field {
            FieldName::U(Some(_)) if scalar => Some("u has no components in Poisson problems; write u"),
            FieldName::Norm | FieldName::PolarU(_) if scalar => Some("u has no components in Poisson problems; write u"),
            FieldName::U(None) if !scalar => Some("u has components in elasticity; write u.x or u.y"),
            FieldName::U(Some(c)) | FieldName::Flux(c) if c >= N => Some("this component is not there in the plane"),
            FieldName::Flux(_) if !scalar => Some("the flux belongs to Poisson problems; elasticity has stress.xx, stress.yy, stress.xy"),
            _ if scalar && field.is_derived() && !matches!(field, FieldName::Flux(_)) => {
                Some("stresses and strains belong to elasticity; Poisson problems have flux.x, flux.y")
            }
            _ => None,
        };
        wrong.map_or(Ok(()), |why| Err(self.fault("E018", format!("`{text}` is no quantity here: {why}"), at)))
    }

    /// The centre of a field's directions; in space the point [x, y] of the axis along z.
    fn centre(&self, text: &str, about: Vec<String>, at: SourceSpan) -> Result<Vector<N>, Box<Diagnostic>> {
        match about.len() {
            0 => Ok(Vector::zeros()),
            2 => {
                let plane = about.into_iter().chain(std::iter::repeat_n("0".to_owned(), N - 2)).collect();
                self.point(text, &At::Point(plane), at)
            }
            n => {
                let message = format!("`{text}`: the centre has {n} coordinates; write about [x, y]");
                let help = "the axis of polar components is that of z, in space through [x, y, 0]";
                Err(Box::new(self.fault("E018", message, at).with_help(help)))
            }
        }
    }

    /// Returns the patches that a name stands for: one, or all those of a file; without a name all.
    fn bodies_of(&self, name: Option<&str>, at: SourceSpan) -> Result<Vec<usize>, Box<Diagnostic>> {
        let Some(name) = name else { return Ok((0..self.contents.bodies().len()).collect()) };
        let found = self.case.find_patches(name);
        if found.is_empty() { Ok(vec![self.patch(name, at)?]) } else { Ok(found) }
    }

    pub(super) fn patch(&self, name: &str, at: SourceSpan) -> Result<usize, Box<Diagnostic>> {
        let names: Vec<&str> = self.contents.bodies().map(|b| b.name()).collect();
        names.iter().position(|n| *n == name).ok_or_else(|| {
            let near = nearest(name, names.iter().copied()).map_or(String::new(), |n| format!("; did you mean `{n}`?"));
            let fault = self.fault("E021", format!("there is no patch \"{name}\"; patches are {}{near}", names.join(", ")), at);
            Box::new(fault.with_help(format!("write `in {}`, or leave `in` out", names.first().copied().unwrap_or("PATCH"))))
        })
    }

    /// Position of a named point of a mesh, in whichever patch has it.
    fn named_point(&self, text: &str, tag: &str, at: SourceSpan) -> Result<Vector<N>, Box<Diagnostic>> {
        if let Some(x) = self.case.patches.iter().find_map(|p| named_point::<N>(p, tag)) {
            return Ok(x);
        }
        let parts = self.case.patches.iter().filter_map(|p| p.geometry.shape.part());
        let mut known: Vec<&str> = parts.flat_map(|p| p.points()).collect();
        known.sort_unstable();
        known.dedup();
        let known =
            if known.is_empty() { "no mesh of the case names points".to_owned() } else { format!("points are {}", known.join(", ")) };
        let fault = *self.fault("E021", format!("`{text}`: there is no mesh point `{tag}`; {known}"), at);
        Err(Box::new(fault.with_help(format!("or write at {}", POINT[N - 2]))))
    }

    pub(super) fn point(&self, text: &str, place: &At, at: SourceSpan) -> Result<Vector<N>, Box<Diagnostic>> {
        let list = match place {
            At::Point(list) => list,
            At::Tag(tag) => return self.named_point(text, tag, at),
            At::Everywhere => return Err(self.fault("E018", format!("`{text}` needs a point; write at {}", POINT[N - 2]), at)),
        };
        let flat = list.len() == 3 && N == 2;
        if list.len() != N && !flat {
            return Err(self.fault("E018", format!("`{text}`: the point has {} coordinates, the model {N}", list.len()), at));
        }
        let mut x = Vector::<N>::zeros();
        for (k, coordinate) in list.iter().enumerate() {
            let value = Formula::parse(coordinate, &Scope::number(&self.case.constants))
                .map_err(|e| self.fault("E017", format!("coordinate `{coordinate}` of `{text}`: {e}"), at))?
                .as_constant()
                .filter(|v| v.is_finite())
                .ok_or_else(|| self.fault("E017", format!("coordinate `{coordinate}` of `{text}` is not finite"), at))?;
            if k < N {
                x[k] = value;
            } else if value != 0.0 {
                return Err(self.fault("E044", format!("`{text}`: z must be 0 in the plane"), at));
            }
        }
        Ok(x)
    }

    fn spot(&self, text: &str, place: &At, bodies: &[usize], at: SourceSpan) -> Result<Spot<N>, Box<Diagnostic>> {
        let x = self.point(text, place, at)?;
        let (mut best, mut nearest_body): (Option<(f64, usize, usize, Vector<N>, Vector<N>)>, f64) = (None, f64::INFINITY);
        let (rounding, mut distances) = (1e-9 * self.contents.size().diagonal, Vec::new());
        for &k in bodies {
            match self.locators.of(k).locate(&x) {
                Ok(found) => {
                    // patches that touch in the point: the first one is taken
                    let better = best.as_ref().is_none_or(|b| found.distance < b.0 - rounding);
                    distances.push(found.distance);
                    if better {
                        best = Some((found.distance, k, found.element, found.xi, found.x));
                    }
                }
                Err(outside) => nearest_body = nearest_body.min(outside.distance),
            }
        }
        let Some((distance, patch, element, xi, x)) = best else {
            let coordinates: Vec<String> = x.iter().map(|v| format!("{v}")).collect();
            let whole = match bodies {
                [one] if self.contents.bodies().len() > 1 => format!("patch \"{}\"", self.contents.body(*one).name()),
                _ => "every body".to_owned(),
            };
            let message = format!("the point ({}) is outside {whole}, {nearest_body:.3e} away", coordinates.join(", "));
            return Err(Box::new(
                Diagnostic::error("E022", message)
                    .at(&self.case.source, at)
                    .with_help("points off a body by less than a quarter of an element move to the nearest point"),
            ));
        };
        let shared = distances.iter().filter(|d| **d <= distance + rounding).count() > 1;
        let moved = distance > MOVED * self.contents.size().diagonal;
        Ok(Spot { patch, shared, moved, elements: self.locators.around(patch, element, xi, &x) })
    }

    fn path(&self, text: &str, mut path: Vec<String>, at: SourceSpan) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        if path[0] == "reaction" || path[0] == "reactions" {
            path = self.support(path);
        }
        // a number that some solvers have
        if look_up(self.skeleton, &path).is_some() || path == ["solve", "condition"] {
            return Ok(Prepared::Path(path));
        }
        if let ("area" | "volume", Some(measured)) = (path[0].as_str(), self.measure_of(&path[1..].join("."))) {
            return Ok(measured);
        }
        // results of probes and checks are numbers of the result, too
        if let Some((place, help)) = self.lacks_exact(&path) {
            let help = match self.locators.has_reference() {
                true => format!("the stored run has no multiplier there; {help}"),
                false => help.to_owned(),
            };
            let fault = Diagnostic::error("E062", format!("`{text}` needs `exact` {place}, or `reference` in [model]"));
            return Err(Box::new(fault.at(&self.case.source, at).with_help(help)));
        }
        if let ["error", name @ .., "lambda", "L2"] | ["error", name @ .., "lambda", "L2", "rel"] =
            &path.iter().map(String::as_str).collect::<Vec<_>>()[..]
        {
            let named = name.join(".");
            if let Some(glued) =
                self.case.interfaces.iter().find(|t| t.coupling.value == "glue" && (name.is_empty() || t.name.value == named))
            {
                let text = format!("`{text}`: interface \"{}\" is glued and has no multiplier", glued.name.value);
                return Err(Box::new(self.fault("E018", text, at).with_help("write coupling = \"mortar\" there")));
            }
        }
        if let Some(fault) = self.no_couple(text, &path, at) {
            return Err(fault);
        }
        if let Some(fault) = self.beside(text, &path, at) {
            return Err(fault);
        }
        let fields = self.fields().join(", ");
        let fault = self.suggest(*self.fault("E018", format!("unknown quantity `{text}`"), at), text);
        let heads: Vec<&str> = ["energy", "unknowns", "error", "reaction", "area", "length", "interface", "contact", "balance"].to_vec();
        Err(Box::new(fault.with_help(format!("quantities: {fields} `at {}`; {} ...", POINT[N - 2], heads.join(", ")))))
    }

    /// E018 for a path that leads to no number, with the numbers beside it; `None` where there are none.
    fn beside(&self, text: &str, path: &[String], at: SourceSpan) -> Option<Box<Diagnostic>> {
        let (stem, mut list) = beside(self.skeleton, path)?;
        if let [kind @ ("contact" | "interface"), name, rest @ ..] = &path.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            let (what, components) = match (*kind, self.contents.components()) {
                ("contact", _) => ("pressure", 1),
                (_, n) => ("lambda", n),
            };
            if rest.first().is_none_or(|first| *first == what) {
                let component = if components > 1 { ".x" } else { "" };
                list.insert(0, format!("{kind}.{name}.{what}{component} at {}", POINT[N - 2]));
            }
        }
        let more = if list.len() > NAMED { ", ..." } else { "" };
        list.truncate(NAMED);
        let whole = stem == path.join(".").replacen("reactions.", "reaction.", 1);
        let fault = match whole {
            true => *self.fault("E018", format!("`{text}` is more than one number"), at),
            false => self.suggest(*self.fault("E018", format!("unknown quantity `{text}`"), at), text),
        };
        Some(Box::new(fault.with_help(format!("numbers of {stem}: {}{more}", list.join(", ")))))
    }

    /// E018 for a contact or interface that the case does not have; `None` for other paths.
    pub(super) fn no_couple(&self, text: &str, path: &[String], at: SourceSpan) -> Option<Box<Diagnostic>> {
        let [kind, name, ..] = path else { return None };
        // glued interfaces are in the case alone
        let ties: Vec<&str> = self.case.interfaces.iter().map(|t| t.name.as_str()).collect();
        let contacts: Vec<&str> = self.case.contacts.iter().map(|c| c.name.as_str()).collect();
        let (names, other, others) = match kind.as_str() {
            "contact" => (contacts, "interface", ties),
            "interface" => (ties, "contact", contacts),
            _ => return None,
        };
        if names.contains(&name.as_str()) {
            return None;
        }
        let known = match names.as_slice() {
            [] => format!("the case has no [[{kind}]]"),
            list => format!("{kind}s: {}", list.join(", ")),
        };
        let fault = self.fault("E018", format!("`{text}`: there is no {kind} `{name}`; {known}"), at);
        Some(Box::new(match names.is_empty() {
            _ if others.contains(&name.as_str()) => fault.with_help(format!("that name stands in [[{other}]]: write {other}.{name}")),
            true => fault.with_help("leave it out, or name a quantity of what the case has"),
            false => self.suggest(*fault, text).with_help(format!("write {kind}.NAME with one of these names")),
        }))
    }

    fn fields(&self) -> &'static [&'static str] {
        match (self.contents.components(), N) {
            (1, 2) => &["u", "flux.x", "flux.y"],
            (1, _) => &["u", "flux.x", "flux.y", "flux.z"],
            (_, 2) => &["u.x", "u.y", "u.norm", "stress.xx", "stress.yy", "stress.xy", "strain.xx", "principal.1", "von_mises"],
            _ => &[
                "u.x",
                "u.y",
                "u.z",
                "u.norm",
                "stress.xx",
                "stress.yy",
                "stress.zz",
                "stress.xy",
                "stress.yz",
                "stress.xz",
                "strain.xx",
                "principal.1",
                "von_mises",
            ],
        }
    }

    // block that lacks `exact` for an error that would be known with it, and a help text
    fn lacks_exact(&self, path: &[String]) -> Option<(String, &'static str)> {
        let words: Vec<&str> = path.iter().map(String::as_str).collect();
        let words = words.strip_suffix(&["rel"]).unwrap_or(&words);
        let manufactured = "give a manufactured solution";
        match words {
            ["error", "u", "L2" | "H1" | "energy"] if !self.contents.has_exact() => Some(("in [model]".into(), manufactured)),
            ["error", name @ .., "lambda", "L2"] => {
                let name = name.join(".");
                let tie = self.contents.ties().any(|t| name.is_empty() || t.name() == name);
                let contact = self.contents.contacts().any(|c| name.is_empty() || c.name() == name);
                let block = match (tie, contact) {
                    (true, true) => "[[interface]] or [[contact]]",
                    (true, false) => "[[interface]]",
                    (false, true) => "[[contact]]",
                    (false, false) => return None,
                };
                let named = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
                Some((format!("in {block}{named}, or in [model]"), "write exact = \"..\", the exact multiplier, in that block"))
            }
            _ => None,
        }
    }

    /// Leaves the rate of a known quantity, or of a probe by its name, to studies, also if only `exact` is missing for it.
    fn rate(&self, inner: &str, at: SourceSpan) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        if inner.trim_start().starts_with("rate.") {
            return Err(self.fault("E018", "a rate has no rate".to_owned(), at));
        }
        let probe = self.case.probes.iter().any(|p| p.name.value == inner || format!("probes.{}.value", p.name.value) == inner);
        match if probe { Ok(Prepared::Study) } else { self.prepare(inner, at, false) } {
            Err(fault) if fault.code != "E062" => Err(fault),
            _ => Ok(Prepared::Study),
        }
    }

    // built-in multipliers, and those that the case uses
    fn beta(&self, text: &str, pairing: &str, at: SourceSpan) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let lowered = pairing.strip_prefix("p/p-").is_some_and(|k| k.parse::<usize>().is_ok_and(|k| (1..=12).contains(&k)));
        let ties = self.case.interfaces.iter().map(|t| &t.multiplier.value);
        let mut used = ties.chain(self.case.contacts.iter().map(|c| &c.multiplier.value));
        if lowered
            || matches!(pairing, "auto" | "p/p" | "constant" | "dual")
            || used.any(|m| matches!(m, Multiplier::Named(name) if name == pairing))
        {
            return Ok(Prepared::Study);
        }
        let fault = self.fault("E018", format!("`{text}`: there is no multiplier \"{pairing}\"; write infsup.PAIRING.beta"), at);
        Err(Box::new(fault.with_help("pairings: p/p, p/p-1, p/p-2, p/p-2k, constant, dual")))
    }

    /// Adds the known quantity nearest to the text before `at` and `in` as a suggestion.
    fn suggest(&self, fault: Diagnostic, text: &str) -> Diagnostic {
        let padded = format!("{} ", text.trim());
        let head = [" at ", " at[", " in ", " about "].iter().fold(&*padded, |t, word| t.split(word).next().unwrap_or(t)).trim();
        let named = |list: &[&str], names: &[&str]| -> Vec<String> {
            names.iter().flat_map(|n| list.iter().map(move |form| form.replace("NAME", n))).collect()
        };
        let patches: Vec<&str> = self.contents.bodies().map(|b| b.name()).collect();
        let ties: Vec<&str> = self.contents.ties().map(|t| t.name()).collect();
        let contacts: Vec<&str> = self.contents.contacts().map(|c| c.name()).collect();
        let lambda: &[&str] = if self.contents.components() == 1 {
            &["interface.NAME.lambda"]
        } else {
            &["interface.NAME.lambda.x", "interface.NAME.lambda.y"]
        };
        let mut candidates: Vec<String> = self.fields().iter().map(|f| (*f).to_owned()).collect();
        candidates.extend(["energy", "unknowns"].map(String::from));
        candidates.extend(known(self.skeleton));
        candidates.extend(named(&["area.NAME"], &patches));
        candidates.extend(named(lambda, &ties));
        candidates.extend(named(&["interface.NAME.segments", "interface.NAME.measure"], &ties));
        candidates.extend(named(&["contact.NAME.pressure", "contact.NAME.moment.z"], &contacts));
        // what is wrong stands behind the name
        if candidates.iter().any(|known| known == head) {
            return fault;
        }
        // a name that is far off, if everything else agrees
        let all_but_one = |c: &&String| {
            let (a, b): (Vec<&str>, Vec<&str>) = (head.split('.').collect(), c.split('.').collect());
            a.len() > 1 && a.len() == b.len() && a[0] == b[0] && a.iter().zip(&b).filter(|(x, y)| x != y).count() == 1
        };
        let near = nearest(head, candidates.iter().map(String::as_str));
        match near.or_else(|| candidates.iter().find(all_but_one).map(String::as_str)) {
            Some(near) => fault.with_label(format!("did you mean `{near}`?")),
            None => fault,
        }
    }
}
