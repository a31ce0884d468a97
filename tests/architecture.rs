//! The layers of the engine: a module uses only modules of lower layers, and foreign crates only where they belong.
//!
//! Comments do not count. That the engine uses neither the bench nor the program, cargo itself sees to.

use std::fs;
use std::path::{Path, PathBuf};

mod circles;

/// Modules of one layer do not see each other.
const LAYERS: [&[&str]; 14] = [
    &["quantity", "digest", "files", "statistics", "grid", "linear", "signals", "text"],
    &["geometry"],
    &["ephemeris", "raster", "gpu", "photometry"],
    &["terrain", "camera"],
    &["horizon"],
    &["shadow"],
    &["render"],
    &["labels"],
    &["dataset"],
    &["image_metrics"],
    &["report"],
    &["illumination", "scenario"],
    &["pipeline"],
    &["compare"],
];

/// A crate, and the beginnings of the paths that may name it; `*` stands for anything within a file's name.
const CRATES: [(&str, &[&str]); 7] = [
    ("anise", &["ephemeris/"]),
    ("sofars", &["ephemeris/"]),
    ("gdal", &["raster/"]),
    ("gdal_sys", &["raster/"]),
    ("wgpu", &["gpu", "render/passes", "shadow/", "horizon/*gpu"]),
    ("pollster", &["gpu"]),
    ("ron", &["scenario/", "dataset/", "ephemeris/manifest.rs"]),
];

/// All that a file, named by its path below `src`, does against the rules.
fn violations(path: &str, source: &str) -> Vec<String> {
    let code = without_comments(source);
    let module = path.split('/').next().unwrap_or_default().trim_end_matches(".rs");
    let mut found = Vec::new();
    if module != "lib" {
        match layer(module) {
            None => found.push(format!("{path}: module {module} has no layer")),
            Some(own) => found.extend(used_modules(&code).into_iter().filter_map(|used| {
                let allowed = used == module || layer(&used).is_none_or(|other| other < own);
                (!allowed).then(|| format!("{path}: {module} uses {used}, which is not below it"))
            })),
        }
    }
    for (name, places) in CRATES {
        if names(&code, name) && !places.iter().any(|place| matches(path, place)) {
            found.push(format!("{path}: names {name}, which belongs to {}", places.join(", ")));
        }
    }
    found
}

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|modules| modules.contains(&module))
}

fn without_comments(source: &str) -> String {
    source.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Modules named after `crate::`, alone or in braces. Names that are no module (a macro, an item) have no layer.
fn used_modules(code: &str) -> Vec<String> {
    let mut used = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        match rest.strip_prefix('{') {
            None => used.push(identifier(rest)),
            Some(group) => used.extend(top_level(group).map(|item| identifier(item.trim()))),
        }
    }
    used
}

/// The items of a `use` group, up to its closing brace.
fn top_level(group: &str) -> impl Iterator<Item = &str> {
    let (mut depth, mut start, mut items) = (0, 0, Vec::new());
    for (at, letter) in group.char_indices() {
        match letter {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                items.push(&group[start..at]);
                start = at + 1;
                if letter == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    items.into_iter()
}

fn identifier(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// Whether a path of the crate `name` begins somewhere: `name::`, or `use name`.
fn names(code: &str, name: &str) -> bool {
    code.match_indices(name).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        let after = &code[at + name.len()..];
        let starts = !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':' || c == '"');
        let imported = code[..at].trim_end().ends_with("use") && after.starts_with([';', ' ']);
        starts && (after.starts_with("::") || imported)
    })
}

fn matches(path: &str, place: &str) -> bool {
    match place.split_once('*') {
        None => path.starts_with(place),
        Some((folder, part)) => path.strip_prefix(folder).is_some_and(|file| file.contains(part)),
    }
}

pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

#[test]
fn modules_use_only_what_lies_below_them() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("engine/src");
    let files = rust_files(&src);
    assert!(files.len() > 20, "found {} files", files.len());
    let found: Vec<_> = files
        .iter()
        .flat_map(|file| {
            let path = file.strip_prefix(&src).unwrap().to_string_lossy().replace('\\', "/");
            violations(&path, &fs::read_to_string(file).unwrap())
        })
        .collect();
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn files_of_a_module_are_in_no_circle() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("engine/src");
    for module in LAYERS.concat() {
        let sources = rust_files(&src).into_iter().filter_map(|file| {
            let path = file.strip_prefix(&src).ok()?.to_string_lossy().replace('\\', "/");
            let is_own = path.split('/').next()?.trim_end_matches(".rs") == module;
            is_own.then(|| (path, fs::read_to_string(file).unwrap()))
        });
        let sources: Vec<_> = sources.collect();
        assert!(!sources.is_empty(), "no files of {module}");
        let found = circles::circles(&sources);
        assert!(found.is_empty(), "{}", found.join("\n"));
    }
}

