//! Supports, loads and joints of a problem as they were said.

use super::handles::Statement;
use super::model::{
    BodySide, Condition, CurvedSlide, Foundation, HeldSide, PointCondition, PointLoad, RigidSides, SaidEquation, SideLoad, SideSpring,
    Value,
};
use super::regions::RegionPart;
use crate::linalg::Vector;
use crate::space::Near;
use std::sync::Arc;

/// Supports, loads, springs and foundations, in the order in which they were said.
#[derive(Clone, Debug)]
pub(super) struct Said<const S: usize, const N: usize> {
    pub conditions: Vec<Condition<S, N>>,
    pub pins: Vec<PointCondition<N>>,
    /// Sides with at least one prescribed component.
    pub supports: Vec<Arc<BodySide<S, N>>>,
    pub equations: Vec<SaidEquation>,
    pub held: Vec<HeldSide<S, N>>,
    /// Curved sides that slide.
    pub slides: Vec<CurvedSlide<S, N>>,
    pub rigid_sides: Vec<RigidSides<S, N>>,
    pub loads: Vec<SideLoad<S, N>>,
    pub point_loads: Vec<PointLoad<N>>,
    pub springs: Vec<SideSpring<S, N>>,
    pub foundations: Vec<Foundation>,
}

impl<const S: usize, const N: usize> Default for Said<S, N> {
    fn default() -> Self {
        Self {
            conditions: Vec::new(),
            pins: Vec::new(),
            supports: Vec::new(),
            equations: Vec::new(),
            held: Vec::new(),
            slides: Vec::new(),
            rigid_sides: Vec::new(),
            loads: Vec::new(),
            point_loads: Vec::new(),
            springs: Vec::new(),
            foundations: Vec::new(),
        }
    }
}

impl<const S: usize, const N: usize> Said<S, N> {
    pub fn support(&mut self, side: &Arc<BodySide<S, N>>) {
        if !self.supports.iter().any(|s| Arc::ptr_eq(s, side)) {
            self.supports.push(side.clone());
        }
    }

    pub fn condition(&mut self, of: Statement, piece: &RegionPart<S, N>, component: usize, value: Value) {
        match piece {
            RegionPart::Side(side) => {
                self.conditions.push(Condition { of, side: side.clone(), component, value });
                self.support(side);
            }
            RegionPart::Rim(rim) => self.pins.push(PointCondition { of, rim: rim.clone(), component, value }),
        }
    }
}

/// A slave side that shares the functions of master sides.
#[derive(Clone, Debug)]
pub(super) struct Gluing<const S: usize, const N: usize> {
    pub of: Statement,
    pub slave: Arc<BodySide<S, N>>,
    pub masters: Vec<Arc<BodySide<S, N>>>,
    pub near: Option<Near>,
}

/// Functions of bodies that are one.
#[derive(Clone, Debug)]
pub(super) struct Shared<const N: usize> {
    pub functions: Vec<(usize, usize)>,
    pub x: Vector<N>,
}
