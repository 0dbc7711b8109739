/// What a fragment's depth may differ by from the depth that another pass drew of it.
float layer_slack() { return 0.02 * fwidth(gl_FragCoord.z) + 2e-7; }
