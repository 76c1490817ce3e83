//! The axes of a study: from the command line, else from `[study.NAME]`, else the defaults of the command.

use super::arguments::StudyArguments;
use super::case::Loaded;
use super::ended::Exit;
use super::study::StudyKind;
use crate::case::{Names, StudyValues};
use crate::errors::{Diagnostic, nearest};
use crate::place::Located;
use crate::registry::is_glue;
use crate::studies::{Axes, Degrees, Vary, repeated, split};

/// Most points beyond the default, as in the case file.
const MOST_POINTS: usize = 60;

/// Sources of the values of axes, for reading them and for messages.
struct Reader<'a> {
    kind: &'a StudyKind,
    table: Option<&'a Located<StudyValues>>,
    loaded: &'a Loaded,
}

/// Values of an axis, and whether the case file has them.
struct Values {
    list: Vec<String>,
    of_case: bool,
}

/// The axes of `kind`.
///
/// # Errors
/// Usage (exit 2) for values of the command line, E015 for those of the case; E063 if an interface is missing.
pub fn axes(kind: &StudyKind, options: &StudyArguments, table: Option<&Located<StudyValues>>, loaded: &Loaded) -> Result<Axes, Exit> {
    let r = Reader { kind, table, loaded };
    let none = StudyValues::default();
    let values = table.map_or(&none, |t| &t.value);
    let words = |list: &[&str]| list.iter().map(|w| (*w).to_owned()).collect::<Vec<_>>();

    let backends = r.list("backends", options.backends.as_deref(), &values.backends, words(kind.backends))?;
    for backend in &backends.list {
        let (slave, master) = backend.split_once('+').unwrap_or((backend, backend));
        for name in [slave, master] {
            r.known("backends", &backends, "backend", name, &r.names().backends)?;
        }
    }
    let pairings = r.list("pairings", options.pairings.as_deref(), &values.pairings, Vec::new())?;
    for text in pairings.list.iter().filter(|name| name.starts_with('{')) {
        if toml::from_str::<toml::Table>(&format!("multiplier = {text}")).is_err() {
            let why = format!("`{text}` is no table");
            return Err(r.wrong("pairings", pairings.of_case, &why, "write for example '{ degree = 1, continuity = 0, ends = \"full\" }'"));
        }
    }
    for name in pairings.list.iter().filter(|name| !name.starts_with('{') && !r.names().has_multiplier(name)) {
        r.known("pairings", &pairings, "multiplier", name, &r.names().multipliers)?;
    }
    // the default leaves out `mixed` if the case cannot have it; given values stay
    let no_mixed = loaded.case.interfaces.iter().any(|t| !is_glue(&t.coupling.value) && !r.names().has_rows(&t.coupling.value))
        || loaded.case.contacts.iter().any(|c| !c.needs.mixed)
        || loaded.case.model.dimension.value == 3;
    let has = |word: &str| word != "mixed" || !no_mixed;
    let usual: Vec<&str> = kind.integrations.iter().copied().filter(|word| has(word)).collect();
    let integrations = r.list("integration", options.integration.as_deref(), &values.integration, words(&usual))?;
    for name in &integrations.list {
        r.known("integration", &integrations, "integration", name, &r.names().integrations)?;
    }
    let extra_points = r.extra_points(options.extra_points.as_deref(), &values.extra_points)?;
    let degrees = r.degrees(&options.degrees, &values.degrees)?;
    let (given, of_case) = if options.vary.is_empty() { (&values.vary, true) } else { (&options.vary, false) };
    let vary: Result<Vec<Vary>, String> = given.iter().map(|text| Vary::parse(text)).collect();
    let example = "write for example --vary material.steel.poisson=0.2,0.3";
    let vary = vary.map_err(|why| r.wrong("vary", of_case, &why, example))?;
    if let Some(twice) = repeated(&vary.iter().map(|v| v.key.as_str()).collect::<Vec<_>>()) {
        return Err(r.wrong("vary", of_case, &format!("`{twice}` varies twice"), "name a key once, with all its values"));
    }
    let axes = [
        ("degrees", "degree", !degrees.all.is_empty() || !degrees.of.is_empty()),
        ("backends", "backend", !backends.list.is_empty()),
        ("pairings", "multiplier", !pairings.list.is_empty()),
        ("integration", "integration", !integrations.list.is_empty()),
        ("extra-points", "extra_points", !extra_points.is_empty()),
    ];
    for v in &vary {
        let key = v.key.rsplit('.').next().unwrap_or_default();
        if let Some((axis, ..)) = axes.iter().find(|(_, word, varies)| *varies && *word == key) {
            let why = format!("`{}` varies already by --{axis}, which sets it everywhere", v.key);
            return Err(r.wrong("vary", of_case, &why, &format!("leave one of them out: --vary {}=.. or --{axis}", v.key)));
        }
    }
    if kind.needs_vary && vary.is_empty() {
        let message = format!("`faying {}` has a row per value of a key, and no key is named", kind.command);
        return Err(super::ended::usage(&message, Some("name one, such as --vary material.steel.poisson=0.2,0.3 or --vary let.F=1,2,4")));
    }
    let levels = options.levels.map(usize::from).or(values.levels).unwrap_or(kind.levels);
    let sides = !(pairings.list.is_empty() && integrations.list.is_empty() && extra_points.is_empty());
    let couples_vary = vary.iter().any(|v| v.key.ends_with(".coupling") || v.key.ends_with(".method"));
    r.interface(sides || kind.needs_interface, couples_vary)?;
    r.multiplier(!pairings.list.is_empty() && !couples_vary)?;
    Ok(Axes {
        backends: backends.list,
        as_written: kind.compares,
        degrees,
        pairings: pairings.list,
        integrations: integrations.list,
        extra_points,
        levels,
        vary,
    })
}

