//! Host structs lie in memory as their shaders read them.

use std::mem::offset_of;

use perilune::photometry::{REFLECTANCE_WGSL, ReflectanceParameters};

/// Name and offset of every member of a WGSL struct, and its size.
fn layout(source: &str, name: &str) -> (Vec<(String, usize)>, usize) {
    let module = naga::front::wgsl::parse_str(source).unwrap();
    let (_, declared) = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name)).unwrap();
    match &declared.inner {
        naga::TypeInner::Struct { members, span } => {
            let members = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
            (members.collect(), *span as usize)
        }
        other => panic!("{name} is no struct but {other:?}"),
    }
}

/// The same of a host struct, from its list of members.
macro_rules! host {
    ($type:ty: $($member:ident)*) => {
        (vec![$((stringify!($member).to_string(), offset_of!($type, $member))),*], size_of::<$type>())
    };
}

fn reflectance_parameters() -> (Vec<(String, usize)>, usize) {
    host!(ReflectanceParameters: normal_albedo exponent single_scattering_albedo asymmetry backscatter
        shadow_hiding_amplitude shadow_hiding_width coherent_amplitude coherent_width mean_slope_tan
        porosity_factor multiple_scattering)
}

#[test]
fn reflectance_parameters_lie_as_the_shader_reads_them() {
    assert_eq!(layout(REFLECTANCE_WGSL, "ReflectanceParameters"), reflectance_parameters());
}

#[test]
fn swapped_members_are_noticed() {
    let (right, wrong) = ("asymmetry: f32,\n    backscatter: f32", "backscatter: f32,\n    asymmetry: f32");
    assert!(REFLECTANCE_WGSL.contains(right));
    let swapped = REFLECTANCE_WGSL.replace(right, wrong);
    assert_ne!(layout(&swapped, "ReflectanceParameters"), reflectance_parameters());
}
