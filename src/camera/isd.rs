//! stub
use std::path::Path;
use crate::camera::PosedCamera;
use crate::geometry::{Body, BodyFixed, Position};
#[derive(Debug, Clone)]
pub struct Isd { pub model: String, pub body: Body, pub camera: PosedCamera, pub sun: Position<BodyFixed> }
#[derive(Debug, thiserror::Error)]
pub enum IsdError { #[error("stub")] Stub }
impl Isd { pub fn from_json(_p: &Path, _j: serde_json::Value) -> Result<Self, IsdError> { Err(IsdError::Stub) } }
