//! A model in words, for a second pair of eyes: bodies, materials, what acts on which side, what is joined and why, the size of the system.

use crate::case::{Boundary, Case, Components, Datum, Elastic, Master, Material, Multiplier, Physics, SideRef};
use crate::formula::Formula;
use crate::lower::{LoweredCase, side_names};
use crate::place::Located;
use crate::result::{LoadReport, Moment, RunResult};
use crate::text_format::{bytes, component_name, short};
use faying::physics::Assumption;
use faying::problem::{InterfaceView, SideView};
use faying::space::measure;
use std::fmt::Write as _;

/// Returns the lines on a model that is built and not solved; `result` has its measures, loads and forecast.
pub fn of<const S: usize, const N: usize>(case: &Case, built: &LoweredCase<S, N>, result: &RunResult) -> String {
    let model = Words { case, built, result };
    let units = case.units.words();
    let units = if units.is_empty() { units } else { units + "\n" };
    let mut text = format!("{}\n{}\n{units}\nBodies\n", model.heading(), equation(case));
    model.bodies(&mut text);
    text += "\nMaterials\n";
    // writing to a String cannot fail
    for (k, material) in case.materials.iter().enumerate() {
        let of = case.patches.iter().filter(|p| p.material.value == k).map(|p| p.name.value.as_str()).collect::<Vec<_>>();
        let of = if of.is_empty() { "no body".to_owned() } else { of.join(", ") };
        let _ = writeln!(text, "  {}: {}; of {of}", material.name.value, constants(material, case.model.physics.value));
    }
    text += "\nSupports and loads\n";
    model.boundaries(&mut text);
    model.joints(&mut text);
    model.demand(&mut text);
    text
}

/// Equation, assumption and steps of a case in words.
pub fn equation(case: &Case) -> String {
    let (model, plane) = (&case.model, case.model.dimension.value == 2);
    let what = match (model.physics.value, model.assumption.value) {
        (Physics::Poisson, Assumption::Axisymmetric) => "Poisson's equation in bodies of revolution (x the radius, y the axis)",
        (Physics::Poisson, _) if plane => "Poisson's equation in the plane",
        (Physics::Poisson, _) => "Poisson's equation in space",
        (Physics::Elasticity, Assumption::Axisymmetric) => {
            "Elasticity of bodies of revolution (x the radius, y the axis), small displacements"
        }
        (Physics::Elasticity, Assumption::PlaneStress) => "Elasticity in plane stress, small displacements, forces per unit thickness",
        (Physics::Elasticity, _) if plane => "Elasticity in plane strain, small displacements, forces per unit thickness",
        (Physics::Elasticity, _) => "Elasticity in space, small displacements",
    };
    let when = match case.steps.value.as_slice() {
        [first, .., last] => format!("{} steps from t = {} to t = {}", case.steps.value.len(), short(*first), short(*last)),
        list => format!("one step, t = {}", short(list.first().copied().unwrap_or(1.0))),
    };
    let exact = if case.exact_at().is_some() { "; an exact solution is given" } else { "" };
    format!("{what}; {when}{exact}")
}

/// A model that is described.
struct Words<'a, const S: usize, const N: usize> {
    case: &'a Case,
    built: &'a LoweredCase<S, N>,
    result: &'a RunResult,
}

