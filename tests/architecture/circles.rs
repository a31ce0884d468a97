//! Circles between the files of a module.
//!
//! A file uses another one where a path of it (`use` or not) ends there, re-exports followed to the file that defines the
//! name. Comments and unit tests do not count. A child may use its parent, since the parent uses it anyway; that alone
//! is no circle, but whatever leads back into the family from outside is one.

use std::collections::{BTreeMap, BTreeSet};

/// A file: its path below `src`, and its text.
pub type Source = (String, String);

/// Every circle among files, as `a.rs -> b.rs -> a.rs`, with the name that each step is for.
pub fn circles(sources: &[Source]) -> Vec<String> {
    let tree = Tree::new(sources);
    let uses = tree.uses();
    let mut found = Vec::new();
    for (file, targets) in &uses {
        // Of all circles through a file the shortest, told once: by the first of its members.
        let shortest = targets.keys().filter_map(|next| Some([vec![*file], tree.way(&uses, *next, *file)?].concat()));
        let Some(circle) = shortest.min_by_key(Vec::len) else { continue };
        if circle.iter().min() == Some(file) {
            found.push(tree.text(&uses, &circle));
        }
    }
    found
}

type Uses = BTreeMap<usize, BTreeMap<usize, String>>;

struct Tree<'a> {
    sources: &'a [Source],
    /// Files by their module's path.
    modules: BTreeMap<Vec<String>, usize>,
    files: Vec<File>,
}

/// What a file says.
struct File {
    module: Vec<String>,
    /// Absolute paths, so far as they lie in the crate.
    paths: Vec<Vec<String>>,
    /// What its imports bring in, by name.
    imports: BTreeMap<String, Vec<String>>,
}

impl<'a> Tree<'a> {
    fn new(sources: &'a [Source]) -> Self {
        let modules: BTreeMap<_, _> = sources.iter().zip(0..).map(|((path, _), file)| (module(path), file)).collect();
        let files = sources.iter().map(|(path, text)| File::new(module(path), text, &modules)).collect();
        Self { sources, modules, files }
    }

    /// Which files each file uses, and a name that it uses them for. A child's use of its parent is left out where it closes
    /// no circle but that of the two.
    fn uses(&self) -> Uses {
        let mut uses = Uses::new();
        for (index, file) in self.files.iter().enumerate() {
            for path in &file.paths {
                if let Some(target) = self.defining(path, 0).filter(|target| *target != index) {
                    uses.entry(index).or_default().entry(target).or_insert_with(|| path.join("::"));
                }
            }
        }
        let all = uses.clone();
        for (index, targets) in &mut uses {
            let parent = self.files[*index].module.split_last().and_then(|(_, parent)| self.modules.get(parent));
            if let Some(parent) = parent
                && !self.is_entered(&all, *parent)
            {
                targets.remove(parent);
            }
        }
        uses
    }

    /// Whether something beyond a file's folder both is used from there and leads back to it.
    fn is_entered(&self, uses: &Uses, parent: usize) -> bool {
        let family = &self.files[parent].module;
        let outside = |file: &usize| !self.files[*file].module.starts_with(family);
        reached(uses, parent).iter().filter(|file| outside(file)).any(|file| reached(uses, *file).contains(&parent))
    }

    /// The file in which a path ends.
    fn defining(&self, path: &[String], depth: usize) -> Option<usize> {
        let longest = (1..=path.len()).rev().find(|length| self.modules.contains_key(&path[..*length]))?;
        let file = self.modules[&path[..longest]];
        let imported = path.get(longest).and_then(|name| self.files[file].imports.get(name));
        match imported {
            // Imports may name each other in a circle of their own.
            Some(target) if depth < 8 => {
                let whole = [target.as_slice(), &path[longest + 1..]].concat();
                self.defining(&whole, depth + 1).or(Some(file))
            }
            _ => Some(file),
        }
    }

    /// The shortest way from one file to another.
    fn way(&self, uses: &Uses, from: usize, to: usize) -> Option<Vec<usize>> {
        let mut ways = vec![vec![from]];
        let mut seen = BTreeSet::from([from]);
        while !ways.is_empty() {
            if let Some(way) = ways.iter().find(|way| way.last() == Some(&to)) {
                return Some(way.clone());
            }
            let mut longer = Vec::new();
            for way in ways {
                for next in way.last().and_then(|last| uses.get(last)).into_iter().flat_map(BTreeMap::keys) {
                    if seen.insert(*next) {
                        longer.push([way.as_slice(), &[*next]].concat());
                    }
                }
            }
            ways = longer;
        }
        None
    }

