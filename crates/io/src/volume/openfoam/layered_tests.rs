//! Tests of meshes with layers, flow in time and outlet models.

use super::*;
use crate::flow::{CapFlow, OutletModel, Profile, Transient, Waveform};
use crate::volume::fixtures::slab;
use crate::volume::{WriteOptions, write_mesh, write_mesh_with};
use std::fs;

fn written(flow: Flow) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let notes = MeshNotes { flow: Some(flow), ..MeshNotes::default() };
    write_mesh(&folder.path().join("a.foam"), &slab(), &notes).unwrap();
    folder
}

fn text(folder: &tempfile::TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join("a.foam").join(name)).unwrap()
}

fn flow_with(caps: [(i32, CapFlow); 2]) -> Flow {
    Flow::new(1000.0, 4e-3).caps(caps.into())
}

fn pulse() -> Waveform {
    Waveform::new(vec![0.0, 0.25, 1.0], vec![1e-3, 3e-3, 1e-3]).unwrap()
}

#[test]
fn layers_are_prisms_with_quadrilaterals_between_them_and_on_caps() {
    let folder = written(Flow::new(1.0, 1.0));
    let mesh = folder.path().join("a.foam/constant/polyMesh");
    let [faces, owner, neighbour] = ["faces", "owner", "neighbour"].map(|name| super::tests::lists(&mesh.join(name)));
    let (starts, corners) = (&faces[0], &faces[1]);
    assert_eq!(*starts.last().unwrap() as usize, corners.len());
    let all: Vec<&[u32]> = starts.windows(2).map(|two| &corners[two[0] as usize..two[1] as usize]).collect();
    // Between the prisms: two quadrilaterals side by side, two triangles one above the other.
    let cells: Vec<(u32, u32)> = owner[0].iter().copied().zip(neighbour[0].iter().copied()).collect();
    assert_eq!(cells, [(0, 1), (0, 2), (1, 3), (2, 3)]);
    assert_eq!(all[..4].iter().map(|face| face.len()).collect::<Vec<_>>(), [3, 4, 4, 3]);
    // On the wall and below two triangles each, on the sides quadrilaterals.
    let outer: Vec<usize> = all[4..].iter().map(|face| face.len()).collect();
    assert_eq!(outer, [vec![3; 2], vec![4; 2], vec![3; 2], vec![4; 6]].concat());
    let boundary = text(&folder, "constant/polyMesh/boundary");
    assert!(boundary.contains("inlet { type patch; inGroups 1(inlets); nFaces 2; startFace 6; }"), "{boundary}");
    // Each cell is closed, with its faces oriented outwards.
    let points = slab().mesh.points;
    for cell in 0..4 {
        let mut sum = [0.0; 3];
        for (i, face) in all.iter().enumerate() {
            let sign = match (owner[0][i] == cell, neighbour[0].get(i) == Some(&cell)) {
                (true, _) => 1.0,
                (_, true) => -1.0,
                _ => continue,
            };
            for k in 1..face.len() - 1 {
                let [a, b, c] = [face[0], face[k], face[k + 1]].map(|v| points[v as usize]);
                let area = (b - a).cross(&(c - a)) * 0.5 * sign;
                (0..3).for_each(|axis| sum[axis] += area[axis]);
            }
        }
        assert!(sum.iter().all(|x| x.abs() < 1e-12), "{cell} {sum:?}");
    }
}

