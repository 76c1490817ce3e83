//! Couplings that are not rows alone: Nitsche's method, penalty, stiffness from outside; orders, contrasts, units, refusals.

use crate::common::coupled;
mod patch;
mod solvers;

mod cases;
mod contrast;
mod orders;
mod outside;
mod sample;
