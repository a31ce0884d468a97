//! Meta-kernels: text kernels that name the kernels to load.
//!
//! ```text
//! PATH_VALUES     = ( '/data/kernels' )
//! PATH_SYMBOLS    = ( 'K' )
//! KERNELS_TO_LOAD = ( '$K/de440s.bsp' '$K/a_long_na+'
//!                     'me.tpc' )
//! ```
//!
//! A `+` at the end of a text joins the next to it. A path that is not absolute is looked for beside the meta-kernel, then in
//! the working directory, where SPICE looks.
//!
//! # References
//! NAIF, *Kernel Required Reading*, toolkit N0067, chapter *Using Meta-Kernels*.

use std::path::{Path, PathBuf};

use super::EphemerisError;
use super::shipped::KernelSource;
use super::text_kernel::{Assignment, Values};

const TO_LOAD: &str = "KERNELS_TO_LOAD";
const SYMBOLS: &str = "PATH_SYMBOLS";
const VALUES: &str = "PATH_VALUES";

/// Texts of a variable by the assignments of one kernel; empty where there are none.
fn texts(path: &Path, assignments: &[Assignment], name: &str) -> Result<Vec<String>, EphemerisError> {
    let mut all: Vec<String> = Vec::new();
    for assignment in assignments.iter().filter(|assignment| assignment.name == name) {
        let Values::Texts(texts) = &assignment.values else {
            let problem = format!("{name} wants texts in quotes");
            return Err(EphemerisError::Text { path: path.to_owned(), line: assignment.line, problem });
        };
        if !assignment.appends {
            all.clear();
        }
        all.extend(texts.iter().map(|text| text.trim_end().to_owned()));
    }
    Ok(all)
}

/// Joins what a `+` continues.
fn joined(texts: Vec<String>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    let mut continues = false;
    for text in texts {
        let (part, goes_on) = text.strip_suffix('+').map_or((text.as_str(), false), |part| (part, true));
        match all.last_mut().filter(|_| continues) {
            Some(last) => last.push_str(part),
            None => all.push(part.to_owned()),
        }
        continues = goes_on;
    }
    all
}

/// The kernels that a kernel names; empty where it is no meta-kernel.
pub(super) fn named(path: &Path, assignments: &[Assignment]) -> Result<Vec<KernelSource>, EphemerisError> {
    let Some(first) = assignments.iter().find(|assignment| assignment.name == TO_LOAD) else { return Ok(Vec::new()) };
    let fault = |problem| EphemerisError::Text { path: path.to_owned(), line: first.line, problem };
    let symbols = texts(path, assignments, SYMBOLS)?;
    let values = joined(texts(path, assignments, VALUES)?);
    if symbols.len() != values.len() {
        return Err(fault(format!("{} {SYMBOLS} stand against {} {VALUES}", symbols.len(), values.len())));
    }
    let mut symbols: Vec<(String, String)> = symbols.into_iter().zip(values).collect();
    // `$AB` is no `$A` with a B behind it.
    symbols.sort_by_key(|(symbol, _)| std::cmp::Reverse(symbol.len()));
    let source = |name: String| {
        let mut written = name.clone();
        for (symbol, value) in symbols.iter().filter(|(symbol, _)| !symbol.is_empty()) {
            written = written.replace(&format!("${symbol}"), value);
        }
        if written.contains('$') {
            let known = symbols.iter().map(|(symbol, _)| format!("${symbol}")).collect::<Vec<_>>().join(", ");
            return Err(fault(format!("'{name}' has a symbol that {SYMBOLS} does not; known are {known}")));
        }
        Ok(found(path, &written))
    };
    joined(texts(path, assignments, TO_LOAD)?).into_iter().map(source).collect()
}

/// Where a kernel lies that is named so.
fn found(meta: &Path, name: &str) -> KernelSource {
    let beside = meta.parent().unwrap_or(Path::new("")).join(name);
    let here = PathBuf::from(name);
    let found = [&beside, &here].into_iter().find(|path| path.is_file()).cloned().map(KernelSource::File);
    found.or_else(|| KernelSource::shipped(name)).unwrap_or(KernelSource::File(beside))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ephemeris::text_kernel::parse;

    fn paths(text: &str) -> Result<Vec<PathBuf>, EphemerisError> {
        let path = Path::new("/m/mission.tm");
        let sources = named(path, &parse(&format!("\\begindata\n{text}")).unwrap())?;
        Ok(sources.iter().map(|source| source.path().to_owned()).collect())
    }

    #[test]
    fn symbols_are_replaced_and_long_texts_joined() {
        let text = "PATH_VALUES = ( '/data/ke+' 'rnels' 'b' )\nPATH_SYMBOLS = ( 'K' 'KB' )\n\
                    KERNELS_TO_LOAD = ( '$K/a.bsp' '$KB/lo+' 'ng.tpc' )\nKERNELS_TO_LOAD += 'naif.tls'";
        let expected = ["/data/kernels/a.bsp", "/m/b/long.tpc", "/m/naif.tls"].map(PathBuf::from);
        assert_eq!(paths(text).unwrap(), expected);
        assert!(paths("BODY301_PM = 1").unwrap().is_empty());
    }

    #[test]
    fn symbols_that_nobody_explains_are_refused() {
        let said = |text: &str| paths(text).unwrap_err().to_string();
        assert!(said("KERNELS_TO_LOAD = '$X/a.bsp'").contains("'$X/a.bsp' has a symbol"));
        assert!(said("PATH_SYMBOLS = 'K'\nKERNELS_TO_LOAD = 'a.bsp'").contains("1 PATH_SYMBOLS stand against 0"));
        assert!(said("KERNELS_TO_LOAD = 1").contains("line 2: KERNELS_TO_LOAD wants texts"));
    }
}