    fn text(&self, uses: &Uses, circle: &[usize]) -> String {
        let step = |pair: &[usize]| format!(" -({})-> {}", uses[&pair[0]][&pair[1]], self.sources[pair[1]].0);
        self.sources[circle[0]].0.clone() + &circle.windows(2).map(step).collect::<String>()
    }
}

/// All files that a file leads to.
fn reached(uses: &Uses, from: usize) -> BTreeSet<usize> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
    while let Some(file) = open.pop() {
        open.extend(uses.get(&file).into_iter().flat_map(BTreeMap::keys).filter(|next| seen.insert(**next)));
    }
    seen
}

/// The module of a file: `horizon/mod.rs` and `horizon.rs` are `horizon`.
fn module(path: &str) -> Vec<String> {
    let mut names: Vec<_> = path.trim_end_matches(".rs").split('/').map(String::from).collect();
    if names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    names
}

impl File {
    fn new(module: Vec<String>, text: &str, modules: &BTreeMap<Vec<String>, usize>) -> Self {
        let tokens = tokens(&without_tests(text));
        let (mut paths, mut imports) = (Vec::new(), BTreeMap::new());
        // Modules within the file, and the depth of braces that each ends with.
        let (mut inner, mut depth) = (Vec::<(String, usize)>::new(), 0);
        let mut at = 0;
        while at < tokens.len() {
            let before = at.checked_sub(1).map(|before| tokens[before].as_str());
            match tokens[at].as_str() {
                "{" => depth += 1,
                "}" => {
                    depth = usize::saturating_sub(depth, 1);
                    inner.pop_if(|(_, end)| *end == depth);
                }
                "mod" if tokens.get(at + 2).is_some_and(|next| next == "{") => {
                    inner.push((tokens[at + 1].clone(), depth));
                }
                name if before != Some("::") && is_path(&tokens, at) => {
                    let here = [module.clone(), inner.iter().map(|(name, _)| name.clone()).collect()].concat();
                    let is_import = before == Some("use");
                    let mut leaves = Vec::new();
                    let child = [here.as_slice(), &[name.into()]].concat();
                    let start = if modules.contains_key(&child) { here.clone() } else { Vec::new() };
                    at = leaf_paths(&tokens, at, start, &mut leaves);
                    for (path, name) in leaves {
                        let Some(path) = absolute(path, &here) else { continue };
                        if is_import && inner.is_empty() {
                            imports.insert(name, path.clone());
                        }
                        paths.push(path);
                    }
                    continue;
                }
                _ => {}
            }
            at += 1;
        }
        // A module's own imports name their leaves.
        imports.remove(module.last().map_or("", String::as_str));
        Self { module, paths, imports }
    }
}

/// Whether a path of several names begins at a token.
fn is_path(tokens: &[String], at: usize) -> bool {
    let is_name = tokens[at].starts_with(|c: char| c.is_alphabetic() || c == '_');
    is_name && tokens.get(at + 1).is_some_and(|next| next == "::")
}

/// All paths of a tree that begins at a token, with the names that they bring in; returns the token after it.
fn leaf_paths(
    tokens: &[String],
    mut at: usize,
    mut path: Vec<String>,
    found: &mut Vec<(Vec<String>, String)>,
) -> usize {
    loop {
        let Some(token) = tokens.get(at) else { return at };
        if token == "{" {
            at += 1;
            while tokens.get(at).is_some_and(|token| token != "}") {
                at = leaf_paths(tokens, at, path.clone(), found);
                at += usize::from(tokens.get(at).is_some_and(|token| token == ","));
            }
            return at + 1;
        }
        if !token.starts_with(|c: char| c.is_alphabetic() || c == '_' || c == '*') {
            found.push((path, String::new()));
            return at;
        }
        // `self` in a group is the group's own module.
        if token != "self" || path.is_empty() {
            path.push(token.clone());
        }
        at += 1;
        if tokens.get(at).is_some_and(|token| token == "::") {
            at += 1;
            continue;
        }
        let mut name = path.last().cloned().unwrap_or_default();
        if tokens.get(at).is_some_and(|token| token == "as") {
            name = tokens.get(at + 1).cloned().unwrap_or_default();
            at += 2;
        }
        found.push((path, name));
        return at;
    }
}

