//! A headless device that runs compute shaders: buffers, pipelines, dispatches, readback, timestamps; and draws depths.
//!
//! Knows no physics. A shader's buffers are bindings 0, 1, 2, … of group 0, in the order given to [`Gpu::run`];
//! counts and constants reach it as `override` values.
//!
//! Any Vulkan, Metal or DirectX 12 adapter does, the software ones too. On Debian and Ubuntu the package
//! `mesa-vulkan-drivers` brings a software adapter (lavapipe).

mod depth;
mod pages;

use std::sync::{Arc, Mutex, PoisonError};

use bytemuck::Pod;
use wgpu::util::DeviceExt;

pub use depth::Depths;

/// What can go wrong between the program and its device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error("no {wanted} adapter for Vulkan, Metal or DirectX 12 found ({found}); {}", remedy(wanted))]
    NoAdapter { wanted: &'static str, found: String },
    #[error("adapter {adapter} gives no device")]
    NoDevice { adapter: String, source: wgpu::RequestDeviceError },
    #[error("shader {label} does not compile: {message}")]
    Shader { label: String, message: String },
    #[error("reading buffer {label} back failed: {message}")]
    Read { label: String, message: String },
    #[error(
        "{what} take {needed_mib} MiB, the adapter allows {allowed_mib} MiB; \
         use a coarser posting, a smaller extent, or the reference renderer"
    )]
    TooLarge { what: &'static str, needed_mib: u64, allowed_mib: u64 },
    #[error("{what}: the adapter ended the loops of a shader before they were done")]
    CutShort { what: &'static str },
}

/// Function `cut_short`, which every shader asks at its end whose loops may be long.
pub const CUT_SHORT_WGSL: &str = include_str!("gpu/cut_short.wgsl");

/// What `cut_short` counts to.
pub const CUT_SHORT_TURNS: u32 = 2;

/// Which adapter to open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Adapter {
    /// The fastest there is; a software adapter where there is no other.
    #[default]
    Auto,
    /// Hardware or nothing.
    Gpu,
    /// The software adapter, also where a GPU exists.
    Cpu,
}

/// An open device. Its clones share it, also between threads.
#[derive(Debug, Clone)]
pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    pub info: wgpu::AdapterInfo,
    timer: Option<Arc<Timer>>,
}

/// Two timestamps around a pass, and where they are resolved to.
#[derive(Debug)]
struct Timer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    seconds_per_tick: f64,
    /// Held from a pass to the reading of its timestamps: another thread's pass would write over them.
    busy: Mutex<()>,
}

impl Gpu {
    /// Opens a device with all the limits of its adapter.
    pub fn open(choice: Adapter) -> Result<Self, GpuError> {
        Self::open_within(choice, u64::MAX)
    }

