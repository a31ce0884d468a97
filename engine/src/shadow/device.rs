//! What a method brings to a graphics device.
//!
//! A method's WGSL declares one function, which the pass over pixels calls for ground of a map:
//!
//! ```wgsl
//! // What is seen of the disc of light `index`, from the direction `s`, above the terrain and above the facet's own `plane`.
//! fn light_over_terrain(facet: Facet, index: u32, light: LightParameters, s: vec3f, plane: vec3f) -> DiskLight
//! ```
//!
//! Bindings 0 to 3 of group 0 are the method's own; only the text of the chosen method is compiled.

use std::fmt::Debug;

use wgpu::Buffer;

use super::light::QuantizedLight;
use crate::gpu::{Gpu, GpuError};
use crate::horizon::Encoding;
use crate::terrain::Gnomonic;

/// Without terrain: only the facet's own plane shades it.
const OPEN: &str = include_str!("open.wgsl");
/// Skylines of nodes, interpolated.
const NODES: &str = include_str!("nodes.wgsl");
/// The same with what they leave out.
const NODES_AND_NEAR: &str = concat!(
    include_str!("nodes_and_near.wgsl"),
    include_str!("near.wgsl"),
    include_str!("../horizon/arc_tangent.wgsl")
);
/// The light above a straight skyline.
pub const SKYLINE_WGSL: &str = include_str!("skyline.wgsl");
/// Fields of nodes, interpolated: all bindings of a method.
pub const FIELDS_WGSL: &str = include_str!("fields.wgsl");

/// Bindings that belong to a method.
pub const BINDINGS: usize = 4;

/// A method's part of a device's pass over pixels.
#[derive(Debug)]
pub struct DevicePart {
    /// Declares `light_over_terrain` and what it calls beyond the pass itself.
    pub wgsl: String,
    /// Its `override` values.
    pub constants: Vec<(&'static str, f64)>,
    /// Bindings 0, 1, … that its WGSL reads; fields take all of them.
    pub buffers: Vec<Buffer>,
    /// Where each level's texels begin, in the order of faces and levels; empty where there are none.
    pub texels: Vec<LevelTexels>,
    /// What is found for all nodes while the lights stand still.
    pub fields: Option<Fields>,
}

/// Where a level's horizon map lies in its buffers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LevelTexels {
    pub pages: [u32; 4],
    pub table: u32,
}

/// Where fields are found.
#[derive(Debug)]
pub enum Fields {
    /// On the host, by the method's [`super::SkylineSource`].
    Host,
    Device(Box<dyn FieldMaker>),
}

/// Makes fields of nodes on a device.
pub trait FieldMaker: Debug + Send + Sync {
    /// Writes two numbers for each seen node of a level towards a light, from node `offset` of `fields` on. Gives the seconds
    /// that it took where the device tells them.
    fn field(
        &self,
        gpu: &Gpu,
        map: &Gnomonic,
        place: [usize; 2],
        light: &QuantizedLight,
        fields: &Buffer,
        offset: usize,
    ) -> Option<f64>;
}

/// Why a method has no part on a device.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    #[error(transparent)]
    Gpu(#[from] GpuError),
    #[error("{0} shadows need the reference renderer")]
    HostOnly(&'static str),
    #[error("horizon maps are encoded as {first} and as {other}, want one encoding")]
    Encodings { first: Encoding, other: Encoding },
}

impl DevicePart {
    /// A method of some WGSL alone.
    pub fn of(wgsl: impl Into<String>, constants: Vec<(&'static str, f64)>) -> Self {
        Self { wgsl: wgsl.into(), constants, buffers: Vec::new(), texels: Vec::new(), fields: None }
    }

    /// No terrain casts shadows.
    pub fn open() -> Self {
        Self::of(OPEN, Vec::new())
    }

    /// Skylines of nodes, interpolated, made on the device or on the host; terrain within so many postings is looked at from
    /// every sample.
    pub fn of_skylines(maker: Option<Box<dyn FieldMaker>>, near: usize) -> Self {
        let (nodes, constants) = match near {
            0 => (NODES, Vec::new()),
            postings => (NODES_AND_NEAR, vec![("NEAR", postings as f64)]),
        };
        Self {
            fields: Some(maker.map_or(Fields::Host, Fields::Device)),
            ..Self::of([SKYLINE_WGSL, FIELDS_WGSL, nodes].concat(), constants)
        }
    }
}
