// What the passes share that find how far it is to cloud.

// No way is longer: half floats end soon after.
const FARTHEST_M: f32 = 60000.0;
