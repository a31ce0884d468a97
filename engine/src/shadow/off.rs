//! No cast shadows: only a facet's own plane shades it.

use std::sync::Arc;

use super::method::{Bench, Family, Ingredients, MethodOptions, NamedMethod, PrepareError, ShadowMethod};

pub const FAMILY: Family = Family {
    named: &[NamedMethod {
        name: "none",
        bench: Bench::Usual,
        hard_cases: false,
        auto: false,
        options: || Box::new(Off),
    }],
    patterns: &[],
    parse: |_| None,
};

/// The method that casts none, and its options: there are none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Off;

impl ShadowMethod for Off {
    fn name(&self) -> &'static str {
        "none"
    }
}

impl MethodOptions for Off {
    fn spelling(&self) -> String {
        "Off".into()
    }

    fn serves_globe(&self) -> bool {
        true
    }

    fn prepare(&self, _: Ingredients) -> Result<Arc<dyn ShadowMethod>, PrepareError> {
        Ok(Arc::new(Self))
    }
}
