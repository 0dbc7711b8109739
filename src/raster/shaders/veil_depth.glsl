// Depths of blended surfaces in a shadow map: those before a slice, beyond 1, are told apart too, for each of them dims
// what is behind.
const float kLeastStored = 1e-6;  // what 1 stands for: so far before the slice that it is no distance

float veil_stored(float depth) { return depth <= 1.0 ? 0.5 * depth : 1.0 - 0.5 / depth; }
float veil_restored(float stored) { return stored <= 0.5 ? 2.0 * stored : 0.5 / max(1.0 - stored, kLeastStored); }
