//! Problems: bodies with materials, supports, loads, ties and contacts, their systems and states.
//!
//! [`Model`] holds what a problem is made of, [`step`] solves it at a time, [`StepState`] is the solution. Fields, reactions and what
//! contacts transmit follow from a state.

mod arc_length;
mod assembled;
mod at_rest;
mod builder;
mod closed_points;
mod compliance;
mod contact_field;
mod contact_part;
mod contact_points;
mod contact_rows;
mod corner_search;
mod corners;
mod data;
mod directions;
mod equilibrium;
mod fixed;
mod function_sums;
mod glued;
mod gluing;
mod guess;
mod handles;
mod held_part;
mod integrate;
mod interface_error;
mod interfaces;
mod loads;
mod matrices;
mod model;
mod multipliers;
mod observer;
mod obstacle;
mod physics;
mod prescribed;
mod problem_error;
mod reactions;
mod resultant;
mod rigid;
mod rigid_bodies;
mod rigid_rows;
mod side;
mod solve;
mod solved;
mod solver;
mod start;
mod state;
mod step;
mod supports;
mod system;
mod tie_field;
mod tie_fluxes;
mod tie_part;

pub use arc_length::ArcLength;
pub use assembled::{ContactResult, Solution, System};
pub use builder::Problem;
pub use closed_points::{closed_points, left_free};
pub use contact_field::ContactField;
pub use contact_part::ContactSetup;
pub use corners::SharedCorner;
pub use data::{Data, Derivatives, Exact, Function, Point, field_slope};
pub use fixed::{Conflict, Fixed};
pub use function_sums::FunctionSums;
pub use glued::{Glued, Hinge};
pub use handles::{BodyId, Components, SideOf, Sides};
pub use integrate::on_trace;
pub use interface_error::InterfaceError;
pub use interfaces::{ContactOf, Integration, Opposite, Tie};
pub use matrices::{Matrices, Stiffness};
pub use model::{
    Action, Against, Changing, Condition, ContactModel, ContactPart, Formulation, Model, Pairing, PatchModel, Pin, RigidSides, RimModel,
    SideLoad, SideModel, SideSpring, TieModel, TiePart, Value,
};
pub use multipliers::{CutMultiplier, DualPair, MakeCovered, MakeMultiplier, covered_dual, curve_multiplier, wrapped};
pub use observer::{Observer, Progress};
pub use obstacle::{AtRest, ObstacleModel, Pressed};
pub use physics::{OtherField, Physics, PhysicsError, PointState};
pub use prescribed::Conditions;
pub use problem_error::ProblemError;
pub use reactions::reactions;
pub use resultant::Resultant;
pub use rigid::{FreeBody, RigidForm, RigidModes, RigidRow};
pub use rigid_bodies::{RigidBodies, unit};
pub use rigid_rows::closed_forms;
pub use solver::Solver;
pub use start::Start;
pub use state::{StepError, StepState, Unsolved};
pub use step::step;
pub use supports::{Ties, contact_points, free_by, free_motions, held_by, sentences, tie_points};
pub use tie_field::{TieField, component_rows, multiplier_at};
pub use tie_fluxes::Fluxes;
pub use tie_part::{InterfaceRules, MakeIntegration, Memberships, TieSetup};