impl Reader<'_> {
    fn names(&self) -> &Names {
        &self.loaded.options.names
    }

    /// The values of an axis, each once.
    fn list(&self, axis: &str, option: Option<&str>, table: &[String], default: Vec<String>) -> Result<Values, Exit> {
        let values = match option {
            Some(text) => Values { list: split(text).into_iter().filter(|word| !word.is_empty()).collect(), of_case: false },
            None if !table.is_empty() => Values { list: table.to_vec(), of_case: true },
            None => Values { list: default, of_case: false },
        };
        if option.is_some() && values.list.is_empty() {
            return Err(self.wrong(axis, false, "no value is named", &format!("name some, separated by commas, or leave --{axis} out")));
        }
        if let Some(twice) = repeated(&values.list) {
            return Err(self.wrong(axis, values.of_case, &format!("`{twice}` is named twice"), "name every value once"));
        }
        Ok(values)
    }

    /// The numbers of points beyond the default.
    fn extra_points(&self, option: Option<&str>, table: &[usize]) -> Result<Vec<usize>, Exit> {
        let numbers = |list: &[usize]| list.iter().map(usize::to_string).collect::<Vec<_>>();
        let points = self.list("extra-points", option, &numbers(table), numbers(self.kind.extra_points))?;
        let numbers = points.list.iter().map(|text| match text.parse::<usize>() {
            Ok(n) if n <= MOST_POINTS => Ok(n),
            _ => {
                let why = format!("`{text}` is no number of points, a whole number from 0 to {MOST_POINTS}");
                Err(self.wrong("extra-points", points.of_case, &why, "write for example --extra-points 0,1,2,4"))
            }
        });
        numbers.collect()
    }

    /// The degrees, of all backends and of single ones.
    fn degrees(&self, options: &[String], table: &[String]) -> Result<Degrees, Exit> {
        let (given, of_case) = if options.is_empty() { (table, true) } else { (options, false) };
        let mut degrees = Degrees::default();
        for text in given {
            let example = "write for example --degrees 1,2,3 --degrees iga:2,3,4";
            degrees.add(text).map_err(|why| self.wrong("degrees", of_case, &why, example))?;
        }
        for (name, _) in &degrees.of {
            self.known("degrees", &Values { list: Vec::new(), of_case }, "backend", name, &self.names().backends)?;
        }
        Ok(degrees)
    }

    /// Checks that `name` is one of `known`.
    fn known(&self, axis: &str, values: &Values, what: &str, name: &str, known: &[String]) -> Result<(), Exit> {
        if known.iter().any(|k| k == name) {
            return Ok(());
        }
        let near = nearest(name, known.iter().map(String::as_str)).map_or(String::new(), |near| format!("; did you mean `{near}`?"));
        let help = format!("known: {}", known.join(", "));
        Err(self.wrong(axis, values.of_case, &format!("unknown {what} `{name}`{near}"), &help))
    }

    /// Error in an axis of the command line, or of the table of the case.
    fn wrong(&self, axis: &str, of_case: bool, why: &str, help: &str) -> Exit {
        match self.table.filter(|_| of_case) {
            Some(table) => {
                let key = axis.replace('-', "_");
                let fault = Diagnostic::error("E015", format!("`{key}` of [study.{}]: {why}", self.kind.command)).with_help(help);
                self.loaded.case.diagnostic(fault, table.at).into()
            }
            None => super::ended::usage(&format!("--{axis}: {why}"), Some(help)),
        }
    }

    /// E063 if the axes need an interface and the case has neither one that is integrated over, nor a contact.
    fn interface(&self, needed: bool, couples_vary: bool) -> Result<(), Exit> {
        let case = &self.loaded.case;
        // sides that share their functions have no integrals
        let is_integrated = case.interfaces.iter().any(|t| couples_vary || t.coupling.value != "glue") || !case.contacts.is_empty();
        if !needed || is_integrated {
            return Ok(());
        }
        let what = if self.kind.needs_interface { self.kind.command } else { "a study of multipliers and integration" };
        let fault = Diagnostic::error(
            "E063",
            format!(
                "{what} needs an interface or a contact, and the case has {}",
                if case.interfaces.is_empty() { "none" } else { "only glued sides" }
            ),
        );
        Err(fault
            .with_help("add [[interface]] with slave and master; glued sides are not integrated over")
            .in_file(&self.loaded.name)
            .into())
    }

    /// E063 if the axes need a multiplier and no interface or contact of the case has one.
    fn multiplier(&self, needed: bool) -> Result<(), Exit> {
        let case = &self.loaded.case;
        let ties = case.interfaces.iter().map(|t| self.names().has_rows(&t.coupling.value));
        let contacts = case.contacts.iter().map(|c| c.needs.multiplier);
        if !needed || ties.chain(contacts).any(|has_one| has_one) {
            return Ok(());
        }
        let fault =
            Diagnostic::error("E063", "a study of multipliers needs an interface or a contact with a multiplier, and the case has none");
        let help = "leave the pairings out, or write coupling = \"mortar\" or \"penalty\"";
        Err(fault.with_help(help).in_file(&self.loaded.name).into())
    }
}
