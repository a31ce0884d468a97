//! Host structs lie in memory as their shaders read them.

use std::mem::offset_of;

use perilune_engine::horizon::Encoding;
use perilune_engine::photometry::{REFLECTANCE_WGSL, ReflectanceParameters, SOLAR_DISK_WGSL};
use perilune_engine::render::layout::{
    CentreOut, LightParameters, MapFace, MapLevel, PixelOut, RayWindow, ViewParameters,
};
use perilune_engine::render::passes::SHADER;
use perilune_engine::shadow::DevicePart;
use perilune_engine::shadow::horizon_maps::device::{NODES, NodesParameters};
use perilune_engine::shadow::multiscale::device;

/// Stands for what is made of a map.
const NODE_VALUE: &str =
    "fn node_value(horizon: HorizonGrid, grid: vec2f, at_m: vec2f, s: vec3f) -> vec2f { return vec2f(0.0); }";

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
        porosity_factor multiple_scattering phase_linear phase_square phase_cube phase_fourth phase_narrow_surge
        phase_wide_surge)
}

#[test]
fn reflectance_parameters_lie_as_the_shader_reads_them() {
    assert_eq!(layout(REFLECTANCE_WGSL, "ReflectanceParameters"), reflectance_parameters());
}

#[test]
fn the_structs_of_the_pass_lie_as_the_shader_reads_them() {
    let source = [SHADER, SOLAR_DISK_WGSL, REFLECTANCE_WGSL, &DevicePart::open().wgsl].concat();
    let hosts = [
        (
            "ViewParameters",
            host!(ViewParameters: from_camera_x from_camera_y from_camera_z scaled_camera radii_m camera_m pixels
                first_ray until_ray turns),
        ),
        ("RayWindow", host!(RayWindow: low scale columns rows pitch near_m)),
        (
            "MapFace",
            host!(MapFace: from_camera_x from_camera_y from_camera_z camera_m quotient bounds_m cone first_level levels
                direct open_edge),
        ),
        (
            "MapLevel",
            host!(MapLevel: base camera south_west_m posting_m columns rows mips heights_offset maxima_offset horizon
                face horizon_table bounced),
        ),
        ("LightParameters", host!(LightParameters: direction radius_rad irradiance_w_m2 padding)),
        ("Pixel", host!(PixelOut: radiance irradiance fraction hit)),
        ("Centre", host!(CentreOut: ground level cell padding fraction distance_m padding_2)),
    ];
    for (name, host) in hosts {
        assert_eq!(layout(&source, name), host, "{name}");
    }
}

#[test]
fn parameters_of_maps_at_nodes_lie_as_the_shader_reads_them() {
    let host = host!(NodesParameters: direction south_west_m posting_m radius_m offset columns rows horizon_table
        horizon radius_rad padding);
    assert_eq!(layout(&[NODES, NODE_VALUE, &Encoding::Fm16.wgsl()].concat(), "NodesParameters"), host);
}

#[test]
fn the_structs_of_multiscale_skylines_lie_as_the_shader_reads_them() {
    let nodes = host!(device::Nodes: light swath_rad turn first spacing radius_m seen margin offset levels scales);
    assert_eq!(layout(device::SHADER, "Nodes"), nodes);
    let image = host!(device::Image: whole rest texels rate per_m start);
    assert_eq!(layout(device::SHADER, "Image"), image);
}

#[test]
fn swapped_members_are_noticed() {
    let (right, wrong) = ("asymmetry: f32,\n    backscatter: f32", "backscatter: f32,\n    asymmetry: f32");
    assert!(REFLECTANCE_WGSL.contains(right));
    let swapped = REFLECTANCE_WGSL.replace(right, wrong);
    assert_ne!(layout(&swapped, "ReflectanceParameters"), reflectance_parameters());
}