    /// The same with bindings of at most `binding_bytes`: an adapter that allows less, for those who have none.
    pub fn open_within(choice: Adapter, binding_bytes: u64) -> Result<Self, GpuError> {
        let adapter = request_adapter(choice)?;
        let limits = adapter.limits();
        let binding_bytes = limits.max_storage_buffer_binding_size.min(binding_bytes);
        let info = adapter.get_info();
        let wanted = wgpu::Features::TIMESTAMP_QUERY | wgpu::Features::FLOAT32_FILTERABLE;
        let (device, queue) = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("perilune"),
            required_features: adapter.features() & wanted,
            required_limits: wgpu::Limits { max_storage_buffer_binding_size: binding_bytes, ..limits },
            ..Default::default()
        }))
        .map_err(|source| GpuError::NoDevice { adapter: info.name.clone(), source })?;
        let timer = Timer::new(&device, &queue).map(Arc::new);
        Ok(Self { device, queue, info, timer })
    }

    /// The adapter on one line, for manifests and reports.
    pub fn describe(&self) -> String {
        let wgpu::AdapterInfo { name, driver_info, backend, device_type, .. } = &self.info;
        format!("{name} ({device_type:?}, {backend:?}, {driver_info})")
    }

    /// Whether the adapter is a program on the processor.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// A read-only storage buffer filled with `values`. An empty slice makes a buffer of zeros.
    pub fn storage<T: Pod>(&self, label: &str, values: &[T]) -> wgpu::Buffer {
        self.filled(label, bytemuck::cast_slice(values), wgpu::BufferUsages::STORAGE)
    }

    /// A uniform buffer that holds `value`.
    pub fn uniform<T: Pod>(&self, label: &str, value: &T) -> wgpu::Buffer {
        self.filled(label, bytemuck::bytes_of(value), wgpu::BufferUsages::UNIFORM)
    }

    /// A storage buffer of `bytes` zeros that shaders write and [`Gpu::read`] reads.
    pub fn output(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).max(MIN_BYTES as u64),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    }

    fn filled(&self, label: &str, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let zeros = [0; MIN_BYTES];
        let contents = if bytes.len() < MIN_BYTES { &[bytes, &zeros[bytes.len()..]].concat() } else { bytes };
        let usage = usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage })
    }

    /// What the device has written to `buffer`; waits until all that was submitted is done.
    pub fn read<T: Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>, GpuError> {
        let staging = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &staging, 0, buffer.size());
        self.queue.submit([encoder.finish()]);

        let failed = |message: String| GpuError::Read { label: format!("{buffer:?}"), message };
        let (sender, receiver) = std::sync::mpsc::channel();
        staging.map_async(wgpu::MapMode::Read, .., move |outcome| drop(sender.send(outcome)));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|error| failed(error.to_string()))?;
        match receiver.recv() {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(failed(error.to_string())),
            Err(error) => return Err(failed(error.to_string())),
        }
        let view = staging.get_mapped_range(..).map_err(|error| failed(error.to_string()))?;
        let whole = view.len() - view.len() % size_of::<T>().max(1);
        Ok(bytemuck::pod_collect_to_vec(&view[..whole]))
    }

    /// Compiles the entry point `entry` of a shader, with its `override` values by name.
    pub fn compute(
        &self,
        label: &str,
        wgsl: &str,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: None,
            module: &module,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(pipeline),
            Some(error) => Err(GpuError::Shader { label: label.into(), message: error.to_string() }),
        }
    }

    /// Runs `groups` workgroups (at most 65535 along each axis) of a pipeline on `buffers`, which are the bindings
    /// 0, 1, … of group 0 that the entry point uses. Returns the seconds the device took, and waits for it, where
    /// the device can tell them.
    pub fn run(&self, pipeline: &wgpu::ComputePipeline, buffers: &[&wgpu::Buffer], groups: [u32; 3]) -> Option<f64> {
        let numbered: Vec<_> = (0..).zip(buffers.iter().copied()).collect();
        self.run_bound(pipeline, &numbered, groups)
    }

    /// [`Gpu::run`] with buffers by the numbers of their bindings: all that the entry point uses and no others.
    pub fn run_bound(
        &self,
        pipeline: &wgpu::ComputePipeline,
        buffers: &[(u32, &wgpu::Buffer)],
        groups: [u32; 3],
    ) -> Option<f64> {
        let bind_group = self.bindings(&pipeline.get_bind_group_layout(0), buffers);
        let timer = self.timer.as_deref();
        let _busy = timer.map(|timer| timer.busy.lock().unwrap_or_else(PoisonError::into_inner));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: None,
                timestamp_writes: timer.map(Timer::writes),
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bind_group, &[]);
            pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
        }
        if let Some(timer) = timer {
            encoder.resolve_query_set(&timer.queries, 0..2, &timer.resolved, 0);
        }
        self.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = self.read(&timer?.resolved).ok()?;
        Some(ticks[1].saturating_sub(ticks[0]) as f64 * timer?.seconds_per_tick)
    }

    fn bindings(&self, layout: &wgpu::BindGroupLayout, buffers: &[(u32, &wgpu::Buffer)]) -> wgpu::BindGroup {
        let entries: Vec<_> = buffers
            .iter()
            .map(|&(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }
}

/// So many workgroups or a few more, as [`Gpu::run`] takes them: a dimension holds at most 65535.
pub fn workgroups(count: usize) -> [u32; 3] {
    let across = count.min(1 << 15);
    [across as u32, count.div_ceil(across) as u32, 1]
}

/// Bindings may not be smaller than the type a shader gives them; a vec4 is the largest plain one.
const MIN_BYTES: usize = 16;

impl Timer {
    fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timestamps"),
                ty: wgpu::QueryType::Timestamp,
                count: 2,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timestamps"),
                size: 2 * size_of::<u64>() as u64,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            seconds_per_tick: f64::from(queue.get_timestamp_period()) * 1e-9,
            busy: Mutex::new(()),
        })
    }

    fn writes(&self) -> wgpu::ComputePassTimestampWrites<'_> {
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(0),
            end_of_pass_write_index: Some(1),
        }
    }
}