/// A path from the crate's root; `None` where it begins elsewhere.
fn absolute(mut path: Vec<String>, here: &[String]) -> Option<Vec<String>> {
    if path.starts_with(here) && !here.is_empty() {
        return Some(path);
    }
    let mut base = match path.first()?.as_str() {
        "crate" => Vec::new(),
        "self" | "super" => here.to_vec(),
        _ => return None,
    };
    let ups = path.iter().take_while(|name| *name == "super").count();
    base.truncate(base.len().saturating_sub(ups));
    Some([base, path.split_off(ups.max(1))].concat())
}

/// The text up to the unit tests, which come last, comments cut.
fn without_tests(text: &str) -> String {
    let end = text.match_indices("#[cfg(test)]").find(|(at, mark)| {
        let next = text[at + mark.len()..].trim_start().lines().next().unwrap_or_default();
        next.contains("mod ") && next.ends_with('{')
    });
    let code = &text[..end.map_or(text.len(), |(at, _)| at)];
    code.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Names, `::`, and single characters.
fn tokens(code: &str) -> Vec<String> {
    let mut tokens: Vec<String> = Vec::new();
    let mut rest = code.trim_start();
    while let Some(first) = rest.chars().next() {
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let length = if is_name(first) {
            rest.find(|c| !is_name(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        tokens.push(rest[..length].into());
        rest = rest[length..].trim_start();
    }
    tokens
}

#[cfg(test)]
mod tests {
    use super::circles;

    fn found(sources: &[(&str, &str)]) -> Vec<String> {
        circles(&sources.iter().map(|(path, text)| ((*path).into(), (*text).into())).collect::<Vec<_>>())
    }

    #[test]
    fn a_circle_through_a_re_export_is_found() {
        let sources = [
            ("m/mod.rs", "pub mod a;\npub mod b;\npub mod c;\npub use b::B;"),
            ("m/a.rs", "use crate::m::B;"),
            ("m/b.rs", "use super::{c::{self, C}, other};\npub struct B;"),
            ("m/c.rs", "fn f() { super::a::g() }"),
        ];
        assert_eq!(found(&sources), ["m/a.rs -(m::B)-> m/b.rs -(m::c)-> m/c.rs -(m::a::g)-> m/a.rs"]);
        let open = [sources[0], sources[1], sources[2], ("m/c.rs", "pub struct C;")];
        assert!(found(&open).is_empty(), "{:?}", found(&open));
    }

    #[test]
    fn a_parent_and_its_child_are_no_circle() {
        let sources = [
            ("m/mod.rs", "pub mod a;\npub mod b;"),
            ("m/a.rs", "mod x;\nmod y;\nuse x::X;\nfn f() { y::g() }\npub struct A;"),
            ("m/a/x.rs", "use super::A;"),
            ("m/a/y.rs", "use super::{A, x::X};"),
            ("m/b.rs", "use super::a::A;"),
        ];
        assert!(found(&sources).is_empty(), "{:?}", found(&sources));
    }

    #[test]
    fn children_in_a_circle_are_one_whatever_their_parent() {
        let sources =
            [("m/a.rs", "mod x;\nmod y;"), ("m/a/x.rs", "use super::y::Y;"), ("m/a/y.rs", "use super::x::X;")];
        assert_eq!(found(&sources).len(), 1);
    }

    #[test]
    fn a_way_out_of_a_family_and_back_is_a_circle() {
        let sources = [
            ("m/a.rs", "mod x;\nfn f() { x::g() }\npub struct A;"),
            ("m/a/x.rs", "use crate::m::b::B;"),
            ("m/b.rs", "use super::a::A;"),
        ];
        assert_eq!(found(&sources).len(), 1);
    }

    #[test]
    fn tests_and_comments_do_not_count() {
        let sources = [
            ("m/a.rs", "use super::b::B;"),
            ("m/b.rs", "// use super::a::A;\n/// [`super::a`]\n#[cfg(test)]\nmod tests {\n use crate::m::a::A;\n}"),
        ];
        assert!(found(&sources).is_empty());
    }
}
