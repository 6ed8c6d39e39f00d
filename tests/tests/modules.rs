//! Modules use each other in one direction: no circles, and nothing but the paper's law uses the paper's law.
//!
//! Read from the sources. Between two modules of the same parent, A uses B if a path in A, or in a module
//! inside of A, leads to B or into it. A name counts for the module that defines it, so re-exports are
//! followed. A module and what is inside of it are one: a child may use its parent's items, and a parent its
//! children's. Not read: comments, `#[cfg(test)] mod`, files of tests and `src/bin`, whose programs stand alone.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A module by its path from the root of its crate.
type Module = Vec<String>;

/// Every package of the workspace and every board.
const CRATES: [&str; 11] = [
    "bindings/c",
    "bindings/python",
    "bindings/ros2",
    "controller-core",
    "firmware-demo",
    "protocol",
    "sim-host",
    "tests",
    "boards/common",
    "boards/rp2350",
    "boards/stm32f411",
];

/// The modules of a crate, each with its code.
fn read(folder: &Path, inside: &Module, found: &mut BTreeMap<Module, String>) {
    let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    for entry in entries {
        let path = entry.expect("a folder can be listed").path();
        let stem = path.file_stem().expect("it has a name").to_string_lossy();
        if stem == "tests" || stem == "bin" {
            continue;
        }
        let mut module = inside.clone();
        if path.is_dir() {
            module.push(stem.into_owned());
            read(&path, &module, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            if !["lib", "main", "mod"].contains(&&*stem) {
                module.push(stem.into_owned());
            }
            let source = fs::read_to_string(&path).expect("a source can be read");
            // A library and a program of the same folder share their root.
            found.entry(module).or_default().push_str(&code(&source));
        }
    }
}

/// A source without comments and without the module of its tests, which is its last item.
fn code(source: &str) -> String {
    let source = source.split("#[cfg(test)]\nmod ").next().unwrap_or("");
    let lines = source
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""));
    lines.collect::<Vec<_>>().join("\n") + "\n"
}

/// The paths of a `use` tree.
fn leaves(tree: &str, before: &[String], found: &mut Vec<Module>) {
    let joined = |path: &str| {
        let path = path.split(" as ").next().unwrap_or("");
        let parts = path.split("::").map(str::trim).filter(|p| !p.is_empty());
        let mut all = before.to_vec();
        all.extend(parts.map(str::to_owned));
        all
    };
    let Some((prefix, group)) = tree.split_once('{') else {
        found.push(joined(tree));
        return;
    };
    let group = &group[..group.rfind('}').expect("a group ends")];
    let before = joined(prefix);
    let (mut depth, mut start) = (0, 0);
    for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !group[start..at].trim().is_empty() {
                    leaves(group[start..at].trim(), &before, found);
                }
                start = at + 1;
            }
            _ => {}
        }
    }
}

/// The paths that a module names, and whether each is re-exported.
fn paths(code: &str) -> Vec<(bool, Module)> {
    let mut found = Vec::new();
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    for (at, _) in code.match_indices("use ") {
        let before = &code[..at];
        if before.ends_with(is_name) {
            continue;
        }
        let end = at + code[at..].find(';').expect("a use ends");
        let line = before.rsplit(['\n', ';']).next().unwrap_or("");
        let mut all = Vec::new();
        leaves(&code[at + 4..end], &[], &mut all);
        found.extend(all.into_iter().map(|path| (line.contains("pub"), path)));
    }
    for root in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(root) {
            if code[..at].ends_with(|c| is_name(c) || c == ':') {
                continue;
            }
            let end = code[at..].find(|c| !is_name(c) && c != ':');
            let path = &code[at..end.map_or(code.len(), |end| at + end)];
            let parts = path.split("::").filter(|part| !part.is_empty());
            found.push((false, parts.map(str::to_owned).collect()));
        }
    }
    found
}

/// A crate's modules, and what each uses.
struct Graph {
    modules: BTreeMap<Module, String>,
    /// By module and name: what is re-exported under it.
    exports: BTreeMap<(Module, String), Module>,
}

