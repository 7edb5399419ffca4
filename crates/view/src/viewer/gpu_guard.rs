//! Errors of the GPU, kept for the next frame.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use crate::Gpu;

/// Loss of the device, and errors that no call returned.
#[derive(Clone, Debug, Default)]
pub(crate) struct GpuGuard(Arc<GpuTrouble>);

#[derive(Debug, Default)]
struct GpuTrouble {
    is_lost: AtomicBool,
    errors: Mutex<Vec<String>>,
}

impl GpuGuard {
    /// Watches a device from now on; without that, its errors end the program.
    pub fn of(gpu: &Gpu, wake: &egui::Context) -> Self {
        let this = Self::default();
        let (lost, woken, is_lost) = (this.clone(), wake.clone(), gpu.loss());
        gpu.device.set_device_lost_callback(move |reason, _| {
            // The end of the program destroys the device as well.
            if reason != wgpu::DeviceLostReason::Destroyed {
                is_lost.store(true, Ordering::Relaxed);
                lost.0.is_lost.store(true, Ordering::Relaxed);
                woken.request_repaint();
            }
        });
        let (errors, woken) = (this.clone(), wake.clone());
        gpu.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let text = error.to_string();
            let line = text.lines().map(str::trim).find(|line| !line.is_empty());
            if let Ok(mut all) = errors.0.errors.lock() {
                all.push(line.unwrap_or("unknown").to_owned());
            }
            woken.request_repaint();
        }));
        this
    }

    pub fn is_lost(&self) -> bool {
        self.0.is_lost.load(Ordering::Relaxed)
    }

    /// Returns the errors since the last call.
    pub fn take_errors(&self) -> Vec<String> {
        self.0.errors.lock().map(|mut all| std::mem::take(&mut *all)).unwrap_or_default()
    }
}
