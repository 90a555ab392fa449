//! Stores keep what they were given, and a work directory survives whatever happens to it.

use std::fs;
use std::io::Write;

use super::error::Difference;
use super::*;
use anastomesh_mesh::geometry::Point3;
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
}