#[test]
fn flow_in_time_has_a_ramp_a_table_and_final_solvers() {
    let inlet = CapFlow::default().flow(2e-3).waveform(Some(pulse()));
    let rcr = OutletModel::Rcr { proximal: 2e3, capacitance: 1e-4, distal: 8e3, distal_pressure: 500.0 };
    let outlet = CapFlow::default().flow(2e-3).outlet(rcr);
    let flow = flow_with([(2, inlet), (3, outlet)]).transient(Some(Transient::new(1.0).periods(2).outputs(10)));
    let folder = written(flow);
    assert_eq!(text(&folder, "constant/inflow/inlet"), "(\n    (0 1e-3)\n    (0.25 3e-3)\n    (1 1e-3)\n)\n");
    let velocity = text(&folder, "0/U");
    for part in ["halfCosineRamp; start 0; duration 1e-1", "outOfBounds repeat; file \"<constant>/inflow/inlet\""] {
        assert!(velocity.contains(part), "{velocity}");
    }
    let control = text(&folder, "system/controlDict");
    for part in ["pimpleFoam", "endTime         2;", "writeInterval   0.1;", "adjustTimeStep  yes"] {
        assert!(control.contains(part), "{control}");
    }
    let solution = text(&folder, "system/fvSolution");
    assert!(solution.contains("UFinal") && solution.contains("pFinal") && solution.contains("PIMPLE"));
    assert!(solution.contains("nNonOrthogonalCorrectors 0;"), "outlets follow each flow rate");
    assert!(text(&folder, "system/fvSchemes").contains("default backward"));
    // By density. The pressure starts behind the proximal resistance: 0.5 + 8 · 2e-3.
    let pressure = text(&folder, "0/p");
    let line = "outlet_0 { $outletModel; Rp 2e0; Rd 8e0; tau 8e-1; P 5e-1; value uniform 5.16e-1; }";
    assert!(pressure.contains(line), "{pressure}");
    assert!(pressure.contains("\"R=Rp+Rd*dt/(tau+dt)\"") && pressure.contains("internalField   uniform 5.16e-1"));
}

#[test]
fn steady_outlets_have_a_pressure_or_a_resistance() {
    let resistance = OutletModel::Resistance { resistance: 3e3, distal_pressure: 0.0 };
    let flow = flow_with([(2, CapFlow::default().flow(1e-3)), (3, CapFlow::default().outlet(resistance))]);
    let pressure = text(&written(flow), "0/p");
    assert!(pressure.contains("outlet_0 { $outletModel; Rp 3e0; Rd 0e0;") && pressure.contains("\"R=Rp+Rd\""));
    let flow = flow_with([(2, CapFlow::default()), (3, CapFlow::default().outlet(OutletModel::Pressure(2000.0)))]);
    let pressure = text(&written(flow), "0/p");
    assert!(pressure.contains("value uniform 2e0;") && !pressure.contains("outletModel"), "{pressure}");
}

#[test]
fn a_profile_is_written_as_velocities_of_the_faces() {
    let inlet = CapFlow::default().flow(2e-3).waveform(Some(pulse()));
    let flow = flow_with([(2, inlet), (3, CapFlow::default())]).profile(Profile::Womersley);
    let folder = written(flow.clone().transient(Some(Transient::new(1.0).periods(1))));
    assert!(text(&folder, "0/U").contains("timeVaryingMappedFixedValue"));
    let points = text(&folder, "constant/boundaryData/inlet/points");
    assert!(points.starts_with("2\n(\n"), "{points}");
    assert!(text(&folder, "constant/boundaryData/inlet/0.25/U").starts_with("2\n(\n"));
    // A new run replaces the files of the old one.
    let path = folder.path().join("a.foam");
    let notes = MeshNotes { flow: Some(flow), ..MeshNotes::default() };
    write_mesh(&path, &slab(), &notes).unwrap();
    let times: Vec<_> = fs::read_dir(path.join("constant/boundaryData/inlet")).unwrap().collect();
    assert_eq!(times.len(), 2, "points and the steady velocities");
}

#[test]
fn a_case_that_cannot_converge_is_remarked() {
    let folder = tempfile::tempdir().unwrap();
    let flow = flow_with([(2, CapFlow::default().flow(1e3)), (3, CapFlow::default())]);
    let notes = MeshNotes { flow: Some(flow), ..MeshNotes::default() };
    let remarks = std::cell::RefCell::new(Vec::new());
    let remark = |text: &str| remarks.borrow_mut().push(text.to_owned());
    let options = WriteOptions::default().remark(&remark as &dyn Fn(&str));
    write_mesh_with(&options, &folder.path().join("a.foam"), &slab(), &notes, &()).unwrap();
    assert!(remarks.borrow()[0].contains("beyond laminar flow"), "{remarks:?}");
}
