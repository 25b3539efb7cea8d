//! The import graph between the files of a crate, and its circles.
//!
//! Read from tokens, not by a compiler: paths that begin with `crate`, `self`, `super`, an imported name or a child module.
//! A path leads to the file that defines the item, through the re-exports of the modules on its way.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::tokens::{skip_enclosed, tokenise};

/// A module's path from the crate's root.
type ModulePath = Vec<String>;

/// One file as a module.
#[derive(Debug, Default)]
struct Module {
    /// Its path below the root.
    file: String,
    /// Whether it only lists modules and re-exports, so that it stands for its children.
    only_lists: bool,
    /// Imported and re-exported names, with the paths that they stand for.
    aliases: BTreeMap<String, ModulePath>,
    /// Modules of which everything is imported.
    globs: Vec<ModulePath>,
    /// Items that it defines.
    items: BTreeSet<String>,
    /// All paths of its code, relative as they stand there.
    paths: Vec<ModulePath>,
}

/// Files by the files that they import.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// Computes the import graph of the files of one crate, given by their paths from its root.
pub fn import_graph<'a>(files: impl IntoIterator<Item = (&'a Path, &'a str)>) -> Graph {
    let modules: BTreeMap<ModulePath, Module> =
        files.into_iter().map(|(path, text)| (module_path(path), parse(path, text))).collect();
    let mut graph = Graph::new();
    for (at, module) in modules.iter().filter(|(_, module)| !module.only_lists) {
        let imported = graph.entry(module.file.clone()).or_default();
        for path in &module.paths {
            if let Some(target) = resolve(&modules, at, path, 0)
                && target.file != module.file
                && !target.only_lists
            {
                imported.insert(target.file.clone());
            }
        }
    }
    graph
}

/// Returns the sets of more than one file in which every file imports every other, perhaps through others.
pub fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let reach: BTreeMap<&String, BTreeSet<&String>> =
        graph.keys().map(|from| (from, reachable(graph, from))).collect();
    let mut found: Vec<Vec<String>> = Vec::new();
    for file in graph.keys() {
        let circle: Vec<String> = graph
            .keys()
            .filter(|other| reach[file].contains(other) && reach[other].contains(file))
            .cloned()
            .collect();
        if circle.len() > 1 && !found.contains(&circle) {
            found.push(circle);
        }
    }
    found
}

fn reachable<'a>(graph: &'a Graph, from: &'a String) -> BTreeSet<&'a String> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        for next in graph.get(file).into_iter().flatten() {
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen
}

fn module_path(file: &Path) -> ModulePath {
    let mut parts: ModulePath = file
        .with_extension("")
        .components()
        .map(|part| part.as_os_str().to_string_lossy().into_owned())
        .collect();
    if parts.last().is_some_and(|last| matches!(last.as_str(), "mod" | "lib" | "main")) {
        parts.pop();
    }
    parts
}

/// Follows a path from a module to the module that defines its item; none if it leads out of the crate.
fn resolve<'a>(
    modules: &'a BTreeMap<ModulePath, Module>,
    from: &[String],
    path: &[String],
    depth: usize,
) -> Option<&'a Module> {
    // Re-exports are a few steps long; more is a path that leads to itself.
    const STEPS_MAX: usize = 12;
    let (first, rest) = path.split_first().filter(|_| depth < STEPS_MAX)?;
    let mut at: ModulePath = match first.as_str() {
        "crate" => Vec::new(),
        "self" => from.to_vec(),
        "super" => from.split_last()?.1.to_vec(),
        name => {
            let module = modules.get(from)?;
            if let Some(target) = module.aliases.get(name).filter(|target| target.first() != Some(first)) {
                let whole: ModulePath = target.iter().chain(rest).cloned().collect();
                return resolve(modules, from, &whole, depth + 1);
            }
            let child: ModulePath = from.iter().chain([first]).cloned().collect();
            modules.contains_key(&child).then_some(child)?
        }
    };
    for (index, name) in rest.iter().enumerate() {
        if name == "super" {
            at.pop()?;
            continue;
        }
        let child: ModulePath = at.iter().chain([name]).cloned().collect();
        if modules.contains_key(&child) {
            at = child;
            continue;
        }
        let module = modules.get(&at)?;
        let left = &rest[index..];
        if module.items.contains(name) {
            return Some(module);
        }
        if let Some(target) = module.aliases.get(name) {
            let whole: ModulePath = target.iter().chain(&left[1..]).cloned().collect();
            return resolve(modules, &at, &whole, depth + 1);
        }
        let through_glob = module.globs.iter().find_map(|glob| {
            let whole: ModulePath = glob.iter().chain(left).cloned().collect();
            resolve(modules, &at, &whole, depth + 1).filter(|found| found.items.contains(name))
        });
        return through_glob.or(Some(module));
    }
    modules.get(&at)
}

