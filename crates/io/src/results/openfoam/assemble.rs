//! Mesh and fields to a result.

use super::dictionary::{Dictionary, Entry, Field};
use super::poly_mesh::{FoamPatch, PolyMesh};
use crate::results::content::{FlowResult, InnerFlux, Near, OuterFlux};
use crate::results::error::ResultFault;
use anastomesh_mesh::geometry::Vec3;

/// Contents of the field files.
pub(super) struct Fields {
    pub velocity: Dictionary,
    pub pressure: Dictionary,
    /// Flow rates through faces.
    pub flux: Option<Dictionary>,
    pub shear: Option<Dictionary>,
}

/// Values of a field on the faces of a patch; `None` if the file has no values there.
fn on_patch(
    field: &Dictionary,
    what: &str,
    patch: &FoamPatch,
    components: usize,
) -> Result<Option<Vec<f64>>, ResultFault> {
    let Some(Entry::Dictionary(boundary)) = field.get("boundaryField") else {
        return Err(ResultFault::Missing { what: format!("boundaryField of {what}") });
    };
    let Some(Entry::Dictionary(condition)) = boundary.get(&patch.name) else {
        return Err(ResultFault::Missing { what: format!("patch {} of {what}", patch.name) });
    };
    match condition.get("value") {
        Some(Entry::Field(values)) => {
            values.expand(&format!("patch {} of {what}", patch.name), patch.count, components).map(Some)
        }
        _ => Ok(None),
    }
}

fn internal<'a>(field: &'a Dictionary, what: &str) -> Result<&'a Field, ResultFault> {
    match field.get("internalField") {
        Some(Entry::Field(values)) => Ok(values),
        _ => Err(ResultFault::Missing { what: format!("internalField of {what}") }),
    }
}

fn vectors(values: &[f64]) -> Vec<Vec3> {
    values.as_chunks::<3>().0.iter().map(|&v| Vec3::from(v)).collect()
}

pub(super) fn assemble(mesh: &PolyMesh, fields: &Fields, name: String) -> Result<FlowResult, ResultFault> {
    if !mesh.patches.iter().any(|patch| patch.is_wall) {
        let found: Vec<&str> = mesh.patches.iter().map(|patch| patch.name.as_str()).collect();
        return Err(ResultFault::NoWall { found: format!("patches {}", found.join(", ")) });
    }
    let (cells, inner) = (mesh.cells.len(), mesh.neighbour.len());
    let velocity = vectors(&internal(&fields.velocity, "U")?.expand("U", cells, 3)?);
    let pressures = internal(&fields.pressure, "p")?.expand("p", cells, 1)?;
    let flux = match &fields.flux {
        Some(flux) => internal(flux, "phi")?.expand("phi", inner, 1)?,
        None => interpolated(mesh, &velocity),
    };
    let sides = mesh.owner.iter().zip(&mesh.neighbour).zip(flux);
    let mut result = FlowResult {
        name,
        inner: sides.map(|((&a, &b), flux)| InnerFlux { cells: [a, b], flux }).collect(),
        is_kinematic: is_kinematic(&fields.pressure),
        ..FlowResult::default()
    };
    for patch in &mesh.patches {
        add_patch(mesh, fields, patch, (&velocity, &pressures), &mut result)?;
    }
    (result.cells, result.volumes, result.pressures) = (mesh.cells.clone(), mesh.volumes.clone(), pressures);
    Ok(result)
}

/// True unless the pressure has the unit of mass.
fn is_kinematic(pressure: &Dictionary) -> bool {
    match pressure.get("dimensions") {
        Some(Entry::Words(words)) => !words.trim_start_matches('[').trim_start().starts_with('1'),
        _ => true,
    }
}

/// Flow rates by the mean velocity of both cells.
fn interpolated(mesh: &PolyMesh, velocity: &[Vec3]) -> Vec<f64> {
    let sides = mesh.owner.iter().zip(&mesh.neighbour).zip(&mesh.areas);
    sides.map(|((&a, &b), area)| 0.5 * (velocity[a as usize] + velocity[b as usize]).dot(area)).collect()
}

fn add_patch(
    mesh: &PolyMesh,
    fields: &Fields,
    patch: &FoamPatch,
    (velocity, pressures): (&[Vec3], &[f64]),
    result: &mut FlowResult,
) -> Result<(), ResultFault> {
    let speeds = on_patch(&fields.velocity, "U", patch, 3)?.map(|values| vectors(&values));
    let pressure = on_patch(&fields.pressure, "p", patch, 1)?;
    let flux = fields.flux.as_ref().map(|flux| on_patch(flux, "phi", patch, 1)).transpose()?.flatten();
    let shear = match &fields.shear {
        Some(shear) if patch.is_wall => on_patch(shear, "wallShearStress", patch, 3)?.map(|values| vectors(&values)),
        _ => None,
    };
    for (at, face) in (patch.first..patch.first + patch.count).enumerate() {
        let (cell, area, center) = (mesh.owner[face], mesh.areas[face], mesh.centers[face]);
        let own = velocity[cell as usize];
        let speed = speeds.as_ref().map_or(if patch.is_wall { Vec3::zeros() } else { own }, |speeds| speeds[at]);
        let offset = mesh.cells[cell as usize] - center;
        result.outer.push(OuterFlux {
            cell,
            center,
            area,
            flux: flux.as_ref().map_or_else(|| speed.dot(&area), |flux| flux[at]),
            // Without values the gradient is zero.
            pressure: pressure.as_ref().map_or(pressures[cell as usize], |pressure| pressure[at]),
            is_wall: patch.is_wall,
            shear: shear.as_ref().map(|shear| shear[at].norm()),
            near: Near::of(&own, &offset, &area),
        });
    }
    Ok(())
}
