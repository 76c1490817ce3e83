#![doc = include_str!(concat!(env!("OUT_DIR"), "/front.md"))]

#[doc = include_str!(concat!(env!("OUT_DIR"), "/install.md"))]
pub mod install {}

/// Twelve tasks from the case file to the number it is held to; each runs as a test.
///
/// | tutorial | what |
/// | --- | --- |
/// | [Tie two meshes](tutorials::t01_tie_two_meshes) | a first tie, and what multipliers do |
/// | [Press fit](tutorials::t02_press_fit) | two rings, beside the formula of Lamé |
/// | [Hertz](tutorials::t03_hertz) | pressure, half width and stresses below the surface |
/// | [Own mesh from Gmsh](tutorials::t04_mesh_from_gmsh) | physical groups become bodies and sides |
/// | [Own mesh from `.inp`](tutorials::t05_mesh_from_inp) | an `.inp` of Abaqus or CalculiX |
/// | [CAD against mesh](tutorials::t06_cad_against_mesh) | the exact shape and facets of it |
/// | [Convergence study](tutorials::t07_convergence_study) | rates, tables and pictures for a paper |
/// | [Steps](tutorials::t08_steps) | a load that grows, contact that begins on the way |
/// | [A joint in space](tutorials::t09_joint_in_space) | a tie in three dimensions |
/// | [Contact in space](tutorials::t10_contact_in_space) | contact in three dimensions |
/// | [Own Rust program](tutorials::t11_rust_program) | the same by calls, for many variants |
/// | [Parts, fields, lines](tutorials::t12_parts_fields_lines) | parts of sides, what is drawn, values along a line |
pub mod tutorials {
    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/01_tie_two_meshes.md"))]
    pub mod t01_tie_two_meshes {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/02_press_fit.md"))]
    pub mod t02_press_fit {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/03_hertz.md"))]
    pub mod t03_hertz {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/04_mesh_from_gmsh.md"))]
    pub mod t04_mesh_from_gmsh {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/05_mesh_from_inp.md"))]
    pub mod t05_mesh_from_inp {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/06_cad_against_mesh.md"))]
    pub mod t06_cad_against_mesh {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/07_convergence_study.md"))]
    pub mod t07_convergence_study {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/08_steps.md"))]
    pub mod t08_steps {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/09_joint_in_space.md"))]
    pub mod t09_joint_in_space {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/10_contact_in_space.md"))]
    pub mod t10_contact_in_space {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/11_rust_program.md"))]
    pub mod t11_rust_program {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/12_parts_fields_lines.md"))]
    pub mod t12_parts_fields_lines {}
}

#[doc = include_str!(concat!(env!("OUT_DIR"), "/choose.md"))]
pub mod choose {}

/// The methods and why they are as they are, with an example that runs for every choice.
///
/// | chapter | subject |
/// | --- | --- |
/// | [`ties`](theory::ties) | the mortar method, its multipliers, its integrals, Nitsche's method and penalty |
/// | [`contact`](theory::contact) | gap and pressure, discrete cones, the active set, formulations |
/// | [`surfaces`](theory::surfaces) | what is as in the plane in three dimensions, and what is not |
pub mod theory {
    #[doc = include_str!(concat!(env!("OUT_DIR"), "/theory/ties.md"))]
    pub mod ties {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/theory/contact.md"))]
    pub mod contact {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/theory/surfaces.md"))]
    pub mod surfaces {}
}

#[doc = include_str!(concat!(env!("OUT_DIR"), "/coming_from.md"))]
pub mod coming_from {}

// units and matrices in brackets are no links
#[allow(rustdoc::broken_intra_doc_links)]
#[doc = include_str!(concat!(env!("OUT_DIR"), "/docs/reference.md"))]
pub mod reference {}

#[allow(rustdoc::broken_intra_doc_links)]
#[doc = include_str!(concat!(env!("OUT_DIR"), "/docs/verified.md"))]
pub mod verified {}

#[doc = include_str!(concat!(env!("OUT_DIR"), "/docs/comparisons.md"))]
pub mod comparisons {}
