//! Tests of solver input: structure and numbers.

use super::stage;
use crate::flow::{CapFlow, Flow, OutletModel, Profile, Transient, Waveform};
use crate::volume::fixtures::labelled_tube;
use crate::volume::{MeshNotes, read_mesh};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::{Cap, Patch, VolumeMesh};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Flow rate into the inlet.
const RATE: f64 = 3.0;

/// A tube whose patch 2 is an inlet and whose patch 3 is an outlet.
fn tube() -> VolumeMesh {
    let (mut volume, _) = labelled_tube(9);
    let cap = |normal: f64, z: f64| Cap {
        node: 0,
        center: Point3::new(0.0, 0.0, z),
        normal: Vec3::new(0.0, 0.0, normal),
        radius: 1.0,
    };
    let top = volume.mesh.points.iter().map(|p| p.z).fold(0.0, f64::max);
    let is_at = |face: &[u32; 3], z: f64| face.iter().all(|&v| (volume.mesh.points[v as usize].z - z).abs() < 1e-9);
    let patch = |face: &[u32; 3]| if is_at(face, 0.0) { 2 } else { 1 + 2 * i32::from(is_at(face, top)) };
    volume.boundary_patch = volume.boundary.iter().map(patch).collect();
    let ends = ends(&volume);
    volume.patches = vec![
        Patch { id: 1, name: "wall".into(), cap: None },
        Patch { id: 2, name: "inlet".into(), cap: Some(cap(ends[0].1, ends[0].0)) },
        Patch { id: 3, name: "outlet_0".into(), cap: Some(cap(ends[1].1, ends[1].0)) },
    ];
    volume
}

/// Height and outward direction of patches 2 and 3.
fn ends(volume: &VolumeMesh) -> [(f64, f64); 2] {
    let height = |id: i32| {
        let face = volume.boundary_patch.iter().position(|&patch| patch == id).unwrap();
        volume.mesh.points[volume.boundary[face][0] as usize].z
    };
    let [a, b] = [height(2), height(3)];
    [(a, (a - b).signum()), (b, (b - a).signum())]
}

fn pulse() -> Waveform {
    Waveform::new(vec![0.0, 0.25, 1.0], vec![RATE, 3.0 * RATE, RATE]).unwrap()
}

fn flow(outlet: OutletModel, waveform: Option<Waveform>) -> Flow {
    let inlet = CapFlow::default().flow(RATE).waveform(waveform.clone());
    let outlet = CapFlow::default().flow(RATE).outlet(outlet);
    let transient = waveform.map(|waveform| Transient::new(waveform.period()).periods(2).outputs(7));
    Flow::new(1.0, 0.1).caps(BTreeMap::from([(2, inlet), (3, outlet)])).transient(transient)
}

/// Folder of a case.
fn written(folder: &Path, flow: Flow) -> PathBuf {
    let path = folder.join("case.svmesh");
    stage(&path, &tube(), None, &MeshNotes { flow: Some(flow), ..MeshNotes::default() }, &()).unwrap().place().unwrap();
    path
}

/// Text of each element by its path, with names of patches; fails unless the file is well-formed.
fn elements(folder: &Path) -> BTreeMap<String, String> {
    let text = fs::read_to_string(folder.join("solver.xml")).unwrap();
    let mut reader = quick_xml::Reader::from_str(&text);
    let (mut path, mut found) = (Vec::<String>::new(), BTreeMap::new());
    loop {
        match reader.read_event().unwrap() {
            quick_xml::events::Event::Start(start) => {
                let name = start.name().as_ref().to_owned();
                let attribute = start.attributes().next().map(|a| a.unwrap().value.into_owned());
                path.push(attribute.map_or(name.clone(), |attribute| format!("{name} {attribute}")));
            }
            quick_xml::events::Event::End(_) => drop(path.pop()),
            quick_xml::events::Event::Text(text) => {
                let text = text.as_ref().to_owned();
                if !text.trim().is_empty() {
                    found.insert(path[1..].join("/"), text.trim().to_owned());
                }
            }
            quick_xml::events::Event::Eof => break,
            _ => {}
        }
    }
    assert!(path.is_empty(), "{path:?}");
    found
}

