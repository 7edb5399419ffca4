//! The GPU: a device and its queue, and helpers for buffers, bindings, shaders and textures, which
//! know nothing of meshes.

pub(crate) mod bindings;
pub(crate) mod buffers;
pub(crate) mod read;
pub(crate) mod shaders;
pub(crate) mod texture;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use wgpu::{
    Adapter, Backends, Device, Features, Instance, InstanceDescriptor, PowerPreference, Queue,
};

use crate::ViewError;

/// GPU, or the software that stands in for one; a handle that is cheap to clone.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Device that makes buffers, textures and pipelines.
    pub device: Device,
    /// Queue that takes uploads and commands.
    pub queue: Queue,
    name: String,
    is_lost: Arc<AtomicBool>,
}

/// Features that are used where the GPU has them.
const WANTED: Features = Features::INDIRECT_FIRST_INSTANCE;

impl Gpu {
    /// Interfaces to the GPU that are used: Vulkan, Metal and Direct3D 12. OpenGL lacks what
    /// shaders need here, such as storage buffers for vertices.
    pub(crate) const BACKENDS: Backends = Backends::PRIMARY;

    /// Opens the fastest GPU without a window.
    ///
    /// The environment may choose another: `WGPU_BACKEND`, `WGPU_ADAPTER_NAME`.
    ///
    /// # Errors
    /// No GPU is there, or it does not open.
    pub fn headless() -> Result<Self, ViewError> {
        let all = InstanceDescriptor::new_without_display_handle_from_env();
        let backends = all.backends & Self::BACKENDS;
        let adapter = adapter(InstanceDescriptor { backends, ..all }).ok_or(ViewError::NoGpu)?;
        let opened = pollster::block_on(adapter.request_device(&Self::descriptor(&adapter)));
        let (device, queue) = opened.map_err(|error| ViewError::Failed(error.to_string()))?;
        let this = Self::new(&adapter, device, queue);
        let is_lost = Arc::clone(&this.is_lost);
        let note = move |_, _| is_lost.store(true, Ordering::Relaxed);
        this.device.set_device_lost_callback(note);
        Ok(this)
    }

    /// Takes a device that was opened elsewhere, such as by a window.
    pub fn new(adapter: &Adapter, device: Device, queue: Queue) -> Self {
        let info = adapter.get_info();
        Self {
            device,
            queue,
            name: format!("{} ({})", info.name, info.backend),
            is_lost: Arc::default(),
        }
    }

    /// Returns a description of the device to open on an adapter: with all of its limits, and those
    /// features that are used where available.
    pub fn descriptor(adapter: &Adapter) -> wgpu::DeviceDescriptor<'static> {
        wgpu::DeviceDescriptor {
            label: Some("meshlod"),
            required_features: adapter.features() & WANTED,
            required_limits: adapter.limits(),
            ..Default::default()
        }
    }

    /// Returns the name of the GPU and of the interface to it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the flag for the loss of the device, which the window's callback sets; a GPU without
    /// a window has its own callback.
    #[cfg(feature = "viewer")]
    pub(crate) fn loss(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.is_lost)
    }

    /// Returns true if the device was lost. To poll it then would end the program.
    pub(crate) fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::Relaxed)
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// The device was lost.
    pub fn wait(&self) -> Result<(), ViewError> {
        if self.is_lost() {
            return Err(ViewError::Failed("the device was lost".into()));
        }
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        done.map(|_| ()).map_err(|error| ViewError::Failed(error.to_string()))
    }

    /// Fails if a shader could not bind a buffer of this size as storage.
    pub(crate) fn check_storage(&self, what: &'static str, needed: u64) -> Result<(), ViewError> {
        let limit = self.device.limits().max_storage_buffer_binding_size;
        if needed > limit {
            return Err(ViewError::TooLarge { what, needed, limit });
        }
        self.check_buffer(what, needed)
    }

    /// Fails if a buffer of this size would be beyond the limits of the GPU.
    pub(crate) fn check_buffer(&self, what: &'static str, needed: u64) -> Result<(), ViewError> {
        let limit = self.device.limits().max_buffer_size;
        if needed <= limit { Ok(()) } else { Err(ViewError::TooLarge { what, needed, limit }) }
    }
}

/// Returns the fastest adapter of an instance.
fn adapter(descriptor: InstanceDescriptor) -> Option<Adapter> {
    let options = wgpu::RequestAdapterOptions {
        power_preference: PowerPreference::HighPerformance,
        force_fallback_adapter: false,
        compatible_surface: None,
        apply_limit_buckets: false,
    };
    pollster::block_on(Instance::new(descriptor).request_adapter(&options)).ok()
}
