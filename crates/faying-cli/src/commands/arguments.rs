//! Arguments of the command line.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Mortar tying and contact of discretisations that do not match.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "faying",
    version,
    about = "Mortar tying and contact of NURBS and finite element meshes that do not match.",
    after_help = "A first run:  faying new hertz  &&  faying run hertz.toml\n\nExit: 0 done, 1 a check failed, 2 usage, 3 invalid case, 4 reading or writing failed, 5 numerical failure,\n6 a limit was reached, 70 internal error, 130 interrupted.",
    propagate_version = true
)]
pub struct Arguments {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every command.
    #[command(flatten)]
    pub common: Common,
}

/// The commands.
#[derive(Clone, Debug, Subcommand)]
#[non_exhaustive]
pub enum Command {
    /// Solve one case and write its folder of results
    Run(RunArguments),
    /// Validate a case and predict its size and memory; solves nothing
    Check(CheckArguments),
    /// Write a sample case here, never over a file
    New(NewArguments),
    /// Say what an error code means and what to do
    Explain(ExplainArguments),
    /// Several backends in one table
    Compare(CompareArguments),
    /// Refinement study: errors and observed rates, level by level
    Convergence(StudyCommand),
    /// Interface integration study: errors against integration and points
    Quadrature(StudyCommand),
    /// Stability of multiplier pairs: inf-sup constants of slave sides, level by level
    Infsup(InfsupArguments),
    /// One row per value of a key; checks are decided on the case as written
    Sweep(StudyCommand),
    /// Say what is in a mesh, a geometry, a .vtu or a case
    Inspect(InspectArguments),
    /// Convert Gmsh, G+Smo XML, MFEM, VTU and Abaqus files and cases, by the extension of OUT
    Convert(ConvertArguments),
    /// JSON Schema of the case file or of result.json
    Schema(SchemaArguments),
    /// Print the completions of a shell, such as bash: put them where the shell looks for them
    Completions(CompletionsArguments),
    /// Print the manual in roff: faying man | man -l -
    Man,
}

impl Command {
    /// Its name on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Run(_) => "run",
            Self::Check(_) => "check",
            Self::New(_) => "new",
            Self::Compare(_) => "compare",
            Self::Convergence(_) => "convergence",
            Self::Quadrature(_) => "quadrature",
            Self::Infsup(_) => "infsup",
            Self::Sweep(_) => "sweep",
            Self::Inspect(_) => "inspect",
            Self::Convert(_) => "convert",
            Self::Schema(_) => "schema",
            Self::Explain(_) => "explain",
            Self::Completions(_) => "completions",
            Self::Man => "man",
        }
    }

    /// Arguments of the study; `None` for other commands.
    pub fn study(&self) -> Option<&StudyCommand> {
        match self {
            Self::Compare(compare) => Some(&compare.study),
            Self::Infsup(infsup) => Some(&infsup.study),
            Self::Convergence(study) | Self::Quadrature(study) | Self::Sweep(study) => Some(study),
            _ => None,
        }
    }
}

/// `run CASE`.
#[derive(Args, Clone, Debug)]
pub struct RunArguments {
    /// The case file, or - for stdin
    pub case: PathBuf,
    /// Use this backend for every patch: iga, fe
    #[arg(long, value_name = "NAME")]
    pub backend: Option<String>,
    /// Cells of fields.vtu [default: lagrange]
    #[arg(long, value_name = "CELLS")]
    pub vtu: Option<VtuCells>,
    /// Store the last state in FILE: cases with `reference = "FILE"` in [model] measure their errors against it
    #[arg(long, value_name = "FILE")]
    pub save_reference: Option<PathBuf>,
    /// Draw no pictures
    #[arg(long)]
    pub no_pictures: bool,
    /// Print the model in words; solve and write nothing
    #[arg(long, conflicts_with_all = ["save_reference", "watch"])]
    pub dry: bool,
    /// Solve again whenever the case or a file it names changes, and say which probes change; Ctrl-C ends
    #[arg(long)]
    pub watch: bool,
}

/// `completions SHELL`.
#[derive(Args, Clone, Debug)]
pub struct CompletionsArguments {
    /// The shell
    pub shell: clap_complete::Shell,
}

/// `check CASE`.
#[derive(Args, Clone, Debug)]
pub struct CheckArguments {
    /// The case file, or - for stdin
    pub case: PathBuf,
    /// Use this backend for every patch: iga, fe
    #[arg(long, value_name = "NAME")]
    pub backend: Option<String>,
}

