//! Poisson on (0,1)^2 cut at y = 1/2, tied across the cut: what the mortar validation suites share.
#![allow(dead_code, clippy::unwrap_used)]

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, Status};

/// The solution of benchmarks that others published rates for.
pub const SMOOTH: &str = "cos(3*x + 0.3)*exp(y) + sin(2*pi*x*y)";

/// A backend with its cells and basis, as a case writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Spline,
    Nurbs,
    Tensor,
    Triangle,
}

pub const KINDS: [Kind; 4] = [Kind::Spline, Kind::Nurbs, Kind::Tensor, Kind::Triangle];

/// One half of the square.
#[derive(Clone, Copy, Debug)]
pub struct Half {
    pub kind: Kind,
    pub degree: usize,
    /// Elements along and across the interface.
    pub elements: [usize; 2],
}

impl Half {
    pub fn new(kind: Kind, degree: usize, elements: [usize; 2]) -> Self {
        Self { kind, degree, elements }
    }

    /// The patch from height y0 to y1; NURBS have weights that vary and keep straight sides straight.
    fn patch(&self, name: &str, [y0, y1]: [f64; 2]) -> String {
        let Self { kind, degree, elements: [n, m] } = *self;
        let words = match kind {
            Kind::Spline => "backend = \"iga\"\nbasis = \"b-spline\"\n",
            Kind::Nurbs => "backend = \"iga\"\nbasis = \"nurbs\"\n",
            Kind::Tensor => "backend = \"fe\"\n",
            Kind::Triangle => "backend = \"fe\"\ncells = \"simplex\"\n",
        };
        let geometry = if kind == Kind::Nurbs {
            format!(
                "{{ kind = \"nurbs\", degree = [1, 1], knots = [[0, 0, 1, 1], [0, 0, 1, 1]], \
                 points = [[0, {y0}], [1, {y0}], [0, {y1}], [1, {y1}]], weights = [1, 0.9, 1.05, 0.95] }}"
            )
        } else {
            format!("{{ kind = \"box\", min = [0, {y0}], max = [1, {y1}] }}")
        };
        format!("[[patch]]\nname = \"{name}\"\ngeometry = {geometry}\nelements = [{n}, {m}]\ndegree = {degree}\n{words}")
    }
}

/// A tied pair of halves.
#[derive(Clone, Debug)]
pub struct Squares {
    pub lower: Half,
    pub upper: Half,
    pub slave_is_lower: bool,
    /// Lines of the interface: multiplier, integration, coupling, ...
    pub interface: String,
    pub exact: &'static str,
    /// Neumann data on the four sides that meet the interface; Dirichlet data there otherwise.
    pub neumann: bool,
}

/// What a run gives.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Errors of u in L2 and H1, of lambda in L2.
    pub errors: [f64; 3],
    pub balance: f64,
    pub consistency: f64,
    /// u at a point of each half.
    pub probes: [f64; 2],
}

impl Squares {
    /// The patch of the half with this name.
    pub fn half(&self, name: &str) -> String {
        if name == "lower" { self.lower.patch(name, [0.0, 0.5]) } else { self.upper.patch(name, [0.5, 1.0]) }
    }

    pub fn text(&self) -> String {
        let [a, b] = if self.neumann {
            [
                "[[boundary]]\non = [\"lower.v0\", \"upper.v1\"]\ndirichlet = \"exact\"\n",
                "[[boundary]]\non = \"all-outer\"\nneumann = \"exact\"\n",
            ]
        } else {
            ["[[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n", ""]
        };
        let (slave, master) = if self.slave_is_lower { ("lower.v1", "upper.v0") } else { ("upper.v0", "lower.v1") };
        let mut text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{}\" }}\n[[material]]\nname = \"m\"\n{}{}{a}{b}\
             [[interface]]\nname = \"i\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{}\n",
            self.exact,
            self.half("lower"),
            self.half("upper"),
            self.interface
        );
        for q in ["error.u.L2", "error.u.H1", "error.lambda.L2", "u at [0.37, 0.21]", "u at [0.61, 0.83]"] {
            text += &format!("[[probe]]\nname = \"{}\"\nquantity = \"{q}\"\n", q.replace(['.', ' ', '[', ']', ','], "_"));
        }
        text
    }

    pub fn run(&self) -> Result<Errors, String> {
        let case = Case::parse("case.toml", &self.text(), &ReadOptions::default()).map_err(|e| e.to_string())?;
        let result = case.run(&Registry::default()).map_err(|e| e.to_string())?;
        if result.status != Status::Ok {
            return Err(format!("{:?} {:?}", result.status, result.diagnostics));
        }
        let v: Vec<f64> = result.probes.iter().map(|p| p.value).collect();
        let i = result.interface.get("i").unwrap();
        Ok(Errors { errors: [v[0], v[1], v[2]], balance: i.balance, consistency: i.consistency, probes: [v[3], v[4]] })
    }
}

/// log2 of the errors of a level over those of the next.
pub fn rates(coarse: &Errors, fine: &Errors) -> [f64; 3] {
    std::array::from_fn(|k| (coarse.errors[k] / fine.errors[k]).log2())
}
