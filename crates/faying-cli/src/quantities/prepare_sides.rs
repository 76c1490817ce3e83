//! Quantities of sides, prepared: their measure and force, reactions, lambda and pressure on slave sides.

use super::grammar::At;
use super::prepare::{OFF, Prepared, Preparer, SideSpot};
use crate::case::canonical;
use crate::errors::Diagnostic;
use crate::place::SourceSpan;
use faying::geometry::ClosestPoint;
use faying::linalg::Vector;
use faying::problem::InterfaceView;

impl<const S: usize, const N: usize> Preparer<'_, S, N> {
    pub(super) fn side_measure(&self, text: &str, side: &str, at: SourceSpan) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let sides = self.case.find_sides(side);
        if !sides.is_empty() {
            let mut sum = 0.0;
            for s in &sides {
                let p = self.contents.body(s.patch);
                let trace = p.body().trace(&s.side);
                let trace = trace.map_err(|e| self.fault("E021", format!("`{text}`: patch \"{}\": {e}", p.name()), at))?;
                sum += p.side_measure(&trace);
            }
            return Ok(Prepared::Number(sum));
        }
        if let Some(measured) = self.measure_of(side).filter(|_| !text.trim_start().starts_with("length")) {
            return Ok(measured);
        }
        for p in self.contents.bodies() {
            if let Some(rest) = side.strip_prefix(&format!("{}.", p.name())) {
                return match p.body().trace(canonical(rest, N).unwrap_or(rest)) {
                    Ok(trace) => Ok(Prepared::Number(p.side_measure(&trace))),
                    Err(e) => Err(self.fault("E021", format!("`{text}`: patch \"{}\": {e}", p.name()), at)),
                };
            }
        }
        let name = side.split('.').next().unwrap_or(side);
        self.patch(name, at)?;
        Err(self.fault("E018", format!("`{text}` is no quantity; write length.PATCH.SIDE"), at))
    }

    /// The area (volume in 3D) of the patches that a name stands for.
    pub(super) fn measure_of(&self, name: &str) -> Option<Prepared<S, N>> {
        let patches = self.case.find_patches(name);
        let of = |k: &usize| self.contents.body(*k).measure();
        (!patches.is_empty()).then(|| Prepared::Number(patches.iter().map(of).sum()))
    }

    /// The force of the stresses on a side, or the flux through it.
    pub(super) fn side_force(
        &self,
        text: &str,
        side: &str,
        component: Option<usize>,
        at: SourceSpan,
    ) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let component = match (component, self.contents.components()) {
            (None, 1) => 0,
            (Some(c), n) if n > 1 && c < n => c,
            (None, _) => {
                let side = side.strip_suffix(".moment").unwrap_or(side);
                let fault = self.fault("E018", format!("`{text}`: a force has components; write force.{side}.x"), at);
                let help = "moments are those of ties (interface.NAME.moment), contacts (contact.NAME.moment), loads (loads.NAME.moment) and of cuts in the plane";
                return Err(Box::new(fault.with_help(help)));
            }
            (_, n) => {
                let known = if n == 1 { format!("force.{side}") } else { format!("force.{side}.x to .{}", ["x", "y", "z"][n - 1]) };
                let fault = self.fault("E018", format!("`{text}`: there is no such component"), at);
                return Err(Box::new(fault.with_help(format!("write {known}"))));
            }
        };
        // what is wrong with the name is said where its measure is asked for
        self.side_measure(text, side, at)?;
        let named = self.case.find_sides(side);
        if !named.is_empty() {
            return Ok(Prepared::SideForce(named.into_iter().map(|s| (s.patch, s.side)).collect(), component));
        }
        let own = |(k, name): (usize, &str)| {
            let rest = side.strip_prefix(name)?.strip_prefix('.')?;
            Some((k, canonical(rest, N).unwrap_or(rest).to_owned()))
        };
        match self.contents.bodies().enumerate().find_map(|(k, body)| own((k, body.name()))) {
            Some(found) => Ok(Prepared::SideForce(vec![found], component)),
            None => Err(self.fault("E018", format!("`{text}` is no quantity; write force.PATCH.SIDE.x"), at)),
        }
    }

    /// Converts `reaction.PATCH.SIDE.c` to the label used in the result, for any alias.
    pub(super) fn support(&self, path: Vec<String>) -> Vec<String> {
        let found = |label: &str, rest: &[String]| {
            let mut out = vec!["reactions".to_string(), label.to_owned()];
            out.extend_from_slice(rest);
            if self.contents.components() == 1 && out.len() == 2 {
                out.push("0".into());
            }
            out
        };
        // the component may be left out in Poisson problems
        for end in [path.len() - 1, path.len()] {
            if end < 2 {
                continue;
            }
            let [wanted] = &self.case.find_sides(&path[1..end].join("."))[..] else { continue };
            let mut supports = self.contents.supports().filter(|s| s.is_side && s.body == wanted.patch && s.name == wanted.side);
            // several parts of one side are distinguished by their labels only
            if let (Some(support), None) = (supports.next(), supports.next()) {
                return found(support.label, &path[end..]);
            }
        }
        // edges and corners
        for (k, p) in self.contents.bodies().enumerate() {
            let n = p.name().split('.').count();
            if path.len() < n + 2 || path[1..=n].join(".") != p.name() {
                continue;
            }
            if let Some(support) = self.contents.supports().find(|s| !s.is_side && s.body == k && s.name == path[n + 1]) {
                return found(support.label, &path[n + 2..]);
            }
        }
        path
    }

    pub(super) fn lambda(
        &self,
        text: &str,
        name: &str,
        component: Option<usize>,
        place: &At,
        at: SourceSpan,
    ) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let component = match (component, self.contents.components()) {
            (None, 1) => 0,
            (Some(c), n) if n > 1 && c < n => c,
            (None, _) => return Err(self.fault("E018", format!("`{text}`: lambda has components; write interface.{name}.lambda.x"), at)),
            _ => return Err(self.fault("E018", format!("`{text}`: lambda has no such component"), at)),
        };
        let x = self.point(text, place, at)?;
        let Some(tie) = self.contents.ties().find(|t| t.name() == name) else {
            return Err(self.fault("E018", format!("`{text}`: there is no interface \"{name}\""), at));
        };
        Ok(Prepared::Lambda(self.on_sides(text, &tie, &x, at)?, component))
    }

    pub(super) fn pressure(
        &self,
        text: &str,
        name: &str,
        pressure: bool,
        place: &At,
        at: SourceSpan,
    ) -> Result<Prepared<S, N>, Box<Diagnostic>> {
        let Some(contact) = self.contents.contacts().find(|c| c.name() == name) else {
            let kind = text.trim_start().split('.').next().unwrap_or_default().to_owned();
            return match self.no_couple(text, &[kind, name.to_owned()], at) {
                Some(fault) => Err(fault),
                None => Err(self.fault("E018", format!("`{text}`: contacts have a pressure, interfaces lambda"), at)),
            };
        };
        let x = self.point(text, place, at)?;
        Ok(Prepared::Pressure(self.on_sides(text, &contact, &x, at)?, pressure))
    }

    fn on_sides(&self, text: &str, of: &InterfaceView<'_, S, N>, x: &Vector<N>, at: SourceSpan) -> Result<SideSpot<S>, Box<Diagnostic>> {
        let mut best: Option<(f64, SideSpot<S>)> = None;
        for (number, slave) in of.sides().into_iter().enumerate() {
            let space = slave.side().trace().space.clone();
            let Some(p) = ClosestPoint::new(space.clone()).project(x) else { continue };
            if p.distance <= OFF * space.bounds(p.element).diagonal() && best.as_ref().is_none_or(|b| p.distance < b.0) {
                best = Some((p.distance, SideSpot { of: of.id(), side: number, element: p.element, xi: p.xi }));
            }
        }
        best.map(|(_, spot)| spot).ok_or_else(|| {
            let fault = self.fault("E022", format!("`{text}`: the point is not on the slave side"), at);
            Box::new(fault.with_help("move the point onto the slave side, to within a quarter of an element"))
        })
    }
}
