//! Choice of the graphics adapter: the best one with a device that makes the pipelines of the body. A driver may offer an
//! adapter whose device cannot compile a shader.

use std::fmt;

use super::body::BodyRenderer;
use super::{FORMAT, Gpu, RenderError};

/// Environment variable with the names of the backends to be used.
const BACKEND: &str = "WGPU_BACKEND";
/// Environment variable with a part of the name of the adapter to be used.
const NAME: &str = "WGPU_ADAPTER_NAME";

/// Reason for which an adapter is not usable for a window.
pub(crate) const NO_WINDOW: &str = "it cannot draw into this window";

/// Graphics adapter of this machine, as [`adapters`] lists it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct AdapterReport {
    /// Name of the adapter.
    pub name: String,
    /// Name of the graphics API.
    pub backend: String,
    /// Name and version of the driver; empty if the driver does not state them.
    pub driver: String,
    /// `true` if the adapter draws on the processor.
    pub is_software: bool,
    /// Reason for which the adapter is not usable; `None` if it is usable.
    pub failure: Option<String>,
    /// `true` if this adapter is used.
    pub is_used: bool,
}

/// Adapter that was found, with the instance that found it.
pub(crate) struct Candidate {
    pub instance: wgpu::Instance,
    pub adapter: wgpu::Adapter,
    /// Surface of the window; `None` if there is no window.
    pub surface: Option<wgpu::Surface<'static>>,
}

impl Candidate {
    /// Returns the order in which the adapters of the same backends are tried.
    fn rank(&self) -> (u8, u8) {
        use wgpu::{Backend, DeviceType};
        let info = self.adapter.get_info();
        let kind = match info.device_type {
            DeviceType::DiscreteGpu => 0,
            DeviceType::IntegratedGpu => 1,
            DeviceType::Other => 2,
            DeviceType::VirtualGpu => 3,
            DeviceType::Cpu => 4,
        };
        let backend = match info.backend {
            Backend::Vulkan => 0,
            Backend::Metal => 1,
            Backend::Dx12 => 2,
            _ => 3,
        };
        (kind, backend)
    }

    fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }
}

/// Surface of the window, `None` if there is no window, or the reason for which there is no surface.
type FoundSurface = Result<Option<wgpu::Surface<'static>>, wgpu::CreateSurfaceError>;

/// Source of the instances and surfaces with which adapters are searched.
pub(crate) struct AdapterSearch<I, S> {
    /// Part of the name of the adapter to be used.
    pub name: Option<String>,
    /// Creates an instance with these backends.
    pub instance: I,
    /// Creates the surface of the window; returns `None` if there is no window.
    pub surface: S,
}

/// Adds the failure of an adapter to the text of a search, in a line.
fn add_failure(failures: &mut String, adapter: impl fmt::Display, reason: &str) {
    let reason = reason.split_whitespace().collect::<Vec<_>>().join(" ");
    *failures += &format!("\n  {adapter}: {reason}");
}