/// What [`Adapter::Gpu`] asks for.
const HARDWARE: &str = "hardware graphics";

fn request_adapter(choice: Adapter) -> Result<wgpu::Adapter, GpuError> {
    let wanted = match choice {
        Adapter::Auto => "graphics",
        Adapter::Gpu => HARDWARE,
        Adapter::Cpu => "software graphics",
    };
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::PRIMARY;
    let instance = wgpu::Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        force_fallback_adapter: choice == Adapter::Cpu,
        ..Default::default()
    }))
    .map_err(|_| GpuError::NoAdapter { wanted, found: "found none".into() })?;
    let info = adapter.get_info();
    if choice == Adapter::Gpu && info.device_type == wgpu::DeviceType::Cpu {
        return Err(GpuError::NoAdapter { wanted, found: format!("found only {}", info.name) });
    }
    Ok(adapter)
}

/// Software is no remedy for who asks for hardware.
fn remedy(wanted: &str) -> &'static str {
    match wanted {
        HARDWARE => "the driver of the graphics card brings one; without a card render with software, or on the CPU",
        _ => "on Debian or Ubuntu `apt-get install mesa-vulkan-drivers` brings one in software",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOUBLE: &str = "
        override FACTOR: f32 = 1.0;
        @group(0) @binding(0) var<storage, read> given: array<f32>;
        @group(0) @binding(1) var<storage, read_write> made: array<f32>;
        @compute @workgroup_size(4) fn main(@builtin(global_invocation_id) id: vec3u) {
            if id.x < arrayLength(&given) { made[id.x] = FACTOR * given[id.x]; }
        }";

    /// `None` where this machine has no adapter; the conformance tests say when that is a failure.
    fn gpu() -> Option<Gpu> {
        Gpu::open(Adapter::Auto).inspect_err(|error| println!("skipped: {error}")).ok()
    }

    #[test]
    fn a_shader_scales_a_buffer_by_its_override() {
        let Some(gpu) = gpu() else { return };
        let pipeline = gpu.compute("double", DOUBLE, "main", &[("FACTOR", 2.5)]).unwrap();
        let given: Vec<f32> = (0..1000).map(|i| i as f32).collect();
        let (input, made) = (gpu.storage("given", &given), gpu.output("made", 4 * given.len() as u64));
        let seconds = gpu.run(&pipeline, &[&input, &made], [250, 1, 1]);
        let expected: Vec<f32> = given.iter().map(|x| 2.5 * x).collect();
        assert_eq!(gpu.read::<f32>(&made).unwrap(), expected);
        assert!(seconds.is_none_or(|s| s > 0.0 && s < 10.0), "{seconds:?}");
    }

    #[test]
    fn a_shader_with_an_error_is_reported_with_its_label() {
        let Some(gpu) = gpu() else { return };
        let broken = DOUBLE.replace("FACTOR *", "FACTORS *");
        let error = gpu.compute("double", &broken, "main", &[]).unwrap_err().to_string();
        assert!(error.starts_with("shader double does not compile") && error.contains("FACTORS"), "{error}");
    }

    #[test]
    fn a_missing_adapter_names_the_package_that_brings_one() {
        let error = GpuError::NoAdapter { wanted: "graphics", found: "found none".into() };
        assert!(error.to_string().contains("mesa-vulkan-drivers"), "{error}");
        let error = GpuError::NoAdapter { wanted: HARDWARE, found: "found none".into() };
        assert!(!error.to_string().contains("mesa"), "{error}");
    }
}
