//! Measures: what each pass costs, on flights, and beside the table of the thesis.

pub mod bench;
pub mod flight;
pub mod table;
pub mod thesis;
