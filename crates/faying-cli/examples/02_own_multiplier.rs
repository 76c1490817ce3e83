//! Lesson 2: a multiplier space from outside the crate, in case files under a name of its own.
//!
//! `Coarse` has continuous, piecewise linear functions on every second breakpoint of the slave side: half as many
//! multipliers as elements. It is a `Basis` like any other: the crate's own checks look at it, the registry gives it a
//! name, and mortar, solvers, results and studies take it from there without learning what it is.
//!
//! `cargo run --release --example 02_own_multiplier`

use faying::basis::{Basis, Elements, Order, ShapeTable};
use faying::linalg::Vector;
use std::error::Error;

/// Hats on pairs of neighbouring elements; a pair at a constrained end has one constant instead.
#[derive(Debug)]
struct Coarse {
    /// Per element the functions that fall and rise over its pair; the same one twice at a constrained end.
    functions: Vec<[usize; 2]>,
    /// Per element the part of its pair, begin and width, in [0, 1].
    part: Vec<[f64; 2]>,
    corners: Vec<Vec<usize>>,
}

impl Coarse {
    /// On elements that follow one another; `constrained`: at the begin and at the end of the side.
    fn new(side: &dyn Basis<1>, constrained: [bool; 2]) -> Self {
        let n = side.num_elements();
        let pairs = n.div_ceil(2);
        // vertex k of the coarse grid carries function k; constrained ends join the first or the last two
        let last = pairs.saturating_sub(usize::from(constrained[0]) + usize::from(constrained[1]));
        let function = |vertex: usize| (vertex.saturating_sub(usize::from(constrained[0]))).min(last);
        let part = |e: usize| if e == n - 1 && n % 2 == 1 { [0.0, 1.0] } else { [0.5 * (e % 2) as f64, 0.5] };
        let corners = |e: usize| {
            let mut ids = Vec::new();
            side.corners(e, &mut ids);
            ids
        };
        Self {
            functions: (0..n).map(|e| [function(e / 2), function(e / 2 + 1)]).collect(),
            part: (0..n).map(part).collect(),
            corners: (0..n).map(corners).collect(),
        }
    }
}

impl Elements for Coarse {
    fn num_elements(&self) -> usize {
        self.functions.len()
    }
    fn corners(&self, element: usize, ids: &mut Vec<usize>) {
        ids.clear();
        ids.extend_from_slice(&self.corners[element]);
    }
}

impl Basis<1> for Coarse {
    fn num_functions(&self) -> usize {
        self.functions.last().map_or(0, |f| f[1] + 1)
    }
    fn degree(&self, _element: usize) -> [usize; 1] {
        [1]
    }
    fn active(&self, element: usize, ids: &mut Vec<usize>) {
        let [falls, rises] = self.functions[element];
        ids.clear();
        ids.push(falls);
        if rises != falls {
            ids.push(rises);
        }
    }
    fn tabulate(&self, element: usize, xi: &[Vector<1>], order: Order, table: &mut ShapeTable<1>) {
        let ([falls, rises], [begin, width]) = (self.functions[element], self.part[element]);
        let single = falls == rises;
        table.reset(xi.len(), if single { 1 } else { 2 }, order);
        for (q, xi) in xi.iter().enumerate() {
            let t = begin + width * xi[0];
            if single {
                table.values_mut(q)[0] = 1.0;
                continue;
            }
            table.values_mut(q).copy_from_slice(&[1.0 - t, t]);
            if order >= Order::Gradients {
                table.grads_mut(q).copy_from_slice(&[Vector::<1>::new(-width), Vector::<1>::new(width)]);
            }
        }
    }
}

/// Two squares that share y = 1, tied with the multiplier of that name; u = sin(x) exp(y).
fn case(backend: &str, multiplier: &str) -> String {
    format!(
        r#"
        [model]
        physics = "poisson"
        dimension = 2
        exact = {{ u = "sin(x)*exp(y)" }}
        [discretization]
        backend = "{backend}"
        [[patch]]
        name = "lower"
        geometry = {{ kind = "box", min = [0, 0], max = [1, 1] }}
        elements = [12, 12]
        [[patch]]
        name = "upper"
        geometry = {{ kind = "box", min = [0, 1], max = [1, 2] }}
        elements = [8, 8]
        [[boundary]]
        on = "all-outer"
        dirichlet = "exact"
        [[interface]]
        name = "seam"
        slave = "lower.top"
        master = "upper.bottom"
        multiplier = "{multiplier}"
        "#
    )
}

