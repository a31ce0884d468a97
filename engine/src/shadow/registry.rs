//! All shadow methods: the only list.

use std::sync::Arc;

use super::horizon_maps::{self, HorizonMaps, HorizonMapsOptions};
use super::method::{Bench, Family, MethodOptions, NamedMethod, ShadowMethod};
use super::off::Off;
use super::site::Shadow;
use super::traced::{Traced, TracedShadow};
use super::{mipmaps, multiscale, off, towards_sun, traced};
use crate::horizon::{HorizonMap, Settings};
use crate::terrain::Surface;

/// By folder.
const FAMILIES: [&Family; 6] =
    [&traced::FAMILY, &horizon_maps::FAMILY, &towards_sun::FAMILY, &mipmaps::FAMILY, &multiscale::FAMILY, &off::FAMILY];

/// All methods that have a name of their own.
pub fn all() -> impl Iterator<Item = &'static NamedMethod> {
    FAMILIES.into_iter().flat_map(|family| family.named)
}

/// The options behind a name.
pub fn named(name: &str) -> Option<Box<dyn MethodOptions>> {
    let own = all().find(|named| named.name == name).map(|named| (named.options)());
    own.or_else(|| FAMILIES.iter().find_map(|family| (family.parse)(name)))
}

/// Names that a bench compares.
pub fn names(bench: Bench) -> impl Iterator<Item = &'static str> {
    all().filter(move |named| named.bench == bench).map(|named| named.name)
}

/// Names that hard cases are tried with.
pub fn hard_case_names() -> impl Iterator<Item = &'static str> {
    all().filter(|named| named.hard_cases).map(|named| named.name)
}

/// Names with a parameter, for people.
pub fn patterns() -> impl Iterator<Item = &'static str> {
    FAMILIES.into_iter().flat_map(|family| family.patterns).copied()
}

/// Methods among which `Auto` chooses; of equal ones the first.
pub fn candidates() -> impl Iterator<Item = Box<dyn MethodOptions>> {
    all().filter(|named| named.auto).map(|named| (named.options)())
}

/// How the reference is asked for that others are held to.
pub fn reference_options() -> Box<dyn MethodOptions> {
    Box::new(traced::Options)
}

/// The reference that others are held to.
pub fn reference(settings: Settings) -> Arc<dyn ShadowMethod> {
    Arc::new(Traced { settings })
}

/// The reference as a source of shadows of a surface.
pub fn reference_shadow(surface: &Surface, settings: Settings) -> Box<dyn Shadow + '_> {
    Box::new(TracedShadow { surface, settings })
}

/// The method whose nodes hold skylines as they were swept: what others with skylines at nodes err beyond it, their encoding
/// does.
pub fn uncompressed_at_nodes() -> Option<&'static str> {
    all().find(|named| (named.options)().is_for_given_lights()).map(|named| named.name)
}

/// How horizon maps at every sample are asked for, whose errors are known.
pub fn maps_options() -> Box<dyn MethodOptions> {
    Box::new(HorizonMapsOptions::default())
}

/// How no cast shadows are asked for.
pub fn no_shadows_options() -> Box<dyn MethodOptions> {
    Box::new(Off)
}

/// No cast shadows.
pub fn no_shadows() -> Arc<dyn ShadowMethod> {
    Arc::new(Off)
}

/// The method that is made of horizon maps by face and level, evaluated at every sample.
pub fn of_maps(maps: Vec<Vec<HorizonMap>>) -> Arc<dyn ShadowMethod> {
    Arc::new(HorizonMaps::of(maps))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_distinct_and_lead_to_their_options() {
        let names: Vec<_> = all().map(|named| named.name).collect();
        for (index, name) in names.iter().enumerate() {
            assert!(!names[..index].contains(name) && named(name).is_some(), "{name}");
        }
        assert!(named("fourier-w21").is_some() && named("preset-High").is_some() && named("preset-None").is_some());
        assert!(named("fourier-").is_none() && named("nothing").is_none());
    }

    #[test]
    fn some_methods_are_usual_and_some_are_chosen_among() {
        assert!(names(Bench::Usual).count() > 4 && candidates().count() > 2 && hard_case_names().count() > 8);
    }
}