/// `inspect FILE`.
#[derive(Args, Clone, Debug)]
pub struct InspectArguments {
    /// The file: G+Smo XML, MFEM mesh, Gmsh MSH, VTU, Abaqus or CalculiX .inp, or a case (.toml, - for stdin)
    pub file: PathBuf,
    /// Draw a picture, in FILE [default: the name of the file with .svg, in the current folder]
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "")]
    pub svg: Option<OsString>,
}

/// `convert IN OUT`.
#[derive(Args, Clone, Debug)]
pub struct ConvertArguments {
    /// The file to read, of any of these formats or an Abaqus or CalculiX .inp, or a case (.toml, - for stdin): its bodies, cut into its elements
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// The file to write: .msh (Gmsh 4.1), .xml (G+Smo), .mesh (MFEM), .vtu
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// Order of the cells that are made of splines, 1 to 4 [default: the degree of the splines, at most 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=4))]
    pub order: Option<u8>,
    /// Write Gmsh files in binary
    #[arg(long)]
    pub binary: bool,
}

/// `new NAME`.
#[derive(Args, Clone, Debug)]
pub struct NewArguments {
    /// Name of the sample
    #[arg(required_unless_present = "list")]
    pub name: Option<String>,
    /// - prints the sample instead of writing a file
    #[arg(value_parser = ["-"], hide_possible_values = true)]
    pub to: Option<String>,
    /// List the samples
    #[arg(long)]
    pub list: bool,
}

/// `explain [WORD]`.
#[derive(Args, Clone, Debug)]
pub struct ExplainArguments {
    /// A code such as E021, a key such as contact.gap, or a quantity such as half_width; none: the list of all codes
    #[arg(value_name = "CODE|KEY|QUANTITY")]
    pub code: Option<String>,
}

/// `schema [result]`.
#[derive(Args, Clone, Debug)]
pub struct SchemaArguments {
    /// Document to describe
    #[arg(value_enum, default_value = "case")]
    pub of: SchemaOf,
}

/// Documents with a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SchemaOf {
    /// The case file, as the JSON that its TOML stands for
    Case,
    /// result.json and the document of --json
    Result,
}

/// `compare CASE`.
#[derive(Args, Clone, Debug)]
pub struct CompareArguments {
    /// Arguments of every study.
    #[command(flatten)]
    pub study: StudyCommand,
    /// Largest relative difference from the first row; beyond it the exit is 1 [default: only a table]
    #[arg(long, value_name = "TOL", value_parser = tolerance)]
    pub tol: Option<f64>,
}

/// `convergence CASE`, `quadrature CASE`, `sweep CASE`.
#[derive(Args, Clone, Debug)]
pub struct StudyCommand {
    /// The case file, or - for stdin
    pub case: PathBuf,
    /// Probes or quantities of the table, separated by commas (repeatable) [default: all probes]
    #[arg(long, value_name = "Q1,Q2")]
    pub quantity: Vec<String>,
    /// Axes of the study.
    #[command(flatten)]
    pub axes: StudyArguments,
}

/// `infsup CASE`.
#[derive(Args, Clone, Debug)]
pub struct InfsupArguments {
    /// Arguments of every study.
    #[command(flatten)]
    pub study: StudyCommand,
    /// Norms of traces and multipliers: l2 for both, or h^-1/2 for traces and h^1/2 for multipliers [default: l2]
    #[arg(long, value_enum, value_name = "NORM")]
    pub norm: Option<NormChoice>,
    /// Ends of slave sides: as the case constrains them, all zero (multipliers lowered), all free [default: case]
    #[arg(long, value_enum, value_name = "ENDS")]
    pub ends: Option<EndsChoice>,
}

/// Norms of the inf-sup test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum NormChoice {
    /// L2 for both spaces
    #[default]
    L2,
    /// h^-1/2 |w| of traces, h^1/2 |mu| of multipliers, h the size of elements
    HHalf,
}

/// Ends of slave sides in the inf-sup test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EndsChoice {
    /// Supports and cross points of the case
    #[default]
    Case,
    /// Traces vanish at both ends
    Zero,
    /// Nothing is constrained
    Free,
}

