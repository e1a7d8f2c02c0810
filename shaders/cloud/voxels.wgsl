// Voxels along each edge of a cell, for which their greatest value is known; as render/voxels.rs has it.
const VOXELS_PER_CELL: u32 = 8u;
