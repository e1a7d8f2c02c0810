//! Brings textures and buffers back to the processor.

use super::{Gpu, GpuError, Texture};

/// All bytes of a buffer that has `COPY_SRC`.
pub fn buffer(gpu: &Gpu, source: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let staging = staging_buffer(gpu, source.size());
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(source, 0, &staging, 0, source.size());
    gpu.queue.submit([encoder.finish()]);
    map(gpu, &staging)
}

/// The texels of level 0, rows packed without gaps.
pub fn texture(gpu: &Gpu, source: &Texture) -> Result<Vec<u8>, GpuError> {
    let texture = &source.texture;
    let size = texture.size();
    let texel = texture.format().block_copy_size(None).unwrap_or(4);
    let row = size.width * texel;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let rows = u64::from(size.height) * u64::from(size.depth_or_array_layers);
    let staging = staging_buffer(gpu, u64::from(padded_row) * rows);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded_row), rows_per_image: Some(size.height) };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &staging, layout },
        size,
    );
    gpu.queue.submit([encoder.finish()]);
    let padded = map(gpu, &staging)?;
    Ok(padded.chunks_exact(padded_row as usize).flat_map(|padded| padded[..row as usize].iter().copied()).collect())
}

/// The texels of a four-channel float or half texture.
pub fn rgba(gpu: &Gpu, source: &Texture) -> Result<Vec<[f32; 4]>, GpuError> {
    let bytes = texture(gpu, source)?;
    Ok(match source.texture.format() {
        wgpu::TextureFormat::Rgba16Float => bytes
            .chunks_exact(8)
            .map(|texel| [0, 2, 4, 6].map(|at| half::f16::from_le_bytes([texel[at], texel[at + 1]]).to_f32()))
            .collect(),
        _ => bytes
            .chunks_exact(16)
            .map(|texel| {
                [0, 4, 8, 12].map(|at| f32::from_le_bytes([texel[at], texel[at + 1], texel[at + 2], texel[at + 3]]))
            })
            .collect(),
    })
}

/// The texels of a one-channel float texture.
pub fn scalars(gpu: &Gpu, source: &Texture) -> Result<Vec<f32>, GpuError> {
    let bytes = texture(gpu, source)?;
    Ok(bytes.chunks_exact(4).map(|texel| f32::from_le_bytes([texel[0], texel[1], texel[2], texel[3]])).collect())
}

fn staging_buffer(gpu: &Gpu, size: u64) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn map(gpu: &Gpu, staging: &wgpu::Buffer) -> Result<Vec<u8>, GpuError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    let slice = staging.slice(..);
    slice.map_async(wgpu::MapMode::Read, move |result| {
        sender.send(result).ok();
    });
    gpu.wait()?;
    match receiver.recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(GpuError::Device(error.to_string())),
        Err(_) => return Err(GpuError::Device("the readback never finished".to_owned())),
    }
    let bytes = slice.get_mapped_range().map_err(|error| GpuError::Device(error.to_string()))?.to_vec();
    staging.unmap();
    Ok(bytes)
}
