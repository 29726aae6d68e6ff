//! Dependencies follow `deny.toml`: licences, sources, and one version of each.

use crate::program::root;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

fn policy() -> toml::Table {
    let text = std::fs::read_to_string(root().join("deny.toml")).expect("there is a policy");
    text.parse().expect("it is TOML")
}

/// Texts of a list of the policy, or of a field of its rows.
fn listed(section: &str, key: &str, field: &str) -> BTreeSet<String> {
    let policy = policy();
    let rows = policy[section][key].as_array().expect("a list");
    let text = |row: &toml::Value| row.get(field).unwrap_or(row).as_str().expect("text").to_owned();
    rows.iter().map(text).collect()
}

/// The packages of the program on this machine.
fn packages() -> Vec<Value> {
    let host = Command::new("rustc").arg("-vV").output().expect("rustc runs").stdout;
    let host = String::from_utf8(host).expect("text");
    let host = host.lines().find_map(|line| line.strip_prefix("host: ")).expect("rustc tells its host");
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    let words = ["metadata", "--format-version", "1", "--offline", "--filter-platform", host];
    let output = Command::new(cargo).args(words).current_dir(root()).output().expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let all: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    all["packages"].as_array().expect("packages").clone()
}

/// Whether one alternative of an SPDX expression is allowed; the old syntax has "/" for "OR".
fn is_allowed(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let expression = expression.replace('/', " OR ");
    let of_all = |part: &str| part.split(" OR ").any(|choice| allowed.contains(choice.trim_matches(['(', ')', ' '])));
    expression.split(" AND ").all(of_all)
}

#[test]
fn licences_are_those_of_the_policy() {
    let allowed = listed("licenses", "allow", "");
    assert!(is_allowed("(MIT OR GPL-3.0-only) AND Zlib", &allowed) && !is_allowed("MIT AND GPL-3.0-only", &allowed));
    for package in packages() {
        let license = package["license"].as_str().unwrap_or("none");
        assert!(
            is_allowed(license, &allowed),
            "{} has the licence {license}, which deny.toml does not allow",
            package["name"]
        );
    }
}

#[test]
fn each_package_comes_from_the_registry_in_one_version() {
    let skipped = listed("bans", "skip", "crate");
    let mut versions: BTreeMap<String, usize> = BTreeMap::new();
    for package in packages() {
        let name = package["name"].as_str().expect("a name").to_owned();
        let source = package["source"].as_str();
        assert!(
            source.is_none_or(|source| source.contains("github.com/rust-lang/crates.io-index")),
            "{name}: {source:?}"
        );
        *versions.entry(name).or_default() += 1;
    }
    let several: BTreeSet<String> =
        versions.into_iter().filter(|(_, count)| *count > 1).map(|(name, _)| name).collect();
    assert_eq!(several, skipped, "packages of several versions, and those that deny.toml skips");
}
