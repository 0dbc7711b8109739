#!/bin/sh
# install.sh DIR: the tools of npm that tests/interop runs, in the versions that its table was made with. Then
#     CANDELA_NODE_MODULES=DIR/node_modules ctest --test-dir build/dev -R interop
set -e
[ -n "$1" ] || { sed -n 2,3p "$0" >&2; exit 2; }
mkdir -p "$1"
cd "$1"
[ -f package.json ] || echo '{"private": true}' > package.json
npm install --no-audit --no-fund @gltf-transform/cli@4.5.1 gltfpack@1.3.0 three@0.187.0 @babylonjs/core@9.35.0 \
  @babylonjs/loaders@9.28.0 @babylonjs/serializers@9.28.0 ktx2-encoder@0.6.0
