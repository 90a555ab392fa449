//! Command line tests of `completions` and `man`: they contain every command and option of `--help`.

use crate::common::program::*;

/// Commands listed by the program.
fn verbs() -> Vec<String> {
    let help = stdout(&run("--help", &[], &[]));
    let list = help.split("Commands:\n").nth(1).and_then(|rest| rest.split("\n\n").next()).expect("a list");
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.filter_map(|line| line.split_whitespace().next()).filter(|&verb| verb != "help").map(str::to_owned).collect()
}

/// Long options listed by a command.
fn options(verb: &str) -> Vec<String> {
    let help = stdout(&run(verb, &[], &["--help"]));
    let words = help.lines().filter(|line| line.trim_start().starts_with('-')).flat_map(|line| line.split([' ', ',']));
    let names = words.filter_map(|word| word.strip_prefix("--")?.split('[').next());
    names.map(str::to_owned).filter(|word| !word.is_empty()).collect()
}

#[test]
fn completions_and_manual_hold_each_verb_and_option() {
    let verbs = verbs();
    assert!(["mesh", "replay", "man"].iter().all(|verb| verbs.iter().any(|known| known == verb)), "{verbs:?}");
    let shells = ["bash", "elvish", "fish", "powershell", "zsh"];
    let scripts = shells.map(|shell| stdout(&run("completions", &[], &[shell])));
    let program = stdout(&run("man", &[], &[]));
    for verb in &verbs {
        assert!(program.contains(verb) && scripts.iter().all(|script| script.contains(verb)), "{verb}");
        let page = stdout(&run("man", &[], &[verb])).replace("\\-", "-");
        let found = options(verb);
        assert!(found.iter().any(|option| option == "help"), "{verb}: {found:?}");
        for option in found {
            assert!(page.contains(&format!("--{option}")), "{verb} --{option}: {page}");
            assert!(scripts.iter().all(|script| script.contains(&option)), "{verb} --{option}");
        }
    }
}

#[test]
fn what_is_not_known_is_a_usage_error() {
    assert_says(&run("man", &[], &["knit"]), USAGE, &["knit", "--help"]);
    assert_says(&run("completions", &[], &["csh"]), USAGE, &["csh", "zsh"]);
    assert_code(&run("completions", &[], &[]), USAGE);
}
