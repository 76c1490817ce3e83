//! Reads inline `nurbs` geometry and checks knots, counts and weights at their places.

use super::reader::{Block, Reader};
use super::rows;
use super::tree::{Node, Value};
use super::types::Shape;
use crate::place::Located;

const DIRECTIONS: [&str; 3] = ["u", "v", "w"];

impl Reader {
    /// `{ kind = "nurbs", degree, knots, points, weights }`; u runs fastest.
    pub fn nurbs(&mut self, b: &mut Block) -> Shape {
        self.nurbs_of(b, self.dimension)
    }

    /// Reads `nurbs` geometry with `n` parameters: one for the curve of an obstacle in the plane.
    pub fn nurbs_of(&mut self, b: &mut Block, n: usize) -> Shape {
        let world = self.dimension;
        let fallback = Shape::Nurbs {
            degree: Located::new(vec![1; n], b.at),
            knots: vec![Located::new(vec![0.0, 0.0, 1.0, 1.0], b.at); n],
            // corners of the unit cube: no edge is collapsed
            points: Located::new((0..1_usize << n).map(|c| (0..world).map(|k| ((c >> k) & 1) as f64).collect()).collect(), b.at),
            weights: None,
        };
        let curve = n == 1;
        if curve {
            for key in &mut b.keys {
                if let Some(own) = rows::CURVE.iter().find(|own| own.name == key.name) {
                    *key = own.clone();
                }
            }
        }
        let degree = self.required(b, "degree");
        let knots = self.required(b, "knots");
        let points = self.required(b, "points");
        let (Some(degree), Some(knots), Some(points)) = (degree, knots, points) else { return fallback };
        if let (3, Value::List(lists)) = (n, &knots.value)
            && lists.len() == 2
        {
            let help = "add extrude = h for a solid of height h along z";
            self.fault("E044", knots.at, "two knot vectors make a plane patch, the model has dimension 3", help);
            return fallback;
        }
        let degree = self.net_degree(&degree, n);
        let knots = self.net_knots(&knots, n);
        let points = self.net_points(&points);
        let weights = b.node("weights").cloned().map(|w| (self.net_weights(&w), w.at));
        let (Some(degree), Some(knots), Some(points)) = (degree, knots, points) else { return fallback };
        // every direction is looked at, so that all their errors are listed
        let good: Vec<bool> = (0..n).map(|k| self.check_knots(&knots[k], degree[k], k)).collect();
        if good.contains(&false) {
            return fallback;
        }
        let counts: Vec<usize> = (0..n).map(|k| knots[k].len() - degree[k] - 1).collect();
        let product = counts.iter().try_fold(1_usize, |a, c| a.checked_mul(*c));
        let text = counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ");
        if product != Some(points.len()) {
            let message = format!("degree and knots ask for {text} control points, found {}", points.len());
            self.fault("E033", points.at, message, "per direction: number of knots - degree - 1; u runs fastest");
            return fallback;
        }
        let weights = match weights {
            None => None,
            Some((None, _)) => return fallback,
            Some((Some(w), at)) => {
                if w.len() != points.len() {
                    let message = format!("there are {} control points, but {} weights", points.len(), w.len());
                    self.fault("E033", at, message, "give one weight per point");
                    return fallback;
                }
                Some(Located::new(w, at))
            }
        };
        let knots = knots.into_iter().map(|u| Located::new(u.iter().map(|v| v.value).collect(), u.at)).collect();
        Shape::Nurbs { degree, knots, points, weights }
    }

    fn net_degree(&mut self, node: &Node, n: usize) -> Option<Located<Vec<usize>>> {
        let all: Option<Vec<usize>> = match &node.value {
            Value::List(l) if l.len() == n => l.iter().map(|item| self.whole_of(item, "degree", 1, 12)).collect(),
            Value::Integer(_) => self.whole_of(node, "degree", 1, 12).map(|p| vec![p; n]),
            _ => {
                let wanted =
                    if n == 1 { "a whole number, as its knots are one list".to_owned() } else { format!("a list of {n} whole numbers") };
                self.wrong_type(node, "degree", &wanted, "");
                None
            }
        };
        all.map(|d| Located::new(d, node.at))
    }

    fn net_knots(&mut self, node: &Node, n: usize) -> Option<Vec<Located<Vec<Located<f64>>>>> {
        match &node.value {
            Value::List(l) if n == 1 && !(l.len() == 1 && matches!(l[0].value, Value::List(_))) => {
                self.numbers_of(node, "knots").map(|u| vec![Located::new(u, node.at)])
            }
            Value::List(l) if l.len() == n => {
                l.iter().map(|item| self.numbers_of(item, "knots").map(|u| Located::new(u, item.at))).collect()
            }
            Value::List(l) => {
                let message = format!("`knots` must have {n} lists, one per direction, found {}", l.len());
                self.fault("E044", node.at, message, "");
                None
            }
            _ => {
                self.wrong_type(node, "knots", &format!("a list of {n} knot vectors"), "");
                None
            }
        }
    }

    fn net_points(&mut self, node: &Node) -> Option<Located<Vec<Vec<f64>>>> {
        let Value::List(list) = &node.value else {
            self.wrong_type(node, "points", "a list of points", "");
            return None;
        };
        let mut out = Vec::with_capacity(list.len());
        for item in list {
            out.push(self.vector_of(item, "points", false)?.value);
        }
        Some(Located::new(out, node.at))
    }

    fn net_weights(&mut self, node: &Node) -> Option<Vec<f64>> {
        let all = self.numbers_of(node, "weights")?;
        if let Some((k, w)) = all.iter().enumerate().find(|(_, w)| w.value <= 0.0) {
            self.fault("E034", w.at, format!("weight {k} must be positive, found {:?}", w.value), "weights are counted from 0");
            return None;
        }
        Some(all.iter().map(|w| w.value).collect())
    }

    /// Checks that knots are open: non-decreasing, the ends degree + 1 times, inner ones at most degree times.
    fn check_knots(&mut self, knots: &Located<Vec<Located<f64>>>, degree: usize, direction: usize) -> bool {
        let d = DIRECTIONS[direction];
        if knots.len() < 2 * (degree + 1) {
            let message = format!("the knots of direction {d} are {}, degree {degree} needs at least {}", knots.len(), 2 * (degree + 1));
            self.fault("E033", knots.at, message, "repeat the first and the last knot degree + 1 times");
            return false;
        }
        for k in 1..knots.len() {
            let (a, b) = (knots[k - 1].value, knots[k].value);
            if b < a {
                let message = format!("knots of direction {d} decrease at index {k}: {b:?} after {a:?}");
                self.fault("E031", knots[k].at, message, "sort the knots");
                return false;
            }
        }
        let mut start = 0;
        while start < knots.len() {
            let value = knots[start].value;
            let count = knots[start..].iter().take_while(|u| u.value == value).count();
            let end = start + count;
            let rim = start == 0 || end == knots.len();
            let most = if rim { degree + 1 } else { degree };
            if count > most {
                let message =
                    format!("knot {value:?} of direction {d} is repeated {count} times, at most {most} are allowed (index {start})");
                let help = if rim { "ends: degree + 1 times" } else { "inside: degree times; a jump needs two patches" };
                self.fault("E032", knots[start].at, message, help);
                return false;
            }
            if rim && count < most {
                let message = format!("knot {value:?} at an end of direction {d} stands {count} times, it must stand {most} times");
                self.fault("E032", knots[start].at, message, "open knot vectors repeat both ends degree + 1 times");
                return false;
            }
            start = end;
        }
        true
    }
}