/// The inf-sup constants of quadratic splines against `Coarse` on 8, 16 and 32 elements, zero at both ends.
fn betas() -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    use faying::coupling::inf_sup::{Question, inf_sup};
    use faying::geometry::shapes::rectangle;
    use faying::space::{Body, Patch, PatchSpec};
    let mut points = Vec::new();
    for n in [8, 16, 32] {
        let spec = PatchSpec::new(rectangle([0.0, 0.0], [1.0, 1.0])?).with_degree([2, 2]).with_elements([n, 1]);
        let side = Patch::<1, 2>::try_new(&spec)?.trace("v0")?;
        let last = side.dofs.len() - 1;
        let inner: Vec<Option<usize>> = (0..=last).map(|i| (i > 0 && i < last).then(|| i - 1)).collect();
        let found = inf_sup(&*side.space, &inner, &Coarse::new(&*side.space, [true, true]), &Question::default())?;
        points.push((found.h, found.beta));
    }
    Ok(points)
}

/// Checks the space by the rules of every basis, asks whether it is stable, and runs cases that name it.
pub fn main() -> Result<(), Box<dyn Error>> {
    use faying::basis::BSpline;
    use faying::check;
    use faying::coupling::inf_sup::{Verdict, verdict};
    for constrained in [[false, false], [true, false], [false, true], [true, true]] {
        for elements in [1, 2, 5, 8] {
            let coarse = Coarse::new(&BSpline::<f64>::uniform(2, elements, 1), constrained);
            check::basis(&coarse)?;
            check::partition_of_unity(&coarse)?;
            check::non_negative(&coarse)?;
        }
    }

    let points = betas()?;
    println!("inf-sup constants on 8, 16, 32 elements {:.4?}: {}", points.iter().map(|p| p.1).collect::<Vec<_>>(), verdict(&points));
    assert_eq!(verdict(&points), Verdict::Stable);

    {
        use faying::coupling::multiplier::side_ends;
        use faying::problem::Multiplier;
        use faying_cli::infsup::{InfSupOptions, constants};
        use faying_cli::{Case, case::ReadOptions};
        use faying_cli::{Registry, RunControl, Status};

        let mut registry = Registry::default();
        registry.plane.multipliers.add(
            "coarse",
            Multiplier::of(|trace, is_constrained| {
                let ends = side_ends(&*trace.space);
                let held = |at: usize| {
                    let (mut ids, mut table) = (Vec::new(), ShapeTable::new());
                    ends.iter().filter(|end| end.at == at).any(|end| {
                        trace.space.active(end.element, &mut ids);
                        trace.space.tabulate(end.element, &[Vector::<1>::new(at as f64)], Order::Values, &mut table);
                        ids.iter().zip(table.values(0)).any(|(&i, value)| value.abs() > 1e-10 && is_constrained(trace.dofs[i]))
                    })
                };
                Ok(Box::new(Coarse::new(&*trace.space, [held(0), held(1)])))
            }),
        );
        for backend in ["iga", "fe"] {
            for name in ["p/p-2", "coarse"] {
                let options = ReadOptions { names: registry.case_names(), ..ReadOptions::default() };
                let seam = Case::parse("seam.toml", &case(backend, name), &options)?;
                let result = seam.run(&registry)?;
                let multiplier = result.interface.get("seam").and_then(|i| i.multiplier.clone()).ok_or("no multiplier")?;
                let error = *result.errors.get("error.u.L2").ok_or("no error")?;
                println!(
                    "{backend:>3} {name:<7} {:>2} multipliers, hold degree {:?}, L2 error {error:.2e}",
                    multiplier.functions, multiplier.reproduction
                );
                assert!(result.status == Status::Ok && error < 1e-3);
                // what `faying infsup` prints
                for found in constants(&seam, &registry, &InfSupOptions::default(), &RunControl::default())? {
                    println!("            beta {:.4} on {} elements of {}", found.found.beta, found.elements, found.side);
                    assert!(found.found.beta > 0.5);
                }
            }
        }
    }
    Ok(())
}

#[test]
fn the_lesson_runs() {
    main().unwrap();
}
