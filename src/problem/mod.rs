//! Problems: bodies with materials, supports, loads, ties and contacts, their systems and states.
//!
//! [`Model`] holds what a problem is made of, [`step`] solves it at a time, [`StepState`] is the solution. Fields, reactions and what
//! contacts transmit follow from a state.

mod arc_length;
mod at_rest;
mod compliance;
mod contact_field;
mod contact_points;
mod contact_rows;
mod corners;
mod data;
mod directions;
mod equilibrium;
mod function_sums;
mod glued;
mod integrate;
mod loads;
mod matrices;
mod model;
mod observer;
mod obstacle;
mod physics;
mod prescribed;
mod reactions;
mod rigid;
mod solve;
mod solver;
mod start;
mod supports;
mod system;
mod tie_field;
mod tie_fluxes;

pub use arc_length::ArcLength;
pub use contact_field::ContactField;
pub use contact_points::PointSides;
pub use contact_rows::rows;
pub use corners::SharedCorner;
pub use data::{Data, Derivatives, Exact, Function, Point, field_slope};
pub use directions::{directions, slides};
pub use function_sums::{FunctionSums, closed_forms, function_sums};
pub use glued::{Glued, Hinge};
pub use integrate::on_trace;
pub use loads::Resultant;
pub use matrices::{Matrices, Stiffness};
pub use model::{
    Action, Against, Changing, Condition, ContactModel, ContactPart, Formulation, Model, Pairing, PatchModel, Pin, RigidSides, RimModel,
    SideLoad, SideModel, SideSpring, TieModel, TiePart, Value,
};
pub use observer::{Observer, Progress};
pub use obstacle::{AtRest, ObstacleModel, Pressed};
pub use physics::{OtherField, Physics, PointState};
pub use prescribed::Conditions;
pub use reactions::reactions;
pub use rigid::{FreeBody, RigidForm, RigidModes, RigidRow};
pub use solve::{StepError, StepState, Unsolved, step};
pub use solver::Solver;
pub use start::Start;
pub use supports::{RigidBodies, Ties, contact_points, free_by, free_motions, held_by, sentences, tie_points, unit};
pub use tie_field::{TieField, component_rows, multiplier_at};
pub use tie_fluxes::Fluxes;