/// Elements of the condition at a patch.
fn condition(all: &BTreeMap<String, String>, patch: &str) -> BTreeMap<String, String> {
    let start = format!("Add_equation fluid/Add_BC {patch}/");
    let own = all.iter().filter_map(|(path, text)| Some((path.strip_prefix(&start)?.to_owned(), text.clone())));
    own.collect()
}

fn number(all: &BTreeMap<String, String>, path: &str) -> f64 {
    all.get(path).unwrap_or_else(|| panic!("no {path} in {all:?}")).parse().unwrap()
}

/// Numbers of a table, by line.
fn table(path: &Path) -> Vec<Vec<f64>> {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.lines().all(|line| line.trim() == line && !line.is_empty()), "{text}");
    text.lines().map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
}

#[test]
fn each_outlet_model_has_its_condition() {
    let folder = tempfile::tempdir().unwrap();
    let of = |outlet| condition(&elements(&written(folder.path(), flow(outlet, None))), "outlet_0");
    let text = |pairs: &[(&str, &str)]| -> BTreeMap<String, String> {
        pairs.iter().map(|&(path, text)| (path.to_owned(), text.to_owned())).collect()
    };
    let pressure = of(OutletModel::Pressure(5.0));
    assert_eq!(pressure, text(&[("Type", "Neu"), ("Time_dependence", "Steady"), ("Value", "5e0")]));
    let resistance = of(OutletModel::Resistance { resistance: 4.0, distal_pressure: 7.0 });
    assert_eq!(resistance, text(&[("Type", "Neu"), ("Time_dependence", "Resistance"), ("Value", "4e0")]));
    let comment = fs::read_to_string(folder.path().join("case.svmesh/solver.xml")).unwrap();
    assert!(comment.contains("Add 7e0, the pressure beyond the outlets"), "{comment}");
    let rcr = of(OutletModel::Rcr { proximal: 1.0, capacitance: 0.5, distal: 2.0, distal_pressure: 7.0 });
    let expected = [
        ("Type", "Neu"),
        ("Time_dependence", "RCR"),
        ("RCR_values/Proximal_resistance", "1e0"),
        ("RCR_values/Capacitance", "5e-1"),
        ("RCR_values/Distal_resistance", "2e0"),
        ("RCR_values/Distal_pressure", "7e0"),
        // Distal pressure and the mean flow rate through the distal resistance.
        ("RCR_values/Initial_pressure", "1.3e1"),
    ];
    assert_eq!(rcr, text(&expected));
}

#[test]
fn steady_flow_rises_linearly_and_settles() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), flow(OutletModel::default(), None));
    let all = elements(&path);
    let inlet = condition(&all, "inlet");
    let get = |name: &str| inlet[name].as_str();
    assert_eq!(["Type", "Time_dependence", "Ramp_function"].map(get), ["Dir", "Unsteady", "true"]);
    assert_eq!(["Profile", "Impose_flux"].map(get), ["Parabolic", "true"]);
    let [step, count, increment] = ["Time_step_size", "Number_of_time_steps", "Increment_in_saving_VTK_files"]
        .map(|name| number(&all, &format!("GeneralSimulationParameters/{name}")));
    let diffusion = 1.0 * 1.0 / 0.1;
    assert!((step * count / (4.0 * diffusion) - 1.0).abs() < 1e-12, "{step} {count}");
    assert!((count / 4.0 - increment).abs() < 1e-12);
    // The rate is negative, as the normal points out.
    assert_eq!(
        table(&path.join(get("Temporal_values_file_path"))),
        [vec![2.0, 1.0], vec![0.0, 0.0], vec![diffusion, -RATE]]
    );
    assert_eq!(number(&all, "Add_equation fluid/Min_iterations"), 1.0);
    let uniform = flow(OutletModel::default(), None).profile(Profile::Uniform);
    assert_eq!(condition(&elements(&written(folder.path(), uniform)), "inlet")["Profile"], "Flat");
}

