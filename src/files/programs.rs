//! Compiled programs on the disk between runs, where the driver gives them away (Vulkan's pipeline cache).
//!
//! A file holds the data of one driver behind a SHA-256 of that driver's name and version and of the data: what is damaged,
//! cut off or another driver's never reaches a driver. A file that cannot be read or written costs time and nothing else, so
//! nobody is told.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::cache_folder;
use crate::export::ExportError;
use crate::export::atomic::write_atomically;
use crate::gpu::Gpu;
use crate::images::sha256_hex;

/// Drivers keep a few megabytes; a larger file is something else, or has grown for years.
const MOST_BYTES: u64 = 64 << 20;
/// Hexadecimal digits of a sum.
const SUM_BYTES: usize = 64;

/// The file of one driver's programs.
#[derive(Debug)]
pub struct KeptPrograms {
    path: PathBuf,
    driver: String,
    /// How much the driver gave away at the beginning; more of it is worth writing.
    begun_with: usize,
}

impl KeptPrograms {
    /// Gives the driver what an earlier run has kept; `None` where it keeps nothing. To be called before programs are
    /// compiled.
    pub fn begin(gpu: &Gpu) -> Option<Self> {
        Self::begin_in(&cache_folder().join("programs"), gpu)
    }

    /// The same in a folder.
    pub fn begin_in(folder: &Path, gpu: &Gpu) -> Option<Self> {
        let identity = wgpu::util::pipeline_cache_key(&gpu.info)?;
        let driver = format!("{} {identity} {}", env!("CARGO_PKG_VERSION"), gpu.description());
        let path = folder.join(&sha256_hex(driver.as_bytes())[..16]);
        let small = std::fs::metadata(&path).is_ok_and(|about| about.is_file() && about.len() <= MOST_BYTES);
        let file = small.then(|| std::fs::read(&path).ok()).flatten();
        let data = file.as_deref().and_then(|file| data_of(file, &driver));
        if !gpu.begin_pipeline_cache(data) {
            return None;
        }
        let begun_with = gpu.pipeline_data()?.len();
        Some(Self { path, driver, begun_with })
    }

    /// Where they are kept: a file of its own for each driver and each version of the program.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes what the driver has compiled since, if it gives any of it away; true if it did.
    pub fn keep(&mut self, gpu: &Gpu) -> bool {
        let Some(data) = gpu.pipeline_data() else { return false };
        if data.len() <= self.begun_with {
            return false;
        }
        let folder_exists = self.path.parent().is_some_and(|folder| std::fs::create_dir_all(folder).is_ok());
        let failed = |error| ExportError::writing(&self.path, error);
        let is_written = folder_exists
            && write_atomically(&self.path, |writer| {
                writer.write_all(sum_of(&data, &self.driver).as_bytes()).map_err(failed)?;
                writer.write_all(&data).map_err(failed)
            })
            .is_ok();
        self.begun_with = data.len();
        is_written
    }
}

fn sum_of(data: &[u8], driver: &str) -> String {
    sha256_hex(&[driver.as_bytes(), b"\0", data].concat())
}

/// The data in a file, if it is whole and this driver's.
fn data_of<'file>(file: &'file [u8], driver: &str) -> Option<&'file [u8]> {
    let (sum, data) = file.split_at_checked(SUM_BYTES)?;
    (sum == sum_of(data, driver).as_bytes()).then_some(data)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_and_foreign_data_never_reaches_a_driver() {
        let mut file = [sum_of(b"programs", "driver 1").as_bytes(), b"programs"].concat();
        assert_eq!(data_of(&file, "driver 1"), Some(&b"programs"[..]), "its own");
        assert_eq!(data_of(&file, "driver 2"), None, "another driver's");
        assert_eq!(data_of(&file[..file.len() - 1], "driver 1"), None, "cut off");
        assert_eq!(data_of(&file[..10], "driver 1"), None, "cut off in the sum");
        assert_eq!(data_of(b"", "driver 1"), None, "empty");
        file[70] ^= 1;
        assert_eq!(data_of(&file, "driver 1"), None, "damaged");
    }
}
