//! Ties, glue and supports from case files: states, orders, refusals.
#![allow(clippy::unwrap_used)]

mod common;
mod corner_values;
mod cross_product;
mod direct;
mod glue;
mod held;
mod in_space;
mod integration;
mod iterative;
mod kinks;
mod mortar_balance;
mod multipliers;
mod partly_joined;
mod poor_numbers;
mod skeletons;
mod soft_coupling;
mod touching;
mod uneven_gap;