#[test]
fn fast_flow_takes_shorter_steps() {
    let folder = tempfile::tempdir().unwrap();
    let mut courant = Vec::new();
    for scale in [1e-3, 1.0, 10.0] {
        let mut fast = flow(OutletModel::default(), None);
        fast.caps.get_mut(&2).unwrap().flow *= scale;
        let all = elements(&written(folder.path(), fast));
        courant.push(number(&all, "GeneralSimulationParameters/Time_step_size") * scale);
    }
    // Slow flow has ten steps per diffusion time; above, the step is inverse to the speed.
    assert!((courant[0] / 1e-3 - 1.0).abs() < 1e-12, "{courant:?}");
    assert!((courant[1] / courant[2] - 1.0).abs() < 0.05, "{courant:?}");
}

#[test]
fn pulsatile_flow_is_a_table_longer_than_the_simulation() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path(), flow(OutletModel::default(), Some(pulse())));
    let all = elements(&path);
    let general = |name: &str| number(&all, &format!("GeneralSimulationParameters/{name}"));
    let (step, count) = (general("Time_step_size"), general("Number_of_time_steps"));
    assert!((step * count - 2.0).abs() < 1e-12);
    assert_eq!(count / general("Increment_in_saving_VTK_files"), 14.0);
    assert_eq!(count / general("Increment_in_saving_restart_files"), 2.0);
    let inlet = condition(&all, "inlet");
    assert!(!inlet.contains_key("Ramp_function"));
    let rows = table(&path.join(&inlet["Temporal_values_file_path"]));
    assert_eq!(rows[0], [(rows.len() - 1) as f64, 128.0 * 3.0]);
    assert_eq!(rows[1], [0.0, 0.0]);
    assert!((rows[rows.len() - 1][0] - 3.0).abs() < 1e-12);
    for row in &rows[1..] {
        let expected = -pulse().at(row[0]) * (row[0] / 0.1).min(1.0);
        assert!((row[1] - expected).abs() < 1e-9, "{row:?} {expected}");
    }
    assert!(rows[1..].windows(2).all(|pair| pair[1][0] > pair[0][0]));
    // Without a ramp the solver repeats one period.
    let mut steady = flow(OutletModel::default(), Some(pulse()));
    steady.transient = steady.transient.map(|time| time.ramp(0.0));
    let path = written(folder.path(), steady);
    let rows = table(&path.join("inlet.flow"));
    assert_eq!(rows, [[3.0, 128.0], [0.0, -RATE], [0.25, -3.0 * RATE], [1.0, -RATE]]);
}

#[test]
fn womersley_velocities_carry_the_flow_rate() {
    let folder = tempfile::tempdir().unwrap();
    let mut pulsatile = flow(OutletModel::default(), Some(pulse())).profile(Profile::Womersley);
    pulsatile.transient = pulsatile.transient.map(|time| time.ramp(0.0));
    let path = written(folder.path(), pulsatile);
    let inlet = condition(&elements(&path), "inlet");
    assert_eq!(inlet["Time_dependence"], "General");
    let rows = table(&path.join(&inlet["Temporal_and_spatial_values_file_path"]));
    let [components, times, points] = [0, 1, 2].map(|i| rows[0][i] as usize);
    assert_eq!((components, rows.len()), (3, 1 + times + points * (1 + times)));
    let blocks: BTreeMap<usize, &[Vec<f64>]> =
        rows[1 + times..].chunks(1 + times).map(|block| (block[0][0] as usize - 1, &block[1..])).collect();
    let volume = tube();
    let direction = -ends(&volume)[0].1;
    let faces = volume.boundary.iter().zip(&volume.boundary_patch).filter(|(_, patch)| **patch == 2);
    let faces: Vec<[usize; 3]> = faces.map(|(face, _)| face.map(|v| v as usize)).collect();
    for k in [0, times / 3, times - 1] {
        let flux = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|v| volume.mesh.points[v]);
            let area = (b - a).cross(&(c - a)).norm() / 2.0;
            face.iter().map(|v| area / 3.0 * blocks[v][k][2] * direction).sum::<f64>()
        };
        let (found, expected) = (faces.iter().map(flux).sum::<f64>(), pulse().at(rows[1 + k][0]));
        assert!((found / expected - 1.0).abs() < 1e-9, "{k}: {found} {expected}");
    }
    assert!(path.join("inlet.flow").metadata().is_err());
}

