//! The files of a run: their names and contents.

use crate::errors::{Diagnostic, Diagnostics};
use crate::plot::{self, FieldPlot, IterationPlot, SidePlot};
use crate::table;
use crate::{Output, RunResult, SideOutput, SidePart};

/// A file to be written.
#[derive(Clone, Debug)]
pub struct OutputFile {
    /// Its name in the folder.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The names of the `.vtu` files of an output, without number and ending: the fields, then the sides.
pub fn stems(output: &Output) -> Vec<String> {
    let fields = (!output.parts.is_empty()).then(|| "fields".to_owned());
    fields.into_iter().chain(output.sides.iter().map(|s| format!("interface_{}", s.name))).collect()
}

/// The contents of the `.vtu` files, in the order of [`stems`].
pub fn vtus(output: &Output) -> impl Iterator<Item = Result<Vec<u8>, String>> {
    let fields = (!output.parts.is_empty()).then(|| output.parts.vtu().map_err(|e| e.to_string()));
    fields.into_iter().chain(output.sides.iter().map(|s| s.part.vtu().map_err(|e| e.to_string())))
}

/// The name of a file of a step.
pub fn numbered(stem: &str, number: usize) -> String {
    format!("{stem}_{number:04}.vtu")
}

/// The files of fields and sides; what cannot be drawn is reported as a warning.
pub fn of(output: &Output, with_vtu: bool, with_pictures: bool, trouble: &mut Diagnostics) -> Vec<OutputFile> {
    let mut files = Vec::new();
    let mut add = |name: String, made: Result<Vec<u8>, String>| match made {
        Ok(bytes) => files.push(OutputFile { name, bytes }),
        Err(why) => trouble.push(Diagnostic::warning("E091", format!("`{name}` was not written: {why}"))),
    };
    if with_vtu && !output.parts.is_empty() {
        add("fields.vtu".to_owned(), output.parts.vtu().map_err(|e| e.to_string()));
    }
    if let Some(picture) = output.picture.as_ref().filter(|_| with_pictures) {
        let range = output.range.as_ref().and_then(|range| range.0());
        let (field, component) = (picture.field.as_str(), picture.component);
        let length = output.units.length.as_str();
        let plot = FieldPlot {
            title: &output.title,
            label: &picture.label,
            field,
            component,
            range,
            length,
            moved: (output.deformed.0)(),
            marks: &output.marks,
        };
        add("fields.svg".to_owned(), output.parts.svg(&plot).map(String::into_bytes).map_err(|e| e.to_string()));
    }
    for side in &output.sides {
        let name = |end: &str| format!("interface_{}.{end}", side.name);
        if with_vtu {
            add(name("vtu"), side.part.vtu().map_err(|e| e.to_string()));
        }
        add(name("csv"), Ok(table::interface_csv(&side.rows).into_bytes()));
        if with_pictures {
            add(name("svg"), picture(output, side).map(String::into_bytes).map_err(|e| e.to_string()));
        }
    }
    files
}

fn picture(output: &Output, side: &SideOutput) -> Result<String, plot::PlotError> {
    let title = match (output.title.is_empty(), side.contact) {
        (true, _) => side.name.clone(),
        (false, true) => format!("{}: pressure on {}", output.title, side.name),
        (false, false) => format!("{}: multiplier on {}", output.title, side.name),
    };
    let length = output.units.length.as_str();
    // lambda of conduction is a flux, whose unit is not known
    let stress = if output.picture.as_ref().is_some_and(|p| p.field == "u") { String::new() } else { output.units.stress() };
    match &side.part {
        SidePart::Curve(part) => {
            let exact = side.exact.as_ref().map(|f| &**f as plot::ExactCurve<'_>);
            let units = [length, stress.as_str()];
            plot::side(&SidePlot { title: &title, contact: side.contact, rows: &side.rows, exact, units }, part)
        }
        SidePart::Surface(part) => {
            let components = part.fields.iter().find(|f| f.name == "lambda").map_or(1, |f| f.components);
            let (label, shown): (_, plot::Shown) = match (side.contact, components) {
                (true, _) => ("pressure", |lambda| -lambda[0]),
                (false, 1) => ("lambda", |lambda| lambda[0]),
                (false, _) => ("|lambda|", |lambda| lambda.iter().map(|l| l * l).sum::<f64>().sqrt()),
            };
            let label = label.to_owned() + &plot::in_unit(&stress);
            plot::surface(
                &FieldPlot { title: &title, label: &label, field: "lambda", component: 0, range: None, length, moved: 0.0, marks: &[] },
                shown,
                part,
            )
        }
    }
}

/// `active_set.svg`; `None` without an iteration of the active set.
pub fn active_set(title: &str, result: &RunResult, trouble: &mut Diagnostics) -> Option<OutputFile> {
    let set = result.solve.as_ref()?.active_set.as_ref().filter(|set| !set.history.is_empty())?;
    let title = if title.is_empty() { "active set".to_owned() } else { format!("{title}: active set") };
    match plot::iteration(&IterationPlot { title: &title, active: &set.history, wrong: &set.wrong, best: set.best }) {
        Ok(svg) => Some(OutputFile { name: "active_set.svg".to_owned(), bytes: svg.into_bytes() }),
        Err(why) => {
            trouble.push(Diagnostic::warning("E091", format!("`active_set.svg` was not written: {why}")));
            None
        }
    }
}
