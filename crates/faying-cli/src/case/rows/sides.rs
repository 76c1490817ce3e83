//! `[[boundary]]`.

use super::common::name;
use crate::case::key::{Key, KeyKind, Only, Special};

const ELASTIC: Only = Only { holds: |_, s| !s.poisson, of: "elasticity", instead: "use neumann" };
const COMPONENTS: Special = Special::Components { exact: false };
const DATA: Special = Special::Components { exact: true };

pub(in crate::case) const BOUNDARY: &[Key] = &[
    name(),
    Key::of("on", Special::Sides, "a side PATCH.SIDE, a list, or all-outer: sides in no other block; of supports and forces also an edge or a corner PATCH.u0v0, and named points and inner lines of meshes").required("\"lower.bottom\""),
    Key::new("where", KeyKind::Formula, "keeps only the facets whose centre satisfies it").optional("\"x > 0.9\""),
    Key::of(
        "fix",
        Special::Only(
            "a list of components, \"normal\", \"tangential\"",
            r#"{"anyOf":[{"enum":["x","y","z","u","normal","tangential"]},{"type":"array","minItems":1,"items":{"enum":["x","y","z","u","normal","tangential"]}}]}"#,
        ),
        "components that are zero; \"normal\": n . u, \"tangential\": the rest of u, on planar sides and on curved ones of bodies with an exact map",
    )
    .optional("[\"x\", \"y\"]"),
    Key::of("dirichlet", DATA, "prescribed values; \"exact\" follows from the exact solution").optional("{ y = \"-0.002\" }"),
    Key::of("neumann", DATA, "flux k du/dn or traction; \"exact\" follows from the exact solution").optional("\"exact\""),
    Key::of("traction", DATA, "force per area").unit("force/area").optional("{ y = \"-1\" }").only(ELASTIC),
    Key::new("pressure", KeyKind::Formula, "force per area along minus the outward normal").unit("force/area").optional("1.0").only(ELASTIC),
    Key::of("force", COMPONENTS, "resultant, spread evenly; on corners and edges, points and lines of meshes, too").unit("force").optional("{ y = -1000 }"),
    Key::of("spring", COMPONENTS, "force per area and length").unit("force/area/length").optional("{ x = 1e3 }"),
    Key::of("rigid_force", COMPONENTS, "rigid side: equal displacement in this direction, total force given").unit("force").optional("{ y = -1.0 }"),
];
