//! Text tables for people and comma-separated values for programs.

use std::fmt::Write as _;

/// A table with aligned columns; numbers to the right, words to the left.
///
/// # Example
/// ```
/// let mut table = faying_cli::table::Table::new(["patch", "unknowns"]);
/// table.row(["lower", "300"]);
/// assert_eq!(table.to_string(), "patch  unknowns\nlower       300\n");
/// ```
#[derive(Clone, Debug, Default)]
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with a line of column names; no names, no line.
    pub fn new<S: Into<String>>(head: impl IntoIterator<Item = S>) -> Self {
        Self { head: head.into_iter().map(Into::into).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) -> &mut Self {
        self.rows.push(cells.into_iter().map(Into::into).collect());
        self
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// The names of the columns.
    pub fn head(&self) -> &[String] {
        &self.head
    }

    /// The cells of every row.
    pub fn rows(&self) -> impl Iterator<Item = &[String]> {
        self.rows.iter().map(Vec::as_slice)
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let all = || std::iter::once(&self.head).filter(|h| !h.is_empty()).chain(&self.rows);
        let columns = all().map(Vec::len).max().unwrap_or(0);
        let cell = |row: &Vec<String>, k: usize| row.get(k).cloned().unwrap_or_default();
        let width = |k: usize| all().map(|row| cell(row, k).chars().count()).max().unwrap_or(0);
        let numeric = |k: usize| {
            let mut cells = self.rows.iter().map(|row| cell(row, k)).filter(|c| !c.is_empty() && c != "-").peekable();
            cells.peek().is_some() && cells.all(|c| c.parse::<f64>().is_ok())
        };
        let layout: Vec<(usize, bool)> = (0..columns).map(|k| (width(k), numeric(k))).collect();
        for row in all() {
            let mut line = String::new();
            for (k, &(width, right)) in layout.iter().enumerate() {
                let gap = if k == 0 { "" } else { "  " };
                let text = cell(row, k);
                if right {
                    write!(line, "{gap}{text:>width$}")?;
                } else {
                    write!(line, "{gap}{text:<width$}")?;
                }
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// A number for people: at most `digits` significant digits, exponents only where they help, no trailing zeros.
pub fn short(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return "-".to_owned();
    }
    let digits = digits.max(1);
    let scientific = format!("{x:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let trimmed = |s: &str| if s.contains('.') { s.trim_end_matches('0').trim_end_matches('.').to_owned() } else { s.to_owned() };
    let e: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&e) {
        let decimals = usize::try_from(digits as i32 - 1 - e).unwrap_or(0);
        trimmed(&format!("{x:.decimals$}"))
    } else {
        format!("{}e{exponent}", trimmed(mantissa))
    }
}

/// A number with fixed decimals; what rounds to zero has no sign.
pub fn decimals(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| matches!(c, '0' | '.')) => rest.to_owned(),
        _ => text,
    }
}

/// A number for programs: 17 significant digits; empty if it is not finite.
pub fn exact(x: f64) -> String {
    if x.is_finite() { format!("{x:.16e}") } else { String::new() }
}

/// A cell of comma-separated values, quoted where it holds a comma, a quote or a line break (RFC 4180).
pub fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

/// One multiplier function of an interface or a contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterfaceRow {
    /// Arc length along a curved slave side where the function is centred \[length\]; `None` on surfaces.
    pub s: Option<f64>,
    /// Coordinates of that point \[length\].
    pub x: [f64; 3],
    /// The multiplier: one number in contact and for Poisson, else one per component.
    pub lambda: Vec<f64>,
    /// The lumped gap in contact, u_slave - u_master along the master's normal where tied \[length\]; `None` without a master point.
    pub gap: Option<f64>,
    /// Whether the row is enforced.
    pub active: bool,
}

/// `interface_NAME.csv`: s (empty on surfaces), x, y, z, lambda (one column per component), gap, active; a line per multiplier function.
pub fn interface_csv(rows: &[InterfaceRow]) -> String {
    let components = rows.first().map_or(1, |row| row.lambda.len());
    let lambda = match components {
        0 | 1 => "lambda".to_owned(),
        n => ["lambda.x", "lambda.y", "lambda.z"][..n.min(3)].join(","),
    };
    let mut text = format!("s,x,y,z,{lambda},gap,active\n");
    for row in rows {
        let [s, gap] = [row.s, row.gap].map(|v| v.map(exact).unwrap_or_default());
        let numbers = row.x.iter().chain(row.lambda.iter().take(3)).map(|&v| exact(v));
        text.push_str(&format!("{s},{},{gap},{}\n", numbers.collect::<Vec<_>>().join(","), u8::from(row.active)));
    }
    text
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_drop_noise() {
        assert_eq!(short(0.001_250_000_000_01, 6), "0.00125");
        assert_eq!(short(-123_456.7, 6), "-123457");
        assert_eq!(short(7.1e-7, 4), "7.1e-7");
        assert_eq!(short(1.0, 6), "1");
        assert_eq!(short(210e9, 4), "2.1e11");
        assert_eq!(short(f64::NAN, 4), "-");
        assert_eq!([-0.04, -0.06, 0.0, 1.25].map(|x| decimals(x, 1)), ["0.0", "-0.1", "0.0", "1.2"]);
    }

    #[test]
    fn csv_numbers_come_back_bit_for_bit() {
        for x in [0.1, -1.25e-3, std::f64::consts::PI, 5e-324, 1.0 / 3.0] {
            assert_eq!(exact(x).parse::<f64>().unwrap(), x);
        }
        let row = InterfaceRow { s: Some(0.5), x: [1.0, 2.0, 0.0], lambda: vec![-0.1], gap: Some(0.0), active: true };
        let text = interface_csv(&[row]);
        assert!(text.starts_with("s,x,y,z,lambda,gap,active\n5.0000000000000000e-1,"));
        assert!(text.ends_with(",1\n"));
        let on_surface = InterfaceRow { lambda: vec![0.0], ..InterfaceRow::default() };
        assert!(interface_csv(&[on_surface]).contains("\n,0.0000000000000000e0,"));
    }
}
