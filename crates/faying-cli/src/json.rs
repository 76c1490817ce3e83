//! The JSON text of results: 17 significant digits, `null` with a reason for numbers that are not finite.

use serde::Serialize;
use serde_json::Value;
use serde_json::ser::{Formatter, Serializer};
use std::io::{self, Write};

/// Lists in which `null` means "none there", not a lost number.
const WORDS: [&str; 2] = ["warnings", "diagnostics"];

/// Adds `reason` to every object that holds a `null`, itself or in a list; diagnostics are left alone.
pub fn add_reasons(value: &mut Value) {
    match value {
        Value::Array(items) => items.iter_mut().for_each(add_reasons),
        Value::Object(map) => {
            let lost: Vec<String> = map.iter().filter(|(_, v)| holds_null(v)).map(|(k, _)| k.clone()).collect();
            map.iter_mut().filter(|(key, _)| !WORDS.contains(&key.as_str())).for_each(|(_, inner)| add_reasons(inner));
            if !lost.is_empty() && !map.contains_key("reason") {
                map.insert("reason".into(), Value::String(format!("not finite: {}", lost.join(", "))));
            }
        }
        _ => {}
    }
}

fn holds_null(value: &Value) -> bool {
    match value {
        Value::Null => true,
        Value::Array(items) => items.iter().any(holds_null),
        _ => false,
    }
}

/// `x` with 17 significant digits, zeros at the end left out; reads back to the same number.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into(); // no sign: that of a zero depends on the order of summation
    }
    let scientific = format!("{x:.16e}");
    let (mantissa, exponent) = scientific.split_once('e').expect("scientific notation has an exponent");
    let exponent: i32 = exponent.parse().expect("the exponent is a whole number");
    let trim = |s: &str| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_string() } else { s.to_string() };
    if (-5..17).contains(&exponent) {
        let decimals = usize::try_from(16 - exponent).expect("at most 17 digits before the point");
        trim(&format!("{x:.decimals$}"))
    } else {
        format!("{}e{exponent}", trim(mantissa))
    }
}

/// One line per member of the outermost object, everything deeper on that line.
#[derive(Debug, Default)]
struct LineStarts {
    depth: usize,
}

impl Formatter for LineStarts {
    fn write_f64<W: Write + ?Sized>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        writer.write_all(number(value).as_bytes())
    }
    fn begin_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth += 1;
        writer.write_all(b"{")
    }
    fn end_object<W: Write + ?Sized>(&mut self, writer: &mut W) -> io::Result<()> {
        self.depth -= 1;
        writer.write_all(if self.depth == 0 { b"\n}" } else { b"}" })
    }
    fn begin_object_key<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        let between: &[u8] = match (first, self.depth) {
            (true, 1) => b"\n",
            (true, _) => b"",
            (false, 1) => b",\n",
            (false, _) => b", ",
        };
        writer.write_all(between)
    }
    fn begin_object_value<W: Write + ?Sized>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }
    fn begin_array_value<W: Write + ?Sized>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        writer.write_all(if first { b"" } else { b", " })
    }
}

/// The text of a JSON document, ending in a line break.
pub fn text(value: &Value) -> String {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, LineStarts::default());
    value.serialize(&mut serializer).expect("a JSON value can always be written to memory");
    bytes.push(b'\n');
    String::from_utf8(bytes).expect("JSON text is UTF-8")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_to_the_same_bits() {
        for x in [0.1, -1.25e-3, 1.0 / 3.0, 1e300, -7.5e-310, 123456789.0, 2e16, 1e17, 9.99999e-6, 0.5] {
            assert_eq!(number(x).parse::<f64>().unwrap(), x, "{}", number(x));
        }
        assert_eq!(number(0.5), "0.5");
        assert_eq!(number(-0.0), "0");
        assert_eq!(number(1e-7), "9.9999999999999995e-8"); // the 17 digits that are stored
    }

    #[test]
    fn a_number_that_is_not_finite_is_null_with_a_reason() {
        let mut value = serde_json::json!({"a": f64::NAN, "b": {"c": [1.0, f64::INFINITY]}, "d": 1});
        add_reasons(&mut value);
        assert_eq!(value["reason"], "not finite: a");
        assert_eq!(value["b"]["reason"], "not finite: c");
    }
}