#[test]
fn every_module_of_the_library_has_a_layer() {
    let library = include_str!("../engine/src/lib.rs");
    let modules = library.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    let missing: Vec<_> = modules.filter(|module| layer(module).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn an_upward_edge_is_reported() {
    for (path, source) in [
        ("terrain/tile.rs", "use crate::render::Image;"),
        ("terrain/tile.rs", "use crate::{geometry::{Body, Local}, render::Image};"),
        ("camera/optics.rs", "fn f() { crate::terrain::height() }"),
        ("render/view.rs", "use anise::prelude::*;"),
        ("horizon/trace.rs", "fn f(device: &wgpu::Device) {}"),
        ("camera/spec.rs", "use ron;"),
        ("weather/mod.rs", ""),
    ] {
        assert_eq!(violations(path, source).len(), 1, "{path}: {source} {:?}", violations(path, source));
    }
}

#[test]
fn downward_edges_comments_and_own_paths_are_not() {
    for (path, source) in [
        ("terrain/tile.rs", "use crate::geometry::Body;\nuse crate::terrain::level::Level;"),
        ("quantity.rs", "//! Planes carry their unit in [`crate::render::image`]."),
        ("horizon/sweep_gpu.rs", "use crate::gpu::Gpu;\nfn f(device: &wgpu::Device) {}"),
        ("render/passes.rs", "use wgpu::Buffer;"),
        ("render/view.rs", "let electron::Shell = 1; let wgpu_like = neutron::x();"),
    ] {
        assert!(violations(path, source).is_empty(), "{path}: {:?}", violations(path, source));
    }
}

/// The names that the face shows of the engine, each with the paths of its `use`.
fn shown_names(face: &str) -> Vec<String> {
    let uses = face.split("pub use perilune_engine::").skip(1).filter_map(|rest| rest.split_once(';'));
    let items = uses.flat_map(|(path, _)| match path.split_once("::{") {
        Some((_, group)) => group.trim_end_matches('}').split(',').map(str::to_owned).collect::<Vec<_>>(),
        None => vec![path.rsplit("::").next().unwrap_or_default().to_owned()],
    });
    let names = items.map(|item| item.trim().split(' ').next().unwrap_or_default().to_owned());
    names.filter(|name| !name.is_empty()).collect()
}

/// Whether a source defines a name as a public item.
fn defines(source: &str, name: &str) -> bool {
    let item = |line: &str| {
        let rest = line.strip_prefix("pub ")?;
        let (_, rest) = rest.split_once(' ')?;
        Some(identifier(rest))
    };
    source.lines().any(|line| item(line).is_some_and(|found| found == name))
}

/// What the face shows is documented item by item: the compiler sees to it in every file that says so at its head.
#[test]
fn every_file_with_a_name_of_the_face_warns_of_missing_docs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let names = shown_names(&fs::read_to_string(root.join("src/lib.rs")).unwrap());
    assert!(names.len() > 30, "{names:?}");
    let sources: Vec<_> = rust_files(&root.join("engine/src"))
        .into_iter()
        .filter(|file| !file.components().any(|part| part.as_os_str() == "spec"))
        .map(|file| (file.display().to_string(), fs::read_to_string(file).unwrap()))
        .collect();
    let is_documented = |source: &str| source.lines().any(|line| line == "#![warn(missing_docs)]");
    for name in names {
        let defining: Vec<_> = sources.iter().filter(|(_, source)| defines(source, &name)).collect();
        // Frames come from a macro, epochs from another crate.
        let documented = defining.iter().any(|(_, source)| is_documented(source));
        assert!(
            documented || defining.is_empty(),
            "{name}: {:?}",
            defining.iter().map(|(file, _)| file).collect::<Vec<_>>()
        );
    }
}

#[test]
fn names_of_the_face_are_found_in_groups_and_alone() {
    let face = "pub use perilune_engine::a::{B as C, d};\npub use x::Y;\npub use perilune_engine::e::F;";
    assert_eq!(shown_names(face), ["B", "d", "F"]);
    assert!(defines("pub struct B {", "B") && !defines("struct B;\npub fn b() {}", "B"));
}
