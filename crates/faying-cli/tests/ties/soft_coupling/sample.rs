//! Two rectangles that meet at y = 1/2, as a case file.

use faying_cli::Case;
use faying_cli::case::ReadOptions;
use faying_cli::{Registry, RunResult, Status};

/// What the tests vary.
#[derive(Clone, Debug)]
pub struct Sample {
    pub poisson: bool,
    /// One formula per component.
    pub exact: Vec<String>,
    /// Material of the lower and of the upper body.
    pub materials: [String; 2],
    pub backends: [&'static str; 2],
    /// Elements of the lower and of the upper body along and across.
    pub elements: [[usize; 2]; 2],
    pub degree: usize,
    /// 0: the lower body is the slave.
    pub slave: usize,
    /// Lines of `[[interface]]` and further blocks.
    pub tie: String,
    /// Multiplies all lengths of the bodies.
    pub size: f64,
}

impl Sample {
    pub fn poisson(exact: &str, tie: &str) -> Self {
        Self {
            poisson: true,
            exact: vec![exact.into()],
            materials: ["conductivity = 1".into(), "conductivity = 1".into()],
            backends: ["iga"; 2],
            elements: [[6, 3], [4, 2]],
            degree: 2,
            slave: 0,
            tie: tie.into(),
            size: 1.0,
        }
    }

    pub fn elastic(exact: [&str; 2], tie: &str) -> Self {
        let material = "young = 1000\npoisson = 0.3".to_owned();
        Self { poisson: false, exact: exact.map(String::from).to_vec(), materials: [material.clone(), material], ..Self::poisson("", tie) }
    }

    pub fn text(&self) -> String {
        let l = self.size;
        let exact: Vec<String> = self.exact.iter().map(|f| format!("\"{f}\"")).collect();
        let (physics, exact) = if self.poisson { ("poisson", exact[0].clone()) } else { ("elasticity", format!("[{}]", exact.join(", "))) };
        let body = |k: usize| {
            let ([name, y0, y1], [n, m]) = ([["lower", "0", "0.5"], ["upper", "0.5", "1"]][k], self.elements[k]);
            let [y0, y1] = [y0, y1].map(|y| l * y.parse::<f64>().unwrap());
            let backend = self.backends[k];
            let backend = if backend == "simplex" { "fe\"\ncells = \"simplex" } else { backend };
            format!(
                "[[material]]\nname = \"{name}\"\n{}\n[[patch]]\nname = \"{name}\"\nmaterial = \"{name}\"\nbackend = \"{backend}\"\nelements = [{n}, {m}]\n\
                 geometry = {{ kind = \"box\", min = [0, {y0:e}], max = [{l:e}, {y1:e}] }}\n",
                self.materials[k]
            )
        };
        let (slave, master) = if self.slave == 0 { ("lower.top", "upper.bottom") } else { ("upper.bottom", "lower.top") };
        format!(
            "schema = 1\n[model]\nphysics = \"{physics}\"\ndimension = 2\nexact = {{ u = {exact} }}\n[discretization]\ndegree = {}\n{}{}\
             [[boundary]]\non = \"all-outer\"\ndirichlet = \"exact\"\n\
             [[interface]]\nname = \"i\"\nslave = \"{slave}\"\nmaster = \"{master}\"\n{}\n",
            self.degree,
            body(0),
            body(1),
            self.tie
        )
    }

    pub fn run(&self) -> RunResult {
        solved(&self.text())
    }
}

/// The result of a case that is solved.
pub fn solved(text: &str) -> RunResult {
    let result = tried(text);
    assert_eq!(result.status, Status::Ok, "{:?}\n{text}", result.diagnostics);
    result
}

/// The result of a case that is well written.
pub fn tried(text: &str) -> RunResult {
    let case = Case::parse("case.toml", text, &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    case.run(&Registry::default()).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

pub fn error(result: &RunResult, name: &str) -> f64 {
    *result.errors.get(&format!("error.{name}")).unwrap_or_else(|| panic!("no error {name}"))
}

pub fn probe(result: &RunResult, name: &str) -> f64 {
    result.probes.iter().find(|p| p.name == name).unwrap().value
}
