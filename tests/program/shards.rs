//! Tests of runs that share one network's blocks in a work directory, as a scheduler starts, kills and repeats them.

use crate::common::oracle::missing;
use crate::common::program::{BAD_INPUT, FINE, USAGE, assert_code, assert_says, folder, json, program, stderr};
use crate::common::{fixture, shared};
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;
use tempfile::TempDir;

/// Network, shared work directory, and results.
struct Shared {
    folder: TempDir,
    network: PathBuf,
    options: Vec<&'static str>,
}

impl Shared {
    /// With the fixture, which is meshed quickly.
    fn small() -> Self {
        Self { folder: folder(), network: fixture("tree_30.vtp"), options: vec!["--refine", "20"] }
    }

    /// With two vessels that cross, which only refinement moves apart.
    fn crossing() -> Self {
        let folder = folder();
        let network = folder.path().join("crossing.swc");
        // Five pairs of crossing tubes: too many for the local refinement, which is not stored.
        let pair = |i: u32| {
            let (first, y) = (4 * i + 1, 60 * i);
            let [b, c, d] = [first + 1, first + 2, first + 3];
            format!(
                "{first} 0 -20 {y} 0 1 -1\n{b} 0 20 {y} 0 1 {first}\n{c} 0 0 {} 0.5 1 -1\n{d} 0 0 {} 0.5 1 {c}\n",
                f64::from(y) - 20.0,
                y + 20
            )
        };
        let text: String = (0..5).map(pair).collect();
        fs::write(&network, text).expect("written");
        Self { folder, network, options: vec!["--refine", "50"] }
    }

    /// With a larger network if available.
    fn large() -> Self {
        let network = shared().map(|shared| shared.join("data/kidney/subtree_289_clear.vtp"));
        Self { network: network.unwrap_or_else(|| fixture("tree_30.vtp")), ..Self::small() }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn work(&self, name: &str) -> PathBuf {
        self.path("work").join(format!("anastomesh.{name}"))
    }

    fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = program();
        command
            .arg("mesh")
            .arg(&self.network)
            .arg("-o")
            .arg(self.path(out))
            .args(&self.options)
            .args(["-q", "-j", "1"]);
        command.args(more);
        command
    }

    /// Runs in the work directory.
    fn run(&self, out: &str, more: &[&str]) -> Output {
        self.in_folder(out, more).output().expect("the program runs")
    }

    fn in_folder(&self, out: &str, more: &[&str]) -> Command {
        let mut command = self.command(out, more);
        command.arg("--work-dir").arg(self.path("work"));
        command
    }

    fn shard(&self, shard: &str) -> Output {
        self.run("no.vtu", &["--shard", shard])
    }

    /// Runs all shards at the same time.
    fn all_shards(&self, of: usize) {
        let start = |i| self.in_folder("no.vtu", &["--shard", &format!("{i}/{of}")]).spawn().expect("the program runs");
        let children: Vec<_> = (1..=of).map(start).collect();
        for mut child in children {
            assert_eq!(child.wait().expect("a child").code(), Some(FINE));
        }
        assert!(!self.path("no.vtu").exists() && !self.path("no_patches.csv").exists(), "shards write no mesh");
    }

    /// Bytes of a single run without a work directory.
    fn undisturbed(&self) -> Vec<u8> {
        assert_code(&self.command("alone.vtu", &[]).output().expect("the program runs"), FINE);
        fs::read(self.path("alone.vtu")).expect("a mesh")
    }

    /// Number of entries of a kind in the work directory.
    fn count(&self, what: &str) -> usize {
        let entries = fs::read_dir(self.path("work")).expect("a folder").map(|e| e.expect("an entry").file_name());
        entries.filter(|name| name.to_string_lossy().starts_with(&format!("anastomesh.{what}-"))).count()
    }

    #[track_caller]
    fn assert_joins(&self, whole: &[u8], more: &[&str]) {
        assert_code(&self.run("joined.vtu", more), FINE);
        assert!(fs::read(self.path("joined.vtu")).expect("a mesh") == whole);
    }
}

/// Truncates a file.
fn cut(path: &Path, bytes: u64) {
    let file = File::options().write(true).open(path).expect("there");
    file.set_len(bytes).expect("shorter");
}

fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |m| m.len())
}

#[test]
fn shards_at_the_same_time_give_the_bytes_of_one_run() {
    let net = Shared::large();
    let whole = net.undisturbed();
    net.all_shards(5);
    let before = length(&net.work("blocks"));
    net.assert_joins(&whole, &[]);
    assert_eq!((before, length(&net.work("blocks"))), (0, 0), "shards have left nothing to be made");
    // Partitioned once, by whichever shard came first. The network gives a valid mesh as it is, so it is not refined.
    assert_eq!([net.count("refined"), net.count("partition"), net.count("part")], [0, 1, 0]);
    let again = json(&net.run("no.vtu", &["--shard", "2/5", "--json"]));
    assert_eq!(again["share"], again["found"]);
    assert!(again["share"].as_u64() > Some(0) && again["blocks"].as_u64() > again["share"].as_u64(), "{again}");
}

