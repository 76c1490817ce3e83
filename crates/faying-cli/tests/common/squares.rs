//! Poisson on (0,1)^2 cut at y = 1/2, tied across the cut: as a case file.
#![allow(dead_code, clippy::unwrap_used)]

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
}

impl Squares {
    /// The patch of the half with this name.
    pub fn half(&self, name: &str) -> String {
        if name == "lower" { self.lower.patch(name, [0.0, 0.5]) } else { self.upper.patch(name, [0.5, 1.0]) }
    }

    pub fn text(&self) -> String {
        let (slave, master) = if self.slave_is_lower { ("lower.v1", "upper.v0") } else { ("upper.v0", "lower.v1") };
        let mut text = format!(
            "[model]\nphysics = \"poisson\"\ndimension = 2\nexact = {{ u = \"{}\" }}\n[[material]]\nname = \"m\"\n{}{}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n[[interface]]\nname = \"i\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{}\n",
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
}
