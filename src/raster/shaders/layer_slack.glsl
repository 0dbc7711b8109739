// Of what depth changes by over a pixel, and four roundings of a depth of 24 bits.
const float kSlopeSlack = 0.02;
const float kDepthSlack = 2e-7;

/// What a fragment's depth may differ by from the depth that another pass drew of it.
float layer_slack() { return kSlopeSlack * fwidth(gl_FragCoord.z) + kDepthSlack; }