#[test]
fn a_network_that_has_to_be_refined_is_refined_once() {
    let net = Shared::crossing();
    let whole = net.undisturbed();
    net.all_shards(2);
    net.assert_joins(&whole, &[]);
    assert_eq!(net.count("refined"), 1);
}

#[test]
fn a_shard_that_is_killed_at_any_moment_goes_on() {
    let net = Shared::large();
    let whole = net.undisturbed();
    assert_code(&net.shard("1/2"), FINE);
    let all = length(&net.work("shard_1_of_2.blocks"));
    let mut killed = 0;
    for step in 0..8 {
        let mut child = net.in_folder("no.vtu", &["--shard", "2/2"]).stderr(Stdio::null()).spawn().expect("it runs");
        while child.try_wait().expect("a child").is_none() {
            if length(&net.work("shard_2_of_2.blocks")) >= all * step / 10 {
                killed += u32::from(child.kill().is_ok());
                child.wait().expect("gone");
                break;
            }
            std::thread::sleep(Duration::from_micros(300));
        }
    }
    assert!(killed >= 6, "{killed} kills");
    assert_says(&net.run("a.vtu", &[]), BAD_INPUT, &["shard 2/2 is not finished", "--make-missing"]);
    assert_code(&net.shard("2/2"), FINE);
    net.assert_joins(&whole, &[]);
}

#[test]
fn a_missing_shard_is_named_and_made_on_request() {
    let net = Shared::small();
    let whole = net.undisturbed();
    for shard in ["1/4", "3/4"] {
        assert_code(&net.shard(shard), FINE);
    }
    let refused = net.run("joined.vtu", &[]);
    assert_says(&refused, BAD_INPUT, &["shards 2/4, 4/4 are not finished", "--make-missing"]);
    assert!(!net.path("joined.vtu").exists(), "nothing is merged");
    net.assert_joins(&whole, &["--make-missing"]);
    assert_code(&net.shard("2/4"), FINE);
    assert_says(&net.run("joined.vtu", &[]), BAD_INPUT, &["shard 4/4 is not finished"]);
}

#[test]
fn a_record_that_is_cut_off_or_damaged_is_named_and_made_again() {
    let net = Shared::small();
    let whole = net.undisturbed();
    net.all_shards(2);
    let path = net.work("shard_2_of_2.blocks");
    let records = fs::read(&path).expect("records");
    let mut flipped = records.clone();
    flipped[records.len() / 2] ^= 1;
    for bytes in [&records[..records.len() - 5], &flipped, &records[..0]] {
        fs::write(&path, bytes).expect("written");
        let refused = net.run("joined.vtu", &[]);
        assert_says(&refused, BAD_INPUT, &["shard_2_of_2.blocks", "complete records", "run shard 2/2 again"]);
        assert!(!net.path("joined.vtu").exists(), "nothing is merged");
    }
    net.assert_joins(&whole, &["--make-missing"]);
    fs::write(&path, &flipped).expect("written");
    fs::remove_file(net.work("blocks")).expect("what was made instead");
    assert_code(&net.shard("2/2"), FINE);
    assert_eq!(fs::read(&path).expect("records").len(), records.len());
    net.assert_joins(&whole, &[]);
}

#[test]
fn what_is_kept_for_all_is_made_again_when_it_is_damaged() {
    let net = Shared::small();
    let whole = net.undisturbed();
    net.all_shards(2);
    for entry in fs::read_dir(net.path("work")).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        if name.starts_with("anastomesh.refined-") || name.starts_with("anastomesh.partition-") {
            cut(&path, length(&path) / 2);
        }
    }
    net.assert_joins(&whole, &[]);
}