impl<I, S> AdapterSearch<I, S>
where
    I: Fn(wgpu::Backends) -> wgpu::Instance,
    S: Fn(&wgpu::Instance) -> FoundSurface,
{
    /// Returns the result of `open` for the first adapter for which it does not fail. Adapters of hardware are tried
    /// before those in software, and the system's native graphics API before OpenGL, whose search takes time and may
    /// print warnings. `WGPU_BACKEND` restricts the backends.
    pub(crate) async fn first_usable<T>(
        &self,
        mut open: impl AsyncFnMut(Candidate) -> Result<T, String>,
    ) -> Result<T, RenderError> {
        let mut failures = String::new();
        let mut software = Vec::new();
        let groups = backends().await;
        if groups.is_empty() {
            add_failure(&mut failures, BACKEND, "expected vulkan, metal, dx12 or gl, if the system has it");
        }
        for backends in groups {
            let found = self.find(backends).await;
            if found.is_empty() {
                // The names are those in `WGPU_BACKEND`.
                let names: Vec<_> = backends.iter_names().map(|(name, _)| name.to_lowercase()).collect();
                add_failure(&mut failures, names.join(", "), "no adapter found");
            }
            let (slow, fast): (Vec<_>, Vec<_>) = found.into_iter().partition(Candidate::is_software);
            software.extend(slow);
            if let Some(opened) = self.first_of(fast, &mut open, &mut failures).await {
                return Ok(opened);
            }
        }
        let opened = self.first_of(software, &mut open, &mut failures).await;
        opened.ok_or(RenderError::NoAdapter { tried: failures })
    }

    /// Returns the result of `open` for the first of these adapters for which it does not fail.
    async fn first_of<T>(
        &self,
        candidates: Vec<Candidate>,
        open: &mut impl AsyncFnMut(Candidate) -> Result<T, String>,
        failures: &mut String,
    ) -> Option<T> {
        for mut candidate in candidates {
            let wgpu::AdapterInfo { name, backend, .. } = candidate.adapter.get_info();
            let opened = match self.prepare(&mut candidate) {
                Ok(()) => open(candidate).await,
                Err(reason) => Err(reason),
            };
            match opened {
                Ok(opened) => return Some(opened),
                Err(reason) => add_failure(failures, format_args!("{name}, {backend}"), &reason),
            }
        }
        None
    }

    /// Checks the adapter's name, and provides the surface that the adapter has to support.
    fn prepare(&self, candidate: &mut Candidate) -> Result<(), String> {
        self.check_name(&candidate.adapter.get_info().name)?;
        if candidate.surface.is_none() {
            let surface = (self.surface)(&candidate.instance);
            candidate.surface = surface.map_err(|error| format!("no surface for the window: {error}"))?;
        }
        match &candidate.surface {
            Some(surface) if !candidate.adapter.is_surface_supported(surface) => Err(NO_WINDOW.to_owned()),
            _ => Ok(()),
        }
    }

    /// Returns an error unless the name of an adapter contains the wanted one.
    fn check_name(&self, name: &str) -> Result<(), String> {
        match &self.name {
            Some(wanted) if !name.to_lowercase().contains(&wanted.to_lowercase()) => {
                Err(format!("its name does not contain \"{wanted}\""))
            }
            _ => Ok(()),
        }
    }

    /// Returns the adapters of these backends in the order in which they are tried.
    async fn find(&self, backends: wgpu::Backends) -> Vec<Candidate> {
        let instance = (self.instance)(backends);
        let mut found = self.enumerate(instance, backends).await;
        found.sort_by_key(Candidate::rank);
        found
    }

    #[cfg(not(target_arch = "wasm32"))]
    async fn enumerate(&self, instance: wgpu::Instance, backends: wgpu::Backends) -> Vec<Candidate> {
        let adapters = instance.enumerate_adapters(backends).await;
        adapters.into_iter().map(|adapter| Candidate { instance: instance.clone(), adapter, surface: None }).collect()
    }

    /// Returns the only adapter of a page. WebGL provides it for the surface of the canvas alone.
    #[cfg(target_arch = "wasm32")]
    async fn enumerate(&self, instance: wgpu::Instance, _: wgpu::Backends) -> Vec<Candidate> {
        let surface = (self.surface)(&instance).unwrap_or_default();
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface.as_ref(),
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await.ok();
        adapter.map(|adapter| Candidate { instance, adapter, surface }).into_iter().collect()
    }
}

/// Returns the part of the name of the adapter to be used: `name`, or that of the environment.
pub(crate) fn wanted_name(name: Option<&str>) -> Option<String> {
    name.map(str::to_owned).or_else(|| std::env::var(NAME).ok()).filter(|name| !name.trim().is_empty())
}

/// Creates an instance with these backends.
pub(crate) fn instance(mut descriptor: wgpu::InstanceDescriptor, backends: wgpu::Backends) -> wgpu::Instance {
    descriptor.backends = backends;
    // No call here is indirect. wgpu would compile shaders for the validation of such calls, and log an error where the
    // driver cannot compile them.
    descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
    wgpu::Instance::new(descriptor)
}

/// Returns a search without a window.
pub(crate) fn offscreen(
    name: Option<&str>,
) -> AdapterSearch<impl Fn(wgpu::Backends) -> wgpu::Instance, impl Fn(&wgpu::Instance) -> FoundSurface> {
    let instance = |backends| instance(wgpu::InstanceDescriptor::new_without_display_handle_from_env(), backends);
    AdapterSearch { name: wanted_name(name), instance, surface: |_: &wgpu::Instance| Ok(None) }
}

