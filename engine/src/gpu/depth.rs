//! Triangles drawn into an image of depths, nearest first; nothing else is drawn.

use super::{Gpu, GpuError};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Depths as the device holds them: rows of `pitch` floats; the larger one is the nearer, 0 where nothing was drawn.
#[derive(Debug)]
pub struct Depths {
    pub buffer: wgpu::Buffer,
    pub pitch: u32,
}

impl Gpu {
    /// Compiles the vertex shader `entry` for [`Gpu::draw_depths`].
    pub fn depth_pipeline(&self, label: &str, wgsl: &str, entry: &str) -> Result<wgpu::RenderPipeline, GpuError> {
        let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let pipeline = self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(label),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        match pollster::block_on(scope.pop()) {
            None => Ok(pipeline),
            Some(error) => Err(GpuError::Shader { label: label.into(), message: error.to_string() }),
        }
    }

    /// Draws `draws`, each a range of vertices and its instance's index, with the bindings 0, 1, … of group 0.
    pub fn draw_depths(
        &self,
        pipeline: &wgpu::RenderPipeline,
        buffers: &[&wgpu::Buffer],
        draws: &[(std::ops::Range<u32>, u32)],
        [columns, rows]: [u32; 2],
    ) -> Depths {
        let size = wgpu::Extent3d { width: columns, height: rows, depth_or_array_layers: 1 };
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("depths"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let bytes_per_row = (4 * columns).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = self.output("depths", u64::from(bytes_per_row) * u64::from(rows));
        let mut encoder = self.device.create_command_encoder(&Default::default());
        self.encode(&mut encoder, pipeline, buffers, draws, &texture.create_view(&Default::default()));
        let source = wgpu::TexelCopyTextureInfo {
            texture: &texture,
            mip_level: 0,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::DepthOnly,
        };
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(bytes_per_row), rows_per_image: None };
        encoder.copy_texture_to_buffer(source, wgpu::TexelCopyBufferInfo { buffer: &buffer, layout }, size);
        self.queue.submit([encoder.finish()]);
        Depths { buffer, pitch: bytes_per_row / 4 }
    }

    fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        buffers: &[&wgpu::Buffer],
        draws: &[(std::ops::Range<u32>, u32)],
        view: &wgpu::TextureView,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("depths"),
            color_attachments: &[],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        pass.set_pipeline(pipeline);
        let numbered: Vec<_> = (0..).zip(buffers.iter().copied()).collect();
        pass.set_bind_group(0, &self.bindings(&pipeline.get_bind_group_layout(0), &numbered), &[]);
        for (vertices, instance) in draws {
            pass.draw(vertices.clone(), *instance..instance + 1);
        }
    }
}
