//! Command line tests of `render`: pictures of networks, meshes and surfaces.

use crate::common::fixture;
use crate::common::program::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Width and pixels of a picture file.
fn picture(path: &Path) -> (usize, Vec<[u8; 3]>) {
    let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).expect("a picture")));
    let mut reader = decoder.read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a frame");
    assert_eq!(info.color_type, png::ColorType::Rgb);
    (info.width as usize, bytes.as_chunks::<3>().0.to_vec())
}

fn render(input: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    let small = if options.contains(&"--size") { &[][..] } else { &["--size", "320x240"] };
    run("render", &[input, Path::new("--output"), out], &[small, options].concat())
}

/// Number of pixels with nearly this colour.
fn near(pixels: &[[u8; 3]], colour: [u8; 3]) -> usize {
    let off = |p: &&[u8; 3]| p.iter().zip(colour).all(|(a, b)| a.abs_diff(b) < 40);
    pixels.iter().filter(off).count()
}

#[test]
fn a_network_its_mesh_and_their_insides_are_drawn() {
    let folder = folder();
    let [tree, out] = ["tree.vtu", "p.png"].map(|name| folder.path().join(name));
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    let network = fixture("tree_30.vtp");
    let network = network.to_str().expect("a path");
    let drawn = |input: &Path, options: &[&str]| {
        assert_code(&render(input, &out, options), FINE);
        let (width, pixels) = picture(&out);
        assert_eq!((width, pixels.len()), (320, 320 * 240));
        let ground = near(&pixels, pixels[0]);
        assert!((10_000..76_000).contains(&ground), "{options:?}: {ground} pixels of background");
        pixels
    };
    let wall = drawn(&tree, &[]);
    assert!(wall[0] == [255; 3] && near(&wall, [190, 110, 100]) > 500);
    // The cut shows tetrahedra, which the wall alone does not have.
    let cream = [225, 210, 185];
    let cut = drawn(&tree, &["--clip", "view"]);
    assert!(2 * near(&cut, cream) > 3 * near(&wall, cream), "{} {}", near(&cut, cream), near(&wall, cream));
    assert!(drawn(&tree, &["--cut-away", "view"]) != wall);
    assert_eq!(drawn(&tree, &["--background", "dark"])[0], [16, 19, 24]);
    for options in [
        &["--color", "block"][..],
        &["--color", "quality", "--view", "30,20"],
        &["--color", "radius", "--network", network],
        &["--color", "order", "--network", network, "--view", "top"],
    ] {
        let colours: BTreeSet<[u8; 3]> = drawn(&tree, options).into_iter().collect();
        assert!(colours.len() > 100, "{options:?}");
    }
    drawn(&fixture("tree_30.vtp"), &["--color", "order", "--zoom", "1.2"]);
    drawn(&fixture("torus.off"), &[]);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let folder = folder();
    let [one, two] = ["1", "2"].map(|threads| {
        let out = folder.path().join(threads).with_extension("png");
        assert_code(&render(&fixture("tree_30.swc"), &out, &["-j", threads, "-q"]), FINE);
        fs::read(out).expect("a file")
    });
    assert!(one == two);
}

#[test]
fn what_cannot_be_drawn_is_said() {
    let folder = folder();
    let out = folder.path().join("p.png");
    let network = fixture("tree_30.swc");
    let refused = |input: &Path, out: &Path, options: &[&str], code: i32, words: &[&str]| {
        assert_says(&render(input, out, options), code, words);
    };
    refused(&network, &folder.path().join("p.gif"), &[], BAD_INPUT, &["p.gif", ".png"]);
    refused(&network, &folder.path().join("none/p.png"), &[], BAD_INPUT, &["p.png", "cannot be written"]);
    refused(&folder.path().join("absent.vtu"), &out, &[], BAD_INPUT, &["absent.vtu"]);
    refused(&folder.path().join("odd.xyz"), &out, &[], BAD_INPUT, &["odd.xyz", "render --help"]);
    refused(&network, &out, &["--clip", "x"], USAGE, &["--cut-away"]);
    refused(&network, &out, &["--clip", "w"], USAGE, &["view:40%"]);
    refused(&network, &out, &["--size", "0x5"], USAGE, &["1200x900"]);
    refused(&network, &out, &["--size", "90000x90000"], USAGE, &["64 million"]);
    refused(&network, &out, &["--zoom", "nan"], USAGE, &["above zero"]);
    refused(&fixture("torus.off"), &out, &["--color", "radius"], USAGE, &["--network"]);
    assert!(entries(folder.path()).is_empty());
}

#[test]
fn values_of_vessels_have_colours() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (flow, tree, out) = (at("flow.vtp"), at("tree.vtu"), at("p.png"));
    assert_code(&run("flow", &[&fixture("tree_30.vtp"), Path::new("-o"), &flow], &["-q", "--inflow", "1e-3"]), FINE);
    assert_code(&mesh(&fixture("tree_30.vtp"), &tree, &["-q"]), FINE);
    let drawn = |input: &Path, options: &[&str]| {
        let made = render(input, &out, options);
        assert_code(&made, FINE);
        (picture(&out).1, stderr(&made))
    };
    let network = flow.to_str().expect("a path");
    let (pixels, said) = drawn(&flow, &["--data", "Pressure:Pa"]);
    assert!(said.contains("Pressure in Pa") && said.contains("(dark violet) to"), "{said}");
    // The pressure falls from the inlet (yellow) to the outlets (violet).
    let count = |shade: fn(&[u8; 3]) -> bool| pixels.iter().filter(|p| shade(p)).count();
    let (yellow, violet) =
        (count(|[r, g, b]| g > r && *r > b.saturating_add(40)), count(|[r, g, b]| b > r && *r > g.saturating_add(10)));
    assert!(yellow > 100 && violet > 100, "{yellow} {violet}");
    let (wall, said) = drawn(&tree, &["--network", network, "--data", "Flow"]);
    assert!(said.contains("Flow from") && near(&wall, [190, 110, 100]) < 100, "{said}");
    assert!(wall != drawn(&tree, &["--network", network, "--data", "WallShear"]).0);
    assert_says(&render(&tree, &out, &["--data", "Flow"]), USAGE, &["--network NETWORK"]);
}
