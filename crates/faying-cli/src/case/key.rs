//! A key of a block, as one row of the grammar: the reader, defaults, the effective case, the schema, `explain`, the reference and
//! studies follow from it.

use super::names::{EntryFamily, Names};
use super::tree::Table;
use crate::place::Located;
use std::fmt;

/// A key of a block: its name, its type, its default, its meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Name in case files.
    pub name: &'static str,
    /// Type of its values.
    pub kind: KeyKind,
    /// State of a case without it.
    pub absent: Absent,
    /// Meaning, for `faying explain`, `faying schema` and the reference.
    pub text: &'static str,
    /// Unit of its values, such as "force/area"; empty for pure numbers and words.
    pub unit: &'static str,
    /// Other names of the key.
    pub(crate) aliases: &'static [&'static str],
    /// A symbol of textbooks that is taken for it in messages.
    pub(crate) symbol: Option<&'static str>,
    /// Condition under which it has an effect; `None`: everywhere.
    pub(super) only: Option<Only>,
    /// The axis of studies that sets it.
    pub(crate) axis: Option<Axis>,
}

/// A case without a key; values are texts of TOML.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Absent {
    /// It is an error; with an example of a value.
    Required(&'static str),
    /// It has this value, which the effective case shows.
    Is(&'static str),
    /// It has no value; with an example of one.
    None(&'static str),
}

/// Type of the values of a key.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum KeyKind {
    /// A number.
    Number,
    /// A number above zero.
    Positive,
    /// A whole number from a least to a largest one.
    Whole(i64, i64),
    /// "auto" or a number above zero.
    Auto,
    /// A formula of x, y, z, t.
    Formula,
    /// A number per coordinate.
    Vector,
    /// true or false.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// A text.
    Text,
    /// A type that only blocks of the language have.
    Language(Language),
}

/// Types of the language's own blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct Language(pub(super) Special);

/// See [`Language`].
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Special {
    /// A name of letters, digits, `_` and `-`.
    Name,
    /// A formula of other names than those of space.
    FormulaOf(Uses),
    /// A list of numbers.
    Numbers,
    /// Two increasing numbers.
    Pair,
    /// A formula per component of the unknown.
    Field,
    /// Formulas of some components of the unknown or, `exact`, the word "exact".
    Components { exact: bool },
    /// A number per coordinate, or a table of some.
    SomeCoordinates,
    /// One or several sides.
    Sides,
    /// A text or a list of texts.
    Words,
    /// Name of an entry of the registry, whose keys join the block.
    Entry(EntryFamily),
    /// Name of a multiplier, or its data.
    Multiplier,
    /// A table with these keys.
    Block(&'static [Key]),
    /// `[[name]]`, a list of such tables.
    Blocks(&'static [Key]),
    /// `[name.of]`, such a table per word.
    BlockPer(&'static [&'static str], &'static [Key]),
    /// A table of names.
    Let,
    /// The shape of a patch.
    Geometry,
    /// A rigid obstacle.
    Obstacle,
    /// A type of one key alone: its words, and its JSON Schema.
    Only(&'static str, &'static str),
    /// A key that this version does not have: the values that mean what it does anyway, and a remedy for all others.
    Later(Plain, &'static str),
}

/// Names that a formula may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::case) enum Uses {
    Space,
    Gap,
    Time,
    Check,
}

/// Values of a key that this version does not have which mean what it does anyway.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Plain {
    /// No value.
    Never,
    /// Zero: a number, a formula of constants, or a list or table of them.
    Zero,
    /// The accepted words, and the other words of the language.
    Words(&'static [&'static str], &'static [&'static str]),
}

/// Condition under which a key has an effect; elsewhere its default alone is accepted.
#[derive(Clone, Copy)]
pub(super) struct Only {
    /// Whether it holds in a block, of which the keys that it asks for may be missing.
    pub holds: fn(&Table, &Scene<'_>) -> bool,
    /// The place that the key belongs to: "elasticity".
    pub of: &'static str,
    /// Remedy; may be empty.
    pub instead: &'static str,
}

impl fmt::Debug for Only {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Only").field(&self.of).finish()
    }
}

