//! Stores keep what they were given, and a work directory survives whatever happens to it.

use std::fs;
use std::io::Write;

use super::error::Difference;
use super::*;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_skeleton::{Node, Skeleton};

fn key(i: u32) -> Key {
    let mut maker = KeyMaker::new("test");
    maker.id(i);
    maker.finish()
}

fn manifest(rho: f64) -> Manifest {
    Manifest::new(&Skeleton::default(), serde_json::json!({ "mesh": { "rho": rho }, "refine": null }))
}

fn record(i: u32) -> Vec<u8> {
    (0..100 + 13 * i).map(|k| (k * 7 + i) as u8).collect()
}

fn open(folder: &Path) -> Store {
    Store::in_folder(folder, &manifest(3.0), false).expect("a work directory")
}

/// The records 0 to n − 1, however they came in there.
fn assert_holds(store: &Store, n: u32) {
    for i in 0..n {
        let id = store.find(key(i)).expect("kept");
        let bytes = record(i);
        assert_eq!(store.bytes(id).get(0..bytes.len() as u64).expect("readable")[..], bytes);
        assert_eq!(store.bytes(id).get(3..9).expect("readable")[..], bytes[3..9]);
        assert!(store.bytes(id).get(9..bytes.len() as u64 + 1).is_err(), "a record ends where it ends");
    }
    assert_eq!(store.find(key(n)), None);
}

fn fill(store: &Store, range: Range<u32>) {
    for i in range {
        store.keep(key(i), record(i)).expect("kept");
    }
}

#[test]
fn records_come_back_from_every_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let work = folder.path().join("work");
    for store in [Store::in_memory(), Store::in_passing(folder.path()).expect("a file"), open(&work)] {
        fill(&store, 0..20);
        fill(&store, 5..10);
        assert_holds(&store, 20);
    }
    // A file in passing leaves nothing behind.
    assert_eq!(fs::read_dir(folder.path()).expect("readable").count(), 1);
}

#[test]
fn a_work_directory_cut_off_anywhere_keeps_what_was_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    fill(&open(folder.path()), 0..6);
    let path = folder.path().join("anastomesh.blocks");
    let whole = fs::read(&path).expect("blocks");
    for length in (0..whole.len()).step_by(7) {
        fs::write(&path, &whole[..length]).expect("written");
        let store = open(folder.path());
        let kept = (0..6).take_while(|&i| store.find(key(i)).is_some()).count() as u32;
        assert_holds(&store, kept);
        fill(&store, kept..6);
        assert_eq!(store.bytes_on_disk(), whole.len() as u64);
        drop(store);
        assert_eq!(fs::read(&path).expect("blocks"), whole);
        assert_eq!(open(folder.path()).bytes_on_disk(), whole.len() as u64);
    }
    assert_eq!(Store::in_memory().bytes_on_disk(), 0);
}

#[test]
fn damage_is_found_by_the_checksum() {
    let folder = tempfile::tempdir().expect("a folder");
    fill(&open(folder.path()), 0..6);
    let path = folder.path().join("anastomesh.blocks");
    let whole = fs::read(&path).expect("blocks");
    for at in (0..whole.len()).step_by(31) {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x10;
        fs::write(&path, &bytes).expect("written");
        let store = open(folder.path());
        let kept = (0..6).filter(|&i| store.find(key(i)).is_some()).count() as u32;
        assert!(kept < 6, "byte {at}");
        assert_holds(&store, kept);
    }
}

#[test]
fn another_network_option_or_version_is_refused_or_starts_over() {
    let folder = tempfile::tempdir().expect("a folder");
    fill(&open(folder.path()), 0..3);
    let refused = Store::in_folder(folder.path(), &manifest(4.0), false).expect_err("another option");
    let StoreError::Other { difference, .. } = &refused else { panic!("{refused}") };
    let (name, was, is) = ("mesh.rho".to_owned(), "3.0".to_owned(), "4.0".to_owned());
    assert_eq!(*difference, Difference::Option { name, was, is });
    let node = Node { position: Point3::origin(), radius: 1.0, original: 0 };
    let other = Skeleton { nodes: vec![node], edges: Vec::new() };
    let network = Manifest::new(&other, serde_json::json!({ "mesh": { "rho": 3.0 }, "refine": null }));
    let refused = Store::in_folder(folder.path(), &network, false).expect_err("another network");
    assert!(matches!(refused, StoreError::Other { difference: Difference::Network, .. }));
    assert_holds(&open(folder.path()), 3);
    let over = Store::in_folder(folder.path(), &manifest(4.0), true).expect("starts over");
    assert_eq!(over.find(key(0)), None);
    drop(over);
    for other in ["{}", "not JSON", "{\"format\": 99, \"program\": \"other\", \"network\": \"\", \"options\": 1}"] {
        fs::write(folder.path().join("anastomesh.json"), other).expect("written");
        let refused = Store::in_folder(folder.path(), &manifest(4.0), false).expect_err("another version");
        assert!(matches!(refused, StoreError::Other { difference: Difference::Version(_), .. }), "{refused}");
    }
}

