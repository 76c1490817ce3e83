#![doc = include_str!(concat!(env!("OUT_DIR"), "/front.md"))]

#[doc = include_str!(concat!(env!("OUT_DIR"), "/install.md"))]
pub mod install {}

/// Eleven tutorials, each a task from the case file to a figure beside a formula; a test runs every command of them.
///
/// | | tutorial | task |
/// | --- | --- | --- |
/// | 1 | [`tie_two_meshes`](tutorials::tie_two_meshes) | Tie two meshes that do not match, and see what a multiplier can do |
/// | 2 | [`press_fit`](tutorials::press_fit) | Press a hub on a shaft and compare the pressure with the formula of Lamé |
/// | 3 | [`hertz`](tutorials::hertz) | Hertz contact of a roller on a rail: pressure, half width and the stresses below the surface |
/// | 4 | [`mesh_from_gmsh`](tutorials::mesh_from_gmsh) | Your own mesh from Gmsh: a bracket with bolt holes, its physical groups as bodies and sides |
/// | 5 | [`mesh_from_inp`](tutorials::mesh_from_inp) | Your own mesh from Abaqus or CalculiX: an `.inp` file, and the patch test of MacNeal and Harder on it |
/// | 6 | [`cad_against_mesh`](tutorials::cad_against_mesh) | The exact geometry of a CAD model beside a mesh of it: what facets cost |
/// | 7 | [`convergence_study`](tutorials::convergence_study) | A convergence study for a paper: rates, tables, pictures, and how to state what was run |
/// | 8 | [`steps`](tutorials::steps) | Steps: a load that grows, contact that begins on the way, and its history |
/// | 9 | [`joint_in_space`](tutorials::joint_in_space) | A joint in three dimensions: a shaft of two pieces, splines and hexahedra, under torsion |
/// | 10 | [`contact_in_space`](tutorials::contact_in_space) | Contact in three dimensions: a bearing ball on a block, against the formula of Hertz |
/// | 11 | [`rust_program`](tutorials::rust_program) | Your own Rust program: a press fit for many hubs, by the calls that stand behind a case file |
pub mod tutorials {
    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/01_tie_two_meshes.md"))]
    pub mod tie_two_meshes {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/02_press_fit.md"))]
    pub mod press_fit {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/03_hertz.md"))]
    pub mod hertz {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/04_mesh_from_gmsh.md"))]
    pub mod mesh_from_gmsh {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/05_mesh_from_inp.md"))]
    pub mod mesh_from_inp {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/06_cad_against_mesh.md"))]
    pub mod cad_against_mesh {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/07_convergence_study.md"))]
    pub mod convergence_study {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/08_steps.md"))]
    pub mod steps {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/09_joint_in_space.md"))]
    pub mod joint_in_space {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/10_contact_in_space.md"))]
    pub mod contact_in_space {}

    #[doc = include_str!(concat!(env!("OUT_DIR"), "/tutorials/11_rust_program.md"))]
    pub mod rust_program {}
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
