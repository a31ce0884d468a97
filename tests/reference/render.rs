//! Images against closed forms, from the reference renderer and from the compute pass.

mod ground;
mod imaging;
mod methods;
mod shadows;
mod sphere;