/// Returns the adapters of this machine in the order in which they are tried for an image without a window. `name` is a part of the name of the adapter to be used; `None` stands for
/// `WGPU_ADAPTER_NAME`. Not for web pages, which cannot wait for a device.
pub fn adapters(name: Option<&str>) -> Vec<AdapterReport> {
    let search = offscreen(name);
    pollster::block_on(async {
        let mut found = Vec::new();
        for backends in backends().await {
            found.extend(search.find(backends).await);
        }
        found.sort_by_key(Candidate::is_software);
        let mut reports: Vec<AdapterReport> = Vec::new();
        for candidate in found {
            let info = candidate.adapter.get_info();
            let is_used = search.check_name(&info.name).is_ok() && reports.iter().all(|report| !report.is_used);
            let failure = Gpu::usable(candidate.adapter).await.err();
            reports.push(AdapterReport {
                driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
                backend: info.backend.to_string(),
                is_software: info.device_type == wgpu::DeviceType::Cpu,
                is_used: is_used && failure.is_none(),
                name: info.name,
                failure,
            });
        }
        reports
    })
}

/// Returns the groups of backends in the order in which they are tried.
#[cfg(not(target_arch = "wasm32"))]
async fn backends() -> Vec<wgpu::Backends> {
    let allowed = wgpu::Backends::from_env().unwrap_or(wgpu::Backends::all());
    let native = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let groups = [native, wgpu::Backends::GL].map(|group| group & allowed & wgpu::Instance::enabled_backend_features());
    groups.into_iter().filter(|group| !group.is_empty()).collect()
}

/// Returns the backend of this browser. There is only one, because a canvas keeps its first kind of context.
#[cfg(target_arch = "wasm32")]
async fn backends() -> Vec<wgpu::Backends> {
    let has_webgpu = wgpu::util::is_browser_webgpu_supported().await;
    vec![if has_webgpu { wgpu::Backends::BROWSER_WEBGPU } else { wgpu::Backends::GL }]
}

impl Gpu {
    /// Creates a device on this adapter, and tries the pipelines of the body with it.
    pub(crate) async fn usable(adapter: wgpu::Adapter) -> Result<Self, String> {
        let limits = Self::limits(&adapter);
        let gpu = Self::connect(adapter, limits).await?;
        gpu.pipelines(FORMAT).await?;
        Ok(gpu)
    }

    /// Returns limits that software OpenGL also supports, except for the sizes of textures and buffers, which are the
    /// adapter's.
    fn limits(adapter: &wgpu::Adapter) -> wgpu::Limits {
        let own = adapter.limits();
        let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(own.clone());
        wgpu::Limits { max_buffer_size: own.max_buffer_size, ..limits }
    }

    /// Creates a device with these limits.
    async fn connect(adapter: wgpu::Adapter, limits: wgpu::Limits) -> Result<Self, String> {
        let descriptor =
            wgpu::DeviceDescriptor { label: Some("warpbeam"), required_limits: limits, ..Default::default() };
        let requested = adapter.request_device(&descriptor).await;
        let (device, queue) = requested.map_err(|error| format!("no device: {error}"))?;
        Ok(Self::new(adapter, device, queue))
    }

    /// Creates the pipelines of the body for targets of this format.
    async fn pipelines(&self, format: wgpu::TextureFormat) -> Result<BodyRenderer, String> {
        let made = self.without_error(|| BodyRenderer::new(self, format)).await;
        made.map_err(|reason| format!("no pipeline: {reason}"))
    }

