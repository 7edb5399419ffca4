//! Flocks on the GPU: one buffer of all levels, and members as instances.
//!
//! A [`GpuFlock`] draws what a `Selector` chose on the CPU. A [`GpuSelection`] chooses on the GPU
//! itself, by the rule of the policy `screen-error`, and leaves out what is hidden by a [`HiZ`].

mod atlas;
mod choice;
mod drawn;
mod hiz;
mod instances;
mod model;
mod obstacles;
mod pipelines;
mod selection;

pub use drawn::GpuFlock;
pub use hiz::HiZ;
pub use obstacles::GpuObstacles;
pub use selection::GpuSelection;
