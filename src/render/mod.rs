//! Drawing with wgpu: the body's multisampled pass, the camera, the colour map, offscreen pictures.
//!
//! The renderer borrows a [`Frame`] (positions, triangles, a value a triangle), never the simulation. The window and the
//! offscreen picture go through the same calls.

use thiserror::Error;

use crate::picture::PictureError;

mod body;
mod camera;
pub mod colormap;
pub(crate) mod display_geometry;
mod offscreen;

pub use body::{BodyRenderer, Frame, View, Viewport};
pub use camera::{Camera, Margins};
pub use offscreen::read_texture;

/// Why nothing was drawn.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// No adapter would do.
    #[error(
        "no usable graphics adapter: {tried}.\nInstall a Vulkan driver: on Debian and Ubuntu `scripts/setup`, or \
         `apt-get install mesa-vulkan-drivers`, gives one in software; elsewhere the driver of your GPU"
    )]
    NoAdapter {
        /// What was tried and what each said.
        tried: String,
    },
    /// The adapter gave no device.
    #[error("the graphics adapter {adapter} gave no device: {reason}")]
    NoDevice {
        /// Its name.
        adapter: String,
        /// Its reason.
        reason: String,
    },
    /// A picture larger than the adapter can draw.
    #[error("a picture of {size:?} pixels is larger than the {limit} this adapter draws")]
    TooLarge {
        /// What was asked for.
        size: [u32; 2],
        /// Its largest side.
        limit: u32,
    },
    /// The picture did not come back from the device.
    #[error("the picture did not come back from the graphics device: {0}")]
    ReadBack(String),
    /// The picture was not written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl RenderError {
    /// Whether the machine has nothing to draw with.
    #[must_use]
    pub fn is_missing_adapter(&self) -> bool {
        matches!(self, Self::NoAdapter { .. } | Self::NoDevice { .. })
    }
}

/// A graphics device.
#[derive(Debug)]
pub struct Gpu {
    /// Its adapter.
    pub adapter: wgpu::Adapter,
    /// The device.
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
}

impl Gpu {
    /// A device without a window.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`], [`RenderError::NoDevice`].
    pub fn headless() -> Result<Self, RenderError> {
        Self::first_of_backends(|backends| {
            let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
            descriptor.backends = backends;
            Self::request(&wgpu::Instance::new(descriptor), None)
        })
    }

    /// Tries the system's own graphics interface, and OpenGL only where that gives nothing: asking OpenGL too costs
    /// time and prints its complaints. `WGPU_BACKEND` overrides both.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`] with all that was tried, or whatever else `attempt` fails with.
    pub fn first_of_backends<T>(
        mut attempt: impl FnMut(wgpu::Backends) -> Result<T, RenderError>,
    ) -> Result<T, RenderError> {
        let wanted = wgpu::Backends::from_env().map_or_else(
            || vec![wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12, wgpu::Backends::GL],
            |backends| vec![backends],
        );
        let mut tried = Vec::new();
        for backends in wanted {
            match attempt(backends) {
                Err(RenderError::NoAdapter { tried: reason }) => tried.push(reason),
                other => return other,
            }
        }
        Err(RenderError::NoAdapter { tried: tried.join("; then ") })
    }

    /// The best adapter for a surface: hardware before software.
    ///
    /// # Errors
    /// [`RenderError::NoAdapter`], [`RenderError::NoDevice`].
    pub fn request(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, RenderError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| RenderError::NoAdapter { tried: error.to_string() })?;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("warpbeam"),
            // Enough for a software GL; the texture size is whatever the adapter has.
            required_limits: wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits()),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| RenderError::NoDevice { adapter: adapter.get_info().name, reason: error.to_string() })?;
        Ok(Self { adapter, device, queue })
    }

    /// Largest side of a texture, pixels.
    #[must_use]
    pub fn max_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// Samples a pixel of the body's pass: four are what every WebGPU adapter has. A processor that draws takes one: four
    /// take it three times as long a frame, and the body's outline is smooth without.
    #[must_use]
    pub fn samples(&self) -> u32 {
        if self.adapter.get_info().device_type == wgpu::DeviceType::Cpu { 1 } else { 4 }
    }

    /// The adapter in words; software is named as such.
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

    /// A texture to draw into, sampled or copied from afterwards.
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

/// The format of every offscreen target: what egui wants of an image, and PNG of a file.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