#[test]
fn shards_of_something_else_are_refused() {
    let net = Shared::small();
    assert_code(&net.shard("1/3"), FINE);
    let option = net.run("no.vtu", &["--shard", "2/3", "--rho", "4"]);
    assert_says(&option, BAD_INPUT, &["other options (mesh.rho was 3.0, now 4.0)"]);
    let refine = net.run("no.vtu", &["--shard", "2/3", "--clearance", "1.3"]);
    assert_says(&refine, BAD_INPUT, &["other options (refine"]);
    let number = net.shard("2/4");
    assert_says(&number, BAD_INPUT, &["has 3 shards, but 2/4 was requested"]);
    let other = Shared { network: fixture("crotch.vtp"), folder: net.folder, options: net.options.clone() };
    assert_says(&other.shard("2/3"), BAD_INPUT, &["another network"]);
    let net = Shared { network: fixture("tree_30.vtp"), ..other };
    // Leftovers of another version.
    let manifest = fs::read_to_string(net.work("json")).expect("a manifest");
    fs::write(net.work("json"), manifest.replacen("anastomesh 0", "anastomesh 9", 1)).expect("written");
    assert_says(&net.shard("2/3"), BAD_INPUT, &["another version"]);
    assert_says(&net.run("a.vtu", &["--make-missing"]), BAD_INPUT, &["another version"]);
    fs::write(net.work("json"), &manifest).expect("written");
    assert_code(&net.shard("2/3"), FINE);
    // Everything is discarded on request, by a run without concurrent shards.
    assert_code(&net.run("a.vtu", &["--rho", "4", "--restart"]), FINE);
    assert!(!net.work("shard_1_of_3.blocks").exists() && !net.work("shards").exists());
}

#[test]
fn shards_that_are_none_are_refused() {
    let net = Shared::small();
    for (shard, words) in [("0/3", "0/3 is out of range"), ("4/3", "give 1/3 to 3/3"), ("1/0", "1 to")] {
        assert_says(&net.shard(shard), BAD_INPUT, &[words]);
    }
    for shard in ["3", "1/2/3", "-1/3", "a/b", ""] {
        assert_code(&net.shard(shard), USAGE);
    }
    assert!(!net.path("work").exists());
    assert_says(&net.run("a.vtu", &["--shard", "1/2", "--restart"]), USAGE, &["--restart"]);
    assert_says(&net.run("a.vtu", &["--shard", "1/2", "--make-missing"]), USAGE, &["--make-missing"]);
    let woven = net.run("a.vtu", &["--shard", "1/2", "--joint", "woven", "--frozen-joints"]);
    assert_says(&woven, USAGE, &["--joint disc"]);
    assert_says(&net.command("a.vtu", &["--shard", "1/2"]).output().expect("it runs"), USAGE, &["--work-dir"]);
}

#[test]
fn one_shard_is_made_by_one_run_at_a_time() {
    let net = Shared::small();
    assert_code(&net.shard("1/2"), FINE);
    let lock = |name: &str| {
        let file = File::options().write(true).open(net.work(name)).expect("a lock");
        file.lock().expect("locked");
        file
    };
    let held = lock("shard_1_of_2.lock");
    assert_says(&net.shard("1/2"), BAD_INPUT, &["another run makes shard 1/2"]);
    assert_code(&net.shard("2/2"), FINE);
    drop(held);
    assert_code(&net.shard("1/2"), FINE);
    // Shards cannot be joined while one is running, and no shard starts during joining.
    let shard = File::open(net.work("lock")).expect("a lock");
    shard.lock_shared().expect("locked");
    assert_says(&net.run("a.vtu", &[]), BAD_INPUT, &["another run uses this work directory"]);
    drop(shard);
    let joins = lock("lock");
    assert_says(&net.shard("1/2"), BAD_INPUT, &["another run uses this work directory"]);
    drop(joins);
    assert_code(&net.run("a.vtu", &[]), FINE);
}

#[test]
fn what_a_run_alone_has_made_is_found_by_shards() {
    let net = Shared::small();
    let whole = net.undisturbed();
    assert_code(&net.run("a.vtu", &[]), FINE);
    for shard in ["1/2", "2/2"] {
        let made = json(&net.run("no.vtu", &["--shard", shard, "--json"]));
        assert_eq!(made["share"], made["found"], "{made}");
    }
    net.assert_joins(&whole, &[]);
}

/// A file system without locks, simulated by injecting the system's error with strace.
#[test]
fn a_file_system_without_locks_is_named() {
    let net = Shared::small();
    let under_strace = |inject: &str| {
        let plain = net.in_folder("no.vtu", &["--shard", "1/2"]);
        let mut command = Command::new("strace");
        command
            .args(["-f", "-qq", "-o", "/dev/null", "-e", inject, "--"])
            .arg(plain.get_program())
            .args(plain.get_args());
        command.output()
    };
    for (inject, words) in
        [("inject=flock:error=ENOLCK", "No locks available"), ("inject=flock:retval=0", "grants one lock twice")]
    {
        let Ok(done) = under_strace(inject) else { return missing("strace is not there (apt-get install strace)") };
        if stderr(&done).contains("ptrace") {
            return missing("strace is not permitted to trace");
        }
        assert_says(&done, BAD_INPUT, &["has no file locks", words]);
        assert!(!net.work("shard_1_of_2.blocks").exists());
    }
}
