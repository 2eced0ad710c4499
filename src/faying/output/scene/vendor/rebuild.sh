#!/usr/bin/env bash
# Makes three.min.js again from the package index of npm: what entry.js names of three.js, tree-shaken and minified.
# The versions are those that made the file in this folder; tests/output/test_scene.py has its SHA-256.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
npm init -y >/dev/null
npm install --no-save --no-audit --no-fund three@0.187.0 esbuild@0.28.2
cp "$here/entry.js" entry.js
./node_modules/.bin/esbuild entry.js --bundle --minify --format=esm --target=es2020 --legal-comments=none \
  --outfile="$here/three.min.js"
cp node_modules/three/LICENSE "$here/LICENSE.three"
sha256sum "$here/three.min.js"
