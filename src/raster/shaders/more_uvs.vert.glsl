// Texture coordinates beyond the first two sets, two sets in each.
#ifdef MORE_UVS
layout(location = 9) in vec4 a_uv_2;
#if MORE_UVS > 1
layout(location = 10) in vec4 a_uv_4;
#endif
#if MORE_UVS > 2
layout(location = 11) in vec4 a_uv_6;
#endif
#if MORE_UVS > 3
layout(location = 12) in vec4 a_uv_8;
#endif
#if MORE_UVS > 4
layout(location = 13) in vec4 a_uv_10;
#endif
#if MORE_UVS > 5
layout(location = 14) in vec4 a_uv_12;
#endif
#if MORE_UVS > 6
layout(location = 15) in vec4 a_uv_14;
#endif

out vec4 v_more_uv[MORE_UVS];

void pass_more_uvs() {
  v_more_uv[0] = a_uv_2;
#if MORE_UVS > 1
  v_more_uv[1] = a_uv_4;
#endif
#if MORE_UVS > 2
  v_more_uv[2] = a_uv_6;
#endif
#if MORE_UVS > 3
  v_more_uv[3] = a_uv_8;
#endif
#if MORE_UVS > 4
  v_more_uv[4] = a_uv_10;
#endif
#if MORE_UVS > 5
  v_more_uv[5] = a_uv_12;
#endif
#if MORE_UVS > 6
  v_more_uv[6] = a_uv_14;
#endif
}
#else
void pass_more_uvs() {}
#endif