#[test]
fn two_runs_do_not_share_a_work_directory() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = open(folder.path());
    let second = Store::in_folder(folder.path(), &manifest(3.0), false).expect_err("in use");
    assert!(matches!(second, StoreError::Locked { .. }), "{second}");
    drop(first);
    open(folder.path());
}

#[test]
fn a_folder_that_cannot_be_one_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::File::create(&file).and_then(|mut f| f.write_all(b"x")).expect("written");
    assert!(matches!(Store::in_folder(&file, &manifest(3.0), false), Err(StoreError::Folder { .. })));
    assert!(matches!(Store::in_passing(&folder.path().join("missing")), Err(StoreError::Folder { .. })));
}

#[test]
fn keys_tell_neighbours_apart() {
    let of = |texts: &[&str]| {
        let mut maker = KeyMaker::new("test");
        for text in texts {
            maker.text(text);
        }
        maker.finish()
    };
    assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
    assert_ne!(KeyMaker::new("a").finish(), KeyMaker::new("b").finish());
    assert_eq!(Key(4 << 96 | 3 << 64 | 2 << 32 | 1).short(), [1, 2, 3]);
}

#[test]
fn every_number_of_a_section_counts_for_its_key() {
    let of = |section: &Section| {
        let mut maker = KeyMaker::new("test");
        maker.section(section);
        maker.finish()
    };
    let section = Section { up: Some(Vec3::y()), ..Section::new(Point3::new(1.0, 2.0, 3.0), Vec3::x(), 0.5) };
    let mut others = vec![Section { radius: 0.25, ..section }, Section { up: None, ..section }];
    for axis in 0..3 {
        let other = |change: fn(&mut Section) -> &mut [f64]| {
            let mut other = section;
            change(&mut other)[axis] += 1e-15;
            other
        };
        others.push(other(|section| section.axis.as_mut_slice()));
        others.push(other(|section| section.origin.coords.as_mut_slice()));
        others.push(other(|section| section.up.as_mut().map_or(&mut [], |up| up.as_mut_slice())));
    }
    let keys: std::collections::BTreeSet<Key> = others.iter().chain([&section]).map(of).collect();
    assert_eq!(keys.len(), others.len() + 1);
}

#[test]
fn every_bit_of_a_key_counts_for_the_checksum() {
    for key in [0, u128::MAX, 0x0123_4567_89ab_cdef_0f1e_2d3c_4b5a_6978] {
        let sum = |key: u128| log::checksum(Key(key), b"record");
        assert!((0..128).all(|bit| sum(key ^ 1 << bit) != sum(key)), "{key:x}");
    }
}

#[test]
fn pieces_of_tissue_are_kept_like_blocks() {
    use anastomesh_domain::Shelf;
    let store = Store::in_memory();
    let (first, second) = (vec![1, 2, 3], vec![4, 5, 6, 7]);
    let [a, b] = [(9, first), (8, second)].map(|(key, bytes)| Shelf::keep(&store, key, bytes).expect("kept"));
    assert_eq!([9, 8, 7].map(|key| Shelf::find(&store, key)), [Some(a), Some(b), None]);
    assert_eq!(Shelf::read(&store, b, 1..3).expect("readable"), [5, 6]);
    assert_eq!(Shelf::read(&store, a, 0..3).expect("readable"), [1, 2, 3]);
    assert!(Shelf::read(&store, a, 0..4).is_err());
}

#[test]
fn files_that_cannot_be_read_are_errors_and_no_missing_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let open = || Store::in_folder(folder.path(), &manifest(3.0), false);
    for name in
        ["anastomesh.json", "anastomesh.shards", "anastomesh.shard_1_of_1.done", "anastomesh.shard_1_of_1.blocks"]
    {
        drop(open().expect("a work directory"));
        if name.contains("_of_") {
            fs::write(folder.path().join("anastomesh.shards"), "1").expect("written");
            fs::write(folder.path().join("anastomesh.shard_1_of_1.done"), "{\"bytes\":0}").expect("written");
        }
        let path = folder.path().join(name);
        let _ = fs::remove_file(&path);
        // A folder in its place.
        fs::create_dir(&path).expect("a folder");
        let failed = open().expect_err(name);
        assert!(matches!(failed, StoreError::Folder { .. }), "{name}: {failed}");
        fs::remove_dir(&path).expect("removed");
        for entry in fs::read_dir(folder.path()).expect("readable") {
            fs::remove_file(entry.expect("an entry").path()).expect("removed");
        }
    }
}