    /// Returns the result of `make`, or the first error of the device in it.
    pub(crate) async fn without_error<T>(&self, make: impl FnOnce() -> T) -> Result<T, String> {
        use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
        let scopes = [Validation, OutOfMemory, Internal].map(|filter| self.device.push_error_scope(filter));
        let made = make();
        let mut failure = self.failure();
        // Scopes end in reverse order.
        let ended: Vec<_> = scopes.into_iter().rev().map(wgpu::ErrorScopeGuard::pop).collect();
        for error in ended {
            let error = error.await;
            failure = failure.or(error.map(|error| error.to_string()));
        }
        failure.map_or(Ok(made), Err)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stage at which an adapter fails.
    #[derive(Clone, Copy, Debug)]
    enum Fault {
        Device,
        Pipeline,
    }

    /// Opens an adapter, in which the device refuses this stage.
    async fn faulty(adapter: wgpu::Adapter, fault: Fault) -> Result<Gpu, String> {
        let mut limits = Gpu::limits(&adapter);
        if matches!(fault, Fault::Device) {
            limits.max_bind_groups = u32::MAX;
        }
        let gpu = Gpu::connect(adapter, limits).await?;
        // A compressed texture cannot be drawn into.
        let format = if matches!(fault, Fault::Pipeline) { wgpu::TextureFormat::Bc1RgbaUnorm } else { FORMAT };
        gpu.pipelines(format).await?;
        Ok(gpu)
    }

    /// Returns the beginning of the line of an adapter that has failed.
    fn line(info: &wgpu::AdapterInfo, reason: &str) -> String {
        format!("\n  {}, {}: {reason}", info.name, info.backend)
    }

    #[test]
    fn an_adapter_that_fails_at_any_stage_is_skipped() {
        for (fault, stage) in [(Fault::Device, "no device"), (Fault::Pipeline, "no pipeline")] {
            let search = offscreen(None);
            let mut failures = String::new();
            let mut opened = Vec::new();
            let gpu = pollster::block_on(async {
                // A machine may have a single adapter, which then is found twice.
                let mut found = Vec::new();
                for group in [backends().await, backends().await].concat() {
                    found.extend(search.find(group).await);
                }
                let mut open = async |candidate: Candidate| {
                    opened.push(candidate.adapter.get_info());
                    match opened.len() {
                        1 => faulty(candidate.adapter, fault).await,
                        _ => Gpu::usable(candidate.adapter).await,
                    }
                };
                search.first_of(found, &mut open, &mut failures).await
            });
            assert_eq!(opened.len(), 2, "{fault:?}: {failures}");
            assert_eq!(gpu.map(|gpu| gpu.adapter.get_info()).as_ref(), Some(&opened[1]), "{fault:?}");
            assert!(failures.starts_with(&line(&opened[0], stage)), "{fault:?}: {failures}");
            assert_eq!(failures.lines().count(), 2, "{failures}");
        }
    }

    #[test]
    fn without_a_usable_adapter_the_error_has_a_line_per_adapter() {
        for fault in [Fault::Device, Fault::Pipeline] {
            let mut opened = Vec::new();
            let search = offscreen(None);
            let result = pollster::block_on(search.first_usable(async |candidate: Candidate| {
                opened.push(candidate.adapter.get_info());
                faulty(candidate.adapter, fault).await
            }));
            let text = result.err().unwrap().to_string();
            for adapter in &opened {
                assert!(text.contains(&line(adapter, "no ")), "{fault:?}: {text}");
            }
            assert!(text.contains("Install a Vulkan driver"), "{text}");
        }
    }

    #[test]
    fn software_is_tried_last_and_a_name_restricts_the_choice() {
        let reports = adapters(None);
        assert!(reports.iter().any(|report| report.failure.is_none()), "{reports:?}");
        assert!(reports.is_sorted_by_key(|report| report.is_software), "{reports:?}");
        assert_eq!(reports.iter().position(|r| r.is_used), reports.iter().position(|r| r.failure.is_none()));
        let last = reports.last().unwrap();
        let part = last.name[..last.name.len() / 2].to_uppercase();
        let chosen = adapters(Some(&part)).into_iter().find(|report| report.is_used).unwrap();
        assert!(chosen.name.to_uppercase().contains(&part), "{chosen:?}");
        assert_eq!(Gpu::headless(Some(&part)).unwrap().adapter.get_info().name, chosen.name);
        let none = "no such adapter";
        assert!(adapters(Some(none)).iter().all(|report| !report.is_used));
        let text = Gpu::headless(Some(none)).unwrap_err().to_string();
        assert!(text.contains("its name does not contain \"no such adapter\""), "{text}");
    }
}
