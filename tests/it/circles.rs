//! No files of a crate ask for each other in a circle.
//!
//! A file asks for another one where it names something of it, by `use` or by a path. `mod` and `pub use` only say what there is, and tests may
//! look at everything.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use super::contract::{root, rust_files};

/// The names that lead from the root of the crate to a module, or on to something in it.
type Names = Vec<String>;

/// A crate as text.
struct Code {
    /// What each module says, without comments and tests.
    modules: BTreeMap<Names, String>,
    /// What modules offer under their own name, and what that is.
    offered: BTreeMap<(Names, String), Names>,
}

#[test]
fn no_files_of_a_crate_ask_for_each_other_in_a_circle() {
    let crates = fs::read_dir(root().join("crates")).unwrap();
    let crates = crates.map(|entry| entry.unwrap().path().join("src"));
    let mut folders: Vec<PathBuf> = crates.chain([root().join("src")]).collect();
    // One file asks for no other.
    folders.retain(|folder| folder.exists() && rust_files(folder).len() > 2);
    assert!(folders.len() >= 9, "{folders:?}");
    for folder in folders {
        let code = Code::of(&folder);
        let folder = folder.display();
        let asked: BTreeMap<&Names, BTreeSet<Names>> = code
            .modules
            .keys()
            .map(|module| (module, code.asked_by(module)))
            .collect();
        let count: usize = asked.values().map(BTreeSet::len).sum();
        assert!(count > asked.len(), "{folder}: {count} of {}", asked.len());
        // What asks for nothing that is left, or is asked for by nothing that is left, is no part of a circle.
        let mut left = asked;
        loop {
            let before = left.len();
            let present: BTreeSet<Names> = left.keys().map(|module| (*module).clone()).collect();
            let wanted: BTreeSet<Names> = left.values().flatten().cloned().collect();
            left.retain(|module, asked| {
                wanted.contains(*module) && asked.iter().any(|other| present.contains(other))
            });
            if left.len() == before {
                break;
            }
        }
        let circle: Vec<String> = left
            .iter()
            .flat_map(|(module, asked)| {
                let within = asked.iter().filter(|other| left.contains_key(other));
                within.map(|other| format!("{} -> {}", module.join("::"), other.join("::")))
            })
            .collect();
        assert!(
            circle.is_empty(),
            "{folder}, circles of files, and what lies between them:\n{}",
            circle.join("\n")
        );
    }
}

impl Code {
    fn of(root: &Path) -> Self {
        let mut modules = BTreeMap::new();
        for file in rust_files(root) {
            let within = file.strip_prefix(root).unwrap().with_extension("");
            let names = within.iter().map(|name| name.to_str().unwrap().to_owned());
            let mut module: Names = names.collect();
            if matches!(module.last().map(String::as_str), Some("mod" | "lib")) {
                module.pop();
            }
            if !module.iter().any(|name| name == "tests") {
                modules.insert(module, code_of(&fs::read_to_string(&file).unwrap()));
            }
        }
        let mut code = Self {
            modules,
            offered: BTreeMap::new(),
        };
        let mut offered = BTreeMap::new();
        for (module, text) in &code.modules {
            for (_, tree) in statements(text).filter(|(is_public, _)| *is_public) {
                for path in paths_of(&tree) {
                    if let (Some(meant), Some(name)) = (code.meant(module, &path), path.last()) {
                        offered.insert((module.clone(), name.clone()), meant);
                    }
                }
            }
        }
        code.offered = offered;
        code
    }

    /// The modules of which `module` names something.
    fn asked_by(&self, module: &Names) -> BTreeSet<Names> {
        let text = &self.modules[module];
        let mut rest = text.clone();
        let mut named: Vec<Names> = Vec::new();
        for (is_public, tree) in statements(text) {
            rest = rest.replacen(&tree, "", 1);
            if !is_public {
                named.extend(paths_of(&tree));
            }
        }
        named.extend(paths_in(&rest));
        let meant = named.iter().filter_map(|path| self.meant(module, path));
        let asked = meant.map(|path| self.module_of(path, 0));
        asked
            .filter(|other| other != module && !other.is_empty())
            .collect()
    }

