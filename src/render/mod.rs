//! Rendering with wgpu: multisampled pass of the bodies, camera, colour maps, offscreen images.
//!
//! The renderer borrows a [`Frame`] (positions, triangles, values), never the simulation. The window and offscreen
//! images use the same calls.

use thiserror::Error;

use crate::image::PictureError;

mod body;
mod camera;
pub mod colormap;
pub(crate) mod display_geometry;
mod offscreen;

pub use body::{BodyRenderer, Frame, View, Viewport};
pub use camera::{Camera, Margins};
pub use offscreen::read_texture;
pub(crate) use offscreen::to_rgba;

/// Error of the renderer.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No adapter is usable.
    #[error(
        "no usable graphics adapter: {tried}.\nInstall a Vulkan driver: on Debian and Ubuntu `scripts/setup`, or \
         `apt-get install mesa-vulkan-drivers`, gives one in software; elsewhere the driver of your GPU"
    )]
    NoAdapter {
        /// Tried backends, and the error of each.
        tried: String,
    },
    /// The adapter returned no device.
    #[error("the graphics adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// Reason of the failure.
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
    /// Returns `true` if the machine has no usable graphics adapter or device.
    #[must_use]
    pub fn is_missing_adapter(&self) -> bool {
        matches!(self, Self::NoAdapter { .. } | Self::NoDevice { .. })
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
}

impl Gpu {
    /// Creates a device without a window. Not for web pages, which cannot wait for a device.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`], [`RenderError::NoDevice`].
    pub fn headless() -> Result<Self, RenderError> {
        pollster::block_on(Self::first_of_backends(async |backends| {
            let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
            descriptor.backends = backends;
            Self::request(&wgpu::Instance::new(descriptor), None).await
        }))
    }

    /// Tries the system's native graphics API first, and OpenGL only if that fails, because probing OpenGL takes time
    /// and prints warnings. `WGPU_BACKEND` overrides both.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`] with all backends tried, or any other error of `attempt`.
    pub async fn first_of_backends<T>(
        mut attempt: impl AsyncFnMut(wgpu::Backends) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let wanted = match wgpu::Backends::from_env() {
            Some(backends) => vec![backends],
            None => Self::backends().await,
        };
        let mut tried = Vec::new();
        for backends in wanted {
            match attempt(backends).await {
                Err(RenderError::NoAdapter { tried: reason }) => tried.push(reason),
                other => return other,
            }
        }
        Err(RenderError::NoAdapter { tried: tried.join("; then ") })
    }

    /// Returns the backends of this system in the order in which they are tried.
    #[cfg(not(target_arch = "wasm32"))]
    async fn backends() -> Vec<wgpu::Backends> {
        vec![wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12, wgpu::Backends::GL]
    }

    /// Returns the backend of this browser. There is only one, because a canvas keeps its first kind of context.
    #[cfg(target_arch = "wasm32")]
    async fn backends() -> Vec<wgpu::Backends> {
        let has_webgpu = wgpu::util::is_browser_webgpu_supported().await;
        vec![if has_webgpu { wgpu::Backends::BROWSER_WEBGPU } else { wgpu::Backends::GL }]
    }

    /// Creates a device on the best adapter for a surface: hardware is preferred to software.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`], [`RenderError::NoDevice`].
    pub async fn request(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, RenderError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await;
        let adapter = adapter.map_err(|error| RenderError::NoAdapter { tried: error.to_string() })?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("warpbeam"),
            // Limits that software OpenGL also supports, except for the texture size, which is the adapter's.
            required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
            ..Default::default()
        };
        let (device, queue) = adapter
            .request_device(&descriptor)
            .await
            .map_err(|error| RenderError::NoDevice { adapter: adapter.get_info().name, reason: error.to_string() })?;
        Ok(Self { adapter, device, queue })
    }

    /// Returns the largest width or height of a texture that the GPU supports, pixels.
    #[must_use]
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Returns the number of samples per pixel of the body's pass. Every WebGPU adapter supports four. Software
    /// rendering uses one: with four a frame takes three times as long, and the body's outline is smooth without them.
    #[must_use]
    pub fn samples(&self) -> u32 {
        if self.adapter.get_info().device_type == wgpu::DeviceType::Cpu { 1 } else { 4 }
    }

    /// Returns a description of the adapter, which marks software rendering.
    #[must_use]
    pub fn describe(&self) -> String {
        let info = self.adapter.get_info();
        match info.device_type {
            wgpu::DeviceType::Cpu => {
                format!("software rendering ({}, {})", info.name, info.backend)
            }
            _ => format!("{} ({})", info.name, info.backend),
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
