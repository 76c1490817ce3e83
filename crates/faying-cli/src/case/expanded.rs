//! The patches of a file as patches of the case, and what those of one mesh share.

use super::family::{Family, Label, MeshSource};
use super::mesh_part::{met, shared};
use super::part::{FilePart, MeshPart};
use super::reader::Reader;
use super::types::*;
use crate::place::Located;
use std::collections::BTreeMap;

impl Reader {
    /// Expands a patch of a file with several patches into NAME.0, NAME.1, ..; records the facets that groups of one mesh share.
    pub fn expand(&mut self, patches: Vec<Patch>) -> Vec<Patch> {
        let all = std::mem::take(&mut self.from_files);
        let mut out: Vec<Patch> = Vec::with_capacity(patches.len());
        let mut meshes: Vec<(usize, MeshSource)> = Vec::new();
        for (mut patch, from) in patches.into_iter().zip(all) {
            let Some(from) = from else {
                out.push(patch);
                continue;
            };
            let first = out.len();
            let parts = match &mut patch.geometry.value.shape.value {
                Shape::File { parts, .. } => std::mem::take(parts),
                _ => Vec::new(),
            };
            let name = patch.name.clone();
            let single = parts.len() == 1;
            for (k, part) in parts.into_iter().enumerate() {
                let mut one = patch.clone();
                if let Shape::File { parts, .. } = &mut one.geometry.value.shape.value {
                    parts.push(part);
                }
                if !single {
                    one.name = Located::new(format!("{}.{k}", name.value), name.at);
                }
                out.push(one);
            }
            let labels = from.labels.into_iter().map(|(name, sides)| Label {
                name,
                sides: sides.into_iter().map(|(k, side)| SideRef { patch: first + k, side }).collect(),
            });
            self.families.push(Family { name: name.value.clone(), patches: first..out.len(), labels: labels.collect() });
            if let Some(source) = from.mesh {
                meshes.push((first, source));
            }
        }
        self.mesh_joints(&mut out, meshes);
        out
    }

    // groups of one mesh share the facets that have the same points in the file
    fn mesh_joints(&mut self, patches: &mut [Patch], mut meshes: Vec<(usize, MeshSource)>) {
        while let Some((first, source)) = meshes.first().cloned() {
            let (same, others): (Vec<_>, Vec<_>) = meshes.into_iter().partition(|(_, s)| *s == source);
            meshes = others;
            let members: Vec<usize> = same.into_iter().map(|(k, _)| k).collect();
            if members.len() < 2 {
                continue;
            }
            self.overlap(patches, &members);
            match patches[first].geometry.shape.part() {
                Some(FilePart::Plane(_)) => self.join(patches, &members, plane, plane_mut),
                Some(FilePart::Space(_)) => self.join(patches, &members, space, space_mut),
                _ => {}
            }
        }
    }

    // reports a cell that is in two patches (E015)
    fn overlap(&mut self, patches: &[Patch], members: &[usize]) {
        let mut owner: BTreeMap<u64, usize> = BTreeMap::new();
        for &k in members {
            let ids = match patches[k].geometry.shape.part() {
                Some(FilePart::Plane(p)) => &p.ids,
                Some(FilePart::Space(p)) => &p.ids,
                _ => continue,
            };
            let twice = ids.iter().find_map(|id| Some((*id, owner.insert(*id, k).filter(|o| *o != k)?)));
            if let Some((id, other)) = twice {
                let message =
                    format!("cell {id} of the file is in patches {:?} and {:?}", patches[other].name.value, patches[k].name.value);
                self.fault("E015", patches[k].geometry.at, message, "patches of one mesh take different groups, which share no cell");
                return;
            }
        }
    }

    fn join<const N: usize>(&mut self, patches: &mut [Patch], members: &[usize], get: Get<N>, get_mut: GetMut<N>) {
        let parts: Vec<&MeshPart<N>> = members.iter().filter_map(|k| get(&patches[*k])).collect();
        if parts.len() < members.len() {
            return;
        }
        let common = shared(&parts);
        let met = met(&parts, &common);
        for ([a, b], facets) in common {
            let (a, b) = (members[a], members[b]);
            let names = [a, b].map(|k| patches[k].name.value.clone());
            let mut add = |k: usize, other: &str| {
                let facets = facets.clone();
                let side = get_mut(&mut patches[k]).map_or(String::new(), |p| p.add_side(&format!("joint with {other}"), facets));
                SideRef { patch: k, side }
            };
            let sides = [add(a, &names[1]), add(b, &names[0])];
            self.joints.push(Joint { sides, at: patches[b].geometry.at });
        }
        for (point, places) in met {
            let patches_there: Vec<usize> = places.iter().map(|k| members[*k]).collect();
            let at = patches[*patches_there.last().expect("points are met by two")].geometry.at;
            self.meetings.push(Meeting { patches: patches_there, point, at });
        }
    }
}

type Get<const N: usize> = fn(&Patch) -> Option<&MeshPart<N>>;
type GetMut<const N: usize> = fn(&mut Patch) -> Option<&mut MeshPart<N>>;

fn plane(patch: &Patch) -> Option<&MeshPart<2>> {
    match patch.geometry.shape.part() {
        Some(FilePart::Plane(p)) => Some(p),
        _ => None,
    }
}

fn space(patch: &Patch) -> Option<&MeshPart<3>> {
    match patch.geometry.shape.part() {
        Some(FilePart::Space(p)) => Some(p),
        _ => None,
    }
}

fn plane_mut(patch: &mut Patch) -> Option<&mut MeshPart<2>> {
    match patch.geometry.value.shape.value.part_mut()? {
        FilePart::Plane(p) => Some(p),
        _ => None,
    }
}

fn space_mut(patch: &mut Patch) -> Option<&mut MeshPart<3>> {
    match patch.geometry.value.shape.value.part_mut()? {
        FilePart::Space(p) => Some(p),
        _ => None,
    }
}