impl PartialEq for Only {
    fn eq(&self, other: &Self) -> bool {
        self.of == other.of
    }
}

/// Surroundings of a block that its keys may depend on.
pub(super) struct Scene<'a> {
    pub names: &'a Names,
    /// Whether the physics is Poisson's equation.
    pub poisson: bool,
    pub dimension: usize,
    /// Backend of [discretization].
    pub backend: Option<&'a Located<String>>,
    /// Whether patches may hold keys that only other backends have.
    pub any_backend: bool,
}

/// An axis of studies: a key that a row of a study sets in every block where it has an effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Axis {
    /// Backend.
    Backend,
    /// Degree.
    Degree,
    /// Halvings of every element, added to those of the case.
    Level,
    /// Multiplier.
    Pairing,
    /// Integration.
    Integration,
    /// Points beyond the default.
    ExtraPoints,
}

/// A table within a block: nothing, a block of its own, or one of several kinds of block.
pub(super) enum Inside {
    Nothing,
    Block(Vec<Key>),
    Kinds(Vec<(String, Vec<Key>)>),
}

impl Key {
    /// A required key.
    pub const fn new(name: &'static str, kind: KeyKind, text: &'static str) -> Self {
        Self { name, kind, absent: Absent::Required(""), text, unit: "", aliases: &[], symbol: None, only: None, axis: None }
    }

    /// A key of a type of the language's own blocks.
    pub(super) const fn of(name: &'static str, kind: Special, text: &'static str) -> Self {
        Self::new(name, KeyKind::Language(Language(kind)), text)
    }

    /// With a default, a text of TOML: `"1.0"`, `"\"auto\""`.
    #[must_use]
    pub const fn default(mut self, value: &'static str) -> Self {
        self.absent = Absent::Is(value);
        self
    }

    /// Required, with an example of a value, a text of TOML.
    #[must_use]
    pub const fn required(mut self, example: &'static str) -> Self {
        self.absent = Absent::Required(example);
        self
    }

    /// May be left out and has no default; with an example of a value, a text of TOML.
    #[must_use]
    pub const fn optional(mut self, example: &'static str) -> Self {
        self.absent = Absent::None(example);
        self
    }

    /// With the unit of its values.
    #[must_use]
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    pub(super) const fn aliases(mut self, names: &'static [&'static str]) -> Self {
        self.aliases = names;
        self
    }

    pub(super) const fn symbol(mut self, symbol: &'static str) -> Self {
        self.symbol = Some(symbol);
        self
    }

    pub(super) const fn only(mut self, only: Only) -> Self {
        self.only = Some(only);
        self
    }

    pub(super) const fn axis(mut self, axis: Axis) -> Self {
        self.axis = Some(axis);
        self
    }

    /// Whether a case must give it.
    pub(crate) fn is_required(&self) -> bool {
        matches!(self.absent, Absent::Required(_))
    }

    /// Whether this version does not have it.
    pub(super) fn is_later(&self) -> bool {
        matches!(self.special(), Some(Special::Later(..)))
    }

    pub(super) fn special(&self) -> Option<&Special> {
        match &self.kind {
            KeyKind::Language(Language(kind)) => Some(kind),
            _ => None,
        }
    }

    /// An example of the key with a value, in a model of this dimension: `radius = 1.0`.
    pub(super) fn example(&self, dimension: usize) -> String {
        let value = match self.absent {
            Absent::Required("") | Absent::None("") => match self.kind {
                KeyKind::Vector if dimension == 2 => "[0.0, 1.0]",
                KeyKind::Vector => "[0.0, 0.0, 1.0]",
                _ => "1.0",
            },
            Absent::Required(value) | Absent::Is(value) | Absent::None(value) => value,
        };
        match (&self.kind, dimension, value) {
            // examples of the table are those of the plane
            (KeyKind::Vector, 3, "[0, 0]") => format!("{} = [0, 0, 0]", self.name),
            (KeyKind::Vector, 3, "[1, 1]") => format!("{} = [1, 1, 1]", self.name),
            (KeyKind::Vector, 3, "[0, 1]") => format!("{} = [0, 0, 1]", self.name),
            _ => format!("{} = {value}", self.name),
        }
    }
}
