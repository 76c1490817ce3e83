//! The files of a run: their names and contents.

use crate::case::Units;
use crate::errors::{Diagnostic, Diagnostics};
use crate::lines;
use crate::plot::{self, FieldPlot, IterationPlot, IterationStep, SidePlot, SlaveCurve, SurfaceQuantity};
use crate::result::{ActiveSetSummary, LineReport, StepReport};
use crate::table;
use crate::{Output, Panel, RunResult, SideOutput, SidePart};

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
    fields.into_iter().chain(pieces(&output.sides).map(|side| format!("interface_{}", side[0].name))).collect()
}

/// The contents of the `.vtu` files, in the order of [`stems`].
pub fn vtus(output: &Output) -> impl Iterator<Item = Result<Vec<u8>, String>> {
    let fields = (!output.parts.is_empty()).then(|| output.parts.vtu().map_err(|e| e.to_string()));
    fields.into_iter().chain(pieces(&output.sides).map(|side| SideOutput::vtu(side).map_err(|e| e.to_string())))
}

/// The pieces of every side.
fn pieces(sides: &[SideOutput]) -> impl Iterator<Item = &[SideOutput]> {
    sides.chunk_by(|a, b| a.name == b.name)
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
    if with_pictures && !output.panels.is_empty() {
        let panels: Result<Vec<String>, _> = output.panels.iter().map(|panel| drawn(output, panel)).collect();
        // one panel is the picture itself
        let made = panels.map(|mut list| if list.len() == 1 { list.remove(0) } else { plot::stacked(&list) });
        add("fields.svg".to_owned(), made.map(String::into_bytes).map_err(|e| e.to_string()));
    }
    for sides in output.sides.chunk_by(|a, b| a.of == b.of) {
        for side in pieces(sides) {
            let name = |end: &str| format!("interface_{}.{end}", side[0].name);
            if with_vtu {
                add(name("vtu"), SideOutput::vtu(side).map_err(|e| e.to_string()));
            }
            add(name("csv"), Ok(table::interface_csv(&SideOutput::table(side)).into_bytes()));
        }
        if with_pictures {
            let made = picture(output, sides).map(String::into_bytes).map_err(|e| e.to_string());
            add(format!("interface_{}.svg", sides[0].of), made);
        }
    }
    files
}

/// A panel of `fields.svg`.
fn drawn(output: &Output, panel: &Panel) -> Result<String, plot::PlotError> {
    match panel {
        Panel::Bodies(picture) => output.parts.svg(&FieldPlot {
            title: &output.title,
            label: &picture.label,
            field: &picture.field,
            component: picture.component,
            range: (picture.range.0)(),
            length: &output.units.length,
            moved: (output.deformed.0)(),
            marks: &output.marks,
            obstacles: &output.obstacles,
        }),
        Panel::Sides(name) => {
            let sides = output.sides.chunk_by(|a, b| a.of == b.of).find(|sides| sides[0].of == *name);
            picture(output, sides.ok_or_else(|| plot::PlotError::Empty(name.clone()))?)
        }
    }
}

/// The picture of all slave sides of an interface or a contact.
fn picture(output: &Output, sides: &[SideOutput]) -> Result<String, plot::PlotError> {
    let (name, contact) = (&sides[0].of, sides[0].contact);
    let title = match (output.title.is_empty(), contact) {
        (true, _) => name.clone(),
        (false, true) => format!("{}: pressure on {name}", output.title),
        (false, false) => format!("{}: multiplier on {name}", output.title),
    };
    let length = output.units.length.as_str();
    // lambda of conduction is a flux, whose unit is not known
    let stress = if output.elastic { output.units.stress() } else { String::new() };
    let curves: Vec<SlaveCurve<'_>> = sides
        .iter()
        .filter_map(|side| {
            let SidePart::Curve(part) = &side.part else { return None };
            let exact = side.exact.as_ref().map(|f| &**f as plot::ExactLambda<'_>);
            Some(SlaveCurve { label: &side.label, part, rows: &side.rows, exact })
        })
        .collect();
    if !curves.is_empty() {
        return plot::side(&SidePlot { title: &title, contact, sides: &curves, units: [length, stress.as_str()] });
    }
    let mut parts = Vec::new();
    for side in sides {
        if let SidePart::Surface(part) = &side.part {
            parts.push(part);
        }
    }
    let components = parts.first().and_then(|part| part.fields.iter().find(|f| f.name == "lambda")).map_or(1, |f| f.components);
    let pictures: Result<Vec<String>, _> = SurfaceQuantity::all(contact, components)
        .iter()
        .map(|shown| {
            let (gap, word) = (*shown == SurfaceQuantity::Gap, shown.label());
            let label = word.to_owned() + &plot::in_unit(if gap { length } else { &stress });
            let title = if gap { format!("{}: gap on {name}", output.title) } else { title.clone() };
            let plot = FieldPlot { title: &title, label: &label, length, ..FieldPlot::default() };
            plot::surface(&plot, *shown, &parts)
        })
        .collect();
    Ok(plot::stacked(&pictures?))
}

/// `active_set.svg`; `None` without an iteration of the active set.
pub fn active_set(title: &str, result: &RunResult, trouble: &mut Diagnostics) -> Option<OutputFile> {
    let of_step = |step: &StepReport| Some((Some(step.t), step.active_set.clone()?));
    let mut sets: Vec<_> = result.steps.iter().filter_map(of_step).collect();
    if result.steps.is_empty() {
        sets.extend(result.solve.as_ref().and_then(|solve| Some((None, solve.active_set.clone()?))));
    }
    let step = |(t, set): &(Option<f64>, ActiveSetSummary)| IterationStep {
        t: *t,
        active: set.history.clone(),
        wrong: set.wrong.clone(),
        best: set.best,
    };
    let steps: Vec<IterationStep> = sets.iter().filter(|(_, set)| !set.history.is_empty()).map(step).collect();
    if steps.is_empty() {
        return None;
    }
    let title = if title.is_empty() { "active set".to_owned() } else { format!("{title}: active set") };
    match plot::iteration(&IterationPlot { title: &title, steps: &steps }) {
        Ok(svg) => Some(OutputFile { name: "active_set.svg".to_owned(), bytes: svg.into_bytes() }),
        Err(why) => {
            trouble.push(Diagnostic::warning("E091", format!("`active_set.svg` was not written: {why}")));
            None
        }
    }
}

/// The files of lines: `title` of the pictures, `runs` with their labels.
pub fn lines(
    (title, units): (&str, &Units),
    runs: &[(String, &[LineReport])],
    with_pictures: bool,
    trouble: &mut Diagnostics,
) -> Vec<OutputFile> {
    let mut files = Vec::new();
    for line in lines::by_name(runs) {
        let Some(name) = line.first().map(|(_, line)| format!("line_{}", line.name)) else { continue };
        files.push(OutputFile { name: format!("{name}.csv"), bytes: lines::csv(&line).into_bytes() });
        if !with_pictures {
            continue;
        }
        match lines::svg(title, units, &line) {
            Ok(svg) => files.push(OutputFile { name: format!("{name}.svg"), bytes: svg.into_bytes() }),
            Err(why) => trouble.push(Diagnostic::warning("E091", format!("`{name}.svg` was not written: {why}"))),
        }
    }
    files
}