/// Options of every study.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Options of every study")]
pub struct StudyArguments {
    /// Backends; iga+fe: iga on slave patches, fe elsewhere [default: the case's; compare: iga,fe]
    #[arg(long, value_name = "B1,B2")]
    pub backends: Option<String>,
    /// Number of levels; each halves every element, level 0 is the case as written [default: convergence and infsup 5, quadrature 3, else 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=20))]
    pub levels: Option<u8>,
    /// Degrees: 1,2,3 for all backends, iga:2,3,4 for one (repeatable)
    #[arg(long, value_name = "LIST")]
    pub degrees: Vec<String>,
    /// Values of a key of the case, which is named as in --set (repeatable)
    #[arg(long, value_name = "KEY=V1,V2")]
    pub vary: Vec<String>,
    /// Multipliers of all interfaces and contacts: p/p,p/p-2
    #[arg(long, value_name = "LIST")]
    pub pairings: Option<String>,
    /// Integrations of all interfaces and contacts: merged,slave,mixed [default of quadrature: all]
    #[arg(long, value_name = "LIST")]
    pub integration: Option<String>,
    /// Extra Gauss points per segment, such as 0,1,2 [quadrature: 0,1,2,4,8]
    #[arg(long, value_name = "LIST")]
    pub extra_points: Option<String>,
    /// Keep the rows that an earlier study of the same case in this folder finished
    #[arg(long)]
    pub resume: bool,
}

/// Cells of `fields.vtu`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum VtuCells {
    /// Values at equispaced nodes
    Lagrange,
    /// Exact, rational weights included; values are coefficients
    Bezier,
    /// Straight cells
    Linear,
    /// Linear and quadratic cells that every reader knows; points are shared, with means of what jumps there, and cells have middle values
    Quadratic,
    /// No .vtu files
    None,
}

/// When to colour messages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorChoice {
    /// On a terminal, unless NO_COLOR is set
    #[default]
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

/// Options of every command.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Options of every command")]
pub struct Common {
    /// Folder of the results [default: CASE.out, of a study CASE.COMMAND, in the current folder]
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write into a folder that holds other files; overwrites files of the same name, deletes nothing
    #[arg(long, global = true)]
    pub force: bool,
    /// One JSON document on stdout, or in FILE, instead of the summary on stdout
    #[arg(long, global = true, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    pub json: Option<PathBuf>,
    /// Number of threads [default: one per core]; results do not depend on it. Fewer where the address space is limited
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Change a key of the case, such as patch.lower.degree=3 (repeatable)
    #[arg(long = "set", global = true, value_name = "KEY=VALUE", value_parser = assignment)]
    pub set: Vec<String>,
    /// Memory limit, such as 4GB; a larger run, or one beyond the limits of the process, is refused before it starts
    #[arg(long, global = true, value_name = "SIZE", value_parser = bytes)]
    pub max_memory: Option<u64>,
    /// Longest time in seconds; a factorisation that has begun comes to its end first
    #[arg(long, global = true, value_name = "SECONDS", value_parser = seconds)]
    pub time_limit: Option<f64>,
    /// No summary and no warnings, errors only
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say what happens and how long it takes
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// When to colour messages
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto")]
    pub color: ColorChoice,
}

fn assignment(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, _)) if !key.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("expected KEY=VALUE, such as patch.lower.degree=3".to_owned()),
    }
}

/// A size in bytes: a number with B, kB, MB, GB, TB (powers of 1000) or KiB, MiB, GiB, TiB (powers of 1024).
fn bytes(text: &str) -> Result<u64, String> {
    let wrong = || "expected a size such as 500MB, 4GB or 2GiB".to_owned();
    let text = text.trim();
    let split = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let number: f64 = text[..split].parse().map_err(|_| wrong())?;
    let factor: f64 = match text[split..].trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0f64.powi(2),
        "gib" => 1024.0f64.powi(3),
        "tib" => 1024.0f64.powi(4),
        _ => return Err(wrong()),
    };
    let size = number * factor;
    if size >= 1.0 && size < u64::MAX as f64 { Ok(size as u64) } else { Err(wrong()) }
}

fn tolerance(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|t| *t >= 0.0 && t.is_finite()).ok_or_else(|| "expected a number from 0, such as 1e-8".to_owned())
}

fn seconds(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|s| *s > 0.0 && *s <= 1e9).ok_or_else(|| "expected a number of seconds above 0".to_owned())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_well_formed() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn sizes_have_units() {
        assert_eq!(bytes("4GB"), Ok(4_000_000_000));
        assert_eq!(bytes("1.5 MiB"), Ok(1_572_864));
        assert_eq!(bytes("100"), Ok(100));
        assert!(bytes("-1GB").is_err());
        assert!(bytes("GB").is_err());
        assert!(bytes("4 elephants").is_err());
    }

    #[test]
    fn json_takes_a_file_only_with_an_equals_sign() {
        let json = |words: &[&str]| Arguments::try_parse_from(words).map(|a| a.common.json).unwrap();
        assert_eq!(json(&["faying", "run", "--json", "a.toml"]), Some("-".into()));
        assert_eq!(json(&["faying", "run", "a.toml", "--json=b.json"]), Some("b.json".into()));
        assert_eq!(json(&["faying", "run", "a.toml"]), None);
    }
}
