//! Nephoscope: volumetric skies that show what accuracy costs in time.

pub mod export;
