//! Rendering with wgpu: multisampled pass of the bodies, camera, colour maps, offscreen images.
//!
//! The renderer borrows a [`Frame`] (positions, triangles, values), never the simulation. The window and offscreen
//! images use the same calls.

use std::sync::{Arc, Mutex, PoisonError};

use thiserror::Error;

use crate::image::PictureError;

mod adapter;
mod body;
mod camera;
pub mod colormap;
pub(crate) mod display_geometry;
pub(crate) mod interpolated_field;
mod offscreen;

pub use adapter::{AdapterReport, adapters};
pub(crate) use adapter::{AdapterSearch, Candidate, NO_WINDOW, instance, wanted_name};
pub use body::{BodyRenderer, Frame, View, Viewport};
pub use camera::{Camera, Margins};
pub use offscreen::read_texture;

/// Error of the renderer.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No adapter is usable.
    #[error(
        "no usable graphics adapter:{tried}\nInstall a Vulkan driver: on Debian and Ubuntu `scripts/setup`, or \
         `apt-get install mesa-vulkan-drivers`, gives one in software; elsewhere the driver of your GPU. `warpbeam gpu` \
         lists all adapters"
    )]
    NoAdapter {
        /// A line per adapter: name, backend, and the reason for which it is not usable.
        tried: String,
    },
    /// A device was lost, and a second one too.
    #[error(
        "the graphics device failed twice: {reason}.\nUpdate the driver of your GPU, or choose another adapter: \
         `warpbeam gpu` lists them, --adapter NAME chooses one"
    )]
    Lost {
        /// Reason of the last failure.
        reason: String,
    },
    /// The image is larger than the adapter can draw.
    #[error("a picture of {size:?} pixels is larger than the {limit} this adapter draws")]
    TooLarge {
        /// Requested size, pixels.
        size: [u32; 2],
        /// Largest side that the adapter supports, pixels.
        limit: u32,
    },
    /// The image could not be read back from the device.
    #[error("the picture did not come back from the graphics device: {0}")]
    ReadBack(String),
    /// The image could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl RenderError {
    /// Returns `true` if the machine has no usable graphics adapter, or its devices do not last.
    pub fn is_missing_adapter(&self) -> bool {
        matches!(self, Self::NoAdapter { .. } | Self::Lost { .. })
    }
}

/// Graphics device.
#[derive(Debug)]
pub struct Gpu {
    /// Adapter of the device.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Command queue of the device.
    pub queue: wgpu::Queue,
    /// First error of the device, or the reason of its loss.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    /// Takes over a device. Its errors and its loss are kept as [`Self::failure`].
    fn new(adapter: wgpu::Adapter, device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let failure = Arc::new(Mutex::new(None));
        let keep = |reason: String, failure: &Mutex<Option<String>>| {
            failure.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(reason);
        };
        let lost = failure.clone();
        device.set_device_lost_callback(move |reason, message| {
            let message = if message.is_empty() { format!("{reason:?}") } else { message };
            keep(format!("the device was lost ({message})"), &lost);
        });
        let errors = failure.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| keep(error.to_string(), &errors)));
        Self { adapter, device, queue, failure }
    }

    /// Creates a device without a window, on the best adapter that draws and whose name contains `name`; `None` stands
    /// for `WGPU_ADAPTER_NAME`. Not for web pages, which cannot wait for a device.
    pub fn headless(name: Option<&str>) -> Result<Self, RenderError> {
        let search = adapter::offscreen(name);
        pollster::block_on(search.first_usable(async |candidate| Self::usable(candidate.adapter).await))
    }

    /// Returns the first error of the device, or the reason of its loss. A device with a failure draws nothing, and
    /// waiting for it panics.
    pub fn failure(&self) -> Option<String> {
        self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Returns the largest width or height of a texture that the GPU supports, pixels.
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Returns the number of samples per pixel of the body's pass. Every WebGPU adapter supports four. Software
    /// rendering uses one: with four a frame takes three times as long, and the body's outline is smooth without them.
    pub fn samples(&self) -> u32 {
        if self.adapter.get_info().device_type == wgpu::DeviceType::Cpu { 1 } else { 4 }
    }

    /// Returns a description of the adapter, which marks software rendering.
    pub fn describe(&self) -> String {
        let wgpu::AdapterInfo { name, backend, device_type, .. } = self.adapter.get_info();
        match device_type {
            wgpu::DeviceType::Cpu => format!("software rendering ({name}, {backend})"),
            _ => format!("{name} ({backend})"),
        }
    }

    /// Creates a texture to draw into, which is sampled or copied from afterwards.
    pub(crate) fn target(
        &self,
        label: &str,
        format: wgpu::TextureFormat,
        size: [u32; 2],
        samples: u32,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: samples,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
            view_formats: &[],
        })
    }
}

/// Pixel format of all offscreen targets, as egui expects it for an image and PNG for a file.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
