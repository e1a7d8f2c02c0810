//! Measures: what each pass costs, on flights, and beside the table of the thesis; and how far a picture is from a
//! reference, with the plots and colours to show it.

pub mod accuracy;
pub mod bench;
pub mod colormap;
mod colour;
pub mod costa;
pub mod effects;
pub mod flight;
pub mod flip;
pub mod metrics;
pub mod pareto;
pub mod plot;
pub mod realism;
pub mod suite;
pub mod sweep;
pub mod table;
pub mod thesis;
pub mod verify;