impl Graph {
    fn of(package: &str) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut modules = BTreeMap::new();
        read(&root.join(package).join("src"), &Vec::new(), &mut modules);
        let mut graph = Self {
            modules,
            exports: BTreeMap::new(),
        };
        for (module, code) in &graph.modules {
            for (exported, path) in paths(code) {
                if let (true, Some(path)) = (exported, graph.absolute(module, &path)) {
                    let name = path.last().expect("a path has a name").clone();
                    graph.exports.insert((module.clone(), name), path);
                }
            }
        }
        graph
    }

    /// A path from the root of the crate; `None` if it leads out of the crate.
    fn absolute(&self, module: &Module, path: &[String]) -> Option<Module> {
        let mut base = match path.first()?.as_str() {
            "crate" => Vec::new(),
            "super" | "self" => module.clone(),
            child => {
                let mut inside = module.clone();
                inside.push(child.to_owned());
                if !self.modules.contains_key(&inside) {
                    return None;
                }
                module.clone()
            }
        };
        for part in path {
            match part.as_str() {
                "crate" | "self" => {}
                "super" => {
                    base.pop();
                }
                name => base.push(name.to_owned()),
            }
        }
        Some(base)
    }

    /// The module that defines what a path leads to.
    fn definer(&self, path: &Module) -> Module {
        let mut path = path.clone();
        // A name is re-exported through as many modules as there are, at most.
        for _ in 0..self.modules.len() {
            let known = (0..=path.len()).rev();
            let mut known = known.filter(|&k| self.modules.contains_key(&path[..k]));
            let depth = known.next().expect("the root is a module");
            let module = path[..depth].to_vec();
            let export = path
                .get(depth)
                .and_then(|name| self.exports.get(&(module.clone(), name.clone())));
            match export {
                Some(export) if *export != path[..=depth] => {
                    path = [&export[..], &path[depth + 1..]].concat();
                }
                _ => return module,
            }
        }
        panic!("{path:?} is re-exported in a circle");
    }

    /// By parent: which of its children uses which other one, and a path that does.
    fn uses(&self) -> BTreeMap<Module, BTreeMap<(String, String), String>> {
        let mut all: BTreeMap<Module, BTreeMap<_, _>> = BTreeMap::new();
        for (module, code) in &self.modules {
            for (_, path) in paths(code) {
                let Some(path) = self.absolute(module, &path) else {
                    continue;
                };
                let to = self.definer(&path);
                let common = module.iter().zip(&to).take_while(|(a, b)| a == b).count();
                if let (Some(from), Some(to)) = (module.get(common), to.get(common)) {
                    let example = format!("{} -> {}", module.join("::"), path.join("::"));
                    let edges = all.entry(module[..common].to_vec()).or_default();
                    edges.insert((from.clone(), to.clone()), example);
                }
            }
        }
        all
    }
}

/// The strongly connected components of more than one module.
fn circles(edges: &BTreeMap<(String, String), String>) -> BTreeSet<BTreeSet<String>> {
    let reach = |start: &String| {
        let mut seen = BTreeSet::new();
        let mut open = vec![start];
        while let Some(from) = open.pop() {
            for (a, b) in edges.keys() {
                if a == from && seen.insert(b.clone()) {
                    open.push(b);
                }
            }
        }
        seen
    };
    let reached: BTreeMap<_, _> = edges.keys().map(|(a, _)| (a, reach(a))).collect();
    let on_circle = reached.iter().filter(|(a, seen)| seen.contains(**a));
    on_circle
        .map(|(a, seen)| {
            let back = |b: &&String| reached.get(*b).is_some_and(|seen| seen.contains(*a));
            seen.iter().filter(back).cloned().collect()
        })
        .collect()
}

#[test]
fn no_module_uses_what_uses_it() {
    let mut wrong = Vec::new();
    for package in CRATES {
        for (parent, edges) in Graph::of(package).uses() {
            let parent = parent.join("::");
            for circle in circles(&edges) {
                wrong.push(format!("{package}, in \"{parent}\": {circle:?}"));
                for ((a, b), example) in &edges {
                    if circle.contains(a) && circle.contains(b) {
                        wrong.push(format!("    {a} uses {b}: {example}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "circles:\n{}", wrong.join("\n"));
}

/// The default law and the base stand on shared ground.
#[test]
fn nothing_else_uses_the_law_of_the_paper() {
    let uses = Graph::of("controller-core").uses();
    let of_root = &uses[&Module::new()];
    let wrong = of_root.iter().filter(|((_, to), _)| to == "paper");
    assert_eq!(wrong.map(|(_, path)| path).collect::<Vec<_>>(), [""; 0]);
    assert!(of_root.keys().any(|(from, _)| from == "paper"));
}

/// Circles of two and three are found, through folders and re-exports; a parent and its child are none.
#[test]
fn circles_are_found() {
    let graph = |sources: &[(&str, &str)]| {
        let of = |(path, code): &(&str, &str)| {
            let parts = path.split("::").filter(|part| !part.is_empty());
            (parts.map(str::to_owned).collect(), (*code).to_owned())
        };
        let modules: BTreeMap<Module, String> = sources.iter().map(of).collect();
        let mut graph = Graph {
            modules,
            exports: BTreeMap::new(),
        };
        let named = |name: &str| (vec!["a".to_owned()], name.to_owned());
        let path = |path: &str| path.split("::").map(str::to_owned).collect();
        graph.exports.insert(named("Name"), path("a::inner::Name"));
        let uses = graph.uses();
        uses.values().flat_map(circles).collect::<Vec<_>>()
    };
    let none = [
        ("", "pub use a::Name;\n"),
        ("a", "mod inner;\npub use inner::Name;\n"),
        ("a::inner", "use super::helper;\n"),
        ("b", "use crate::{a::{self, Name}, c};\n"),
        ("c", "fn f() {}\n"),
    ];
    assert_eq!(graph(&none).len(), 0);
    let mut two = none;
    two[2].1 = "fn f() { crate::b::g() }\n";
    assert_eq!(graph(&two), [["a", "b"].map(str::to_owned).into()]);
    let mut three = none;
    three[4].1 = "use super::a::Name;\n";
    three[2].1 = "use crate::b::B;\n";
    assert_eq!(graph(&three), [["a", "b", "c"].map(str::to_owned).into()]);
}