#[test]
fn positions_outside_their_files_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let store = open(folder.path());
    fill(&store, 0..3);
    let ids = (0..3).map(|i| store.find(key(i)).expect("kept"));
    let extents = store.extents(ids).expect("in a folder");
    assert!(Store::in_memory().extents([].into_iter()).is_none());
    let again = |text: String| {
        let extents: Extents = serde_json::from_str(&text).expect("positions");
        Store::of_extents(folder.path(), &extents)
    };
    let text = serde_json::to_string(&extents).expect("text");
    let read = again(text.clone()).expect("sound");
    for i in 0..3 {
        let bytes = record(i);
        assert_eq!(read.bytes(Extents::record(i as usize)).get(0..bytes.len() as u64).expect("readable")[..], bytes);
    }
    let [file, start, end] = {
        let value: serde_json::Value = serde_json::from_str(&text).expect("text");
        assert_eq!(value["files"].as_array().map(Vec::len), Some(1));
        [0, 1, 2].map(|i| value["places"][1][i].as_u64().expect("a number"))
    };
    let place = format!("[{file},{start},{end}]");
    let with = |other: String| again(text.replace(&place, &other)).is_some();
    assert!(with(format!("[0,{start},{start}]")) && with(place.clone()));
    assert!(!with(format!("[1,{start},{end}]")) && !with(format!("[0,{end},{start}]")));
    let names = text.replace(&format!("{:?}", b"anastomesh.blocks").replace(' ', ""), "[46,46]");
    assert!(names != text && again(names).is_none(), "a name that leads out of the folder");
}

#[test]
fn shards_are_joined_when_all_are_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let open = |role| Store::in_folder_as(role, folder.path(), &manifest(3.0));
    let alone = Role::Alone { restart: false, make_missing: false };
    let shards: Vec<Shard> = Shard::all(2).collect();
    let make = |shard: Shard, range: Range<u32>| {
        let store = open(Role::Shard(shard)).expect("a shard");
        fill(&store, range);
        store.mark_done(shard).expect("marked");
    };
    make(shards[0], 0..3);
    let missing = open(alone).expect_err("one is missing");
    assert!(matches!(&missing, StoreError::Missing { shards: of, .. } if of[..] == shards[1..]), "{missing}");
    make(shards[1], 3..5);
    let joined = open(alone).expect("both exist");
    assert_holds(&joined, 5);
    fill(&joined, 5..7);
    assert_holds(&joined, 7);
    drop(joined);
    // Another number of shards, and bytes after the last record of one.
    let other = open(Role::Shard(Shard::new(1, 3).expect("a shard"))).expect_err("another number");
    assert!(matches!(other, StoreError::OtherShards { was: 2, .. }), "{other}");
    let path = folder.path().join(shards[0].records());
    let whole = fs::read(&path).expect("records");
    for bytes in [[&whole[..], b"more"].concat(), whole[..whole.len() - 1].to_vec()] {
        fs::write(&path, &bytes).expect("written");
        let damaged = open(alone).expect_err("damaged");
        assert!(matches!(damaged, StoreError::Damaged { shard, .. } if shard == shards[0]), "{damaged}");
        let rest = open(Role::Alone { restart: false, make_missing: true }).expect("the rest is made");
        assert!(rest.find(key(0)).is_some() && rest.find(key(4)).is_some());
    }
    fs::write(&path, &whole).expect("written");
    assert_holds(&open(alone).expect("both exist"), 7);
    // Shards run at the same time.
    let both = [0, 1].map(|i| open(Role::Shard(shards[i])).expect("a shard"));
    drop(both);
    // A shard that is made again is not finished until it is marked.
    drop(open(Role::Shard(shards[0])).expect("a shard"));
    assert!(matches!(open(alone), Err(StoreError::Missing { .. })));
    let rest = open(Role::Alone { restart: false, make_missing: true }).expect("the rest is made");
    assert_holds(&rest, 7);
}

#[test]
fn files_that_cannot_be_read_do_not_count_as_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let shard = Shard::new(1, 2).expect("a shard");
    let all_read = || {
        [
            manifest(3.0).begun(folder.path()).is_ok(),
            super::shards::unmark(folder.path(), shard).is_ok(),
            super::log::scan_path(&path("file/records")).is_ok(),
        ]
    };
    assert_eq!(all_read(), [true; 3]);
    // Folders in the places of files, and a file in the place of a folder.
    fs::create_dir(path(super::manifest::MANIFEST)).expect("a folder");
    fs::create_dir(path(&shard.mark())).expect("a folder");
    fs::write(path("file"), b"").expect("written");
    assert_eq!(all_read(), [false; 3]);
}