impl<const S: usize, const N: usize> Words<'_, S, N> {
    fn heading(&self) -> String {
        match self.case.title.value.as_str() {
            "" => self.result.case.clone(),
            title => format!("{}: {title}", self.result.case),
        }
    }

    fn bodies(&self, text: &mut String) {
        let word = if N == 2 { "area" } else { "volume" };
        for (patch, body) in self.case.patches.iter().zip(self.built.system.contents().bodies()) {
            let d = &patch.discretization;
            let mut degrees: Vec<String> = d.degree.value.iter().map(usize::to_string).collect();
            degrees.dedup();
            let material = self.case.materials.get(patch.material.value).map_or("", |m| m.name.as_str());
            let _ = writeln!(
                text,
                "  {}: {}; {} elements of {} of degree {}, {} unknowns; {word} {}; material {material}",
                body.name(),
                patch.geometry.shape.kind(),
                body.space().num_elements(),
                body.backend(),
                degrees.join(" x "),
                body.unknowns().len(),
                short(body.measure())
            );
        }
        for load in self.result.loads.iter().filter(|(name, _)| self.case.boundaries.iter().all(|b| b.name.value != **name)) {
            let _ = writeln!(text, "  {}: {}", load.0, resultant(load.1));
        }
    }

    /// Label of a side of the case: the patch and the body's own word for the side.
    fn label(&self, side: &SideRef) -> String {
        format!("{}.{}", self.case.patches[side.patch].name.value, side_names(self.case, side.patch)(&side.side))
    }

    fn boundaries(&self, text: &mut String) {
        for block in &self.case.boundaries {
            let open =
                |side: &&Located<SideRef>| !block.all_outer || self.built.free_measures.get(&side.value).is_none_or(|free| *free > 0.0);
            let sides: Vec<&SideRef> = block.on.iter().filter(open).map(|side| &side.value).collect();
            let names = sides.iter().map(|side| self.label(side) + &self.extent(side, block)).collect::<Vec<_>>().join(", ");
            let part = block.filter.as_ref().map_or_else(String::new, |f| format!(" where {}", f.value.text()));
            let acts = conditions(block, self.case.model.components());
            let load = self.result.loads.get(&block.name.value).map_or_else(String::new, |load| format!("; {}", resultant(load)));
            let _ = writeln!(text, "  {} on {names}{part}: {}{load}", block.name.value, acts.join(", "));
        }
        let held = self.built.system.contents().supports().count();
        let _ = match held {
            0 => writeln!(text, "  nothing is held by a support"),
            _ => writeln!(text, "  {held} sides, edges or corners are held"),
        };
    }

    /// " (length 0.5)" of a whole side.
    fn extent(&self, side: &SideRef, block: &Boundary) -> String {
        let body = self.built.system.contents().body(side.patch);
        match body.body().trace(&side.side) {
            Ok(trace) if block.filter.is_none() => {
                let free = self.built.free_measures.get(side).filter(|_| block.all_outer);
                let measure = free.copied().unwrap_or_else(|| body.side_measure(&trace));
                format!(" ({} {})", if S == 1 { "length" } else { "area" }, short(measure))
            }
            _ => String::new(),
        }
    }

    fn joints(&self, text: &mut String) {
        let contents = self.built.system.contents();
        if self.case.interfaces.is_empty() && self.case.contacts.is_empty() {
            text.push_str("\nNothing is tied, and no contact is looked for.\n");
            return;
        }
        text.push_str("\nInterfaces and contacts\n");
        for glued in &self.result.geometry.glued {
            let _ = writeln!(
                text,
                "  interface {}: {} and {} share their unknowns (glue)",
                glued.interface, glued.sides.slave, glued.sides.master
            );
        }
        for tie in contents.ties() {
            let Some(read) = self.case.interfaces.iter().find(|t| t.name.value == tie.name()) else { continue };
            let why =
                if read.between.is_some() { "found by `between`: they touch, the finer one is slave" } else { "as the case names them" };
            let of =
                format!("{}, multiplier {}, integration {}", read.coupling.value, word(&read.multiplier.value), read.integration.value);
            self.slaves(text, "interface", &tie, why, &of);
        }
        for (contact, read) in contents.contacts().zip(&self.case.contacts) {
            let multiplier = if read.needs.multiplier { format!(", multiplier {}", word(&read.multiplier.value)) } else { String::new() };
            let against = match &read.master {
                Master::Rigid(obstacle) => format!("as the case names it, against a rigid {}", obstacle.value.shape.value.kind()),
                Master::Sides(_) => "as the case names them".to_owned(),
            };
            let of =
                format!("method {}{multiplier}, integration {}, gap {}", read.method.value, read.integration.value, read.gap.value.text());
            self.slaves(text, "contact", &contact, &against, &of);
        }
    }

    fn slaves(&self, text: &mut String, kind: &str, of: &InterfaceView<'_, S, N>, why: &str, how: &str) {
        let _ = writeln!(text, "  {kind} {} ({why}): {how}", of.name());
        for slave in of.sides() {
            let _ = writeln!(text, "    slave {}, {} rows", grid(slave.side()), slave.rows().len());
            for pair in slave.pairs() {
                let (covered, whole) = (pair.covered(), pair.slave_measure());
                let share = if whole > 0.0 { short(100.0 * covered / whole) } else { "0".to_owned() };
                let apart = short(pair.distance());
                let _ = writeln!(text, "      master {}: faces {share} % of the slave, at most {apart} apart", grid(pair.master()));
            }
        }
    }

    fn demand(&self, text: &mut String) {
        let (case, u) = (self.case, &self.result.unknowns);
        let memory = self.result.predicted.map_or_else(String::new, |p| format!("; about {} of memory", bytes(p.memory)));
        let _ = write!(
            text,
            "\nForecast: {} unknowns, {} multipliers{memory}.\nProbes: {}, checks: {}.\nNothing was solved, nothing written.\n",
            u.primal,
            u.multipliers,
            case.probes.len(),
            case.checks.len()
        );
    }
}

