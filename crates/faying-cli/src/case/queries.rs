//! Questions to a case: its sides and patches by their names.

use super::sides;
use super::types::{Case, SideRef};
use crate::errors::Diagnostic;
use crate::place::SourceSpan;
use std::ops::Range;

impl Case {
    /// The case with every default written out, as a case file that reads back to the same case.
    pub fn effective_toml(&self) -> &str {
        &self.effective
    }

    /// Components of the unknown: 1 for Poisson, the dimension for elasticity.
    pub fn components(&self) -> usize {
        self.model.components()
    }

    /// Whether the case has `[steps]`; without it there is one step at t = 1.
    pub fn has_steps(&self) -> bool {
        self.steps.at != SourceSpan::NONE
    }

    /// The position of a patch by its name.
    pub fn patch_index(&self, name: &str) -> Option<usize> {
        self.patches.iter().position(|p| p.name.value == name)
    }

    /// `lower.v0`: the name of a side in results.
    pub fn side_name(&self, side: &SideRef) -> String {
        sides::show(side, &self.patches)
    }

    /// The sides of a patch, without collapsed edges.
    pub fn sides(&self, patch: usize) -> Vec<&str> {
        self.patches.get(patch).map_or(Vec::new(), |p| sides::sides_of(&p.geometry.shape, self.model.dimension.value))
    }

    /// The sides named by a text: `lower.top`, `bracket."top face"`, or a name that a file gives to several; empty if there is no
    /// such side.
    pub fn find_sides(&self, text: &str) -> Vec<SideRef> {
        sides::find(text, &self.patches, &self.families, self.model.dimension.value).unwrap_or_default()
    }

    /// The patches of a name: one, or all patches of a file.
    pub fn find_patches(&self, name: &str) -> Vec<usize> {
        if let Some(k) = self.patch_index(name) {
            return vec![k];
        }
        self.families.iter().find(|f| f.name == name).map_or(Vec::new(), |f| f.patches.clone().collect())
    }

    /// The patches of every file whose touching sides are glued, with the place of their block.
    pub fn glued_files(&self) -> Vec<(Range<usize>, SourceSpan)> {
        let glued = self.families.iter().filter(|f| f.patches.len() > 1 && self.patches[f.patches.start].glue.value);
        glued.map(|f| (f.patches.clone(), self.patches[f.patches.start].geometry.at)).collect()
    }

    /// A diagnostic at a place of this case.
    pub fn diagnostic(&self, diagnostic: Diagnostic, at: SourceSpan) -> Diagnostic {
        diagnostic.at(&self.source, at)
    }
}