    /// The names from the root of the crate on; `None` of another crate.
    fn meant(&self, module: &Names, path: &[String]) -> Option<Names> {
        let first = path.first()?.as_str();
        let mut from = module.clone();
        let rest = match first {
            "crate" => {
                from.clear();
                &path[1..]
            }
            "self" => &path[1..],
            "super" => {
                let up = path.iter().take_while(|name| *name == "super").count();
                from.truncate(from.len().checked_sub(up)?);
                &path[up..]
            }
            _ => {
                let inner: Names = from.iter().cloned().chain([first.to_owned()]).collect();
                self.modules.contains_key(&inner).then_some(path)?
            }
        };
        from.extend(rest.iter().cloned());
        Some(from)
    }

    /// The module in which that stands, wherever else it is offered.
    fn module_of(&self, path: Names, depth: usize) -> Names {
        let is_module = |names: &&[String]| self.modules.contains_key(*names) || names.is_empty();
        let mut prefixes = (0..=path.len()).rev().map(|end| &path[..end]);
        let module = prefixes.find(is_module).unwrap_or_default().to_vec();
        let name = path.get(module.len()).cloned();
        let offered = name.and_then(|name| self.offered.get(&(module.clone(), name)));
        match offered {
            Some(meant) if depth < 6 && *meant != path => self.module_of(meant.clone(), depth + 1),
            _ => module,
        }
    }
}

/// `text` without comments and tests.
fn code_of(text: &str) -> String {
    let end = text
        .match_indices("#[cfg(test)]\n")
        .find(|(at, found)| {
            let line = text[at + found.len()..].lines().next();
            line.is_some_and(|line| line.contains("mod tests {"))
        })
        .map_or(text.len(), |(at, _)| at);
    let lines = text[..end].lines();
    let code = lines.filter(|line| !line.trim_start().starts_with("//"));
    code.collect::<Vec<_>>().join("\n")
}

/// The trees of `use` in formatted `code`, and whether they are offered to others. Those for tests alone are left out.
fn statements(code: &str) -> impl Iterator<Item = (bool, String)> {
    let mut before = "";
    let starts = code.split_inclusive('\n').scan(0, |at, line| {
        let start = *at;
        *at += line.len();
        Some((start, line))
    });
    let found = starts.filter_map(move |(start, line)| {
        let for_tests = before.trim() == "#[cfg(test)]";
        before = line;
        let words = line.trim_start();
        let is_public = words.starts_with("pub");
        let at = line.find("use ")?;
        let head = line[..at].trim();
        let begins = head.is_empty() || is_public && (head == "pub" || head.ends_with(')'));
        let tree = code[start + at + 4..].split(';').next()?;
        (begins && !for_tests).then(|| (is_public, tree.to_owned()))
    });
    found.collect::<Vec<_>>().into_iter()
}

/// The paths of a tree of `use`.
fn paths_of(tree: &str) -> Vec<Names> {
    let tree = tree.trim();
    let Some((head, inner)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default();
        let names = path.split("::").map(|name| name.trim().to_owned());
        let mut names: Names = names.filter(|name| !name.is_empty()).collect();
        if names.len() > 1 && names.last().is_some_and(|name| name == "self") {
            names.pop();
        }
        return vec![names];
    };
    let inner = inner.rsplit_once('}').map_or(inner, |(inner, _)| inner);
    let (mut depth, mut branches) = (0, vec![String::new()]);
    for letter in inner.chars() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches.push(String::new());
                continue;
            }
            _ => {}
        }
        branches.last_mut().unwrap().push(letter);
    }
    let branches = branches.iter().filter(|branch| !branch.trim().is_empty());
    branches
        .flat_map(|branch| paths_of(&format!("{head}{}", branch.trim())))
        .collect()
}

/// The paths of `code` that begin at the crate, at the module or above it.
fn paths_in(code: &str) -> Vec<Names> {
    let is_of_name = |letter: char| letter.is_alphanumeric() || letter == '_' || letter == ':';
    code.split(|letter: char| !is_of_name(letter))
        .filter(|path| {
            ["crate::", "super::", "self::"]
                .iter()
                .any(|at| path.starts_with(at))
        })
        .map(|path| path.split("::").map(str::to_owned).collect())
        .collect()
}