/// "a.top (12 elements, 0.083 each on average)".
fn grid<const S: usize, const N: usize>(side: &SideView<S, N>) -> String {
    let space = &side.trace().space;
    let (n, whole) = (space.num_elements(), measure(&**space));
    format!("{} ({n} elements, {} each on average)", side.label(), short(whole / n.max(1) as f64))
}

fn word(multiplier: &Multiplier) -> String {
    match multiplier {
        Multiplier::Named(name) => name.clone(),
        Multiplier::Data { degree, .. } => format!("of degree {degree}"),
    }
}

/// Constants of a material as they are written.
fn constants(material: &Material, physics: Physics) -> String {
    let mut list = match (&material.law, &material.elastic) {
        (Some(law), _) => vec![format!("law {}", law.name)],
        (None, Some(Elastic::YoungPoisson(e, nu))) => vec![format!("young {}", e.value.text()), format!("poisson {}", nu.value.text())],
        (None, Some(Elastic::Lame(lambda, mu))) => vec![format!("lambda {}", lambda.value.text()), format!("mu {}", mu.value.text())],
        (None, None) if physics == Physics::Poisson => vec![format!("conductivity {}", material.conductivity.value.text())],
        (None, None) => Vec::new(),
    };
    list.extend(material.density.as_ref().map(|d| format!("density {}", d.value.text())));
    list.join(", ")
}

/// Conditions and loads of a block, in its own words.
fn conditions(block: &Boundary, components: usize) -> Vec<String> {
    let datum = |d: &Datum| match d {
        Datum::Exact => "exact".to_owned(),
        Datum::Formula(f) => f.text(),
    };
    let each = |what: &str, list: &[Option<String>]| -> Option<String> {
        let given = list.iter().enumerate().filter_map(|(k, v)| Some(format!("{} = {}", component_name(k, components), v.as_ref()?)));
        let given: Vec<String> = given.collect();
        (!given.is_empty()).then(|| format!("{what} {}", given.join(", ")))
    };
    let data = |list: &Components<Datum>| list.iter().map(|d| d.as_ref().map(|d| datum(&d.value))).collect::<Vec<_>>();
    let formulas = |list: &Components<Formula>| list.iter().map(|f| f.as_ref().map(|f| f.value.text())).collect::<Vec<_>>();
    let flux = if components == 1 { "flux" } else { "traction" };
    let mut acts: Vec<String> = Vec::new();
    acts.extend(each("prescribed", &data(&block.dirichlet)));
    acts.extend(block.fix_normal.as_ref().map(|_| "held along its normal".to_owned()));
    acts.extend(block.fix_tangential.as_ref().map(|_| "held along its tangents".to_owned()));
    acts.extend(each(flux, &data(&block.traction)));
    acts.extend(block.pressure.as_ref().map(|p| format!("pressure {}", p.value.text())));
    acts.extend(each("force", &formulas(&block.force)));
    acts.extend(each("springs", &formulas(&block.spring)));
    acts.extend(each("moves as one under the force", &formulas(&block.rigid_force)));
    acts
}

/// "resultant (0, -1), moment -0.5".
fn resultant(load: &LoadReport) -> String {
    let list = |values: &[f64]| match values {
        [one] => short(*one),
        many => format!("({})", many.iter().map(|v| short(*v)).collect::<Vec<_>>().join(", ")),
    };
    let moment = match &load.moment {
        None => String::new(),
        Some(Moment::Plane(m)) => format!(", moment {}", short(*m)),
        Some(Moment::Space(m)) => format!(", moment {}", list(m)),
    };
    format!("resultant {}{moment}", list(&load.force))
}
