//! Points of a part, shared by elements if all their values agree but those that are averaged.

use super::file::Kept;
use super::piece::{AHEAD, Piece, WEIGHT};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Tolerance of fields, relative to the largest value so far, and of positions, relative to the element's size.
const SAME: f64 = 1e-10;

/// Rounding of positions, relative to their distance from the origin.
const ROUNDING: f64 = 1e-14;

/// No point.
const NONE: u32 = u32::MAX;

/// Corners around a node, rising, each with the node's weight at it in the low bits.
type Key = [u64; 4];

/// Bits of a weight: degree 10 on a hexahedron has weights up to 1000.
const WEIGHT_BITS: u32 = 12;

/// Hasher that multiplies and folds: keys are distinct by construction, and the order of the table has no effect.
#[derive(Default)]
struct Fold(u64);

impl Hasher for Fold {
    fn write(&mut self, bytes: &[u8]) {
        for word in bytes.as_chunks::<8>().0 {
            self.write_u64(u64::from_le_bytes(*word));
        }
    }
    fn write_u64(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 32
    }
}

/// Positions, weights and fields of points.
#[derive(Default)]
pub(super) struct Points {
    pub x: Vec<[f64; 3]>,
    pub weights: Vec<f64>,
    /// Per field, all components of a point after the other.
    pub fields: Vec<Vec<f64>>,
    components: Vec<usize>,
    averaged: Vec<bool>,
    /// Nodes of every point, where fields are averaged: until then its values are sums over them.
    nodes_of: Vec<u32>,
    /// Previous point of the same node.
    before: Vec<u32>,
    /// The last point of the corners whose ids are below the length.
    vertices: Vec<u32>,
    /// The last point of all other nodes.
    nodes: HashMap<Key, u32, BuildHasherDefault<Fold>>,
    /// Greatest magnitude per field.
    greatest: Vec<f64>,
}

impl Points {
    pub fn new(fields: &[Kept]) -> Self {
        let (components, averaged) = fields.iter().map(|f| (f.components, f.averaged)).unzip();
        Self { fields: vec![Vec::new(); fields.len()], components, averaged, ..Self::default() }
    }

    /// Divides the sums of averaged fields by the numbers of nodes.
    pub fn average(&mut self) {
        for ((values, c), _) in self.fields.iter_mut().zip(&self.components).zip(&self.averaged).filter(|f| *f.1) {
            for (point, n) in values.chunks_exact_mut(*c).zip(&self.nodes_of) {
                point.iter_mut().for_each(|v| *v /= f64::from(*n));
            }
        }
    }

    /// Begins a part of the given number of elements, which shares no points with the previous parts.
    pub fn begin(&mut self, elements: usize) {
        self.vertices = vec![NONE; 2 * elements + 2];
        self.nodes.clear();
        self.greatest = vec![0.0; self.fields.len()];
    }

    /// Points of the nodes of a piece: existing ones if they agree, else new ones.
    pub fn of(&mut self, piece: &Piece<'_>, ids: &mut Vec<usize>) {
        ids.clear();
        let width = AHEAD + self.components.iter().sum::<usize>();
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for row in piece.values.chunks_exact(width) {
            let mut first = AHEAD;
            for (greatest, c) in self.greatest.iter_mut().zip(&self.components) {
                *greatest = row[first..first + c].iter().fold(*greatest, |m, v| if v.is_finite() { m.max(v.abs()) } else { m });
                first += c;
            }
            (0..3).for_each(|k| (low[k], high[k]) = (low[k].min(row[k]), high[k].max(row[k])));
        }
        let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let far = (0..3).map(|k| high[k].abs().max(low[k].abs())).fold(0.0, f64::max);
        let near = SAME * size + ROUNDING * far;
        // an element that has a corner twice would have a point twice
        let known = !piece.corners.is_empty() && (1..piece.corners.len()).all(|k| !piece.corners[..k].contains(&piece.corners[k]));
        for (row, around) in piece.values.chunks_exact(width).zip(piece.around) {
            let list = around.as_ref().filter(|_| known && self.x.len() < NONE as usize);
            ids.push(match list {
                Some(list) => self.shared(row, key(list, &piece.corners), near),
                None => self.add(row, NONE),
            });
        }
    }

    fn shared(&mut self, row: &[f64], key: Key, near: f64) -> usize {
        let vertex = (key[1] == u64::MAX).then_some((key[0] >> WEIGHT_BITS) as usize).filter(|v| *v < self.vertices.len());
        let last = match vertex {
            Some(v) => self.vertices[v],
            None => self.nodes.get(&key).copied().unwrap_or(NONE),
        };
        let mut point = last;
        while point != NONE {
            if self.agrees(point as usize, row, near) {
                self.join(point as usize, row);
                return point as usize;
            }
            point = self.before[point as usize];
        }
        let new = self.add(row, last);
        match vertex {
            Some(v) => self.vertices[v] = new as u32,
            None => {
                self.nodes.insert(key, new as u32);
            }
        }
        new
    }

    /// Adds the averaged values of a node to those of its point.
    fn join(&mut self, point: usize, row: &[f64]) {
        self.nodes_of[point] += 1;
        let mut first = AHEAD;
        for ((values, c), averaged) in self.fields.iter_mut().zip(&self.components).zip(&self.averaged) {
            if *averaged {
                values[point * c..(point + 1) * c].iter_mut().zip(&row[first..first + c]).for_each(|(sum, v)| *sum += v);
            }
            first += c;
        }
    }

    /// Whether all values of a point agree with those of a node, the averaged ones left out.
    fn agrees(&self, point: usize, row: &[f64], near: f64) -> bool {
        let mut first = AHEAD;
        self.x[point].iter().zip(row).all(|(a, b)| (a - b).abs() <= near)
            && (self.weights[point] - row[WEIGHT]).abs() <= SAME * row[WEIGHT]
            && self.fields.iter().zip(&self.components).zip(&self.greatest).zip(&self.averaged).all(
                |(((values, c), greatest), averaged)| {
                    let (own, tolerance) = (&row[first..first + c], SAME * greatest);
                    first += c;
                    *averaged || values[point * c..(point + 1) * c].iter().zip(own).all(|(a, b)| a == b || (a - b).abs() <= tolerance)
                },
            )
    }

    fn add(&mut self, row: &[f64], before: u32) -> usize {
        self.x.push([row[0], row[1], row[2]]);
        self.weights.push(row[WEIGHT]);
        self.nodes_of.push(1);
        let mut first = AHEAD;
        for (values, c) in self.fields.iter_mut().zip(&self.components) {
            values.extend_from_slice(&row[first..first + c]);
            first += c;
        }
        self.before.push(before);
        self.x.len() - 1
    }
}

/// Key of a node, equal in all elements that share it.
fn key(around: &[(usize, u64)], corners: &[usize]) -> Key {
    let mut key = [u64::MAX; 4];
    for (slot, &(c, weight)) in key.iter_mut().zip(around) {
        *slot = (corners[c] as u64) << WEIGHT_BITS | weight;
    }
    key.sort_unstable();
    key
}