fn parse(path: &Path, text: &str) -> Module {
    let tokens = tokenise(text);
    let mut module = Module { file: path.display().to_string(), only_lists: true, ..Module::default() };
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token.as_str() {
            "#" if tokens[at..]
                .iter()
                .take(7)
                .map(String::as_str)
                .eq(["#", "[", "cfg", "(", "test", ")", "]"]) =>
            {
                at = skip_enclosed(&tokens, at + 7, ["{", "}"]);
            }
            // Attributes name no module of ours.
            "#" => at = skip_enclosed(&tokens, at, ["[", "]"]),
            "use" => {
                at = parse_tree(&tokens, at + 1, &[], &mut module);
                at += 1;
            }
            "mod" if tokens.get(at + 2).is_some_and(|next| next == ";") => at += 3,
            "pub" => at += 1,
            "(" if at > 0 && tokens[at - 1] == "pub" => {
                while tokens[at] != ")" {
                    at += 1;
                }
                at += 1;
            }
            _ => {
                module.only_lists = false;
                at = parse_code(&tokens, at, &mut module);
            }
        }
    }
    module
}

/// Takes a definition's name or a path, and returns where the rest begins.
fn parse_code(tokens: &[String], at: usize, module: &mut Module) -> usize {
    const DEFINES: [&str; 8] = ["fn", "struct", "enum", "trait", "const", "static", "type", "union"];
    let is_name = |token: &String| token.starts_with(|c: char| c.is_alphabetic() || c == '_');
    if DEFINES.contains(&tokens[at].as_str())
        && let Some(name) = tokens.get(at + 1).filter(|token| is_name(token))
    {
        module.items.insert(name.clone());
        return at + 2;
    }
    if !is_name(&tokens[at]) {
        return at + 1;
    }
    let mut path = vec![tokens[at].clone()];
    let mut next = at + 1;
    while tokens.get(next).is_some_and(|token| token == "::") && tokens.get(next + 1).is_some_and(is_name) {
        path.push(tokens[next + 1].clone());
        next += 2;
    }
    let is_field = at > 0 && tokens[at - 1] == ".";
    if path.len() > 1 && !is_field {
        module.paths.push(path);
    }
    next
}

/// Takes one tree of a `use`, and returns the place of the token after it.
fn parse_tree(tokens: &[String], mut at: usize, prefix: &[String], module: &mut Module) -> usize {
    let mut path = prefix.to_vec();
    loop {
        match tokens[at].as_str() {
            "{" => {
                at += 1;
                while tokens[at] != "}" {
                    at = parse_tree(tokens, at, &path, module);
                    if tokens[at] == "," {
                        at += 1;
                    }
                }
                return at + 1;
            }
            "*" => {
                module.globs.push(path.clone());
                module.paths.push(path);
                return at + 1;
            }
            "::" => {
                at += 1;
                continue;
            }
            "self" if !path.is_empty() => at += 1,
            name => {
                path.push(name.to_owned());
                at += 1;
            }
        }
        if tokens[at] == "::" {
            continue;
        }
        let mut name = path.last().cloned().unwrap_or_default();
        if tokens[at] == "as" {
            name.clone_from(&tokens[at + 1]);
            at += 2;
        }
        module.paths.push(path.clone());
        module.aliases.insert(name, path);
        return at;
    }
}
