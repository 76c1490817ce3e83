//! Values on the axes of a study as words: lists, keys with values, degrees.

/// The first value that occurs twice in a list.
pub fn repeated<T: PartialEq>(values: &[T]) -> Option<&T> {
    values.iter().enumerate().find_map(|(k, value)| values[..k].contains(value).then_some(value))
}

/// A key of the case and the values it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vary {
    /// As in `--set`: `patch.lower.degree`.
    pub key: String,
    /// Texts of the values.
    pub values: Vec<String>,
}

impl Vary {
    /// Reads `KEY=v1,v2`; commas inside brackets, braces and quotes belong to a value.
    ///
    /// # Errors
    /// A message.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("`{text}` is not KEY=v1,v2, such as patch.lower.degree=2,3");
        let (key, values) = text.split_once('=').ok_or_else(wrong)?;
        let values = split(values);
        if key.trim().is_empty() || values.is_empty() || values.iter().any(String::is_empty) {
            return Err(wrong());
        }
        if let Some(twice) = repeated(&values) {
            return Err(format!("`{twice}` is named twice for `{}`; write every value once", key.trim()));
        }
        Ok(Self { key: key.trim().to_owned(), values })
    }
}

/// The parts of a list between commas outside brackets, braces, parentheses and quotes, without spaces around them.
pub fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quote) = (vec![String::new()], 0_i32, None);
    for c in text.chars() {
        match (quote, c) {
            (Some(open), _) => quote = (c != open).then_some(open),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth -= 1,
            (None, ',') if depth <= 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().expect("there is a first part").push(c);
    }
    parts.iter().map(|p| p.trim().to_owned()).collect()
}

/// Degrees of all backends, or of single ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Degrees {
    /// For every backend without degrees of its own.
    pub all: Vec<usize>,
    /// Of single backends.
    pub of: Vec<(String, Vec<usize>)>,
}

impl Degrees {
    /// Adds `1,2,3` or `iga:2,3,4`.
    ///
    /// # Errors
    /// A message.
    pub fn add(&mut self, text: &str) -> Result<(), String> {
        let wrong = || format!("`{text}` is no list of degrees, such as 1,2,3 or iga:2,3,4");
        let (backend, list) = match text.split_once(':') {
            Some((backend, list)) => (Some(backend.trim()), list),
            None => (None, text),
        };
        let degrees: Result<Vec<usize>, _> = list.split(',').map(|p| p.trim().parse::<usize>()).collect();
        let degrees = degrees.ok().filter(|list| list.iter().all(|p| (1..=12).contains(p))).ok_or_else(wrong)?;
        if let Some(twice) = repeated(&degrees) {
            return Err(format!("degree {twice} is named twice in `{text}`; write every degree once"));
        }
        match backend {
            None if self.all.is_empty() => self.all = degrees,
            Some(name) if !name.is_empty() && !self.of.iter().any(|(known, _)| known == name) => self.of.push((name.to_owned(), degrees)),
            Some("") => return Err(wrong()),
            _ => {
                return Err(format!(
                    "`{text}` gives degrees a second time; write one list such as 1,2,3, and one per backend such as iga:2,3,4"
                ));
            }
        }
        Ok(())
    }

    /// The degrees of a backend; empty: as written.
    pub(super) fn list(&self, backend: &str) -> &[usize] {
        self.of.iter().find(|(name, _)| name == backend).map_or(&self.all, |(_, list)| list)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn commas_inside_brackets_and_quotes_do_not_separate() {
        assert_eq!(split("2, [3, 2],\"a,b\""), ["2", "[3, 2]", "\"a,b\""]);
        assert_eq!(split("u.y at [1, 0.5] in upper,energy"), ["u.y at [1, 0.5] in upper", "energy"]);
        assert!(Vary::parse("let.a").is_err());
        assert!(Vary::parse("let.a=1,,2").is_err());
        assert!(Vary::parse("let.a=1,2,1").unwrap_err().contains("`1` is named twice"));
    }

    #[test]
    fn degrees_are_of_all_backends_or_of_one() {
        let mut degrees = Degrees::default();
        degrees.add("1,2").unwrap();
        degrees.add("iga:2,3,4").unwrap();
        assert_eq!((degrees.list("fe"), degrees.list("iga")), (&[1, 2][..], &[2, 3, 4][..]));
        for wrong in ["3", "iga:2", ":2", "fe:", "fe:0", "fe:13", "fe:x", "fe:2,2"] {
            assert!(degrees.add(wrong).is_err(), "{wrong}");
        }
    }
}