/// Integral of a component's values over a curved face with six nodes, by small triangles.
fn integral(nodes: &[Point3; 6], values: &[f64; 6]) -> f64 {
    const STEPS: u32 = 40;
    let basis = |x: f64, y: f64| {
        let z = 1.0 - x - y;
        let corner = |x: f64| x * (2.0 * x - 1.0);
        [corner(x), corner(y), corner(z), 4.0 * x * y, 4.0 * y * z, 4.0 * z * x]
    };
    let at = |[i, j]: [u32; 2]| {
        let basis = basis(f64::from(i) / f64::from(STEPS), f64::from(j) / f64::from(STEPS));
        let point: Vec3 = nodes.iter().zip(basis).map(|(node, share)| node.coords * share).sum();
        (point, values.iter().zip(basis).map(|(value, share)| value * share).sum::<f64>())
    };
    let part = |corners: [[u32; 2]; 3]| {
        let [(a, f), (b, g), (c, h)] = corners.map(at);
        (b - a).cross(&(c - a)).norm() / 2.0 * (f + g + h) / 3.0
    };
    let mut sum = 0.0;
    for i in 0..STEPS {
        for j in 0..STEPS - i {
            sum += part([[i, j], [i + 1, j], [i, j + 1]]);
            if i + j + 1 < STEPS {
                sum += part([[i + 1, j], [i + 1, j + 1], [i, j + 1]]);
            }
        }
    }
    sum
}

#[test]
fn second_order_elements_have_ten_nodes_and_their_velocities_the_flow_rate() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.svmesh");
    let volume = tube();
    let second = SecondOrder::curved(&volume).0;
    let mut flow = flow(OutletModel::default(), Some(pulse())).profile(Profile::Womersley);
    flow.transient = flow.transient.map(|time| time.ramp(0.0));
    stage(&path, &volume, Some(&second), &MeshNotes { flow: Some(flow), ..MeshNotes::default() }, &())
        .unwrap()
        .place()
        .unwrap();
    let all = elements(&path);
    assert_eq!(all["Add_equation fluid/Use_taylor_hood_type_basis"], "true");
    assert_eq!(read_mesh(&path.join("mesh-complete.mesh.vtu")).unwrap().second_order.as_ref(), Some(&second));

    let rows = table(&path.join(&condition(&all, "inlet")["Temporal_and_spatial_values_file_path"]));
    let times = rows[0][1] as usize;
    let speeds: BTreeMap<u32, f64> =
        rows[1 + times..].chunks(1 + times).map(|block| (block[0][0] as u32 - 1, block[1][2])).collect();
    let points = [&volume.mesh.points[..], second.middles()].concat();
    let faces = volume.boundary.iter().zip(&volume.boundary_patch).filter(|(_, patch)| **patch == 2);
    let faces: Vec<[u32; 6]> = faces.map(|(face, _)| second.face_nodes(*face)).collect();
    assert!(speeds.keys().all(|node| faces.iter().any(|face| face.contains(node))));
    let flux = |face: &[u32; 6]| integral(&face.map(|v| points[v as usize]), &face.map(|v| speeds[&v]));
    let (found, expected) = (faces.iter().map(flux).sum::<f64>(), -ends(&volume)[0].1 * pulse().at(rows[1][0]));
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    // Nodes of the rim do not move.
    let still = speeds.values().filter(|speed| **speed == 0.0).count();
    assert!(still > 0 && still % 2 == 0, "{still}");
}
